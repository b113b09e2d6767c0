"""Robots of other kinds: four wheels, a body that is only visual, meshes beside the folder; and what is refused."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from sim.core.geometry.pose import Pose
from sim.core.interface import Action, ConfigError
from sim.env.objectnav import ObjectNavEnv
from sim.env.oracle import Oracle
from sim.gl import mujoco
from sim.robot.foreign import load_robot, robot_sha256
from sim.world.world import World
from tests.helpers.worlds import open_floor, with_box

WHEEL = '<joint name="hub_{0}" axis="0 {2} 0"/><geom type="cylinder" size="0.1 0.02" euler="90 0 0" mass="0.4"/>'
ROVER = """<mujoco><asset/><worldbody><body name="deck" pos="0 0 0.1"><freejoint/>
<geom {deck} pos="0 0 0.05" mass="12"/>{wheels}</body></worldbody></mujoco>"""
PLACES = {"fl": (0.13, 0.17), "rl": (-0.13, 0.17), "fr": (0.13, -0.17), "rr": (-0.13, -0.17)}


def rover(folder: Path, *, deck: str = 'type="box" size="0.2 0.14 0.06"', axis: int = 1, **sidecar: object) -> Path:
    """Writes a robot of four wheels, whose right joints turn about `axis` (1 or -1) times y."""
    wheels = "".join(
        f'<body pos="{x} {y} 0">{WHEEL.format(name, 0, axis if y < 0 else 1)}</body>' for name, (x, y) in PLACES.items()
    )
    file = folder / "mjcf" / "rover.xml"
    file.parent.mkdir(parents=True)
    file.write_text(ROVER.format(deck=deck, wheels=wheels))
    content = {"wheel_joints": ["hub_fl", "hub_rl", "hub_fr", "hub_rr"], "wheel_radius_m": 0.1} | sidecar
    file.with_suffix(".json").write_text(json.dumps(content))
    return file


@pytest.mark.parametrize("axis", [1, -1])
@pytest.mark.parametrize("deck", ['type="box" size="0.2 0.14 0.06"', 'size="0.1" contype="0" conaffinity="0"'])
def test_a_robot_of_four_wheels_drives_turns_about_its_middle_and_bumps(deck: str, axis: int, tmp_path: Path) -> None:
    cylinder = {"radius_m": 0.26, "height_m": 0.25}
    config, _ = load_robot(rover(tmp_path, deck=deck, axis=axis, **cylinder))
    house = with_box(open_floor(), "table_00", centre_m=(1.2, 0, 0.3), half_m=(0.2, 0.5, 0.3))
    world = World(house, robot=config)
    world.reset(Pose(-0.5, 0.0, 0.0))
    turns = [world.move(Action.TURN_LEFT) for _ in range(6)]
    assert world.pose.yaw_rad == pytest.approx(math.pi, abs=0.02)
    assert math.hypot(world.pose.x_m + 0.5, world.pose.y_m) < 0.02
    assert not any(motion.collided for motion in turns)
    world.reset(Pose(0.0, 0.0, 0.0))
    moved = [world.move(Action.MOVE_FORWARD) for _ in range(4)]
    assert [motion.collided for motion in moved][::3] == [False, True]
    assert world.pose.x_m == pytest.approx(1.0 - config.body.radius_m, abs=0.06)
    angles = {
        name: sign * float(world.data.joint(f"stubborn_robot/file/hub_{name}").qpos[0])
        for name, sign in (("fl", 1), ("rl", 1), ("fr", axis), ("rr", axis))
    }
    assert np.ptp(list(angles.values())) < 0.1  # all wheels turn together
    assert angles["fl"] == pytest.approx(world.pose.x_m / 0.1, rel=0.05)


def test_a_robot_of_four_wheels_finds_the_goal(house: Path, tmp_path: Path) -> None:
    env = ObjectNavEnv(house=house, goal="sofa", sensors=(), robot=load_robot(rover(tmp_path))[0])
    env.reset(seed=0)
    oracle = Oracle(env)
    oracle.reset("sofa", 0)
    over, info = False, dict[str, object]()
    while not over:
        _, _, terminated, truncated, info = env.step(oracle.act({}))
        over = terminated or truncated
    assert info["success"] == 1.0
    assert env.scene.task.metrics().collisions <= 1


def test_the_wheels_of_a_side_are_named_together(tmp_path: Path) -> None:
    for number, joints in enumerate(
        (["hub_fl", "hub_fr", "hub_rl", "hub_rr"], ["hub_fr", "hub_rr", "hub_fl", "hub_rl"])
    ):
        with pytest.raises(ConfigError, match="wheel_joints names the left ones first"):
            load_robot(rover(tmp_path / str(number), wheel_joints=joints))
    for number, joints in enumerate((["hub_fl", "hub_rl", "hub_fr"], ["hub_fl"] * 4, ["hub_fl"])):
        with pytest.raises(ConfigError, match="as many left ones and then right ones"):
            load_robot(rover(tmp_path / f"x{number}", wheel_joints=joints))


def test_a_visual_body_needs_the_size_of_its_cylinder(tmp_path: Path) -> None:
    visual = 'size="0.1" contype="0" conaffinity="0"'
    with pytest.raises(ConfigError, match="or radius_m and height_m in the sidecar"):
        load_robot(rover(tmp_path / "a", deck=visual, radius_m=0.26))
    config, _ = load_robot(rover(tmp_path / "b", deck=visual, radius_m=0.26, height_m=0.3))
    assert (config.body.radius_m, config.body.height_m) == (0.26, 0.3)


@pytest.mark.parametrize(
    ("radius_m", "fits"), [(1.0, False), (0.01, False), (0.07, False), (0.095, True), (0.11, True)]
)
def test_the_radius_of_wheels_is_that_of_their_geoms(radius_m: float, fits: bool, tmp_path: Path) -> None:
    file = rover(tmp_path, wheel_radius_m=radius_m, deck='type="box" size="0.2 0.14 0.02"')
    if fits:
        assert load_robot(file)[0].wheels.radius_m == radius_m
    else:
        with pytest.raises(ConfigError, match=f"wheel_radius_m in the sidecar is {radius_m:g} m, but .* about 0.1 m"):
            load_robot(file)


def test_a_slide_is_no_wheel(tmp_path: Path) -> None:
    file = rover(tmp_path)
    file.write_text(file.read_text().replace('<joint name="hub_fl"', '<joint name="hub_fl" type="slide"'))
    with pytest.raises(ConfigError, match="'hub_fl' is a slide, and wheels turn on hinges"):
        load_robot(file)


def rover_with_a_mesh(folder: Path, mesh: str) -> Path:
    """Writes a robot whose deck is a mesh at this path relative to the robot's file; the file does not name it yet."""
    file = rover(folder, deck='type="mesh" mesh="deck"')
    corners = [(x, y, z) for x in (-0.2, 0.2) for y in (-0.14, 0.14) for z in (-0.03, 0.05)]
    lines = [*("v {} {} {}".format(*corner) for corner in corners), "f 1 2 3", "f 4 3 2", "f 5 6 7", "f 8 7 6"]
    (file.parent / mesh).parent.mkdir(exist_ok=True)
    (file.parent / mesh).write_text("\n".join(lines))
    return file


def test_with_strippath_only_the_name_of_a_mesh_counts(tmp_path: Path) -> None:
    file = rover_with_a_mesh(tmp_path, "deck.obj")
    named = '<compiler strippath="true"/><asset><mesh name="deck" file="elsewhere/deck.obj"/></asset>'
    file.write_text(file.read_text().replace("<asset/>", named))
    World(open_floor(), robot=load_robot(file)[0]).reset(Pose(0.0, 0.0, 0.0))


def test_meshes_beside_the_folder_need_a_root(tmp_path: Path) -> None:
    file = rover_with_a_mesh(tmp_path, "../meshes/deck.obj")
    named = '<asset><mesh name="deck" file="../meshes/deck.obj"/></asset>'
    file.write_text(file.read_text().replace("<asset/>", named))
    with pytest.raises(ConfigError, match=r"outside of its folder.*--root"):
        load_robot(file)
    config, _ = load_robot(file, root=tmp_path)
    world = World(open_floor(), robot=config)
    world.reset(Pose(0.0, 0.0, 0.0))
    assert not world.move(Action.MOVE_FORWARD).collided
    assert int(mujoco.mjtGeom.mjGEOM_MESH) in world.model.geom_type
    before = robot_sha256(file, root=tmp_path)
    mesh = tmp_path / "meshes" / "deck.obj"
    mesh.write_text(mesh.read_text().replace("-0.03", "-0.02"))
    assert robot_sha256(file, root=tmp_path) != before
