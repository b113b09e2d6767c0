"""Robots and houses stand as MuJoCo alone computes them, however their files give orientations."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sim.core.geometry.pose import Pose
from sim.gl import mujoco
from sim.houses.geoms import data_at_rest
from sim.houses.load import load_house
from sim.robot.foreign import load_robot
from sim.world.world import World

angle = st.floats(-170.0, 170.0).map(lambda value: round(value, 1))
coordinate = st.sampled_from((-0.9, -0.4, 0.1, 0.7, 1.0))
vector = st.tuples(coordinate, coordinate, coordinate)


@st.composite
def compilers(draw: st.DrawFn) -> str:
    """A compiler element, with `angle` in either unit and any sequence of axes."""
    sequence = draw(st.sampled_from(("xyz", "XYZ", "ZYX", "zyx", "YXZ", "zxz")))
    unit = draw(st.sampled_from(('angle="degree"', 'angle="radian"', "")))
    return f'<compiler {unit} eulerseq="{sequence}"/>'


@st.composite
def orientations(draw: st.DrawFn, degree: bool) -> str:
    """An orientation attribute of any kind."""
    scale = 1.0 if degree else np.pi / 180.0
    kind = draw(st.sampled_from(("euler", "axisangle", "zaxis", "xyaxes", "quat", "none")))
    x, y, z = draw(vector)
    if kind == "euler":
        values = [draw(angle) * scale for _ in range(3)]
    elif kind == "axisangle":
        values = [x, y, z, draw(angle) * scale]
    elif kind == "zaxis":
        values = [x, y, z]
    elif kind == "xyaxes":
        values = [x, y, z, -y, x, 0.3]  # not parallel: (x, y) and (-y, x) are orthogonal in the plane
    elif kind == "quat":
        values = [0.5, x, y, z]
    else:
        return ""
    return f'{kind}="{" ".join(f"{value:.5f}" for value in values)}"'


@st.composite
def parts(draw: st.DrawFn, stem: str, degree: bool, size: float) -> str:
    """A body inside a frame inside a body, each with an orientation, with one geom each."""
    turn = orientations(degree)
    geoms = [
        f'<geom name="{stem}{i}" type="box" size="{size} {size} {size}" pos=".02 .01 0" {draw(turn)}' for i in (0, 1)
    ]
    return (
        f'<body name="{stem}" pos="0 0 .3" {draw(turn)}>{geoms[0]}/><frame pos="0 .01 0" {draw(turn)}>'
        f'<body name="{stem}_in" pos="{2 * size} 0 0" {draw(turn)}>{geoms[1]}/></body></frame></body>'
    )


@st.composite
def robots(draw: st.DrawFn) -> str:
    compiler = draw(compilers())
    wheels = "".join(
        f'<body name="w{side}" pos="0 {y} 0"><joint name="j{side}" type="hinge" axis="0 1 0"/>'
        '<geom type="cylinder" size=".08 .015" quat=".707107 .707107 0 0" mass=".3"/></body>'
        for side, y in (("l", 0.14), ("r", -0.14))
    )
    return (
        f'<mujoco>{compiler}<worldbody><body name="bot" pos="0 0 .08"><freejoint/>'
        '<geom name="deck" type="cylinder" size=".15 .1" pos="0 0 .12" mass="8"/>'
        f"{draw(parts('arm', degree='radian' not in compiler, size=0.02))}{wheels}</body></worldbody></mujoco>"
    )


@st.composite
def houses(draw: st.DrawFn) -> str:
    compiler = draw(compilers())
    walls = "".join(
        f'<geom name="wall_{i}" type="box" size="{size}" pos="{pos}"/>'
        for i, (size, pos) in enumerate((("3 .05 1", "0 2.5 1"), ("3 .05 1", "0 -2.5 1"), (".05 2.5 1", "3 0 1")))
    )
    return (
        f'<mujoco>{compiler}<worldbody><geom name="floor_0" type="plane" size="3 2.5 .1"/>{walls}'
        f'<body name="sofa_00" pos="2 0 .5">{draw(parts("chair_0", degree="radian" not in compiler, size=0.1))}</body>'
        "</worldbody></mujoco>"
    )


def _poses(model: mujoco.MjModel, names: list[str], base: str | None = None) -> np.ndarray:
    """Returns the rotation and position of geoms, relative to a body or to the world; (n, 12)."""
    data = data_at_rest(model)
    turn, origin = np.eye(3), np.zeros(3)
    if base is not None:
        turn, origin = data.body(base).xmat.reshape(3, 3).copy(), data.body(base).xpos.copy()
    return np.array(
        [
            np.concatenate(
                [(turn.T @ data.geom(name).xmat.reshape(3, 3)).ravel(), turn.T @ (data.geom(name).xpos - origin)]
            )
            for name in names
        ]
    )


@pytest.mark.costly
@settings(max_examples=40, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(house=houses(), robot=robots())
def test_every_geom_stands_where_mujoco_alone_puts_it(tmp_path: Path, house: str, robot: str) -> None:
    (tmp_path / "house.xml").write_text(house)
    (tmp_path / "robot.xml").write_text(robot)
    (tmp_path / "robot.json").write_text(json.dumps({"wheel_joints": ["jl", "jr"], "wheel_radius_m": 0.08}))
    world = World(load_house(tmp_path / "house.xml"), robot=load_robot(tmp_path / "robot.xml")[0])
    world.reset(Pose(0.0, 0.0, 0.0))
    furniture = ["chair_00", "chair_01"]
    alone = mujoco.MjModel.from_xml_string(house)
    np.testing.assert_allclose(_poses(world.model, furniture), _poses(alone, furniture), atol=1e-5)
    alone, body = mujoco.MjModel.from_xml_string(robot), ["deck", "arm0", "arm1"]
    theirs = _poses(world.model, [f"stubborn_robot/file/{name}" for name in body], "stubborn_robot/base")
    theirs -= theirs[0] * (np.arange(12) >= 9)  # the base's origin is on the floor: compare with the deck
    ours = _poses(alone, body, "bot")
    np.testing.assert_allclose(theirs, ours - ours[0] * (np.arange(12) >= 9), atol=1e-5)
