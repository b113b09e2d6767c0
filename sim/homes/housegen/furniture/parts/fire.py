"""Flames of fireplaces and stoves."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

from sim.homes.housegen.furniture.item import Look
from sim.homes.housegen.furniture.parts.leaves import Body, joined, tube
from sim.homes.housegen.furniture.workbench import Workbench

_SHARES = ((0.0, 0.55, 0.0), (0.28, 1.0, 0.25), (0.62, 0.6, -0.3), (1.0, 0.0, 0.35))
"""Height and radius of the rings of a flame, as shares of its own, and how far they are shifted, in radii."""


def flames(w: Workbench, x: float, z: float, tongues: Sequence[tuple[float, float, float]]) -> None:
    """Adds pointed flames that rise from the height `z`, each with a lighter core on its front side.

    Args:
        w: the workbench.
        x: where the flames are, from the wall.
        z: height of their lower ends.
        tongues: position along y, height and radius of each flame.
    """
    fire = w.look("fire")
    outer = [_tongue(x, y, z, high, radius, 1.0 if i % 2 else -1.0) for i, (y, high, radius) in enumerate(tongues)]
    inner = [
        _tongue(x + 0.6 * radius, y, z, 0.6 * high, 0.55 * radius, 1.0 if i % 2 else -1.0)
        for i, (y, high, radius) in enumerate(tongues)
    ]
    w.mesh(joined("flames", outer), (0.0, 0.0, 0.0), fire, solid=False)
    w.mesh(joined("flames", inner), (0.0, 0.0, 0.0), _core(fire), solid=False)


def _tongue(x: float, y: float, z: float, high: float, radius: float, lean: float) -> Body:
    path = [(x, y + lean * shift * radius, z + share * high) for share, _, shift in _SHARES]
    return tube(path, [radius * wide for _, wide, _ in _SHARES])


def _core(fire: Look) -> Look:
    """Returns a lighter and yellower look."""
    r, g, b, a = fire.rgba
    light = (round(min(1.0, 0.5 + 0.5 * r), 3), round(0.45 + 0.5 * g, 3), round(0.3 + 0.5 * b, 3), a)
    return dataclasses.replace(fire, rgba=light)
