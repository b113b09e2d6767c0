"""The agent of the page: it states the place of its own STOP and none of a person's."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from sim.interface import Action, StatesTarget
from sim.web.controls import Choice
from sim.web.session import SharedAgent


class Stops:
    """An agent that stops at once."""

    def reset(self, goal: str, seed: int) -> None: ...

    def act(self, observation: object) -> Action:
        return Action.STOP


class StopsThere(Stops):
    """It also states for which place."""

    def stop_target_xy_m(self) -> tuple[float, float]:
        return 1.0, 2.0


@pytest.mark.parametrize(
    ("inner", "driver", "place"),
    [(StopsThere(), "agent", (1.0, 2.0)), (StopsThere(), "person", None), (Stops(), "agent", None)],
)
def test_the_place_is_that_of_the_agents_own_stop(
    inner: Stops, driver: Any, place: object, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(SharedAgent, "_show", lambda *_: None)
    controls: Any = SimpleNamespace(choose=lambda advised: Choice(advised, driver))
    unused: Any = None
    parts: Any = SimpleNamespace(agent=inner)
    shared = SharedAgent(parts, unused, controls, unused)
    shared.reset("bed", 0)
    assert shared.act({}) is Action.STOP  # pyright: ignore[reportArgumentType] - nothing reads the observation
    assert isinstance(shared, StatesTarget)
    assert shared.stop_target_xy_m() == place
