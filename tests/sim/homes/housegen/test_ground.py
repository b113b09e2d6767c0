"""The ground of houses: what is drawn, that only floors change, and that the robot drives over all of it."""

from __future__ import annotations

import functools
import math
from dataclasses import replace

import numpy as np
import pytest

from sim.core.geometry.pose import Pose
from sim.core.interface import CLIMB_M, Action
from sim.gl import mujoco
from sim.homes.housegen.ground import lay_ground
from sim.homes.housegen.ground.draw import FRICTION, RUG_M, Ground, Piece, draw_ground, material_of
from sim.homes.housegen.ground.lay import lay
from sim.homes.housegen.ground.survey import Survey, survey
from sim.houses.geoms import data_at_rest
from sim.houses.house import House
from sim.houses.labels import cover_geoms, read_labels
from sim.robot.conditions import Conditions
from sim.world.world import World

FLOOR = (
    '<body name="floor_0{n}"><geom size="2 2 .05" pos="{x} 0 -.05" material="{m}" contype="0" conaffinity="0"/></body>'
)
HOUSE = f"""<mujoco>
<asset><texture name="planks_wide" type="2d" builtin="flat" width="4" height="4"/>
<texture name="tiles_large" type="2d" builtin="flat" width="4" height="4"/>
<material name="boards" texture="planks_wide"/><material name="tiles" texture="tiles_large"/><material name="white"/>
</asset>
<default><geom type="box"/></default>
<worldbody>
<geom name="floor_00" size="4.2 2.2 .05" pos="2 0 -.05" group="3"/>
<site name="room_bedroom_00" type="box" size="1.94 1.94 1.2" pos="0 0 1.2"/>
<site name="room_bathroom_00" type="box" size="1.94 1.94 1.2" pos="4 0 1.2"/>
{FLOOR.format(n=1, x=0, m="boards")}{FLOOR.format(n=2, x=4, m="tiles")}
<body name="floor_03" pos="0 -1 0"><geom size=".6 .4 .004" pos="0 0 .004" contype="0" conaffinity="0"/></body>
<body name="wall_00"><geom size=".06 .8 1.2" pos="2 -1.2 1.2"/><geom size=".06 .8 1.2" pos="2 1.2 1.2"/>
<geom size=".1 2.2 1.2" pos="-2.04 0 1.2"/><geom size=".1 2.2 1.2" pos="6.04 0 1.2"/>
<geom size="4.2 .1 1.2" pos="2 -2.04 1.2"/><geom size="4.2 .1 1.2" pos="2 2.04 1.2"/></body>
<body name="door_00" pos="2 0 0" quat="1 0 0 1"><geom size=".015 .064 1" pos="-.385 0 1" material="white"/>
<geom size=".015 .064 1" pos=".385 0 1" material="white"/></body>
<body name="shower_00" pos="5.4 1 0" quat="0 0 0 1"><geom size=".4 .4 1" pos="0 0 1"/></body>
<body name="chair_00" pos="0 -1 0"><freejoint/>
<geom size=".2 .2 .2" pos="0 0 .2" friction=".2 .005 .0001" priority="1" mass="4"/></body>
</worldbody></mujoco>"""
FORWARD = Action.MOVE_FORWARD


def house(seed: int | None = None) -> mujoco.MjSpec:
    """Returns a house of two rooms with a doorway, a rug under a chair and a shower; with the ground of a seed."""
    spec = mujoco.MjSpec.from_string(HOUSE)
    if seed is not None:
        lay_ground(spec, HOUSE, seed, 0)
    return spec


def drawn(seed: int) -> Ground:
    return draw_ground(np.random.default_rng(seed), survey(house()))


def test_a_survey_finds_rooms_doorways_rugs_and_fixtures():
    found: Survey = survey(house())
    assert [(room.kind, material_of(room)) for room in found.rooms] == [("bedroom", "wood"), ("bathroom", "tiles")]
    (doorway,), (rug,), (shower,) = found.doorways, found.rugs, found.fixtures
    assert (doorway.x_m, doorway.y_m, doorway.width_m) == pytest.approx((2.0, 0.0, 0.74))
    assert [room.body for room in doorway.rooms] == ["floor_01", "floor_02"]
    assert (rug.half_m, rug.height_m, rug.is_round) == (pytest.approx((0.6, 0.4)), pytest.approx(0.008), False)
    assert (shower.room.body, abs(shower.yaw_rad)) == ("floor_02", pytest.approx(math.pi, abs=1e-3))


def test_grounds_differ_by_seed_within_their_limits():
    grounds = [drawn(seed) for seed in range(60)]
    assert drawn(3) == grounds[3]
    for ground in grounds:
        assert FRICTION["wood"][0] <= ground.friction["floor_01"] <= FRICTION["wood"][1]
        assert FRICTION["tiles"][0] <= ground.friction["floor_02"] <= FRICTION["tiles"][1]
        assert RUG_M[0] <= 0.008 * ground.rug_scale["floor_03"] <= RUG_M[1]
    heights = [0.008 * ground.rug_scale["floor_03"] for ground in grounds]
    assert min(heights) < 0.004 < 0.011 < max(heights)
    with_sill = [any(piece.material == "white" for piece in ground.pieces) for ground in grounds]
    with_water = [any(piece.material == "water" for piece in ground.pieces) for ground in grounds]
    with_tiles = [any(piece.quat[0] < 1.0 and not piece.material for piece in ground.pieces) for ground in grounds]
    for kind in (with_sill, with_water, with_tiles):
        assert 0.1 * len(grounds) < sum(kind) < len(grounds)


def test_thresholds_are_rarer_between_floors_of_the_same_material():
    other = survey(house())
    same = survey(mujoco.MjSpec.from_string(HOUSE.replace('material="tiles" contype', 'material="boards" contype')))
    assert {material_of(room) for room in same.rooms} == {"wood"}
    counts = []
    for found in (other, same):
        grounds = [draw_ground(np.random.default_rng(seed), found) for seed in range(200)]
        counts.append(sum(any(piece.material == "white" for piece in ground.pieces) for ground in grounds))
    assert 0 < counts[1] < 0.7 * counts[0]


def test_the_friction_of_an_episode_is_the_drawn_one_times_its_scale_on_floors_and_on_what_covers_them():
    rng = np.random.default_rng([3, 0, 3])
    ground = draw_ground(rng, survey(house()))
    world = World(House("house", house(3)))
    model = world.model
    first = {model.geom(geom).name.partition(":")[0]: geom for geom in reversed(range(model.ngeom))}
    for scale in (0.5, 1.0):
        world.reset(Pose(-1.0, 1.0, 0.0), Conditions(floor_friction_scale=scale))
        for name, friction in ground.friction.items():
            assert model.geom_friction[first[name], 0] == pytest.approx(scale * friction)
        covers = sorted(model.geom_friction[cover_geoms(model), 0])
        assert covers == pytest.approx(sorted(scale * piece.friction for piece in ground.pieces))


@pytest.mark.parametrize("seed", range(4))
def test_the_robot_climbs_everything_and_only_floors_differ(seed):
    level, laid = house().compile(), house(seed).compile()
    data = data_at_rest(laid)
    labels = read_labels(laid, ignore_prefix="")
    covers = np.flatnonzero(cover_geoms(laid))
    assert {labels.instances[labels.geom_instance[geom]].category for geom in covers} == {"floor"}
    rotation = np.abs(data.geom_xmat[covers, 6:9])
    top_m = data.geom_xpos[covers, 2] + (rotation * laid.geom_aabb[covers, 3:]).sum(axis=1)
    assert top_m.min() > 0.0
    assert top_m.max() <= CLIMB_M + 1e-5
    for name in ("wall_00", "door_00", "shower_00", "chair_00"):
        pairs = zip(*(range(*_geoms_of(model, name)) for model in (level, laid)), strict=True)
        for a, b in pairs:
            assert level.geom(a).pos.tolist() == laid.geom(b).pos.tolist()
            assert level.geom(a).size.tolist() == laid.geom(b).size.tolist()


def _geoms_of(model: mujoco.MjModel, body: str) -> tuple[int, int]:
    first, count = int(model.body(body).geomadr[0]), int(model.body(body).geomnum[0])
    return first, first + count


def test_the_free_space_is_that_of_the_level_ground():
    level, laid = (World(House("house", spec)).free_space() for spec in (house(), house(1)))
    assert level.frame == laid.frame
    np.testing.assert_array_equal(level.free, laid.free)


def test_furniture_on_a_rug_stands_on_the_floor_below():
    world = World(House("house", house(1)))
    world.reset(Pose(-1.0, 1.0, 0.0))
    mujoco.mj_step(world.model, world.data, nstep=250)
    chair = world.data.body("chair_00")
    assert world.model.geom("floor_03:4").contype[0] == 8
    assert chair.xpos[2] == pytest.approx(0.0, abs=0.001)


def course(friction: float, *pieces: Piece) -> World:
    """Returns a floor with some pieces of ground on it."""
    spec = mujoco.MjSpec()
    spec.add_material(name="white")
    spec.worldbody.add_body(name="floor_01").add_geom(
        type=mujoco.mjtGeom.mjGEOM_BOX, size=[4, 4, 0.05], pos=[0, 0, -0.05]
    )
    lay(spec, Ground({"floor_01": friction}, {}, pieces))
    return World(House("course", spec))


@functools.cache
def highest(kind: str) -> list[Piece]:
    """Returns the pieces of the highest rug (`""`) or threshold (`white`) of some seeds, moved to the origin."""
    of_seeds = [
        [p for p in drawn(seed).pieces if p.material == kind and p.quat[1:3] == (0.0, 0.0)] for seed in range(80)
    ]
    best = max((pieces for pieces in of_seeds if pieces), key=lambda pieces: max(p.pos_m[2] for p in pieces))
    return [replace(p, body="floor_01", pos_m=(0.0, 0.0, p.pos_m[2])) for p in best]


@pytest.mark.parametrize("kind", ["", "white"], ids=["rug", "threshold"])
@pytest.mark.parametrize(("start_m", "heading_deg"), [(-0.9, 0.0), (-0.75, 0.0), (-0.9, 30.0)])
def test_the_robot_drives_over_the_highest_rug_and_threshold_with_the_least_friction(kind, start_m, heading_deg):
    pieces = highest(kind)
    assert 2.0 * max(p.pos_m[2] for p in pieces) > 0.0115
    world = course(FRICTION["stone"][0], *(replace(p, friction=FRICTION["sill"][0]) for p in pieces))
    yaw = math.radians(heading_deg)
    world.reset(Pose(start_m, start_m * math.tan(yaw), yaw))
    motions = [world.move(FORWARD) for _ in range(6)]
    assert [motion.collided for motion in motions] == [False] * 6
    assert sum(motion.displacement_m for motion in motions) == pytest.approx(1.5, abs=0.05)


def test_wheels_slip_on_a_wet_spot_when_the_robot_pushes_and_not_when_it_drives():
    wet = Piece("floor_01", (0.0, 0.0, 0.0005), (3.0, 1.0, 0.0005), FRICTION["wet"][0], material="white")
    world = course(0.7, wet)
    world.reset(Pose(-1.0, 0.0, 0.0))
    assert [round(world.move(FORWARD).displacement_m, 2) for _ in range(3)] == [0.25] * 3
    tyre = world.model.geom("stubborn_robot/left_tyre").id
    touching = {int(b if a == tyre else a) for a, b in world.data.contact.geom.tolist() if tyre in (a, b)}
    assert [world.model.geom_friction[geom, 0] for geom in touching] == [pytest.approx(FRICTION["wet"][0])]
