"""Families of glass panes, which no camera shows: across a corridor, in a row, as a comb, at the end of dead ends."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Self

from sim.core.geometry.pose import Pose
from sim.homes.housegen.traps.families.family import Chance, Parameters, Scene, gap_away_from
from sim.homes.housegen.traps.site import TrapSite


@dataclass(frozen=True, kw_only=True)
class PaneGap(Parameters):
    """A glass pane across a corridor with a gap at an unknown place."""

    family: ClassVar[str] = "pane_gap"
    summary: ClassVar[str] = "A glass pane stands across the corridor; a gap leads past it somewhere along it."
    of_panes: ClassVar[bool] = True

    width_m: float
    """Width of the corridor."""
    pane_x_m: float
    """Distance of the pane from the near end of the corridor."""
    gap_low_m: float
    """Distance of the gap from one side of the corridor."""
    line_m: float
    """Distance of start and goal from that side."""

    @classmethod
    def draw(cls, chance: Chance) -> Self:
        """Draws a pane; a harder one is longer and has a narrower gap farther from the straight line."""
        width_m = chance.between((3.2, 4.0), (4.0, 5.2), (5.2, 6.8))
        gap_m, line_m = chance.gap_m(), chance.between((1.0, width_m - 1.0))
        away_m = (0.9, 1.4, 2.0)[chance.level]
        return cls(
            gap_m=gap_m, width_m=width_m, pane_x_m=chance.between((3.2, 4.0)), line_m=line_m, goal=chance.goal(),
            gap_low_m=gap_away_from(chance, width_m, gap_m, line_m, away_m), yaw_rad=chance.yaw_rad(),
        )  # fmt: skip

    def build(self, name: str, seed: int) -> Scene:
        """Builds the corridor."""
        site = TrapSite(name, 8.5, self.width_m, kind="hallway", seed=seed)
        pane_across(site, self.pane_x_m, (self.gap_low_m, self.gap_low_m + self.gap_m))
        site.goal_furniture(self.goal, 7.3, self.line_m)
        zone_m = (self.pane_x_m - 1.0, 0.0, self.pane_x_m + 0.3, self.width_m)
        return Scene(site, Pose(1.2, self.line_m, self.yaw_rad), self.goal, zone_m)


@dataclass(frozen=True, kw_only=True)
class TwoPanes(Parameters):
    """Two panes in a row, with gaps at different places."""

    family: ClassVar[str] = "two_panes"
    summary: ClassVar[str] = "Two glass panes stand across the corridor one after the other, with gaps apart."
    of_panes: ClassVar[bool] = True
    held_out: ClassVar[bool] = True

    width_m: float
    """Width of the corridor."""
    apart_m: float
    """Distance between the panes."""
    first_low_m: float
    """Distance of the gap of the first pane from one side of the corridor."""
    second_low_m: float
    """Distance of the gap of the second pane from that side."""
    line_m: float
    """Distance of start and goal from that side."""

    @classmethod
    def draw(cls, chance: Chance) -> Self:
        """Draws two panes; harder ones are longer, nearer to each other, and have narrower gaps."""
        width_m = chance.between((3.2, 3.8), (3.8, 4.6), (4.6, 5.6))
        gap_m, line_m = chance.gap_m(), chance.between((1.0, width_m - 1.0))
        first = gap_away_from(chance, width_m, gap_m, line_m, (0.8, 1.1, 1.5)[chance.level])
        second = gap_away_from(chance, width_m, gap_m, first + 0.5 * gap_m, (1.2, 1.6, 2.0)[chance.level])
        return cls(
            gap_m=gap_m, width_m=width_m, apart_m=chance.between((1.6, 2.0), (1.2, 1.6), (0.9, 1.2)), line_m=line_m,
            first_low_m=first, second_low_m=second, goal=chance.goal(), yaw_rad=chance.yaw_rad(),
        )  # fmt: skip

    def build(self, name: str, seed: int) -> Scene:
        """Builds the corridor."""
        site = TrapSite(name, 9.0, self.width_m, kind="hallway", seed=seed)
        for x, low in ((3.2, self.first_low_m), (3.2 + self.apart_m, self.second_low_m)):
            pane_across(site, x, (low, low + self.gap_m))
        site.goal_furniture(self.goal, 7.8, self.line_m)
        zone_m = (2.2, 0.0, 3.5 + self.apart_m, self.width_m)
        return Scene(site, Pose(1.2, self.line_m, self.yaw_rad), self.goal, zone_m)


@dataclass(frozen=True, kw_only=True)
class PaneComb(Parameters):
    """A comb of panes: pockets side by side; one of them has an opening in its back."""

    family: ClassVar[str] = "pane_comb"
    summary: ClassVar[str] = "Glass panes form a comb of pockets that open to the start; one pocket leads through."
    of_panes: ClassVar[bool] = True

    pockets: int
    """Number of pockets."""
    pocket_m: float
    """Width of a pocket."""
    depth_m: float
    """Length of the teeth of the comb."""
    way_out: int
    """The pocket with the opening."""
    towards: int
    """The pocket that start and goal face."""

    @classmethod
    def draw(cls, chance: Chance) -> Self:
        """Draws a comb; a harder one has more and deeper pockets and a narrower opening farther off."""
        pockets, gap_m = chance.count((3, 3), (4, 4), (5, 6)), chance.gap_m()
        out = chance.count((0, pockets - 1))
        far = [i for i in range(pockets) if abs(i - out) >= (1, 1, 2)[chance.level]]
        return cls(
            gap_m=gap_m, pockets=pockets, pocket_m=chance.between((1.05, 1.25), (0.95, 1.15), (0.85, 1.05)),
            depth_m=chance.between((0.4, 0.8), (0.8, 1.2), (1.2, 1.8)), way_out=out, towards=chance.one_of(far),
            goal=chance.goal(), yaw_rad=chance.yaw_rad(),
        )  # fmt: skip

    def build(self, name: str, seed: int) -> Scene:
        """Builds the hall."""
        width_m, back_x = self.pockets * self.pocket_m, 5.2
        site = TrapSite(name, 9.4, width_m, seed=seed)
        middle = (self.way_out + 0.5) * self.pocket_m
        pane_across(site, back_x, (middle - 0.5 * self.gap_m, middle + 0.5 * self.gap_m))
        for tooth in range(1, self.pockets):
            y = tooth * self.pocket_m
            site.pane("window", (back_x - self.depth_m, y), (back_x, y))
        line_m = min(max((self.towards + 0.5) * self.pocket_m, 1.0), width_m - 1.0)
        site.goal_furniture(self.goal, 8.2, line_m)
        start_y = (self.towards + 0.5) * self.pocket_m
        zone_m = (back_x - self.depth_m - 0.2, 0.0, back_x + 0.3, width_m)
        return Scene(site, Pose(1.6, start_y, self.yaw_rad), self.goal, zone_m)


@dataclass(frozen=True, kw_only=True)
class DeadEnds(Parameters):
    """Corridors side by side; all but one end in an invisible wall."""

    family: ClassVar[str] = "dead_ends"
    summary: ClassVar[str] = "Corridors lead to the goal; invisible walls close all of them but one."
    of_panes: ClassVar[bool] = True

    corridors: int
    """Number of corridors."""
    depth_m: float
    """Length of the corridors."""
    corridor_m: float
    """Width of the corridors."""
    way_out: int
    """The open corridor."""
    towards: int
    """The corridor that start and goal face."""

    @classmethod
    def draw(cls, chance: Chance) -> Self:
        """Draws corridors; harder ones are longer, and the open one is narrower and farther off."""
        corridors = chance.count((2, 2), (3, 3), (4, 4))
        out = chance.count((0, corridors - 1))
        far = [i for i in range(corridors) if i != out and (chance.level < 2 or abs(i - out) > 1)] or [
            (out + corridors // 2) % corridors
        ]
        return cls(
            gap_m=chance.gap_m(), corridors=corridors, depth_m=chance.between((1.0, 1.4), (1.4, 2.0), (2.0, 2.8)),
            corridor_m=chance.between((1.0, 1.1), (0.95, 1.05), (0.9, 1.0)), way_out=out, towards=chance.one_of(far),
            goal=chance.goal(), yaw_rad=chance.yaw_rad(),
        )  # fmt: skip

    def build(self, name: str, seed: int) -> Scene:
        """Builds the hall; the corridors are divided by blocks of wall 0.3 m wide."""
        pitch, begin_x = self.corridor_m + 0.3, 2.8
        end_x, width_m = begin_x + self.depth_m, self.corridors * pitch - 0.3
        site = TrapSite(name, end_x + 4.4, width_m, kind="hallway", seed=seed)
        for i in range(self.corridors):
            low, high = i * pitch, i * pitch + self.corridor_m
            if i:
                site.wall((begin_x, end_x), (low - 0.3, low))
            closed = high if i != self.way_out else high - self.gap_m
            site.pane("wall", (end_x - 0.15, low), (end_x - 0.15, closed))
        line_m = self.towards * pitch + 0.5 * self.corridor_m
        goal_y = min(max(line_m, 1.0), width_m - 1.0)
        site.goal_furniture(self.goal, end_x + 3.2, goal_y)
        zone_m = (begin_x, 0.0, end_x + 0.2, width_m)
        return Scene(site, Pose(1.2, line_m, self.yaw_rad), self.goal, zone_m)


def pane_across(site: TrapSite, x: float, gap: tuple[float, float]) -> None:
    """Adds a pane across the whole hall at `x` that is open along `gap` (a span of y)."""
    for low, high in ((0.0, gap[0]), (gap[1], site.rect.y1)):
        if high - low > 0.01:
            site.pane("window", (x, low), (x, high))
