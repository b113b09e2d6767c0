"""`--semantics http://HOST:PORT`: segmentation by a server of detectors.

Three forms of requests are known. `posteriors` is that of `stubborn serve detectors --source network`: colour and depth
without loss, and the probabilities of all categories, so that a run has the results of the network in process.
`vlfm` asks GroundingDINO for boxes and MobileSAM for the mask of each, as VLFM does. `coco` asks the address itself,
with JSON {"image": base64 of a PNG, "words": [...]}; the reply is a list of annotations as COCO has them, each with
`category` (a word), `score`, `bbox` (x, y, width, height, pixels) and, where there is a mask, `segmentation` (runs).

Replies can be kept in a folder by the content of their requests. A run whose replies are all there needs no server.
"""

from __future__ import annotations

import base64
import functools
import hashlib
import http.client
import io
import json
import math
import time
import urllib.error
import urllib.parse
import urllib.request
import zipfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal, TypeVar

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.app.services.detectors import Segment
from sim.app.services.words import category_of
from sim.core.configuration import as_json
from sim.core.errors import AgentError, ConfigError
from sim.core.files import write_together
from sim.core.interface import (
    GOAL_CATEGORIES,
    MPCAT40,
    MPCAT40_ID,
    CameraModel,
    Observation,
    Scores,
    SegmenterSpec,
    category_id,
)
from sim.core.reading import parse_json, printable
from sim.training.views.coco import decode_mask

T = TypeVar("T")
STRIDE_PX = 4
"""Edge of the image block of one posterior in the forms `vlfm` and `coco`."""
MAX_BYTES = 1 << 28
"""Longest reply."""
WAIT_S = 0.5
"""Time before a request is repeated."""
VLFM_PORTS = {"gdino": 0, "mobile_sam": 2}
"""Ports of VLFM's servers after that of the first."""


@dataclass(frozen=True, kw_only=True)
class HttpConfig:
    """How a server of detectors is asked."""

    url: str
    """Address, such as http://localhost:12181."""
    form: Literal["posteriors", "vlfm", "coco"] = "posteriors"
    """posteriors: that of `stubborn serve detectors`; vlfm: GroundingDINO at the port of `url`, MobileSAM two above;
    coco: annotations in JSON."""
    timeout_s: float = 10.0
    """Longest time of one request."""
    retries: int = 2
    """How often a request is repeated if there is no valid reply."""
    cache: Path | None = None
    """Folder in which replies are kept by the content of their requests; None: they are not kept."""
    box_threshold: float = 0.35
    """Least score of a detection in the forms `vlfm` and `coco`."""

    def __post_init__(self) -> None:
        if not is_address(self.url):
            raise ConfigError(f"HttpConfig.url must be http://HOST:PORT or https://HOST:PORT, got '{self.url}'.")
        if not 0.0 < self.timeout_s < math.inf or self.retries < 0:
            raise ConfigError(
                f"HttpConfig needs timeout_s > 0 and retries >= 0, got {self.timeout_s} and {self.retries}."
            )
        if not 0.0 <= self.box_threshold <= 1.0:
            raise ConfigError(f"HttpConfig.box_threshold must lie in [0, 1], got {self.box_threshold}.")


def is_address(semantics: str) -> bool:
    """Returns whether a value of `--semantics` is the address of a server."""
    try:
        parts = urllib.parse.urlsplit(semantics)
        return parts.scheme in ("http", "https") and bool(parts.hostname) and (parts.port or 1) > 0
    except ValueError:
        return False


class HttpSegmenter:
    """A segmenter that asks a server.

    Args:
        camera: gives field of view, height and range.
        config: how the server is asked.
    """

    spec = SegmenterSpec(sensors=("rgb",))

    def __init__(self, camera: CameraModel, config: HttpConfig) -> None:
        self._camera, self._config = camera, config
        self._ask = {"posteriors": self._of_ours, "vlfm": self._of_vlfm, "coco": self._of_coco}[config.form]
        self._last: tuple[NDArray[np.uint8], NDArray[np.float32]] | None = None

    def scores(self, observation: Observation, goal: str) -> Scores:
        """Returns the scores of one frame.

        Raises:
            ConfigError: the goal is not a category of mpcat40.
            AgentError: the server gave no valid reply.
        """
        channel, posteriors = category_id(goal) - 1, self.posteriors(observation)
        others = np.maximum(
            posteriors[:channel].max(axis=0, initial=0.0), posteriors[channel + 1 :].max(axis=0, initial=0.0)
        )
        return Scores(posteriors[channel].copy(), others)

    def posteriors(self, observation: Observation) -> NDArray[np.float32]:
        """Returns the probability of each category except void, float32 (40, h, w), at the server's resolution.

        Raises:
            AgentError: the server gave no valid reply.
        """
        if self._last is None or self._last[0] is not observation["rgb"]:
            self._last = observation["rgb"], self._ask(observation["rgb"], observation["depth"])
        return self._last[1]

    def categories(self, observation: Observation) -> NDArray[np.uint8]:
        """Returns the most probable mpcat40 id of each pixel; 0 where the server saw nothing."""
        posteriors = self.posteriors(observation)
        best = (posteriors.argmax(axis=0) + 1).astype(np.uint8)
        best[posteriors.max(axis=0) <= 1.0 / len(posteriors)] = 0
        return best

    def _of_ours(self, rgb: NDArray[np.uint8], depth: NDArray[np.float32]) -> NDArray[np.float32]:
        body, rows_columns = view_bytes(rgb, depth, self._camera), rgb.shape[:2]
        read = functools.partial(read_posteriors, shape=(rows_columns[0], rows_columns[1]))
        return self._reply("/posteriors", body, "application/octet-stream", read)

    def _of_vlfm(self, rgb: NDArray[np.uint8], depth: NDArray[np.float32]) -> NDArray[np.float32]:
        del depth
        height, width = rgb.shape[:2]
        image = base64.b64encode(cv2.imencode(".png", rgb)[1].tobytes()).decode()
        words = [goal.replace("_", " ") for goal in GOAL_CATEGORIES]
        question = {"image": image, "caption": " . ".join(words) + " .", "box_threshold": self._config.box_threshold}
        found, read = self._json("/gdino", question, read_boxes), functools.partial(read_mask, shape=(height, width))
        segments = []
        for box in found:
            if box.score >= self._config.box_threshold:
                corners = (np.array(box.corners) * (width, height, width, height)).tolist()
                mask = self._json("/mobile_sam", {"image": image, "bbox": corners}, read)
                segments.append(Segment(category=box.category, score=box.score, mask=mask))
        return painted(segments, (height, width))

    def _of_coco(self, rgb: NDArray[np.uint8], depth: NDArray[np.float32]) -> NDArray[np.float32]:
        del depth
        image = base64.b64encode(cv2.imencode(".png", rgb[..., ::-1])[1].tobytes()).decode()
        words = [goal.replace("_", " ") for goal in GOAL_CATEGORIES]
        shape = rgb.shape[0], rgb.shape[1]
        segments = self._json("", {"image": image, "words": words}, functools.partial(read_annotations, shape=shape))
        return painted([one for one in segments if one.score >= self._config.box_threshold], shape)

    def _json(self, path: str, question: dict[str, Any], read: Callable[[bytes], T]) -> T:
        body = json.dumps(question, sort_keys=True).encode()
        return self._reply(path, body, "application/json", read)

    def _reply(self, path: str, body: bytes, kind: str, read: Callable[[bytes], T]) -> T:
        """Returns the reply to a request, from the cache if it is there.

        Args:
            path: of the request.
            body: of the request.
            kind: media type of the body.
            read: returns the value of a reply, or raises ConfigError if it is not valid.

        Raises:
            AgentError: there was no valid reply.
        """
        kept = self._kept(path, body)
        if kept is not None and kept.is_file():
            try:
                return read(kept.read_bytes())
            except (ConfigError, OSError) as error:
                raise AgentError(f"The cached reply '{kept}' cannot be used: {error}") from None
        url, problem = self._url(path), ""
        for attempt in range(self._config.retries + 1):
            time.sleep(WAIT_S if attempt else 0.0)
            try:
                data = _post(url, body, kind, self._config.timeout_s)
                value = read(data)
            except ConfigError as error:
                problem = str(error)
                continue
            if kept is not None:
                kept.parent.mkdir(parents=True, exist_ok=True)
                write_together({kept: data})
            return value
        raise AgentError(f"{url} gave no valid reply in {self._config.retries + 1} attempts: {problem}")

    def _url(self, path: str) -> str:
        parts = urllib.parse.urlsplit(self._config.url)
        offset = VLFM_PORTS.get(path.strip("/"), 0)
        if offset and parts.port:
            host = f"[{parts.hostname}]" if ":" in (parts.hostname or "") else parts.hostname
            parts = parts._replace(netloc=f"{host}:{parts.port + offset}")
        return urllib.parse.urlunsplit(parts._replace(path=parts.path.rstrip("/") + path))

    def _kept(self, path: str, body: bytes) -> Path | None:
        """Returns the file of the reply to a request; None: replies are not kept."""
        if self._config.cache is None:
            return None
        name = hashlib.sha256(self._url(path).encode() + b"\0" + body).hexdigest()
        return self._config.cache / name[:2] / name


def _post(url: str, body: bytes, kind: str, timeout_s: float) -> bytes:
    """Returns the body of the reply to a POST request.

    Raises:
        ConfigError: there is no reply in time, it has another status than 200, or it is too long.
    """
    request = urllib.request.Request(url, body, {"Content-Type": kind}, method="POST")
    deadline, parts, size = time.monotonic() + timeout_s, list[bytes](), 0
    try:
        with urllib.request.build_opener(urllib.request.ProxyHandler({})).open(request, timeout=timeout_s) as reply:
            announced = reply.headers.get("Content-Length")
            while part := reply.read1(1 << 16):
                parts.append(part)
                size += len(part)
                if size > MAX_BYTES:
                    raise ConfigError(f"its reply is longer than {MAX_BYTES} bytes.")
                if time.monotonic() > deadline:
                    raise ConfigError(f"its reply took longer than {timeout_s:g} s.")
    except urllib.error.HTTPError as error:
        with error:
            text = error.read(300).decode(errors="replace")
        raise ConfigError(f"status {error.code}: {printable(' '.join(text.split()))[:200]}") from None
    except (OSError, http.client.HTTPException) as error:
        reason = getattr(error, "reason", error)
        text = f"no reply in {timeout_s:g} s" if isinstance(reason, TimeoutError) else str(reason)
        raise ConfigError(f"{printable(text)}.") from None
    if announced is not None and announced.isdigit() and size != int(announced):
        raise ConfigError(f"its reply ended after {size} of {announced} bytes.")
    return b"".join(parts)


def view_bytes(rgb: NDArray[np.uint8], depth: NDArray[np.float32], camera: CameraModel) -> bytes:
    """Returns the request of `/posteriors`: an NPZ file of colour, depth (metres) and the camera as JSON."""
    stream = io.BytesIO()
    text = json.dumps(as_json(camera), sort_keys=True)
    np.savez(stream, allow_pickle=False, rgb=rgb, depth=depth, camera=np.frombuffer(text.encode(), np.uint8))
    return stream.getvalue()


def read_view(data: bytes) -> tuple[NDArray[np.uint8], NDArray[np.float32], CameraModel]:
    """Returns colour, depth and camera of a request of `/posteriors`.

    Raises:
        ConfigError: it is not one of `view_bytes`.
    """
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as file:
            rgb, depth = file["rgb"], file["depth"]
            camera = CameraModel(**json.loads(file["camera"].tobytes()))
    except (ValueError, KeyError, TypeError, OSError, EOFError, zipfile.BadZipFile) as error:
        raise ConfigError(f"This is not a view: {type(error).__name__}: {error}.") from None
    size = camera.height_px, camera.width_px
    if (rgb.dtype, rgb.shape, depth.dtype, depth.shape) != (np.uint8, (*size, 3), np.float32, size):
        raise ConfigError("This is not a view: its images have other types or sizes than its camera.")
    return rgb, depth, camera


def posteriors_bytes(posteriors: NDArray[np.float32]) -> bytes:
    """Returns the reply of `/posteriors`: an NPY file."""
    stream = io.BytesIO()
    np.save(stream, posteriors, allow_pickle=False)
    return stream.getvalue()


def read_posteriors(data: bytes, *, shape: tuple[int, int]) -> NDArray[np.float32]:
    """Returns the posteriors of a reply.

    Args:
        data: the reply.
        shape: rows and columns of the picture.

    Raises:
        ConfigError: they have another type, no whole fraction of the picture's size, or values outside of [0, 1].
    """
    try:
        posteriors = np.load(io.BytesIO(data), allow_pickle=False)
    except (ValueError, OSError, EOFError) as error:
        raise ConfigError(f"its reply cannot be read as an NPY file: {printable(str(error))[:120]}.") from None
    if not isinstance(posteriors, np.ndarray) or posteriors.dtype != np.float32 or posteriors.ndim != 3:
        raise ConfigError("its reply must be float32 (40, h, w).")
    classes, rows, columns = posteriors.shape
    fits = rows > 0 and columns > 0 and shape[0] % rows == 0 and shape[0] // rows * columns == shape[1]
    if classes != len(MPCAT40) - 1 or not fits:
        raise ConfigError(f"its reply has shape {posteriors.shape} for a picture of {shape[1]} x {shape[0]} pixels.")
    if not (posteriors.min() >= 0.0 and posteriors.max() <= 1.0 + 1e-5):  # also NaN
        raise ConfigError("its reply has probabilities outside of [0, 1].")
    return posteriors


def painted(segments: Sequence[Segment], shape: tuple[int, int]) -> NDArray[np.float32]:
    """Returns the posteriors of detections, float32 (40, h / 4, w / 4).

    A pixel has the score of the most probable detection that covers it, and the other categories share the rest. Where
    there is no detection, all categories are equally probable.

    Args:
        segments: what a detector reports.
        shape: rows and columns of the picture.
    """
    small, count = slice(STRIDE_PX // 2, None, STRIDE_PX), len(MPCAT40) - 1
    posteriors = np.full((count, *np.empty(shape, np.bool_)[small, small].shape), 1.0 / count, np.float32)
    for segment in sorted(segments, key=lambda segment: segment.score):  # the most probable is painted last
        mask = segment.mask[small, small]
        posteriors[:, mask] = (1.0 - segment.score) / (count - 1)
        posteriors[MPCAT40_ID[segment.category] - 1, mask] = segment.score
    return posteriors


def read_annotations(data: bytes, *, shape: tuple[int, int]) -> list[Segment]:
    """Returns the detections of a reply with annotations of COCO whose word names a category.

    Args:
        data: the reply: a list, or an object with a list `annotations`.
        shape: rows and columns of the picture.

    Raises:
        ConfigError: the reply has another form, or a mask of another size.
    """
    reply = parse_json(data, list[dict[str, Any]] | dict[str, Any], where="its reply")
    segments = []
    try:
        for entry in reply["annotations"] if isinstance(reply, dict) else reply:
            category, score = category_of(entry["category"]), float(entry["score"])
            if not 0.0 <= score <= 1.0:
                raise ConfigError("its reply has scores outside of [0, 1].")
            if category is not None:
                segments.append(Segment(category=category, score=score, mask=_mask_of(entry, shape)))
    except (TypeError, ValueError, KeyError, AttributeError, OverflowError) as error:
        if isinstance(error, ConfigError):
            raise
        raise ConfigError("its reply must be a list of annotations with category, score and bbox.") from None
    return segments


def _mask_of(entry: Mapping[str, Any], shape: tuple[int, int]) -> NDArray[np.bool_]:
    """Returns the mask (h, w) of an annotation: that of its run lengths, else its box."""
    if entry.get("segmentation") is not None:
        mask = decode_mask(entry["segmentation"])
        if mask.shape != shape:
            raise ConfigError(
                f"its reply has a mask of {mask.shape[1]} x {mask.shape[0]} pixels for a picture of "
                f"{shape[1]} x {shape[0]}."
            )
        return mask
    mask = np.zeros(shape, np.bool_)
    left, top, width, height = (round(float(side)) for side in entry["bbox"])
    mask[max(top, 0) : max(top + height, 0), max(left, 0) : max(left + width, 0)] = True
    return mask


@dataclass(frozen=True)
class Box:
    """A box that a detector reports."""

    corners: tuple[float, float, float, float]
    """Left, top, right and bottom edge, as shares of the picture."""
    score: float
    category: str


def read_boxes(data: bytes) -> list[Box]:
    """Returns the boxes of a reply of GroundingDINO whose phrase names a category.

    Raises:
        ConfigError: the reply has another form.
    """
    reply = parse_json(data, dict[str, Any], where="its reply")
    boxes, scores, phrases = (reply.get(name) for name in ("boxes", "logits", "phrases"))
    try:
        rows = [
            Box((float(left), float(top), float(right), float(bottom)), float(score), category)
            for (left, top, right, bottom), score, phrase in zip(boxes, scores, phrases, strict=True)  # pyright: ignore[reportArgumentType]
            if (category := category_of(phrase)) is not None
        ]
    except (TypeError, ValueError, AttributeError):
        raise ConfigError("its reply must have lists boxes (of four numbers), logits and phrases.") from None
    if not all(0.0 <= value <= 1.0 for box in rows for value in (box.score,)):
        raise ConfigError("its reply has scores outside of [0, 1].")
    return [replace(box, corners=tuple(min(max(side, 0.0), 1.0) for side in box.corners)) for box in rows]


def read_mask(data: bytes, *, shape: tuple[int, int]) -> NDArray[np.bool_]:
    """Returns the mask (h, w) of a reply of MobileSAM.

    Raises:
        ConfigError: the reply has another form or size.
    """
    text = parse_json(data, dict[str, Any], where="its reply").get("cropped_mask")
    try:
        mask = np.frombuffer(base64.b64decode(text, validate=True), np.uint8)  # pyright: ignore[reportArgumentType]
    except (TypeError, ValueError):
        raise ConfigError("its reply must have a text cropped_mask in base64.") from None
    if mask.size != math.prod(shape):
        raise ConfigError(f"its reply has a mask of {mask.size} pixels for a picture of {math.prod(shape)}.")
    return mask.reshape(shape) > 0
