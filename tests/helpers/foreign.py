"""A scene and a robot in a style that differs from ours: meshes, textures, class defaults, nested bodies, degrees."""

from __future__ import annotations

import json
from pathlib import Path

import cv2
import numpy as np

CUBE = """
v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1
f 1 3 2\nf 1 4 3\nf 5 6 7\nf 5 7 8\nf 1 2 6\nf 1 6 5\nf 2 3 7\nf 2 7 6\nf 3 4 8\nf 3 8 7\nf 4 1 5\nf 4 5 8
"""
"""A Wavefront file: a box of 2 x 2 x 2."""
ARCH = (
    "\n".join(f"v {x} {y} {z}" for y in (0, 0.1) for x, z in ((0, 0), (0.3, 0), (0.3, 2), (1.3, 2), (1.3, 0), (1.6, 0)))
    + "\n"
    + "\n".join(f"v {x} {y} 2.5" for y in (0, 0.1) for x in (0, 1.6))
    + "\nf 1 2 3\nf 1 3 13\nf 3 4 14\nf 3 14 13\nf 4 5 6\nf 4 6 14\nf 9 8 7\nf 15 9 7\nf 16 10 9\nf 15 16 9\nf 12 11 10"
    + "\nf 16 12 10\nf 2 8 9\nf 2 9 3\nf 3 9 10\nf 3 10 4\nf 4 10 11\nf 4 11 5\nf 1 13 15\nf 1 15 7"
    + "\nf 6 12 16\nf 6 16 14\n"
)
"""A wall with a doorway of 1.0 x 2.0 m in it, in one mesh: its convex hull has no doorway."""

SCENE = """
<mujoco model="flat">
  <compiler angle="degree" meshdir="meshes" texturedir="textures" autolimits="true" inertiafromgeom="true"/>
  <option timestep="0.002" gravity="0 0 -9.8" integrator="RK4"/>
  <size nkey="1"/>
  <visual><global offwidth="320" offheight="240"/><map znear="0.5"/></visual>
  <include file="assets.xml"/>
  <default>
    <geom condim="4" friction="0.8 0.01 0.001"/>
    <default class="visual"><geom contype="0" conaffinity="0" group="2" mass="0"/></default>
    <default class="collision"><geom group="3"/></default>
    <default class="plaster"><geom type="box" rgba="0.9 0.9 0.85 1"/></default>
    <default class="prop"><joint type="free" damping="0.01"/></default>
  </default>
  <worldbody>
    <light name="sun" type="directional" dir="0 0.3 -1" castshadow="true"/>
    <light name="lamp a" pos="-1.5 0 2.4" dir="0 0 -1"/>
    <light name="lamp b" pos="2 0 2.4" dir="0 0 -1" active="false"/>
    <camera name="overview" pos="0 0 9"/>
    <geom name="Ground" type="plane" size="8 8 0.1" material="parquet"/>
    <body name="Shell">
      <geom name="Shell.N" class="plaster" size="3.2 0.1 1.25" pos="0 2.1 1.25"/>
      <geom name="Shell.S" class="plaster" size="3.2 0.1 1.25" pos="0 -2.1 1.25"/>
      <geom name="Shell.E" class="plaster" size="0.1 2 1.25" pos="3.1 0 1.25"/>
      <geom name="Shell.W" class="plaster" size="0.1 2 1.25" pos="-3.1 0 1.25"/>
      <body name="Arch" pos="0.05 -0.8 0" euler="0 0 90">
        <geom name="Arch.look" class="visual" type="mesh" mesh="arch"/>
        <geom class="collision" type="box" size="0.15 0.05 1.25" pos="0.15 0.05 1.25"/>
        <geom class="collision" type="box" size="0.15 0.05 1.25" pos="1.45 0.05 1.25"/>
      </body>
      <geom name="Shell.between" class="plaster" size="0.05 0.6 1.25" pos="0 1.4 1.25"/>
      <geom name="Shell.between2" class="plaster" size="0.05 0.6 1.25" pos="0 -1.4 1.25"/>
    </body>
    <body name="Couch.001" pos="2.2 1 0" euler="0 0 180">
      <body name="Couch.001_base"><geom class="visual" type="mesh" mesh="couch" material="fabric"/>
        <geom class="collision" type="mesh" mesh="couch"/></body>
      <body name="Pillow.A" pos="0 0.2 0.5"><geom type="ellipsoid" size="0.2 0.1 0.15"/></body>
    </body>
    <body name="Sideboard" pos="-2.7 -1 0.4">
      <geom type="box" size="0.25 0.6 0.4"/>
      <body name="Sideboard_door" pos="0.27 -0.6 0">
        <joint name="sideboard_hinge" type="hinge" axis="0 0 1" range="0 110"/>
        <geom type="box" size="0.01 0.3 0.38" pos="0 0.3 0"/>
      </body>
    </body>
    <body name="Stool_7" pos="-1.5 1.2 0.23"><joint class="prop"/>
      <geom type="cylinder" size="0.17 0.02" pos="0 0 0.2"/><geom type="cylinder" size="0.03 0.2"/>
    </body>
    <body name="Ball_3" pos="1 -1.2 0.11"><freejoint/><geom type="sphere" size="0.1" mass="0.4"/></body>
    <body name="Gadget" pos="2.8 -1.6 0.2"><geom name="Gadget.box" type="box" size="0.1 0.1 0.2"/>
      <geom name="Gadget.hit" class="collision" size="0.1"/></body>
    <body name="Widget" pos="2.8 -1.2 0.2"><geom type="capsule" size="0.05 0.1"/></body>
  </worldbody>
  <actuator><motor name="open" joint="sideboard_hinge"/></actuator>
  <sensor><jointpos joint="sideboard_hinge"/></sensor>
  <keyframe><key name="home" qpos="0  -1.5 1.2 0.23 1 0 0 0  1 -1.2 0.11 1 0 0 0"/></keyframe>
</mujoco>
"""
ASSETS = """
<mujocoinclude>
  <asset>
    <mesh name="couch" file="cube.obj" scale="0.4 0.8 0.35" refpos="0 0 -1"/>
    <mesh name="arch" file="arch.obj"/>
    <texture name="wood" type="2d" file="wood.png"/>
    <texture name="sky" type="skybox" builtin="gradient" rgb1="0.3 0.5 0.7" rgb2="0 0 0" width="32" height="32"/>
    <material name="parquet" texture="wood" texrepeat="4 4" reflectance="0.1"/>
    <material name="fabric" rgba="0.4 0.3 0.6 1"/>
  </asset>
</mujocoinclude>
"""
LABELS = {
    "^Ground$": "floor",
    r"^Shell\.": "wall",
    "^Arch": "wall",
    r"^Couch\.\d+$": "sofa",
    r"^Pillow": "cushion",
    "^Sideboard": "cabinet",
    r"^Stool_\d+$": "stool",
    r"^Ball": "objects",
}
"""Gadget and Widget are left without a label."""


TRAP = {"goal": "sofa", "start": {"x_m": 1.0, "y_m": 2.5, "yaw_rad": 0.0}, "zone_m": [2.0, 1.0, 4.0, 4.0]}
"""A sidecar of the example house."""


def write_trap(folder: Path, name: str = "pane") -> Path:
    """Writes the example house with a sidecar that fixes start and goal; returns the path of the house."""
    folder.mkdir(parents=True, exist_ok=True)
    house = folder / f"{name}.xml"
    house.write_bytes((Path(__file__).parents[2] / "examples" / "my_house.xml").read_bytes())
    house.with_suffix(".json").write_text(json.dumps(TRAP))
    return house


def write_scene(folder: Path, *, scene: str = SCENE, labels: dict[str, str] | None = None) -> tuple[Path, Path]:
    """Writes the scene and its label rules with all files that they need; returns both paths."""
    (folder / "meshes").mkdir(parents=True)
    (folder / "textures").mkdir()
    (folder / "meshes" / "cube.obj").write_text(CUBE)
    (folder / "meshes" / "arch.obj").write_text(ARCH)
    cv2.imwrite(
        str(folder / "textures" / "wood.png"), np.tile(np.array([[[40, 80, 140], [60, 110, 170]]], np.uint8), (8, 4, 1))
    )
    (folder / "assets.xml").write_text(ASSETS)
    (folder / "flat.xml").write_text(scene)
    (folder / "labels.json").write_text(json.dumps(LABELS if labels is None else labels))
    return folder / "flat.xml", folder / "labels.json"


ROBOT = """
<mujoco model="carrier">
  <compiler angle="degree" meshdir="parts" eulerseq="zyx"/>
  <option timestep="0.001"/>
  <asset><mesh name="deck" file="cube.obj" scale="0.14 0.12 0.05"/></asset>
  <default>
    <default class="wheel">
      <geom type="cylinder" size="0.075 0.02" euler="0 0 0" mass="0.5" friction="1.5 0.01 0.01" rgba="0.1 0.1 0.1 1"/>
      <joint type="hinge" axis="0 0 1" damping="0.02"/>
    </default>
  </default>
  <worldbody>
    <light pos="0 0 3"/>
    <geom name="ground" type="plane" size="3 3 0.1"/>
    <body name="chassis" pos="0.4 0.1 0.075">
      <freejoint name="root"/>
      <geom name="deck" type="mesh" mesh="deck" pos="0.02 0 0.06" mass="9"/>
      <camera name="front" pos="0.1 0 0.1"/>
      <body name="wheel_l" pos="0 0.15 0" euler="0 0 -90">
        <joint name="hub_l" class="wheel"/><geom class="wheel"/>
      </body>
      <body name="wheel_r" pos="0 -0.15 0" euler="0 0 90">
        <joint name="hub_r" class="wheel"/><geom class="wheel"/>
      </body>
      <geom name="castor" type="sphere" size="0.03" pos="-0.12 0 -0.045" mass="0.1"/>
      <body name="mast" pos="0 0 0.1">
        <geom type="capsule" fromto="0 0 0 0 0 0.6" size="0.03" mass="1.5"/>
        <body name="head" pos="0 0 0.65"><joint name="pan" type="hinge" axis="0 0 1" range="-90 90"/>
          <geom type="box" size="0.05 0.08 0.05" mass="0.8"/>
        </body>
      </body>
    </body>
  </worldbody>
  <actuator>
    <motor name="ml" joint="hub_l"/><motor name="mr" joint="hub_r"/><position name="look" joint="pan"/>
  </actuator>
  <keyframe><key qpos="0.4 0.1 0.075 1 0 0 0 0 0 0"/></keyframe>
</mujoco>
"""
TWO_BODIES = """
<mujoco><worldbody>
  <body pos="0 0.1 0.1"><joint name="hub_l" axis="0 1 0"/><geom size="0.05"/></body>
  <body pos="0 -0.1 0.1"><joint name="hub_r" axis="0 1 0"/><geom size="0.05"/></body>
</worldbody></mujoco>
"""
HOLLOW = """</default>
    <geom contype="0" conaffinity="0"/>
  </default>"""
"""In place of the end of the robot's defaults: nothing of it collides."""
SIDECAR = {"wheel_joints": ["hub_l", "hub_r"], "wheel_radius_m": 0.075, "casters": ["castor"], "camera_height_m": 0.82}


def write_robot(folder: Path, *, robot: str = ROBOT, **sidecar: object) -> Path:
    """Writes the robot's file, its parts and its sidecar; a value of None removes the sidecar's entry."""
    (folder / "parts").mkdir(parents=True)
    (folder / "parts" / "cube.obj").write_text(CUBE)
    (folder / "carrier.xml").write_text(robot)
    content = {key: value for key, value in {**SIDECAR, **sidecar}.items() if value is not None}
    (folder / "carrier.json").write_text(json.dumps(content))
    return folder / "carrier.xml"
