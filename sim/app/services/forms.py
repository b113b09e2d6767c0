"""What a server of detectors is sent, and what it replies: bytes to arrays, and back.

`/posteriors` takes a view as an NPZ file and replies with an NPY file; the other forms are JSON, as COCO, GroundingDINO
and MobileSAM have them. Each reader refuses a reply of another form with a ConfigError that begins "its reply".
"""

from __future__ import annotations

import base64
import io
import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.app.services.client import MAX_BYTES
from sim.app.services.detectors import Segment
from sim.app.services.words import category_of
from sim.core.configuration import as_json
from sim.core.errors import ConfigError
from sim.core.interface import MPCAT40, CameraModel
from sim.core.reading import parse_json, printable, read_npz
from sim.training.views.coco import decode_mask


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
    arrays = read_npz(data, ("rgb", "depth", "camera"), what="view", most_bytes=MAX_BYTES)
    rgb, depth = arrays["rgb"], arrays["depth"]
    camera = parse_json(arrays["camera"].tobytes(), CameraModel, where="This is not a view: its camera")
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
    if not data.startswith(b"\x93NUMPY"):
        raise ConfigError(f"its reply is not an NPY file: it {f'begins with {data[:40]!r}' if data else 'is empty'}.")
    stream = io.BytesIO(data)
    try:
        posteriors = np.load(stream, allow_pickle=False)
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
                mask = _mask_of(entry, shape)
                segments.append(Segment(category=category, score=score, mask=mask, phrase=entry["category"]))
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
    phrase: str
    """The server's word."""


def read_boxes(data: bytes) -> list[Box]:
    """Returns the boxes of a reply of GroundingDINO whose phrase names a category.

    Raises:
        ConfigError: the reply has another form.
    """
    reply = parse_json(data, dict[str, Any], where="its reply")
    boxes, scores, phrases = (reply.get(name) for name in ("boxes", "logits", "phrases"))
    try:
        rows = [
            Box((float(left), float(top), float(right), float(bottom)), float(score), category, phrase)
            for (left, top, right, bottom), score, phrase in zip(boxes, scores, phrases, strict=True)  # pyright: ignore[reportArgumentType]
            if (category := category_of(phrase)) is not None
        ]
    except (TypeError, ValueError, AttributeError, OverflowError):
        raise ConfigError("its reply must have lists boxes (of four numbers), logits and phrases.") from None
    if not all(0.0 <= box.score <= 1.0 for box in rows):
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
