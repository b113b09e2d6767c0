"""Servers for the tests of clients."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.helpers.services import Handler, Server, Start


@pytest.fixture
def start(monkeypatch: pytest.MonkeyPatch) -> Iterator[Start]:
    monkeypatch.setattr("sim.app.services.client.WAIT_S", 0.0)
    monkeypatch.setattr("sim.app.services.remote.VLFM_PORTS", {})  # both services on one port
    servers: list[Server] = []

    def made(answer: Handler) -> Server:
        servers.append(Server(answer))
        return servers[-1]

    yield made
    for server in servers:
        server.close()
