"""Choices on the page: the parts that ship, those with which the server was started, and the episodes of its runs."""

from __future__ import annotations

import base64
import json
import math
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from typing import Any, cast

import cv2
import numpy as np
import pytest

from sim.app.commands import run as sim_run
from sim.app.commands import web
from sim.app.composition.runner import build_parts
from sim.app.composition.setup import resolve
from sim.app.evaluation.results import RunRecord, read_record, read_results
from sim.app.options import RunOptions
from sim.app.web.choices import Choices, Offer
from sim.app.web.controls import EpisodeRequest
from sim.app.web.driven import DrivenRuns
from sim.app.web.pictures import NAMES, in_sight
from sim.app.web.session import Frame, Session, choose_episode
from sim.core.errors import ConfigError, EpisodeError
from sim.core.interface import MPCAT40_ID
from sim.episodes.splits import load_split
from sim.task.trajectory import read_trajectory, trajectory_file
from tests.helpers.results import a_result
from tests.helpers.worlds import room, with_box
from tests.sim.robot.test_kinds import rover_with_a_mesh

START = {"split": "traps", "house": "wedged_spawn", "goal": "bed", "agent": "oracle", "semantics": "gt"}
OWN_AGENT = "examples.my_agent:AGENT"


class Display:
    """Keeps the frames and states that it receives."""

    def __init__(self) -> None:
        self.states: list[Any] = []
        self.frames: list[Frame] = []

    def wanted(self) -> frozenset[str]:
        return frozenset()

    def show(self, frame: Frame) -> None:
        self.frames.append(frame)

    def show_state(self, state: Any) -> None:
        self.states.append(json.loads(json.dumps(state)))


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


def play(
    request: EpisodeRequest, runs: Path, prepare: Callable[[Session], None] = lambda _: None,
    display: Display | None = None,
) -> Display:  # fmt: skip
    """Plays an episode to its end in this thread."""
    display = display or Display()
    session = Session(display, DrivenRuns(runs))
    session.controls.obey({"do": "speed", "per_s": 60})
    session.controls.ask_for(request)
    assert session.controls.next_request() is request
    prepare(session)
    try:
        session._run_episode(request)
    finally:
        session._free()
    return display


def test_what_the_server_was_started_with_is_offered_and_comes_first(own: Choices, house: Path) -> None:
    offered: Any = own.as_json()
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
    request = own.request(START | {"agent": "stubborn-plus", "explorer": "stubborn.agents:INFORMED_TOUR"})
    assert (request.options.split, request.options.house) == ("traps", None)
    assert (request.options.explorer, request.options.config) == (
        "stubborn.agents:INFORMED_TOUR",
        ("task.max_steps=8",),
    )


def test_the_id_of_an_episode_says_its_house_and_goal(choices: Choices) -> None:
    request = choices.request(START | {"split": "val", "episode": "val_0018"})
    assert (request.episode_id, request.house != "wedged_spawn") == ("val_0018", True)
    with pytest.raises(ConfigError, match=r"'val'.*'val_9999'"):
        choices.request(START | {"split": "val", "episode": "val_9999"})


def test_a_robot_may_use_files_of_the_root_in_every_split(tmp_path: Path) -> None:
    robot = rover_with_a_mesh(tmp_path, "../meshes/deck.obj")
    named = '<asset><mesh name="deck" file="../meshes/deck.obj"/></asset>'
    robot.write_text(robot.read_text().replace("<asset/>", named))
    choices = Choices(web.offer(web.Args(robot=str(robot), root=tmp_path)))
    for start in ({}, {"start": [1.0, 1.0, 0.0]}):
        assert resolve(choices.request(START | start).options).options.root == tmp_path
    with pytest.raises(ConfigError, match="--root needs --house or --robot"):
        web.offer(web.Args(root=tmp_path))


def test_replicates_and_episodes_that_the_page_drew_can_be_watched_again(choices: Choices) -> None:
    record: RunRecord = {"agent": "oracle", "semantics": "gt", "split": "traps", "seed": 3}
    first = choices.as_json()["splits"]["traps"]["wedged_spawn"]["bed"][0]  # type: ignore[index]
    line = a_result(episode_id=f"{first}~1", house="wedged_spawn", goal="bed")
    assert choices.again(record, line, "agent").episode_id == f"{first}~1"
    drawn = choices.request(WISH)
    setup = resolve(drawn.options)
    with closing(build_parts(setup, watched=True).env) as env:
        before = choose_episode(env, drawn, 2, setup)
        line = a_result(episode_id=before.episode_id, house=before.house, goal=before.goal)
        again = choices.again({**record, "seed": drawn.options.seed, "agent": "stubborn-plus"}, line, "person")
        assert choose_episode(env, again, 0, setup) == before


@pytest.mark.parametrize(
    ("part", "value"),
    [
        ("agent", "os:system"), ("agent", ["oracle"]), ("split", "/tmp"), ("split", "test"), ("semantics", "os:getcwd"),
        ("explorer", "os:getcwd"), ("house", "../../etc"), ("house", None), ("driver", "other"), ("goal", 5),
    ],
)  # fmt: skip
def test_nothing_else_can_be_started(choices: Choices, part: str, value: object) -> None:
    with pytest.raises(ConfigError):
        choices.request(START | {part: value})


def test_an_episode_of_a_run_has_its_options_but_no_file_or_code_that_is_not_offered(choices: Choices) -> None:
    offered: Any = choices.as_json()
    first = offered["splits"]["traps"]["wedged_spawn"]["bed"][0]
    line = a_result(episode_id=first, house="wedged_spawn", goal="bed")
    settings = {"task.max_steps": 30, "agent.weights": "/etc/passwd", "agent.name": "plain", "agent.list": ["../x"],
                "agent.code": "mine:main()"}  # fmt: skip
    record: RunRecord = {"agent": "random", "semantics": "noisy", "split": "traps", "seed": 7, "noise": "harsh"}
    request = choices.again({**record, "settings": settings}, line, "person")
    assert (request.options.seed, request.options.noise, request.driver) == (7, "harsh", "person")
    assert request.options.config == ("task.max_steps=30", "agent.name=plain")
    for part, name in (("agent", OWN_AGENT), ("explorer", "mine:EXPLORER"), ("split", "/my/split")):
        with pytest.raises(ConfigError, match=rf"--{part} '?{name}"):
            choices.again(cast(RunRecord, {**record, part: name}), line, "agent")
    with pytest.raises(ConfigError, match=r"web --house /my/house\.xml"):
        choices.again({**record, "house": "/my/house.xml"}, line, "agent")


def test_a_run_in_one_house_without_its_number_of_episodes_is_refused(own: Choices, house: Path) -> None:
    record: RunRecord = {"agent": "random", "semantics": "gt", "house": str(house), "seed": 7}
    line = a_result(episode_id=f"{house.stem}_0000", house=house.stem, goal="sofa")
    with pytest.raises(ConfigError, match="episodes"):
        own.again(record, line, "agent")


def test_an_episode_of_a_run_is_repeated_exactly(own: Choices, house: Path, tmp_path: Path) -> None:
    options = ["--house", str(house), "--agent", "random", "--semantics", "gt", "--seed", "5", "--noise", "harsh"]
    options += ["--config", "task.max_steps=8", "--episodes", "2", "--record", "--out", str(tmp_path / "run")]
    assert sim_run.entry(options) == 0
    line = read_results(tmp_path / "run" / "results.jsonl").values[1]
    request = own.again(read_record(tmp_path / "run" / "config.json"), line, "agent")
    display = play(request, tmp_path)
    (begun,) = (state for state in display.states if state["phase"] == "running")
    assert (begun["episode_id"], begun["note"]) == (line.episode_id, "")
    last = display.frames[-1].facts
    assert (last["step"], last["driven_m"]) == (line.num_steps, line.path_length)


@pytest.mark.costly
def test_an_episode_of_a_run_without_noise_in_a_house_with_two_goals_begins_where_it_began(tmp_path: Path) -> None:
    built = with_box(room(5, 5), "sofa_00", centre_m=(2.0, 0, 0.4), half_m=(0.3, 0.6, 0.4))
    built = with_box(built, "bed_00", centre_m=(-2.0, 0, 0.3), half_m=(0.3, 0.6, 0.3))
    (tmp_path / "two.xml").write_text(built.spec.to_xml())
    options = ["--house", str(tmp_path / "two.xml"), "--agent", "oracle", "--semantics", "gt", "--seed", "3"]
    assert sim_run.entry([*options, "--episodes", "3", "--out", str(tmp_path / "run")]) == 0
    line = read_results(tmp_path / "run" / "results.jsonl").values[2]
    offered: Any = Choices(Offer(houses=(tmp_path / "two.xml",), options=RunOptions(weights=None, profile="fast")))
    request = offered.again(read_record(tmp_path / "run" / "config.json"), line, "agent")
    last = play(request, tmp_path).frames[-1].facts
    assert (last["step"], last["driven_m"]) == (line.num_steps, line.path_length)


def test_an_episode_driven_by_hand_is_recorded_and_one_of_the_agent_is_not(
    own: Choices, house: Path, tmp_path: Path
) -> None:
    start = START | {"split": str(house), "house": "sofa_room", "goal": "sofa", "agent": "random"}

    def drive(session: Session) -> None:
        session.controls.obey({"do": "hints", "on": True})
        for action in (2, 1, 0):
            session.controls.obey({"do": "act", "action": action})

    display = play(own.request(start | {"driver": "person", "episode": "sofa_room_0003"}), tmp_path, drive)
    assert display.frames[0].facts["hint"] is not None
    (run,) = tmp_path.iterdir()
    assert display.states[-1]["outcome"]["recorded"] == f"Recorded in {run}."
    (line,) = read_results(run / "results.jsonl").values
    assert (line.agent, line.uses_ground_truth, line.semantics) == ("human", True, "gt")
    assert (line.episode_id, line.person_steps, line.hint_steps) == ("sofa_room_0003", 3, 3)
    assert read_trajectory(trajectory_file(run, "sofa_room_0003")).actions.tolist() == [2, 1, 0]
    assert read_record(run / "config.json")["config"]["task"]["max_steps"] == 8
    assert {file.name for file in run.iterdir()} >= {"summary.json", "pictures"}
    play(own.request(start), tmp_path)
    assert len(list(tmp_path.iterdir())) == 1
    again = play(own.again(read_record(run / "config.json"), line, "agent"), tmp_path).frames[0].facts
    assert again["shortest_m"] == line.shortest_path


def test_replicates_of_one_start_in_a_house_can_be_watched_again(own: Choices, house: Path, tmp_path: Path) -> None:
    record: RunRecord = {"agent": "random", "semantics": "gt", "house": str(house), "episodes": 2, "replicates": 2}
    line = a_result(episode_id="sofa_room_0000~1", house="sofa_room", goal="sofa")
    request = own.again(cast(RunRecord, {**record, "start_deg": "-1 1 0"}), line, "agent")
    assert play(request, tmp_path).states[-1]["phase"] == "ended"


def test_hints_lead_to_the_goal_also_after_a_detour(own: Choices, house: Path, tmp_path: Path) -> None:
    start = START | {"split": str(house), "house": "sofa_room", "goal": "sofa", "agent": "random", "driver": "person"}
    request = own.request(start | {"episode": "sofa_room_0001"})
    request = EpisodeRequest(
        **{**vars(request), "options": RunOptions(agent="random", semantics="gt", house=house, goal="sofa")}
    )

    class Follower(Display):
        def show(self, frame: Frame) -> None:
            super().show(frame)
            hint: Any = frame.facts["hint"]
            if hint is not None:
                detour = len(self.frames) in (1, 3)
                controls.obey({"do": "act", "action": 3 if detour else hint["action"]})

    display = Follower()
    session = Session(display, DrivenRuns(tmp_path))
    controls = session.controls
    controls.obey({"do": "hints", "on": True})
    controls.ask_for(request)
    controls.next_request()
    session._run_episode(request)
    session._free()
    assert display.states[-1]["outcome"]["found"]
    assert len(display.frames) < 100


@pytest.mark.parametrize("readable", [True, False])
def test_code_of_the_users_that_raises_anything_leaves_the_session_alive(
    readable: bool, own: Choices, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    class Strange(BaseException):
        def __str__(self) -> str:
            return super().__str__() if readable else str(self.args[1])

    display = Display()
    session = Session(display, DrivenRuns(tmp_path))

    def fail(request: EpisodeRequest) -> None:
        if len(display.states) == 1:
            session.controls.close()
        session.controls.ask_for(request)
        raise Strange("no\nreason \ud800")

    monkeypatch.setattr(session, "_run_episode", fail)
    session.controls.ask_for(own.request(START))
    session._run()
    assert [state["phase"] for state in display.states] == ["failed", "failed"]
    reason = "no reason \\ud800" if readable else "its message cannot be read (IndexError)"
    message = f"The episode failed: Strange: {reason} (unexpected; --debug shows where)"
    assert display.states[0]["message"] == message
    assert capsys.readouterr().err == ""


WISH = START | {"agent": "stubborn-plus", "goal": "the bed"}


@pytest.mark.costly
def test_a_wish_in_words_is_played_in_a_house_of_a_split(choices, tmp_path):
    request = choices.request(WISH)
    assert request.options.goal == "the bed"
    display = play(request, tmp_path / "runs")
    assert display.states[-1]["phase"] == "ended", display.states[-1]
    assert "Looking for the bed." in [state["message"] for state in display.states]
    assert display.frames[0].facts["in_sight"]


def test_only_the_object_of_a_wish_is_the_goal_in_sight():
    semantic = np.full((20, 20), MPCAT40_ID["chair"], np.uint8)
    mask = np.zeros((20, 20), bool)
    assert [item["goal"] for item in in_sight(semantic, "the black chair", mask)] == [False]
    mask[:5] = True
    assert [item["goal"] for item in in_sight(semantic, "the black chair", mask)] == [True]


def test_a_wish_that_the_house_cannot_satisfy_is_answered_with_what_is_there(choices, tmp_path):
    with pytest.raises(EpisodeError, match=r"has no 'kettle'\. It has: bed, chair"):
        play(choices.request(WISH | {"goal": "a kettle"}), tmp_path / "runs")


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"goal": "a spaceship"}, "No object is known as 'spaceship'"),
        ({"goal": "toilet"}, "There is no 'toilet' in house 'wedged_spawn'"),
        ({"agent": "cloned"}, "takes the listed goals only"),
        ({"house": "nowhere"}, "There is no house 'nowhere'"),
    ],
)
def test_wishes_that_are_refused(choices, change, words):
    with pytest.raises(ConfigError, match=words):
        choices.request(WISH | change)


def test_the_house_is_shown_from_above_to_scale(own: Choices, house: Path) -> None:
    (split,) = [name for name in own.as_json()["splits"] if name.endswith(house.name)]  # type: ignore[attr-defined]
    view: Any = own.house_from_above(split, house.stem)
    picture = cv2.imdecode(np.frombuffer(base64.b64decode(view["jpeg"]), np.uint8), cv2.IMREAD_COLOR)
    assert view["middle_m"] == pytest.approx((0.0, 0.0), abs=0.02)
    assert picture is not None
    rows, cols = np.nonzero(np.abs(picture.astype(int) - picture[0, 0]).max(axis=2) > 25)  # not the background
    for cells in (rows, cols):  # a room of 6 x 6 m; the tops of its walls are nearer to the eye than its floor
        assert (np.ptp(cells) + 1) * view["m_per_px"] == pytest.approx(6.5, abs=0.4)
    assert own.house_from_above(split, house.stem) is view
    for asked in ((split, "nowhere"), ("nowhere", house.stem)):
        with pytest.raises(ConfigError):
            own.house_from_above(*asked)


@pytest.mark.parametrize("of_split", [True, False])
def test_an_episode_begins_at_the_chosen_start(
    of_split: bool, own: Choices, choices: Choices, house: Path, tmp_path: Path
) -> None:
    if of_split:
        offered, message = choices, START | {"driver": "agent"}
        pose = next(e.start for e in load_split("traps").episodes if e.house == "wedged_spawn")
        x, y = pose.x_m, pose.y_m
    else:
        (split,) = [name for name in own.as_json()["splits"] if name.endswith(house.name)]  # type: ignore[attr-defined]
        offered, message, x, y = own, START | {"split": split, "house": house.stem, "goal": "sofa"}, 1.0, 1.0
    request = offered.request(message | {"start": [x, y, 90.0], "episode": "ignored" if not of_split else ""})
    shown: list[Any] = []

    def watch(session: Session) -> None:
        made = session._made_for(request)
        shown.append(choose_episode(made.parts.env, request, 0, made.setup).start)

    play(request, tmp_path, watch)
    assert (shown[0].x_m, shown[0].y_m, math.degrees(shown[0].yaw_rad)) == pytest.approx((x, y, 90.0), abs=0.001)


@pytest.mark.costly
def test_an_episode_with_a_goal_in_words_does_not_begin_at_the_goal(choices: Choices, tmp_path: Path) -> None:
    request = choices.request(START | {"split": "val", "house": "val_02", "goal": "the chair in the living room"})
    session = Session(Display(), DrivenRuns(tmp_path))
    made = session._made_for(request)
    try:
        env = made.parts.env
        for turn in range(6):
            episode = choose_episode(env, request, turn, made.setup)
            env.reset(options={"episode": episode})
            assert (env.scene.task.goal_metrics().distance_to_goal or 0.0) > 0.5
    finally:
        session._free()


@pytest.mark.parametrize("start", [[1.0, 2.0], [1e9, 0.0, 0.0], ["1", 2.0, 0.0], "1 2 0", [float("nan"), 0.0, 0.0]])
def test_a_start_is_three_numbers(start: object, choices: Choices) -> None:
    with pytest.raises(ConfigError):
        choices.request(START | {"start": start})


@pytest.mark.costly
def test_a_person_drives_in_a_house_without_a_goal_and_an_agent_does_not(tmp_path: Path) -> None:
    file = tmp_path / "lit.xml"
    lamp = with_box(room(5, 4), "lighting_00", centre_m=(2.0, 0, 0.45), half_m=(0.2, 0.2, 0.45))
    file.write_text(lamp.spec.to_xml())
    offered = Choices(Offer(houses=(file,)))
    assert offered.as_json()["splits"][str(file)] == {"lit": {"": []}}  # type: ignore[index]
    start = START | {"split": str(file), "house": "lit", "goal": ""}
    with pytest.raises(ConfigError, match="'lit' has no goal for an agent; you can drive in it yourself"):
        offered.request(start)

    def drive(session: Session) -> None:
        session.controls.obey({"do": "hints", "on": True})
        with pytest.raises(ConfigError, match="no goal"):
            session.controls.obey({"do": "agent"})
        for action in (2, 1, 0):
            session.controls.obey({"do": "act", "action": action})

    class Pictured(Display):
        def wanted(self) -> frozenset[str]:
            return frozenset(NAMES)

    request = offered.request(start | {"driver": "person"})
    display = play(request, tmp_path / "runs", drive, Pictured())
    assert [state["message"] for state in display.states[1:]] == [
        "You drive, without a goal.",
        "The drive ended after 3 steps; nothing was recorded.",
    ]
    last = display.frames[-1].facts
    assert last["driven_m"] == pytest.approx(0.25, abs=0.02)
    assert (last["left_m"], last["advice"], last["hint"]) == (None, None, None)
    assert {"camera", "chase", "plan", "semantic", "depth"} <= set(display.frames[0].pictures)
    assert not (tmp_path / "runs").exists()
    placed = offered.request(start | {"driver": "person", "start": [1.0, 0.5, 90.0]})
    assert placed.options.start_deg == "1.0000 0.5000 90.0000"
    play(placed, tmp_path / "runs", drive)
