"""Responses of the server: JSON that can hold any text, and errors."""

from __future__ import annotations

import json
from collections.abc import Awaitable, Callable

import anyio.to_thread
from starlette.requests import Request
from starlette.responses import JSONResponse, PlainTextResponse, Response

from sim.core.errors import ObjectNavError
from sim.core.reading import printable


def as_ascii(content: object) -> str:
    """Returns JSON in ASCII, so that text with lone surrogates, such as some file names, can be sent too."""
    return json.dumps(content, ensure_ascii=True, allow_nan=False)


class Json(JSONResponse):
    """A response in JSON."""

    def render(self, content: object) -> bytes:
        """Returns the body of the response."""
        return as_ascii(content).encode("ascii")


def in_thread(answer: Callable[[Request], Response]) -> Callable[[Request], Awaitable[Response]]:
    """Returns an endpoint that runs a function in a thread; an error of this project is answered with status 404."""

    async def respond(request: Request) -> Response:
        try:
            return await anyio.to_thread.run_sync(answer, request)
        except ObjectNavError as error:
            return PlainTextResponse(printable(str(error)), 404)

    return respond
