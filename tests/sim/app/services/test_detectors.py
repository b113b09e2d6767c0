"""The server of detectors as an ASGI application, without a network."""

from __future__ import annotations

import asyncio
import base64
import http.server
import json
from dataclasses import replace
from typing import Any

import cv2
import numpy as np
import pytest

pytest.importorskip("starlette", reason="no starlette: pip install -e '.[web]'")

from sim.app.services.detectors import (
    NetworkDetector,
    Segment,
    _network,
    make_detector,
    mask_in,
    noisy_segments,
    phrases_of,
    share_of,
    true_segments,
)
from sim.app.services.forms import read_posteriors, view_bytes
from sim.app.services.frames import Frame, Shelf, UnknownPictureError, register
from sim.app.services.hosting import in_address
from sim.app.services.server import Answers, make_app
from sim.app.services.words import categories_in, category_of
from sim.core.errors import ConfigError
from sim.core.interface import CameraModel
from tests.helpers.services import Handler, Start, body_of, closed

HEIGHT, WIDTH = 96, 128
CHAIR, SOFA = slice(8, 40), slice(60, 100)
"""Columns of the objects, which have rows 30 to 90."""


def frame(seed: int = 0, shade: int = 0) -> Frame:
    rng = np.random.default_rng(shade)
    rgb = cv2.resize(rng.integers(0, 255, (6, 8, 3), np.uint8), (WIDTH, HEIGHT), interpolation=cv2.INTER_CUBIC)
    objects = np.full((HEIGHT, WIDTH), -1, np.int16)
    objects[30:90, CHAIR], objects[30:90, SOFA] = 0, 1
    return Frame(
        rgb=np.asarray(rgb, np.uint8),
        depth=np.full((HEIGHT, WIDTH), 2.0, np.float32),
        objects=objects,
        names=("chair_00", "sofa_00", "bed_00"),
        categories=("chair", "sofa", "bed"),
        middles_xy_m=np.array([[2.0, 1.0], [2.0, -1.0], [9.0, 9.0]]),
        eye_xy_m=(0.0, 0.0),
        seed=seed,
        number=1,
        camera=CameraModel(width_px=WIDTH, height_px=HEIGHT),
    )


def jpeg(picture: np.ndarray) -> str:
    return base64.b64encode(cv2.imencode(".jpg", picture)[1].tobytes()).decode()


class Client:
    """Calls the application as a server does."""

    def __init__(self, source: Any = "truth") -> None:
        self._app = make_app(make_detector(source))

    def post(self, path: str, body: bytes | dict[str, Any]) -> tuple[int, Any]:
        sent: list[Any] = []
        data = body if isinstance(body, bytes) else json.dumps(body).encode()

        async def send(message: Any) -> None:
            sent.append(message)

        async def receive() -> Any:
            return {"type": "http.request", "body": data, "more_body": False}

        scope = {"type": "http", "method": "POST", "path": path, "headers": [], "query_string": b""}
        asyncio.run(self._app(scope, receive, send))
        text = b"".join(message.get("body", b"") for message in sent[1:]).decode()
        status = sent[0]["status"]
        return status, json.loads(text) if status == 200 else text


@pytest.fixture
def client() -> Client:
    made = Client()
    assert made.post("/frame", frame().to_bytes()) == (204, "")
    return made


def test_a_frame_is_the_same_after_its_bytes() -> None:
    before = frame(seed=7)
    after = Frame.from_bytes(before.to_bytes())
    assert (after.names, after.seed, after.eye_xy_m, after.camera) == (before.names, 7, (0.0, 0.0), before.camera)
    for name in ("rgb", "depth", "objects", "middles_xy_m"):
        np.testing.assert_array_equal(getattr(after, name), getattr(before, name))
        assert getattr(after, name).dtype == getattr(before, name).dtype


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"nothing",
        frame().to_bytes()[:200],
        replace(frame(), depth=np.zeros((2, 2), np.float32)).to_bytes(),
        replace(frame(), categories=("chair",)).to_bytes(),
        replace(frame(), objects=np.full((HEIGHT, WIDTH), 3, np.int16)).to_bytes(),
        replace(frame(), number=float("inf")).to_bytes(),  # type: ignore[arg-type]
        replace(frame(), eye_xy_m=(10**400, 0)).to_bytes(),
    ],
)
def test_other_bytes_are_no_frame(data: bytes) -> None:
    with pytest.raises(ConfigError, match="not a frame"):
        Frame.from_bytes(data)


def test_a_picture_finds_its_frame_after_compression_in_either_order_of_channels() -> None:
    shelf, frames = Shelf(), [frame(shade=shade) for shade in range(4)]
    with pytest.raises(UnknownPictureError, match=r"no simulator has sent a frame.* detector.form=posteriors"):
        shelf.find(frames[0].rgb)
    for one in frames:
        shelf.add(one)
    for one in frames:
        sent = np.asarray(cv2.imdecode(cv2.imencode(".jpg", one.rgb)[1], cv2.IMREAD_COLOR))
        assert shelf.find(np.asarray(sent, np.uint8)) is one
        assert shelf.find(np.asarray(sent[..., ::-1], np.uint8)) is one
    with pytest.raises(UnknownPictureError, match="last 4 frames"):
        shelf.find(frame(shade=9).rgb)


def test_the_truth_has_exact_boxes_and_no_object_that_is_out_of_view() -> None:
    chair, sofa = true_segments(frame())
    assert (chair.category, chair.score, sofa.category) == ("chair", 1.0, "sofa")
    assert chair.box == (8 / WIDTH, 30 / HEIGHT, 40 / WIDTH, 90 / HEIGHT)


def test_the_errors_of_a_network_depend_on_the_seed() -> None:
    seen = [noisy_segments(frame(seed)) for seed in range(40)]
    classes = {tuple(segment.category for segment in segments) for segments in seen}
    assert ("chair", "sofa") in classes
    assert len(classes) > 3
    assert all(0.0 < segment.score < 1.0 for segments in seen for segment in segments)
    again = noisy_segments(frame(3))
    assert [(s.category, s.score) for s in again] == [(s.category, s.score) for s in seen[3]]
    assert any((s.mask != true_segments(frame())[0].mask).any() for s in again)


def test_words_name_categories() -> None:
    assert category_of("Potted  plant") == "plant"
    assert category_of("tv") == category_of("tv_monitor") == "tv_monitor"
    assert category_of("chairs") == "chair"
    assert category_of("dragon") is category_of("void") is None
    assert category_of("door") == "door"
    assert [category_of(word) for word in ("dresser", "nightstand", "fridge", "desk", "armchair")] == [
        "chest_of_drawers", "chest_of_drawers", "appliances", "table", "chair",
    ]  # fmt: skip
    assert categories_in("a flower bed by the night stand") == {"chest_of_drawers"}
    assert categories_in("Seems like there is a tv monitor or couches ahead, or a seatingroom.") == {
        "tv_monitor",
        "sofa",
    }
    assert phrases_of("chair . couch .sofa. unicorn .") == {"chair": "chair", "sofa": "couch"}


def test_a_box_selects_the_mask_that_overlaps_it_most() -> None:
    segments = true_segments(frame())
    np.testing.assert_array_equal(mask_in(segments, [55, 20, 105, 95], (HEIGHT, WIDTH)), segments[1].mask)
    assert not mask_in(segments, [110, 0, 120, 20], (HEIGHT, WIDTH)).any()
    assert not mask_in([], [0, 0, 9, 9], (HEIGHT, WIDTH)).any()


def test_the_share_counts_each_pixel_once() -> None:
    half = np.zeros((2, 4), np.bool_)
    half[:, :2] = True
    twice = [Segment(category="chair", score=1.0, mask=half), Segment(category="sofa", score=1.0, mask=half)]
    assert share_of(twice, "a chair or a couch") == 0.5
    assert share_of(twice, "a bed") == 0.0


def test_each_service_answers_in_the_form_of_vlfm(client: Client) -> None:
    image = jpeg(frame().rgb)
    status, found = client.post("/gdino", {"image": image, "caption": "couch . bed ."})
    assert status == 200
    assert found == {
        "boxes": [[60 / WIDTH, 30 / HEIGHT, 100 / WIDTH, 90 / HEIGHT]], "logits": [1.0], "phrases": ["couch"],
    }  # fmt: skip
    assert client.post("/yolov7", {"image": image})[1]["phrases"] == ["chair", "couch"]
    assert client.post("/yolov7", {"image": image, "conf_thres": 1.1})[1]["phrases"] == []
    text = client.post("/mobile_sam", {"image": image, "bbox": [60, 30, 100, 90]})[1]["cropped_mask"]
    mask = np.frombuffer(base64.b64decode(text), np.uint8).reshape(HEIGHT, WIDTH)
    np.testing.assert_array_equal(mask, frame().objects == 1)
    share = float((frame().objects == 0).mean())
    answer = client.post("/blip2itm", {"image": image, "txt": "Seems like there is a chair ahead."})[1]
    assert answer == {"response": share, "itm score": share}


@pytest.mark.parametrize(
    ("path", "body", "status", "words"),
    [
        ("/gdino", b"{", 400, "The request"),
        ("/gdino", {"image": jpeg(frame().rgb)}, 400, "'caption'"),
        ("/gdino", {"caption": "chair ."}, 400, "'image'"),
        ("/gdino", {"image": "AAAA", "caption": "chair ."}, 400, "JPEG or PNG"),
        ("/gdino", {"image": "???", "caption": "chair ."}, 400, "JPEG or PNG"),
        ("/yolov7", {"image": jpeg(frame().rgb), "conf_thres": "high"}, 400, "'conf_thres': expected float"),
        ("/yolov7", {"image": jpeg(frame().rgb), "conf_thres": 10**400}, 400, "'conf_thres': number out of range"),
        ("/mobile_sam", {"image": jpeg(frame().rgb), "bbox": [1, 2]}, 400, "'bbox': expected array of length 4"),
        ("/mobile_sam", {"image": jpeg(frame().rgb), "bbox": [1, 2, 3, 10**400]}, 400, "number out of range"),
        ("/blip2itm", {"image": jpeg(frame(shade=5).rgb), "txt": "a"}, 404, "STUBBORN_HABITAT"),
        ("/blip2itm", {"image": jpeg(frame().rgb[::2, ::2]), "txt": "a"}, 404, "128 x 96"),
        ("/frame", b"nothing", 400, "not a frame"),
    ],
)
def test_a_wrong_request_is_answered_with_a_sentence(
    client: Client, path: str, body: bytes | dict[str, Any], status: int, words: str
) -> None:
    answered, text = client.post(path, body)
    assert answered == status
    assert words in text
    assert client.post("/yolov7", {"image": jpeg(frame().rgb)})[0] == 200


def test_the_network_sees_a_frame_by_itself() -> None:
    blank = replace(frame(), rgb=np.full((HEIGHT, WIDTH, 3), 200, np.uint8))
    client = Client("network")
    client.post("/frame", blank.to_bytes())
    status, found = client.post("/yolov7", {"image": jpeg(blank.rgb), "conf_thres": 0.0})
    assert status == 200
    assert len(found["boxes"]) == len(found["logits"]) == len(found["phrases"])
    segments = make_detector("network")(blank)
    assert sum(int(segment.mask.sum()) for segment in segments) > 0.9 * HEIGHT * WIDTH


def test_posteriors_are_those_of_the_network_in_process(client: Client) -> None:
    camera, one = CameraModel(width_px=WIDTH, height_px=HEIGHT), frame()
    detector = NetworkDetector()
    own = Answers(detector).posteriors(view_bytes(one.rgb, one.depth, camera))
    direct = _network(camera).posteriors({"rgb": one.rgb.copy(), "depth": one.depth})
    np.testing.assert_array_equal(read_posteriors(bytes(own.body), shape=(HEIGHT, WIDTH)), direct)
    status, text = client.post("/posteriors", view_bytes(one.rgb, one.depth, camera))
    assert status == 400
    assert "--source network" in text


def no_http(handler: http.server.BaseHTTPRequestHandler, body: bytes) -> None:
    handler.wfile.write(b"SSH-2.0-OpenSSH\r\n")


@pytest.mark.parametrize(
    ("answer", "words"),
    [(no_http, "OpenSSH"), (closed, "closed connection"), (body_of(b"No frame.", 400), "No frame.")],
)
def test_a_server_that_does_not_take_frames_is_named(start: Start, answer: Handler, words: str) -> None:
    url = start(answer).url
    with pytest.raises(ConfigError, match=f"detectors={url}: .*{words}.* `stubborn serve detectors` starts"):
        register(url, frame())
    with pytest.raises(ConfigError, match="must be http"):
        register(url.removeprefix("http://"), frame())


def test_an_address_has_brackets_around_a_host_of_ipv6() -> None:
    assert [in_address(host) for host in ("localhost", "::1")] == ["localhost", "[::1]"]
