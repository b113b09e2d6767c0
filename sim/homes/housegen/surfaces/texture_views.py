"""Functions that draw the view from a window at a time of day, and the image in a mirror.

Each returns `px` x `px` RGB pixels in [0, 1], the top row first. The horizon is low, because a window begins at the
height of the robot's eye.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sim.homes.housegen.surfaces.texture_patterns import Colour, Image, grid, noise

_HORIZON = 0.66
"""Row of the horizon as a share of the height."""
_SKIES: dict[str, tuple[Colour, Colour, Colour]] = {
    "morning": ((0.50, 0.68, 0.86), (0.97, 0.88, 0.76), (1.0, 0.95, 0.88)),
    "noon": ((0.36, 0.60, 0.90), (0.80, 0.90, 0.98), (1.0, 1.0, 1.0)),
    "evening": ((0.34, 0.38, 0.62), (0.98, 0.62, 0.38), (0.98, 0.74, 0.62)),
    "night": ((0.03, 0.04, 0.10), (0.11, 0.13, 0.22), (0.14, 0.16, 0.24)),
}
"""Colours of the upper sky, of the sky at the horizon and of clouds by time of day."""
_SUNLIGHT: dict[str, Colour] = {
    "morning": (0.94, 0.90, 0.80), "noon": (1.0, 1.0, 1.0), "evening": (0.72, 0.52, 0.42), "night": (0.10, 0.12, 0.19),
}  # fmt: skip
_LIT_WINDOWS = {"morning": 0.05, "noon": 0.0, "evening": 0.4, "night": 0.5}
"""Share of the windows of other houses with light."""


def outside(rng: np.random.Generator, px: int, *, scene: str, time: str) -> Image:
    """Returns the view from a window: `hills`, `street`, `roofs` or `garden`."""
    painter = {"hills": _hills, "street": _street, "roofs": _roofs, "garden": _garden}[scene]
    image = _sky(rng, px, time)
    painter(image, rng, time)
    return np.clip(image, 0.0, 1.0)


def reflection(rng: np.random.Generator, px: int, *, wall: Colour, floor: Colour) -> Image:
    """Returns the image in a mirror: a blurred room with a bright window and a door, streaks, and a bevelled edge."""
    y, x = grid(px)
    image = np.empty((px, px, 3))
    image[:] = np.array(wall) * (1.04 - 0.22 * x[:, :, None])
    image[y < 0.16] = np.array((0.90, 0.91, 0.92))
    image[y > 0.78 + 0.10 * x] = np.array(floor)
    image[(np.abs(x - 0.26) < 0.13) & (y > 0.26) & (y < 0.58)] = (0.90, 0.95, 1.0)
    image[(np.abs(x - 0.26) < 0.012) & (y > 0.26) & (y < 0.58)] = np.array(wall)
    image[(np.abs(x - 0.76) < 0.11) & (y > 0.32) & (y < 0.84)] = 0.62 * np.array(wall)
    image[(x > 0.06) & (x < 0.50) & (y > 0.70) & (y < 0.84)] = 0.55 * np.array(floor)
    for _ in range(3):
        image = 0.25 * (np.roll(image, 2, 0) + np.roll(image, -2, 0) + np.roll(image, 2, 1) + np.roll(image, -2, 1))
    streak = np.mod(x + 0.6 * y, 1.0)
    image += (
        0.10 * (np.exp(-(((streak - 0.30) / 0.05) ** 2)) + 0.7 * np.exp(-(((streak - 0.42) / 0.02) ** 2)))[:, :, None]
    )
    edge = np.minimum(np.minimum(x, 1.0 - x), np.minimum(y, 1.0 - y))
    image[edge < 0.045] = 0.35 * image[edge < 0.045] + 0.60
    image[np.abs(edge - 0.045) < 0.006] = 0.98
    image += 0.01 * noise(rng, px, 6, 6)[:, :, None]
    return np.clip(image, 0.0, 1.0)


def _sky(rng: np.random.Generator, px: int, time: str) -> Image:
    """Returns the sky with clouds, and stars at night."""
    top, low, cloud = (np.array(colour) for colour in _SKIES[time])
    y, _ = grid(px)
    height = np.clip(y / _HORIZON, 0.0, 1.0)[:, :, None] ** 1.3
    image = top + (low - top) * height
    field = noise(rng, px, 7, 20) + 0.35 * noise(rng, px, 2, 5)
    cover = np.clip((field - 0.05) * 1.6, 0.0, 0.85)[:, :, None] * (1.0 - 0.55 * height)
    image += cover * (cloud - image)
    if time == "night":
        image[rng.random((px, px)) > 0.9985] = (0.75, 0.78, 0.85)
    return image


def _profile(rng: np.random.Generator, px: int, level: float, rise: float, smooth_px: float) -> Image:
    """Returns the row (1, px), as a share, of a wavy skyline."""
    line = noise(rng, px, 1, smooth_px).mean(axis=0, keepdims=True)
    return level - rise * (0.5 + line / (2.2 * np.abs(line).max()))


def _lit(colour: Colour, time: str) -> Image:
    return np.array(colour) * np.array(_SUNLIGHT[time])


def _fill(image: Image, mask: NDArray[np.bool_], colour: Colour, time: str, shade: Image | None = None) -> None:
    """Paints the pixels of a mask, lit by the time of day and shaded by a factor."""
    paint = np.broadcast_to(_lit(colour, time), image.shape)
    image[mask] = (paint if shade is None else paint * shade[:, :, None])[mask]


def _trees(image: Image, rng: np.random.Generator, time: str, base: float, heights: tuple[float, float]) -> None:
    """Paints trees with round crowns; `base` and heights are shares of the picture."""
    px = len(image)
    y, x = grid(px)
    leaves = 1.0 + 0.28 * noise(rng, px, 2, 2)
    at = rng.uniform(-0.05, 0.1)
    while at < 1.05:
        high, wide = rng.uniform(*heights), rng.uniform(0.05, 0.09)
        green = (rng.uniform(0.16, 0.30), rng.uniform(0.34, 0.46), rng.uniform(0.14, 0.22))
        _fill(image, (np.abs(x - at) < 0.012) & (y > base - 0.6 * high) & (y < base), (0.30, 0.22, 0.16), time)
        for _ in range(5):
            cx, cy = at + rng.uniform(-0.6, 0.6) * wide, base - high * rng.uniform(0.55, 0.95)
            ball = np.hypot(x - cx, y - cy) < wide * rng.uniform(0.6, 0.95) * (1.0 + 0.12 * (leaves - 1.0))
            _fill(image, ball, green, time, leaves * (1.12 - 0.9 * (y - cy)))
        at += rng.uniform(0.16, 0.42)


def _hills(image: Image, rng: np.random.Generator, time: str) -> None:
    """Paints two chains of hills, meadows and some trees."""
    px = len(image)
    y, _ = grid(px)
    haze = np.array(_SKIES[time][1])
    for level, rise, colour, clear in (
        (_HORIZON + 0.02, 0.22, (0.36, 0.46, 0.50), 0.55),
        (_HORIZON + 0.07, 0.15, (0.30, 0.44, 0.26), 0.8),
        (_HORIZON + 0.13, 0.06, (0.44, 0.56, 0.28), 1.0),
    ):
        land = y > _profile(rng, px, level, rise, 22)
        image[land] = (1.0 - clear) * haze + clear * _lit(colour, time)
    meadow = y > _HORIZON + 0.13
    image[meadow] *= (1.0 + 0.10 * noise(rng, px, 2, 8))[meadow][:, None]
    _trees(image, rng, time, 0.86, (0.14, 0.30))


def _houses(
    image: Image, rng: np.random.Generator, time: str, base: float, heights: tuple[float, float], *, gabled: bool
) -> None:
    """Paints a row of house fronts with windows, under flat or gabled roofs."""
    px = len(image)
    y, x = grid(px)
    at = -rng.uniform(0.0, 0.15)
    walls = ((0.80, 0.72, 0.60), (0.70, 0.42, 0.32), (0.84, 0.82, 0.78), (0.62, 0.60, 0.56), (0.76, 0.60, 0.44))
    while at < 1.0:
        wide, high = rng.uniform(0.2, 0.34), rng.uniform(*heights)
        inside = (x >= at) & (x < at + wide)
        top = base - high
        _fill(image, inside & (y > top) & (y < base), walls[int(rng.integers(len(walls)))], time)
        roof = 0.45 * wide - 0.9 * np.abs(x - at - 0.5 * wide) if gabled else np.full_like(x, 0.02)
        tile = (0.52, 0.24, 0.18) if rng.random() < 0.6 else (0.34, 0.34, 0.38)
        _fill(image, inside & (y <= top) & (y > top - roof), tile, time)
        for row in np.arange(top + 0.04, base - 0.08, 0.12):
            for col in np.arange(at + 0.035, at + wide - 0.05, 0.075):
                pane = (x > col) & (x < col + 0.042) & (y > row) & (y < row + 0.07)
                if rng.random() < _LIT_WINDOWS[time]:
                    image[pane] = (1.0, 0.84, 0.52)
                else:
                    _fill(image, pane, (0.30, 0.36, 0.42), time)
        at += wide + (rng.uniform(0.02, 0.12) if gabled else 0.004)


def _street(image: Image, rng: np.random.Generator, time: str) -> None:
    """Paints the fronts across a street, the pavement, the road and trees."""
    y, x = grid(len(image))
    _houses(image, rng, time, 0.80, (0.30, 0.55), gabled=False)
    _fill(image, y >= 0.80, (0.66, 0.65, 0.63), time)
    _fill(image, y > 0.86, (0.36, 0.37, 0.39), time)
    _fill(image, (np.abs(y - 0.94) < 0.008) & (np.mod(x, 0.25) < 0.14), (0.9, 0.9, 0.86), time)
    _trees(image, rng, time, 0.83, (0.24, 0.34))


def _roofs(image: Image, rng: np.random.Generator, time: str) -> None:
    """Paints the roofs of a town in two rows, with hills behind."""
    px = len(image)
    y, _ = grid(px)
    far = y > _profile(rng, px, _HORIZON - 0.04, 0.12, 26)
    image[far] = 0.5 * np.array(_SKIES[time][1]) + 0.5 * _lit((0.40, 0.46, 0.52), time)
    _houses(image, rng, time, 0.84, (0.14, 0.26), gabled=True)
    _trees(image, rng, time, 0.90, (0.10, 0.18))
    _houses(image, rng, time, 1.02, (0.10, 0.20), gabled=True)


def _garden(image: Image, rng: np.random.Generator, time: str) -> None:
    """Paints tall trees behind a hedge, a wooden fence and a lawn."""
    px = len(image)
    y, x = grid(px)
    leaves = 1.0 + 0.25 * noise(rng, px, 2, 2)
    _trees(image, rng, time, 0.72, (0.30, 0.50))
    _fill(image, y > _profile(rng, px, 0.70, 0.08, 5), (0.20, 0.36, 0.18), time, leaves)
    _fill(image, (y > 0.76) & (y < 0.88) & (np.mod(x * 16, 1.0) < 0.86), (0.60, 0.50, 0.38), time)
    _fill(image, y >= 0.88, (0.40, 0.56, 0.26), time, 1.0 + 0.12 * noise(rng, px, 1, 3))
    flowers = (rng.random((px, px)) > 0.985) & (y > 0.90)
    _fill(image, flowers, (0.95, 0.80, 0.40), time)
