"""Responses of the server: JSON that can hold any text, and files that are already open."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable, Mapping
from typing import BinaryIO

import anyio.to_thread
from starlette.requests import Request
from starlette.responses import JSONResponse, PlainTextResponse, Response
from starlette.types import Receive, Scope, Send

from sim.core.errors import ObjectNavError
from sim.core.reading import printable

_CHUNK_BYTES = 1 << 18
_RANGE = re.compile(r"bytes=(\d{0,18})-(\d{0,18})")


def as_ascii(content: object) -> str:
    """Returns JSON in ASCII, so that text with lone surrogates, such as some file names, can be sent too."""
    return json.dumps(content, ensure_ascii=True, allow_nan=False)


class Json(JSONResponse):
    """A response in JSON."""

    def render(self, content: object) -> bytes:
        """Returns the body of the response."""
        return as_ascii(content).encode("ascii")


class OpenFile(Response):
    """Sends an open file, or the one range of it that the request asks for, and closes it.

    Exactly the announced number of bytes is sent, even if the size of the file changes at the same time.
    """

    def __init__(
        self, stream: BinaryIO, media_type: str, range_header: str = "", headers: Mapping[str, str] | None = None
    ) -> None:
        self._stream = stream
        size = os.fstat(stream.fileno()).st_size
        self._begin, end = _range(range_header, size) or (0, size)
        self._left = end - self._begin
        more = {"accept-ranges": "bytes", "content-length": str(self._left), **(headers or {})}
        status = 200
        if self._left < size:
            status, more["content-range"] = 206, f"bytes {self._begin}-{end - 1}/{size}"
        super().__init__(status_code=status, headers=more, media_type=media_type)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Sends the file."""
        with self._stream:
            await send({"type": "http.response.start", "status": self.status_code, "headers": self.raw_headers})
            remaining = 0 if scope["method"] == "HEAD" else self._left
            self._stream.seek(self._begin)
            while remaining > 0:
                piece = await anyio.to_thread.run_sync(self._stream.read, min(remaining, _CHUNK_BYTES))
                piece = piece or bytes(min(remaining, _CHUNK_BYTES))  # the file has become shorter
                remaining -= len(piece)
                await send({"type": "http.response.body", "body": piece, "more_body": remaining > 0})
            if scope["method"] == "HEAD" or self._left == 0:
                await send({"type": "http.response.body", "body": b""})


def _range(header: str, size: int) -> tuple[int, int] | None:
    """Returns begin and end of the range in a header; None: the whole file, also if the range is outside the file."""
    match = _RANGE.fullmatch(header.strip())
    if match is None or not any(match.groups()):
        return None
    first, last = match.groups()
    if not first:
        begin, end = max(0, size - int(last)), size
    else:
        begin, end = int(first), min(size, int(last) + 1) if last else size
    return (begin, end) if begin < end else None


async def or_404(answer: Callable[[], Response]) -> Response:
    """Runs a function in a thread and returns its response; after an error of this project, one with status 404."""
    try:
        return await anyio.to_thread.run_sync(answer)
    except ObjectNavError as error:
        return PlainTextResponse(printable(str(error)), 404)


def file_answer(
    request: Request, open_file: Callable[[], BinaryIO], media_type: str, headers: Mapping[str, str] | None = None
) -> Callable[[], Response]:
    """Returns a function for `or_404` that opens a file and responds with it."""
    return lambda: OpenFile(open_file(), media_type, request.headers.get("range", ""), headers)
