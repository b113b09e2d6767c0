"""A client of services over HTTP: one POST request at a time, with a time limit, retries, and a cache by content.

A reply counts only if its reader accepts it; anything else is repeated, and ends as one sentence. Replies that count
can be kept in a folder by the content of their requests: a run whose replies are all there needs no service.
"""

from __future__ import annotations

import contextlib
import hashlib
import http.client
import ipaddress
import logging
import math
import time
import urllib.error
import urllib.parse
import urllib.request
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import TypeVar

from sim.core.errors import AgentError, ConfigError
from sim.core.files import write_together
from sim.core.reading import printable, read_bytes, reason_of
from sim.core.vocabulary import counted

_log = logging.getLogger(__name__)
T = TypeVar("T")
MAX_BYTES = 1 << 28
"""Longest request and reply, and the most that an NPZ file of a request expands to: a frame of the largest camera has 9
bytes a pixel."""
WAIT_S = 0.5
"""Time before a request is repeated."""
JSON = "application/json"


@dataclass(frozen=True, kw_only=True)
class ServiceConfig:
    """How a service is asked."""

    url: str
    """Its address, such as http://localhost:12181."""
    timeout_s: float = 10.0
    """Longest time of one request."""
    retries: int = 2
    """How often a request is repeated if there is no valid reply."""
    cache: Path | None = None
    """Folder in which replies are kept by the content of their requests; None: they are not kept."""

    def __post_init__(self) -> None:
        name = type(self).__name__
        if not is_address(self.url):
            raise ConfigError(f"{name}.url must be http://HOST:PORT or https://HOST:PORT, got '{self.url}'.")
        if not 0.0 < self.timeout_s < math.inf or self.retries < 0:
            raise ConfigError(f"{name} needs timeout_s > 0 and retries >= 0, got {self.timeout_s} and {self.retries}.")


def is_address(text: str) -> bool:
    """Returns whether a text is the address of a server."""
    try:
        parts = urllib.parse.urlsplit(text)
        return parts.scheme in ("http", "https") and bool(parts.hostname) and (parts.port or 1) > 0
    except ValueError:
        return False


def opener_for(url: str) -> urllib.request.OpenerDirector:
    """Returns what opens an address: through the proxy of the environment (HTTP_PROXY, HTTPS_PROXY), if there is one.

    Addresses of this machine (localhost, 127.0.0.1, ::1) and those of NO_PROXY are opened without a proxy.
    """
    direct = _is_this_machine(urllib.parse.urlsplit(url).hostname or "")
    return urllib.request.build_opener(urllib.request.ProxyHandler({} if direct else None))


def _is_this_machine(host: str) -> bool:
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


class Client:
    """Asks one service.

    Args:
        config: how it is asked.
        headers: of each request, in addition; they are not part of the content by which replies are kept.
    """

    def __init__(self, config: ServiceConfig, headers: Mapping[str, str] = MappingProxyType({})) -> None:
        self._config, self._headers = config, headers

    def ask(self, url: str, body: bytes, kind: str, read: Callable[[bytes], T]) -> T:
        """Returns the reply to a request, from the cache if it is there.

        Args:
            url: address of the request.
            body: of the request.
            kind: media type of the body.
            read: returns the value of a reply, or raises ConfigError if it is not valid.

        Raises:
            AgentError: there was no valid reply.
        """
        kept = self._kept(url, body)
        if kept is not None and kept.is_file():
            try:
                return read(read_bytes(kept, what="Cached reply", most=MAX_BYTES))
            except ConfigError as error:
                raise AgentError(f"The cached reply '{kept}' cannot be used: {error}") from None
        problem, headers = "", {**self._headers, "Content-Type": kind}
        for attempt in range(self._config.retries + 1):
            time.sleep(WAIT_S if attempt else 0.0)
            try:
                data = post(url, body, headers, self._config.timeout_s)
                value = read(data)
            except ConfigError as error:
                problem = str(error)
                continue
            if kept is not None:
                try:
                    kept.parent.mkdir(parents=True, exist_ok=True)
                    write_together({kept: data})
                except OSError as fault:  # the reply is valid, and may have been paid for
                    _log.warning("The reply is not kept in '%s': %s.", kept.parent, reason_of(fault))
            return value
        raise AgentError(f"{url} gave no valid reply in {counted(self._config.retries + 1, 'attempt')}: {problem}")

    def _kept(self, url: str, body: bytes) -> Path | None:
        """Returns the file of the reply to a request; None: replies are not kept."""
        if self._config.cache is None:
            return None
        name = hashlib.sha256(url.encode() + b"\0" + body).hexdigest()
        return self._config.cache / name[:2] / name


def post(url: str, body: bytes, headers: Mapping[str, str], timeout_s: float) -> bytes:
    """Returns the body of the reply to a POST request.

    Raises:
        ConfigError: there is no reply in time, its status is an error, or it is too long.
    """
    request = urllib.request.Request(url, body, method="POST")
    for name, value in headers.items():
        request.add_unredirected_header(name, value)  # another host must not get the key
    deadline, parts, size = time.monotonic() + timeout_s, list[bytes](), 0
    try:
        with opener_for(url).open(request, timeout=timeout_s) as reply:
            announced = reply.headers.get("Content-Length")
            while part := reply.read1(1 << 16):
                parts.append(part)
                size += len(part)
                if size > MAX_BYTES:
                    raise ConfigError(f"its reply is longer than {MAX_BYTES} bytes.")
                if time.monotonic() > deadline:
                    raise ConfigError(f"its reply took longer than {timeout_s:g} s.")
    except urllib.error.HTTPError as error:
        text = "without a text"
        with error, contextlib.suppress(OSError, http.client.HTTPException):
            text = error.read(300).decode(errors="replace")
        raise ConfigError(f"status {error.code}: {printable(' '.join(text.split()))[:200].rstrip('.')}.") from None
    except (OSError, http.client.HTTPException) as error:
        reason = getattr(error, "reason", error)
        text = f"no reply in {timeout_s:g} s" if isinstance(reason, TimeoutError) else str(reason)
        raise ConfigError(f"{printable(' '.join(text.split()))}.") from None
    if announced is not None and announced.isdigit() and size != int(announced):
        raise ConfigError(f"its reply ended after {size} of {announced} bytes.")
    return b"".join(parts)
