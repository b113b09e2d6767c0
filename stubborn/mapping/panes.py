"""Finds straight surfaces, such as glass panes, from the places where a round robot was stopped."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64

from sim.core.interface import ConfigError


@dataclass(frozen=True, kw_only=True)
class LineRule:
    """The conditions under which stops lie on one straight surface."""

    straight_m: float = 0.01
    """Stops belong to a line if their centres are at most this far from it."""
    apart_m: float = 0.10
    """Two stops must be at least this far apart to define a line."""
    link_m: float = 0.90
    """Neighbouring stops of a pane are at most this far apart."""
    facing: float = 0.4
    """Cosine of the largest angle between the heading (or `contact_direction`) at a stop and the surface's normal."""
    least_stops: int = 3
    """A line through this many stops is a pane."""

    def __post_init__(self) -> None:
        if self.least_stops < 2 or min(self.straight_m, self.apart_m, self.link_m) <= 0.0:
            raise ConfigError(
                "LineRule needs least_stops >= 2 and straight_m, apart_m and link_m > 0 m, got "
                f"{self.least_stops}, {self.straight_m}, {self.apart_m} and {self.link_m}."
            )


@dataclass(frozen=True)
class Pane:
    """A straight surface, by the line on which the robot's centre was at each stop."""

    normal: Float64[np.ndarray, " xy"]
    """Unit vector from the robot to the surface."""
    offset_m: float
    """Distance of the line from the origin along the normal."""
    stops: Bool[np.ndarray, " stops"]
    """The stops on the line."""

    @property
    def along(self) -> Float64[np.ndarray, " xy"]:
        """Unit vector along the surface."""
        return np.array([-self.normal[1], self.normal[0]])

    def point(self, along_m: float, ahead_m: float) -> tuple[float, float]:
        """Returns the point at a position along the surface and a distance beyond the line, metres."""
        x_m, y_m = along_m * self.along + (self.offset_m + ahead_m) * self.normal
        return float(x_m), float(y_m)


def find_panes(
    centres: Float64[np.ndarray, "stops xy"], headings: Float64[np.ndarray, "stops xy"], rule: LineRule
) -> list[Pane]:
    """Returns the lines through the most stops, each stop on at most one line.

    Args:
        centres: of the robot at each stop, metres.
        headings: unit vectors.
        rule: the conditions for a line.
    """
    first, second = np.triu_indices(len(centres), 1)
    between = centres[second] - centres[first]
    length_m = np.hypot(*between.T)
    fits = (length_m >= rule.apart_m) & (length_m <= rule.link_m)
    first, second, between = first[fits], second[fits], between[fits]
    normals = np.stack([-between[:, 1], between[:, 0]], axis=1) / length_m[fits, None]
    normals *= np.where((normals * headings[first]).sum(axis=1) < 0.0, -1.0, 1.0)[:, None]
    offset_m = (normals * centres[first]).sum(axis=1)
    on_line = np.abs(normals @ centres.T - offset_m[:, None]) <= rule.straight_m  # (pairs, stops)
    on_line &= normals @ headings.T >= rule.facing
    panes, unassigned = [], np.ones(len(centres), np.bool_)
    while True:
        at_most, best, pane = (on_line & unassigned).sum(axis=1), rule.least_stops - 1, None
        for pair in np.argsort(-at_most, kind="stable").tolist():
            if at_most[pair] <= best:
                break
            ends = int(first[pair]), int(second[pair])
            stops = _linked(centres, normals[pair], on_line[pair] & unassigned, ends, rule.link_m)
            if stops.sum() > best:
                best = int(stops.sum())
                pane = Pane(normals[pair], float((centres[stops] @ normals[pair]).mean()), stops)
        if pane is None:
            return panes
        panes.append(pane)
        unassigned &= ~pane.stops


def _linked(
    centres: Float64[np.ndarray, "stops xy"],
    normal: Float64[np.ndarray, " xy"],
    on_line: Bool[np.ndarray, " stops"],
    ends: tuple[int, int],
    link_m: float,
) -> Bool[np.ndarray, " stops"]:
    """Returns the stops on a line that are linked with two of them by steps of at most `link_m`; empty without both."""
    stops = np.zeros_like(on_line)
    if not (on_line[ends[0]] and on_line[ends[1]]):
        return stops
    along_m = centres @ np.array([-normal[1], normal[0]])
    order = np.flatnonzero(on_line)[np.argsort(along_m[on_line])]
    part = np.concatenate([[0], np.cumsum(np.diff(along_m[order]) > link_m)])
    stops[order[part == part[order == ends[0]]]] = True
    return stops
