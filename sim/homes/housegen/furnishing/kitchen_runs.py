"""Plans the units of a kitchen along its walls: one run, an L, a U, two runs opposite each other, or two walls apart.

Rules of the NKBA Kitchen Planning Guidelines: the work triangle between the fronts of sink, cooker and fridge adds up
to 13-26 ft (4.0-7.9 m; guideline 3), no tall unit stands between two of them (4), work aisles are at least 42 in wide
(1.07 m; 6), and there is worktop next to each of the three (11, 13, 17). The fridge is therefore at the end of a run.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

from sim.homes.housegen.floor_plan.rectangles import OPPOSITE, SIDES, Interval, Side
from sim.homes.housegen.furnishing.placement import RoomLayout
from sim.world.arrangement import MAX_TRIANGLE_M, MIN_TRIANGLE_M

Kind = Literal["fridge", "cooker", "dishwasher", "sink", "top", "sink_and_hob"]
Shape = Literal["line", "L", "U", "galley", "apart"]

DEPTH_M = 0.66
"""Depth of a run with its gap to the wall; in a corner, this much of the other run begins behind it."""
FRIDGE_DEPTH_M = 0.74
"""Depth that has to be free for a run."""
MIN_GALLEY_M = 2 * DEPTH_M + 0.95
"""Smallest distance between two walls with runs along both."""
MARGIN_M = 0.15
"""The planned work triangle keeps this far from its limits, since the sink is not always in the middle of its unit."""
BESIDE_COOKER_M = 1.2
"""Smallest width of a unit with a sink in its middle that leaves 0.3 m of worktop before a cooker."""
LONG_LEG_M = 2.75
"""A side of the work triangle that is longer than this (9 ft; guideline 3) is worse."""
WORST_SCORE = -3.0
"""Plans that are worse than this, such as a fridge before a window, are not used."""
GAP_M = 0.003


@dataclass(frozen=True)
class Unit:
    """A unit of a run, and the widths that it may have; appliances have their own width."""

    kind: Kind
    low_m: float = 0.6
    high_m: float = 0.6


@dataclass(frozen=True)
class Leg:
    """A stretch of wall for a run: it begins at `start` and goes on towards larger (+1) or smaller (-1) positions."""

    side: Side
    start_m: float
    sign: int
    length_m: float
    blind_m: tuple[float, float] = (0.0, 0.0)
    """Lengths at its beginning and its end that lie behind another run."""

    def at(self, along_m: float) -> float:
        """Returns the position along the side of a point this far from the beginning."""
        return self.start_m + self.sign * along_m


@dataclass(frozen=True)
class Run:
    """The units of a leg with their widths, from its beginning."""

    leg: Leg
    units: tuple[tuple[Kind, float], ...]

    def spans(self) -> Iterator[tuple[Kind, float, float]]:
        """Yields kind, distance from the beginning, and width of each unit."""
        at = GAP_M
        for kind, width_m in self.units:
            yield kind, at, width_m
            at += width_m + GAP_M


FRIDGE, COOKER, DISHWASHER = Unit("fridge"), Unit("cooker"), Unit("dishwasher")
CORNER = Unit("top", DEPTH_M + 0.3, DEPTH_M + 0.7)


def _top(low_m: float = 0.4, high_m: float = 0.9) -> Unit:
    return Unit("top", low_m, high_m)


def _sink(low_m: float = 0.9, high_m: float = 1.4) -> Unit:
    return Unit("sink", low_m, high_m)


TEMPLATES: Mapping[Shape, tuple[tuple[tuple[Unit, ...], ...], ...]] = MappingProxyType(
    {
        "line": (
            ((FRIDGE, _sink(1.3, 2.0), COOKER, _top(0.4, 1.2)),),
            ((FRIDGE, DISHWASHER, _sink(BESIDE_COOKER_M, 1.7), COOKER, _top(0.4, 1.2)),),
            ((FRIDGE, _sink(0.9, 1.2), _top(0.6, 1.4), COOKER, _top(0.4, 1.2)),),
        ),
        "L": (
            ((CORNER, _sink(), _top(0.0, 0.6)), (_top(), COOKER, _top(0.4, 0.8), FRIDGE)),
            ((CORNER, DISHWASHER, _sink()), (_top(), COOKER, _top(0.4, 0.8), FRIDGE)),
            ((CORNER, _sink(), FRIDGE), (_top(), COOKER, _top(0.4, 1.0))),
            ((CORNER, COOKER, _top(0.4, 1.0), FRIDGE), (_sink(0.9, 1.8),)),
            ((CORNER, COOKER, _top(0.4, 1.0)), (_sink(0.9, 1.8), FRIDGE)),
            ((CORNER, _sink(0.9, 1.2), _top(0.5, 1.0), COOKER, _top(0.4, 0.8)), (_top(0.4, 1.4), FRIDGE)),
        ),
        "U": (
            ((CORNER, _sink(0.9, 1.6), CORNER), (_top(0.4, 0.8), COOKER, _top(0.4, 0.9)), (_top(0.4, 1.2), FRIDGE)),
            ((CORNER, _sink(0.9, 1.6), CORNER), (_top(0.4, 0.8), COOKER, _top(0.4, 0.8), FRIDGE), (_top(0.6, 1.6),)),
        ),
        "galley": (
            ((_top(0.4, 0.9), COOKER, _top(0.5, 1.0), FRIDGE), (_sink(0.9, 2.0),)),
            ((_top(0.4, 1.0), COOKER, _top(0.4, 1.0)), (_sink(0.9, 1.6), FRIDGE)),
        ),
        "apart": (
            ((_sink(BESIDE_COOKER_M, 1.6), COOKER, _top(0.4, 0.9)), (_top(0.4, 0.9), FRIDGE)),
            ((FRIDGE, _sink(0.9, 1.8)), (_top(0.4, 0.8), COOKER, _top(0.4, 0.8))),
        ),
    }
)
"""Units of each run by the shape of the kitchen, from the corner outwards."""
FILLED = (1.0, 0.6, 0.2)
"""Shares of the spare length that the units take up: with another share, the cooker may stand between two windows."""
SHORT: tuple[tuple[tuple[Unit, ...], ...], ...] = (
    ((FRIDGE, _sink(BESIDE_COOKER_M, 1.4), COOKER),),
    ((FRIDGE, Unit("sink_and_hob", 2.0, 2.4)),),
)
"""Single runs for kitchens in which no other plan fits."""


def kitchen_plans(
    layout: RoomLayout, appliance_widths_m: Mapping[Kind, float], jitter: Sequence[float], *, longest_m: float
) -> list[tuple[Run, ...]]:
    """Returns plans of the runs of a kitchen, the best first, those of short single runs last.

    Args:
        layout: the room.
        appliance_widths_m: widths of the fridge, the cooker and the dishwasher.
        jitter: random numbers from 0 to 1, which decide between plans that are about equally good.
        longest_m: greatest length of a run.
    """
    noise = itertools.cycle(jitter)
    scored: list[tuple[float, tuple[Run, ...]]] = []
    for shape, legs in _legs(layout, longest_m):
        for template, filled in itertools.product(TEMPLATES[shape], FILLED):
            plan = _fitted(legs, template, appliance_widths_m, filled)
            triangle_m = work_triangle_m(layout, plan) if plan else 0.0
            if plan and MIN_TRIANGLE_M + MARGIN_M < triangle_m < MAX_TRIANGLE_M - MARGIN_M:
                scored.append((_score(layout, shape, plan) + 1.6 * next(noise), plan))
    scored = [(score, plan) for score, plan in scored if score > WORST_SCORE]
    plans = [plan for _, plan in sorted(scored, key=lambda entry: -entry[0])]
    for template in SHORT:
        fitted = [
            _fitted(legs, template, appliance_widths_m)
            for shape, legs in _legs(layout, longest_m)
            if shape == "line" and _is_short(legs[0])
        ]
        plans += [plan for plan in fitted if plan]
    return plans


def work_triangle_m(layout: RoomLayout, plan: Sequence[Run]) -> float:
    """Returns the sum of the distances between the middles of the fronts of sink, cooker and fridge."""
    return sum(_triangle_legs_m(layout, plan))


def _triangle_legs_m(layout: RoomLayout, plan: Sequence[Run]) -> list[float]:
    """Returns the distances between the middles of the fronts of sink, cooker and fridge."""
    fronts = [
        layout.walls.point(run.leg.side, run.leg.at(start_m + width_m / 2), DEPTH_M)
        for run in plan
        for kind, start_m, width_m in run.spans()
        if kind in ("sink", "cooker", "fridge")
    ]
    return [math.dist(a, b) for a, b in itertools.combinations(fronts, 2)]


def _is_short(leg: Leg) -> bool:
    return leg.length_m < 3.4


def _score(layout: RoomLayout, shape: Shape, plan: Sequence[Run]) -> float:
    """Returns how well a plan suits the room: enough worktop, few odd gaps, the sink and not the hob at a window."""
    area_m2 = layout.inner.area_m2
    suits = {
        "line": 0.6 if area_m2 < 9 else -0.6,
        "L": 0.8,
        "U": 0.8 if area_m2 > 10 else -0.5,
        "galley": 0.2,
        "apart": -2.5,  # where no other shape fits
    }
    score = suits[shape] - (1.5 if max(_triangle_legs_m(layout, plan)) > LONG_LEG_M else 0.0)
    for run in plan:
        used_m = sum(width_m for _, width_m in run.units)
        rest_m = run.leg.length_m - used_m
        score += 0.25 * min(used_m, 3.5) - (0.4 if 0.06 < rest_m < 0.55 else 0.0)
        windows = [hole.span for side, hole in layout.walls.windows() if side == run.leg.side]
        for kind, start_m, width_m in run.spans():
            lo, hi = sorted((run.leg.at(start_m), run.leg.at(start_m + width_m)))
            if any(hi > window[0] + 0.02 and lo < window[1] - 0.02 for window in windows):
                score += {"sink": 0.6, "cooker": -4.0, "fridge": -9.0, "sink_and_hob": -1.0}.get(kind, 0.0)
    return score


def _fitted(
    legs: Sequence[Leg],
    template: Sequence[Sequence[Unit]],
    appliance_widths_m: Mapping[Kind, float],
    filled: float = 1.0,
) -> tuple[Run, ...] | None:
    """Returns the units of a template with widths that fill a share of the legs; None if a leg is too short."""
    runs = []
    for leg, units in zip(legs, template, strict=True):
        low = [appliance_widths_m.get(unit.kind, unit.low_m) for unit in units]
        high = [appliance_widths_m.get(unit.kind, unit.high_m) for unit in units]
        if leg.blind_m[1] == 0.0 and units[-1] is CORNER:
            return None
        slack_m = leg.length_m - sum(low) - GAP_M * (len(units) + 1)
        if slack_m < 0.0:
            return None
        stretch_m = sum(high) - sum(low)
        share = filled * min(1.0, slack_m / stretch_m) if stretch_m > 0.0 else 0.0
        widths = [
            math.floor(100.0 * (a + share * (b - a))) / 100.0 if b > a else a for a, b in zip(low, high, strict=True)
        ]
        runs.append(Run(leg, tuple((u.kind, w) for u, w in zip(units, widths, strict=True) if w >= 0.2)))
    return tuple(runs)


def _legs(layout: RoomLayout, longest_m: float) -> Iterator[tuple[Shape, tuple[Leg, ...]]]:
    """Yields the legs of every shape that the room's free walls allow."""
    free: dict[Side, list[Interval]] = {side: layout.free_spans(side, FRIDGE_DEPTH_M) for side in SIDES}
    for side in SIDES:
        for lo, hi in free[side]:
            length_m = min(hi - lo, longest_m)
            yield "line", (Leg(side, lo, 1, length_m),)
            yield "line", (Leg(side, hi, -1, length_m),)
    for side, end in itertools.product(SIDES, (0, 1)):
        corner = _corner(layout, free, side, end, longest_m)
        if corner is None:
            continue
        yield "L", corner
        other = _corner(layout, free, side, 1 - end, longest_m)
        whole = layout.inner.span(side)
        if other is not None and (free[side][0][1] - free[side][0][0]) > whole[1] - whole[0] - 0.02:
            length_m = whole[1] - whole[0]
            if DEPTH_M * 2 + 0.9 < length_m <= longest_m + DEPTH_M:
                middle = Leg(side, corner[0].start_m, corner[0].sign, length_m, (DEPTH_M, DEPTH_M))
                yield "U", (middle, corner[1], other[1])
    for side in SIDES:
        across_m = layout.inner.area_m2 / max(layout.inner.span(side)[1] - layout.inner.span(side)[0], 0.1)
        if not MIN_GALLEY_M <= across_m <= MIN_GALLEY_M + 0.8:
            continue
        for (a, b), (c, d) in itertools.product(free[side], free[OPPOSITE[side]]):
            if min(b, d) - max(a, c) > 0.9:
                yield "galley", (_leg(side, (a, b), 1, longest_m), _leg(OPPOSITE[side], (c, d), 1, longest_m))
                yield "galley", (_leg(side, (a, b), -1, longest_m), _leg(OPPOSITE[side], (c, d), -1, longest_m))
    spans: list[tuple[Side, Interval]] = [(side, span) for side in SIDES for span in free[side]]
    for (side, span), (other_side, other_span) in itertools.permutations(spans, 2):
        if side != other_side:
            for sign, other_sign in itertools.product((1, -1), (1, -1)):
                yield "apart", (_leg(side, span, sign, longest_m), _leg(other_side, other_span, other_sign, longest_m))


def _leg(side: Side, span: Interval, sign: int, longest_m: float) -> Leg:
    return Leg(side, span[0] if sign > 0 else span[1], sign, min(span[1] - span[0], longest_m))


def _corner(
    layout: RoomLayout, free: Mapping[Side, Sequence[Interval]], side: Side, end: int, longest_m: float
) -> tuple[Leg, Leg] | None:
    """Returns the legs from a corner: along `side` from its lower (0) or upper (1) end, and along the other wall."""
    ends: tuple[Side, Side] = ("south", "north") if side in ("east", "west") else ("west", "east")
    other, other_end = ends[end], 1 if side in ("east", "north") else 0
    legs = []
    walls: tuple[tuple[Side, int], ...] = ((side, end), (other, other_end))
    for wall, at_end in walls:
        corner = layout.inner.span(wall)[at_end]
        span = next((s for s in free[wall] if abs(s[at_end] - corner) < 0.02), None)
        if span is None:
            return None
        legs.append(Leg(wall, corner, 1 if at_end == 0 else -1, min(span[1] - span[0], longest_m)))
    first, second = legs
    rest_m = second.length_m - DEPTH_M
    if rest_m < 0.4:
        return None
    return (
        Leg(first.side, first.start_m, first.sign, first.length_m, (DEPTH_M, 0.0)),
        Leg(second.side, second.at(DEPTH_M), second.sign, rest_m),
    )
