"""The agent that asks a model, with a scripted server in place of one and a world of boxes."""

from __future__ import annotations

import base64
import json
import logging
import math
import re
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
from numpy.typing import NDArray

from sim.app.evaluation.rollout import model_use_of
from sim.app.services.vlm.agent import SPEC, VlmAgent, VlmConfig
from sim.app.services.vlm.pictures import jpeg, outlined, write_transcript
from sim.app.services.vlm.prompts import FILE, Prompts
from sim.core.errors import AgentError, ConfigError
from sim.core.geometry.pose import Pose
from sim.core.interface import MPCAT40_ID, Observation, RobotModel, Scores, SegmenterSpec
from sim.task.result import ModelUse
from stubborn.detection.seeker import TargetSeekerConfig
from stubborn.detection.track_seeker import TrackSeekerConfig
from stubborn.exploration.corners import CornerConfig
from stubborn.exploration.tour import TourConfig
from stubborn.segmentation.ground_truth import GroundTruthSegmenter
from tests.helpers.chat_server import Question, believing, pictures_of, scripted, text_of
from tests.helpers.gridworld import SMALL_CAMERA, GridWorld, Trace, boxes_from_plan, run_episode
from tests.helpers.results import a_result
from tests.helpers.services import Server, Start, body_of

ROOMS = boxes_from_plan(
    """
##############################
#        #          #        #
#        #          #   bb   #
#        #          #   bb   #
#                            #
#                            #
#        #          #        #
#   tt   #          #        #
#        #          #        #
##############################
""",
    0.3,
)
START = (4.5, 1.35, 0.0)


class Certain(GroundTruthSegmenter):
    """The truth from an observation, declared as a detector that may err; it takes tables for beds, too."""

    spec = SegmenterSpec(sensors=("semantic",))

    def posteriors(self, observation: Observation) -> NDArray[np.float32]:
        posteriors = np.array(super().posteriors(observation))
        bed, table = (MPCAT40_ID[name] - 1 for name in ("bed", "table"))
        posteriors[bed] += 0.98 * posteriors[table]
        posteriors[table] *= 0.02
        return posteriors

    def scores(self, observation: Observation, goal: str) -> Scores:
        posteriors = self.posteriors(observation)
        target = posteriors[MPCAT40_ID[goal] - 1]
        return Scores(target, np.where(target > 0.5, 0.02, 0.98).astype(np.float32))


class ColouredWorld(GridWorld):
    """Also has colours: a red value for each category."""

    def observe(self, goal: str = "bed") -> dict[str, NDArray]:
        observation = super().observe(goal)
        rgb = np.repeat((6 * observation["semantic"])[..., None], 3, axis=2).astype(np.uint8)
        return {**observation, "rgb": rgb}


def agent_for(server: Server, **options: Any) -> VlmAgent:
    config = VlmConfig(url=f"{server.url}/v1", model="script", explorer=TourConfig(replan_steps=10), retries=0)
    parts = {"camera": SMALL_CAMERA, "robot": RobotModel(), "segmenter": Certain()}
    agent = SPEC.build("vlm", max_steps=300, config=replace(config, **options), **parts)
    assert isinstance(agent, VlmAgent)
    return agent


def run(agent: VlmAgent, max_steps: int = 200, goal: str = "bed") -> Trace:
    return run_episode(ColouredWorld(ROOMS, START), agent, goal, max_steps=max_steps)


def places_of(question: Question) -> list[tuple[float, float]]:
    """Returns distance, metres, and direction, degrees to the left, of the places of a question."""
    result = []
    for line in re.findall(r"^\d: (.*)", text_of(question), re.MULTILINE):
        found = re.match(r"(\d+\.\d) m away, (?:ahead|(\d+) degrees to the (left|right))", line)
        assert found is not None, line
        result.append((float(found[1]), float(found[2] or 0) * (1 if found[3] == "left" else -1)))
    return result


def is_stop(question: Question) -> bool:
    return '"found"' in text_of(question)


def farthest(question: Question) -> str:
    """Chooses the farthest place."""
    if is_stop(question) or "ready" in text_of(question):
        return believing(question)
    return json.dumps({"choice": int(np.argmax([distance for distance, _ in places_of(question)])) + 1})


@pytest.mark.costly
def test_the_robot_heads_for_the_place_that_the_model_chooses(start: Start) -> None:
    server, world = start(scripted(farthest)), ColouredWorld(ROOMS, START)
    agent, other_than_nearest = agent_for(server, asked=("place",)), 0
    agent.reset("sofa", 0)
    for _ in range(80):
        before = len(server.requests)
        world.step(agent.act(world.observe("sofa")))
        if len(server.requests) == before:
            continue
        places = places_of(json.loads(server.requests[-1][1]))
        distance_m, degrees = places[int(np.argmax([distance for distance, _ in places]))]
        assert agent.pose is not None
        chosen = Pose(agent.pose.x_m, agent.pose.y_m, agent.pose.yaw_rad + math.radians(degrees)).ahead(distance_m)
        assert agent.route is not None
        x_m, y_m = np.broadcast_arrays(*agent.route.goal.free.frame.mesh())
        cells = agent.route.goal.cells
        assert np.hypot(x_m[cells] - chosen[0], y_m[cells] - chosen[1]).min() < 0.3  # the text is rounded
        other_than_nearest += distance_m > min(places)[0] + 0.5
    assert other_than_nearest >= 2


@pytest.mark.costly
def test_the_question_has_the_map_and_views_with_the_places(start: Start) -> None:
    server = start(scripted())
    run(agent_for(server), max_steps=60, goal="sofa")
    questions = [json.loads(body) for _, body in server.requests[1:]]
    assert questions
    for question in questions:
        views = {int(number) for number in re.findall(r"in view (\d)", text_of(question))}
        assert len(pictures_of(question)) == 1 + len(views)
        assert views == set(range(1, len(views) + 1))
        assert "for this object: sofa." in text_of(question)
    assert any("in view 1" in text_of(question) for question in questions)
    server.requests.clear()
    run(agent_for(server, shown=("map",)), max_steps=60, goal="tv_monitor")
    question = json.loads(server.requests[1][1])
    assert len(pictures_of(question)) == 1
    assert "view" not in text_of(question).replace(" in view", "")
    assert "television" in text_of(question)


@pytest.mark.costly
@pytest.mark.parametrize("seeker", [TargetSeekerConfig(), TrackSeekerConfig()])
def test_a_candidate_that_the_model_refuses_is_left_for_another_one(start: Start, seeker: Any) -> None:
    refused: list[Question] = []

    def script(question: Question) -> str:
        if not is_stop(question) or refused:
            return believing(question)
        refused.append(question)
        return '{"found": false, "reason": "It is something else."}'

    world = ColouredWorld(ROOMS, (4.5, 1.35, math.pi))  # it sees the table first
    believed = run_episode(world, agent_for(start(scripted()), seeker=seeker), "bed", max_steps=250)
    assert believed.stopped
    first = "table" if world.distance_to("table") < world.distance_to("bed") else "bed"
    other = "bed" if first == "table" else "table"
    world = ColouredWorld(ROOMS, (4.5, 1.35, math.pi))
    agent = agent_for(start(scripted(script)), seeker=seeker)
    trace = run_episode(world, agent, "bed", max_steps=299)
    assert refused
    assert trace.stopped
    assert world.distance_to(other) < 1.0 < world.distance_to(first)
    assert "outlined in magenta" in text_of(refused[0])
    assert agent.model_use()["questions"] == agent.chat.questions >= 2


def test_the_candidate_is_outlined_where_a_leaning_camera_sees_it(start: Start) -> None:
    server, world = start(scripted()), ColouredWorld(ROOMS, START)
    agent = agent_for(server)
    assert run_episode(world, agent, "bed", max_steps=200).stopped
    observation = world.observe()
    for pitch_rad in (0.0, 0.0, 0.1):
        imu = 9.81 * np.array([-math.sin(pitch_rad), 0.0, math.cos(pitch_rad), 0.0, 0.0, 0.0])
        agent.levelling.level({**observation, "imu": imu})
    agent._confirmed()
    mask = agent.wished.scores(observation, "bed").target > agent.config.mapping.candidate_score
    assert mask.any()
    (sent,) = pictures_of(json.loads(server.requests[-1][1]))
    expected = base64.b64encode(jpeg(outlined(observation["rgb"], mask))).decode()
    assert sent.endswith(expected), "it is another picture"


def test_the_truth_is_not_checked(start: Start) -> None:
    server = start(scripted(lambda question: '{"found": false}' if is_stop(question) else believing(question)))
    config = VlmConfig(url=f"{server.url}/v1", model="script", explorer=TourConfig(), asked=("stop",))
    parts: Mapping[str, Any] = {"camera": SMALL_CAMERA, "robot": RobotModel(), "segmenter": GroundTruthSegmenter()}
    agent = SPEC.build("vlm", max_steps=300, config=config, **parts)
    assert run_episode(ColouredWorld(ROOMS, START), agent, "bed", max_steps=250).stopped
    assert len(server.requests) == 1  # whether it is there


@pytest.mark.costly
def test_after_some_failures_the_agent_decides_alone_as_the_tour_does_and_says_so(
    start: Start, caplog: pytest.LogCaptureFixture
) -> None:
    count = 0

    def answer(handler: Any, body: bytes) -> None:
        nonlocal count
        count += 1
        (scripted() if count == 1 else body_of(b"out of memory\n", 500))(handler, body)

    alone = agent_for(start(scripted()), asked=())
    broken = agent_for(start(answer), max_failures=2)
    with caplog.at_level(logging.WARNING):
        trace = run(broken)
    assert trace.actions == run(alone).actions
    use = model_use_of(broken, "vlm")
    assert isinstance(use, ModelUse)
    assert (use.questions, use.failed_questions) == (0, 2)
    assert use.fell_back_step is not None
    assert count == 3
    lines = [record.getMessage() for record in caplog.records]
    assert len(lines) == 3
    assert all("\n" not in line and "Model 'script', goal 'bed', step" in line for line in lines)
    assert "status 500: out of memory" in lines[0]
    assert lines[-1].endswith(f"step {use.fell_back_step}: 2 failures: it is not asked again.")
    broken.reset("bed", 0)
    assert broken.model_use()["fell_back_step"] is None  # another episode asks again


def test_a_repeated_episode_needs_no_server_and_has_the_same_line(start: Start, tmp_path: Path) -> None:
    server = start(scripted(farthest))
    config = {"cache": tmp_path, "input_price": 1.5, "output_price": 6.0}
    agent = agent_for(server, **config)
    first, used = run(agent), agent.model_use()
    assert used["questions"]
    assert used["cost"] == pytest.approx(agent.chat.questions * (900 * 1.5 + 20 * 6.0) / 1e6)
    server._server.shutdown()
    server._server.server_close()
    server.close = lambda: None  # type: ignore[method-assign]
    asked = len(server.requests)
    again = agent_for(server, **config)
    assert run(again).actions == first.actions
    assert {**again.model_use(), "wait_s": 0.0} == {**used, "wait_s": 0.0}
    assert len(server.requests) == asked


def test_transcripts_hold_questions_pictures_and_replies(start: Start, tmp_path: Path) -> None:
    run(agent_for(start(scripted()), transcripts=tmp_path, asked=("place",)), max_steps=40, goal="sofa")
    texts = sorted(tmp_path.glob("sofa_0_*_place.txt"))
    assert texts
    assert "choice=1, reason='Near.'" in texts[0].read_text()
    assert texts[0].with_name(f"{texts[0].stem}_1.jpg").read_bytes()[:2] == b"\xff\xd8"


def test_no_words_of_a_goal_lead_a_transcript_out_of_its_folder(tmp_path: Path) -> None:
    write_transcript(tmp_path / "in", "../the sofa_0_001_place", "text", [np.zeros((4, 4, 3), np.uint8)])
    assert [path.name for path in tmp_path.iterdir()] == ["in"]
    names = ["___the_sofa_0_001_place.txt", "___the_sofa_0_001_place_1.jpg"]
    assert sorted(path.name for path in (tmp_path / "in").iterdir()) == names


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"model": ""}, "agent.model=NAME"),
        ({"explorer": CornerConfig()}, "--explorer tour or informed-tour"),
        ({"max_places": 1}, "max_places >= 2"),
        ({"shown": ()}, '"map", "views" or both'),
        ({"url": "localhost"}, "VlmConfig.url"),
        ({"url": "http://127.0.0.1:9"}, "Agent 'vlm': http://127.0.0.1:9/chat/completions gave no valid reply"),
    ],
)
def test_settings_that_make_no_sense_are_refused(start: Start, options: dict[str, Any], message: str) -> None:
    with pytest.raises(ConfigError, match=re.escape(message)):
        agent_for(start(scripted()), **options)


def test_an_agent_that_asks_only_about_stops_takes_any_explorer(start: Start) -> None:
    agent_for(start(scripted()), explorer=CornerConfig(), asked=("stop",)).reset("bed", 0)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("$goal", "$object"), r"\$goal.*\$object|object"),
        (("ready =", "hello ="), "hello|ready"),
        (("[shown]", "[shown"), "prompts.toml"),
        (("$places", "$ places"), "may use"),
    ],
)
def test_prompts_of_ones_own_are_checked(tmp_path: Path, change: tuple[str, str], message: str) -> None:
    file = tmp_path / "prompts.toml"
    file.write_text(FILE.read_text())
    assert Prompts.read(file) == Prompts.read(FILE)
    file.write_text(FILE.read_text().replace(*change))
    with pytest.raises(ConfigError, match=message) as error:
        Prompts.read(file)
    assert str(file) in str(error.value)


def test_a_statement_in_another_form_is_an_error() -> None:
    class Wrong:
        def model_use(self) -> dict[str, object]:
            return {"model": 5}

    with pytest.raises(AgentError, match="model_use"):
        model_use_of(Wrong(), "wrong")  # type: ignore[arg-type]


def test_the_time_is_left_out_of_scores_that_are_compared() -> None:
    use = ModelUse(
        model="m", questions=1, failed_questions=0, prompt_tokens=9, completion_tokens=1, cost=None, wait_s=3.5,
        fell_back_step=None,
    )  # fmt: skip

    line = a_result(model_use=use)
    assert line.as_json()["model_use"] == msgspec.to_builtins(use)
    assert line.without_times().model_use == msgspec.structs.replace(use, wait_s=None)


def test_the_next_goal_of_a_chain_is_what_the_model_is_asked_for(start: Start) -> None:
    agent = agent_for(start(scripted()))
    agent.reset("bed", 0)
    agent.next_goal("the red sofa")
    assert agent.words == "the red sofa"
