"""Watch an agent, or drive the robot, in the browser: `stubborn web`, then open the address that it prints.

On a machine without a display, forward the port: `ssh -L 8008:127.0.0.1:8008 MACHINE`, and open
http://127.0.0.1:8008 on your own.
"""

from __future__ import annotations

import contextlib
import importlib.util
import socket
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from msgspec import Meta

from sim import cli, invocation
from sim.analysis import display
from sim.errors import ConfigError

HERE = frozenset(("127.0.0.1", "localhost", "::1"))
"""Names of this machine for itself."""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Watch an agent, or drive the robot, in the browser."""

    port: Annotated[int, Meta(ge=0, le=65535)] = 8008
    """Port of the page; 0 takes a free one."""
    host: str = "127.0.0.1"
    """Address to listen on. Every person with access to it can see and drive the robot: there is no password."""
    name: tuple[str, ...] = ()
    """Further names or addresses under which browsers reach this machine; needed with --host 0.0.0.0."""
    weights: Path | None = None
    """Your network in place of the shipped one, for segmentation by rednet."""
    semantics: tuple[str, ...] = ()
    """Segmentations of your own, package.module:NAME ..., to choose on the page."""
    config: tuple[str, ...] = ()
    """Their options, detector.FIELD=VALUE ..."""
    runs: Path = Path("runs")
    """Folder of the runs that the page shows."""


def main(args: Args) -> int:
    """Serves the page until it is interrupted; returns the exit status."""
    missing = [name for name in ("starlette", "uvicorn", "websockets") if importlib.util.find_spec(name) is None]
    if missing:
        raise ConfigError(f"{invocation.program()} needs {', '.join(missing)}: pip install -e '.[web]'.")
    if args.weights is not None:
        from sim.composition.segmenters import weights_file

        weights_file(args.weights)
    if args.semantics:
        from sim.composition.segmenters import find_segmentation

        own = {name: find_segmentation(name, None).description for name in args.semantics}
    else:
        own = {}
    listening = _listen(args.host, args.port)  # before the imports, which take seconds
    import uvicorn

    from sim.web.catalogue import Runs
    from sim.web.server import MAX_MESSAGE_BYTES, Hub, make_app

    port = listening.getsockname()[1]
    hosts = HERE | {args.host, *args.name} - {"0.0.0.0", "::"}
    app = make_app(Hub(args.weights, args.config), Runs(args.runs), hosts=hosts, segmentations=own)
    config = uvicorn.Config(
        app, log_level="warning", access_log=False, ws_max_size=MAX_MESSAGE_BYTES, timeout_graceful_shutdown=1
    )
    names = sorted(hosts - HERE) or ["127.0.0.1"]
    addresses = ", ".join(f"http://{f'[{name}]' if ':' in name else name}:{port}" for name in names)
    display.make_console().print(
        f"Open {addresses} in a browser. Ctrl-C ends the server.", highlight=False, soft_wrap=True
    )
    sys.stdout.flush()
    with contextlib.suppress(KeyboardInterrupt):
        uvicorn.Server(config).run(sockets=[listening])
    return 0


def _listen(host: str, port: int) -> socket.socket:
    """Returns a listening socket.

    Raises:
        ConfigError: the address is not of this machine, or the port is in use.
    """
    try:
        family, kind, protocol, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        listening = socket.socket(family, kind, protocol)
        listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listening.bind(address)
        listening.listen()
    except OSError as error:
        raise ConfigError(f"Cannot listen on {host}, port {port}: {error.strerror or error}.") from None
    return listening


def entry(argv: Sequence[str] | None = None) -> int:
    """Runs the command line; returns its exit status."""
    return cli.run(Args, main, argv)


if __name__ == "__main__":
    sys.exit(entry())
