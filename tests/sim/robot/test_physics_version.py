"""The version of the physics is increased when the same actions lead elsewhere."""

from __future__ import annotations

import pytest

from sim.core.geometry.pose import Pose
from sim.core.interface import Action
from sim.robot.conditions import Conditions
from sim.robot.config import PHYSICS_VERSION
from sim.world.world import World
from tests.helpers.worlds import sofa_room

ACTIONS = "1121113311111111221111"
ENDS = {3: (1.9165, -0.041, 0.8889, 8)}
"""x, y and yaw at the end, and the number of collisions, by version of the physics."""


def test_the_same_actions_lead_to_the_place_of_this_version_of_the_physics() -> None:
    """If this fails, increase `PHYSICS_VERSION` and put the new numbers here: recorded runs cannot be replayed."""
    world = World(sofa_room())
    varied = Conditions(
        floor_friction_scale=0.5, motor_gain_scale=(0.95, 1.05), stop_std_m=0.004, stop_std_rad=0.006, wheel_std=0.016,
        gyro_std=0.016, motor_std=0.05, seed=5,
    )  # fmt: skip
    world.reset(Pose(0.0, -1.0, 0.4), varied)
    motions = [world.move(Action(int(each))) for each in ACTIONS]
    x_m, y_m, yaw_rad, collisions = ENDS[PHYSICS_VERSION]
    pose = world.pose
    assert sum(motion.collided for motion in motions) == collisions > 0
    assert (pose.x_m, pose.y_m, pose.yaw_rad) == pytest.approx((x_m, y_m, yaw_rad), abs=5e-3)
