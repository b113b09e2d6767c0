"""Pictures with their truth: the simulator registers each frame, and a picture that an agent sends finds its frame.

Agents send their picture as a JPEG, with channels in either order. Its thumbnail is compared with those of the frames
that were registered last, so that neither the compression nor the order matters.
"""

from __future__ import annotations

import io
import json
import math
import threading
from collections import deque
from dataclasses import asdict, dataclass, fields

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.app.services.client import MAX_BYTES, is_address, post
from sim.core.errors import ConfigError
from sim.core.interface import CameraModel
from sim.core.reading import parse_json, read_npz

TIMEOUT_S = 5.0
MAX_FRAMES = 64
"""Frames that a server keeps."""
MAX_DIFFERENCE = 6.0
"""Largest mean difference of two thumbnails of the same picture, in grey levels."""
THUMBNAIL_PX = (32, 24)


class UnknownPictureError(ConfigError):
    """No frame of a picture is registered."""


@dataclass(frozen=True, kw_only=True)
class FrameFacts:
    """What is known of a frame besides its arrays; the part of its file that is JSON."""

    names: tuple[str, ...]
    """Names of the objects of the house, such as `chair_03`."""
    categories: tuple[str, ...]
    """Categories of the objects."""
    eye_xy_m: tuple[float, float]
    """Position of the camera in plan."""
    seed: int
    """Seed of the episode."""
    number: int
    """Number of the frame in the episode."""
    camera: CameraModel
    """Field of view, height and range of the camera."""


@dataclass(frozen=True, kw_only=True)
class Frame(FrameFacts):
    """What a camera sees, and what it is."""

    rgb: NDArray[np.uint8]
    """(h, w, 3)."""
    depth: NDArray[np.float32]
    """(h, w) metres along the optical axis; 0: none or nearer than the range, the largest distance: farther."""
    objects: NDArray[np.int16]
    """(h, w) index of the object that each pixel shows; -1: none."""
    middles_xy_m: NDArray[np.float64]
    """(objects, 2) positions in plan at the start of the episode."""

    def to_bytes(self) -> bytes:
        """Returns the frame as an NPZ file."""
        arrays = {name: getattr(self, name) for name in _ARRAYS}
        others = {field.name: getattr(self, field.name) for field in fields(FrameFacts)}
        text = json.dumps({**others, "camera": asdict(self.camera)})
        stream = io.BytesIO()
        np.savez(stream, allow_pickle=False, others=np.frombuffer(text.encode(), np.uint8), **arrays)
        return stream.getvalue()

    @classmethod
    def from_bytes(cls, data: bytes) -> Frame:
        """Returns the frame of an NPZ file.

        Raises:
            ConfigError: the file is not one of `to_bytes`.
        """
        arrays = read_npz(data, (*_ARRAYS, "others"), what="frame", most_bytes=MAX_BYTES)
        text = arrays.pop("others").tobytes()
        frame = cls(**arrays, **vars(parse_json(text, FrameFacts, where="This is not a frame: its text")))
        height, width = frame.objects.shape if frame.objects.ndim == 2 else (0, 0)
        right = (
            frame.rgb.dtype == np.uint8
            and frame.rgb.shape == (height, width, 3)
            and frame.depth.dtype == np.float32
            and frame.depth.shape == (height, width)
            and np.issubdtype(frame.objects.dtype, np.signedinteger)
            and height * width > 0
            and len(frame.names) == len(frame.categories) == len(frame.middles_xy_m)
            and -1 <= frame.objects.min() <= frame.objects.max() < len(frame.names)
        )
        if not right:
            raise ConfigError("This is not a frame: its arrays have other types, sizes or values.")
        return frame


_ARRAYS = ("rgb", "depth", "objects", "middles_xy_m")


def register(url: str, frame: Frame) -> None:
    """Sends a frame to the server of detectors at `url`.

    Raises:
        ConfigError: there is no such server, or it refuses the frame.
    """
    if not is_address(url):
        raise ConfigError(f"detectors={url} must be http://HOST:PORT or https://HOST:PORT.")
    try:
        post(f"{url.rstrip('/')}/frame", frame.to_bytes(), {}, TIMEOUT_S)
    except ConfigError as error:
        raise ConfigError(f"detectors={url}: {error} `stubborn serve detectors` starts the server.") from None


class Shelf:
    """The frames that were registered last; safe for several threads."""

    def __init__(self) -> None:
        self._frames: deque[tuple[NDArray[np.float32], Frame]] = deque(maxlen=MAX_FRAMES)
        self._lock = threading.Lock()

    def add(self, frame: Frame) -> None:
        """Adds a frame; the oldest is dropped."""
        entry = _thumbnail(frame.rgb), frame
        with self._lock:
            self._frames.append(entry)

    def find(self, picture: NDArray[np.uint8]) -> Frame:
        """Returns the frame of a picture, the last one if several are equally similar.

        Args:
            picture: (h, w, 3), RGB or BGR.

        Raises:
            UnknownPictureError: no frame is similar.
        """
        own = _thumbnail(picture)
        with self._lock:
            frames = list(self._frames)
        best, found = math.inf, None
        for thumbnail, frame in reversed(frames):
            difference = min(float(np.abs(thumbnail - own[..., order]).mean()) for order in (slice(None), [2, 1, 0]))
            if difference < best:
                best, found = difference, frame
        if found is None or best > MAX_DIFFERENCE:
            last = f"is not one of the last {len(frames)} frames that a simulator sent"
            raise UnknownPictureError(
                f"This picture {last if frames else 'is unknown, because no simulator has sent a frame'}: run a script "
                "of Habitat with STUBBORN_HABITAT=detectors=http://localhost:12181 (docs/habitat.md). `stubborn run` "
                "asks this server with detector.form=posteriors."
            )
        return found


def _thumbnail(picture: NDArray[np.uint8]) -> NDArray[np.float32]:
    return np.asarray(cv2.resize(picture, THUMBNAIL_PX, interpolation=cv2.INTER_AREA), np.float32)
