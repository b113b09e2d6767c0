"""`--semantics noisy`: ground truth seen through a seeded model of a network's mistakes.

What it imitates: whole things taken for something similar, and that over neighbouring views, since a network errs by
what it sees and not by the toss of a coin; some things that are hard from most sides; single frames that differ from
those around them; small and far things that are missed; soft scores in blobs, and outlines that run over the edge.

A view of a thing is a sector of directions and a range of distances from which it is seen; what is drawn for a view
comes from a hash of the episode's seed, the thing and the view, so it is the same however often the view is met. All
else is drawn for each frame. The same seed and the same way give the same scores.
"""

from __future__ import annotations

import math
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.detectors.confusions import CONFUSIONS
from sim.env.scene import Scene
from sim.gl import mujoco
from sim.interface import MPCAT40, MPCAT40_ID, ConfigError, Observation, Scores, SegmenterSpec
from sim.world.world import World


@dataclass(frozen=True, kw_only=True)
class NoisyConfig:
    """How often and how the detector errs."""

    stride_px: int = 4
    """Scores are given for the middle of every block of so many pixels, each way."""
    sectors: int = 8
    """Directions from which a thing is seen make so many views."""
    distances_m: tuple[float, ...] = (1.3, 2.6)
    """Between these distances to a thing's middle lies a change of view."""
    lookalike_share: float = 0.35
    """Of all things: those that resemble another category, one of their row in `sim.detectors.confusions`."""
    lookalike_rate: float = 0.7
    """Of the views of such a thing: those in which it is taken for that category."""
    mistake_rate: float = 0.08
    """Of the views of any other thing: those in which it is taken for one of its row."""
    flicker_rate: float = 0.04
    """Of the frames of any thing: those in which it is taken for one of its row, whatever the view says."""
    miss_rate: float = 0.03
    """Of the views of a thing, however large it appears: those in which it is missed."""
    miss_share: float = 0.003
    """Share of the frame at which a thing is missed in 1/e of its views besides; it falls off exponentially."""
    confidence: tuple[float, float] = (0.85, 0.10)
    """Mean and deviation over views of the score of what is seen right."""
    mistaken_confidence: tuple[float, float] = (0.72, 0.12)
    """Mean and deviation over views of the score of what is mistaken."""
    runner_up: float = 0.7
    """Share of the rest that goes to the second most probable category: the truth, where that was mistaken."""
    thing_logit: float = 0.4
    """Deviation from frame to frame of a whole thing's score, in logits."""
    blob_logit: float = 0.7
    """Deviation within a frame of the score, in logits, in blobs of about `blob_px`."""
    blob_px: int = 80
    """Size of such blobs, and of the waves of outlines, in pixels of the image."""
    outline_px: float = 5.0
    """Deviation of outlines from the true ones, in pixels of the image."""
    background: float = 0.004
    """Score of the goal where nothing resembles it."""

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
        if list(self.distances_m) != sorted(self.distances_m):
            raise ConfigError(f"NoisyConfig.distances_m must grow, got {self.distances_m}.")


class Watched(Protocol):
    """What the detector must know of the running episode: a `sim.env.objectnav.ObjectNavEnv` made with `truth=("geom",)`."""

    @property
    def scene(self) -> Scene: ...  # noqa: D102
    @property
    def np_random_seed(self) -> int: ...  # noqa: D102
    @property
    def truth_images(self) -> dict[str, NDArray]: ...  # noqa: D102


class Seen(NamedTuple):
    """What the detector makes of each thing in one frame; arrays (things,), categories as mpcat40 ids."""

    first: NDArray[np.intp]
    """The most probable category; 0: missed, it looks like nothing in particular."""
    second: NDArray[np.intp]
    """The next one."""
    confidence: NDArray[np.float64]
    """Probability of the first."""


class NoisySegmenter:
    """See the module. Reads what is true of the running episode; keeps nothing from frame to frame."""

    spec = SegmenterSpec(sensors=(), truth=("geom",))

    def __init__(self, episode: Watched, config: NoisyConfig = NoisyConfig()) -> None:
        self.config = config
        self._episode = episode
        self._world: World | None = None

    def scores(self, observation: Observation, goal: str) -> Scores:
        """Scores of the frame that the environment rendered last, at 1 / `stride_px` of the image's size.

        Raises:
            ConfigError: no such category.
        """
        if goal not in MPCAT40_ID:
            raise ConfigError(f"No category {goal!r} in mpcat40. There is: {', '.join(MPCAT40_ID)}.")
        scene = self._episode.scene
        if scene.world is not self._world:
            self._world, self._things = scene.world, Things.of(scene.world)
        seed, frame = self._episode.np_random_seed, scene.task.num_steps
        rng = np.random.default_rng([seed & 0xFFFFFFFF, frame])
        geom = _middles(self._episode.truth_images["geom"], self.config.stride_px)
        thing = self._things.of_geom[geom]  # (h, w); -1, the last of them, is nothing
        share = np.bincount(thing.reshape(-1) + 1, minlength=len(self._things.category) + 1)[1:] / thing.size
        pose = scene.world.camera_pose
        seen = self.see(self._things, share, (pose.x_m, pose.y_m), seed, rng)
        return self._paint(thing, seen, MPCAT40_ID[goal], rng)

    def see(
        self,
        things: Things,
        share: NDArray[np.floating],
        eye_xy_m: tuple[float, float],
        seed: int,
        rng: np.random.Generator,
    ) -> Seen:
        """What the detector takes each thing for, in one frame.

        Args:
            things: of the house.
            share: (things,) of the frame that each covers.
            eye_xy_m: where the camera is.
            seed: the episode's; draws what lasts.
            rng: draws what is of this frame only.
        """
        c = self.config
        of_thing = _hash(np.uint64(seed & 0xFFFFFFFF), things.key)
        of_view = _hash(of_thing, things.view_from(eye_xy_m, c, _uniform(of_thing, 0)))
        lookalike = _uniform(of_thing, 1) < c.lookalike_share * things.proneness
        other_self = things.similar(_uniform(of_thing, 2))
        mistake = _uniform(of_view, 3)
        flicker = rng.random(len(things.key)) < c.flicker_rate * things.proneness
        taken = np.where(lookalike, mistake < c.lookalike_rate, mistake < c.mistake_rate * things.proneness)
        seen_as = np.where(lookalike, other_self, things.similar(_uniform(of_view, 4)))
        seen_as = np.where(flicker, things.similar(rng.random(len(things.key))), seen_as)
        mistaken = (taken | flicker) & (seen_as > 0)
        missed = _uniform(of_view, 5) < c.miss_rate + (1.0 - c.miss_rate) * np.exp(-share / c.miss_share)
        first = np.where(missed, 0, np.where(mistaken, seen_as, things.category))
        second = np.where(mistaken, things.category, other_self)
        mean, deviation = np.where(mistaken, *np.array([c.mistaken_confidence, c.confidence])[:, :, None])
        sure = np.clip(mean + deviation * _normal(of_view, 6), 0.35, 0.99)
        logit = np.log(sure / (1.0 - sure)) + c.thing_logit * rng.standard_normal(len(sure))
        return Seen(first, second, 1.0 / (1.0 + np.exp(-logit)))

    def _paint(self, thing: NDArray[np.intp], seen: Seen, goal: int, rng: np.random.Generator) -> Scores:
        """Scores of the pixels from what is seen of the things; `thing` (h, w) is the thing that each shows."""
        c = self.config
        rest = c.runner_up * (1.0 - seen.confidence)
        target = np.where(seen.first == goal, seen.confidence, np.where(seen.second == goal, rest, c.background))
        target = np.where((seen.first == 0) & (seen.second == goal), rest, target)
        other = np.where(seen.first == goal, rest, seen.confidence)
        target, other = np.append(target, c.background), np.append(other, 0.0)  # the last: nothing
        target = np.clip(target, c.background, 1.0 - c.background)
        height, width = thing.shape
        cells = max(2, round(height * c.stride_px / c.blob_px)), max(2, round(width * c.stride_px / c.blob_px))
        waves = rng.standard_normal((*cells, 3)).astype(np.float32)
        down, right, blob = cv2.split(cv2.resize(waves, (width, height), interpolation=cv2.INTER_CUBIC))
        px = np.float32(c.outline_px / c.stride_px)
        warped = cv2.remap(
            thing.astype(np.int16),
            np.arange(width, dtype=np.float32)[None, :] + px * np.asarray(right),
            np.arange(height, dtype=np.float32)[:, None] + px * np.asarray(down),
            cv2.INTER_NEAREST,
            borderMode=cv2.BORDER_REPLICATE,
        )
        shown = np.asarray(warped, np.intp)
        odds = (target / (1.0 - target)).astype(np.float32)[shown] * np.exp(np.float32(c.blob_logit) * np.asarray(blob))
        left_over = 1.0 / (1.0 + odds)
        scores = np.stack([odds * left_over, (other / (1.0 - target)).astype(np.float32)[shown] * left_over], axis=-1)
        soft = cv2.blur(scores, (3, 3), borderType=cv2.BORDER_REPLICATE)
        target_score, other_score = cv2.split(np.clip(soft, 0.0, 1.0))
        return Scores(np.asarray(target_score, np.float32), np.asarray(other_score, np.float32))


@dataclass(frozen=True, eq=False)
class Things:
    """The labelled things of one house, as the detector needs them."""

    of_geom: NDArray[np.intp]
    """(geoms + 1,) index of each geom's thing, -1 for none; the last entry stands for no geom."""
    category: NDArray[np.intp]
    """(things,) true mpcat40 id."""
    key: NDArray[np.uint64]
    """(things,) of the name: what is drawn for a thing does not hang on how many others there are."""
    middle_xy_m: NDArray[np.float64]
    """(things, 2) in plan, before anything moved."""
    proneness: NDArray[np.float64]
    """(things,) sum of the category's row of confusions."""
    rows: NDArray[np.float64]
    """(things, 40 + 1) cumulative shares of its row, by mpcat40 id."""

    @classmethod
    def of(cls, world: World) -> Things:
        """Of a compiled world."""
        at_rest = mujoco.MjData(world.model)
        mujoco.mj_kinematics(world.model, at_rest)
        instances = world.labels.instances
        return cls.named(
            [each.name for each in instances],
            [each.category for each in instances],
            np.array([at_rest.geom_xpos[list(each.geom_ids), :2].mean(axis=0) for each in instances]).reshape(-1, 2),
            world.labels.geom_instance,
        )

    @classmethod
    def named(
        cls, names: Sequence[str], categories: Sequence[str], middle_xy_m: NDArray, of_geom: NDArray[np.integer]
    ) -> Things:
        """Of things with these names, categories and places; `of_geom` (geoms,) indexes them."""
        table = np.zeros((len(MPCAT40), len(MPCAT40)))
        for name, row in CONFUSIONS.items():
            for taken_for, share in row.items():
                table[MPCAT40_ID[name], MPCAT40_ID[taken_for]] = share
        category = np.array([MPCAT40_ID[name] for name in categories], np.intp)
        sums = table.sum(axis=1, keepdims=True)
        return cls(
            of_geom=np.append(of_geom, -1).astype(np.intp),
            category=category,
            key=np.array([zlib.crc32(name.encode()) for name in names], np.uint64),
            middle_xy_m=np.asarray(middle_xy_m, np.float64),
            proneness=sums[category, 0],
            rows=np.cumsum(table / np.maximum(sums, 1e-9), axis=1)[category],
        )

    def similar(self, draw: NDArray[np.float64]) -> NDArray[np.intp]:
        """(things,) a category out of each thing's row for a draw in [0, 1); 0 where it has none."""
        taken_for = (draw[:, None] >= self.rows - 1e-12).sum(axis=1)
        return np.where(self.proneness > 0, np.minimum(taken_for, len(MPCAT40) - 1), 0)

    def view_from(
        self, eye_xy_m: tuple[float, float], config: NoisyConfig, turned: NDArray[np.float64]
    ) -> NDArray[np.uint64]:
        """(things,) number of the view that each is seen in; `turned` in [0, 1) is where its sectors begin."""
        dx, dy = eye_xy_m[0] - self.middle_xy_m[:, 0], eye_xy_m[1] - self.middle_xy_m[:, 1]
        sector = np.floor((np.arctan2(dy, dx) / math.tau + 1.0) * config.sectors + turned) % config.sectors
        ring = np.searchsorted(np.array(config.distances_m), np.hypot(dx, dy))
        return (ring * config.sectors + sector.astype(np.intp)).astype(np.uint64)


def _middles(image: NDArray, stride_px: int) -> NDArray:
    """The pixel in the middle of each block."""
    return image[stride_px // 2 :: stride_px, stride_px // 2 :: stride_px]


def _hash(state: NDArray[np.uint64] | np.uint64, value: NDArray[np.uint64] | np.uint64) -> NDArray[np.uint64]:
    """Mix a value into a state (the finalizer of SplitMix64: Steele, Lea, Flood 2014)."""
    with np.errstate(over="ignore"):
        z = np.asarray(state, np.uint64) * np.uint64(0x9E3779B97F4A7C15) + np.asarray(value, np.uint64)
        z = z + np.uint64(0x9E3779B97F4A7C15)
        z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
        return np.asarray(z ^ (z >> np.uint64(31)))


def _uniform(state: NDArray[np.uint64], draw: int) -> NDArray[np.float64]:
    """The draw of that number in [0, 1)."""
    return (_hash(state, np.uint64(draw)) >> np.uint64(11)).astype(np.float64) * 2.0**-53


def _normal(state: NDArray[np.uint64], draw: int) -> NDArray[np.float64]:
    """The draw of that number from a standard normal distribution (Box and Muller); takes the next number too."""
    radius = np.sqrt(-2.0 * np.log1p(-_uniform(state, draw)))
    return radius * np.cos(math.tau * _uniform(state, draw + 1))
