"""Choices of a material for a part. Each function draws from the item's random generator."""

from __future__ import annotations

import dataclasses

from sim.homes.housegen.furniture.item import Look
from sim.homes.housegen.furniture.workbench import Workbench


def darker(look: Look, factor: float = 0.45) -> Look:
    """Returns a darker version of a look without its texture, for example for the shadow in a joint."""
    r, g, b, a = look.rgba
    return dataclasses.replace(
        look, rgba=(round(factor * r, 3), round(factor * g, 3), round(factor * b, 3), a), texture=None
    )


def tinted_glass(glass: Look) -> Look:
    """Returns the look of a horizontal sheet of glass: greener and less transparent than a pane."""
    r, g, b, _ = glass.rgba
    return dataclasses.replace(glass, rgba=(round(0.62 * r, 3), round(0.80 * g, 3), round(0.80 * b, 3), 0.55))


def glass_edge(glass: Look) -> Look:
    """Returns the look of the edge of a sheet of glass, which is opaque and darker than the sheet."""
    r, g, b, _ = glass.rgba
    return dataclasses.replace(glass, rgba=(round(0.45 * r, 3), round(0.62 * g, 3), round(0.58 * b, 3), 1.0))


def wood_look(w: Workbench) -> Look:
    """Returns lacquer with the probability 0.45, otherwise plain wood."""
    return w.look("lacquer") if w.chance(0.45) else w.look("wood")
