"""A pose that is written into the bodies is the one that MuJoCo computes from the positions of the joints."""

from __future__ import annotations

import math

import mujoco
import numpy as np
import pytest

from sim.core.interface import ConfigError
from sim.houses.mjcf import orient_by_quaternions
from sim.robot.posing import pose_joints

ARM = """
<mujoco>
  <compiler angle="degree" eulerseq="zyx"/>
  <worldbody>
    <body name="base" pos="0.1 0.2 0.3" euler="10 20 30">
      <geom size="0.1"/>
      <frame pos="0.2 0 0.1" euler="0 40 0">
        <body name="shoulder" pos="0 0.1 0" axisangle="1 2 0 50">
          <joint name="lift" type="slide" axis="0 2 1" range="-0.2 0.4"/>
          <joint name="turn" axis="1 1 0" pos="0.05 -0.1 0.2" ref="15" range="-90 120"/>
          <joint name="roll" axis="0 0 3" pos="0 0 0.1"/>
          <geom size="0.1"/>
          <body name="hand" pos="0.3 0 0">
            <joint name="wrist" axis="0 1 0" pos="-0.1 0 0"/>
            <joint name="ball" type="ball"/>
            <geom size="0.1"/>
          </body>
        </body>
      </frame>
    </body>
  </worldbody>
</mujoco>
"""
POSE = {"lift": 0.15, "turn": 0.9, "roll": -1.3, "wrist": 2.0}


def arm() -> mujoco.MjSpec:
    """Returns an arm with a frame, anchors, a reference and axes of any length."""
    spec = mujoco.MjSpec.from_string(ARM)
    orient_by_quaternions(spec)
    return spec


@pytest.mark.parametrize("names", [("lift",), ("turn",), ("roll", "wrist"), tuple(POSE)])
def test_a_pose_is_that_of_mujocos_kinematics(names: tuple[str, ...]) -> None:
    moved, posed = arm().compile(), arm()
    pose_joints(posed, tuple((name, POSE[name]) for name in names))
    for joint in list(posed.joints):
        posed.delete(joint)
    fixed = posed.compile()
    expected, found = mujoco.MjData(moved), mujoco.MjData(fixed)
    for name in names:
        expected.joint(name).qpos[0] = POSE[name]
    mujoco.mj_forward(moved, expected)
    mujoco.mj_forward(fixed, found)
    for body in ("base", "shoulder", "hand"):
        np.testing.assert_allclose(found.body(body).xpos, expected.body(body).xpos, atol=1e-9)
        np.testing.assert_allclose(found.body(body).xmat, expected.body(body).xmat, atol=1e-9)


@pytest.mark.parametrize(
    ("name", "position", "sentence"),
    [
        ("elbow", 0.0, "'elbow'"),
        ("ball", 0.0, "'ball'"),
        ("lift", 0.5, r"'lift'.*\[-0.2.*0.4\].*0.5"),
        ("turn", math.radians(121.0), r"'turn'.*\[-1.571.*2.094\].*2.11"),
    ],
)
def test_a_joint_that_cannot_be_posed_is_refused(name: str, position: float, sentence: str) -> None:
    with pytest.raises(ConfigError, match=sentence):
        pose_joints(arm(), ((name, position),))
