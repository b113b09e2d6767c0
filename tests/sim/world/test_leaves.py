"""Door leaves on hinges: free space, starts, sight, and a robot that pushes one."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sim.core.geometry.pose import Pose
from sim.core.interface import Action
from sim.gl import mujoco
from sim.houses.house import House
from sim.task.ground_truth import GroundTruth
from sim.world.freespace import FreeSpace
from sim.world.leaves import hinged_leaves, pushed_open
from sim.world.world import World


def two_rooms(angle_deg: float, *, widest_deg: float = 95.0, hinge: bool = True) -> House:
    """Returns two rooms of 3 x 3 m; the leaf between them opens into the right one, its hinge at y = 1.05."""
    joint = (
        f'<joint name="hinge" type="hinge" axis="0 0 -1" limited="true" range="{-angle_deg} {widest_deg - angle_deg}" '
        'damping="1" frictionloss="1"/>'
    )
    closed, turn = 90.0, -angle_deg
    return House("two", mujoco.MjSpec.from_string(f"""<mujoco><worldbody>
      <geom name="floor_00" type="box" size="3.2 1.7 .05" pos="3 1.5 -.05"/>
      <geom name="wall_00" type="box" size="3.1 .05 1.2" pos="3 -.05 1.2"/>
      <geom name="wall_01" type="box" size="3.1 .05 1.2" pos="3 3.05 1.2"/>
      <geom name="wall_02" type="box" size=".05 1.6 1.2" pos="-.05 1.5 1.2"/>
      <geom name="wall_03" type="box" size=".05 1.6 1.2" pos="6.05 1.5 1.2"/>
      <geom name="wall_04" type="box" size=".05 .525 1.2" pos="3 .525 1.2"/>
      <geom name="wall_05" type="box" size=".05 .525 1.2" pos="3 2.475 1.2"/>
      <site name="room_bedroom_00" type="box" size="1.5 1.5 1.2" pos="1.5 1.5 1.2"/>
      <site name="room_bathroom_00" type="box" size="1.5 1.5 1.2" pos="4.5 1.5 1.2"/>
      <body name="door_00" pos="3.08 1.05 0" euler="0 0 {closed + turn}">
        {joint if hinge else ""}
        <geom type="box" size=".44 .02 1" pos=".45 0 1.01" density="190"/>
      </body>
      <body name="toilet_00" pos="5.6 1.5 .2"><geom type="box" size=".3 .2 .2"/></body>
      <body name="stool_00" pos="3.6 2.2 .2"><geom type="box" size=".15 .15 .2"/></body>
    </worldbody></mujoco>"""))  # fmt: skip


def free_space(house: House) -> FreeSpace:
    return World(house).free_space()


def is_left(space: FreeSpace) -> tuple[bool, bool]:
    """Returns whether the largest part has places in the left and in the right room."""
    x_m, _ = space.frame.axes()
    part = space.largest_part()
    return bool(part[:, x_m < 2.5].any()), bool(part[:, x_m > 4.5].any())


def crosses(space: FreeSpace) -> bool:
    """Returns whether a path leads from the left room to the right one."""
    source = np.zeros_like(space.free)
    source[space.frame.cell(1.5, 1.0)] = True
    return math.isfinite(space.distance_at(space.geodesic(source), 5.0, 1.0))


def test_a_leaf_is_found_with_its_range_and_width() -> None:
    world = World(two_rooms(20.0))
    (leaf,) = hinged_leaves(world.model, world.data, world.labels)
    assert math.degrees(leaf.widest_rad - leaf.closed_rad) == pytest.approx(95.0)
    assert leaf.width_m == pytest.approx(0.89, abs=0.01)
    assert leaf.gap_m(0.0) == pytest.approx(2 * leaf.width_m * math.sin(math.radians(10.0)))


def test_an_ajar_leaf_counts_as_pushed_open_but_no_start_lies_behind_it() -> None:
    space = free_space(two_rooms(20.0))
    assert crosses(space)
    assert is_left(space) == (True, False)


def test_a_half_open_leaf_counts_where_it_stands() -> None:
    world = World(two_rooms(60.0))
    data, geoms = pushed_open(world.model, world.data, world.labels, world.robot.radius_m)
    assert data is world.data
    assert geoms == ()
    assert crosses(world.free_space())
    assert is_left(world.free_space()) == (True, True)


@pytest.mark.parametrize("house", [two_rooms(20.0, widest_deg=25.0), two_rooms(20.0, hinge=False)])
def test_a_leaf_that_does_not_open_far_enough_is_an_obstacle(house: House) -> None:
    assert not crosses(free_space(house))


def test_the_robot_pushes_a_leaf_open_and_passes() -> None:
    world = World(two_rooms(15.0))
    world.reset(Pose(2.2, 1.5, 0.0))
    for _ in range(8):
        world.move(Action.MOVE_FORWARD)
    assert world.pose.x_m > 3.8
    assert math.degrees(float(world.data.joint("hinge").qpos[0])) > 50.0


def test_a_stop_uses_the_leaf_where_it_is_now_and_distances_where_it_was() -> None:
    world = World(two_rooms(90.0))
    truth = GroundTruth(world)
    world.reset(Pose(1.5, 1.5, 0.0))
    through_the_doorway = (2.8, 1.45, 0.0)
    distance_m = truth.target("stool").distance_m.copy()
    assert truth.succeeds_now("stool", *through_the_doorway)
    world.data.joint("hinge").qpos[0] = math.radians(-90.0)
    mujoco.mj_kinematics(world.model, world.data)
    assert not truth.succeeds_now("stool", *through_the_doorway)
    assert np.array_equal(truth.target("stool").distance_m, distance_m)
