"""Serves the detector of `external_eye`, which others trained on photographs, to `--semantics http://HOST:PORT`.

    npm install --prefix runs/eye @vladmandic/human@3.3.6 @tensorflow/tfjs@4.22.0 @tensorflow/tfjs-backend-wasm@4.22.0
    python -m tools.research.coco_server --detector runs/eye
    stubborn run --semantics http://localhost:8320 --config detector.form=coco detector.box_threshold=0.2

A POST request has JSON {"image": base64 of a PNG or JPEG, "words": ignored: the detector knows its eight classes}. The
reply is a list of annotations {"category", "score", "bbox": [x, y, width, height] in pixels}. A request that cannot be
read is answered with status 400 and a sentence.
"""

from __future__ import annotations

import base64
import contextlib
import http.server
import json
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from msgspec import Meta

from sim.app import cli
from sim.core.errors import ConfigError
from sim.core.pictures import decode_picture
from sim.core.reading import parse_json
from tools.research.external_eye import Detector

MAX_BYTES = 1 << 26
"""Longest request."""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Serve a detector that was trained on photographs."""

    detector: Path
    """Folder in which npm installed `@vladmandic/human` and the two packages of tfjs."""
    port: Annotated[int, Meta(ge=0, le=65535)] = 8320
    """Port on this machine; 0: a free one."""


def found_in(detector: Detector, body: bytes) -> list[Mapping[str, Any]]:
    """Returns the annotations of a request's picture.

    Raises:
        ConfigError: the request cannot be read, or the detector ended.
    """
    text = parse_json(body, dict[str, Any], where="The request").get("image")
    try:
        content = base64.b64decode(text, validate=True)  # pyright: ignore[reportArgumentType]
    except (TypeError, ValueError):
        raise ConfigError("The request needs 'image': a picture in base64.") from None
    image = np.ascontiguousarray(decode_picture(content, where="'image'")[..., ::-1])
    return [
        {"category": found.category, "score": found.score, "bbox": [x0, y0, x1 - x0, y1 - y0]}
        for found in detector.detect(image)
        for x0, y0, x1, y1 in (found.box,)
    ]


def make_server(detector: Detector, port: int) -> http.server.HTTPServer:
    """Returns a server that answers one request after the other."""

    class Handler(http.server.BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            length = self.headers.get("Content-Length", "")
            try:
                if not length.isdecimal() or int(length) > MAX_BYTES:
                    raise ConfigError(f"The request needs a Content-Length of at most {MAX_BYTES} bytes.")
                status, text = 200, json.dumps(found_in(detector, self.rfile.read(int(length))))
            except ConfigError as error:
                status, text = 400, str(error)
            data = text.encode()
            self.send_response(status)
            self.send_header("Content-Type", "application/json" if status == 200 else "text/plain")
            self.send_header("Content-Length", str(len(data)))
            self.end_headers()
            with contextlib.suppress(ConnectionError):  # the client has gone
                self.wfile.write(data)

        def log_message(self, format: str, *args: object) -> None:
            pass

    return http.server.HTTPServer(("127.0.0.1", port), Handler)


def main(args: Args) -> int:
    """Serves until it is interrupted; returns the exit status."""
    with Detector(args.detector) as detector, make_server(detector, args.port) as server:
        print(f"The detector answers at http://localhost:{server.server_port}. Ctrl-C ends the server.", flush=True)
        try:
            server.serve_forever()
        except KeyboardInterrupt:
            return 0
    return 0


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
