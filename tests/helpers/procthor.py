"""A small house in ProcTHOR's format and the database of its assets, written here by the rules of the format.

From above, with x to the right and z upwards (metres):

      0    3   5     9
    6 +----+
      | A  |                A: living room, L-shaped, 26 m2
    4 |    +---+-----+      B: bedroom, 16 m2
      |        D  B  W      D: a door, 2.5 to 3.5 along z; W: a window, 1 to 2 along z
      |        |     |
    0 +--E-----+-----+      E: the front door, 1 to 2 along x
"""

from __future__ import annotations

import gzip
import json
from pathlib import Path
from typing import Any

LOWER, UPPER = 0.0, 2.6
ASSETS = {
    "Sofa": [{"assetId": "Sofa_1", "boundingBox": {"x": 2.0, "y": 0.8, "z": 0.9}}],
    "TVStand": [{"assetId": "TV_Stand_1", "boundingBox": {"x": 1.2, "y": 0.5, "z": 0.4}}],
    "Television": [{"assetId": "Television_1", "boundingBox": {"x": 0.9, "y": 0.6, "z": 0.2}}],
    "Bed": [{"assetId": "Bed_1", "boundingBox": {"x": 1.5, "y": 0.9, "z": 2.1}}],
    "Painting": [{"assetId": "Painting_1", "boundingBox": {"x": 0.8, "y": 0.5, "z": 0.03}}],
    "Fridge": [{"assetId": "Fridge_1", "boundingBox": {"x": 0.7, "y": 1.7, "z": 0.7}}],
    "Apple": [{"assetId": "Apple_1", "boundingBox": {"x": 0.1, "y": 0.1, "z": 0.1}}],
    "CounterTop": [{"assetId": "Countertop_L_6x6", "boundingBox": {"x": 1.83, "y": 0.94, "z": 1.83}}],
    "Gizmo": [{"assetId": "Gizmo_1", "boundingBox": {"x": 0.3, "y": 0.3, "z": 0.3}}],
}


def wall(
    room: str, first: tuple[float, float], second: tuple[float, float], *, top_first: bool = False
) -> dict[str, Any]:
    """Returns a wall from one corner of a room to the next."""
    corners = [{"x": x, "y": y, "z": z} for y in (LOWER, UPPER) for x, z in (first, second)]
    return {
        "id": f"wall|{room}|{first}|{second}",
        "roomId": room,
        "polygon": corners[2:] + corners[:2] if top_first else corners,
    }


def entity(
    asset: str, name: str, position: tuple[float, float, float], turn_deg: float = 0.0, **more: Any
) -> dict[str, Any]:
    """Returns an object whose box has its middle at a position."""
    x, y, z = position
    rotation = {"x": 0.0, "y": turn_deg, "z": 0.0}
    return {
        "assetId": asset,
        "id": name,
        "position": {"x": x, "y": y, "z": z},
        "rotation": rotation,
        "kinematic": True,
        **more,
    }


def hole(
    name: str, of_wall: dict[str, Any], along: tuple[float, float], upwards: tuple[float, float], **more: Any
) -> dict[str, Any]:
    """Returns a door or a window."""
    corners = [{"x": x, "y": y, "z": 0.0} for x, y in zip(along, upwards, strict=True)]
    return {"id": name, "wall0": of_wall["id"], "wall1": "", "room0": of_wall["roomId"], "holePolygon": corners, **more}


def small_house() -> dict[str, Any]:
    """Returns the house of the drawing above."""
    a = [(0.0, 0.0), (0.0, 6.0), (3.0, 6.0), (3.0, 4.0), (5.0, 4.0), (5.0, 0.0)]
    b = [(5.0, 0.0), (5.0, 4.0), (9.0, 4.0), (9.0, 0.0)]
    walls = [
        wall(name, p, q) for name, room in (("A", a), ("B", b)) for p, q in zip(room, [*room[1:], room[0]], strict=True)
    ]
    between, front, east = (
        walls[4],
        walls[5],
        walls[8],
    )  # from (5, 4) down to (5, 0); from (5, 0) to (0, 0); (9, 4) to (9, 0)
    walls.append(wall("exterior", (9.0, 0.0), (9.0, 4.0), top_first=True))
    rooms = [
        {"id": name, "roomType": kind, "floorMaterial": {"name": "WoodGrains"},
         "floorPolygon": [{"x": x, "y": 0.0, "z": z} for x, z in room]}
        for name, kind, room in (("A", "LivingRoom", a), ("B", "Bedroom", b))
    ]  # fmt: skip
    television = entity("Television_1", "Television|1", (2.0, 0.8, 5.75), 180.0, kinematic=False)
    apple = entity("Apple_1", "Apple|1", (3.5, 1.0, 0.4))
    return {
        "rooms": rooms,
        "walls": walls,
        "doors": [
            hole("door|A|B", between, (0.5, 1.5), (0.0, 2.1), assetId="Doorway_1", openness=0.0),
            hole("door|A", front, (3.0, 4.0), (0.0, 2.1), assetId="Doorway_2"),
        ],
        "windows": [hole("window|B", east, (2.0, 3.0), (0.9, 1.9), assetId="Window_1")],
        "objects": [
            entity("Sofa_1", "Sofa|1", (0.48, 0.4, 2.5), 90.0),
            entity("TV_Stand_1", "TVStand|1", (2.0, 0.25, 5.75), 180.0, children=[television]),
            entity("Fridge_1", "Fridge|1", (3.5, 0.85, 0.4), 0.0, children=[apple]),
            entity("Bed_1", "Bed|1", (7.9, 0.45, 3.2), 270.0),
            entity("Painting_1", "Painting|1", (7.0, 1.5, 0.02), 0.0),
            entity("Gizmo_1", "Gizmo|1", (6.0, 0.15, 0.5)),
        ],
    }  # fmt: skip


def write_small_house(folder: Path) -> Path:
    """Writes the house twice, as two gzipped lines, and the database; returns the file of the houses."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "asset-database.json").write_text(json.dumps(ASSETS))
    line = json.dumps(small_house()).encode() + b"\n"
    (folder / "houses.jsonl.gz").write_bytes(gzip.compress(line + b"\n" + line))
    return folder / "houses.jsonl.gz"
