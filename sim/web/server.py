"""The server of the page: HTTP for the page and for finished runs, a websocket for the running episode.

It serves only files of this package, and reports, pictures and videos of the folder of runs. A request is refused
unless its `Host` is one of the allowed names (DNS rebinding), and a websocket unless it comes from the page itself.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import struct
from collections.abc import AsyncIterator, Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any
from urllib.parse import urlsplit

from starlette.applications import Starlette
from starlette.middleware import Middleware
from starlette.requests import Request
from starlette.responses import FileResponse, JSONResponse, PlainTextResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from starlette.websockets import WebSocket, WebSocketDisconnect

from sim.errors import ConfigError
from sim.web.catalogue import Choices, Runs
from sim.web.pictures import NAMES
from sim.web.session import Frame, Session

PAGE = Path(__file__).parent / "page"
PAGE_FILES: Mapping[str, tuple[str, str]] = {
    "/": ("index.html", "text/html"),
    "/page.css": ("page.css", "text/css"),
    "/page.js": ("page.js", "text/javascript"),
    "/icon.svg": ("icon.svg", "image/svg+xml"),
}
"""Address, file and type of everything that the page consists of."""
MAX_CLIENTS = 16
MAX_MESSAGE_BYTES = 4096
_POLICY = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; media-src 'self'; "
_POLICY += "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
_REPORT_POLICY = "sandbox allow-scripts allow-popups; frame-ancestors 'none'"
"""A report has its script inside the page; without an origin of its own it cannot reach this server."""


class Client:
    """One connected page: what it has got of the newest state and frame."""

    def __init__(self) -> None:
        self.names: frozenset[str] = frozenset(("camera", "chase"))
        self.news = asyncio.Event()
        self.state_number = self.frame_number = 0


class Hub:
    """Hands the newest state and frame of the session to all clients; slow ones miss frames (`Audience`)."""

    def __init__(self, weights: Path | None = None, config: tuple[str, ...] = ()) -> None:
        """Makes a session whose network has these weights; the shipped ones when None. `config`: see `Session`."""
        self.clients: set[Client] = set()
        self.session = Session(self, weights, config)
        self._loop: asyncio.AbstractEventLoop | None = None
        self._told: Mapping[str, Any] = {"phase": "idle", "message": "Choose a house, a goal and an agent."}
        self._frame: Frame | None = None
        self._state_number = self._frame_number = 1
        self._wanted: frozenset[str] = frozenset()

    def open(self) -> None:
        """Starts the session; must be called in the loop that serves the clients."""
        self._loop = asyncio.get_running_loop()
        self.session.start()

    def wanted(self) -> frozenset[str]:
        """Returns the names of the pictures that some client shows."""
        return self._wanted

    def show(self, frame: Frame) -> None:
        """Takes the newest frame from the simulating thread."""
        self._in_loop(lambda: self._keep(frame=frame))

    def tell(self, state: Mapping[str, Any]) -> None:
        """Takes the newest state from the simulating thread."""
        self._in_loop(lambda: self._keep(told=state))

    def changed(self) -> None:
        """Sends the state to all clients again, after a command."""
        self._keep()

    def count_wishes(self) -> None:
        """Computes which pictures are shown anywhere; draws them if they are new."""
        before = self._wanted
        self._wanted = frozenset().union(*(client.names for client in self.clients))
        if self._wanted - before:
            self.session.controls.redraw()

    def state(self) -> dict[str, Any]:
        """Returns the state of the episode and of the controls."""
        controls = self.session.controls
        live = {"driver": controls.driver, "paused": controls.paused, "per_s": controls.per_s}
        return {"kind": "state", **self._told, **live, "clients": len(self.clients)}

    async def serve(self, client: Client, socket: WebSocket) -> None:
        """Sends a client what is new, until it is gone."""
        while True:
            if client.state_number != self._state_number:
                client.state_number = self._state_number
                await socket.send_json(self.state())
            if client.frame_number != self._frame_number and self._frame is not None:
                client.frame_number = self._frame_number
                await socket.send_bytes(packed(self._frame, client.names))
            await client.news.wait()
            client.news.clear()

    def _keep(self, *, frame: Frame | None = None, told: Mapping[str, Any] | None = None) -> None:
        if frame is not None:
            self._frame = frame
            self._frame_number += 1
        else:
            self._told = told or self._told
            if self._told["phase"] == "loading":
                self._frame = None  # that of the last episode
            self._state_number += 1
        for client in self.clients:
            client.news.set()

    def _in_loop(self, action: Callable[[], None]) -> None:
        assert self._loop is not None
        with contextlib.suppress(RuntimeError):  # the loop was closed: the server stops
            self._loop.call_soon_threadsafe(action)


def packed(frame: Frame, names: frozenset[str]) -> bytes:
    """Returns a frame as bytes: the length of the header (uint32, big-endian), the header as JSON, the pictures."""
    sent = {name: picture for name, picture in frame.pictures.items() if name in names}
    header = {**frame.facts, "pictures": [[name, len(picture)] for name, picture in sent.items()]}
    text = json.dumps(header).encode()
    return struct.pack(">I", len(text)) + text + b"".join(sent.values())


class OnlyFromHere:
    """ASGI middleware that refuses hosts that are not allowed and websockets of other pages, and adds headers."""

    def __init__(self, app: ASGIApp, hosts: frozenset[str]) -> None:
        self._app, self._hosts = app, hosts

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Passes a request on, or refuses it."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        headers = {name.decode("latin-1"): value.decode("latin-1") for name, value in scope["headers"]}
        host, origin = headers.get("host", ""), headers.get("origin")
        foreign = _name_of(host) not in self._hosts or (origin is not None and urlsplit(origin).netloc != host)
        if scope["type"] == "websocket":
            if foreign or origin is None:
                await send({"type": "websocket.close", "code": 1008})
                return
            await self._app(scope, receive, send)
            return
        if foreign:
            await PlainTextResponse("This host or origin is not allowed here.", 403)(scope, receive, send)
            return

        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                given = {name for name, _ in message["headers"]}
                message["headers"] += [pair for pair in _HEADERS if pair[0] not in given]
            await send(message)

        await self._app(scope, receive, send_with_headers)


_HEADERS = [
    (b"content-security-policy", _POLICY.encode()),
    (b"x-content-type-options", b"nosniff"),
    (b"referrer-policy", b"no-referrer"),
    (b"cross-origin-resource-policy", b"same-origin"),
    (b"cache-control", b"no-cache"),
]


def _name_of(host: str) -> str:
    """Returns the name in a Host header, without the port."""
    return urlsplit(f"//{host}").hostname or ""


def make_app(
    hub: Hub, runs: Runs, *, hosts: frozenset[str], segmentations: Mapping[str, str] = MappingProxyType({})
) -> Starlette:
    """Returns the application.

    Args:
        hub: of the session; it is opened and closed with the application.
        runs: finished runs.
        hosts: names under which the server may be addressed.
        segmentations: names and descriptions of those that can be chosen in addition to the shipped ones.
    """
    choices = Choices(segmentations)

    @contextlib.asynccontextmanager
    async def lifespan(app: Starlette) -> AsyncIterator[None]:
        hub.open()
        yield
        hub.session.close()

    async def live(socket: WebSocket) -> None:
        await _live(hub, choices, socket)

    async def offered(request: Request) -> Response:
        return JSONResponse(choices.as_json())

    async def all_runs(request: Request) -> Response:
        return JSONResponse(await asyncio.to_thread(runs.as_json))

    async def one_run(request: Request) -> Response:
        return await _or_404(lambda: JSONResponse(runs.episodes(request.path_params["run"])))

    async def video(request: Request) -> Response:
        run, episode = request.path_params["run"], request.query_params.get("episode", "")
        return await _or_404(lambda: FileResponse(runs.video(run, episode), media_type="video/mp4"))

    async def report(request: Request) -> Response:
        headers = {"content-security-policy": _REPORT_POLICY}
        return await _or_404(
            lambda: FileResponse(runs.report(request.path_params["run"]), media_type="text/html", headers=headers)
        )

    async def linked(request: Request) -> Response:
        asked = (request.path_params[part] for part in ("run", "kind", "file"))
        headers = {"cross-origin-resource-policy": "cross-origin"}  # a sandboxed report has another origin
        return await _or_404(lambda: FileResponse(runs.linked(*asked), headers=headers))

    routes = [Route(address, _page_file(*about)) for address, about in PAGE_FILES.items()]
    routes += [
        Route("/api/choices", offered),
        Route("/api/runs", all_runs),
        Route("/api/runs/{run}", one_run),
        Route("/runs/{run}/video", video),
        Route("/runs/{run}/report.html", report),
        Route("/runs/{run}/{kind}/{file}", linked),
    ]
    return Starlette(
        routes=[*routes, WebSocketRoute("/live", live)],
        middleware=[Middleware(OnlyFromHere, hosts=hosts)],
        lifespan=lifespan,
    )


async def _or_404(answer: Callable[[], Response]) -> Response:
    try:
        return await asyncio.to_thread(answer)
    except ConfigError as error:
        return PlainTextResponse(str(error), 404)


def _page_file(name: str, media_type: str) -> Callable[[Request], Any]:
    async def answer(request: Request) -> Response:
        return FileResponse(PAGE / name, media_type=media_type)

    return answer


async def _live(hub: Hub, choices: Choices, socket: WebSocket) -> None:
    """Serves one websocket."""
    if len(hub.clients) >= MAX_CLIENTS:
        await socket.close(1013, "There are too many clients.")
        return
    await socket.accept()
    client = Client()
    hub.clients.add(client)
    hub.count_wishes()
    hub.changed()
    sending = asyncio.create_task(hub.serve(client, socket))
    try:
        while True:
            answer = _carry_out(hub, choices, client, await socket.receive_text())
            if answer is not None:
                await socket.send_json({"kind": "refused", "message": answer})
    except (WebSocketDisconnect, RuntimeError):  # RuntimeError: it went while something was sent
        pass
    finally:
        sending.cancel()
        hub.clients.discard(client)
        hub.count_wishes()
        hub.changed()


def _carry_out(hub: Hub, choices: Choices, client: Client, text: str) -> str | None:
    """Carries out one message of a page; returns why it was refused, None if it was not."""
    try:
        message = json.loads(text)
        if not isinstance(message, dict):
            raise ConfigError("A message must be a JSON object.")
        if message.get("do") == "show":
            wanted = message.get("pictures")
            client.names = frozenset(name for name in NAMES if isinstance(wanted, list) and name in wanted)
            hub.count_wishes()
        elif message.get("do") == "start":
            hub.session.controls.ask_for(choices.wish(message))
        else:
            hub.session.controls.obey(message)
            hub.changed()
    except (ValueError, TypeError) as error:  # ConfigError is a ValueError
        return str(error)
    return None
