"""`--semantics noisy`: a simulated detector, the ground truth with a seeded model of a network's errors.

It imitates these errors: whole objects are classified as a similar category, in neighbouring views too, because
the errors of a network depend on the image; some objects are hard from most sides; single frames differ from their
neighbours; small and far objects are missed; scores vary in blobs, and outlines are inexact.

A view of an object is a sector of directions and a range of distances from which it is seen. The errors of a view come
from a hash of the episode's seed, the object and the view, so they are the same in every frame of the view. All other
random numbers are sampled for each frame. The same seed and the same path give the same scores.
"""

from __future__ import annotations

import math
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol, cast

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.core.interface import MPCAT40, MPCAT40_ID, ConfigError, Observation, Scores, SegmenterSpec, category_id
from sim.detectors.confusions import CONFUSIONS
from sim.env.scene import Scene
from sim.houses.geoms import data_at_rest
from sim.world.world import World


@dataclass(frozen=True, kw_only=True)
class NoisyConfig:
    """Rates and sizes of the detector's errors."""

    stride_px: int = 4
    """Scores are computed for the middle of blocks of this many pixels in each direction."""
    sectors: int = 8
    """Number of views by the direction from which an object is seen."""
    distances_m: tuple[float, ...] = (1.3, 2.6)
    """Distances to the middle of an object at which the view changes."""
    lookalike_share: float = 0.35
    """Share of the objects that look like another category, one of their row in `sim.detectors.confusions`."""
    lookalike_rate: float = 0.7
    """Share of the views of such an object in which it is classified as that category."""
    mistake_rate: float = 0.08
    """Share of the views of any other object in which it is classified as a category of its row."""
    flicker_rate: float = 0.04
    """Share of the frames in which an object is classified as a category of its row, in any view."""
    miss_rate: float = 0.03
    """Share of the views in which an object is missed, at any size."""
    miss_share: float = 0.003
    """An object that covers this share of the frame is missed in a further 1/e of its views; exponential in size."""
    confidence: tuple[float, float] = (0.85, 0.10)
    """Mean and standard deviation over views of the score of a correct category."""
    mistaken_confidence: tuple[float, float] = (0.72, 0.12)
    """Mean and standard deviation over views of the score of a wrong category."""
    runner_up: float = 0.7
    """Share of the remaining score of the second category: the true one, where the first is wrong."""
    object_logit: float = 0.4
    """Standard deviation from frame to frame of the score of a whole object, in logits."""
    blob_logit: float = 0.7
    """Standard deviation of the score within a frame, in logits, in blobs of about `blob_px`."""
    blob_px: int = 80
    """Size of these blobs, and of the waves of outlines, in pixels of the image."""
    outline_px: float = 5.0
    """Standard deviation of the outlines from the true ones, in pixels of the image."""
    background: float = 0.004
    """Score of the goal on objects of other categories."""

    def __post_init__(self) -> None:
        rates = ("lookalike_share", "lookalike_rate", "mistake_rate", "flicker_rate", "miss_rate", "runner_up")
        for name in rates:
            if not 0.0 <= getattr(self, name) <= 1.0:
                raise ConfigError(f"NoisyConfig.{name} must lie in [0, 1], got {getattr(self, name)}.")
        if self.stride_px < 1 or self.sectors < 1 or self.miss_share <= 0 or not 0 < self.background < 1:
            raise ConfigError(
                "NoisyConfig needs stride_px and sectors >= 1, miss_share > 0 and background in (0, 1), got "
                f"{self.stride_px}, {self.sectors}, {self.miss_share} and {self.background}."
            )
        if self.blob_px < 1 or self.outline_px < 0:
            raise ConfigError(
                f"NoisyConfig needs blob_px >= 1 and outline_px >= 0, got {self.blob_px} and {self.outline_px}."
            )
        if list(self.distances_m) != sorted(self.distances_m):
            raise ConfigError(f"NoisyConfig.distances_m must grow, got {self.distances_m}.")


class RunningEpisode(Protocol):
    """The ground truth that the detector reads: an `ObjectNavEnv` that was made with `truth=("geom",)`."""

    @property
    def scene(self) -> Scene: ...  # noqa: D102
    @property
    def np_random_seed(self) -> int: ...  # noqa: D102
    def picture_categories(self) -> NDArray[np.uint8] | None: ...  # noqa: D102
    @property
    def truth_images(self) -> dict[str, NDArray]: ...  # noqa: D102


class Classification(NamedTuple):
    """The categories of all objects in one frame; arrays (objects,), categories as mpcat40 ids."""

    first: NDArray[np.intp]
    """The most probable category; 0: the object is missed."""
    second: NDArray[np.intp]
    """The second most probable category."""
    confidence: NDArray[np.float64]
    """Probability of the first category."""


class NoisySegmenter:
    """The simulated detector of this module. The scores of a frame depend on no other frame."""

    spec = SegmenterSpec(sensors=(), truth=("geom",), kind="noisy")

    def __init__(self, episode: RunningEpisode, config: NoisyConfig = NoisyConfig()) -> None:
        """Makes a detector for the episodes of one environment.

        Args:
            episode: the environment, which gives the ground truth.
            config: rates and sizes of the errors.
        """
        self.config = config
        self._episode = episode
        self._world: World | None = None
        self._categories = np.zeros((1, 1), np.uint8)

    @classmethod
    def without_episode(cls, config: NoisyConfig) -> NoisySegmenter:
        """Returns a detector for `classify` and `with_outlines`, which need no environment."""
        return cls(cast(RunningEpisode, None), config)

    def categories(self, observation: Observation) -> NDArray[np.uint8]:
        """Returns the category that each pixel was given in the frame that was scored last; 0: none."""
        del observation
        return self._categories

    def scores(self, observation: Observation, goal: str) -> Scores:
        """Returns the scores of the frame that the environment rendered last, at 1 / `stride_px` of its size.

        Raises:
            ConfigError: `goal` is not a category of mpcat40.
        """
        category = category_id(goal)
        shown, classified, rng = self._classified()
        return self._score(shown, classified, category, rng)

    def picture_categories(self) -> NDArray[np.uint8] | None:
        """Returns the true categories of the goal's picture (h, w), which is close enough to be seen without errors."""
        return self._episode.picture_categories()

    def posteriors(self, observation: Observation) -> NDArray[np.float32]:
        """Returns the probabilities of the categories in the frame that the environment rendered last, (40, h, w).

        It shows the same objects, mistakes and outlines as `scores` of that frame, but without the blobs: the first
        category of an object has its confidence, the second a share of the rest, and all others share what is left. A
        missed object has no information.
        """
        shown, classified, rng = self._classified()
        c, classes = self.config, len(MPCAT40) - 1
        objects = np.arange(len(classified.first))
        second = c.runner_up * (1.0 - classified.confidence)
        rest = (1.0 - classified.confidence - second) / classes
        table = np.zeros((len(objects) + 1, classes + 1), np.float32)  # the last row: no object
        table[:-1] = rest[:, None]
        table[objects, classified.second] += second
        table[objects, classified.first] += classified.confidence
        table[:-1][classified.first == 0] = 1.0 / classes
        table[-1] = 1.0 / classes
        warped = self.with_outlines(shown, rng)
        columns = np.ascontiguousarray(table.T[1:])
        return columns.take(warped.reshape(-1), axis=1).reshape(-1, *warped.shape)  # eight times as fast as indexing

    def _classified(self) -> tuple[NDArray[np.intp], Classification, np.random.Generator]:
        """Returns the object that each pixel shows, -1 for none, the objects' classification, and the generator."""
        scene = self._episode.scene
        if scene.world is not self._world:
            self._world, self._objects = scene.world, LabelledObjects.of(scene.world)
        seed, frame = self._episode.np_random_seed, scene.task.num_steps
        rng = np.random.default_rng([seed & 0xFFFFFFFF, frame])
        geom = _middles(self._episode.truth_images["geom"], self.config.stride_px)
        shown = self._objects.of_geom[geom]  # (h, w) index of the object; -1: none
        share = np.bincount(shown.reshape(-1) + 1, minlength=len(self._objects.category) + 1)[1:] / shown.size
        pose = scene.world.camera_pose
        return shown, self.classify(self._objects, share, (pose.x_m, pose.y_m), seed, rng), rng

    def classify(
        self,
        objects: LabelledObjects,
        share: NDArray[np.floating],
        eye_xy_m: tuple[float, float],
        seed: int,
        rng: np.random.Generator,
    ) -> Classification:
        """Returns the classification of each object in one frame.

        Args:
            objects: the objects of the house.
            share: (objects,) share of the frame that each covers.
            eye_xy_m: position of the camera in plan.
            seed: seed of the episode, for the errors of views.
            rng: generator for the errors of this frame.
        """
        c = self.config
        of_object = _hash(np.uint64(seed & 0xFFFFFFFF), objects.key)
        of_view = _hash(of_object, objects.view_from(eye_xy_m, c, _uniform(of_object, 0)))
        lookalike = _uniform(of_object, 1) < c.lookalike_share * objects.error_scale
        looks_like = objects.similar(_uniform(of_object, 2))
        draw = _uniform(of_view, 3)
        flicker = rng.random(len(objects.key)) < c.flicker_rate * objects.error_scale
        wrong_view = np.where(lookalike, draw < c.lookalike_rate, draw < c.mistake_rate * objects.error_scale)
        wrong = np.where(lookalike, looks_like, objects.similar(_uniform(of_view, 4)))
        wrong = np.where(flicker, objects.similar(rng.random(len(objects.key))), wrong)
        mistaken = (wrong_view | flicker) & (wrong > 0)
        missed = _uniform(of_view, 5) < c.miss_rate + (1.0 - c.miss_rate) * np.exp(-share / c.miss_share)
        first = np.where(missed, 0, np.where(mistaken, wrong, objects.category))
        second = np.where(mistaken, objects.category, looks_like)
        mean, deviation = np.where(mistaken, *np.array([c.mistaken_confidence, c.confidence])[:, :, None])
        confidence = np.clip(mean + deviation * _normal(of_view, 6), 0.35, 0.99)
        logit = np.log(confidence / (1.0 - confidence)) + c.object_logit * rng.standard_normal(len(confidence))
        return Classification(first, second, 1.0 / (1.0 + np.exp(-logit)))

    def _score(
        self, shown: NDArray[np.intp], classified: Classification, goal: int, rng: np.random.Generator
    ) -> Scores:
        """Returns the scores of the pixels; `shown` (h, w) is the index of the object that each shows, -1 for none."""
        c = self.config
        rest = c.runner_up * (1.0 - classified.confidence)
        target = np.where(classified.second == goal, rest, c.background)
        target = np.where(classified.first == goal, classified.confidence, target)
        target = np.where((classified.first == 0) & (classified.second == goal), rest, target)
        other = np.where(classified.first == goal, rest, classified.confidence)
        target, other = np.append(target, c.background), np.append(other, 0.0)  # the last entry: no object
        target = np.clip(target, c.background, 1.0 - c.background)
        down, right, blob = self._waves(shown.shape, rng)
        shown = self._warped(shown, down, right)
        self._categories = np.append(classified.first, 0).astype(np.uint8)[shown]
        odds = (target / (1.0 - target)).astype(np.float32)[shown] * np.exp(np.float32(c.blob_logit) * blob)
        remaining = 1.0 / (1.0 + odds)
        scores = np.stack([odds * remaining, (other / (1.0 - target)).astype(np.float32)[shown] * remaining], axis=-1)
        soft = cv2.blur(scores, (3, 3), borderType=cv2.BORDER_REPLICATE)
        target_score, other_score = cv2.split(np.clip(soft, 0.0, 1.0))
        return Scores(np.asarray(target_score, np.float32), np.asarray(other_score, np.float32))

    def with_outlines(self, shown: NDArray[np.intp], rng: np.random.Generator) -> NDArray[np.intp]:
        """Returns an image (h, w) of objects with inexact outlines; -1 is no object."""
        down, right, _ = self._waves(shown.shape, rng)
        return self._warped(shown, down, right)

    def _waves(
        self, shape: tuple[int, ...], rng: np.random.Generator
    ) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]]:
        """Returns three smooth random images: displacement of outlines downwards and to the right, and blobs."""
        c, (height, width) = self.config, shape
        cells = max(2, round(height * c.stride_px / c.blob_px)), max(2, round(width * c.stride_px / c.blob_px))
        waves = rng.standard_normal((*cells, 3)).astype(np.float32)
        down, right, blob = cv2.split(cv2.resize(waves, (width, height), interpolation=cv2.INTER_CUBIC))
        return np.asarray(down, np.float32), np.asarray(right, np.float32), np.asarray(blob, np.float32)

    def _warped(
        self, shown: NDArray[np.intp], down: NDArray[np.float32], right: NDArray[np.float32]
    ) -> NDArray[np.intp]:
        """Returns the image of objects with inexact outlines."""
        height, width = shown.shape
        px = np.float32(self.config.outline_px / self.config.stride_px)
        warped = cv2.remap(
            shown.astype(np.int16),
            np.arange(width, dtype=np.float32)[None, :] + px * right,
            np.arange(height, dtype=np.float32)[:, None] + px * down,
            cv2.INTER_NEAREST,
            borderMode=cv2.BORDER_REPLICATE,
        )
        return np.asarray(warped, np.intp)


@dataclass(frozen=True, eq=False)
class LabelledObjects:
    """The labelled instances of one house."""

    of_geom: NDArray[np.intp]
    """(geoms + 1,) index of each geom's object, -1 for none; the last entry is for no geom."""
    category: NDArray[np.intp]
    """(objects,) true mpcat40 id."""
    key: NDArray[np.uint64]
    """(objects,) hash of the name, so that the errors of an object do not depend on the other objects."""
    middle_xy_m: NDArray[np.float64]
    """(objects, 2) in plan, at the start of an episode."""
    error_scale: NDArray[np.float64]
    """(objects,) sum of the category's row of confusions, a factor on the error rates."""
    rows: NDArray[np.float64]
    """(objects, 40 + 1) cumulative shares of that row, by mpcat40 id."""

    @classmethod
    def of(cls, world: World) -> LabelledObjects:
        """Returns the objects of a compiled world."""
        at_rest = data_at_rest(world.model)
        instances = world.labels.instances
        return cls.named(
            [instance.name for instance in instances],
            [instance.category for instance in instances],
            np.array([at_rest.geom_xpos[list(instance.geom_ids), :2].mean(axis=0) for instance in instances]).reshape(
                -1, 2
            ),
            world.labels.geom_instance,
        )

    @classmethod
    def named(
        cls, names: Sequence[str], categories: Sequence[str], middle_xy_m: NDArray, of_geom: NDArray[np.integer]
    ) -> LabelledObjects:
        """Returns objects with these names, categories and positions; `of_geom` (geoms,) is the object of each geom."""
        table = np.zeros((len(MPCAT40), len(MPCAT40)))
        for name, row in CONFUSIONS.items():
            for wrong, share in row.items():
                table[MPCAT40_ID[name], MPCAT40_ID[wrong]] = share
        category = np.array([MPCAT40_ID[name] for name in categories], np.intp)
        sums = table.sum(axis=1, keepdims=True)
        return cls(
            of_geom=np.append(of_geom, -1).astype(np.intp),
            category=category,
            key=np.array([zlib.crc32(name.encode()) for name in names], np.uint64),
            middle_xy_m=np.asarray(middle_xy_m, np.float64),
            error_scale=sums[category, 0],
            rows=np.cumsum(table / np.maximum(sums, 1e-9), axis=1)[category],
        )

    def similar(self, draw: NDArray[np.float64]) -> NDArray[np.intp]:
        """Returns (objects,) a category of each object's row for a number in [0, 1); 0 if it has no row."""
        category = (draw[:, None] >= self.rows - 1e-12).sum(axis=1)
        return np.where(self.error_scale > 0, np.minimum(category, len(MPCAT40) - 1), 0)

    def view_from(
        self, eye_xy_m: tuple[float, float], config: NoisyConfig, offset: NDArray[np.float64]
    ) -> NDArray[np.uint64]:
        """Returns (objects,) the number of each object's view; `offset` in [0, 1) sectors rotates its sectors."""
        dx, dy = eye_xy_m[0] - self.middle_xy_m[:, 0], eye_xy_m[1] - self.middle_xy_m[:, 1]
        sector = np.floor((np.arctan2(dy, dx) / math.tau + 1.0) * config.sectors + offset) % config.sectors
        ring = np.searchsorted(np.array(config.distances_m), np.hypot(dx, dy))
        return (ring * config.sectors + sector.astype(np.intp)).astype(np.uint64)


def _middles(image: NDArray, stride_px: int) -> NDArray:
    """Returns the middle pixel of each block."""
    return image[stride_px // 2 :: stride_px, stride_px // 2 :: stride_px]


def _hash(state: NDArray[np.uint64] | np.uint64, value: NDArray[np.uint64] | np.uint64) -> NDArray[np.uint64]:
    """Returns a state mixed with a value (the finalizer of SplitMix64: Steele, Lea, Flood 2014)."""
    with np.errstate(over="ignore"):
        z = np.asarray(state, np.uint64) * np.uint64(0x9E3779B97F4A7C15) + np.asarray(value, np.uint64)
        z = z + np.uint64(0x9E3779B97F4A7C15)
        z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
        return np.asarray(z ^ (z >> np.uint64(31)))


def _uniform(state: NDArray[np.uint64], draw: int) -> NDArray[np.float64]:
    """Returns the random number with this index, in [0, 1)."""
    return (_hash(state, np.uint64(draw)) >> np.uint64(11)).astype(np.float64) * 2.0**-53


def _normal(state: NDArray[np.uint64], draw: int) -> NDArray[np.float64]:
    """Returns a standard normal number (Box and Muller) from the random numbers of this index and the next."""
    radius = np.sqrt(-2.0 * np.log1p(-_uniform(state, draw)))
    return radius * np.cos(math.tau * _uniform(state, draw + 1))
