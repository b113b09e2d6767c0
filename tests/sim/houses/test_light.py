"""Scenes without light of their own get some; others keep theirs."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from sim.core.geometry.pose import Pose
from sim.core.interface import CameraModel
from sim.env.scene import Scene
from sim.houses.load import load_house
from sim.robot.config import RobotConfig

BARE = """<mujoco>{head}<worldbody>{lamp}
<geom name="floor_00" type="plane" size="3 2.5 .1"/>
<geom name="wall_00" type="box" pos="0 2.5 1.25" size="3 .05 1.25"/>
<geom name="wall_01" type="box" pos="0 -2.5 1.25" size="3 .05 1.25"/>
<geom name="wall_02" type="box" pos="3 0 1.25" size=".05 2.5 1.25"/>
<geom name="wall_03" type="box" pos="-3 0 1.25" size=".05 2.5 1.25"/>
</worldbody></mujoco>"""


def written(folder: Path, *, head: str = "", lamp: str = "") -> Path:
    file = folder / "bare.xml"
    file.write_text(BARE.format(head=head, lamp=lamp))
    return file


def test_a_bare_grey_room_is_bright_at_every_heading(tmp_path: Path) -> None:
    house = load_house(written(tmp_path))
    scene = Scene(house, robot=RobotConfig(), camera=CameraModel(width_px=80, height_px=60), profile="fast")
    levels = [
        scene.camera.render(scene.world.data, Pose(0.0, 0.0, k * math.pi / 4), ("rgb",))["rgb"].mean() for k in range(8)
    ]
    scene.close()
    assert min(levels) >= 60.0
    (note,) = house.notes
    assert note.startswith("Added light")


@pytest.mark.parametrize(
    "own", [{"lamp": '<light pos="0 0 2"/>'}, {"head": '<visual><headlight ambient=".4 .4 .4"/></visual>'}]
)
def test_a_scene_with_light_keeps_it(tmp_path: Path, own: dict[str, str]) -> None:
    house = load_house(written(tmp_path, **own))
    assert house.notes == ()
    assert len(house.spec.lights) == len(own.get("lamp", "")[:1])
