"""Serves the page: HTTP for the page and for finished runs, a websocket for the running episode.

The server sends only files of this package, and those of the folder of runs. It refuses a
request unless its `Host` is one of the allowed names (against DNS rebinding), and a websocket unless the page itself
opens it.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import re
import struct
from collections.abc import AsyncIterator, Awaitable, Callable, Mapping
from pathlib import Path

from starlette.applications import Starlette
from starlette.middleware import Middleware
from starlette.requests import Request
from starlette.responses import FileResponse, PlainTextResponse, Response, StreamingResponse
from starlette.routing import Route, WebSocketRoute
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from starlette.websockets import WebSocket, WebSocketDisconnect

from sim.app.web.answers import Json, as_ascii, in_thread
from sim.app.web.choices import Choices
from sim.app.web.controls import EpisodeRequest
from sim.app.web.driven import DrivenRuns
from sim.app.web.pictures import NAMES
from sim.app.web.runs import Runs
from sim.app.web.session import Frame, Session
from sim.core.errors import ConfigError, ObjectNavError
from sim.core.reading import parse_json, printable

PAGE = Path(__file__).parent / "page"
PAGE_FILES: Mapping[str, tuple[str, str]] = {
    "/": ("index.html", "text/html"),
    "/page.css": ("page.css", "text/css"),
    "/page.js": ("page.js", "text/javascript"),
    "/icon.svg": ("icon.svg", "image/svg+xml"),
}
"""Address, file and type of everything that the page consists of."""
_log = logging.getLogger(__name__)
MakeRequest = Callable[[Mapping[str, object]], EpisodeRequest]
"""Returns the request that a message of the page describes."""
MAX_CLIENTS = 16
MAX_MESSAGE_BYTES = 4096
_POLICY = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; media-src 'self'; "
_POLICY += "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
_REPORT_POLICY = "sandbox allow-scripts allow-popups; frame-ancestors 'none'"
"""A report has its script inside the page; without an origin of its own it cannot reach this server."""


class Client:
    """One connected page: the pictures that it shows, and the numbers of the last state and frame that it got."""

    def __init__(self) -> None:
        self.names: frozenset[str] = frozenset(("camera", "chase"))
        self.news = asyncio.Event()
        self.state_number = self.frame_number = 0


class Hub:
    """Sends the newest state and frame of the session to all clients (`Display`); slow clients miss frames.

    Args:
        driven: records the episodes that a person drives.
    """

    def __init__(self, driven: DrivenRuns) -> None:
        self.clients: set[Client] = set()
        self.session = Session(self, driven)
        self._loop: asyncio.AbstractEventLoop | None = None
        self._state: Mapping[str, object] = {"phase": "idle", "message": "Choose a house, a goal and an agent."}
        self._frame: Frame | None = None
        self._state_number = self._frame_number = 1
        self._wanted: frozenset[str] = frozenset()

    def open(self) -> None:
        """Starts the session; must be called in the loop that serves the clients."""
        self._loop = asyncio.get_running_loop()
        self.session.start()

    def wanted(self) -> frozenset[str]:
        """Returns the names of the pictures that at least one client shows."""
        return self._wanted

    def show(self, frame: Frame) -> None:
        """Receives the newest frame from the thread that simulates."""
        self._in_loop(lambda: self._keep(frame=frame))

    def show_state(self, state: Mapping[str, object]) -> None:
        """Receives the newest state from the thread that simulates."""
        self._in_loop(lambda: self._keep(state=state))

    def changed(self) -> None:
        """Sends the state to all clients again, after a command."""
        self._keep()

    def update_wanted(self) -> None:
        """Computes which pictures are shown by any client; requests new ones to be drawn."""
        before = self._wanted
        self._wanted = frozenset().union(*(client.names for client in self.clients))
        if self._wanted - before:
            self.session.controls.redraw()

    def state(self) -> dict[str, object]:
        """Returns the state of the episode and of the controls."""
        controls = self.session.controls
        names = ("driver", "paused", "per_s", "hints")
        live = {name: getattr(controls, name) for name in names}
        return {"kind": "state", **self._state, **live, "clients": len(self.clients)}

    async def serve(self, client: Client, socket: WebSocket) -> None:
        """Sends each new state and frame to a client until it disconnects."""
        while True:
            if client.state_number != self._state_number:
                client.state_number = self._state_number
                await socket.send_text(as_ascii(self.state()))
            if client.frame_number != self._frame_number and self._frame is not None:
                client.frame_number = self._frame_number
                await socket.send_bytes(packed(self._frame, client.names))
            await client.news.wait()
            client.news.clear()

    def _keep(self, *, frame: Frame | None = None, state: Mapping[str, object] | None = None) -> None:
        if frame is not None:
            self._frame = frame
            self._frame_number += 1
        else:
            self._state = state or self._state
            if self._state["phase"] == "loading":
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
    text = as_ascii(header).encode("ascii")
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
        foreign, origin = self._is_foreign(scope), _only(scope, b"origin")
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
                present = {name for name, _ in message["headers"]}
                message["headers"] += [pair for pair in _HEADERS if pair[0] not in present]
            await send(message)

        await self._app(scope, receive, send_with_headers)

    def _is_foreign(self, scope: Scope) -> bool:
        """Returns whether a request names another host, comes from another page, or repeats one of the two headers."""
        host, origin = _only(scope, b"host"), _only(scope, b"origin")
        if host is None or origin is _REPEATED or _name_of(host) not in self._hosts:
            return True
        return origin is not None and origin.lower() not in (f"http://{host}".lower(), f"https://{host}".lower())


_HEADERS = [
    (b"content-security-policy", _POLICY.encode()),
    (b"x-content-type-options", b"nosniff"),
    (b"referrer-policy", b"no-referrer"),
    (b"cross-origin-resource-policy", b"same-origin"),
    (b"cache-control", b"no-cache"),
]


_REPEATED = "repeated"
_HOST = re.compile(r"(?:\[(?P<address>[0-9A-Fa-f:.]+)\]|(?P<name>[\w.-]+))(?::\d{1,5})?", re.ASCII)


def _only(scope: Scope, name: bytes) -> str | None:
    """Returns the value of a header; None if it is missing, `_REPEATED` if there are several."""
    values = [value for key, value in scope["headers"] if key.lower() == name]
    if len(values) > 1:
        return _REPEATED
    return values[0].decode("latin-1") if values else None


def _name_of(host: str) -> str:
    """Returns the name in a Host header, without the port; "" if the header has another form."""
    match = _HOST.fullmatch(host)
    return "" if match is None else (match["address"] or match["name"]).lower()


def make_app(hub: Hub, choices: Choices, runs: Runs, *, hosts: frozenset[str]) -> Starlette:
    """Returns the application.

    Args:
        hub: the hub of the session; it is opened and closed with the application.
        choices: the parts that users can choose.
        runs: finished runs.
        hosts: names under which the server may be addressed.
    """

    def make_request(message: Mapping[str, object]) -> EpisodeRequest:
        if message.get("do") != "again":
            return choices.request(message)
        run, result = runs.result(str(message.get("run")), str(message.get("episode")))
        return choices.again(run.config, result, "person" if message.get("driver") == "person" else "agent")

    @contextlib.asynccontextmanager
    async def lifespan(app: Starlette) -> AsyncIterator[None]:
        hub.open()
        yield
        hub.session.close()

    async def live(socket: WebSocket) -> None:
        await _live(hub, make_request, socket)

    def run_of(request: Request) -> str:
        return request.path_params["run"]

    def asked(request: Request, *names: str) -> list[str]:
        return [request.query_params.get(name, "") for name in names]

    def packed_run(request: Request) -> Response:
        run = run_of(request)
        name = re.sub(r"[^\w.-]", "_", run, flags=re.ASCII)
        headers = {"content-disposition": f'attachment; filename="{name}.zip"'}
        return StreamingResponse(runs.packed(run), headers=headers, media_type="application/zip")

    def delete_run(request: Request) -> Response:
        if request.headers.get("origin") is None:  # a page of this server always sends it
            return PlainTextResponse("Only the page may delete a run.", 403)
        runs.delete(run_of(request))
        return Response(status_code=204)

    def video(request: Request) -> Response:
        return FileResponse(runs.video(run_of(request), *asked(request, "episode")), media_type="video/mp4")

    def report(request: Request) -> Response:
        headers = {"content-security-policy": _REPORT_POLICY}
        return FileResponse(runs.report(run_of(request)), headers=headers, media_type="text/html")

    def linked(request: Request) -> Response:
        run, kind, file = (request.path_params[part] for part in ("run", "kind", "file"))
        headers = {"cross-origin-resource-policy": "cross-origin"}  # a sandboxed report has another origin
        return FileResponse(runs.linked(run, kind, file), headers=headers)

    routes = [Route(address, _page_file(*about)) for address, about in PAGE_FILES.items()]
    answers: dict[str, Callable[[Request], Response]] = {
        "/api/choices": lambda request: Json(choices.as_json()),
        "/api/runs": lambda request: Json(runs.as_json()),
        "/api/runs/{run}": lambda request: Json(runs.episodes(run_of(request))),
        "/api/house": lambda request: Json(choices.house_from_above(*asked(request, "split", "house"))),
        "/api/comparison": lambda request: Json(runs.comparison(*asked(request, "first", "second"))),
        "/runs/{run}/run.zip": packed_run,
        "/runs/{run}/video": video,
        "/runs/{run}/report.html": report,
        "/runs/{run}/{kind}/{file}": linked,
    }
    routes += [Route(address, in_thread(answer)) for address, answer in answers.items()]
    routes.append(Route("/api/runs/{run}", in_thread(delete_run), methods=["DELETE"]))
    return Starlette(
        routes=[*routes, WebSocketRoute("/live", live)],
        middleware=[Middleware(OnlyFromHere, hosts=hosts)],
        lifespan=lifespan,
    )


def _page_file(name: str, media_type: str) -> Callable[[Request], Awaitable[Response]]:
    async def answer(request: Request) -> Response:
        return FileResponse(PAGE / name, media_type=media_type)

    return answer


async def _live(hub: Hub, make_request: MakeRequest, socket: WebSocket) -> None:
    """Serves one websocket."""
    if len(hub.clients) >= MAX_CLIENTS:
        await socket.close(1013, "There are too many clients.")
        return
    await socket.accept()
    client = Client()
    hub.clients.add(client)
    hub.update_wanted()
    hub.changed()
    tasks = [
        asyncio.create_task(work) for work in (hub.serve(client, socket), _obey(hub, make_request, client, socket))
    ]
    try:
        await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
    finally:
        for task in tasks:
            task.cancel()
        # WebSocketDisconnect and RuntimeError: the client disconnected while something was received or sent.
        for ended in await asyncio.gather(*tasks, return_exceptions=True):
            if isinstance(ended, Exception) and not isinstance(ended, (WebSocketDisconnect, RuntimeError)):
                _log.error("A connection failed.", exc_info=ended)
        hub.clients.discard(client)
        hub.update_wanted()
        hub.changed()


async def _obey(hub: Hub, make_request: MakeRequest, client: Client, socket: WebSocket) -> None:
    """Carries out the messages of a client until it disconnects."""
    while (message := await socket.receive())["type"] == "websocket.receive":
        answer = await asyncio.to_thread(_carry_out, hub, make_request, client, message.get("text"))
        hub.update_wanted()
        if answer is None:
            hub.changed()
        else:
            await socket.send_text(as_ascii({"kind": "refused", "message": printable(answer)}))


def _carry_out(hub: Hub, make_request: MakeRequest, client: Client, text: str | None) -> str | None:
    """Carries out one message of a page; returns the reason if it is refused, else None."""
    try:
        if text is None:
            raise ConfigError("A message must be text.")
        message = parse_json(text, dict[str, object], where="The message")
        if message.get("do") == "show":
            pictures = message.get("pictures")
            before = client.names
            client.names = frozenset(name for name in NAMES if isinstance(pictures, list) and name in pictures)
            if client.names - before:
                client.frame_number = 0  # the present frame may have them already
        elif message.get("do") in ("start", "again"):
            hub.session.controls.ask_for(make_request(message))
        else:
            hub.session.controls.obey(message)
    except ObjectNavError as error:
        return str(error)
    return None
