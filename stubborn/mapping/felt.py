"""Infers surfaces from blocked forwards: several stops along one line are a pane; this is not in the paper.

The centre of a round robot that touches a flat surface is one radius away from it, at any heading. If the centres of
several stops lie on a line, the stops belong to one straight surface, such as a glass pane. Three conclusions follow,
which a mark straight ahead of each stop (`stubborn.mapping.collision_marks`) misses:

1. The contact is where the surface is, not straight ahead.
2. A robot that stopped beyond the line has its hull in a gap, and touches the gap's edge. The distance beyond the line
   says how far the edge is from its middle, and the known part of the pane on which side.
3. Two contacts that are nearer to each other than the robot is wide leave no passage between them. A wider part of the
   line between contacts may be a passage.

All marks are computed again after each stop, so that a later stop can correct an earlier conclusion. Marks do not count
where the body has been (`ProvenGround`).
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Bool, Float64, Int

from sim.core.geometry.grid import cells_near_segment
from sim.core.geometry.pose import Pose
from sim.core.interface import ConfigError
from stubborn.mapping.collision_marks import CollisionConfig, mark_collision
from stubborn.mapping.navmap import CollisionLayer, NavMap
from stubborn.mapping.panes import LineRule, Pane, find_panes

BOTH_LAYERS = (CollisionLayer.PESSIMISTIC, CollisionLayer.OPTIMISTIC)


@dataclass(frozen=True, kw_only=True)
class FeelConfig:
    """Parameters of the surfaces that are felt."""

    line: LineRule = field(default_factory=LineRule)
    """The stops that make a pane."""
    noise_sigmas: float = 2.5
    """With a noisy gps, stops may be this many standard deviations of a measured move from the line if this is more."""
    oblique: float = 0.26
    """A robot in a gap that drove along the surface (sine of its heading) touches the edge on that side; one that drove
    straight at it touches the edge of the part that is known."""
    spare_m: float = 0.06
    """A gap is tried if it is wider than the robot by at least this."""
    mark_m: float = 0.03
    """Half the thickness of a marked pane, which is a cell at least."""
    half_wide_m: float = 0.125
    """The pessimistic mark of a contact extends this far to both sides along its pane."""
    same_m: float = 0.03
    """A stop this near to an earlier one of about the same heading shows that the marks did not keep the robot from
    the same forward: both also get the marks straight ahead."""
    same_heading: float = 0.9
    """Cosine of the largest angle between two such headings."""

    def __post_init__(self) -> None:
        if self.mark_m <= 0.0 or min(self.noise_sigmas, self.spare_m, self.half_wide_m, self.same_m) < 0.0:
            raise ConfigError(
                "FeelConfig needs mark_m > 0 m, and noise_sigmas, spare_m, half_wide_m and same_m >= 0, got "
                f"{self.mark_m}, {self.noise_sigmas}, {self.spare_m}, {self.half_wide_m} and {self.same_m}."
            )

    def make(self, radius_m: float, squares: CollisionConfig) -> FeltSurfaces:
        """Returns an empty memory for a robot of this radius; stops outside of panes get the marks of `squares`."""
        return FeltSurfaces(self, radius_m, squares)


def contact_direction(yaw_rad: float, bumper: Int[np.ndarray, " sectors"] | None) -> float | None:
    """Returns the world angle from the robot to the contact that stopped it; None if nothing in front touched it.

    Without a bumper, or with a contact in its sector 0, this is the heading.

    Args:
        yaw_rad: heading of the robot.
        bumper: 1 for each sector of the hull with a contact, sector 0 ahead, the others counter-clockwise; None: the
            robot has no bumper.
    """
    if bumper is None or bumper[0]:
        return yaw_rad
    angles_rad = np.flatnonzero(bumper) * (math.tau / bumper.size)
    angles_rad = angles_rad[np.cos(angles_rad) > 0.0]
    if angles_rad.size == 0:
        return None
    return yaw_rad + math.atan2(np.sin(angles_rad).sum(), np.cos(angles_rad).sum())


class FeltSurfaces:
    """The stops of an episode, and the marks that follow from them."""

    def __init__(self, config: FeelConfig, radius_m: float, squares: CollisionConfig) -> None:
        self.config, self.radius_m, self.squares = config, radius_m, squares
        self.reset()

    def reset(self) -> None:
        """Forgets the last episode."""
        self._poses: list[Pose] = []
        self._doubted = 0  # stops before this one that are not part of a pane leave no marks
        self._straight_m = self.config.line.straight_m
        self.pushes = False
        """True: the last stop repeated an earlier one, so that the marks do not keep the robot from this forward."""
        self.panes: list[Pane] = []
        """The panes that follow from all stops so far."""

    def add(self, navmap: NavMap, pose: Pose, noise_m: float = 0.0) -> bool:
        """Enters a stop, and writes all marks again; returns True if they changed.

        Args:
            navmap: the map; its collision marks are replaced.
            pose: of the robot where it was stopped; its heading is `contact_direction`.
            noise_m: standard deviation of a measured move.
        """
        self._poses.append(pose)
        self._straight_m = max(self.config.line.straight_m, self.config.noise_sigmas * noise_m)
        return self._write(navmap)

    def doubt(self, navmap: NavMap) -> bool:
        """Drops the weakest conclusions, so that avoided places are tried again; returns True if marks changed.

        Marks of single stops are dropped first, since the contact may have been elsewhere on the hull; if there are
        none, all panes are dropped. Later stops count as before.
        """
        self._doubted = len(self._poses)
        if self._write(navmap):
            return True
        self._poses, self._doubted = [], 0
        return self._write(navmap)

    def _write(self, navmap: NavMap) -> bool:
        """Writes all marks again; returns True if they changed."""
        known = navmap.known_window(margin_cells=20).index
        before = [navmap.collision_marks(layer)[known].copy() for layer in BOTH_LAYERS]
        for layer in BOTH_LAYERS:
            navmap.collision_marks(layer)[known] = False
        self._mark(navmap)
        return any(
            bool((navmap.collision_marks(layer)[known] != old).any())
            for layer, old in zip(BOTH_LAYERS, before, strict=True)
        )

    def _mark(self, navmap: NavMap) -> None:
        """Writes the marks of all stops."""
        if not self._poses:
            self.panes, self.pushes = [], False
            return
        centres = np.array([pose.xy_m for pose in self._poses])
        headings = np.array([(np.cos(pose.yaw_rad), np.sin(pose.yaw_rad)) for pose in self._poses])
        self.panes = find_panes(centres, headings, replace(self.config.line, straight_m=self._straight_m))
        explained = np.zeros(len(centres), np.bool_)
        for pane in self.panes:
            edges = self._edges(pane, centres, headings, ~explained)
            explained |= pane.stops
            explained[list(edges)] = True
            self._mark_pane(navmap, pane, centres, edges)
        repeated = self._repeated(centres, headings)
        self.pushes = bool(repeated[-1])
        explained &= ~repeated
        explained[: self._doubted] = True
        for stop in np.flatnonzero(~explained).tolist():
            mark_collision(navmap, self._poses[stop], BOTH_LAYERS, self.squares)

    def _repeated(
        self, centres: Float64[np.ndarray, "stops xy"], headings: Float64[np.ndarray, "stops xy"]
    ) -> Bool[np.ndarray, " stops"]:
        """Returns the stops that happened more than once."""
        gap_m = np.hypot(*(centres[:, None] - centres[None]).transpose(2, 0, 1))
        same = (gap_m <= self.config.same_m) & (headings @ headings.T >= self.config.same_heading)
        return same.sum(axis=1) > 1

    def _edges(
        self,
        pane: Pane,
        centres: Float64[np.ndarray, "stops xy"],
        headings: Float64[np.ndarray, "stops xy"],
        free: Bool[np.ndarray, " stops"],
    ) -> dict[int, tuple[float, int]]:
        """Returns the stops in gaps of a pane: the position of the edge along it, and the side of the gap, +1 or -1."""
        beyond_m, along_m = centres @ pane.normal - pane.offset_m, centres @ pane.along
        on_pane_m = along_m[pane.stops]
        edges: dict[int, tuple[float, int]] = {}
        in_gap = free & ~pane.stops & (beyond_m > self._straight_m) & (beyond_m < self.radius_m)
        for stop in np.flatnonzero(in_gap).tolist():
            away_m = on_pane_m - along_m[stop]
            nearest_m, sideways = float(away_m[np.argmin(np.abs(away_m))]), float(headings[stop] @ pane.along)
            if abs(nearest_m) > self.config.line.link_m:
                continue
            side = np.sign(nearest_m if abs(sideways) < self.config.oblique else sideways)
            ahead_m = self.radius_m - float(beyond_m[stop])
            off_m = float(side * np.sqrt(self.radius_m**2 - ahead_m**2))
            if (ahead_m * pane.normal + off_m * pane.along) @ headings[stop] > 0.0:
                edges[stop] = float(along_m[stop]) + off_m, -int(side)
        return edges

    def _mark_pane(
        self,
        navmap: NavMap,
        pane: Pane,
        centres: Float64[np.ndarray, "stops xy"],
        edges: dict[int, tuple[float, int]],
    ) -> None:
        """Marks the contacts of a pane, and the parts between them that are too narrow for the robot."""
        wide_m, contacts = self.config.half_wide_m, [(float(a), 0) for a in (centres @ pane.along)[pane.stops]]
        contacts = sorted([*contacts, *edges.values()])
        for along_m, gap_side in contacts:  # a gap begins at an edge, so that its mark does not extend into it
            low_m = along_m if gap_side < 0 else along_m - wide_m
            high_m = along_m if gap_side > 0 else along_m + wide_m
            self._mark_segment(navmap, pane, (along_m, along_m), (CollisionLayer.OPTIMISTIC,))
            self._mark_segment(navmap, pane, (low_m, high_m), (CollisionLayer.PESSIMISTIC,))
        for (one_m, _), (next_m, _) in itertools.pairwise(contacts):
            if next_m - one_m < 2.0 * self.radius_m + self.config.spare_m:
                self._mark_segment(navmap, pane, (one_m, next_m), BOTH_LAYERS)

    def _mark_segment(
        self, navmap: NavMap, pane: Pane, span_m: tuple[float, float], layers: tuple[CollisionLayer, ...]
    ) -> None:
        # The mark begins at the surface: where it is nearer, the body has been, and marks do not count.
        ends = [pane.point(along_m, self.radius_m + self.config.mark_m) for along_m in span_m]
        index, inside = cells_near_segment(navmap.frame, ends[0], ends[1], self.config.mark_m)
        for layer in layers:
            navmap.collision_marks(layer)[index] |= inside
