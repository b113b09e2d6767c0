"""Families of floors: slippery and soft ones before a pane, and a path next to a drop."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Self

from sim.core.geometry.pose import Pose
from sim.homes.housegen.floor_plan.rectangles import Rect
from sim.homes.housegen.furniture.item import Look
from sim.homes.housegen.traps.families.family import CLIMBED_M, Chance, Parameters, Scene, gap_away_from
from sim.homes.housegen.traps.families.glass import pane_across
from sim.homes.housegen.traps.site import Pit, TrapSite

WET, RUG = Look((0.72, 0.80, 0.84, 1.0), specular=0.9), Look((0.45, 0.33, 0.36, 1.0), specular=0.0)
WET_M, SOFT_M = 0.004, CLIMBED_M
"""Height of wet and of soft floors."""
SOFT_TIME_S = 0.04
"""Time constant of the contacts of a soft floor: twice the usual one."""


@dataclass(frozen=True, kw_only=True)
class WetFloor(Parameters):
    """A slippery or soft floor before and behind a pane with a gap."""

    family: ClassVar[str] = "wet_floor"
    summary: ClassVar[str] = "A slippery or soft floor makes moves short, and a glass pane with a gap stands on it."
    of_panes: ClassVar[bool] = True

    width_m: float
    """Width of the hall."""
    patch_m: float
    """Length of the floor along the hall."""
    friction: float
    """Sliding friction of the floor."""
    rolling_m: float
    """Rolling friction of a soft floor; 0: the floor is hard and slippery."""
    gap_low_m: float
    """Distance of the gap from one side of the hall."""
    line_m: float
    """Distance of start and goal from that side."""

    @classmethod
    def draw(cls, chance: Chance) -> Self:
        """Draws a floor; a harder one is longer and more slippery, or softer."""
        width_m = chance.between((3.2, 3.8), (3.8, 4.6), (4.6, 5.6))
        gap_m, line_m = chance.gap_m(), chance.between((1.0, width_m - 1.0))
        soft = chance.one_of((False, True))
        return cls(
            gap_m=gap_m, width_m=width_m, line_m=line_m, patch_m=chance.between((1.4, 1.8), (1.8, 2.4), (2.4, 3.0)),
            friction=1.0 if soft else chance.between((0.15, 0.20), (0.11, 0.15), (0.08, 0.11)),
            rolling_m=chance.between((0.002, 0.004), (0.004, 0.006), (0.006, 0.008)) if soft else 0.0,
            gap_low_m=gap_away_from(chance, width_m, gap_m, line_m, (0.8, 1.1, 1.5)[chance.level]),
            goal=chance.goal(), yaw_rad=chance.yaw_rad(),
        )  # fmt: skip

    def build(self, name: str, seed: int) -> Scene:
        """Builds the hall; the pane stands in the middle of the floor."""
        x = 3.8
        span = (x - 0.5 * self.patch_m, x + 0.5 * self.patch_m)
        site = TrapSite(name, 8.8, self.width_m, kind="bathroom", seed=seed)
        soft = self.rolling_m > 0.0
        patch = site.floor_slab(span, (0.0, self.width_m), SOFT_M if soft else WET_M, RUG if soft else WET)
        for geom in patch.geoms:
            geom.priority = 1  # its friction replaces that of the tyres
            geom.friction = [self.friction, 0.005 if soft else 0.0, self.rolling_m]
            if soft:
                geom.condim, geom.solref = 6, [SOFT_TIME_S, 1.0]
        pane_across(site, x, (self.gap_low_m, self.gap_low_m + self.gap_m))
        site.goal_furniture(self.goal, 7.5, self.line_m)
        zone_m = (span[0], 0.0, span[1], self.width_m)
        return Scene(site, Pose(1.2, self.line_m, self.yaw_rad), self.goal, zone_m)


@dataclass(frozen=True, kw_only=True)
class Ledge(Parameters):
    """A path next to a drop; `gap_m` is the width of the path."""

    family: ClassVar[str] = "ledge"
    summary: ClassVar[str] = "A sunken floor lies before the goal; a path as wide as the gap leads along its side."

    width_m: float
    """Width of the hall."""
    length_m: float
    """Length of the sunken floor along the hall."""
    drop_m: float
    """Depth of the sunken floor."""
    side: int
    """0: the path is at the side of smallest y, 1: at the other one."""
    line_m: float
    """Distance of start and goal from the side of smallest y."""

    @classmethod
    def draw(cls, chance: Chance) -> Self:
        """Draws a drop; a harder one is longer, with a narrower path farther off."""
        width_m = chance.between((3.2, 3.8), (3.8, 4.6), (4.6, 5.4))
        side, away = chance.count((0, 1)), chance.between((1.4, 2.0), (1.8, 2.6), (2.6, 3.4))
        return cls(
            gap_m=chance.between((0.84, 1.0), (0.66, 0.80), (0.52, 0.62)), width_m=width_m,
            length_m=chance.between((1.0, 1.6), (1.6, 2.4), (2.4, 3.4)), drop_m=chance.between((0.3, 0.6)), side=side,
            line_m=round(min(away, width_m - 1.0) if side == 0 else max(width_m - away, 1.0), 3),
            goal=chance.goal(), yaw_rad=chance.yaw_rad(),
        )  # fmt: skip

    def build(self, name: str, seed: int) -> Scene:
        """Builds the hall."""
        begin_x, end_x = 2.8, 2.8 + self.length_m
        y = (self.gap_m, self.width_m) if self.side == 0 else (0.0, self.width_m - self.gap_m)
        pit = Pit(Rect(begin_x, y[0], end_x, y[1]), self.drop_m)
        site = TrapSite(name, end_x + 4.2, self.width_m, pit=pit, seed=seed)
        site.goal_furniture(self.goal, end_x + 3.0, self.line_m)
        zone_m = (begin_x - 0.5, 0.0, end_x + 0.5, self.width_m)
        return Scene(site, Pose(1.2, self.line_m, self.yaw_rad), self.goal, zone_m)
