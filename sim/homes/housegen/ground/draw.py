"""Draws the ground of a house: friction of each floor, heights of rugs, thresholds, wet spots and uneven tiles.

Sliding friction of rubber tyres: 0.5 to 0.8 on dry tiles and wood, more on carpet, 0.2 to 0.4 on wet tiles. Rugs and
thresholds are at most 12 mm high, which the robot climbs. Tiles may lie up to 3 mm above their neighbours.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np

from sim.homes.housegen.ground.survey import Doorway, Fixture, RoomFloor, RugShape, Survey

FRICTION = MappingProxyType(
    {
        "wood": (0.55, 0.75),
        "tiles": (0.50, 0.70),
        "stone": (0.45, 0.65),
        "carpet": (0.80, 1.00),
        "rubber": (0.85, 1.00),
        "rug": (0.70, 1.00),
        "sill": (0.50, 0.70),
        "wet": (0.20, 0.40),
    }
)
"""Lowest and highest sliding friction of tyres on each material."""
RUG_M, SILL_M, LIP_M = (0.003, 0.012), (0.002, 0.012), (0.0005, 0.003)
"""Heights of rugs, of thresholds, and of the raised edges of tiles."""
STEP_M = 0.004
"""Edges are bevelled in steps of at most this height."""
BEVEL_M = 0.012
"""Width of each step."""
SILL_SHARES = (0.0, 0.35, 0.8)
"""Share of the doorways between floors of different materials that have a threshold, one for each house ..."""
SAME_FLOOR = 0.4
"""... and the factor for doorways between floors of the same material."""
SILL_TOP_M = (0.015, 0.035)
"""Half the depth of the top of a threshold; the bevels remain within the wall."""
WET_SHARE, WET_ROOMS = 0.35, ("bathroom", "laundry", "kitchen")
WET_M = (0.45, 0.85)
"""Edge length of a wet spot."""
FILM_M = 0.001
"""Height of a wet spot."""
TILE_M = (0.3, 0.45)
M2_PER_TILE = (4.0, 14.0)
"""Area of tiled floor for each tile that is not level, one for each house."""
_TEXTURES = (
    ("planks", "wood"), ("parquet", "wood"), ("tiles", "tiles"), ("terrazzo", "tiles"), ("marble", "stone"),
    ("carpet", "carpet"),
)  # fmt: skip


@dataclass(frozen=True)
class Piece:
    """A box or an upright cylinder on a floor, which only wheels and casters touch (`sim.robot.body`)."""

    body: str
    """The body that it is added to."""
    pos_m: tuple[float, float, float]
    size_m: tuple[float, ...]
    """Half sizes of a box; radius and half height of a cylinder."""
    friction: float
    quat: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)
    material: str = ""
    """Name of the material; "" for a piece that is not rendered."""


@dataclass(frozen=True)
class Ground:
    """The ground of one house."""

    friction: dict[str, float] = field(default_factory=dict)
    """Sliding friction by the body of the floor."""
    rug_scale: dict[str, float] = field(default_factory=dict)
    """Height by the body of the rug, relative to that of its shape."""
    pieces: tuple[Piece, ...] = ()


def material_of(room: RoomFloor) -> str:
    """Returns the material of a floor, a key of `FRICTION`: that of its texture; dark carpet of gyms is rubber."""
    material_of_floor = next((material for start, material in _TEXTURES if room.texture.startswith(start)), "wood")
    return "rubber" if material_of_floor == "carpet" and room.kind == "gym" else material_of_floor


def draw_ground(rng: np.random.Generator, house: Survey) -> Ground:
    """Returns the ground of a house."""
    materials: dict[tuple[str, str], float] = {}  # one friction for all floors of the same texture
    friction = {}
    for room in house.rooms:
        drawn = _uniform(rng, FRICTION[material_of(room)])
        friction[room.body] = materials.setdefault((material_of(room), room.texture), drawn)
    pieces: list[Piece] = []
    scale = {}
    for rug in house.rugs:
        height_m = round(float(rng.uniform(*RUG_M)), 4)
        scale[rug.body] = height_m / rug.height_m
        pieces += _rug(rug, height_m, _uniform(rng, FRICTION["rug"]))
    share, m2_per_tile = SILL_SHARES[int(rng.integers(len(SILL_SHARES)))], float(rng.uniform(*M2_PER_TILE))
    for doorway in house.doorways:
        pieces += _threshold(rng, doorway, share)
    for fixture in house.fixtures:
        pieces += _wet_spot(rng, fixture)
    for room in house.rooms:
        if material_of(room) in ("tiles", "stone"):
            pieces += _uneven_tiles(rng, room, friction[room.body], m2_per_tile)
    return Ground(friction, scale, tuple(pieces))


def _rug(rug: RugShape, height_m: float, friction: float) -> list[Piece]:
    """Returns the steps of a rug with a soft edge."""
    pieces = []
    for inset_m, top_m in _steps(height_m):
        half = [round(side - inset_m, 4) for side in rug.half_m]
        size = (half[0], 0.5 * top_m) if rug.is_round else (half[0], half[1], 0.5 * top_m)
        pieces.append(Piece(rug.body, (0.0, 0.0, 0.5 * top_m), _rounded(size), friction))
    return pieces


def _steps(height_m: float) -> list[tuple[float, float]]:
    """Returns inset from the outer edge and height of each step of a bevel, the lowest first."""
    count = math.ceil(height_m / STEP_M - 1e-6)
    return [(n * BEVEL_M, height_m * (n + 1) / count) for n in range(count)]


def _threshold(rng: np.random.Generator, doorway: Doorway, share: float) -> list[Piece]:
    """Returns the steps of a threshold with bevelled sides; an empty list for a doorway without one."""
    one, other = doorway.rooms
    chance, height_m = float(rng.random()), round(float(rng.uniform(*SILL_M)), 4)
    top_m, friction = float(rng.uniform(*SILL_TOP_M)), _uniform(rng, FRICTION["sill"])
    if chance >= share * (SAME_FLOOR if material_of(one) == material_of(other) else 1.0):
        return []
    steps, quat = _steps(height_m), _about((0.0, 0.0, 1.0), doorway.yaw_rad)
    widest_m = top_m + steps[-1][0]
    return [
        Piece(one.body, _point(doorway.x_m, doorway.y_m, 0.5 * step_m),
              _rounded((0.5 * doorway.width_m - 0.001, widest_m - inset_m, 0.5 * step_m)),
              friction, quat, doorway.material)
        for inset_m, step_m in steps
    ]  # fmt: skip


def _wet_spot(rng: np.random.Generator, fixture: Fixture) -> list[Piece]:
    """Returns a film of water before a fixture; an empty list for a dry floor."""
    chance, ahead_m = float(rng.random()), float(rng.uniform(0.4, 0.7))
    half = [0.5 * float(v) for v in rng.uniform(*WET_M, 2)]
    friction, room = _uniform(rng, FRICTION["wet"]), fixture.room
    if chance >= WET_SHARE or room.kind not in WET_ROOMS:
        return []
    x0, y0, x1, y1 = room.bounds_m
    x = fixture.x_m + ahead_m * math.cos(fixture.yaw_rad)
    y = fixture.y_m + ahead_m * math.sin(fixture.yaw_rad)
    x0, x1 = max(x - half[0], x0), min(x + half[0], x1)
    y0, y1 = max(y - half[1], y0), min(y + half[1], y1)
    if min(x1 - x0, y1 - y0) < 0.5 * WET_M[0]:
        return []
    size, middle = (0.5 * (x1 - x0), 0.5 * (y1 - y0), 0.5 * FILM_M), (0.5 * (x0 + x1), 0.5 * (y0 + y1), 0.5 * FILM_M)
    return [Piece(room.body, _point(*middle), _rounded(size), friction, material="water")]


def _uneven_tiles(rng: np.random.Generator, room: RoomFloor, friction: float, m2_per_tile: float) -> list[Piece]:
    """Returns plates that lean: one edge is level with the floor, the opposite one is higher."""
    x0, y0, x1, y1 = room.bounds_m
    pieces, half_height_m = [], 0.004
    for _ in range(int(rng.poisson((x1 - x0) * (y1 - y0) / m2_per_tile))):
        half, lip_m = 0.5 * float(rng.uniform(*TILE_M)), float(rng.uniform(*LIP_M))
        x, y = float(rng.uniform(x0 + half, x1 - half)), float(rng.uniform(y0 + half, y1 - half))
        axis = [(1.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, -1.0, 0.0)][int(rng.integers(4))]
        quat = _about(axis, lip_m / (2.0 * half))
        pos = (round(x, 3), round(y, 3), 0.5 * lip_m - half_height_m)
        pieces.append(Piece(room.body, _point(*pos), _rounded((half, half, half_height_m)), friction, quat))
    return pieces


def _about(axis: tuple[float, float, float], angle_rad: float) -> tuple[float, float, float, float]:
    """Returns the unit quaternion (w, x, y, z) of a rotation about an axis."""
    half = 0.5 * angle_rad
    w, x, y, z = (math.cos(half), *(math.sin(half) * v for v in axis))
    return w, x, y, z


def _uniform(rng: np.random.Generator, limits: tuple[float, float]) -> float:
    return round(float(rng.uniform(*limits)), 2)


def _rounded(values: tuple[float, ...]) -> tuple[float, ...]:
    """Returns lengths rounded to 0.01 mm."""
    return tuple(round(value, 5) + 0.0 for value in values)


def _point(x_m: float, y_m: float, z_m: float) -> tuple[float, float, float]:
    """Returns a position rounded to 0.01 mm."""
    return round(x_m, 5) + 0.0, round(y_m, 5) + 0.0, round(z_m, 5) + 0.0
