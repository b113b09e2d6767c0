"""What can be started from the page: what ships, what the server was started with, and the episodes of its runs."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from sim import run as sim_run
from sim.composition.options import RunOptions
from sim.errors import ConfigError
from sim.evaluation.results import read_record, read_result_lines
from sim.task.trajectory import read_trajectory, trajectory_file
from sim.web.choices import Choices, Offer
from sim.web.controls import Wish
from sim.web.driven import DrivenRuns
from sim.web.session import Frame, Session
from tests.helpers.worlds import room, with_box

START = {"split": "traps", "house": "wedged_spawn", "goal": "bed", "agent": "oracle", "semantics": "gt"}
OWN_AGENT = "examples.my_agent:AGENT"


class Audience:
    """Keeps what it is told."""

    def __init__(self) -> None:
        self.told: list[Any] = []
        self.frames: list[Frame] = []

    def wanted(self) -> frozenset[str]:
        return frozenset()

    def show(self, frame: Frame) -> None:
        self.frames.append(frame)

    def tell(self, state: Any) -> None:
        self.told.append(json.loads(json.dumps(state)))


@pytest.fixture(scope="module")
def choices() -> Choices:
    return Choices(Offer())


@pytest.fixture(scope="module")
def own(house: Path) -> Choices:
    """Choices with an agent, an explorer and a house of the user's."""
    options = RunOptions(weights=None, profile="fast", config=("task.max_steps=8",))
    return Choices(
        Offer(agents=(OWN_AGENT,), explorers=("stubborn.agents:INFORMED_TOUR",), houses=(house,), options=options)
    )


def play(wish: Wish, runs: Path, prepare: Callable[[Session], None] = lambda _: None) -> Audience:
    """Plays an episode to its end in this thread."""
    audience = Audience()
    session = Session(audience, DrivenRuns(runs))
    session.controls.obey({"do": "speed", "per_s": 60})
    session.controls.ask_for(wish)
    assert session.controls.next_wish() is wish
    prepare(session)
    try:
        session._play(wish)
    finally:
        session._free()
    return audience


def test_what_the_server_was_started_with_is_offered_and_comes_first(own: Choices, house: Path) -> None:
    offered = own.as_json()
    assert offered["splits"][str(house)] == {"sofa_room": {"sofa": []}}
    assert offered["first"] == {
        "split": str(house),
        "agent": OWN_AGENT,
        "explorer": "stubborn.agents:INFORMED_TOUR",
        "semantics": "rednet",
    }
    assert {"stubborn", "oracle", OWN_AGENT} <= set(offered["agents"])
    assert offered["agents"]["stubborn"]["explorer"]
    assert not offered["agents"]["oracle"]["explorer"]
    wish = own.wish(START | {"agent": "stubborn-plus", "explorer": "stubborn.agents:INFORMED_TOUR"})
    assert (wish.options.split, wish.options.house) == ("traps", None)
    assert (wish.options.explorer, wish.options.config) == ("stubborn.agents:INFORMED_TOUR", ("task.max_steps=8",))


def test_the_id_of_an_episode_says_its_house_and_goal(choices: Choices) -> None:
    wish = choices.wish(START | {"split": "val", "episode": "val_0018"})
    assert (wish.episode_id, wish.house != "wedged_spawn") == ("val_0018", True)
    with pytest.raises(ConfigError, match="Split 'val' has no episode 'val_9999'"):
        choices.wish(START | {"split": "val", "episode": "val_9999"})


@pytest.mark.parametrize(
    ("part", "value"),
    [
        ("agent", "os:system"), ("agent", ["oracle"]), ("split", "/tmp"), ("split", "test"), ("semantics", "os:getcwd"),
        ("explorer", "os:getcwd"), ("house", "../../etc"), ("house", None), ("driver", "other"), ("goal", 5),
    ],
)  # fmt: skip
def test_nothing_else_can_be_started(choices: Choices, part: str, value: object) -> None:
    with pytest.raises(ConfigError):
        choices.wish(START | {part: value})


def test_an_episode_of_a_run_has_its_options_but_no_file_or_code_that_is_not_offered(choices: Choices) -> None:
    line = {"episode_id": "traps_0000", "house": "wedged_spawn", "goal": "bed"}
    line["episode_id"] = choices.as_json()["splits"]["traps"]["wedged_spawn"]["bed"][0]
    settings = {"task.max_steps": 30, "agent.weights": "/etc/passwd", "agent.name": "plain", "agent.list": ["../x"]}
    record = {"agent": "random", "semantics": "noisy", "split": "traps", "seed": 7, "noise": "harsh"}
    wish = choices.again(record | {"settings": settings}, line, "person")
    assert (wish.options.seed, wish.options.noise, wish.driver) == (7, "harsh", "person")
    assert wish.options.config == ("task.max_steps=30", 'agent.name="plain"')
    for part, name in (("agent", OWN_AGENT), ("explorer", "mine:EXPLORER"), ("split", "/my/split")):
        with pytest.raises(ConfigError, match=rf"--{part} '?{name}"):
            choices.again(record | {part: name}, line, "agent")
    with pytest.raises(ConfigError, match=r"web --house /my/house\.xml"):
        choices.again(record | {"house": "/my/house.xml"}, line, "agent")


def test_an_episode_of_a_run_is_repeated_exactly(own: Choices, house: Path, tmp_path: Path) -> None:
    options = ["--house", str(house), "--agent", "random", "--semantics", "gt", "--seed", "5", "--noise", "harsh"]
    options += ["--config", "task.max_steps=8", "--episodes", "2", "--record", "--out", str(tmp_path / "run")]
    assert sim_run.entry(options) == 0
    line = read_result_lines(tmp_path / "run" / "results.jsonl").values[1]
    wish = own.again(read_record(tmp_path / "run" / "config.json"), line, "agent")
    audience = play(wish, tmp_path)
    (begun,) = (state for state in audience.told if state["phase"] == "playing")
    assert (begun["episode_id"], begun["note"]) == (line["episode_id"], "")
    last = audience.frames[-1].facts
    assert (last["step"], last["driven_m"]) == (line["num_steps"], line["path_length"])


def test_an_episode_of_a_run_without_noise_in_a_house_with_two_goals_begins_where_it_began(tmp_path: Path) -> None:
    built = with_box(room(5, 5), "sofa_00", centre_m=(2.0, 0, 0.4), half_m=(0.3, 0.6, 0.4))
    built = with_box(built, "bed_00", centre_m=(-2.0, 0, 0.3), half_m=(0.3, 0.6, 0.3))
    (tmp_path / "two.xml").write_text(built.spec.to_xml())
    options = ["--house", str(tmp_path / "two.xml"), "--agent", "oracle", "--semantics", "gt", "--seed", "3"]
    assert sim_run.entry([*options, "--episodes", "3", "--out", str(tmp_path / "run")]) == 0
    line = read_result_lines(tmp_path / "run" / "results.jsonl").values[2]
    offered = Choices(Offer(houses=(tmp_path / "two.xml",), options=RunOptions(weights=None, profile="fast")))
    wish = offered.again(read_record(tmp_path / "run" / "config.json"), line, "agent")
    last = play(wish, tmp_path).frames[-1].facts
    assert (last["step"], last["driven_m"]) == (line["num_steps"], line["path_length"])


def test_an_episode_driven_by_hand_is_recorded_and_one_of_the_agent_is_not(
    own: Choices, house: Path, tmp_path: Path
) -> None:
    start = START | {"split": str(house), "house": "sofa_room", "goal": "sofa", "agent": "random"}

    def drive(session: Session) -> None:
        session.controls.obey({"do": "hints", "on": True})
        for action in (2, 1, 0):
            session.controls.obey({"do": "act", "action": action})

    audience = play(own.wish(start | {"driver": "person", "episode": "sofa_room_0003"}), tmp_path, drive)
    assert audience.frames[0].facts["hint"] is not None
    (run,) = tmp_path.iterdir()
    assert audience.told[-1]["outcome"]["recorded"] == f"Recorded in {run}."
    (line,) = read_result_lines(run / "results.jsonl").values
    assert (line["agent"], line["uses_ground_truth"], line["semantics"]) == ("human", True, "gt")
    assert (line["episode_id"], line["person_steps"], line["hint_steps"]) == ("sofa_room_0003", 3, 3)
    assert read_trajectory(trajectory_file(run, "sofa_room_0003")).actions.tolist() == [2, 1, 0]
    assert read_record(run / "config.json")["config"]["task"]["max_steps"] == 8
    assert {file.name for file in run.iterdir()} >= {"summary.json", "pictures"}
    play(own.wish(start), tmp_path)
    assert len(list(tmp_path.iterdir())) == 1


def test_hints_lead_to_the_goal_also_after_a_detour(own: Choices, house: Path, tmp_path: Path) -> None:
    start = START | {"split": str(house), "house": "sofa_room", "goal": "sofa", "agent": "random", "driver": "person"}
    wish = own.wish(start | {"episode": "sofa_room_0001"})
    wish = Wish(**{**vars(wish), "options": RunOptions(agent="random", semantics="gt", house=house, goal="sofa")})

    class Follower(Audience):
        def show(self, frame: Frame) -> None:
            super().show(frame)
            if frame.facts["hint"] is not None:
                detour = len(self.frames) in (1, 3)
                controls.obey({"do": "act", "action": 3 if detour else frame.facts["hint"]["action"]})

    audience = Follower()
    session = Session(audience, DrivenRuns(tmp_path))
    controls = session.controls
    controls.obey({"do": "hints", "on": True})
    controls.ask_for(wish)
    controls.next_wish()
    session._play(wish)
    session._free()
    assert audience.told[-1]["outcome"]["found"]
    assert len(audience.frames) < 100


def test_code_of_the_users_that_raises_anything_leaves_the_session_alive(
    own: Choices, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    class Strange(BaseException):
        pass

    audience = Audience()
    session = Session(audience, DrivenRuns(tmp_path))

    def fail(wish: Wish) -> None:
        if len(audience.told) == 1:
            session.controls.close()
        session.controls.ask_for(wish)
        raise Strange("no\nreason \ud800")

    monkeypatch.setattr(session, "_play", fail)
    session.controls.ask_for(own.wish(START))
    session._run()
    assert [state["phase"] for state in audience.told] == ["failed", "failed"]
    told = "The episode broke: Strange: no reason \\ud800 (unexpected; --debug shows where)"
    assert audience.told[0]["message"] == told
    assert capsys.readouterr().err == ""
