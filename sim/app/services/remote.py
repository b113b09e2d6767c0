"""`--semantics http://HOST:PORT`: segmentation by a server of detectors.

Three forms of requests are known. `posteriors` is that of `stubborn serve detectors --source network`: colour and depth
without loss, and the probabilities of all categories, so that a run has the results of the network in process.
`vlfm` asks GroundingDINO for boxes and MobileSAM for the mask of each, as VLFM does. `coco` asks the address itself,
with JSON {"image": base64 of a PNG, "words": [...]}; the reply is a list of annotations as COCO has them, each with
`category` (a word), `score`, `bbox` (x, y, width, height, pixels) and, where there is a mask, `segmentation` (runs).
In the last two forms the words are the goal categories and, if the goal is in words, the word for the object.
"""

from __future__ import annotations

import base64
import functools
import json
import urllib.parse
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, NamedTuple, TypeVar

import cv2
import msgspec
import numpy as np
from numpy.typing import NDArray

from sim.app.services.client import JSON, Client, ServiceConfig
from sim.app.services.detectors import Segment
from sim.app.services.forms import read_annotations, read_boxes, read_mask, read_posteriors, view_bytes
from sim.core.errors import ConfigError
from sim.core.interface import (
    GOAL_CATEGORIES,
    MPCAT40,
    MPCAT40_ID,
    CameraModel,
    Observation,
    Scores,
    SegmenterSpec,
    scores_of,
)
from sim.core.reading import Number, read_json
from sim.core.vocabulary import vocabulary

T = TypeVar("T")
STRIDE_PX = 4
"""Edge of the image block of one posterior in the forms `vlfm` and `coco`."""
_MIDDLE = slice(STRIDE_PX // 2, None, STRIDE_PX)
_IS_STUFF = np.array([name in ("wall", "floor", "ceiling") for name in MPCAT40[1:]])
VLFM_PORTS = {"gdino": 0, "mobile_sam": 2}
"""Ports of VLFM's servers after that of the first."""


@dataclass(frozen=True, kw_only=True)
class HttpConfig(ServiceConfig):
    """How a server of detectors is asked."""

    form: Literal["posteriors", "vlfm", "coco"] = "posteriors"
    """posteriors: that of `stubborn serve detectors`; vlfm: GroundingDINO at the port of `url`, MobileSAM two above;
    coco: annotations in JSON."""
    box_threshold: float = 0.35
    """Least score of a detection in the forms `vlfm` and `coco`."""
    words: bool = True
    """In these forms the server is also asked for the words of the goal; False: it knows only categories, and a goal in
    words is every object of its category."""
    calibration: Path | None = None
    """File of the calibration that `stubborn evaluate --calibration` fitted to this server; None: its scores count as
    they are."""

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 0.0 <= self.box_threshold <= 1.0:
            raise ConfigError(f"HttpConfig.box_threshold must lie in [0, 1], got {self.box_threshold}.")


class LogitFactors(msgspec.Struct, frozen=True):
    """A calibration as `stubborn.segmentation.calibration` fits and stores it, without PyTorch."""

    scale: list[Number]
    """Factor of the logarithm of each category's probability."""
    offset: list[Number]

    @classmethod
    def read(cls, file: Path) -> LogitFactors:
        """Returns the calibration in a file.

        Raises:
            ConfigError: there is no such file, or it is not a calibration of the 40 categories.
        """
        factors = read_json(file, cls, what="Calibration of a server")
        if not len(factors.scale) == len(factors.offset) == len(MPCAT40) - 1:
            raise ConfigError(f"'{file}' must have {len(MPCAT40) - 1} factors and offsets, one for each category.")
        return factors

    def applied(self, posteriors: NDArray[np.float32]) -> NDArray[np.float32]:
        """Returns the calibrated probabilities of (40, ...)."""
        scale, offset = (np.array(values, np.float32) for values in (self.scale, self.offset))
        logits = (logits_of(posteriors).T * scale + offset).T
        odds = np.exp(logits - logits.max(axis=0))
        return odds / odds.sum(axis=0)


def logits_of(posteriors: NDArray[np.float32]) -> NDArray[np.float32]:
    """Returns the logarithms of probabilities, at least that of 1e-6."""
    return np.log(np.maximum(posteriors, np.float32(1e-6)))


class _Seen(NamedTuple):
    """What a server saw in a frame."""

    posteriors: NDArray[np.float32]
    """(40, h, w)."""
    objects: tuple[NDArray[np.int32], Sequence[str]] | None = None
    """The detection of each pixel, -1: none, and the name of each; None: the form has no detections."""
    segments: Sequence[Segment] = ()


class HttpSegmenter:
    """A segmenter that asks a server.

    Args:
        camera: gives field of view, height and range.
        config: how the server is asked.

    Raises:
        ConfigError: the file of the calibration cannot be read.
    """

    spec = SegmenterSpec(sensors=("rgb",))

    def __init__(self, camera: CameraModel, config: HttpConfig) -> None:
        self._camera, self._config, self._client = camera, config, Client(config)
        self._look = {"posteriors": self._by_ours, "vlfm": self._by_vlfm, "coco": self._by_coco}[config.form]
        self._calibration = None if config.calibration is None else LogitFactors.read(config.calibration)
        self.ask("", frozenset())

    def ask(self, word: str, names: frozenset[str]) -> None:
        """See `sim.core.interface.TakesWords`."""
        words = [goal.replace("_", " ") for goal in GOAL_CATEGORIES]
        self._words = [word, *words] if word and word not in words and self._config.words else words
        self._names = names if self._config.words else frozenset()
        self._last: tuple[NDArray[np.uint8], _Seen] | None = None

    def scores(self, observation: Observation, goal: str) -> Scores:
        """Returns the scores of one frame.

        Raises:
            ConfigError: the goal is not a category of mpcat40.
            AgentError: the server gave no valid reply.
        """
        return scores_of(self.posteriors(observation), goal)

    def posteriors(self, observation: Observation) -> NDArray[np.float32]:
        """Returns the probability of each category except void, float32 (40, h, w), at the server's resolution.

        Raises:
            AgentError: the server gave no valid reply.
        """
        return self._seen(observation).posteriors

    def objects(self, observation: Observation) -> tuple[NDArray[np.int32], Sequence[str]] | None:
        """See `sim.core.interface.SeesObjects`; None also where the goal is a category.

        Raises:
            AgentError: the server gave no valid reply.
        """
        return self._seen(observation).objects if self._names else None

    def categories(self, observation: Observation) -> NDArray[np.uint8]:
        """Returns the most probable mpcat40 id of each pixel; 0 where the server saw nothing."""
        posteriors = self.posteriors(observation)
        best = (posteriors.argmax(axis=0) + 1).astype(np.uint8)
        best[posteriors.max(axis=0) <= 1.0 / len(posteriors)] = 0
        return best

    def _seen(self, observation: Observation) -> _Seen:
        if self._last is None or self._last[0] is not observation["rgb"]:
            seen = self._look(observation["rgb"], observation["depth"])
            if self._calibration is not None and seen.objects is None:
                seen = seen._replace(posteriors=self._calibration.applied(seen.posteriors))
            self._last = observation["rgb"], seen
        return self._last[1]

    def _by_ours(self, rgb: NDArray[np.uint8], depth: NDArray[np.float32]) -> _Seen:
        read = functools.partial(read_posteriors, shape=(rgb.shape[0], rgb.shape[1]))
        body = view_bytes(rgb, depth, self._camera)
        return _Seen(self._client.ask(self._url("/posteriors"), body, "application/octet-stream", read))

    def _by_vlfm(self, rgb: NDArray[np.uint8], depth: NDArray[np.float32]) -> _Seen:
        del depth
        height, width = rgb.shape[:2]
        image = _png(rgb)
        caption = " . ".join(self._words) + " ."
        question = {"image": image, "caption": caption, "box_threshold": self._config.box_threshold}
        found, read = self._json("/gdino", question, read_boxes), functools.partial(read_mask, shape=(height, width))
        segments = []
        for box in found:
            if box.score >= self._config.box_threshold:
                corners = (np.array(box.corners) * (width, height, width, height)).tolist()
                mask = self._json("/mobile_sam", {"image": image, "bbox": corners}, read)
                segments.append(Segment(category=box.category, score=box.score, mask=mask, phrase=box.phrase))
        return self._painted(segments, (height, width))

    def _by_coco(self, rgb: NDArray[np.uint8], depth: NDArray[np.float32]) -> _Seen:
        del depth
        image = _png(rgb[..., ::-1])
        shape = rgb.shape[0], rgb.shape[1]
        read = functools.partial(read_annotations, shape=shape)
        return self._painted(self._json("", {"image": image, "words": self._words}, read), shape)

    def _painted(self, segments: Sequence[Segment], shape: tuple[int, int]) -> _Seen:
        """Returns the detections with a high enough score as posteriors and objects."""
        shown = sorted((one for one in segments if one.score >= self._config.box_threshold), key=lambda one: one.score)
        posteriors = painted(shown, shape, self._calibration)
        numbers = np.full(posteriors.shape[1:], -1, np.int32)
        for number, segment in enumerate(shown):
            numbers[segment.mask[_MIDDLE, _MIDDLE]] = number
        return _Seen(posteriors, (numbers, [self._name(segment.phrase) for segment in shown]), shown)

    def samples(
        self, observation: Observation, channels: NDArray[np.int64]
    ) -> tuple[NDArray[np.float32], NDArray[np.int64]]:
        """Returns what a calibration is fitted to: logarithms of probabilities (k, 40), and true channels (k,).

        A sample is a detection, whose truth is the object category in the middle half of its box that covers a quarter
        of it, or else what covers most. In the form `posteriors` a sample is a pixel.

        Args:
            observation: of a view.
            channels: true channel of each pixel, (h, w); -1: void.

        Raises:
            AgentError: the server gave no valid reply.
        """
        seen = self._seen(observation)
        if seen.objects is None:
            block = channels.shape[0] // seen.posteriors.shape[1]
            logits = logits_of(seen.posteriors)[:, 2::8, 2::8].reshape(len(seen.posteriors), -1).T
            truth = channels[block // 2 :: block, block // 2 :: block][2::8, 2::8].reshape(-1)
        else:
            logits = np.array([logits_of(vector_of(segment)) for segment in seen.segments]).reshape(
                -1, len(MPCAT40) - 1
            )
            truth = np.array([_shown_in(segment, channels) for segment in seen.segments], np.int64)
        return logits[truth >= 0], truth[truth >= 0]

    def _name(self, phrase: str) -> str:
        """Returns a name that the goal means if the goal means all that a phrase does; else the phrase."""
        found = vocabulary().find(phrase)
        return min(found.names) if found is not None and found.names <= self._names else phrase

    def _json(self, path: str, question: dict[str, Any], read: Callable[[bytes], T]) -> T:
        return self._client.ask(self._url(path), json.dumps(question, sort_keys=True).encode(), JSON, read)

    def _url(self, path: str) -> str:
        parts = urllib.parse.urlsplit(self._config.url)
        offset = VLFM_PORTS.get(path.strip("/"), 0)
        if offset and parts.port:
            host = f"[{parts.hostname}]" if ":" in (parts.hostname or "") else parts.hostname
            parts = parts._replace(netloc=f"{host}:{parts.port + offset}")
        return urllib.parse.urlunsplit(parts._replace(path=parts.path.rstrip("/") + path))


def _png(picture: NDArray[np.uint8]) -> str:
    """Returns a picture (h, w, 3), whose channels OpenCV takes as BGR, as base64 of a PNG file."""
    return base64.b64encode(cv2.imencode(".png", picture)[1].tobytes()).decode()


def painted(
    segments: Sequence[Segment], shape: tuple[int, int], calibration: LogitFactors | None = None
) -> NDArray[np.float32]:
    """Returns the posteriors of detections, float32 (40, h / 4, w / 4).

    A pixel has the probabilities of the last detection that covers it. Where there is no detection, all categories are
    equally probable.

    Args:
        segments: what a detector reports, the most probable last.
        shape: rows and columns of the picture.
        calibration: of the probabilities of the detections.
    """
    count = len(MPCAT40) - 1
    posteriors = np.full((count, *np.empty(shape, np.bool_)[_MIDDLE, _MIDDLE].shape), 1.0 / count, np.float32)
    for segment in segments:
        vector = vector_of(segment) if calibration is None else calibration.applied(vector_of(segment))
        posteriors[:, segment.mask[_MIDDLE, _MIDDLE]] = vector[:, None]
    return posteriors


def vector_of(segment: Segment) -> NDArray[np.float32]:
    """Returns the probabilities (40,) of a detection: its score, and equal shares of the rest for other categories."""
    count = len(MPCAT40) - 1
    vector = np.full(count, (1.0 - segment.score) / (count - 1), np.float32)
    vector[MPCAT40_ID[segment.category] - 1] = segment.score
    return vector


def _shown_in(segment: Segment, channels: NDArray[np.int64]) -> int:
    """Returns the channel of what a detection shows, see `HttpSegmenter.samples`; -1: nothing that is labelled."""
    if not segment.mask.any():
        return -1
    left, top, right, bottom = segment.box
    edges = ((low + (high - low) * share) for low, high in ((top, bottom), (left, right)) for share in (0.25, 0.75))
    row, last_row, column, last_column = (
        int(edge * size) for edge, size in zip(edges, np.repeat(channels.shape, 2).tolist(), strict=True)
    )
    middle = channels[row : max(last_row, row + 1), column : max(last_column, column + 1)]
    counts = np.bincount(middle[middle >= 0], minlength=len(MPCAT40) - 1)
    objects = np.where(_IS_STUFF, 0, counts)
    if objects.max() >= 0.25 * middle.size:
        return int(objects.argmax())
    return int(counts.argmax()) if counts.any() else -1
