"""A segmenter that asks a server, against servers that answer right, wrong or not at all."""

from __future__ import annotations

import base64
import http.server
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import torch

from sim.app.composition.segmenters import find_segmentation
from sim.app.options import RunOptions
from sim.app.services.client import is_address
from sim.app.services.forms import posteriors_bytes, read_posteriors, read_view, view_bytes
from sim.app.services.remote import HttpConfig, HttpSegmenter
from sim.core.errors import AgentError, ConfigError
from sim.core.interface import MPCAT40_ID, CameraModel
from sim.core.vocabulary import vocabulary
from sim.training.views.coco import encode_mask
from stubborn.detection.wished import WishedSegmenter
from stubborn.segmentation.calibration import Calibration
from tests.helpers.services import Handler, Start, body_of, closed, cut, late, mute, send, trickled

CAMERA = CameraModel(width_px=64, height_px=48)


def view(seed: int = 0) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(seed)
    size = CAMERA.height_px, CAMERA.width_px
    return {"rgb": rng.integers(0, 256, (*size, 3), np.uint8), "depth": rng.uniform(0.5, 5.0, size).astype(np.float32)}


def probabilities(seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).dirichlet(np.ones(40), (12, 16)).transpose(2, 0, 1).astype(np.float32)


def asking(url: str, **others: Any) -> HttpSegmenter:
    return HttpSegmenter(CAMERA, HttpConfig(url=url, **others))


def test_the_address_of_a_server_is_a_kind_of_segmentation() -> None:
    kind = find_segmentation("http://localhost:12181", None)
    assert kind.config == HttpConfig(url="http://localhost:12181")
    assert RunOptions(semantics="http://localhost:12181").own_modules == []
    assert is_address("https://[::1]:8000/detect")
    assert not any(map(is_address, ("http://", "http:localhost", "http://host:port", "package.module:NAME", "gt")))
    with pytest.raises(ConfigError, match="--weights go with"):
        find_segmentation("http://localhost:12181", Path("weights"))


@pytest.mark.parametrize("wrong", [{"url": "localhost"}, {"timeout_s": 0.0}, {"retries": -1}, {"box_threshold": 2.0}])
def test_wrong_settings_are_refused(wrong: dict[str, Any]) -> None:
    with pytest.raises(ConfigError, match="HttpConfig"):
        replace(HttpConfig(url="http://localhost:1"), **wrong)


def test_colour_and_depth_arrive_without_loss_and_posteriors_come_back(start: Start) -> None:
    seen: list[Any] = []

    def answer(handler: http.server.BaseHTTPRequestHandler, body: bytes) -> None:
        seen.append(read_view(body))
        send(handler, posteriors_bytes(probabilities()))

    server, observation = start(answer), view()
    segmenter = asking(server.url)
    np.testing.assert_array_equal(segmenter.posteriors(observation), probabilities())
    scores = segmenter.scores(observation, "chair")
    np.testing.assert_array_equal(scores.target, probabilities()[MPCAT40_ID["chair"] - 1])
    assert [path for path, _ in server.requests] == ["/posteriors"]  # one request a frame
    rgb, depth, camera = seen[0]
    np.testing.assert_array_equal(rgb, observation["rgb"])
    np.testing.assert_array_equal(depth, observation["depth"])
    assert camera == CAMERA


def test_boxes_and_masks_of_vlfms_servers_become_posteriors(start: Start) -> None:
    mask = np.zeros((48, 64), np.uint8)
    mask[8:40, 16:48] = 1

    def answer(handler: http.server.BaseHTTPRequestHandler, body: bytes) -> None:
        if handler.path == "/gdino":
            reply = {
                "boxes": [[0.25, 0.2, 0.75, 0.8], [0.0, 0.0, 1.0, 1.0], [0.0, 0.0, 1.0, 1.0]],
                "logits": [0.8, 0.1, 0.9],
                "phrases": ["couch", "chair", "unicorn"],
            }
        else:
            assert json.loads(body)["bbox"] == pytest.approx([16.0, 9.6, 48.0, 38.4])
            reply = {"cropped_mask": base64.b64encode(mask.tobytes()).decode()}
        send(handler, json.dumps(reply).encode())

    server, observation = start(answer), view()
    segmenter = asking(server.url, form="vlfm")
    posteriors = segmenter.posteriors(observation)
    assert posteriors.shape == (40, 12, 16)
    np.testing.assert_allclose(posteriors.sum(axis=0), 1.0, atol=1e-5)
    assert set(np.unique(segmenter.categories(observation))) == {0, MPCAT40_ID["sofa"]}
    np.testing.assert_allclose(posteriors[MPCAT40_ID["sofa"] - 1][mask[2::4, 2::4] > 0], 0.8)
    assert "chair . table . picture" in json.loads(server.requests[0][1])["caption"]
    assert [path for path, _ in server.requests] == ["/gdino", "/mobile_sam"]


def test_annotations_of_coco_become_posteriors(start: Start) -> None:
    mask, observation = np.zeros((48, 64), np.bool_), view()
    mask[8:40, 16:48] = True

    def answer(handler: http.server.BaseHTTPRequestHandler, body: bytes) -> None:
        question = json.loads(body)
        data = np.frombuffer(base64.b64decode(question["image"]), np.uint8)
        sent = np.asarray(cv2.imdecode(data, cv2.IMREAD_COLOR))
        np.testing.assert_array_equal(sent[..., ::-1], observation["rgb"])
        assert "tv monitor" in question["words"]
        annotations = [
            {"category": "bed", "score": 0.6, "bbox": [0, 0, 64, 12]},
            {"category": "couch", "score": 0.9, "bbox": [16, 8, 32, 32], "segmentation": encode_mask(mask)},
            {"category": "dog", "score": 0.9, "bbox": [0, 0, 64, 48]},
            {"category": "chair", "score": 0.2, "bbox": [0, 0, 64, 48]},
        ]
        send(handler, json.dumps({"annotations": annotations}).encode())

    server = start(answer)
    segmenter = asking(f"{server.url}/detect", form="coco")
    shown = segmenter.categories(observation)
    expected = np.zeros((48, 64), np.uint8)
    expected[:12], expected[mask] = MPCAT40_ID["bed"], MPCAT40_ID["sofa"]
    np.testing.assert_array_equal(shown, expected[2::4, 2::4])
    np.testing.assert_allclose(segmenter.posteriors(observation).sum(axis=0), 1.0, atol=1e-5)
    assert [path for path, _ in server.requests] == ["/detect"]


def pickled(handler: http.server.BaseHTTPRequestHandler, body: bytes) -> None:
    stream = np.array([print], object)
    import io

    file = io.BytesIO()
    np.save(file, stream, allow_pickle=True)
    send(handler, file.getvalue())


def as_json(**reply: Any) -> Handler:
    return body_of(json.dumps(reply).encode())


slow, trickle, half = (fault(posteriors_bytes(probabilities())) for fault in (late, trickled, cut))


FAULTS: dict[str, tuple[Handler, str, str]] = {
    "slow": (slow, "posteriors", "no reply in 0.3 s"),
    "trickle": (trickle, "posteriors", "longer than 0.3 s"),
    "closed": (closed, "posteriors", "closed connection|reset"),
    "half": (half, "posteriors", r"ended after \d+ of \d+ bytes"),
    "empty": (body_of(b""), "posteriors", "is not an NPY file: it is empty"),
    "garbage": (body_of(b"\x00\xff garbage"), "posteriors", "is not an NPY file: it begins with b'"),
    "code": (pickled, "posteriors", "cannot be read as an NPY file"),
    "500": (body_of(b"<h1>broken\x1b[2J</h1>", 500), "posteriors", "status 500: <h1>broken"),
    "500 without a text": (mute, "posteriors", "status 500: without a text"),
    "404": (body_of(b"nothing here", 404), "posteriors", "status 404: nothing here"),
    "type": (body_of(posteriors_bytes(probabilities().astype(np.float64))), "posteriors", "float32"),  # type: ignore[arg-type]
    "size": (body_of(posteriors_bytes(probabilities()[:, :5])), "posteriors", r"shape \(40, 5, 16\)"),
    "classes": (body_of(posteriors_bytes(probabilities()[:9])), "posteriors", r"shape \(9, 12, 16\)"),
    "nan": (body_of(posteriors_bytes(probabilities() * np.float32(np.nan))), "posteriors", "outside"),
    "negative": (body_of(posteriors_bytes(-probabilities())), "posteriors", "outside"),
    "json": (body_of(b"{'boxes': []}"), "vlfm", "its reply"),
    "list": (body_of(b"[1]"), "vlfm", "its reply"),
    "fields": (as_json(boxes=[]), "vlfm", "lists boxes"),
    "lengths": (as_json(boxes=[[0, 0, 1, 1]], logits=[], phrases=[]), "vlfm", "lists boxes"),
    "words": (body_of(b'[{"category": 5, "score": 1, "bbox": [0, 0, 1, 1]}]'), "coco", "list of annotations"),
    "bbox": (body_of(b'[{"category": "bed", "score": 1, "bbox": [0, "a", 1, 1]}]'), "coco", "list of annotations"),
    "certain": (body_of(b'[{"category": "bed", "score": 2, "bbox": [0, 0, 1, 1]}]'), "coco", "scores outside"),
    "mask": (
        body_of(b'[{"category": "bed", "score": 1, "segmentation": {"size": [2, 2], "counts": [4]}}]'),
        "coco",
        "2 x 2",
    ),
    "runs": (
        body_of(b'[{"category": "bed", "score": 1, "segmentation": {"size": [48, 64], "counts": [4]}}]'),
        "coco",
        "runs",
    ),
    "huge": (as_json(boxes=[[0, 0, 1, 10**400]], logits=[1], phrases=["chair"]), "vlfm", "lists boxes"),
    "score": (as_json(boxes=[[0, 0, 1, 1]], logits=[7], phrases=["chair"]), "vlfm", "scores outside"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_of_the_server_is_one_sentence_after_all_attempts(start: Start, fault: str) -> None:
    answer, form, words = FAULTS[fault]
    server = start(answer)
    timeout_s = 0.3 if fault in ("slow", "trickle", "500 without a text") else 10.0
    segmenter = asking(server.url, form=form, timeout_s=timeout_s, retries=1)
    with pytest.raises(AgentError, match=words) as error:
        segmenter.posteriors(view())
    assert "no valid reply in 2 attempts" in str(error.value)
    assert "\n" not in str(error.value)
    assert "\x1b" not in str(error.value)
    assert len(server.requests) == 2


def test_a_mask_of_another_size_is_refused(start: Start) -> None:
    def answer(handler: http.server.BaseHTTPRequestHandler, body: bytes) -> None:
        reply: dict[str, Any] = {"boxes": [[0, 0, 1, 1]], "logits": [0.9], "phrases": ["chair"]}
        if handler.path == "/mobile_sam":
            reply = {"cropped_mask": base64.b64encode(bytes(10)).decode()}
        send(handler, json.dumps(reply).encode())

    with pytest.raises(AgentError, match="mask of 10 pixels for a picture of 3072"):
        asking(start(answer).url, form="vlfm", retries=0).posteriors(view())


def test_no_server_is_one_sentence() -> None:
    with pytest.raises(AgentError, match=r"127.0.0.1:9/posteriors gave no valid reply in 1 attempt: .*refused"):
        asking("http://127.0.0.1:9", retries=0).posteriors(view())


def test_other_machines_are_asked_through_the_proxy_of_the_environment(
    start: Start, monkeypatch: pytest.MonkeyPatch
) -> None:
    proxy, local = (start(body_of(posteriors_bytes(probabilities()))) for _ in range(2))
    for name in ("http_proxy", "HTTP_PROXY"):
        monkeypatch.setenv(name, proxy.url)
    for name in ("no_proxy", "NO_PROXY"):
        monkeypatch.setenv(name, "inside.invalid")
    far = "http://detectors.invalid:8000"
    np.testing.assert_array_equal(asking(far, retries=0).posteriors(view()), probabilities())
    assert [path for path, _ in proxy.requests] == [f"{far}/posteriors"]
    for url in (local.url, local.url.replace("127.0.0.1", "localhost")):
        asking(url, retries=0).posteriors(view())
    with pytest.raises(AgentError, match="no valid reply"):
        asking("http://inside.invalid:8000", retries=0).posteriors(view())
    assert (len(proxy.requests), len(local.requests)) == (1, 2)


def test_a_fault_that_ends_is_repaired_by_the_next_attempt(start: Start) -> None:
    count = 0

    def answer(handler: http.server.BaseHTTPRequestHandler, body: bytes) -> None:
        nonlocal count
        count += 1
        send(handler, posteriors_bytes(probabilities()), 503 if count < 3 else 200)

    segmenter = asking(start(answer).url, retries=2)
    np.testing.assert_array_equal(segmenter.posteriors(view()), probabilities())


def test_kept_replies_need_no_server_and_only_valid_ones_are_kept(start: Start, tmp_path: Path) -> None:
    replies = [posteriors_bytes(probabilities(1)), b"garbage"]
    server = start(lambda handler, body: send(handler, replies.pop()))
    segmenter = asking(server.url, cache=tmp_path, retries=1)
    first = segmenter.posteriors(view(1))
    assert len(server.requests) == 2
    server.close = lambda: None  # type: ignore[method-assign]
    server._server.shutdown()
    server._server.server_close()
    again = asking(server.url, cache=tmp_path, retries=0)
    np.testing.assert_array_equal(again.posteriors(view(1)), first)
    with pytest.raises(AgentError, match="no valid reply"):
        again.posteriors(view(2))
    (kept,) = [file for file in tmp_path.rglob("*") if file.is_file()]
    kept.write_bytes(b"damaged")
    with pytest.raises(AgentError, match=r"cached reply .* cannot be used"):
        asking(server.url, cache=tmp_path).posteriors(view(1))


def test_a_reply_counts_where_it_cannot_be_kept(start: Start, tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    (tmp_path / "file").touch()
    server = start(lambda handler, body: send(handler, posteriors_bytes(probabilities())))
    segmenter = asking(server.url, cache=tmp_path / "file")
    np.testing.assert_array_equal(segmenter.posteriors(view()), probabilities())
    assert "The reply is not kept" in caplog.text


@pytest.mark.parametrize(
    "data",
    [
        b"x",
        view_bytes(view()["rgb"][:2], view()["depth"], CAMERA),
        view_bytes(view()["rgb"], view()["depth"].astype(np.float64), CAMERA),  # type: ignore[arg-type]
    ],
)
def test_other_bytes_are_no_view(data: bytes) -> None:
    with pytest.raises(ConfigError, match="not a view"):
        read_view(data)


def test_a_damaged_view_is_refused_or_read() -> None:
    data, rng = view_bytes(view()["rgb"], view()["depth"], CAMERA), np.random.default_rng(0)
    refused = 0
    for _ in range(300):
        damaged = bytearray(data)
        for place in rng.integers(0, len(data), 8):
            damaged[place] = rng.integers(256)
        try:
            read_view(bytes(damaged))
        except ConfigError:
            refused += 1
    assert refused > 200


def test_posteriors_may_have_any_whole_fraction_of_the_size() -> None:
    for rows, columns in ((48, 64), (12, 16), (3, 4)):
        flat = np.full((40, rows, columns), 0.025, np.float32)
        assert read_posteriors(posteriors_bytes(flat), shape=(48, 64)).shape == flat.shape


def test_the_words_of_the_goal_are_asked_for_and_name_the_objects(start: Start) -> None:
    def answer(handler: http.server.BaseHTTPRequestHandler, body: bytes) -> None:
        annotations = [
            {"category": "chair", "score": 0.9, "bbox": [0, 0, 32, 48]},
            {"category": "rocking chair", "score": 0.8, "bbox": [32, 0, 32, 48]},
        ]
        send(handler, json.dumps(annotations).encode())

    server, observation = start(answer), view()
    wished = WishedSegmenter(asking(server.url, form="coco"), CAMERA)
    wished.ask("the red rocking chair in the bedroom")
    target = wished.scores(observation, wished.category).target
    assert json.loads(server.requests[0][1])["words"][:2] == ["rocking chair", "chair"]
    np.testing.assert_allclose(target[:, 8:], 0.8)
    assert (target[:, :8] == 0.0).all()  # it is a chair, but not named as a rocking chair
    wished.ask("chair")
    np.testing.assert_allclose(wished.scores(observation, "chair").target[:, :8], 0.9)
    assert "rocking chair" not in json.loads(server.requests[1][1])["words"]
    closed = WishedSegmenter(asking(server.url, form="coco", words=False), CAMERA)
    closed.ask("rocking chair")
    assert (closed.scores(observation, "chair").target > 0.7).all()
    assert "rocking chair" not in json.loads(server.requests[2][1])["words"]


def test_a_general_word_means_all_that_a_detector_names_below_it(start: Start) -> None:
    server = start(as_json(annotations=[{"category": "couch", "score": 0.9, "bbox": [0, 0, 64, 48]}]))
    wished = WishedSegmenter(asking(server.url, form="coco"), CAMERA)
    wished.ask("something to sit on")
    assert (wished.scores(view(), wished.category).target >= 0.9).all()
    chairs = vocabulary().find("chair")
    assert chairs is not None
    server = start(as_json(annotations=[{"category": "chair", "score": 0.9, "bbox": [0, 0, 64, 48]}]))
    for name in sorted(chairs.names):  # a chair is not yet one of these
        narrow = WishedSegmenter(asking(server.url, form="coco"), CAMERA)
        narrow.ask(name)
        target = narrow.scores(view(), narrow.category).target
        assert (target > 0.8).all() if name == "chair" else (target < 0.1).all()


def test_a_calibration_changes_the_probabilities_as_the_one_of_a_network_does(start: Start, tmp_path: Path) -> None:
    server, file = start(body_of(posteriors_bytes(probabilities()))), tmp_path / "calibration.json"
    calibration = Calibration(torch.linspace(0.5, 1.5, 40), torch.linspace(-1.0, 1.0, 40))
    file.write_text(json.dumps(calibration.to_metadata()))
    expected = calibration.applied(torch.from_numpy(probabilities()).log()).softmax(dim=0).numpy()
    calibrated = asking(server.url, calibration=file).posteriors(view())
    np.testing.assert_allclose(calibrated, expected, atol=1e-3)  # the file has four decimals
    file.write_text(json.dumps({"scale": [1.0], "offset": [0.0]}))
    with pytest.raises(ConfigError, match="40 factors and offsets"):
        asking(server.url, calibration=file)


def test_the_samples_of_a_calibration_are_detections_with_what_they_show(start: Start) -> None:
    annotations = [
        {"category": "chair", "score": 0.8, "bbox": [8, 8, 16, 16]},
        {"category": "bed", "score": 0.6, "bbox": [40, 0, 20, 20]},
        {"category": "bed", "score": 0.2, "bbox": [0, 0, 9, 9]},  # below the threshold
        {"category": "sofa", "score": 0.7, "bbox": [0, 40, 4, 4]},
    ]
    channels = np.full((48, 64), MPCAT40_ID["wall"] - 1, np.int64)
    channels[14:18, 14:19] = MPCAT40_ID["stool"] - 1  # a quarter of the middle half of the first box
    channels[40:] = -1
    segmenter = asking(start(as_json(annotations=annotations)).url, form="coco")
    logits, truth = segmenter.samples(view(), channels)
    assert truth.tolist() == [MPCAT40_ID["wall"] - 1, MPCAT40_ID["stool"] - 1]  # by score; the third has no truth
    np.testing.assert_allclose(np.exp(logits).sum(axis=1), 1.0, atol=1e-5)
    assert np.exp(logits[0, MPCAT40_ID["bed"] - 1]) == pytest.approx(0.6)


def test_a_calibration_changes_detections_and_leaves_the_rest_unknown(start: Start, tmp_path: Path) -> None:
    server = start(as_json(annotations=[{"category": "bed", "score": 0.4, "bbox": [0, 0, 32, 48]}]))
    (file := tmp_path / "calibration.json").write_text(json.dumps({"scale": [3.0] * 40, "offset": [0.0] * 40}))
    posteriors = asking(server.url, form="coco", calibration=file).posteriors(view())
    assert (posteriors[MPCAT40_ID["bed"] - 1, :, :8] > 0.95).all()
    np.testing.assert_allclose(posteriors[:, :, 8:], 1 / 40)
