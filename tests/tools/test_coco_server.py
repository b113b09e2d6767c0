"""The server of the external detector, with a detector of three lines in place of Node.js."""

from __future__ import annotations

import base64
import json
import threading
import urllib.error
import urllib.request
from collections.abc import Iterator
from typing import Any, cast

import cv2
import numpy as np
import pytest

from sim.app.services.remote import HttpConfig, HttpSegmenter
from sim.core.errors import ConfigError
from sim.core.interface import MPCAT40_ID, CameraModel
from tools.research.coco_server import make_server
from tools.research.external_eye import Detector
from tools.research.external_eye_scores import Detection

CAMERA = CameraModel(width_px=64, height_px=48)


class RedIsACouch:
    def detect(self, image: np.ndarray) -> list[Detection]:
        if image.max() == 0:
            raise ConfigError("The detector ended without a reply: it said nothing.")
        rows, columns = np.nonzero((image[..., 0] > 200) & (image[..., 2] < 50))
        box = float(columns.min()), float(rows.min()), float(columns.max() + 1), float(rows.max() + 1)
        return [Detection("couch", box, 0.7)]


@pytest.fixture
def url() -> Iterator[str]:
    server = make_server(cast(Detector, RedIsACouch()), 0)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_port}"
    server.shutdown()
    server.server_close()


def posted(url: str, body: bytes) -> tuple[int, str]:
    try:
        with urllib.request.urlopen(urllib.request.Request(url, body, method="POST"), timeout=10) as reply:
            return reply.status, reply.read().decode()
    except urllib.error.HTTPError as error:
        with error:
            return error.code, error.read().decode()


def test_the_segmenter_of_a_run_understands_its_replies(url: str) -> None:
    rgb = np.full((48, 64, 3), 90, np.uint8)
    rgb[8:40, 16:48] = (250, 0, 0)
    segmenter = HttpSegmenter(CAMERA, HttpConfig(url=url, form="coco"))
    shown = segmenter.categories({"rgb": rgb, "depth": np.ones((48, 64), np.float32)})
    assert (shown[2:10, 4:12] == MPCAT40_ID["sofa"]).all()
    assert np.count_nonzero(shown) == 8 * 8


@pytest.mark.parametrize(
    ("request_of", "message"),
    [
        (b"no JSON", "The request"),
        ({"words": []}, "needs 'image'"),
        ({"image": 5}, "needs 'image'"),
        ({"image": "###"}, "needs 'image'"),
        ({"image": base64.b64encode(b"GIF89a").decode()}, "'image'"),
        (
            {"image": base64.b64encode(cv2.imencode(".png", np.zeros((9, 9, 3), np.uint8))[1].tobytes()).decode()},
            "ended",
        ),
    ],
)
def test_other_requests_are_answered_with_a_sentence(url: str, request_of: Any, message: str) -> None:
    status, text = posted(url, request_of if isinstance(request_of, bytes) else json.dumps(request_of).encode())
    assert status == 400
    assert message in text
    assert "\n" not in text
