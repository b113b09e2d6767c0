"""Families of visible obstacles that are too low, too thin or too near for a map: stools, sills, legs, plinths."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, Self

from sim.core.geometry.pose import Pose
from sim.homes.housegen.furniture.item import Geom
from sim.homes.housegen.traps.families.family import (
    CLIMBED_M,
    CLOSED_M,
    UNSEEN_M,
    Chance,
    Parameters,
    Scene,
    gap_away_from,
)
from sim.homes.housegen.traps.site import FABRIC, STEEL, WOOD, TrapSite


@dataclass(frozen=True, kw_only=True)
class StoolRing(Parameters):
    """A ring of low stools around the start with one opening."""

    family: ClassVar[str] = "stool_ring"
    summary: ClassVar[str] = "The robot starts in a ring of stools that are too near to be seen; it has one opening."
    held_out: ClassVar[bool] = True

    ring_m: float
    """Radius of the ring, to the middle of the stools."""
    stool_m: float
    """Radius of a stool."""
    height_m: float
    """Height of the stools."""
    opening_rad: float
    """Direction of the opening from the start; the goal is at 0."""

    @classmethod
    def draw(cls, chance: Chance) -> Self:
        """Draws a ring; a harder one has a narrower opening, farther from the direction of the goal."""
        side = chance.one_of((-1.0, 1.0))
        return cls(
            gap_m=chance.gap_m(), ring_m=chance.between((0.95, 1.1)), stool_m=chance.between((0.12, 0.16)),
            height_m=chance.between((0.20, 0.28), (0.14, 0.22), (0.10, 0.16)),
            opening_rad=side * chance.between((0.9, 1.5), (1.5, 2.3), (2.3, math.pi)),
            goal=chance.goal(), yaw_rad=chance.yaw_rad(),
        )  # fmt: skip

    def build(self, name: str, seed: int) -> Scene:
        """Builds the hall; the ring is 2.7 m from its near end."""
        site, x, y = TrapSite(name, 8.6, 4.6, seed=seed), 2.7, 2.3
        half_rad = math.asin(0.5 * (self.gap_m + 2 * self.stool_m) / self.ring_m)
        step_rad = 2.0 * math.asin(0.5 * (0.75 * CLOSED_M + 2 * self.stool_m) / self.ring_m)
        count = math.ceil((math.tau - 2 * half_rad) / step_rad)
        for i in range(count + 1):
            angle = self.opening_rad + half_rad + (math.tau - 2 * half_rad) * i / count
            stool = Geom("cylinder", (self.stool_m, 0.5 * self.height_m), (0.0, 0.0, 0.5 * self.height_m), FABRIC)
            at = (x + self.ring_m * math.cos(angle), y + self.ring_m * math.sin(angle))
            site.hide(site.add("stool", [stool], *at))
        site.goal_furniture(self.goal, 7.4, y)
        reach = self.ring_m + self.stool_m
        return Scene(site, Pose(x, y, self.yaw_rad), self.goal, (x - reach, y - reach, x + reach, y + reach))


@dataclass(frozen=True, kw_only=True)
class Sills(Parameters):
    """Doorways with sills that are too high, and one with a low sill between plinths."""

    family: ClassVar[str] = "sills"
    summary: ClassVar[str] = "Doorways have sills that are too high for the wheels; one has a low sill between plinths."

    doorways: int
    """Number of doorways."""
    doorway_m: float
    """Width of a doorway."""
    high_m: float
    """Height of the high sills and of the plinths."""
    low_m: float
    """Height of the low sill."""
    way_out: int
    """The doorway with the low sill."""
    towards: int
    """The doorway that start and goal face."""

    @classmethod
    def draw(cls, chance: Chance) -> Self:
        """Draws doorways; a harder trap has more of them, lower sills, and narrower plinths farther off."""
        doorways, out, towards = draw_row(chance)
        return cls(
            gap_m=chance.gap_m(), doorways=doorways, doorway_m=chance.between((1.0, 1.1)),
            high_m=chance.between((0.075, UNSEEN_M[1]), (0.06, 0.075), (UNSEEN_M[0], 0.06)),
            low_m=chance.between((0.003, CLIMBED_M)), way_out=out, towards=towards,
            goal=chance.goal(), yaw_rad=chance.yaw_rad(),
        )  # fmt: skip

    def build(self, name: str, seed: int) -> Scene:
        """Builds the hall with a wall across it."""
        pitch, x = self.doorway_m + 0.5, 4.0
        width_m = self.doorways * pitch
        site = TrapSite(name, 8.4, width_m, kind="hallway", seed=seed)
        openings = [(i * pitch + 0.25, i * pitch + 0.25 + self.doorway_m) for i in range(self.doorways)]
        site.wall_across(x, *openings)
        for i, (low, high) in enumerate(openings):
            if i != self.way_out:
                site.hide(site.box("door", (x - 0.06, x + 0.06), (low, high), (0.0, self.high_m), WOOD))
                continue
            site.floor_slab((x - 0.06, x + 0.06), (low, high), self.low_m, WOOD)
            plinth_m = 0.5 * (self.doorway_m - self.gap_m)
            for y in ((low, low + plinth_m), (high - plinth_m, high)):
                site.hide(site.box("door", (x - 0.12, x + 0.12), y, (0.0, self.high_m), WOOD))
        line_m = (self.towards + 0.5) * pitch
        site.goal_furniture(self.goal, 7.2, min(max(line_m, 1.0), width_m - 1.0))
        return Scene(site, Pose(1.4, line_m, self.yaw_rad), self.goal, (x - 1.0, 0.0, x + 0.3, width_m))


@dataclass(frozen=True, kw_only=True)
class LegForest(Parameters):
    """Rows of thin legs with one passage."""

    family: ClassVar[str] = "leg_forest"
    summary: ClassVar[str] = "Bar tables on thin legs fill the hall in rows; one passage leads between the legs."

    width_m: float
    """Width of the hall."""
    rows: int
    """Number of rows of legs."""
    leg_m: float
    """Radius of a leg."""
    passage_low_m: float
    """Distance of the passage of the first row from one side of the hall."""
    shift_m: float
    """Displacement of the passage from row to row."""
    line_m: float
    """Distance of start and goal from that side."""

    @classmethod
    def draw(cls, chance: Chance) -> Self:
        """Draws a forest; a harder one has more rows, thinner legs, and a narrower and slanting passage.

        At a distance of 2 m a pixel of the camera is 5 mm wide: medium and hard legs are thinner than that.
        """
        width_m = chance.between((3.4, 4.0), (4.0, 4.8), (4.6, 5.4))
        gap_m, line_m, rows = chance.gap_m(), chance.between((1.0, width_m - 1.0)), chance.count((2, 2), (3, 3), (4, 4))
        low = gap_away_from(chance, width_m, gap_m, line_m, (0.8, 1.1, 1.4)[chance.level])
        shift = chance.between((0.0, 0.05), (0.05, 0.12), (0.10, 0.18)) * (1.0 if low < 0.5 * width_m else -1.0)
        return cls(
            gap_m=gap_m, width_m=width_m, rows=rows,
            leg_m=chance.between((0.004, 0.006), (0.002, 0.003), (0.001, 0.001)),
            passage_low_m=low, shift_m=round(shift, 3), line_m=line_m, goal=chance.goal(), yaw_rad=chance.yaw_rad(),
        )  # fmt: skip

    def build(self, name: str, seed: int) -> Scene:
        """Builds the hall; the tops of the tables are above the robot."""
        apart_m, begin_x = 0.62, 3.0
        end_x = begin_x + apart_m * (self.rows - 1)
        site = TrapSite(name, end_x + 4.6, self.width_m, kind="dining_room", seed=seed)
        for row in range(self.rows):
            x, low = begin_x + apart_m * row, self.passage_low_m + self.shift_m * row
            for span in ((0.0, low), (low + self.gap_m, self.width_m)):
                self._row(site, x, span)
        site.goal_furniture(self.goal, end_x + 3.4, self.line_m)
        zone_m = (begin_x - 0.8, 0.0, end_x + 0.4, self.width_m)
        return Scene(site, Pose(1.1, self.line_m, self.yaw_rad), self.goal, zone_m)

    def _row(self, site: TrapSite, x: float, span: tuple[float, float]) -> None:
        """Adds the legs from one y to another, at most `CLOSED_M` apart, and a top on them."""
        low, high = span[0] + self.leg_m, span[1] - self.leg_m
        if high - low < 0.02:
            return
        count = math.ceil((high - low) / (CLOSED_M + 2 * self.leg_m))
        places = [(x, low + (high - low) * i / count) for i in range(count + 1)]
        site.hide(site.posts("table", places, self.leg_m, (0.0, 0.91), STEEL))
        site.box("table", (x - 0.12, x + 0.12), (low, high), (0.91, 0.94), WOOD, solid=False)


@dataclass(frozen=True, kw_only=True)
class Channels(Parameters):
    """Channels that narrow by low plinths, one of them less than the robot's width allows."""

    family: ClassVar[str] = "channels"
    summary: ClassVar[str] = "Low plinths narrow channels until the robot does not fit; it fits through one of them."

    channels: int
    """Number of channels."""
    length_m: float
    """Length of the channels."""
    channel_m: float
    """Width of a channel at its begin."""
    closed_m: float
    """Width of the closed channels at their end."""
    plinth_m: float
    """Height of the plinths."""
    way_out: int
    """The channel that leads through."""
    towards: int
    """The channel that start and goal face."""

    @classmethod
    def draw(cls, chance: Chance) -> Self:
        """Draws channels; harder ones are longer, and closed ones resemble the open one more."""
        channels, out, towards = draw_row(chance)
        return cls(
            gap_m=chance.gap_m(), channels=channels, length_m=chance.between((0.9, 1.3), (1.3, 1.9), (1.9, 2.6)),
            channel_m=chance.between((1.0, 1.1)), closed_m=chance.between((0.15, 0.22), (0.20, 0.27), (0.25, CLOSED_M)),
            plinth_m=chance.between(UNSEEN_M), way_out=out, towards=towards,
            goal=chance.goal(), yaw_rad=chance.yaw_rad(),
        )  # fmt: skip

    def build(self, name: str, seed: int) -> Scene:
        """Builds the hall; the channels are divided by blocks of wall 0.3 m wide."""
        pitch, begin_x = self.channel_m + 0.3, 2.8
        end_x, width_m = begin_x + self.length_m, self.channels * pitch - 0.3
        site = TrapSite(name, end_x + 4.4, width_m, kind="hallway", seed=seed)
        for i in range(self.channels):
            low = i * pitch
            if i:
                site.wall((begin_x, end_x), (low - 0.3, low))
            self._plinths(site, low, begin_x, self.gap_m if i == self.way_out else self.closed_m)
        line_m = self.towards * pitch + 0.5 * self.channel_m
        site.goal_furniture(self.goal, end_x + 3.2, min(max(line_m, 1.0), width_m - 1.0))
        zone_m = (begin_x, 0.0, end_x + 0.2, width_m)
        return Scene(site, Pose(1.2, line_m, self.yaw_rad), self.goal, zone_m)

    def _plinths(self, site: TrapSite, low: float, begin_x: float, end_m: float) -> None:
        """Adds three pairs of plinths along the sides of a channel that leave less and less width, at last `end_m`."""
        high, third = low + self.channel_m, self.length_m / 3
        for step in range(3):
            wide = 0.5 * (self.channel_m - end_m) * (step + 1) / 3
            x = (begin_x + third * step, begin_x + third * (step + 1))
            for y in ((low, low + wide), (high - wide, high)):
                if wide > 0.01:
                    site.hide(site.box("objects", x, y, (0.0, self.plinth_m), WOOD))


def draw_row(chance: Chance) -> tuple[int, int, int]:
    """Returns the number of openings in a row, the one that leads through, and the one that start and goal face."""
    number = chance.count((2, 2), (3, 3), (4, 4))
    out = chance.count((0, number - 1))
    least = 2 if chance.level == 2 else 1
    return number, out, chance.one_of([i for i in range(number) if abs(i - out) >= least])
