"""Responses of the server: JSON that can hold any text, and errors."""

from __future__ import annotations

import json
from collections.abc import Callable

import anyio.to_thread
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


async def or_404(answer: Callable[[], Response]) -> Response:
    """Runs a function in a thread and returns its response; after an error of this project, one with status 404."""
    try:
        return await anyio.to_thread.run_sync(answer)
    except ObjectNavError as error:
        return PlainTextResponse(printable(str(error)), 404)
