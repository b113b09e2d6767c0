"""The compiled body of the robot."""

from __future__ import annotations

import numpy as np
import pytest

from sim.gl import mujoco
from sim.robot.body import HULL_MASK, MOVABLE_MASK, ROBOT_GROUP, STATIC_MASK, WHEEL_MASK, built_in_robot_spec
from sim.robot.config import Base, RobotConfig
from sim.world.world import World
from tests.helpers.worlds import open_floor


@pytest.fixture(scope="module", params=["planar", "free"])
def alone(request: pytest.FixtureRequest) -> mujoco.MjModel:
    return built_in_robot_spec(RobotConfig(base=request.param)).compile()


def test_the_mass_is_the_declared_one(alone: mujoco.MjModel):
    assert alone.body_mass.sum() == pytest.approx(RobotConfig().body.mass_kg)


def test_the_centre_of_mass_is_the_declared_one(alone: mujoco.MjModel):
    data = mujoco.MjData(alone)
    mujoco.mj_forward(alone, data)
    base = alone.body("base").id
    np.testing.assert_allclose(data.subtree_com[base], (0.0, 0.0, RobotConfig().body.com_height_m), atol=1e-9)


def test_wheels_are_balanced(alone: mujoco.MjModel):
    for name in ("left_wheel", "right_wheel"):
        np.testing.assert_array_equal(alone.body_ipos[alone.body(name).id], 0.0)


def test_no_camera_group_shows_the_robot(alone: mujoco.MjModel):
    assert (alone.geom_group == ROBOT_GROUP).all()
    assert ROBOT_GROUP >= 3


def test_the_hull_fills_the_declared_cylinder(alone: mujoco.MjModel):
    body = RobotConfig().body
    hull = [alone.geom(f"{name}_hull") for name in ("lower", "upper")]
    assert all(float(geom.margin[0]) == body.skin_m for geom in hull)
    assert min(float(geom.pos[2] - geom.size[1]) for geom in hull) == pytest.approx(body.clearance_m + body.skin_m)
    assert max(float(geom.pos[2] + geom.size[1]) for geom in hull) == pytest.approx(body.height_m - body.skin_m)
    assert all(float(geom.size[0]) == pytest.approx(body.radius_m - body.skin_m) for geom in hull)


@pytest.mark.parametrize(
    ("one", "other", "meet"),
    [
        (WHEEL_MASK, (1, 0), True),
        (WHEEL_MASK, STATIC_MASK, True),
        (WHEEL_MASK, MOVABLE_MASK, True),
        (WHEEL_MASK, WHEEL_MASK, False),
        (WHEEL_MASK, HULL_MASK, False),
        (HULL_MASK, (1, 0), True),
        (HULL_MASK, STATIC_MASK, True),
        (HULL_MASK, MOVABLE_MASK, True),
        (MOVABLE_MASK, (1, 0), True),
        (MOVABLE_MASK, STATIC_MASK, True),
        (MOVABLE_MASK, MOVABLE_MASK, True),
        (STATIC_MASK, (1, 0), False),
    ],
)
def test_collision_masks_decide_which_geoms_collide(one, other, meet):
    assert bool((one[0] & other[1]) | (other[0] & one[1])) is meet


def ground_loads_n(base: Base) -> dict[str, float]:
    """Returns the vertical force of the floor on each part of a robot at rest."""
    world = World(open_floor(), robot=RobotConfig(base=base))
    data, wrench = world.data, np.zeros(6)
    mujoco.mj_step(world.model, data, nstep=250)
    loads = {}
    for index, pair in enumerate(data.contact.geom.tolist()):
        mujoco.mj_contactForce(world.model, data, index, wrench)
        loads[world.model.geom(max(pair)).name] = float(wrench[0])
    return loads


WEIGHT_N = 9.81 * RobotConfig().body.mass_kg


def test_all_the_weight_of_a_planar_base_is_on_the_wheels():
    loads = ground_loads_n("planar")
    assert loads.keys() == {"stubborn_robot/left_tyre", "stubborn_robot/right_tyre"}
    assert sum(loads.values()) == pytest.approx(WEIGHT_N, rel=0.01)


def test_the_springs_of_a_free_base_press_the_wheels_down_with_their_share_of_the_weight():
    loads = ground_loads_n("free")
    share = RobotConfig().wheels.load_share
    for side in ("left", "right"):
        assert loads[f"stubborn_robot/{side}_tyre"] == pytest.approx(0.5 * share * WEIGHT_N, rel=0.05)
    assert loads["stubborn_robot/front_caster"] == pytest.approx(loads["stubborn_robot/rear_caster"], rel=0.01)
    assert sum(loads.values()) == pytest.approx(WEIGHT_N, rel=0.01)
