"""LeRobot itself with a dataset and the environment of this project, in the environment of docs/lerobot.md."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("lerobot", reason="lerobot is not installed")
pytest.importorskip("lerobot_env_stubborn", reason="the plugin is not installed")

from lerobot.configs.types import FeatureType
from lerobot.datasets.lerobot_dataset import LeRobotDataset
from lerobot.datasets.utils import dataset_to_policy_features
from lerobot.envs.configs import EnvConfig
from lerobot.envs.factory import make_env
from lerobot.envs.utils import (
    add_envs_task,
    check_env_attributes_and_types,
    env_to_policy_features,
    preprocess_observation,
)

from sim.app.commands.export import lerobot as export
from tests.helpers.submissions import recorded, tiny_split


def test_lerobot_reads_an_export_and_the_environment_has_its_features(tmp_path: Path) -> None:
    split = tiny_split(tmp_path)
    recorded(split, tmp_path / "run", "oracle", episodes=2)
    assert export.main(export.Args(run=tmp_path / "run", out=tmp_path / "data", width_px=64)) == 0
    dataset = LeRobotDataset("local/tiny", root=tmp_path / "data", video_backend="pyav")
    assert dataset.num_episodes == 2
    assert dataset.meta.tasks.index.tolist() == ["find a sofa"]
    assert len(dataset) == len(dataset.hf_dataset) == sum(dataset.meta.episodes["length"])
    assert np.array(dataset.hf_dataset["action"]).sum(axis=1).tolist() == [1.0] * len(dataset)
    of_data = dataset_to_policy_features(dataset.meta.features)
    config = EnvConfig.get_choice_class("stubborn")(split=str(split), width_px=64)
    of_env = env_to_policy_features(config)
    assert {name: of_env[name].shape for name in of_env} == {
        name: feature.shape for name, feature in of_data.items() if feature.type is not FeatureType.REWARD
    }


def test_lerobot_makes_the_environment_and_understands_its_observations(tmp_path: Path) -> None:
    config = EnvConfig.get_choice_class("stubborn")(split=str(tiny_split(tmp_path)), width_px=64, max_steps=3)
    env = make_env(config, n_envs=1)["stubborn"][0]
    check_env_attributes_and_types(env)
    assert env.call("_max_episode_steps") == (3,)
    observation, _ = env.reset(seed=[5])
    seen = add_envs_task(env, preprocess_observation(observation))
    assert seen["task"] == ["find a sofa"]
    shapes = {name: tuple(value.shape) for name, value in seen.items() if name != "task"}
    assert shapes == {
        name: (1, *feature.shape) for name, feature in env_to_policy_features(config).items() if name != "action"
    }
    for _ in range(3):
        *_, truncated, info = env.step(np.array([[0.0, 0.0, 1.0, 0.0]], np.float32))
    assert truncated.tolist() == [True]
    assert info["final_info"]["is_success"].tolist() == [False]
    env.close()
