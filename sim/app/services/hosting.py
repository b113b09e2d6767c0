"""Runs the HTTP servers of this project; each error is one line of their log."""

from __future__ import annotations

import contextlib
import importlib.util
import logging
import socket
import sys
from collections.abc import Sequence
from typing import Any

from sim.app.analysis.display import make_console
from sim.core import invocation
from sim.core.errors import ConfigError, debug
from sim.core.reading import printable


def require_web() -> None:
    """Raises ConfigError if the packages of the extra `web` are not installed."""
    missing = [name for name in ("starlette", "uvicorn", "websockets") if importlib.util.find_spec(name) is None]
    if missing:
        raise ConfigError(f"{invocation.program()} needs {', '.join(missing)}: pip install 'stubborn-objectnav[web]'.")


def in_address(host: str) -> str:
    """Returns a host as it is written in an address: one of IPv6 has brackets."""
    return f"[{host}]" if ":" in host else host


def listen(host: str, port: int) -> socket.socket:
    """Returns a listening socket.

    Raises:
        ConfigError: the address is not one of this machine, or the port is in use.
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


def serve(app: Any, sockets: Sequence[socket.socket], where: str, **options: Any) -> None:
    """Serves an ASGI application until Ctrl-C.

    Args:
        app: the application.
        sockets: listening sockets, see `listen`.
        where: a sentence on the addresses, which is printed first.
        options: further ones of `uvicorn.Config`.
    """
    import uvicorn

    config = uvicorn.Config(app, log_level="warning", access_log=False, **options)
    for handler in (*logging.getLogger("uvicorn").handlers, logging.lastResort):  # of all loggers, uvicorn's and others
        if handler is not None:
            handler.addFilter(in_one_line)
    make_console().print(f"{where} Ctrl-C ends the server.", soft_wrap=True)
    sys.stdout.flush()
    with contextlib.suppress(KeyboardInterrupt):
        uvicorn.Server(config).run(sockets=list(sockets))


def in_one_line(record: logging.LogRecord) -> bool:
    """Replaces the traceback of a log record by the error, unless --debug is given: any client could fill the log."""
    if record.exc_info and not debug():
        error = record.exc_info[1]
        line = " ".join(f"{record.getMessage()} {type(error).__name__}: {error}".split())
        record.msg, record.args, record.exc_info, record.exc_text = printable(line), (), None, None
    return True
