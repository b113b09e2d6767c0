"""Distances at which the agent verifies a candidate and stops, for a success rule and a segmenter."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from sim.core.interface import MAX_STEPS, ConfigError, SegmenterSpec, SuccessRule
from stubborn.mapping.navmap import CollisionLayer

TUNED_FOR_M = 1.0
"""The success distance for which the distances of `TargetConfig` are chosen."""
_MIN_M = 0.05
"""Lower limit of all distances (one cell), however small the success distance is."""


@dataclass(frozen=True, kw_only=True)
class TargetConfig:
    """Distances and steps of the approach. With another success distance than 1 m, the first five distances shift."""

    stop_in_view_m: float = 0.92
    """A target point in view within this distance ends the approach: it is near and nothing hides it."""
    viewpoint_m: float = 0.85
    """A viewpoint is within this distance of a candidate cell: one metre, less the error of the cells."""
    far_viewpoint_m: float = 0.93
    """A viewpoint within this distance is used where a nearer one is missing."""
    pushing_m: float = 0.98
    """If the robot pushes against something on its path to a viewpoint, a visible candidate within this distance is
    near enough."""
    last_resort_m: float = 1.6
    """Without a viewpoint, a candidate is verified from the nearest reachable place within this distance. Late in
    an episode the agent stops there, which may still succeed."""
    outline_margin_m: float = 0.25
    """With inexact outlines the agent goes nearer than `stop_in_view_m` and `viewpoint_m` by this distance where it
    can, because an inexact outline may include a part of a neighbouring object."""
    last_resort_step: int = 420
    """The agent stops at a last resort from this step (of `MAX_STEPS`) on (see `last_resort_from`)."""
    rejection_margin_m: float = 0.25
    """Cells within this distance of rejected cells are rejected too."""
    verify_until_step: int = 200
    """A candidate first found later is not verified: no time is left to look elsewhere."""
    retry_after_steps: int = 15
    """A candidate that could not be reached is tried again after this many steps of exploration, then after twice as
    many, and so on."""
    margin_cells: int = 40
    """Margin around the known part of the map within which routes to a far candidate may run."""
    least_cells: int = 4
    """With inexact outlines, a candidate has at least this many connected cells: single cells are errors at
    outlines."""
    target_edge_m: float = 0.08
    """A wall within this distance of the candidate cell is the wall that the object is mounted on, and does not hide
    it."""

    def last_resort_from(self, max_steps: int) -> int:
        """Returns the step from which the agent stops at a last resort, in episodes of `max_steps` actions."""
        return max_steps - (MAX_STEPS - self.last_resort_step)

    def __post_init__(self) -> None:
        if not 0.0 < self.viewpoint_m <= self.far_viewpoint_m <= self.pushing_m <= self.last_resort_m:
            raise ConfigError(
                "TargetConfig needs 0 < viewpoint_m <= far_viewpoint_m <= pushing_m <= last_resort_m, "
                f"got {self.viewpoint_m}, {self.far_viewpoint_m}, {self.pushing_m} and {self.last_resort_m} m."
            )
        if self.margin_cells < 0:
            raise ConfigError(f"TargetConfig.margin_cells must be >= 0, got {self.margin_cells}.")
        if not 0.0 <= self.outline_margin_m < min(self.viewpoint_m, self.stop_in_view_m):
            raise ConfigError(
                "TargetConfig needs 0 <= outline_margin_m < viewpoint_m and stop_in_view_m, "
                f"got {self.outline_margin_m}, {self.viewpoint_m} and {self.stop_in_view_m} m."
            )


@dataclass(frozen=True, kw_only=True)
class StopDistances:
    """The distances of `TargetConfig` for one success rule and one segmenter."""

    in_view_m: float
    """A target point in view within this distance ends the approach."""
    nearer_viewpoint_m: float | None
    """With inexact outlines, viewpoints within this distance come first, but only those that can be reached without
    crossing collision marks."""
    viewpoints_m: tuple[float, ...]
    """Viewpoints within the first distance come before those within the next one."""
    pushing_m: float
    """Limit for a STOP if the robot pushes against something on its path to a viewpoint."""
    last_resort_m: float
    """Limit for the nearest reachable place, used without a viewpoint."""

    @classmethod
    def of(cls, config: TargetConfig, success: SuccessRule, segmenter: SegmenterSpec) -> StopDistances:
        """Returns the distances, shifted by the difference of the success distance to 1 m, but never below a cell."""
        shift_m = success.distance_m - TUNED_FOR_M
        in_view_m, usual_m, far_m, pushing_m, last_m = (
            max(distance_m + shift_m, _MIN_M)
            for distance_m in (
                config.stop_in_view_m,
                config.viewpoint_m,
                config.far_viewpoint_m,
                config.pushing_m,
                config.last_resort_m,
            )
        )
        margin_m = 0.0 if segmenter.exact_outlines else config.outline_margin_m
        return cls(
            in_view_m=max(in_view_m - margin_m, _MIN_M),
            nearer_viewpoint_m=max(usual_m - margin_m, _MIN_M) if margin_m > 0.0 else None,
            viewpoints_m=(usual_m, far_m),
            pushing_m=pushing_m,
            last_resort_m=last_m,
        )

    def tried_on(self, layers: tuple[CollisionLayer, ...]) -> Iterator[tuple[float, CollisionLayer]]:
        """Yields distance and collision layer of viewpoints in order of preference."""
        if self.nearer_viewpoint_m is not None:
            yield self.nearer_viewpoint_m, layers[0]
        for within_m in self.viewpoints_m:
            for layer in layers:
                yield within_m, layer
