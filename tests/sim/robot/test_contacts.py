"""The record of the contacts of the hull."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sim.app.commands.traps.trial import DeepestContact, hull_of
from sim.core.geometry.pose import Pose
from sim.core.interface import Action
from sim.gl import mujoco
from sim.robot.config import Base, RobotConfig
from sim.robot.drive import Motion
from sim.world.world import World
from tests.helpers.sampling import sample
from tests.helpers.worlds import open_floor, random_obstacles, with_box, with_post

FORWARD = Action.MOVE_FORWARD


def test_a_contact_has_instance_position_and_direction():
    world = World(with_box(open_floor(), "cabinet_07", centre_m=(0.5, 0.0, 0.3), half_m=(0.1, 1.0, 0.3)))
    world.reset(Pose(0.0, 0.0, 0.0))
    (contact,) = world.move(FORWARD).contacts
    assert (contact.instance, contact.geom) == ("cabinet_07", "cabinet_07")
    assert contact.stopped
    assert contact.position_m[0] == pytest.approx(0.4, abs=0.005)
    assert contact.position_m[1] == pytest.approx(0.0, abs=0.01)
    assert 0.0 <= contact.position_m[2] <= 0.61
    assert contact.direction[0] < -0.9
    assert np.linalg.norm(contact.direction) == pytest.approx(1.0)
    assert 0.02 <= contact.duration_s < 0.3


@pytest.mark.parametrize("side", [1, -1])
def test_the_force_comes_from_the_side_of_the_obstacle(side):
    world = World(with_post(open_floor(), "column_00", xy_m=(0.3, side * 0.12), radius_m=0.02))
    world.reset(Pose(0.0, 0.0, 0.0))
    (contact,) = world.move(FORWARD).contacts
    assert contact.direction[0] < 0
    assert contact.direction[1] * side < 0
    assert contact.position_m[1] * side > 0


def test_an_invisible_obstacle_collides_and_is_named():
    glass = with_box(open_floor(), "door_00", centre_m=(0.4, 0.0, 1.0), half_m=(0.01, 1.0, 1.0), group=3)
    world = World(glass)
    world.reset(Pose(0.0, 0.0, 0.0))
    motion = world.move(FORWARD)
    assert motion.collided
    assert motion.contacts[0].instance == "door_00"


def test_an_unlabelled_invisible_obstacle_has_a_geom_but_no_instance():
    world = World(with_box(open_floor(), "artefact", centre_m=(0.4, 0.0, 1.0), half_m=(0.01, 1.0, 1.0), group=4))
    world.reset(Pose(0.0, 0.0, 0.0))
    motion = world.move(FORWARD)
    assert motion.collided
    assert (motion.contacts[0].instance, motion.contacts[0].geom) == ("", "artefact")


def drive_among_obstacles(seed: int, base: Base) -> tuple[list[tuple[Motion, float]], float]:
    """Returns each motion among random obstacles with the heading error after it (deg), and the deepest overlap."""
    world = World(random_obstacles(seed), robot=RobotConfig(base=base))
    rng = np.random.default_rng(seed)
    start_yaw = float(rng.uniform(-3, 3))
    world.reset(Pose(0.0, 0.0, start_yaw))
    deepest, motions = DeepestContact(hull_of(world)), []
    mujoco.set_mjcb_control(deepest)
    try:
        for action in map(Action, rng.choice([1, 1, 1, 2, 3], size=8).tolist()):
            motion = world.move(action)
            error = math.degrees(math.remainder(world.pose.yaw_rad - start_yaw, math.radians(30)))
            motions.append((motion, abs(error)))
    finally:
        mujoco.set_mjcb_control(None)
    return motions, deepest.depth_m


@pytest.mark.parametrize("seed", sample(range(200), 12))
def test_among_random_obstacles_overlaps_are_small_and_contacts_explain_blocked_motions(seed):
    """Overlaps stay below 3 mm, headings are kept, and `collided` agrees with the displacement.

    A forward is 0.25 m by odometry: without a contact that is the truth, wheels that slip while the robot slides along
    an object make it shorter.
    """
    motions, depth_m = drive_among_obstacles(seed, "planar")
    for motion, error_deg in motions:
        whole_m = 0.25 if motion.action == FORWARD else 0.0
        assert error_deg < 0.5
        if motion.ended == "reached":
            assert motion.displacement_m == pytest.approx(whole_m, abs=0.07 if motion.contacts else 0.025)
        else:
            assert motion.collided
            assert motion.displacement_m < 0.25
    assert depth_m < 0.003


@pytest.mark.parametrize("seed", sample(range(200), 6))
def test_a_free_base_among_random_obstacles_may_lean_but_does_not_fall_or_overlap(seed):
    """It leans at table tops, where one wheel loses its grip and the heading turns by up to 15 deg for one motion."""
    motions, depth_m = drive_among_obstacles(seed, "free")
    for motion, error_deg in motions:
        assert not motion.fell
        assert motion.displacement_m < 0.27
        assert error_deg < 15.0
    assert sum(error_deg > 0.5 for _, error_deg in motions) <= 4
    assert depth_m < 0.003


@pytest.mark.parametrize("kind", ["cylinder", "corner", "face"])
def test_the_lightest_touch_has_the_right_normal_and_depth(kind):
    """Without its skin, contacts of micrometres have normals that are wrong by up to 180 deg (MuJoCo 4.0)."""
    middle = np.array((3.217, -1.843))
    if kind == "cylinder":
        house, reach_m = with_post(open_floor(), "stool_00", xy_m=(3.217, -1.843), radius_m=0.17, height_m=0.44), 0.17
    else:
        house, reach_m = with_box(open_floor(), "stool_00", centre_m=(*middle, 0.4), half_m=(0.2, 0.3, 0.4)), 0.0
    world = World(house, robot=RobotConfig(base="planar"))
    data, model = world.data, world.model
    joints = [model.joint(f"stubborn_robot/{name}").qposadr[0] for name in ("x", "y", "z", "yaw")]
    hull = {model.geom(f"stubborn_robot/{name}_hull").id for name in ("lower", "upper")}
    rng = np.random.default_rng(0)
    for _ in range(400):
        depth_m = float(10.0 ** rng.uniform(-9, -2.6))
        bearing = float(rng.uniform(0.1, 1.4)) if kind == "corner" else float(rng.uniform(-math.pi, math.pi))
        corner = np.zeros(2)
        if kind == "corner":
            corner = np.array((0.2, 0.3))
        elif kind == "face":
            bearing, corner = 0.0, np.array((0.2, rng.uniform(-0.29, 0.29)))
        outward = np.array((math.cos(bearing), math.sin(bearing)))
        x, y = middle + corner + outward * (reach_m + 0.18 - depth_m)
        data.qpos[joints] = (x, y, 0.0, rng.uniform(-3, 3))
        mujoco.mj_forward(model, data)
        touches = [i for i, pair in enumerate(data.contact.geom.tolist()) if not hull.isdisjoint(pair)]
        assert touches
        for index in touches:
            contact = data.contact[index]
            towards_hull = contact.frame[:2] * (1 if contact.geom2 in hull else -1)
            assert contact.includemargin - contact.dist == pytest.approx(depth_m, abs=2e-5)
            assert towards_hull @ outward > math.cos(math.radians(3))
