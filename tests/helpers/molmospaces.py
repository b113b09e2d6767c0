"""A house of two rooms in MolmoSpaces' format, written here by its rules."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

OBJECTS = {
    "bed_0f3a_1_0_3": "Bed",
    "armchair_77aa_1_0_2": "ArmChair",
    "doorway_d00d_1_0_2": "Doorway",
    "thing_1b_1_0_2": "Gizmo",
}
FLOOR_M = 0.043
CORNERS = "v {x0} {z} 0\nv {x1} {z} 0\nv {x1} {z} 4\nv {x0} {z} 4\n"
FACES = "132 143 567 578 126 165 348 387 237 276 415 458"
"""Triangles of a plate between two quadrilaterals."""


def box(name: str, size: str, at: str, inside: str = "") -> str:
    """Returns a body with a visual and a collision geom, in MolmoSpaces' classes, 4.3 cm above z = 0."""
    x, y, z = map(float, at.split())
    return (
        f'<body name="{name}" pos="{x} {y} {z + FLOOR_M}"><geom class="seen" type="box" size="{size}"/>'
        f'<geom class="hit" type="box" size="{size}"/>{inside}</body>'
    )


def plate(x0: float, x1: float) -> str:
    """Returns the OBJ file of a floor 4 m long and 1 cm thick, its top at y = 0; y points up."""
    faces = "".join("f " + " ".join(face) + "\n" for face in FACES.split())
    return CORNERS.format(x0=x0, x1=x1, z=0) + CORNERS.format(x0=x0, x1=x1, z=-0.01) + faces


def write_scene(folder: Path, *, name: str = "train_1", objects: Any = None) -> Path:
    """Writes a house of two rooms with a door between them, at x = 4, y = 1.5 to 2.5; returns its file."""
    (folder / f"{name}_assets").mkdir(parents=True, exist_ok=True)
    for room, x0 in (("room_2", 0), ("room_3", 4)):
        (folder / f"{name}_assets" / f"{room}.obj").write_text(plate(x0, x0 + 4))
    leaf = (
        '<body name="doorway_d00d_1_1_2" pos="0 -.5 0"><joint type="hinge" axis="0 0 1" range="0 1.57"/>'
        '<geom class="seen" type="box" size=".02 .45 1" pos="0 .45 0"/>'
        '<geom class="hit" type="box" size=".02 .45 1" pos="0 .45 0"/></body>'
    )
    bodies = [
        box("wall_2_0", ".05 2 1.25", "0 2 1.25"), box("wall_3_1", ".05 2 1.25", "8 2 1.25"),
        box("wall_2_2", "4 .05 1.25", "4 0 1.25"), box("wall_3_3", "4 .05 1.25", "4 4 1.25"),
        box("wall_2_4", ".05 .75 1.25", "4 .75 1.25"), box("wall_2_5", ".05 .75 1.25", "4 3.25 1.25"),
        box("bed_0f3a_1_0_3", "1 .8 .3", "7 1 .3"), box("thing_1b_1_0_2", ".1 .1 .1", "3 3.5 .1"),
        box("armchair_77aa_1_0_2", ".4 .4 .4", "1 3.2 .402", "<freejoint/>"),
        box("doorway_d00d_1_0_2", ".03 .02 .02", "4 2 1.05", leaf),
    ]  # fmt: skip
    rooms = "".join(
        f'<body name="{room}" pos="0 0 {FLOOR_M}">'
        f'<geom class="seen" quat=".707107 .707107 0 0" type="mesh" mesh="{room}"/></body>'
        for room in ("room_2", "room_3")
    )
    meshes = "".join(
        f'<mesh name="{room}" file="{name}_assets/{room}.obj" scale="1 1 -1"/>' for room in ("room_2", "room_3")
    )
    (folder / f"{name}.xml").write_text(
        '<mujoco><compiler angle="radian"/><default>'
        '<default class="seen"><geom contype="0" conaffinity="0"/></default>'
        '<default class="hit"><geom contype="8" conaffinity="15" group="4"/></default></default>'
        f"<asset>{meshes}</asset>"
        f'<worldbody><geom name="floor" class="hit" type="plane" size="0 0 .01" pos="0 0 {FLOOR_M}"/>'
        '<light pos="1 1 2"/>'
        f"{rooms}{''.join(bodies)}</worldbody></mujoco>"
    )
    listed = objects if objects is not None else {name: {"category": kind} for name, kind in OBJECTS.items()}
    (folder / f"{name}_metadata.json").write_text(json.dumps({"objects": listed}))
    return folder / f"{name}.xml"
