"""Rows of rooms along one side of a corridor: their widths, their rectangles and their doors."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from sim.homes.housegen.floor_plan.draft import Draft
from sim.homes.housegen.floor_plan.plan import PlanError
from sim.homes.housegen.floor_plan.rectangles import Rect, in_steps
from sim.homes.housegen.floor_plan.rooms import GAP, ROOM_RULES, Column
from sim.homes.housegen.floor_plan.wings import PUBLIC_KINDS

CUT = (0.46, 0.54)
"""Range of the depth of a front room relative to that of a row, where another room lies behind it."""
STAIRS_DEPTH_M = 4.8
"""Depth of a row in which a flight of stairs lies across it."""
ToRect = Callable[[float, float, float, float], Rect]
"""Turns s0, s1 along a corridor and t0, t1 away from it into a rectangle in the frame of the plan."""


@dataclass(frozen=True)
class Row:
    """Columns along one side of a corridor, and their depth."""

    columns: tuple[Column, ...]
    depth_m: float
    scale: float
    """Size of the rooms relative to the usual one."""

    def widths_m(self, corridor_m: float) -> np.ndarray:
        """Returns (n, 3) smallest, usual and largest widths of the columns; `corridor_m` is that of a gap.

        A column whose smallest width exceeds its largest one does not suit the depth of the row.
        """
        return np.array([self._column_widths_m(column, corridor_m) for column in self.columns])

    def _column_widths_m(self, column: Column, corridor_m: float) -> tuple[float, float, float]:
        if column.front == GAP:
            return corridor_m, corridor_m, corridor_m
        rules = [ROOM_RULES[kind] for kind in (column.front, column.back) if kind]
        usable = self.depth_m if len(rules) == 1 else self.depth_m / 2
        deepest = self.depth_m if len(rules) == 1 else self.depth_m * CUT[1]
        low = max(max(rule.area_m2[0] / usable for rule in rules), max(rule.short_m for rule in rules))
        low = max(low, max(usable / rule.aspect for rule in rules))
        low = max(low, max(rule.long_m if rule.long_m > usable else 0.0 for rule in rules))
        high = min(min(rule.area_m2[2] for rule in rules) / deepest, min(rule.aspect for rule in rules) * usable)
        usual = self.scale * sum(rule.area_m2[1] for rule in rules) / self.depth_m
        return low, min(max(usual, low), high), high


def with_stairs_m(depth_m: float, required: Sequence[str]) -> float:
    """Returns the depth of a row, deep enough for a flight of stairs where a stair hall is required."""
    return max(depth_m, STAIRS_DEPTH_M) if "stair_hall" in required else depth_m


def draw_length_m(rng: np.random.Generator, low_m: float, high_m: float) -> float:
    """Returns a length between two others, in steps of 5 cm."""
    return in_steps(rng.uniform(low_m, high_m))


def draw_depth_m(rng: np.random.Generator, low_m: float, high_m: float, scale: float) -> float:
    """Returns the depth of a row, drawn for rooms of the usual size; it grows with the root of their area."""
    return round(draw_length_m(rng, low_m, high_m) * scale**0.5, 1)


def draw_common_length_m(rng: np.random.Generator, upper: Row, lower: Row, corridor_m: float) -> float:
    """Returns a corridor length for which both rows can be filled.

    Raises:
        PlanError: no length fits both rows.
    """
    of_rows = [row.widths_m(corridor_m) for row in (upper, lower) if row.columns]
    if any((widths_m[:, 0] > widths_m[:, 2]).any() for widths_m in of_rows):
        raise PlanError("a room does not suit the depth of its row")
    ranges = [widths_m.sum(axis=0) for widths_m in of_rows]
    low, high = max(r[0] for r in ranges), min(r[2] for r in ranges)
    if low > high:
        raise PlanError(f"rows of {ranges[0][1]:.1f} m and {ranges[-1][1]:.1f} m do not fit one corridor")
    usual = float(np.mean([r[1] for r in ranges]) * rng.uniform(0.95, 1.05))
    return in_steps(np.clip(usual, low, high))


def _fitted_widths_m(row: Row, length_m: float, corridor_m: float) -> list[float]:
    """Returns widths of the row's columns that add up to `length_m`, in steps of 5 cm where possible."""
    widths = row.widths_m(corridor_m)
    now = widths[:, 1].copy()
    for _ in range(8):
        rest = length_m - now.sum()
        room = (widths[:, 2] - now) if rest > 0 else (now - widths[:, 0])
        if abs(rest) < 1e-9 or room.sum() < 1e-9:
            break
        now += np.sign(rest) * room * min(1.0, abs(rest) / room.sum())
    edges = np.round(np.cumsum(now) * 20.0) / 20.0
    edges[-1] = length_m
    return np.diff(edges, prepend=0.0).tolist()


def add_row(
    rng: np.random.Generator,
    draft: Draft,
    hall: int,
    row: Row,
    length_m: float,
    corridor_m: float,
    to_rect: ToRect,
) -> list[Rect]:
    """Adds a row's rooms and their doors to a draft; returns the gaps left for branch corridors."""
    gaps: list[Rect] = []
    if not row.columns:
        return gaps
    at = 0.0
    fronts: list[int | None] = []
    backs: list[int | None] = []
    for column, width_m in zip(row.columns, _fitted_widths_m(row, length_m, corridor_m), strict=True):
        s0, s1, at = at, at + width_m, at + width_m
        if column.front == GAP:
            gaps.append(to_rect(s0, s1, 0.0, row.depth_m))
            fronts.append(None)
            backs.append(None)
            continue
        cut = row.depth_m if column.back is None else round(row.depth_m * float(rng.uniform(*CUT)), 2)
        front = draft.add(column.front, to_rect(s0, s1, 0.0, cut))
        wide = column.front == "stair_hall" or (column.front == "living_room" and rng.random() < 0.5)
        draft.join(hall, front, "opening" if wide else "door")
        fronts.append(front)
        backs.append(draft.add(column.back, to_rect(s0, s1, cut, row.depth_m)) if column.back else None)
    _join_row(rng, draft, fronts, backs)
    return gaps


def _join_row(rng: np.random.Generator, draft: Draft, fronts: list[int | None], backs: list[int | None]) -> None:
    """Connects each back room with the bedroom next to it or the room in front, and neighbouring public rooms."""
    for i, back in enumerate(backs):
        if back is not None:
            bedroom = fronts[i - 1] if i > 0 else None
            owner = bedroom if bedroom is not None and draft.kinds[bedroom] == "bedroom" else fronts[i]
            assert owner is not None
            draft.join(owner, back, "door")
    for left, right in itertools.pairwise(fronts):
        if left is not None and right is not None and {draft.kinds[left], draft.kinds[right]} <= PUBLIC_KINDS:
            draft.join(left, right, "opening" if rng.random() < 0.7 else "door")
