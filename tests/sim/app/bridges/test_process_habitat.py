"""Agents with Habitat's interface in a process of their own: the same results as in this process."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sim.app.bridges.habitat.conversions import to_action
from sim.app.bridges.process import ProcessAgent
from sim.app.bridges.process_command import ProcessConfig
from sim.app.bridges.stubborn_client import from_habitat
from sim.app.commands.agent_client import client_file
from sim.app.commands.run import entry
from sim.app.composition.environments import takes
from sim.app.composition.setup import resolve
from sim.app.options import RunOptions
from sim.core.errors import AgentError, ConfigError
from sim.core.geometry.pose import Pose
from sim.core.goals import GoalSpec
from sim.core.interface import CameraModel, RobotModel, SuccessRule
from sim.episodes.episode import Episode
from sim.task.trajectory import read_trajectory, trajectory_file
from tests.helpers.results import lines_of

ROOT = Path(__file__).parents[4]
CLIENT = ROOT / "sim" / "app" / "bridges" / "stubborn_client.py"
SMALL = ("camera.width_px=160", "camera.height_px=120", "task.max_steps=25")
OWN = """
import random
import sys
import numpy as np

class Own(object):
    def reset(self):
        self.turns = 0

    def act(self, observations):
        depth, gps = observations["depth"], observations["gps"]
        assert depth.shape == (120, 160, 1) and depth.dtype == np.float32 and 0.0 <= depth.min() <= depth.max() <= 1.0
        assert observations["objectgoal"].tolist() == [int(GOAL)]
        if depth[60, 50:110].min() < 0.15 or np.random.rand() < 0.2 or gps[1] > 1.0:
            self.turns += 1
            return {"action": random.choice(["TURN_LEFT", "turn_right"])}
        return {"action": {"action": 0 if self.turns > 12 else np.int64(1)}}

if __name__ == "__main__":
    from stubborn_client import serve
    serve(Own())
"""


def write_agent(folder: Path, goal_number: int) -> str:
    """Writes agent and client file; returns the name of the agent in its process."""
    (folder / "own_of_habitat.py").write_text(OWN.replace("GOAL", str(goal_number)))
    (folder / "stubborn_client.py").write_text(CLIENT.read_text())
    return f"process:{shlex.quote(sys.executable)} {shlex.quote(str(folder / 'own_of_habitat.py'))}"


def results(out: Path, house: Path, agent: str, *config: str) -> list[dict[str, Any]]:
    options = ["--house", str(house), "--goal", "sofa", "--episodes", "2", "--out", str(out), "--seed-key", "k"]
    options += ["--step-timeout", "0"]  # in this process
    assert entry([*options, "--agent", agent, "--config", *SMALL, *config]) == 0
    dropped = {"agent", "isolated"}
    return [{key: value for key, value in line.items() if key not in dropped} for line in lines_of(out)]


@pytest.mark.costly
def test_the_same_agent_gives_the_same_lines_in_this_process_and_in_its_own(
    house: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    own = write_agent(tmp_path, 5)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "own_of_habitat", raising=False)
    remote = results(tmp_path / "there", house, own, "agent.interface=habitat", "agent.categories=hm3d")
    here = results(tmp_path / "here", house, "habitat:own_of_habitat:Own", "agent.categories=hm3d")
    assert here == remote
    assert {line["end_reason"] for line in here} <= {"stop", "max_steps"}
    assert any(line["path_length"] > 0.5 for line in here)


FORMS: list[Any] = [
    0, 1, "stop", "MOVE_FORWARD", "turn_left", np.int64(3), np.array([2]), np.array(1), [1], ("turn_right",),
    {"action": 2}, {"action": "stop"}, {"action": {"action": "TURN_LEFT", "action_args": None}},
]  # fmt: skip


@pytest.mark.parametrize("chosen", FORMS, ids=repr)
def test_the_client_understands_an_action_as_the_bridge_does(chosen: Any) -> None:
    assert int(from_habitat(chosen)) == to_action(chosen)


def test_a_truth_value_is_no_action() -> None:
    with pytest.raises(TypeError, match="truth value"):
        from_habitat({"action": True})


def test_options_of_habitat_need_its_interface_and_choose_the_goals() -> None:
    with pytest.raises(ConfigError, match=r"need agent\.interface=habitat"):
        ProcessConfig(categories="hm3d")
    with pytest.raises(ConfigError, match="'gym'"):
        ProcessConfig(interface="gym")  # type: ignore[arg-type]
    setup = resolve(RunOptions(agent="process:true", config=("agent.interface=habitat", "agent.categories=hm3d")))
    assert setup.spec.goals is not None
    assert len(setup.spec.goals(setup.config.agent)) == 6


def test_an_agent_with_habitats_interface_gets_no_goals_in_words() -> None:
    episode = Episode("one", "home", "couch", Pose(0.0, 0.0, 0.0), None, (GoalSpec("couch", "words"),))
    takes_words = [
        takes(resolve(RunOptions(agent="process:true", config=(f"agent.interface={interface}",))), episode)
        for interface in ("stubborn", "habitat")
    ]
    assert takes_words == [True, False]


def test_a_goal_that_the_data_set_lacks_is_an_error_of_the_episode(tmp_path: Path) -> None:
    command = shlex.split(write_agent(tmp_path, 0).removeprefix("process:"))
    parts: dict[str, Any] = {"camera": CameraModel(), "robot": RobotModel(), "success": SuccessRule(), "max_steps": 5}
    agent = ProcessAgent(command, **parts, config=ProcessConfig(interface="habitat", categories="hm3d"))
    with pytest.raises(AgentError, match=r"'towel'.*hm3d"):
        agent.reset("towel", 0)
    agent.reset("bed", 0)
    agent.close()


LOOKS = """
from habitat import get_config

class Looks:
    def __init__(self):
        listed = get_config(None, ["TASK.POSSIBLE_ACTIONS", ["STOP", "LOOK_UP", "FLY"]]).TASK.POSSIBLE_ACTIONS
        self.chosen = ["LOOK_UP", {"action": 5}, "look_down", 0] if "LOOK_UP" in listed else [4]
        assert "FLY" not in listed

    def reset(self):
        self.left = list(self.chosen)

    def act(self, observations):
        return self.left.pop(0)
"""
PLAIN = """
from stubborn_client import serve

class Looks:
    def __init__(self, setup):
        self.chosen = [4, 5, 5, 0] if setup.looks else [4]

    def reset(self, goal, seed):
        self.left = list(self.chosen)

    def act(self, observation):
        return self.left.pop(0)

serve(Looks)
"""


@pytest.mark.costly
@pytest.mark.parametrize("declared", [True, False])
@pytest.mark.parametrize("kind", ["habitat", "habitat in a process", "process"])
def test_looks_are_actions_of_agents_that_declare_them_by_an_option(
    kind: str, declared: bool, house: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "stubborn_client.py").write_text(client_file())
    (tmp_path / "plain.py").write_text(PLAIN)
    (tmp_path / "own_looks.py").write_text(LOOKS)
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "own_looks", raising=False)
    agent, *more = {
        "habitat": ("habitat:own_looks:Looks",),
        "habitat in a process": (
            f"process:{sys.executable} stubborn_client.py own_looks:Looks",
            "agent.interface=habitat",
        ),
        "process": (f"process:{sys.executable} plain.py",),
    }[kind]
    options = ["--house", str(house), "--episodes", "1", "--out", "run", "--step-timeout", "0", "--record"]
    config = [*SMALL, *more, *(["agent.looks=true"] if declared else [])]
    status = entry([*options, "--agent", agent, "--config", *config])
    (line,) = lines_of(tmp_path / "run")
    if declared:
        trajectory = read_trajectory(trajectory_file(tmp_path / "run", line["episode_id"]))
        assert (status, trajectory.actions.tolist()) == (0, [4, 5, 5, 0])
    else:
        assert (status, line["end_reason"]) == (1, "error")
        assert "agent.looks=true" in line["error"]
