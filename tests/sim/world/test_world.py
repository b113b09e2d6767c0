"""The compiled world keeps labels, sets collision masks, refuses impossible starts and is deterministic."""

from __future__ import annotations

import hashlib
import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from sim.core.errors import EpisodeError, PhysicsError
from sim.core.geometry.pose import Pose
from sim.core.interface import MPCAT40_ID, Action, SuccessRule
from sim.gl import mujoco
from sim.houses.house import House
from sim.robot.config import PhysicsConfig, RobotConfig
from sim.world.world import World
from tests.helpers.worlds import cluttered_room, open_floor, room, with_box, with_movable, with_post

ORIGIN = Pose(0.0, 0.0, 0.0)
XML = """
<mujoco>
  <option timestep="0.01" gravity="0 0 -1" density="1000"/>
  <size memory="100K"/>
  <default><geom contype="4" conaffinity="4" margin="0.001"/></default>
  <worldbody>
    <geom name="floor_00" type="plane" size="5 5 1"/>
    <body name="stool_00" pos="0 2 .2"><freejoint/><geom type="cylinder" size=".15 .2" mass="2"/></body>
    <body name="sofa_00" pos="2 0 0" euler="0 0 90">
      <geom type="box" size=".4 .8 .2" pos="0 0 .2"/>
      <body name="cushion_00" pos="0 .3 .5"><geom type="box" size=".2 .2 .1"/></body>
      <body name="arm" pos="0 .8 .4"><geom type="box" size=".4 .1 .1"/></body>
    </body>
    <body name="plant_00" pos="-2 0 0">
      <geom name="leaf" type="sphere" size=".4" pos="0 0 .5" contype="0" conaffinity="0"/>
    </body>
    <geom name="artefact" type="box" size=".1 .1 .1" pos="-2 2 .1" group="3"/>
    <site name="room_living_00" type="box" size="5 5 1.25" pos="0 0 1.25"/>
  </worldbody>
</mujoco>
"""


def furnished() -> House:
    return House("furnished", mujoco.MjSpec.from_string(XML))


def where(world: World, instance: str) -> np.ndarray:
    """Returns the mean position of the geoms of an instance."""
    (found,) = [each for each in world.labels.instances if each.name == instance]
    return world.data.geom_xpos[list(found.geom_ids)].mean(axis=0)


def test_labels_survive_fusing():
    world = World(furnished())
    assert world.model.body("world").id == 0
    names = [world.model.body(i).name for i in range(world.model.nbody)]
    assert [name for name in names if not name.startswith("stubborn_robot/")] == ["world", "stool_00"]
    assert {each.name for each in world.labels.instances} == {
        "floor_00",
        "sofa_00",
        "cushion_00",
        "plant_00",
        "stool_00",
    }
    world.reset(ORIGIN)
    np.testing.assert_allclose(where(world, "cushion_00"), (1.7, 0.0, 0.5), atol=1e-9)
    np.testing.assert_allclose(where(world, "sofa_00"), (1.6, 0.0, 0.3), atol=1e-9)
    np.testing.assert_allclose(where(world, "plant_00"), (-2.0, 0.0, 0.5), atol=1e-9)
    for instance in world.labels.instances:
        for geom in instance.geom_ids:
            assert world.labels.geom_category[geom] == MPCAT40_ID[instance.category]
            assert world.labels.instances[world.labels.geom_instance[geom]] is instance


def test_the_robot_belongs_to_no_instance():
    world = World(furnished())
    robot = [i for i in range(world.model.ngeom) if world.model.geom(i).name.startswith("stubborn_robot/")]
    assert len(robot) == 6
    assert (world.labels.geom_instance[robot] == -1).all()
    assert (world.labels.geom_category[robot] == 0).all()


def test_every_geom_has_a_unique_name():
    world = World(furnished())
    names = [world.model.geom(i).name for i in range(world.model.ngeom)]
    assert all(names)
    assert len(set(names)) == len(names)


def test_collision_masks_depend_on_the_kind_of_geom():
    model = World(furnished()).model
    mask = {
        model.geom(i).name: (int(model.geom_contype[i]), int(model.geom_conaffinity[i])) for i in range(model.ngeom)
    }
    assert mask["floor_00"] == (1, 0)
    assert mask["leaf"] == (0, 0)
    assert mask["artefact"] == (2, 0)
    assert {m for name, m in mask.items() if name.startswith(("sofa", "cushion"))} == {(2, 0)}
    assert {m for name, m in mask.items() if name.startswith("stool")} == {(2, 7)}


def test_the_physics_options_of_a_house_are_replaced():
    option = World(furnished()).model.opt
    assert option.timestep == RobotConfig().physics.timestep_s
    np.testing.assert_array_equal(option.gravity, (0.0, 0.0, -9.81))
    assert option.density == 0.0
    assert option.enableflags & mujoco.mjtEnableBit.mjENBL_SLEEP
    assert option.disableflags & mujoco.mjtDisableBit.mjDSBL_MULTICCD


def test_no_option_of_the_file_remains():
    house = room()
    house.spec.option.tolerance, house.spec.option.ccd_iterations = 1.0, 1
    house.spec.option.disableactuator = 1
    option, plain = World(house).model.opt, World(room()).model.opt
    assert (option.tolerance, option.ccd_iterations) == (plain.tolerance, plain.ccd_iterations)
    assert option.disableactuator == 0


@pytest.mark.filterwarnings("ignore:compiler attribute 'settotalmass'")
@pytest.mark.parametrize("setting", ["settotalmass='50'", "discardvisual='true'", "inertiafromgeom='true'"])
def test_the_compiler_settings_of_a_house_change_neither_the_robot_nor_the_visual_geoms(setting):
    plain = World(furnished())
    world = World(House("set", mujoco.MjSpec.from_string(XML.replace("<option", f"<compiler {setting}/>\n<option"))))
    base = world.model.body("stubborn_robot/base").id
    assert world.model.body_subtreemass[base] == pytest.approx(RobotConfig().body.mass_kg)
    assert world.model.ngeom == plain.model.ngeom
    world.reset(ORIGIN)
    assert world.move(Action.MOVE_FORWARD).displacement_m == pytest.approx(0.25, abs=0.001)


def test_the_house_is_not_changed():
    house = furnished()
    before = house.spec.to_xml()
    World(house).reset(ORIGIN)
    assert house.spec.to_xml() == before


def test_reset_puts_the_robot_at_rest_at_the_start():
    world = World(room())
    start = Pose(0.7, -0.4, 2.5)
    world.reset(start)
    assert world.pose.distance_to(start) < 1e-6
    assert world.pose.yaw_rad == pytest.approx(2.5, abs=1e-6)
    assert np.abs(world.data.qvel).max() < 1e-3


@pytest.mark.parametrize("base", ["planar", "free"])
def test_each_storey_has_its_own_floor_height(base):
    house = with_box(room(), "floor_01", centre_m=(0, 0, 2.95), half_m=(2, 2, 0.05))
    world = World(house, robot=RobotConfig(base=base))
    world.reset(Pose(0.0, 0.0, 0.0, floor_z_m=3.0))
    assert world.pose.floor_z_m == pytest.approx(3.0)
    assert world.move(Action.MOVE_FORWARD).ended == "reached"
    assert world.pose.floor_z_m == pytest.approx(3.0)
    world.reset(ORIGIN)
    assert world.pose.floor_z_m == 0.0


def test_a_platform_is_a_level_whatever_the_rule_says_of_storeys():
    platform = with_box(open_floor(), "floor_01", centre_m=(0, 0, 0.25), half_m=(1, 1, 0.25))
    for same_storey_m in (1.0, 0.4):
        world = World(platform, rule=SuccessRule(same_storey_m=same_storey_m))
        world.reset(Pose(0.0, 0.0, 0.0, floor_z_m=0.5))
        assert world.pose.floor_z_m == 0.5


@pytest.mark.parametrize("shape", ["cylinder", "mesh"])
def test_the_top_of_a_floor_of_any_shape_is_a_level(shape: str):
    spec = room(6, 6, box_floor=True).spec.copy()
    if shape == "cylinder":
        spec.worldbody.add_geom(name="floor_01", type=mujoco.mjtGeom.mjGEOM_CYLINDER, pos=(0, 0, 0.2), size=(1, 0.2, 0))
    else:
        corners = [(x, y, 0.0) for x in (-1, 1) for y in (-1, 1)] + [(x, y, 0.4) for x in (-0.2, 1) for y in (-1, 0.3)]
        spec.add_mesh(name="stage", uservert=np.ravel(corners).tolist())
        spec.worldbody.add_geom(name="floor_01", type=mujoco.mjtGeom.mjGEOM_MESH, meshname="stage")
    assert World(House("stage", spec)).floor_levels_m == pytest.approx((0.0, 0.4), abs=1e-6)


def test_a_rug_is_not_a_storey():
    world = World(with_box(open_floor(), "floor_01", centre_m=(0, 0, 0.005), half_m=(0.5, 0.5, 0.005)))
    world.reset(ORIGIN)
    assert world.pose.floor_z_m == 0.0
    assert world.data.body("stubborn_robot/base").xpos[2] == pytest.approx(0.01, abs=0.001)


@pytest.mark.parametrize(
    ("start", "name"),
    [(Pose(1.9, 0.0, 0.0), "wall_00"), (Pose(0.0, 0.95, 0.0), "table_00"), (Pose(-1.0, -0.8, 0.0), "chair_00")],
)
def test_a_start_inside_an_object_is_refused_with_its_name(start, name):
    house = with_box(room(), "table_00", centre_m=(0, 1.2, 0.7), half_m=(0.4, 0.4, 0.02))
    world = World(with_movable(house, "chair_00", xy_m=(-1.0, -1.0)))
    with pytest.raises(EpisodeError, match=name):
        world.reset(start)


def test_a_start_that_just_fits_is_accepted():
    world = World(with_post(room(), "column_00", xy_m=(0.0, 0.0), radius_m=0.02))
    world.reset(Pose(0.2005, 0.0, 0.0))
    with pytest.raises(EpisodeError):
        world.reset(Pose(0.197, 0.0, 0.0))


def test_a_start_without_floor_is_refused():
    world = World(with_box(House("hole", mujoco.MjSpec()), "floor_00", centre_m=(0, 0, -0.05), half_m=(1, 1, 0.05)))
    world.reset(ORIGIN)
    with pytest.raises(EpisodeError, match="no floor"):
        world.reset(Pose(3.0, 0.0, 0.0))


def test_a_robot_that_drops_has_fallen():
    world = World(open_floor(), robot=RobotConfig(base="planar"))
    world.reset(ORIGIN)
    world.data.qpos[world.model.joint("stubborn_robot/z").qposadr[0]] = 1.0
    assert world.move(Action.MOVE_FORWARD).fell


def test_a_free_robot_on_its_side_has_tipped_over():
    world = World(open_floor(), robot=RobotConfig(base="free"))
    world.reset(ORIGIN)
    joint = world.model.joint("stubborn_robot/free").qposadr[0]
    world.data.qpos[joint + 2 : joint + 7] = (0.18, math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0)
    with pytest.raises(PhysicsError, match="tipped over"):
        world.move(Action.MOVE_FORWARD)


def test_nan_is_an_error_that_names_the_house_leaves_no_log_and_is_gone_after_reset(tmp_path: Path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    world = World(room())
    world.reset(ORIGIN)
    world.data.qvel[0] = np.nan
    with pytest.raises(PhysicsError, match="'room'"):
        world.move(Action.MOVE_FORWARD)
    assert list(tmp_path.iterdir()) == []  # MuJoCo would write MUJOCO_LOG.TXT
    world.reset(ORIGIN)
    assert world.move(Action.MOVE_FORWARD).ended == "reached"


def test_chairs_fall_asleep_and_wake_when_pushed():
    world = World(with_movable(with_movable(room(6, 6), "chair_00", xy_m=(0.7, 0.0)), "chair_01", xy_m=(-2.0, 2.0)))
    world.reset(ORIGIN)
    asleep = {name: world.model.body_treeid[world.model.body(name).id] for name in ("chair_00", "chair_01")}
    world.move(Action.TURN_LEFT)
    world.move(Action.TURN_RIGHT)
    assert all(world.data.tree_asleep[tree] >= 0 for tree in asleep.values())
    before = where(world, "chair_00").copy()
    for _ in range(3):
        world.move(Action.MOVE_FORWARD)
    assert where(world, "chair_00")[0] > before[0] + 0.1
    assert world.data.tree_asleep[asleep["chair_01"]] >= 0


def test_reset_puts_movables_back():
    world = World(with_movable(room(6, 6), "chair_00", xy_m=(0.7, 0.0)))
    world.reset(ORIGIN)
    before = where(world, "chair_00").copy()
    for _ in range(3):
        world.move(Action.MOVE_FORWARD)
    assert np.linalg.norm(where(world, "chair_00") - before) > 0.1
    world.reset(ORIGIN)
    np.testing.assert_array_equal(where(world, "chair_00"), before)


def obstacle_course() -> House:
    house = with_movable(cluttered_room(60, width_m=6.0), "chair_00", xy_m=(0.45, 0.05))
    return with_post(house, "column_00", xy_m=(-0.3, 0.3))


def fingerprint(world: World, seed: int) -> str:
    """Returns a hash of the states after each of 30 random actions."""
    rng = np.random.default_rng(seed)
    world.reset(Pose(0.0, 0.0, float(rng.uniform(-3, 3))))
    digest = hashlib.sha256()
    for action in map(Action, rng.choice([1, 1, 2, 3], size=30).tolist()):
        motion = world.move(action)
        digest.update(world.data.qpos.tobytes() + world.data.qvel.tobytes())
        digest.update(repr(motion).encode())
    return digest.hexdigest()


def test_the_same_actions_give_the_same_bits_whatever_ran_before():
    world = World(obstacle_course())
    first = fingerprint(world, 1)
    assert fingerprint(world, 2) != first
    with pytest.raises(EpisodeError):
        world.reset(Pose(2.95, 0.0, 0.0))
    assert fingerprint(world, 1) == first
    assert fingerprint(World(obstacle_course()), 1) == first


@pytest.mark.costly
def test_the_same_actions_give_the_same_bits_in_another_process():
    here = fingerprint(World(obstacle_course()), 1)
    code = "from tests.sim.world.test_world import *\nprint(fingerprint(World(obstacle_course()), 1))"
    root = Path(__file__).parents[3]
    answer = subprocess.run([sys.executable, "-c", code], cwd=root, capture_output=True, text=True, check=True)
    assert answer.stdout.strip() == here


@pytest.mark.parametrize("timestep_s", [0.002, 0.004])
def test_both_time_steps_drive_alike(timestep_s):
    world = World(room(), robot=RobotConfig(physics=PhysicsConfig(timestep_s=timestep_s)))
    world.reset(ORIGIN)
    assert world.move(Action.MOVE_FORWARD).displacement_m == pytest.approx(0.25, abs=0.001)
