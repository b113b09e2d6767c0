"""The server of the page as an ASGI application, without a network: headers and ranges of files."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("starlette", reason="no starlette: pip install -e '.[web]'")

from sim.app.web.driven import DrivenRuns
from sim.app.web.server import Client, Hub, OnlyFromHere, _carry_out

HOSTS = frozenset(("127.0.0.1", "localhost", "::1"))


def answer_to(
    app: Any, headers: list[tuple[bytes, bytes]], kind: str = "http"
) -> tuple[int, dict[bytes, bytes], bytes]:
    """Returns status, headers and body; for a websocket that is let through the status is 101."""
    sent: list[Any] = []

    async def send(message: Any) -> None:
        sent.append(message)

    async def receive() -> Any:
        return {"type": f"{kind}.connect"}

    scope = {"type": kind, "method": "GET", "path": "/", "headers": headers}
    asyncio.run(app(scope, receive, send))
    if sent[0]["type"] == "websocket.close":
        return 403, {}, b""
    return sent[0]["status"], dict(sent[0]["headers"]), b"".join(message.get("body", b"") for message in sent[1:])


async def let_through(scope: Any, receive: Any, send: Any) -> None:
    await send({"type": "http.response.start", "status": 101 if scope["type"] == "websocket" else 200, "headers": []})


def status(*headers: tuple[bytes, bytes], kind: str = "http") -> int:
    return answer_to(OnlyFromHere(let_through, HOSTS), list(headers), kind)[0]


@pytest.mark.parametrize("host", [b"127.0.0.1", b"127.0.0.1:8008", b"LOCALHOST:1", b"[::1]", b"[::1]:8008"])
def test_an_allowed_host_is_let_through_with_its_own_origin_only(host: bytes) -> None:
    assert status((b"host", host)) == 200
    assert status((b"host", host), (b"origin", b"http://" + host)) == 200
    assert status((b"host", host), (b"origin", b"https://" + host), kind="websocket") == 101
    assert status((b"host", host), kind="websocket") == 403
    for origin in (
        b"",
        b"null",
        b"[",
        b"http://[",
        b"http://" + host + b"/",
        b"ftp://" + host,
        b"http://x@" + host,
        b"\xff",
    ):
        assert status((b"host", host), (b"origin", origin)) == 403
        assert status((b"host", host), (b"origin", origin), kind="websocket") == 403


@pytest.mark.parametrize(
    "host",
    [b"", b"[", b"]", b"[::1", b"::1]", b"[]", b"[v1.x]", b"[::1]x", b"x@127.0.0.1", b"127.0.0.1:x", b"127.0.0.1/",
     b"\xff", b"127.0.0.1 x", b"rebound.example", b"127.0.0.1:" + b"9" * 400, b"\xc2\xb2", b"localhost.",
     b"." * 60_000],
)  # fmt: skip
def test_a_host_of_another_form_or_name_is_refused(host: bytes) -> None:
    assert status((b"host", host)) == 403
    assert status((b"host", host), (b"origin", b"http://" + host), kind="websocket") == 403


def test_headers_that_are_missing_or_repeated_are_refused() -> None:
    host = (b"host", b"127.0.0.1")
    assert status() == 403
    assert status(host, host) == 403
    assert status(host, (b"origin", b"http://127.0.0.1"), (b"origin", b"http://127.0.0.1")) == 403


def test_a_page_that_shows_another_picture_gets_the_present_frame_again(tmp_path: Path) -> None:
    hub, page = Hub(DrivenRuns(tmp_path)), Client()

    def tell(text: str) -> int:
        page.frame_number = 7
        assert _carry_out(hub, lambda message: None, page, text) is None  # type: ignore[arg-type]
        return page.frame_number

    assert tell('{"do": "show", "pictures": ["camera"]}') == 7
    assert tell('{"do": "show", "pictures": ["camera", "map"]}') == 0
    assert tell('{"do": "show", "pictures": ["camera", "map"]}') == 7
