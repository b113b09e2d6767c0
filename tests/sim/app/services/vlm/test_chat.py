"""Questions to a chat endpoint: what is sent, which replies count, and the faults of a server."""

from __future__ import annotations

import base64
import http.server
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sim.app.services.vlm.agent import StopReply, place_reply
from sim.app.services.vlm.chat import Chat, ChatConfig
from sim.core.errors import AgentError, ConfigError
from sim.core.pictures import decode_picture
from tests.helpers.chat_server import completion, scripted
from tests.helpers.services import Handler, Start, body_of, closed, cut, late, send, trickled

PICTURE = np.full((48, 64, 3), (200, 30, 10), np.uint8)
RIGHT = completion('{"choice": 2, "reason": "Beds are in bedrooms."}')
PLACE = place_reply(3)


def chat_with(url: str, **others: Any) -> Chat:
    return Chat(ChatConfig(url=f"{url}/v1", model="script", **others), "You guide a robot.")


def test_a_question_has_the_form_of_openai_and_a_reply_is_an_object(
    start: Start, monkeypatch: pytest.MonkeyPatch
) -> None:
    keys: list[str | None] = []

    def answer(handler: http.server.BaseHTTPRequestHandler, body: bytes) -> None:
        keys.append(handler.headers["Authorization"])
        send(handler, RIGHT)

    server = start(answer)
    monkeypatch.setenv("MY_KEY", "secret")
    chat = chat_with(server.url, key_variable="MY_KEY", input_price=2.0, output_price=10.0)
    reply = chat.ask("Where to?", [PICTURE], PLACE)
    assert (reply.choice, reply.reason) == (2, "Beds are in bedrooms.")
    path, body = server.requests[0]
    question = json.loads(body)
    assert path == "/v1/chat/completions"
    assert (question["model"], question["temperature"], question["max_tokens"]) == ("script", 0.0, 400)
    assert question["messages"][0] == {"role": "system", "content": "You guide a robot."}
    text, picture = question["messages"][1]["content"]
    assert text == {"type": "text", "text": "Where to?"}
    head, data = picture["image_url"]["url"].split(",")
    assert head == "data:image/jpeg;base64"
    sent = decode_picture(base64.b64decode(data), where="the picture")[..., ::-1]
    np.testing.assert_allclose(sent, PICTURE, atol=4)
    assert keys == ["Bearer secret"]
    assert b"secret" not in body
    assert (chat.questions, chat.failed, chat.prompt_tokens, chat.completion_tokens) == (1, 0, 900, 20)
    assert chat.cost == pytest.approx((900 * 2 + 20 * 10) / 1e6)
    chat.begin()
    assert (chat.questions, chat.prompt_tokens, chat.wait_s) == (0, 0, 0.0)


def test_a_redirection_does_not_carry_the_key_to_another_host(start: Start, monkeypatch: pytest.MonkeyPatch) -> None:
    keys: list[str | None] = []

    def elsewhere(handler: http.server.BaseHTTPRequestHandler, body: bytes) -> None:
        keys.append(handler.headers["Authorization"])
        send(handler, b"nothing here", 404)

    def redirected(handler: http.server.BaseHTTPRequestHandler, body: bytes) -> None:
        handler.send_response(302)
        handler.send_header("Location", other.url)
        handler.send_header("Content-Length", "0")
        handler.end_headers()

    other = start(elsewhere)
    monkeypatch.setenv("MY_KEY", "secret")
    with pytest.raises(AgentError, match="status 404"):
        chat_with(start(redirected).url, key_variable="MY_KEY", retries=0).ask("Where to?", (), PLACE)
    assert keys == [None]


def test_fields_that_a_server_does_not_know_can_be_left_out(start: Start) -> None:
    server = start(body_of(RIGHT))
    chat_with(server.url, temperature=None, max_tokens=None).ask("Where to?", (), PLACE)
    assert set(json.loads(server.requests[0][1])) == {"model", "messages"}


@pytest.mark.parametrize(
    "text",
    [
        '{"choice": 2}',
        '```json\n{"choice": 2, "reason": "x"}\n```',
        '```\n{"choice": 2}\n```',
        '<think>The door {"choice": 1} is\nnear.</think>\n\n{"choice": 2}',
    ],
)
def test_an_object_may_stand_in_a_fence_or_after_thoughts(start: Start, text: str) -> None:
    assert chat_with(start(body_of(completion(text))).url).ask("Where to?", (), PLACE).choice == 2


def texts(*contents: Any, **others: Any) -> Handler:
    return body_of(completion(contents[0], **others))


FAULTS: dict[str, tuple[Handler, str]] = {
    "slow": (late(RIGHT), "no reply in 0.3 s"),
    "trickle": (trickled(RIGHT), "longer than 0.3 s"),
    "closed": (closed, "closed connection|reset"),
    "half": (cut(RIGHT), r"ended after \d+ of \d+ bytes"),
    "empty": (body_of(b""), "its reply is empty"),
    "garbage": (body_of(b"\x00\xff garbage"), "its reply is not JSON"),
    "500": (body_of(b"<h1>CUDA out of memory\x1b[2J</h1>", 500), "status 500: <h1>CUDA out of memory"),
    "429": (body_of(b'{"error": {"message": "Rate limit"}}', 429), "status 429.*Rate limit"),
    "another size of pictures": (body_of(b'{"error": "image must be 448 x 448"}', 400), "status 400.*448 x 448"),
    "no such model": (body_of(b'{"error": "model not found"}', 404), "status 404.*model not found"),
    "an error with status 200": (body_of(b'{"error": "overloaded"}'), "choices"),
    "no choices": (body_of(b'{"choices": []}'), "choices"),
    "no text": (texts(None), "content"),
    "parts in place of text": (texts([{"type": "text", "text": '{"choice": 2}'}]), "content"),
    "prose": (texts("I would go to place 2."), "the model's text 'I would go to place 2.' is not JSON"),
    "prose around JSON": (texts('Sure! {"choice": 2}'), "is not JSON"),
    "code": (texts("```python\nimport os\nos.system('rm -rf /')\n```"), "is not JSON"),
    "code in a field": (texts('{"choice": "__import__(\'os\').abort()"}'), "choice"),
    "wrong JSON": (texts("{'choice': 2}"), "is not JSON"),
    "half of the JSON": (texts('{"choice": 2, "reas'), "is not JSON"),
    "cut off": (
        body_of(json.dumps({"choices": [{"message": {"content": "{"}, "finish_reason": "length"}]}).encode()),
        "cut off at max_tokens",
    ),
    "too large a number": (texts('{"choice": 4}'), "choice"),
    "zero": (texts('{"choice": 0}'), "choice"),
    "a fraction": (texts('{"choice": 1.5}'), "choice"),
    "true": (texts('{"choice": true}'), "choice"),
    "a list": (texts('[{"choice": 2}]'), "object"),
    "another object": (texts('{"found": true}'), "found|choice"),
    "one more field": (texts('{"choice": 2, "action": "MOVE_FORWARD"}'), "action"),
    "endless": (texts("x" * 30_000), "content"),
    "deep": (texts('{"choice": 2, "reason": ' + "[" * 5000), "the model's text"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_is_one_sentence_and_nothing_is_kept(start: Start, tmp_path: Path, fault: str) -> None:
    answer, words = FAULTS[fault]
    server = start(answer)
    timeout_s = 0.3 if fault in ("slow", "trickle") else 10.0
    chat = chat_with(server.url, timeout_s=timeout_s, retries=1, cache=tmp_path)
    with pytest.raises(AgentError, match=words) as error:
        chat.ask("Where to?", [PICTURE], PLACE)
    assert "no valid reply in 2 attempts" in str(error.value)
    assert "\n" not in str(error.value)
    assert "\x1b" not in str(error.value)
    assert len(str(error.value)) < 600
    assert len(server.requests) == 2
    assert (chat.questions, chat.failed) == (0, 1)
    assert list(tmp_path.rglob("*")) == []


def test_a_reply_is_repaired_by_the_next_attempt_and_kept_with_its_tokens(start: Start, tmp_path: Path) -> None:
    server = start(scripted(['{"found": "yes"}', '{"found": true}']))
    chat = chat_with(server.url, cache=tmp_path)
    assert chat.ask("Is it?", [PICTURE], StopReply).found
    assert (chat.questions, chat.failed, chat.prompt_tokens) == (1, 0, 900)
    again = chat_with(server.url, cache=tmp_path)
    assert again.ask("Is it?", [PICTURE], StopReply).found
    assert (again.questions, again.prompt_tokens) == (1, 900)
    assert len(server.requests) == 2  # none for the second


@pytest.mark.parametrize("make", [lambda: ChatConfig(url="localhost"), lambda: ChatConfig(timeout_s=0.0)])
def test_wrong_settings_are_refused(make: Callable[[], ChatConfig]) -> None:
    with pytest.raises(ConfigError, match="ChatConfig"):
        make()
