"""Runs with `--agent process:COMMAND`: no episode is lost, changed code is seen, videos show the agent's map."""

from __future__ import annotations

import json
import shlex
import shutil
import sys
from pathlib import Path
from typing import Any

import av
import numpy as np
import pytest

from sim.app.commands.run import entry
from sim.app.viewers.video import video_file
from sim.core.geometry.pose import Pose
from sim.core.goals import GoalSpec, PictureCamera
from sim.episodes.episode import Episode
from sim.episodes.splits import write_split
from tests.helpers.results import lines_of
from tests.helpers.worlds import sofa_room

ROOT = Path(__file__).parents[4]
CLIENT_AGENT = ROOT / "tests" / "helpers" / "client_agent.py"
SMALL = ("camera.width_px=160", "camera.height_px=120", "task.max_steps=5")


def run(house: Path, out: Path, agent: str, *options: str, episodes: int = 2, config: tuple[str, ...] = SMALL) -> int:
    fixed = ["--house", str(house), "--episodes", str(episodes), "--out", str(out), "--semantics", "gt"]
    return entry([*fixed, "--agent", agent, *options, "--config", *config])


def command(*words: object) -> str:
    return "process:" + shlex.join([sys.executable, *map(str, words)])


@pytest.mark.costly
def test_an_episode_in_which_the_agent_breaks_is_an_error_and_all_others_run(house: Path, tmp_path: Path) -> None:
    agent = command(CLIENT_AGENT, tmp_path / "broken")
    assert run(house, tmp_path / "run", agent, "--video", episodes=2) == 1
    broken, other = lines_of(tmp_path / "run")
    assert broken["end_reason"] == "error"
    reason = "its process ended with status 1 before it answered; the last lines of its standard error: The agent broke"
    assert broken["error"].endswith(f"step 4: {reason}")
    assert broken["num_steps"] == 3
    assert other["end_reason"] == "max_steps"
    assert all(line["isolated"] and not line["uses_ground_truth"] for line in (broken, other))
    with av.open(str(video_file(tmp_path / "run", other["episode_id"]))) as film:
        *_, last = (frame.to_ndarray(format="rgb24") for frame in film.decode(video=0))
    shown = last[334 + 148, 656 + 148].astype(int)  # the middle of the agent's map
    assert np.abs(shown - (200, 120, 5)).max() < 30


@pytest.mark.costly
def test_a_run_is_not_resumed_with_another_command_or_other_files(
    house: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    own = tmp_path / "agent.py"
    shutil.copy(CLIENT_AGENT, own)
    shutil.copy(ROOT / "sim" / "app" / "bridges" / "stubborn_client.py", tmp_path)
    text = own.read_text()
    assert run(house, tmp_path / "run", command(own), episodes=1) == 0
    assert run(house, tmp_path / "run", command(own), episodes=1) == 0  # nothing is left to run
    own.write_text(text + "\n# changed\n")
    assert run(house, tmp_path / "run", command(own), episodes=2) == 2
    assert "has changed since it ran 1 episode" in capsys.readouterr().err
    assert run(house, tmp_path / "run", command(own, "other"), episodes=2) == 2
    assert "holds a run with agent = " in capsys.readouterr().err
    assert run(house, tmp_path / "run", command(own), "--keep-results", episodes=2) == 0
    assert len(lines_of(tmp_path / "run")) == 2


def test_a_command_that_fails_is_one_line_and_leaves_no_run(
    house: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(house, tmp_path / "run", command("-c", "raise SystemExit('no torch here')"), episodes=1) == 2
    message = capsys.readouterr().err.splitlines()[-1]
    assert message.startswith("error: Agent 'process:")
    assert "ended with status 1 before it answered; the last lines of its standard error: no torch here" in message
    assert not (tmp_path / "run").exists()


@pytest.mark.costly
def test_an_agent_gets_step_timeout_and_true_images_when_the_command_line_says_so(house: Path, tmp_path: Path) -> None:
    own = tmp_path / "agent.py"
    shutil.copy(ROOT / "sim" / "app" / "bridges" / "stubborn_client.py", tmp_path)
    own.write_text("""
import sys, time
from stubborn_client import serve
class Agent:
    def reset(self, goal, seed): pass
    def act(self, observation):
        if len(sys.argv) > 1:
            time.sleep(60)
        raise KeyError(" ".join(sorted(observation)))
serve(Agent())
""")

    def keys(out: str, *config: str) -> Any:
        assert run(house, tmp_path / out, command(own), episodes=1, config=(*SMALL, *config)) == 1
        (line,) = lines_of(tmp_path / out)
        return line["error"].partition("KeyError: ")[2].split("'")[1], line["uses_ground_truth"]

    assert run(house, tmp_path / "slow", command(own, "slow"), "--step-timeout", "0.5", episodes=1) == 1
    assert lines_of(tmp_path / "slow")[0]["error"].endswith("step 1: no answer within 0.5 s")
    assert keys("plain") == ("compass depth gps objectgoal rgb", False)
    assert keys("truth", 'sensors=["rgb", "depth", "semantic"]') == ("compass depth gps objectgoal rgb semantic", True)


CHAINED = """
import json, sys
from stubborn_client import serve
class Agent:
    next_goal = (1.0, 2.0)  # a place on the agent's map
    def note(self, *words):
        with open(sys.argv[1], "a") as stream:
            stream.write(json.dumps(words) + "\\n")
    def reset(self, goal, seed):
        self.note("reset", goal, seed > 0)
    def act(self, observation):
        self.note(int(observation["objectgoal"][0]), bool(observation["goal_picture"].any()))
        return 0
class Remembering(Agent):
    def next_goal(self, goal):
        self.note("next", goal, True)
serve(KIND())
"""


@pytest.mark.parametrize(("kind", "call"), [("Agent", "reset"), ("Remembering", "next")])
def test_an_agent_gets_the_goals_of_a_chain_by_next_goal_or_is_reset(kind: str, call: str, tmp_path: Path) -> None:
    split, own, calls = tmp_path / "tiny", tmp_path / "agent.py", tmp_path / "calls"
    split.mkdir()
    (split / "home.xml").write_text(sofa_room().spec.to_xml())
    camera = PictureCamera(x_m=0.0, y_m=0.0, z_m=1.0, yaw_rad=0.0)
    goals = GoalSpec("sofa", "category"), GoalSpec("couch", "words", None, 0), GoalSpec("sofa_00", "picture", camera, 0)
    write_split(split, [Episode("one", "home", "sofa", Pose(0.0, 0.0, 0.0), None, goals)], {"home": {}}, version="1")
    shutil.copy(ROOT / "sim" / "app" / "bridges" / "stubborn_client.py", tmp_path)
    own.write_text(CHAINED.replace("KIND", kind))
    options = ["--split", str(split), "--episodes", "1", "--out", str(tmp_path / "run"), "--config", *SMALL]
    assert entry([*options, "--agent", command(own, calls)]) == 0
    assert [json.loads(line) for line in calls.read_text().splitlines()] == [
        ["reset", "sofa", True], [5, False], [call, "couch", True], [-1, False], [call, "", True], [-1, True],
    ]  # fmt: skip


@pytest.mark.slow
def test_each_worker_has_a_process_of_its_own_and_the_results_are_the_same(house: Path, tmp_path: Path) -> None:
    results = []
    for workers in ("1", "2"):
        out = tmp_path / workers
        options = ("--workers", workers, "--seed-key", "fixed")
        assert run(house, out, command(CLIENT_AGENT), *options, episodes=4) == 0
        results.append(lines_of(out))
    assert results[0] == results[1]
    assert len({json.dumps(line) for line in results[0]}) == 4
