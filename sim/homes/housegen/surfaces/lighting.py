"""Draws the light of a home: the time of day, daylight, the view from the windows, and a lamp or two in each room."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.homes.housegen.floor_plan import FloorPlan
from sim.homes.housegen.floor_plan.rectangles import Rect, Side
from sim.homes.housegen.furniture.item import Look, Pool
from sim.homes.housegen.mjcf.placed import Lamp

Rgb = tuple[float, float, float]
LONG_ROOM_M = 7.5
"""A longer room has two lamps."""
_DIM_SHARE, _DIM = 0.12, 0.6
"""Share of rooms with a dim lamp, and its strength against others."""


@dataclass(frozen=True)
class Daylight:
    """The light of a time of day, chosen by eye so that all rooms are readable and few surfaces are burnt out."""

    share: float
    """Share of homes at this time."""
    ambient: Rgb
    """Light from everywhere: without it, walls that no lamp faces look black."""
    sides: tuple[float, float, float]
    """Strengths of light from three sides; the first is the strongest."""
    sun: Rgb
    """Colour of the light from the first side."""
    floor: float
    """Strength of the light that the floors reflect to the ceilings."""
    lamps: float
    """Strength of the lamps."""


DAYLIGHT: dict[str, Daylight] = {
    "morning": Daylight(0.3, (0.38, 0.385, 0.39), (0.36, 0.16, 0.10), (1.0, 0.93, 0.80), 0.42, 0.54),
    "noon": Daylight(0.35, (0.40, 0.40, 0.40), (0.28, 0.18, 0.12), (1.0, 0.99, 0.96), 0.44, 0.48),
    "evening": Daylight(0.2, (0.355, 0.335, 0.32), (0.26, 0.11, 0.08), (1.0, 0.80, 0.60), 0.36, 0.66),
    "night": Daylight(0.15, (0.30, 0.31, 0.335), (0.12, 0.08, 0.06), (0.85, 0.90, 1.0), 0.38, 0.84),
}
"""Daylight by time of day; `sim.homes.housegen.surfaces.texture_views` draws the sky of each."""
VIEWS: dict[str, tuple[str, ...]] = {"train": ("hills", "street"), "heldout": ("roofs", "garden")}
"""Scenes outside the windows by pool."""
_WARM, _NEUTRAL, _COLD = (1.0, 0.88, 0.72), (1.0, 0.97, 0.92), (0.93, 0.98, 1.0)
_LAMP_COLOURS: dict[str, tuple[Rgb, ...]] = {
    "bedroom": (_WARM,), "living_room": (_WARM, _WARM, _NEUTRAL), "dining_room": (_WARM, _NEUTRAL),
    "kitchen": (_COLD, _NEUTRAL), "bathroom": (_COLD, _NEUTRAL), "laundry": (_COLD,), "office": (_NEUTRAL, _COLD),
    "gym": (_COLD,), "closet": (_WARM,),
}  # fmt: skip


def draw_time(rng: np.random.Generator) -> str:
    """Returns the time of day of a home, a key of `DAYLIGHT`."""
    names = list(DAYLIGHT)
    return names[int(rng.choice(len(names), p=[DAYLIGHT[name].share for name in names]))]


def draw_views(rng: np.random.Generator, pool: Pool, time: str) -> dict[Side, Look]:
    """Returns the outside view of the windows on each side; opposite sides of a home may differ."""
    scenes = VIEWS[pool]
    sides: tuple[Side, ...] = ("north", "east", "south", "west")
    return {side: _view(scenes[int(rng.integers(len(scenes)))], time) for side in sides}


def draw_lamps(rng: np.random.Generator, plan: FloorPlan, ceiling_m: float, time: str) -> list[Lamp]:
    """Returns daylight from three sides, a reflection from the floors, and lamps in each room, the largest room first.

    Fixed-function OpenGL has eight lights. Four are directional; `sim.renderer.lamps` chooses the lamps in view for the
    others, and other viewers take the first ones. Directional lights cast no shadow, because the ceiling would block
    them. A storey above keeps only the lamps of its rooms: the daylight of the storey below reaches it.

    Args:
        rng: draws directions, strengths and colours.
        plan: the rooms of the storey.
        ceiling_m: height of the ceilings above the floor.
        time: a key of `DAYLIGHT`.
    """
    day = DAYLIGHT[time]
    lamps = _daylight(rng, plan, ceiling_m, day)
    for room in sorted(plan.rooms, key=lambda room: -room.rect.area_m2):
        colours = _LAMP_COLOURS.get(room.kind, (_NEUTRAL,))
        colour = colours[int(rng.integers(len(colours)))]
        strength = day.lamps * float(rng.uniform(0.82, 1.15)) * (_DIM if rng.random() < _DIM_SHARE else 1.0)
        for x, y in _lamp_places(room.rect):
            at = (round(x, 2), round(y, 2), round(ceiling_m - 0.25, 2))
            lamps.append(Lamp(at, _tinted(strength, colour), shadow=True))
    return lamps


def _view(scene: str, time: str) -> Look:
    """Returns the look of a window pane: a picture that emits all of its light."""
    return Look((1.0, 1.0, 1.0, 1.0), f"view_{scene}_{time}", 0.0, specular=0.0, shininess=0.0, emission=1.0)


def _daylight(rng: np.random.Generator, plan: FloorPlan, ceiling_m: float, day: Daylight) -> list[Lamp]:
    """Returns the directional lights of a home."""
    turn = float(rng.uniform(0.0, 2 * np.pi))
    x, y = plan.bounds.centre
    above = (round(x, 2), round(y, 2), ceiling_m + 2.0)
    low = (above[0], above[1], 0.1)
    sides = zip(day.sides, (0.0, 2.0, 4.1), (-0.70, -0.55, -0.50), (day.sun, day.ambient, day.ambient), strict=True)
    return [
        *(
            Lamp(above, _tinted(strength, _whitened(colour)), _towards(turn + angle, tilt))
            for strength, angle, tilt, colour in sides
        ),
        Lamp(low, _tinted(day.floor, _whitened(day.sun)), _towards(turn + 1.0, 1.2)),
    ]


def _lamp_places(rect: Rect) -> list[tuple[float, float]]:
    """Returns the places of a room's lamps: its middle, or the quarter points of its long axis."""
    x, y = rect.centre
    if max(rect.width_m, rect.depth_m) < LONG_ROOM_M:
        return [(x, y)]
    dx, dy = (0.25 * rect.width_m, 0.0) if rect.width_m > rect.depth_m else (0.0, 0.25 * rect.depth_m)
    return [(x - dx, y - dy), (x + dx, y + dy)]


def _whitened(colour: Rgb) -> Rgb:
    """Returns a colour halfway to white, its largest part 1: walls scatter the light of a window."""
    most = max(colour)
    r, g, b = (0.5 + 0.5 * part / most for part in colour)
    return (r, g, b)


def _tinted(strength: float, colour: Rgb) -> Rgb:
    r, g, b = (round(strength * part, 3) for part in colour)
    return (r, g, b)


def _towards(angle: float, tilt: float) -> Rgb:
    """Returns a unit vector of this heading and elevation, in radians."""
    level = np.cos(tilt)
    return (
        round(float(level * np.cos(angle)), 4),
        round(float(level * np.sin(angle)), 4),
        round(float(np.sin(tilt)), 4),
    )
