"""Code written for Habitat runs unchanged behind the client file: scripts, classes, names, and one line on errors."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sim.app.bridges.habitat.stand_in import _FINDER
from sim.app.bridges.habitat_client import HABITAT_MODULES, _read_yaml
from sim.app.bridges.process import ProcessAgent
from sim.app.bridges.process_command import ProcessConfig
from sim.app.commands.agent_client import client_file
from sim.app.composition.setup import resolve
from sim.app.options import RunOptions
from sim.core.errors import AgentError, ConfigError
from sim.core.interface import Action, CameraModel, RobotModel, SuccessRule
from tests.helpers import wording
from tests.helpers.habitat_agents import Wanderer

OBSERVATION = {
    "rgb": np.zeros((3, 4, 3), np.uint8),
    "depth": np.ones((3, 4), np.float32),
    "gps": np.zeros(2, np.float32),
    "compass": np.zeros(1, np.float32),
    "objectgoal": np.zeros(1, np.int64),
}
PUBLISHED = """
import argparse
import os
import detectron2.data.transforms as T
import habitat
from detectron2.config import get_cfg
from habitat.config.default import get_config
from habitat.core.simulator import Observations
from habitat.sims.habitat_simulator.actions import HabitatSimActions


class Own(habitat.Agent):
    def __init__(self, args, task_config: habitat.Config, keep: float = 0.5):
        self.args, self.actions, self.keep = args, task_config.TASK.POSSIBLE_ACTIONS, keep
        self.width = task_config.SIMULATOR.RGB_SENSOR.WIDTH
        self.keep = task_config.OWN.KEEP if "OWN" in task_config else keep

    def reset(self) -> None:
        self.steps = 0

    def act(self, observations: Observations):
        self.steps += 1
        if self.args.break_at == self.steps:
            T.Resize(1)
        if self.steps == 1:
            return {"action": HabitatSimActions.TURN_LEFT if self.keep == 0.75 else 3}
        assert self.actions == ["STOP", "MOVE_FORWARD", "TURN_LEFT", "TURN_RIGHT"] and self.width == 4
        return {"action": self.actions[self.args.action]}


def get_args():
    parser = argparse.ArgumentParser()
    parser.add_argument("--action", type=int, default=1)
    parser.add_argument("--break-at", type=int, default=0)
    return parser.parse_args()


if __name__ == "__main__":
    config = get_config(os.environ["CHALLENGE_CONFIG_FILE"], overrides=["habitat.dataset.split=mine"])
    assert config.ENVIRONMENT.MAX_EPISODE_STEPS == 5 and config.habitat.dataset.split == "mine"
    assert config.OWN.KEEP == 0.75
    habitat.Challenge(eval_remote=False).submit(Own(get_args(), config))
"""
CONFIG = """
ENVIRONMENT: {MAX_EPISODE_STEPS: 7}
OWN: {KEEP: 0.75}
TASK: {POSSIBLE_ACTIONS: [STOP, MOVE_FORWARD, TURN_LEFT, TURN_RIGHT, LOOK_UP]}
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current folder, with the client file, a module `published` and its configuration file."""
    (tmp_path / "stubborn_client.py").write_text(client_file())
    (tmp_path / "published.py").write_text(PUBLISHED)
    (tmp_path / "task.yaml").write_text(CONFIG)
    monkeypatch.setenv("CHALLENGE_CONFIG_FILE", "task.yaml")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def start(words: str, **config: Any) -> ProcessAgent:
    """Returns the agent of `python stubborn_client.py WORDS`."""
    return ProcessAgent(
        [sys.executable, "stubborn_client.py", *shlex.split(words)],
        camera=CameraModel(width_px=4, height_px=3), robot=RobotModel(), success=SuccessRule(), max_steps=5,
        config=ProcessConfig(**{"interface": "habitat", **config}), step_timeout_s=20.0,
    )  # fmt: skip


def first_actions(words: str) -> list[Action]:
    agent = start(words)
    agent.reset("chair", 0)
    actions = [agent.act(OBSERVATION) for _ in range(2)]
    agent.close()
    return actions


@pytest.mark.usefixtures("folder")
def test_an_evaluation_script_and_a_class_run_unchanged() -> None:
    assert first_actions("published.py --action 2") == [Action.TURN_LEFT, Action.TURN_LEFT]
    made = "published:Own args=published:get_args() keep=0.75"
    assert first_actions(made) == [Action.TURN_LEFT, Action.MOVE_FORWARD]
    made = "published:Own args=published:get_args() task_config=task.yaml"
    assert first_actions(made) == [Action.TURN_LEFT, Action.MOVE_FORWARD]


@pytest.mark.usefixtures("folder")
def test_a_use_of_a_package_that_is_not_installed_is_an_error_that_names_it() -> None:
    agent = start("published.py --break-at 1")
    agent.reset("chair", 0)
    with pytest.raises(AgentError, match=r"'detectron2\.data\.transforms\.Resize'.*detectron2"):
        agent.act(OBSERVATION)
    agent.close()


@pytest.mark.costly
@pytest.mark.parametrize(
    ("words", "script", "reason"),
    [
        ("own.py", "import habitat.utils.visualizations", r"'habitat\.utils'"),
        ("own.py", "from habitat import make_dataset", r"'make_dataset'.*'habitat'"),
        ("own.py", "import habitat\nhabitat.Env()", wording.AN_AGENT_HAS_NO_EPISODES_OF_ITS_OWN),
        ("own.py", "import habitat\nhabitat.Challenge(eval_remote=True)", wording.THERE_IS_NO_EVALUATION_SERVER),
        ("own.py", "print('nothing')", r"'own\.py'.*habitat\.Benchmark.*habitat\.Challenge"),
        ("published:Own", "", r"1.*'args'"),
        ("", "", r"package\.module.*CLASS"),
    ],
)
def test_what_cannot_run_ends_with_one_line(folder: Path, words: str, script: str, reason: str) -> None:
    (folder / "own.py").write_text(script)
    with pytest.raises(ConfigError, match=reason):
        start(words)


def test_a_configuration_file_without_a_mapping_is_named(tmp_path: Path) -> None:
    (tmp_path / "task.yaml").write_text("- ENVIRONMENT")
    with pytest.raises(ValueError, match=r"task\.yaml' must hold a mapping, not a list\.$"):
        _read_yaml(str(tmp_path / "task.yaml"))


@pytest.mark.usefixtures("folder")
def test_the_interface_must_be_announced() -> None:
    with pytest.raises(ConfigError, match=r"Give --config agent\.interface=habitat"):
        start("published.py", interface="stubborn")


def test_the_bridge_provides_each_name_of_the_stand_in() -> None:
    names = {name for listed in HABITAT_MODULES.values() for name in listed.split()}
    assert names <= set(_FINDER._objects)


def test_true_images_for_an_agent_of_habitat_are_declared_with_its_sensors() -> None:
    name = f"habitat:{Wanderer.__module__}:{Wanderer.__name__}"
    assert not resolve(RunOptions(agent=name)).uses_ground_truth
    setup = resolve(RunOptions(agent=name, config=('sensors=["rgb", "depth", "semantic"]',)))
    assert setup.uses_ground_truth
