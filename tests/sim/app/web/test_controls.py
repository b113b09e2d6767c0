"""The controls of the page: the driver, the time of an action, and refused messages."""

from __future__ import annotations

import threading
import time

import pytest

from sim.app.options import RunOptions
from sim.app.web.controls import Choice, Controls, EpisodeRequest, Interrupted
from sim.core.errors import ConfigError
from sim.core.interface import Action

LEFT, AHEAD = Action.TURN_LEFT, Action.MOVE_FORWARD
REQUEST = EpisodeRequest(split="val", house="val_00", goal="bed", options=RunOptions(semantics="gt"))


def later(action, delay_s: float = 0.1) -> None:
    threading.Timer(delay_s, action).start()


def test_a_paused_episode_goes_on_by_single_steps_of_the_agent() -> None:
    controls = Controls()
    controls.obey({"do": "step"})
    assert controls.paused
    assert controls.choose(LEFT) == Choice(LEFT, "agent")
    began = time.monotonic()
    later(lambda: controls.obey({"do": "step"}))
    assert controls.choose(LEFT) == Choice(LEFT, "agent")
    assert time.monotonic() - began > 0.05  # it waited for the second step


def test_the_speed_is_the_number_of_actions_per_second() -> None:
    controls = Controls()
    controls.obey({"do": "speed", "per_s": 5})
    began = time.monotonic()
    for _ in range(3):
        controls.choose(LEFT)
    assert 0.35 < time.monotonic() - began < 1.5


def test_an_action_of_a_person_takes_over_and_handing_back_drops_what_waits() -> None:
    controls = Controls()
    controls.obey({"do": "act", "action": 1})
    assert controls.choose(LEFT) == Choice(AHEAD, "person")
    controls.obey({"do": "act", "action": 1})
    controls.obey({"do": "agent"})
    assert controls.choose(LEFT) == Choice(LEFT, "agent")
    controls.obey({"do": "person"})
    later(lambda: controls.obey({"do": "act", "action": 3}))
    assert controls.choose(LEFT) == Choice(Action.TURN_RIGHT, "person")


def test_few_actions_wait_so_that_the_robot_stops_soon_after_a_key_is_released() -> None:
    controls = Controls()
    for _ in range(50):
        controls.obey({"do": "act", "action": 1})
    controls.obey({"do": "act", "action": 2})
    taken = [controls.choose(LEFT) for _ in range(4)]
    assert taken[-1] == Choice(LEFT, "person")
    later(controls.redraw)
    assert controls.choose(LEFT) is None


def test_actions_that_wait_belong_to_their_episode() -> None:
    controls = Controls()
    controls.ask_for(EpisodeRequest(**{**vars(REQUEST), "driver": "person"}))
    controls.next_request()
    for _ in range(3):
        controls.obey({"do": "act", "action": 1})
    controls.ask_for(EpisodeRequest(**{**vars(REQUEST), "driver": "person"}))
    controls.next_request()
    later(controls.redraw)
    assert controls.choose(LEFT) is None


@pytest.mark.parametrize("end", [lambda c: c.obey({"do": "stop"}), lambda c: c.ask_for(REQUEST), lambda c: c.close()])
def test_a_new_request_an_end_or_a_closing_server_interrupts_the_episode(end) -> None:
    controls = Controls()
    controls.obey({"do": "pause"})
    later(lambda: end(controls))
    with pytest.raises(Interrupted):
        controls.choose(LEFT)


@pytest.mark.parametrize(
    "message",
    [
        {},
        {"do": "import os"},
        {"do": "speed", "per_s": 1e9},
        {"do": "speed", "per_s": True},
        {"do": "act"},
        {"do": "act", "action": 4},
        {"do": "act", "action": True},
        {"do": "act", "action": "1"},
        {"do": ["pause"]},
    ],
)
def test_other_messages_are_refused(message: dict) -> None:
    with pytest.raises(ConfigError):
        Controls().obey(message)
