"""Tracks objects in 3-D on the map, from the detections of all classes.

A track owns voxels. A region of equal labels in a frame extends the track that owns most of its voxels, otherwise it
begins a new track. Each frame then gives every track in view the mean posterior of the pixels on its voxels, whatever
region they are in: an object that was classified once as a picture and in most other views as a mirror ends as a
mirror. Voxels that are hidden have no pixels, so a track is judged only where it is visible.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float32, Float64, Int, Int16

from sim.core.geometry.grid import GridFrame
from sim.core.geometry.pose import Pose
from sim.core.interface import MPCAT40_ID, CameraModel, ConfigError
from stubborn.detection.context import IS_OBJECT, Context
from stubborn.detection.evidence import Evidence, EvidenceConfig
from stubborn.detection.fusion import Fusion
from stubborn.kernels.tracks import claim, label_pixels, means_by_track, overlaps_of, regions_of, voxels_of
from stubborn.mapping.projection import Rays

_MIN_PROBABILITY = 0.02
"""Context does not change a probability below this: it would stay far below the limit for a look."""
_ALMOST_1 = np.float32(0.999)
"""The largest probability of a track in the context of others."""


@dataclass(frozen=True, kw_only=True)
class TrackConfig:
    """Parameters of the tracks that detections become. The values were chosen by reasoning, not fitted."""

    voxel_cells: int = 2
    """Edge of a voxel in cells of the map."""
    top_m: float = 2.2
    """Points above this height belong to no track."""
    hot: float = 0.25
    """A pixel is labelled as the goal if the goal has at least this probability, even if another class is more
    probable. The same holds for a track when regions are assigned to tracks. Otherwise an object labelled as the goal
    in one frame would be merged in the next frame with the object that it lies on, and would begin again as a new
    track."""
    least_pixels: int = 12
    """Regions of a frame with fewer pixels are not detections."""
    least_pixels_of_others: int = 40
    """Regions with fewer pixels do not begin a track, unless they show the goal: a network's output has dozens of
    narrow regions in each frame."""
    depth_jump: float = 0.12
    """Neighbouring pixels are one surface if their depths differ by less than this share; the top of a table that is
    seen at a low angle needs 12 %."""
    same_share: float = 0.3
    """A region extends a track that owns at least this share of its pixels."""
    merge_share: float = 0.2
    """Tracks of one category with at least this share each of a region's pixels are one object."""
    part_share: float = 0.4
    """A region of the goal with less than this share of a track's pixels in the frame is an object on it, not the track
    itself; likewise a region of another class on a track of the goal."""
    part_of: float = 0.1
    """Tracks next to each other that have at least this probability of the goal count as one object, see `objects`."""
    least_voxels: int = 6
    """With an imperfect detector, a track with fewer voxels is not a candidate: 6 voxels are 0.06 m2 of visible
    surface."""
    inside_rad: float = 0.15
    """A track is not seen whole if its middle is nearer than this angle to the image's left or right edge."""
    most_tracks: int = 2048
    """Limit of the number of tracks; objects beyond it are not tracked."""
    evidence: EvidenceConfig = field(default_factory=EvidenceConfig)
    """Parameters of the views and of their fusion."""

    def __post_init__(self) -> None:
        if not all(0.0 <= share <= 1.0 for share in (self.hot, self.same_share, self.merge_share, self.part_share)):
            raise ConfigError("TrackConfig needs hot, same_share, merge_share and part_share in [0, 1].")
        if self.top_m <= 0.0:
            raise ConfigError(f"TrackConfig.top_m must be > 0 m, got {self.top_m}.")
        if self.voxel_cells < 1 or not 2 <= self.most_tracks < 2**15:
            raise ConfigError(
                f"TrackConfig needs voxel_cells >= 1 and most_tracks in [2, 32768), got {self.voxel_cells} and "
                f"{self.most_tracks}."
            )


class Pixels(NamedTuple):
    """Tracks and places of the pixels of one frame."""

    track: Int16[np.ndarray, "h w"]
    """Number of the track; 0: none."""
    row: Int[np.ndarray, "h w"]
    """Row on `Tracks.plan`; -1: no voxel."""
    col: Int[np.ndarray, "h w"]
    """Column on it."""
    height_m: Float64[np.ndarray, "h w"]
    """Height above the floor, where there is a voxel."""


class Tracks:
    """All objects seen in an episode."""

    def __init__(
        self,
        config: TrackConfig,
        camera: CameraModel,
        camera_forward_m: float,
        frame: GridFrame,
        fusion: Fusion | None = None,
    ) -> None:
        """`frame` is that of the map; a voxel covers whole cells of it. `fusion` fuses views, by default exact ones."""
        self.config = config
        self.camera = camera
        self.frame = frame
        self._forward_m = camera_forward_m
        self._edge_m = frame.cell_m * config.voxel_cells
        rows, cols = (n // config.voxel_cells for n in frame.shape)
        self._shape = (rows, cols, int(config.top_m / self._edge_m))
        self._owner: Int16[np.ndarray, " voxels"] = np.zeros(int(np.prod(self._shape)), np.int16)
        self._size = np.zeros(config.most_tracks, np.int64)
        self._low = np.full((config.most_tracks, 3), np.iinfo(np.int32).max, np.int64)
        self._high = np.full((config.most_tracks, 3), -1, np.int64)
        self._now = np.arange(config.most_tracks)  # the track that each one is a part of
        self._rays: dict[int, Rays] = {}
        self.evidence = Evidence(config.evidence, fusion or Fusion(), config.most_tracks)
        self.count = 0
        """Tracks have the numbers 1 to `count`."""
        self.in_view: Int[np.ndarray, " n"] = np.zeros(0, np.intp)
        """Tracks with enough pixels in the last frame."""

    def add(
        self,
        posteriors: Float32[np.ndarray, "classes h w"],
        depth: Float32[np.ndarray, "height_px width_px"],
        pose: Pose,
        goal: str,
        objects: Int[np.ndarray, "h w"] | None = None,
    ) -> None:
        """Enters one frame.

        Args:
            posteriors: at a whole fraction of the resolution of the depth.
            depth: metres.
            pose: of the robot.
            goal: the category.
            objects: the object of each pixel of the posteriors, if they are told apart.
        """
        rays = self._rays_for(posteriors.shape[2])
        d, voxel = self._voxels(rays, depth, pose)
        label = label_pixels(posteriors, IS_OBJECT, MPCAT40_ID[goal] - 1, self.config.hot)
        region, count = regions_of(label, voxel, d, self.config.depth_jump, objects)
        overlap, labels = overlaps_of(region, count, label, voxel, self._owner, self.count + 1)
        track_of, takes_over = self._associate(overlap, labels, MPCAT40_ID[goal] - 1)
        claim(region, voxel, self._owner, track_of, takes_over, self._size, self._low, self._high, self._shape)
        means, pixels = means_by_track(posteriors, voxel, self._owner, self.count + 1)
        self.in_view = np.flatnonzero(pixels >= self.config.least_pixels)
        if self.in_view.size:
            x_m, y_m = self.middles(self.in_view)
            seen = means[self.in_view], pixels[self.in_view]
            off_rad = np.arctan2(y_m - pose.y_m, x_m - pose.x_m) - pose.yaw_rad
            whole = np.cos(off_rad) >= math.cos(0.5 * self.camera.hfov_rad - self.config.inside_rad)
            self.evidence.add(self.in_view, *seen, pose.x_m - x_m, pose.y_m - y_m, whole)

    def probabilities(
        self, goal: str, least_voxels: int = 1, context: Context | None = None, share: float = 0.0
    ) -> Float32[np.ndarray, " numbers"]:
        """Returns the probability of the goal for each track; 0 for entry 0 and for tracks with fewer voxels.

        Args:
            goal: the category.
            least_voxels: tracks with fewer voxels do not count, also not as context.
            context: changes the probabilities by the objects near a track.
            share: the share of its log ratios that counts.
        """
        counts = self._size[: self.count + 1] >= least_voxels
        counts[0] = False
        probability = np.where(counts, self.evidence.probability[: self.count + 1, MPCAT40_ID[goal] - 1], np.float32(0))
        likely = np.flatnonzero(probability >= _MIN_PROBABILITY)
        if context is not None and likely.size:
            by_class = self.evidence.probability[likely]
            by_class[:, IS_OBJECT] *= np.exp(share * context.log_ratios(self._nearby(likely, counts, context.radius_m)))
            probability[likely] = by_class[:, MPCAT40_ID[goal] - 1] / by_class.sum(axis=1)
        return probability

    def _nearby(
        self, tracks: Int[np.ndarray, " n"], counts: Bool[np.ndarray, " numbers"], radius_m: float
    ) -> Float32[np.ndarray, "n objects"]:
        """Returns the probability that one of the other tracks that count, nearer than this, is of each category."""
        others = np.flatnonzero(counts)
        (x_m, y_m), (other_x_m, other_y_m) = self.middles(tracks), self.middles(others)
        near = np.hypot(x_m[:, None] - other_x_m, y_m[:, None] - other_y_m) < radius_m
        near &= tracks[:, None] != others
        none = np.log1p(-self.evidence.probability[others][:, IS_OBJECT].clip(max=_ALMOST_1))
        return np.asarray(1.0 - np.exp(near.astype(np.float32) @ none))

    def middles(self, tracks: Int[np.ndarray, " n"]) -> tuple[np.ndarray, np.ndarray]:
        """Returns x and y of the middle of each track's rectangle, metres."""
        middle = 0.5 * (self._low[tracks] + self._high[tracks] + 1) * self._edge_m
        return self.frame.origin_xy_m[0] + middle[:, 1], self.frame.origin_xy_m[1] + middle[:, 0]

    def middle_xy_m(self, number: int) -> tuple[float, float]:
        """Returns the middle of the rectangle of one track."""
        (x_m,), (y_m,) = self.middles(np.array([number]))
        return float(x_m), float(y_m)

    def near(self, number: int, others: Int[np.ndarray, " n"], gap_voxels: int) -> Int[np.ndarray, " m"]:
        """Returns those of `others` with their box at most `gap_voxels` voxels from the box of track `number`."""
        apart = np.maximum(self._low[others] - self._high[number] - 1, self._low[number] - self._high[others] - 1)
        return others[apart.max(axis=1, initial=0) <= gap_voxels]

    def objects(self, probability: Float32[np.ndarray, " numbers"], gap_voxels: int) -> Int[np.ndarray, " numbers"]:
        """Returns the number of the object of each track: candidates next to each other may be parts of one object.

        `probability` is that of the goal; only tracks with at least `part_of` of it are put together.
        """
        result = np.arange(len(probability))
        likely = np.flatnonzero(probability >= self.config.part_of)
        for track in likely[np.argsort(-probability[likely], kind="stable")].tolist():
            if result[track] == track:
                parts = self.near(track, likely, gap_voxels)
                result[parts[result[parts] == parts]] = track
        return result

    def box(self, number: int) -> tuple[tuple[int, int], tuple[int, int]]:
        """Returns row and column on `plan` of the first and of the last voxel of a track."""
        (row, col, _), (last_row, last_col, _) = self._low[number].tolist(), self._high[number].tolist()
        return (row, col), (last_row, last_col)

    def gap_m(self, number: int, other: int) -> float:
        """Returns the gap in plan between the boxes of two tracks; 0 where they overlap."""
        apart = np.maximum(
            self._low[other, :2] - self._high[number, :2] - 1, self._low[number, :2] - self._high[other, :2] - 1
        )
        return float(np.hypot(*np.maximum(apart, 0)) * self._edge_m)

    def nearest_points_m(self, number: int, other: int) -> tuple[tuple[float, float], tuple[float, float]]:
        """Returns the middles of the two voxels in plan, one of each track's box, that are nearest to each other."""
        low = np.maximum(self._low[number, :2], self._low[other, :2])
        high = np.minimum(self._high[number, :2], self._high[other, :2])
        at = np.where(low <= high, (low + high) // 2, 0)
        mine = np.where(low <= high, at, np.where(self._low[other, :2] > self._high[number, :2], high, low))
        its = np.where(low <= high, at, np.where(self._low[other, :2] > self._high[number, :2], low, high))
        (y_a, x_a), (y_b, x_b) = ((cell + 0.5) * self._edge_m for cell in (mine, its))
        x_0, y_0 = self.frame.origin_xy_m
        return (float(x_0 + x_a), float(y_0 + y_a)), (float(x_0 + x_b), float(y_0 + y_b))

    def above_m(self, number: int, other: int) -> float:
        """Returns how much higher the bottom of a track is than the top of another one; negative: lower."""
        return float((self._low[number, 2] - self._high[other, 2] - 1) * self._edge_m)

    def extents_m(self, tracks: Int[np.ndarray, " n"]) -> Float64[np.ndarray, " n"]:
        """Returns the cube root of the volume of each track's box, metres."""
        return np.cbrt(np.prod((self._high[tracks] + 1 - self._low[tracks]).astype(np.float64), axis=1)) * self._edge_m

    def footprint(self, number: int) -> tuple[tuple[slice, slice], Bool[np.ndarray, "rows cols"]]:
        """Returns the map cells of a track's voxels: rows and columns of a rectangle, and a mask over it."""
        (row, col, _), (last_row, last_col, _) = self._low[number], self._high[number]
        volume = self._owner.reshape(self._shape)[row : last_row + 1, col : last_col + 1]
        n = self.config.voxel_cells
        mask = (volume == number).any(axis=2).repeat(n, axis=0).repeat(n, axis=1)
        return (slice(n * row, n * (last_row + 1)), slice(n * col, n * (last_col + 1))), mask

    def sizes(self, tracks: Int[np.ndarray, " n"]) -> Int[np.ndarray, " n"]:
        """Returns the number of voxels of each track; 0 for a track that was merged into another one."""
        return self._size[tracks]

    def pixels(self, depth: Float32[np.ndarray, "height_px width_px"], pose: Pose, columns: int) -> Pixels:
        """Returns track and place of the pixels of an entered frame, at a resolution of `columns` columns."""
        _, voxel = self._voxels(self._rays_for(columns), depth, pose)
        there, (_, cols, layers) = voxel >= 0, self._shape
        plan = voxel // layers
        return Pixels(
            track=np.where(there, self._owner[voxel], np.int16(0)),
            row=np.where(there, plan // cols, -1),
            col=np.where(there, plan % cols, -1),
            height_m=(voxel % layers + 0.5) * self._edge_m,
        )

    @property
    def plan(self) -> GridFrame:
        """The grid of the voxels from above."""
        return GridFrame(origin_xy_m=self.frame.origin_xy_m, shape=self._shape[:2], cell_m=self._edge_m)

    def now(self) -> Int[np.ndarray, " numbers"]:
        """Returns the track that each number belongs to: another one where tracks were merged."""
        return self._now[: self.count + 1]

    def _rays_for(self, width: int) -> Rays:
        block_px = self.camera.width_px // width
        if block_px not in self._rays:
            self._rays[block_px] = Rays(self.camera, block_px // 2, block_px)
        return self._rays[block_px]

    def _voxels(
        self, rays: Rays, depth: Float32[np.ndarray, "height_px width_px"], pose: Pose
    ) -> tuple[Float32[np.ndarray, "h w"], Int[np.ndarray, "h w"]]:
        """Returns the depth of the posteriors' pixels and the voxel of each, -1 without one."""
        d, camera = rays.sample(depth), self.camera
        x_m, y_m = pose.ahead(self._forward_m)
        voxel = voxels_of(
            d, rays.left, rays.up, x_m, y_m, pose.yaw_rad, camera.height_m, camera.min_depth_m, camera.max_depth_m,
            *self.frame.origin_xy_m, self._edge_m, self._shape,
        )  # fmt: skip
        return d, voxel

    def _associate(
        self, overlap: Int[np.ndarray, "regions tracks"], labels: Int[np.ndarray, " regions"], goal: int
    ) -> tuple[Int[np.ndarray, " regions"], Bool[np.ndarray, " regions"]]:
        """Returns the track of each region (0: no track), and whether it takes over voxels. Begins new tracks."""
        c, track_of = self.config, np.zeros(len(labels), np.int64)
        takes_over = np.zeros(len(labels), np.bool_)
        pixels, shown = overlap.sum(axis=1), overlap.sum(axis=0)
        category = self._categories(overlap.shape[1], goal)
        for region in np.flatnonzero(pixels >= c.least_pixels).tolist():
            owned = overlap[region, 1:]
            best = 1 + int(np.argmax(owned)) if owned.size else 0
            if best and overlap[region, best] >= c.same_share * pixels[region]:
                small = overlap[region, best] < c.part_share * shown[best]
                one_is_goal = (labels[region] == goal) != (category[best] == goal)
                takes_over[region] = small and one_is_goal
                track_of[region] = (
                    self._begin() if takes_over[region] else self._merged(overlap[region], best, category)
                )
            elif overlap[region, 0] >= (c.least_pixels if labels[region] == goal else c.least_pixels_of_others):
                track_of[region] = self._begin()
        return track_of, takes_over

    def _categories(self, tracks: int, goal: int) -> Int[np.ndarray, " tracks"]:
        """Returns the category by which the first tracks are distinguished: the goal from probability `hot` on."""
        probability = self.evidence.probability[:tracks]
        return np.where(probability[:, goal] >= self.config.hot, goal, np.argmax(probability, axis=1))

    def _merged(self, overlap: Int[np.ndarray, " tracks"], best: int, category: Int[np.ndarray, " tracks"]) -> int:
        """Merges tracks of one category that a region shows as one object, and returns the track of the region.

        The oldest track stays and keeps the decisions on it.
        """
        shown = overlap >= max(self.config.merge_share * overlap.sum(), self.config.least_pixels)
        shown[0], shown[best] = False, True
        parts = np.flatnonzero(shown & (category == category[best]))
        if parts.size == 1:
            return int(self._now[best])
        same = np.unique(self._now[parts]).tolist()
        for track in same[1:]:
            low, high = self._low[track], self._high[track] + 1
            volume = self._owner.reshape(self._shape)[tuple(slice(a, b) for a, b in zip(low, high, strict=True))]
            volume[volume == track] = same[0]
            self._size[same[0]] += self._size[track]
            self._size[track] = 0
            self._now[self._now == track] = same[0]
            self._low[same[0]] = np.minimum(self._low[same[0]], low)
            self._high[same[0]] = np.maximum(self._high[same[0]], self._high[track])
            self.evidence.merge(track, same[0])
        return same[0]

    def _begin(self) -> int:
        """Returns the number of a new track; 0 if there are too many."""
        if self.count + 1 >= self.config.most_tracks:
            return 0
        self.count += 1
        return self.count
