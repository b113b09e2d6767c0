"""The answers of the server of detectors: VLFM's four services, and the frames that simulators register.

| POST | request | reply |
|---|---|---|
| /gdino | image, caption `chair . sofa .`, box_threshold | boxes (shares of the picture, xyxy), logits, phrases |
| /yolov7 | image, conf_thres | the same, with COCO's phrases |
| /mobile_sam | image, bbox (pixels, xyxy) | cropped_mask: base64 of a byte per pixel |
| /blip2itm | image, txt | response, `itm score`: share of the picture that shows what the text names |
| /posteriors | an NPZ file of `sim.app.services.forms.view_bytes` | an NPY file: float32 (40, h, w) |
| /frame | an NPZ file of `sim.app.services.frames.Frame` | nothing |

Requests and replies are JSON, an image is base64 of a JPEG or PNG. A refused request is answered with status 400, a
picture of no registered frame with 404; the reply's body is one sentence.
"""

from __future__ import annotations

import base64
import binascii
import threading
from collections import OrderedDict
from collections.abc import Callable, Mapping
from typing import Any, TypeVar

import anyio.to_thread
import numpy as np
from numpy.typing import NDArray
from starlette.applications import Starlette
from starlette.requests import ClientDisconnect, Request
from starlette.responses import JSONResponse, PlainTextResponse, Response
from starlette.routing import Route

from sim.app.services.client import MAX_BYTES
from sim.app.services.detectors import Detector, NetworkDetector, Segment, detections, mask_in, phrases_of, share_of
from sim.app.services.forms import posteriors_bytes, read_view
from sim.app.services.frames import MAX_FRAMES, Frame, Shelf, UnknownPictureError
from sim.app.services.words import COCO
from sim.core.errors import ConfigError
from sim.core.interface import MAX_SIDE_PX
from sim.core.pictures import decode_picture
from sim.core.reading import convert, parse_json, printable

T = TypeVar("T")
Corners = tuple[float, float, float, float]
"""A box: left, top, right and bottom edge."""
_BYTES = "application/octet-stream"
BOX_THRESHOLD = 0.35
"""Least score of GroundingDINO's boxes if the request states none."""
CONFIDENCE = 0.25
"""Least score of YOLO's boxes if the request states none."""


class Answers:
    """The answers of one server; safe for several threads."""

    def __init__(self, detector: Detector) -> None:
        self._detector = detector
        self._network = detector if isinstance(detector, NetworkDetector) else None
        self._shelf = Shelf()
        self._seen = OrderedDict[int, tuple[Frame, list[Segment]]]()
        self._lock = threading.Lock()

    def frame(self, body: bytes) -> Response:
        """Registers a frame."""
        self._shelf.add(Frame.from_bytes(body))
        return Response(status_code=204)

    def posteriors(self, body: bytes) -> Response:
        """Runs the network on colour and depth of the request."""
        if self._network is None:
            raise ConfigError("`stubborn serve detectors --source network` starts a server that answers this.")
        return Response(posteriors_bytes(self._network.posteriors(*read_view(body))), media_type=_BYTES)

    def gdino(self, body: bytes) -> Response:
        """Detects what the words of a caption name."""
        request = _Request(body)
        phrases = phrases_of(request.value("caption", str))
        return self._detected(request, phrases, request.value("box_threshold", float, otherwise=BOX_THRESHOLD))

    def yolov7(self, body: bytes) -> Response:
        """Detects what COCO has a name for."""
        request = _Request(body)
        return self._detected(request, COCO, request.value("conf_thres", float, otherwise=CONFIDENCE))

    def mobile_sam(self, body: bytes) -> Response:
        """Segments the object in a box."""
        request = _Request(body)
        mask = mask_in(self._segments(request), request.value("bbox", Corners), request.image.shape[:2])
        return JSONResponse({"cropped_mask": base64.b64encode(mask.tobytes()).decode()})

    def blip2itm(self, body: bytes) -> Response:
        """Scores how much of the picture shows what a text names."""
        request = _Request(body)
        share = share_of(self._segments(request), request.value("txt", str))
        return JSONResponse({"response": share, "itm score": share})

    def _detected(self, request: _Request, phrases: Mapping[str, str], least_score: float) -> Response:
        return JSONResponse(detections(self._segments(request), phrases, least_score))

    def _segments(self, request: _Request) -> list[Segment]:
        """Returns what the detector sees in the frame of a request's picture; each frame is processed once."""
        frame = self._shelf.find(request.image)
        if frame.depth.shape != request.image.shape[:2]:
            rows, columns = frame.depth.shape
            raise UnknownPictureError(f"The frame of this picture has {columns} x {rows} pixels: send it in that size.")
        with self._lock:
            if id(frame) not in self._seen:
                self._seen[id(frame)] = frame, self._detector(frame)
                while len(self._seen) > MAX_FRAMES:
                    self._seen.popitem(last=False)
            return self._seen[id(frame)][1]


class _Request:
    """The JSON of a request."""

    def __init__(self, body: bytes) -> None:
        self._values: Mapping[str, Any] = parse_json(body, dict[str, Any], where="The request")
        self.image = _picture(self.value("image", str))
        """(h, w, 3), the channels in the order of the client."""

    def value(self, name: str, kind: type[T] | Any, *, otherwise: Any = None) -> T:
        """Returns a value, or another one if it is missing.

        Raises:
            ConfigError: it is of another type.
        """
        return convert(self._values.get(name, otherwise), kind, where=f"The request, field '{name}'")


def _picture(text: str) -> NDArray[np.uint8]:
    """Returns the picture of a base64 text.

    Raises:
        ConfigError: it is no picture, or too large.
    """
    try:
        picture = decode_picture(base64.b64decode(text, validate=True), where="'image'")
    except (binascii.Error, ValueError):  # a ConfigError is a ValueError
        picture = None
    if picture is None or max(picture.shape[:2]) > MAX_SIDE_PX:
        raise ConfigError(f"'image' must be base64 of a JPEG or PNG of at most {MAX_SIDE_PX} pixels on each side.")
    return np.asarray(picture, np.uint8)


def make_app(detector: Detector) -> Starlette:
    """Returns the application that answers with a detector."""
    answers = Answers(detector)
    served: dict[str, Callable[[bytes], Response]] = {
        "/frame": answers.frame,
        "/posteriors": answers.posteriors,
        "/gdino": answers.gdino,
        "/yolov7": answers.yolov7,
        "/mobile_sam": answers.mobile_sam,
        "/blip2itm": answers.blip2itm,
    }
    return Starlette(routes=[Route(path, _endpoint(answer), methods=["POST"]) for path, answer in served.items()])


def _endpoint(answer: Callable[[bytes], Response]) -> Any:
    """Returns a handler that reads the whole body and answers in a thread."""

    async def respond(request: Request) -> Response:
        parts, size = list[bytes](), 0
        try:
            async for part in request.stream():
                size += len(part)
                if size > MAX_BYTES:
                    return PlainTextResponse(f"The request is longer than {MAX_BYTES} bytes.", 413)
                parts.append(part)
        except ClientDisconnect:
            return Response(status_code=400)
        try:
            return await anyio.to_thread.run_sync(answer, b"".join(parts))
        except ConfigError as error:
            status = 404 if isinstance(error, UnknownPictureError) else 400
            return PlainTextResponse(printable(str(error)), status)

    return respond
