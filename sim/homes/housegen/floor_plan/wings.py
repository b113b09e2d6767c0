"""Distributes the rooms of a home over its wings and over the two rows of each wing."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sim.homes.housegen.floor_plan.plan import PlanError
from sim.homes.housegen.floor_plan.programme import Group, Program
from sim.homes.housegen.floor_plan.rooms import GAP, Column, PlanKind

PUBLIC_KINDS = frozenset(("living_room", "kitchen", "dining_room"))
TwoRows = tuple[list[Column], list[Column]]
"""Columns of the two rows along a corridor."""


def draw_wings(
    rng: np.random.Generator, kind: PlanKind, program: Program, public_at_end: bool
) -> tuple[TwoRows, list[TwoRows]]:
    """Returns the columns of the main wing (upper, lower row) and of each branch (left, right row).

    With `public_at_end` the public rooms are left out: they form a block of their own.

    Raises:
        PlanError: there are too few rooms for the wings.
    """
    groups = [program.private[i] for i in rng.permutation(len(program.private))]
    if not public_at_end:
        groups.insert(0, tuple(Column(room) for room in program.public))
    three = len(groups) >= 8 and rng.random() < 0.6  # drawn for every kind of plan
    wings = {"lshape": 2, "large": 3 if three else 2}.get(kind, 1)
    shares = [groups] if wings == 1 else _split_groups(groups, wings)
    main = _two_rows(rng, shares[0])
    branches = []
    for row, share in zip(main, shares[1:], strict=False):
        at = len(row) if kind == "lshape" or rng.random() < 0.3 else int(rng.integers(0, len(row) + 1))
        row.insert(_between_groups(row, at), Column(GAP))
        branches.append(_two_rows(rng, share))
    return main, branches


def _split_groups(groups: Sequence[Group], parts: int) -> list[list[Group]]:
    """Returns the groups divided into consecutive parts of about the same area."""
    areas = [_area_m2(group) for group in groups]
    shares: list[list[Group]] = [[] for _ in range(parts)]
    done = 0.0
    for group, area in zip(groups, areas, strict=True):
        shares[min(int(parts * (done + 0.5 * area) / sum(areas)), parts - 1)].append(group)
        done += area
    if not all(shares):
        raise PlanError(f"{len(groups)} groups of rooms do not fill {parts} wings")
    return shares


def _two_rows(rng: np.random.Generator, groups: Sequence[Group]) -> TwoRows:
    """Returns the groups distributed over two rows of about the same area, each row in random order."""
    rows: tuple[list[Group], list[Group]] = ([], [])
    areas = [0.0, 0.0]
    for group in sorted(groups, key=lambda g: -_area_m2(g)):
        i = int(areas[1] < areas[0])
        rows[i].append(group)
        areas[i] += _area_m2(group)
    flat: list[list[Column]] = []
    for row in rows:
        order = [row[i] for i in rng.permutation(len(row))]
        flat.append([column for group in order for column in group])
    return flat[0], flat[1]


def _between_groups(row: list[Column], at: int) -> int:
    """Returns the first position from `at` on where a corridor does not separate rooms that belong together."""
    while (at < len(row) and row[at].back is not None) or (at < len(row) and at > 0 and _belong(row[at - 1], row[at])):
        at += 1
    return at


def _belong(left: Column, right: Column) -> bool:
    """Returns whether two neighbouring columns belong together."""
    return right.back is not None or {left.front, right.front} <= PUBLIC_KINDS


def _area_m2(group: Group) -> float:
    return sum(column.usual_area_m2 for column in group)
