"""The agent of the page: it states a place for its own STOP, and no place for the STOP of a person."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
import torch

from sim.app.evaluation.rollout import next_action
from sim.app.web.controls import Choice, Controls, Interrupted
from sim.app.web.session import Frame, Session, SharedAgent
from sim.core.errors import AgentError
from sim.core.goals import GoalSpec
from sim.core.interface import MOVES, Action, StatesTarget
from sim.task.result import metrics_without_episode


class Stops:
    """An agent that stops at once."""

    def reset(self, goal: str, seed: int) -> None: ...

    def act(self, observation: object) -> Action:
        return Action.STOP


class StopsThere(Stops):
    """It also states the place for which it stops."""

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
    controls: Any = SimpleNamespace(choose=lambda advised: Choice(advised, driver), hints=False)
    unused: Any = None
    parts: Any = SimpleNamespace(agent=inner, env=SimpleNamespace(actions=MOVES))
    shared = SharedAgent(parts, unused, controls, unused)
    shared.reset("bed", 0)
    assert shared.act({}) is Action.STOP  # pyright: ignore[reportArgumentType] - nothing reads the observation
    assert isinstance(shared, StatesTarget)
    assert shared.stop_target_xy_m() == place


@pytest.mark.parametrize(("advised", "refused"), [(np.int64(1), ""), (torch.tensor(2), ""), (4, "got|returned 4")])
def test_actions_are_those_that_a_run_takes(advised: Any, refused: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(SharedAgent, "_show", lambda *_: None)
    controls: Any = SimpleNamespace(choose=lambda advised: Choice(advised, "agent"), hints=False)
    inner, unused = SimpleNamespace(reset=lambda *_: None, act=lambda _: advised), cast(Any, None)
    parts: Any = SimpleNamespace(agent=inner, env=SimpleNamespace(actions=MOVES))
    shared = SharedAgent(parts, unused, controls, unused)
    shared.reset("bed", 0)
    if refused:
        with pytest.raises(AgentError, match=refused):
            shared.act(unused)
    else:
        assert shared.act(unused) is Action(int(advised))


def test_an_agent_whose_close_fails_is_replaced_by_the_next_one() -> None:
    closed = []

    def close() -> None:
        raise RuntimeError("of the user")

    unused: Any = None
    session = Session(unused, unused)
    agent = SimpleNamespace(reset=None, act=None, close=close)
    parts = SimpleNamespace(agent=agent, env=SimpleNamespace(close=lambda: closed.append("env")))
    pictures = SimpleNamespace(close=lambda: closed.append("pictures"))
    session._made = cast(Any, SimpleNamespace(parts=parts, pictures=pictures))
    session._free()
    session._free()
    assert closed == ["pictures", "env"]


def test_the_end_that_a_user_asks_for_is_no_error_of_the_agent(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(SharedAgent, "_show", lambda *_: None)
    controls, unused = Controls(), cast(Any, None)
    parts: Any = SimpleNamespace(agent=Stops(), env=SimpleNamespace(actions=MOVES))
    shared = SharedAgent(parts, unused, controls, unused)
    controls.close()
    with pytest.raises(Interrupted):
        next_action(shared, {}, "Agent 'stops', step 1")


def test_the_world_can_be_shown_before_the_first_action() -> None:
    shown: list[Frame] = []
    metrics = metrics_without_episode(None)
    task = SimpleNamespace(
        goal_metrics=lambda: metrics, num_steps=0, goal="bed", is_chain=False, goals=[GoalSpec.of("bed")],
        goal_number=0, goal_mask=lambda images: images["semantic"] > 0,
    )  # fmt: skip
    env = SimpleNamespace(
        truth_images={"semantic": np.zeros((4, 4), np.uint8)},
        scene=SimpleNamespace(task=task),
        episode=SimpleNamespace(goal="bed"),
    )
    parts: Any = SimpleNamespace(agent=Stops(), env=env, painter=None)
    display: Any = SimpleNamespace(wanted=frozenset, show=shown.append)
    unused: Any = None
    SharedAgent(parts, unused, unused, display).show_end()
    assert (shown[0].facts["last"], shown[0].facts["ended"]) == (None, True)
