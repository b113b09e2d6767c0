"""Servers whose answers a test states, and their faults."""

from __future__ import annotations

import contextlib
import http.server
import threading
import time
from collections.abc import Callable

Handler = Callable[[http.server.BaseHTTPRequestHandler, bytes], None]


class Server:
    """A server whose answer each test states."""

    def __init__(self, answer: Handler, port: int = 0) -> None:
        self.requests: list[tuple[str, bytes]] = []
        owner = self

        class OneHandler(http.server.BaseHTTPRequestHandler):
            def do_POST(self) -> None:
                body = self.rfile.read(int(self.headers["content-length"] or 0))
                owner.requests.append((self.path, body))
                answer(self, body)

            do_GET = do_POST  # after a redirection

            def log_message(self, format: str, *args: object) -> None:
                pass

        self._server = http.server.ThreadingHTTPServer(("127.0.0.1", port), OneHandler)
        self._server.daemon_threads = True
        threading.Thread(target=self._server.serve_forever, daemon=True).start()
        self.url = f"http://127.0.0.1:{self._server.server_port}"

    def close(self) -> None:
        self._server.shutdown()
        self._server.server_close()


Start = Callable[[Handler], Server]


def send(handler: http.server.BaseHTTPRequestHandler, data: bytes, status: int = 200) -> None:
    _begin(handler, data, status)
    handler.wfile.write(data)


def body_of(data: bytes, status: int = 200) -> Handler:
    """Always answers with this body."""
    return lambda handler, body: send(handler, data, status)


def closed(handler: http.server.BaseHTTPRequestHandler, body: bytes) -> None:
    handler.close_connection = True
    handler.connection.close()


def late(data: bytes) -> Handler:
    """Answers after 0.6 s."""

    def answer(handler: http.server.BaseHTTPRequestHandler, body: bytes) -> None:
        time.sleep(0.6)
        send(handler, data)

    return answer


def trickled(data: bytes) -> Handler:
    """Sends a byte each 0.1 s, until the client leaves."""

    def answer(handler: http.server.BaseHTTPRequestHandler, body: bytes) -> None:
        _begin(handler, data)
        with contextlib.suppress(ConnectionError):
            for first in range(8):
                handler.wfile.write(data[first : first + 1])
                handler.wfile.flush()
                time.sleep(0.1)

    return answer


def mute(handler: http.server.BaseHTTPRequestHandler, body: bytes) -> None:
    """Answers with status 500 and does not send the text that it announces."""
    _begin(handler, b"broken", 500)
    handler.wfile.flush()
    time.sleep(0.6)


def cut(data: bytes) -> Handler:
    """Sends half of what it announces."""

    def answer(handler: http.server.BaseHTTPRequestHandler, body: bytes) -> None:
        _begin(handler, data)
        handler.wfile.write(data[: len(data) // 2])

    return answer


def _begin(handler: http.server.BaseHTTPRequestHandler, data: bytes, status: int = 200) -> None:
    handler.send_response(status)
    handler.send_header("Content-Length", str(len(data)))
    handler.end_headers()
