"""Families of objects in doorways: invisible artifacts of scans, and movable crates that jam."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Self

from sim.core.geometry.pose import Pose
from sim.homes.housegen.traps.families.family import UNSEEN_M, Chance, Parameters, Scene
from sim.homes.housegen.traps.families.low import draw_row
from sim.homes.housegen.traps.site import WOOD, TrapSite


@dataclass(frozen=True, kw_only=True)
class ScanDoors(Parameters):
    """Invisible artifacts of a scan before doors."""

    family: ClassVar[str] = "scan_doors"
    summary: ClassVar[str] = "A scan left invisible lumps before doorways; beside one of them the robot fits through."

    doorways: int
    """Number of doorways."""
    doorway_m: float
    """Width of a doorway."""
    lump_m: float
    """Extent of a lump along the hall."""
    height_m: float
    """Height of the lumps."""
    before_m: float
    """Distance of the lumps from the wall."""
    way_out: int
    """The doorway that leads through."""
    towards: int
    """The doorway that start and goal face."""

    @classmethod
    def draw(cls, chance: Chance) -> Self:
        """Draws doorways; a harder trap has more of them, and less width next to the lump of the open one."""
        doorways, out, towards = draw_row(chance)
        return cls(
            gap_m=chance.gap_m(), doorways=doorways, doorway_m=chance.between((1.05, 1.15)),
            lump_m=chance.between((0.2, 0.5)), height_m=chance.between((0.3, 1.2)),
            before_m=chance.between((0.0, 0.15)),
            way_out=out, towards=towards, goal=chance.goal(), yaw_rad=chance.yaw_rad(),
        )  # fmt: skip

    def build(self, name: str, seed: int) -> Scene:
        """Builds the hall with a wall across it."""
        pitch, x = self.doorway_m + 0.6, 4.0
        width_m = self.doorways * pitch
        site = TrapSite(name, 8.4, width_m, seed=seed)
        openings = [(i * pitch + 0.3, i * pitch + 0.3 + self.doorway_m) for i in range(self.doorways)]
        site.wall_across(x, *openings)
        for i, (low, high) in enumerate(openings):
            if i == self.way_out:
                site.invisible_box("misc", (x - 0.5 * self.lump_m, x + 0.5 * self.lump_m), (low, high - self.gap_m),
                                   (0.0, self.height_m))  # fmt: skip
            else:
                end_x = x - 0.05 - self.before_m
                site.invisible_box("misc", (end_x - self.lump_m, end_x), (low - 0.1, high + 0.1), (0.0, self.height_m))
        line_m = (self.towards + 0.5) * pitch
        site.goal_furniture(self.goal, 7.2, min(max(line_m, 1.0), width_m - 1.0))
        return Scene(site, Pose(1.2, line_m, self.yaw_rad), self.goal, (x - 1.2, 0.0, x + 0.3, width_m))


@dataclass(frozen=True, kw_only=True)
class Jam(Parameters):
    """Low crates that can be pushed, in doorways where they jam."""

    family: ClassVar[str] = "jam"
    summary: ClassVar[str] = "Crates too low for the map stand in passages; when they are pushed, they jam at stops."

    passages: int
    """Number of passages; all but one have a crate."""
    passage_m: float
    """Width of a passage."""
    crate_m: float
    """Width of the crates."""
    height_m: float
    """Height of crates and stops."""
    mass_kg: float
    """Mass of a crate."""
    friction: float
    """Sliding friction of a crate."""
    way_out: int
    """The passage without a crate."""
    towards: int
    """The passage that start and goal face."""

    @classmethod
    def draw(cls, chance: Chance) -> Self:
        """Draws crates; harder ones are lighter, so that they are pushed farther, and the free passage is narrower."""
        passages, out, towards = draw_row(chance)
        return cls(
            gap_m=chance.gap_m(), passages=passages, passage_m=chance.between((0.95, 1.05)),
            crate_m=chance.between((0.70, 0.76)), height_m=chance.between(UNSEEN_M),
            friction=chance.between((0.25, 0.35)),
            mass_kg=chance.between((4.5, 5.5), (3.0, 4.5), (2.0, 3.0)), way_out=out, towards=towards,
            goal=chance.goal(), yaw_rad=chance.yaw_rad(),
        )  # fmt: skip

    def build(self, name: str, seed: int) -> Scene:
        """Builds the hall; blocks of wall 1.2 m long divide the passages, and their stops are at the far end."""
        pitch, begin_x = self.passage_m + 0.3, 2.8
        end_x, width_m = begin_x + 1.2, self.passages * pitch - 0.3
        site = TrapSite(name, end_x + 4.4, width_m, kind="hallway", seed=seed)
        for i in range(self.passages):
            low, high = i * pitch, i * pitch + self.passage_m
            if i:
                site.wall((begin_x, end_x), (low - 0.3, low))
            stop_m = 0.5 * (self.passage_m - (self.gap_m if i == self.way_out else 0.5))
            for y in ((low, low + stop_m), (high - stop_m, high)):
                site.hide(site.box("objects", (end_x - 0.2, end_x), y, (0.0, self.height_m), WOOD))
            if i != self.way_out:
                y = (0.5 * (low + high - self.crate_m), 0.5 * (low + high + self.crate_m))
                site.hide(site.movable_box((begin_x + 0.1, begin_x + 0.4), y, self.height_m, WOOD,
                                           mass_kg=self.mass_kg, friction=self.friction))  # fmt: skip
        line_m = self.towards * pitch + 0.5 * self.passage_m
        site.goal_furniture(self.goal, end_x + 3.2, min(max(line_m, 1.0), width_m - 1.0))
        zone_m = (begin_x - 0.4, 0.0, end_x + 0.2, width_m)
        return Scene(site, Pose(1.2, line_m, self.yaw_rad), self.goal, zone_m)
