"""A kitchen in RoboCasa's format, written here by its rules: named fixtures, a robot, geoms that only collide."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

LARGE_PX = 300


def fixture(name: str, size: str, at: str, inside: str = "", *, group: int = 3) -> str:
    """Returns the body of a fixture: a collision geom, a visible one and what else is in it."""
    return (
        f'<body name="{name}" pos="{at}"><geom name="{name}_g0" type="box" size="{size}" group="{group}"/>'
        f'<geom name="{name}_g0_vis" type="box" size="{size}" group="1" contype="0" conaffinity="0" material="wood"/>'
        f"{inside}</body>"
    )


ROBOT = """<body name="robot0_base" pos="2 -2 0"><geom name="robot0_foot" size=".3" pos="0 0 .3"/>
<body name="robot0_link1" pos="0 0 .6"><joint name="robot0_joint1"/><geom name="robot0_g" size=".1"/>
<body name="gripper0_right_hand"><geom name="hand" size=".05"/></body></body></body>"""
DOOR = """<body name="cab_1_main_group_door_main"><joint name="cab_1_hinge" range="0 1.5"/>
<geom name="cab_1_main_group_door" type="box" size=".2 .01 .4" pos="0 -.2 0" group="1" contype="0"/></body>"""
SPECK = '<geom name="counter_base" type="box" size=".01 .01 .01" pos="0 0 10" rgba="0 0 0 0"/>'
FIXTURES = "".join((
    fixture("wall_room_main", "2.04 .02 1.5", "2 .02 1.5"),
    fixture("wall_left_room_main", ".02 2 1.5", "-.02 -2 1.5"),
    fixture("floor_room_main", "2.04 2.02 .02", "2 -2 -.02"),
    fixture("counter_main_main_group_main", "1 .3 .45", "1.2 -.32 .45", SPECK, group=0),
    fixture("stack_1_main_group_1_main", ".3 .3 .4", "2.6 -.32 .4"),
    fixture("cab_1_main_group_main", ".2 .2 .4", ".4 -.2 1.9", DOOR),
    fixture("fridge_main_group_main", ".4 .35 .9", "3.5 -.37 .9"),
    '<body name="gadget"><geom type="box" size=".1 .1 .1" pos="3.5 -1 .1"/></body>',
))  # fmt: skip
OBJECT = fixture("distr_counter_main", ".05 .05 .05", "1 -.4 .951", "<freejoint/>")


def write_kitchen(folder: Path, *, name: str = "kitchen", fixtures: str = FIXTURES, robot: str = ROBOT) -> Path:
    """Writes `scenes/<name>.xml` and the texture in `assets` that it uses; returns the file of the kitchen."""
    for part in ("scenes", "assets"):
        (folder / part).mkdir(parents=True, exist_ok=True)
    cv2.imwrite(str(folder / "assets" / "wood.png"), np.full((LARGE_PX, LARGE_PX // 2, 3), 90, np.uint8))
    drives = (
        '<actuator><motor joint="robot0_joint1"/></actuator><contact><exclude body1="robot0_base" '
        'body2="robot0_link1"/></contact><sensor><jointpos joint="robot0_joint1"/></sensor>'
    )
    file = folder / "scenes" / f"{name}.xml"
    file.write_text(
        '<mujoco model="kitchen"><compiler angle="radian"/><asset>'
        '<texture name="wood" type="2d" file="../assets/wood.png"/><material name="wood" texture="wood"/>'
        '<texture name="unused" type="2d" file="../assets/wood.png"/><material name="unused" texture="unused"/></asset>'
        f'<worldbody><light pos="2 -2 3"/><body name="kitchen">{fixtures}</body>{OBJECT}{robot}</worldbody>'
        f"{drives if robot else ''}</mujoco>"
    )
    return file
