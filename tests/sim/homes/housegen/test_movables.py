"""Tests of movable furniture: it rests, slides when it is pushed, stays upright and sleeps again."""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Iterator

import numpy as np
import pytest

from sim.core.geometry.pose import Pose
from sim.core.interface import MPCAT40_ID, Action, CameraModel
from sim.env.oracle import Oracle
from sim.env.scene import Scene
from sim.episodes.drawing import sample_episode
from sim.gl import mujoco
from sim.homes.housegen import generate
from sim.homes.housegen.floor_plan.rectangles import Rect
from sim.homes.housegen.furniture import CATALOGUE
from sim.homes.housegen.furniture.item import Child, Item
from sim.homes.housegen.mjcf.builder import HouseBuilder
from sim.homes.housegen.mjcf.movables import GRAVITY_M_S2, MAX_PUSH_N, split_movable
from sim.homes.housegen.mjcf.placed import PlacedItem
from sim.homes.housegen.splits.recipes import SPLITS
from sim.houses.house import House
from sim.renderer.camera import Camera
from sim.robot.config import RobotConfig
from sim.robot.drive import Motion
from sim.world.check import check_house
from sim.world.world import World
from tests.helpers.sampling import sample
from tests.helpers.worlds import room, with_movable

AREA_M2 = 80.0
POOLS = ("train", "heldout")
KINDS = ("chair", "stool", "plant", "gym_equipment")
HIGH_M = 0.35
"""A force of 20 N at this height has 4/5 of the moment of the weight of the robot about a caster."""
EXACT_SHAPES = {mujoco.mjtGeom.mjGEOM_BOX, mujoco.mjtGeom.mjGEOM_CAPSULE, mujoco.mjtGeom.mjGEOM_SPHERE}


@functools.cache
def item_of(category: str, pool: str, style: str) -> Item:
    return CATALOGUE.make_item(category, np.random.default_rng(3), pool=pool, style=style)  # type: ignore[arg-type]


def movable_styles(*categories: str) -> list[tuple[str, str, str]]:
    names = [(c, pool, style.name) for c in categories for pool in POOLS for style in CATALOGUE.styles(c, pool)]
    return [name for name in names if split_movable(item_of(*name))[1]]


def world_with(item: Item) -> World:
    """Returns the world of one item on an empty floor."""
    builder = HouseBuilder("world_with")
    builder.add_ground(Rect(-4, -4, 4, 4))
    builder.add_movable(PlacedItem(item))
    return World(House("world_with", builder.spec))


@functools.cache
def seed_of_home() -> int:
    """Returns the first seed whose small flat has a movable chair and three more movables."""
    for seed in range(20):
        names = movable_names(flat(seed).spec.compile())
        if len(names) >= 4 and any(name.startswith("chair_") for name in names):
            return seed
    raise AssertionError("no seed below 20 has chairs to push")


@functools.cache
def flat(seed: int) -> House:
    return House("home", generate(seed, kind="flat", area_m2=AREA_M2, movable=True))


def home() -> House:
    return flat(seed_of_home())


@dataclasses.dataclass
class Place:
    """The environment of the oracle."""

    scene: Scene


def movable_bodies(model: mujoco.MjModel) -> list[int]:
    """Returns the bodies with a free joint, without the robot's."""
    free = model.jnt_bodyid[model.jnt_type == mujoco.mjtJoint.mjJNT_FREE].tolist()
    return [body for body in free if not model.body(body).name.startswith("stubborn_robot/")]


def movable_names(model: mujoco.MjModel) -> list[str]:
    return [model.body(body).name for body in movable_bodies(model)]


def asleep(world: World, body: int) -> bool:
    return bool(world.data.tree_asleep[world.model.body_treeid[body]] >= 0)


def tilt_deg(world: World, body: int) -> float:
    return math.degrees(math.acos(min(1.0, float(world.data.xmat[body, 8]))))


def wait(world: World, seconds: float) -> None:
    mujoco.mj_step(world.model, world.data, nstep=round(seconds / world.model.opt.timestep))


def step_back(world: World, yaw_rad: float) -> None:
    """Moves the robot back by 5 cm, so that it does not touch what it has pushed: the robot itself never sleeps."""
    at = world.model.joint("stubborn_robot/free").qposadr[0]
    world.data.qpos[at : at + 2] -= 0.05 * np.array([math.cos(yaw_rad), math.sin(yaw_rad)])


def free_pose(world: World) -> Pose:
    space = world.free_space()
    cells = np.argwhere(space.largest_part())
    row, col = cells[len(cells) // 2]
    x, y = space.frame.axes()
    return Pose(float(x[col]), float(y[row]), 0.0)


def forwards(world: World, actions: int, body: int) -> Iterator[tuple[Motion, float]]:
    """Yields each forward action and the speed of a body at its end."""
    for _ in range(actions):
        motion = world.move(Action.MOVE_FORWARD)
        velocity = np.zeros(6)
        mujoco.mj_objectVelocity(world.model, world.data, mujoco.mjtObj.mjOBJ_BODY, body, velocity, 0)
        yield motion, float(np.linalg.norm(velocity[3:]))


def is_too_high(motion: Motion) -> bool:
    """Returns whether a contact stopped a motion so high above the floor that the robot would rather tip over."""
    return any(contact.stopped and contact.position_m[2] > HIGH_M for contact in motion.contacts)


@pytest.mark.costly
def test_only_light_items_of_four_categories_are_movable_and_only_on_request() -> None:
    assert {name.rpartition("_")[0] for name in movable_names(home().spec.compile())} <= set(KINDS)
    assert not movable_bodies(generate(seed_of_home(), kind="studio", area_m2=55.0).compile())


@pytest.mark.parametrize("name", movable_styles(*KINDS), ids="-".join)
def test_a_movable_has_exact_shapes_is_light_enough_stays_in_place_and_sleeps(name: tuple[str, str, str]) -> None:
    world = world_with(item_of(*name))
    model = world.model
    for body in movable_bodies(model):
        geoms = np.flatnonzero(model.geom_bodyid == body)
        collision = geoms[model.geom_contype[geoms] != 0]
        assert {mujoco.mjtGeom(kind) for kind in model.geom_type[collision]} <= EXACT_SHAPES
        assert (model.geom_group[collision] >= 3).all()
        assert (model.geom_group[np.setdiff1d(geoms, collision)] < 3).all()
        assert (model.geom_priority[collision] == 1).all()
        assert 0.5 <= model.body_mass[body] <= 20.0
        friction = float(model.geom_friction[collision[0], 0])
        assert friction * model.body_mass[body] * GRAVITY_M_S2 <= MAX_PUSH_N
        assert 0.0 < model.body_ipos[body, 2] < 0.6
    world.reset(Pose(3.0, 3.0, 0.0))
    wait(world, 1.0)
    for body in movable_bodies(model):
        at = model.jnt_qposadr[model.body_jntadr[body]]
        assert np.linalg.norm(world.data.qpos[at : at + 3] - model.qpos0[at : at + 3]) < 0.002
        assert asleep(world, body)


@pytest.mark.costly
@pytest.mark.parametrize("name", sample(movable_styles("chair", "stool", "plant"), 10), ids="-".join)
@pytest.mark.parametrize("side_deg", [0, 90, 180, 225])
def test_a_pushed_movable_slides_upright_and_sleeps_again(name: tuple[str, str, str], side_deg: int) -> None:
    world = world_with(item_of(*name))
    (body,) = movable_bodies(world.model)
    yaw = math.radians(side_deg) + 0.1
    world.reset(Pose(-0.8 * math.cos(yaw), -0.8 * math.sin(yaw), yaw))
    wait(world, 0.5)
    assert asleep(world, body)
    tilts, motions, where = [], list[Motion](), world.data.xpos[body].copy()
    for motion, speed in forwards(world, 5, body):
        tilts.append(tilt_deg(world, body))
        motions.append(motion)
        assert speed < 1.5
    wait(world, 2.0)
    assert np.linalg.norm(world.data.xpos[body] - where) > 0.05 or is_too_high(motions[-1])
    assert max(*tilts, tilt_deg(world, body)) < 20.0
    step_back(world, yaw)
    wait(world, 2.0)
    assert asleep(world, body)


def test_a_pushed_ball_comes_to_rest() -> None:
    world = world_with(item_of("gym_equipment", "train", "mat_and_ball"))
    ball = max(movable_bodies(world.model), key=lambda body: float(world.model.body_ipos[body, 2]))
    x, y, _ = world.model.body_pos[ball]
    world.reset(Pose(float(x) - 0.8, float(y), 0.0))
    for _ in range(4):
        world.move(Action.MOVE_FORWARD)
    assert world.data.xipos[ball, 0] > x + 0.1
    wait(world, 4.0)
    assert asleep(world, ball)


def test_all_movables_of_a_house_rest_and_block_the_free_space() -> None:
    world = World(home())
    bodies = movable_bodies(world.model)
    mujoco.mj_forward(world.model, world.data)
    space = world.free_space()
    before = world.data.xpos[bodies].copy()
    assert not any(space.is_free(float(x), float(y)) for x, y, _ in world.data.xipos[bodies])
    world.reset(free_pose(world))
    wait(world, 1.0)
    assert np.linalg.norm(world.data.xpos[bodies] - before, axis=1).max() < 0.002
    assert all(asleep(world, body) for body in bodies)


@pytest.mark.costly
def test_a_pushed_chair_is_rendered_and_blocks_at_its_new_place() -> None:
    world = world_with(item_of("chair", "train", "slat_back"))
    (body,) = movable_bodies(world.model)
    world.reset(Pose(-0.8, 0.0, 0.0))
    camera = Camera(world.model, world.labels, camera=CameraModel())
    chair = MPCAT40_ID["chair"]
    seen = []
    for actions in (0, 5):
        for _ in range(actions):
            world.move(Action.MOVE_FORWARD)
        picture = camera.render(world.data, Pose(-2.0, 0.0, 0.0), ("semantic", "depth"))
        seen.append(float(picture["depth"][picture["semantic"] == chair].mean()))
        x, y, _ = world.data.xpos[body]
        assert not world.free_space().is_free(float(x), float(y))
    camera.close()
    assert seen[1] - seen[0] == pytest.approx(float(world.data.xpos[body, 0]), abs=0.05)
    assert world.free_space().is_free(-0.1, 0.0)


def test_items_that_carry_others_or_are_heavy_stay_static() -> None:
    chair, cushion = (
        item_of("chair", "train", "slat_back"),
        CATALOGUE.make_item("cushion", np.random.default_rng(0), pool="train"),
    )
    laden = dataclasses.replace(chair, children=(Child(cushion, (0.0, 0.0, 0.5)),))
    assert split_movable(laden) == (laden, ())
    treadmill = item_of("gym_equipment", "train", "treadmill")
    rest, movables = split_movable(treadmill)
    assert rest is not None
    assert movables == ()
    assert split_movable(dataclasses.replace(chair, mass_kg=15.0))[1] == ()


def test_the_check_finds_movables_that_do_not_rest() -> None:
    house = with_movable(room(5, 4), "stool_00", xy_m=(0.0, 0.0))
    assert check_house(house.spec) == []
    both = with_movable(house, "stool_01", xy_m=(0.395, 0.0))  # 5 mm into the other: they push each other away
    faults = check_house(both.spec)
    assert faults
    assert all("is not stable: after 1 s" in fault for fault in faults)


@pytest.mark.costly
def test_the_oracle_reaches_a_goal_among_movables() -> None:
    scene = Scene(home(), robot=RobotConfig(), camera=CameraModel(), profile="fast")
    episode = sample_episode(scene.task, "home", np.random.default_rng(0))
    scene.world.reset(episode.start)
    scene.task.begin(episode.goal, episode.start)

    oracle = Oracle(Place(scene))
    oracle.reset(episode.goal, seed=0)
    while not scene.task.done:
        action = oracle.act({})
        scene.task.observe(action, scene.world.move(action))
    metrics = scene.task.metrics()
    scene.close()
    assert metrics.success == 1.0
    assert metrics.collisions == 0


@pytest.mark.parametrize("split", [name for name in SPLITS if name in ("val", "test")])
def test_a_third_of_the_shipped_houses_has_movables(split: str) -> None:
    recipes = SPLITS[split]
    assert sum(recipe.movable for recipe in recipes) == pytest.approx(len(recipes) / 3, abs=1)
