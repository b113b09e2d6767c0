"""Queue of private rooms from which rows of a given length are filled."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence

import numpy as np

from sim.homes.housegen.floor_plan.draft import Draft
from sim.homes.housegen.floor_plan.frames import Frame
from sim.homes.housegen.floor_plan.plan import PlanError
from sim.homes.housegen.floor_plan.programme import Group, draw_groups, draw_numbers, may_add
from sim.homes.housegen.floor_plan.rooms import GAP, ROOM_RULES, Column
from sim.homes.housegen.floor_plan.rows import Row, add_row

_BEDROOM, _BATHROOM, _OFFICE, _LAUNDRY, _CLOSET = (
    (Column(kind),) for kind in ("bedroom", "bathroom", "office", "laundry", "closet")
)
_MORE: tuple[Group, ...] = (_BEDROOM, _BATHROOM, _OFFICE, _CLOSET, _LAUNDRY)
"""Groups that are added when no group of the queue fits."""
_SHARES = {"bedroom": 4.0, "bathroom": 1.5, "office": 1.5, "closet": 1.2, "laundry": 0.5}
"""Usual numbers of rooms of these kinds in a home, relative to each other."""
WITHOUT_DAYLIGHT = frozenset(("bathroom", "closet", "laundry", "gym"))
"""Rooms that may lie in the core of a home, without windows."""

MORE_M = 2.5
"""Length of a row that remains, from which further rooms are added although the others could be larger."""


class RoomQueue:
    """Groups of private rooms in the order in which they are placed."""

    def __init__(
        self, rng: np.random.Generator, area_m2: float, private_m2: float, required: Sequence[str] = ()
    ) -> None:
        """Makes a queue of rooms for a home; those that it needs come first.

        Args:
            rng: source of the rooms and their order.
            area_m2: floor area of the home.
            private_m2: floor area of the private rooms.
            required: kinds of rooms that the home has at least, as often as they are named.
        """
        groups = draw_groups(rng, draw_numbers(rng, area_m2, private_m2, required))
        missing = Counter(required) | Counter(("bedroom", "bathroom"))
        first, rest = [], []
        for group in [groups[i] for i in rng.permutation(len(groups))]:
            kinds = _kinds(group)
            (first if missing & kinds else rest).append(group)
            missing -= kinds
        self._groups = first + rest
        self._placed: Counter[str] = Counter()

    def take(self, fits: Callable[[Group], bool], *, more: bool) -> Group | None:
        """Removes and returns the first group that fits, with `more` else a further room; None if nothing fits."""
        for i, group in enumerate(self._groups):
            if fits(group):
                return self._count(self._groups.pop(i))
        planned = sum(map(_kinds, self._groups), self._placed)
        allowed = [group for group in _MORE if more and may_add(planned, group[0].front)]
        others = [group for group in allowed if fits(group)]
        return self._count(min(others, key=self._excess)) if others else None

    def _count(self, group: Group) -> Group:
        self._placed += _kinds(group)
        return group

    def _excess(self, group: Group) -> float:
        """Returns how many rooms of the kind of a group there are, relative to how many a home usually has."""
        return self._placed[group[0].front] / _SHARES[group[0].front]

    def add(self, kind: str) -> bool:
        """Counts a room that is placed without the queue; returns False if the home may not have it."""
        planned = sum(map(_kinds, self._groups), self._placed)
        if may_add(planned, kind):
            self._placed[kind] += 1
            return True
        return False

    def fill_row(
        self,
        rng: np.random.Generator,
        length_m: float,
        depth_m: float,
        scale: float,
        *,
        gap_m: float = 0.0,
        kinds: frozenset[str] | None = None,
    ) -> Row:
        """Returns a row of rooms that can be fitted to a length; they are removed from the queue.

        Args:
            rng: source of the order of the rooms.
            length_m: length of the row.
            depth_m: its depth.
            scale: size of the rooms relative to the usual one.
            gap_m: width of the gap for a branch corridor; 0 for none.
            kinds: kinds of rooms that it may have; all when None.

        Raises:
            PlanError: no rooms fit.
        """
        taken: list[Group] = []
        while True:
            low, usual, high = _widths_m(taken, depth_m, scale, gap_m)

            def fits(group: Group, low: float = low, usual: float = usual) -> bool:
                if kinds is not None and any(kind not in kinds for c in group for kind in (c.front, c.back) if kind):
                    return False
                if any(depth_m / (1 + (c.back is not None)) < ROOM_RULES[c.front].short_m for c in group):
                    return False
                own = Row(group, depth_m, scale).widths_m(0.0)
                if (own[:, 0] > own[:, 2]).any():
                    return False
                own_low, own_usual, _ = own.sum(axis=0)
                return low + own_low <= length_m + 1e-9 and usual + 0.55 * own_usual <= length_m

            group = self.take(fits, more=high < length_m or length_m - usual > MORE_M)
            if group is None:
                break
            taken.append(group)
        low, _, high = _widths_m(taken, depth_m, scale, gap_m)
        if not low - 1e-9 <= length_m <= high + 1e-9:
            raise PlanError(f"rooms of {low:.1f}-{high:.1f} m do not fill a row of {length_m:.1f} m")
        groups = [taken[i] for i in rng.permutation(len(taken))]
        if gap_m:
            groups.insert(int(rng.integers(0, len(groups) + 1)), (Column(GAP),))
        return Row(tuple(column for group in groups for column in group), depth_m, scale)


def add_private_rows(
    rng: np.random.Generator,
    draft: Draft,
    hall: int,
    queue: RoomQueue,
    span_m: tuple[float, float],
    corridor_m: float,
    deep_m: tuple[float, float],
    scale: float,
) -> None:
    """Adds rows of private rooms to a corridor along +x that has public rooms at the beginning of its north side.

    Args:
        rng: source of the order of the rooms and of their doors.
        draft: the plan.
        hall: index of the corridor.
        queue: rooms that are taken.
        span_m: x at which the public rooms end, and the length of the corridor, which begins at x = 0.
        corridor_m: width of the corridor.
        deep_m: depth of the south row, which is as long as the corridor, and of the north row behind the public rooms.
        scale: size of the rooms relative to the usual one.

    Raises:
        PlanError: no rooms fit.
    """
    begin_m, end_m = span_m
    row = queue.fill_row(rng, end_m, deep_m[0], scale)
    frame = Frame(0.0, 0.0, "east")
    add_row(rng, draft, hall, row, end_m, corridor_m, frame.right())
    if begin_m < end_m:
        row = queue.fill_row(rng, end_m - begin_m, deep_m[1], scale)
        add_row(rng, draft, hall, row, end_m - begin_m, corridor_m, frame.left(begin_m, corridor_m))


def _widths_m(groups: Sequence[Group], depth_m: float, scale: float, gap_m: float) -> tuple[float, float, float]:
    """Returns the smallest, usual and largest width of some groups side by side, with a gap."""
    columns = tuple(column for group in groups for column in group)
    if not columns:
        return gap_m, gap_m, gap_m
    low, usual, high = (Row(columns, depth_m, scale).widths_m(0.0).sum(axis=0) + gap_m).tolist()
    return low, usual, high


def _kinds(group: Group) -> Counter[str]:
    """Returns the numbers of rooms of each kind in a group."""
    return Counter(kind for column in group for kind in (column.front, column.back) if kind)
