"""Each episode gives one line, even where the physics fail."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from sim.env.objectnav import ObjectNavEnv
from sim.episodes.splits import Episode
from sim.evaluation.results import summarise
from sim.evaluation.rollout import episode_seed, play_episode
from sim.geometry.pose import Pose
from sim.interface import Action, CameraModel
from tests.helpers.worlds import ledge, room, with_box

SMALL = CameraModel(width_px=64, height_px=48)
EPISODE = Episode("sofa_room_0", "sofa_room", "sofa", Pose(-1.0, 0.0, 0.0))


class Script:
    """An agent that reads its actions from a list."""

    def __init__(self, actions: list[Action]) -> None:
        self.actions = actions

    def reset(self, goal: str, seed: int) -> None:
        self.goal, self.left = goal, list(self.actions)

    def act(self, observation: object) -> Action:
        return self.left.pop(0)


@pytest.fixture
def env(tmp_path) -> Iterator[ObjectNavEnv]:
    file = tmp_path / "sofa_room.xml"
    file.write_text(with_box(room(6, 6), "sofa_00", centre_m=(2.5, 0, 0.4), half_m=(0.4, 0.8, 0.4)).spec.to_xml())
    env = ObjectNavEnv(house=file, sensors=("depth",), camera=SMALL)
    yield env
    env.close()


def test_a_finished_episode_is_a_line_that_json_can_hold(env: ObjectNavEnv) -> None:
    line = play_episode(env, Script([Action.MOVE_FORWARD, Action.STOP]), EPISODE, seed=0)
    assert json.loads(json.dumps(line, allow_nan=False)) == line
    assert (line["end_reason"], line["num_steps"], line["success"]) == ("stop", 2, 0.0)
    assert line["path_length"] == pytest.approx(0.25, abs=0.01)


def test_a_state_that_is_not_finite_ends_the_episode_as_an_error_that_names_house_and_step(env: ObjectNavEnv) -> None:
    def break_it(step: int, agent: object, info: dict) -> None:
        if step == 2:
            env.scene.world.data.qvel[:] = np.nan

    line = play_episode(env, Script([Action.MOVE_FORWARD] * 5), EPISODE, seed=0, on_step=break_it)
    assert line["end_reason"] == "error"
    assert line["success"] == 0.0
    assert line["failure"] == "misc"
    assert "sofa_room" in line["error"]
    assert "Step 3" in line["error"]


def test_the_episode_after_a_broken_one_is_as_if_nothing_had_been(env: ObjectNavEnv) -> None:
    def break_it(step: int, agent: object, info: dict) -> None:
        env.scene.world.data.qvel[:] = np.nan

    script = Script([Action.MOVE_FORWARD, Action.TURN_LEFT, Action.STOP])
    times = ("wall_time_s", "steps_per_s")
    before, _, after = (
        play_episode(env, script, EPISODE, seed=0, on_step=on_step) for on_step in (None, break_it, None)
    )
    assert {k: v for k, v in before.items() if k not in times} == {k: v for k, v in after.items() if k not in times}


def test_an_agents_seed_depends_on_run_and_episode_only() -> None:
    seeds = {episode_seed(run, name) for run in (0, 1) for name in ("a", "b")}
    assert len(seeds) == 4
    assert episode_seed(1, "a") == episode_seed(1, "a")


def test_a_fall_is_a_line_and_no_error(tmp_path) -> None:
    file = tmp_path / "ledge.xml"
    file.write_text(ledge(0.6).spec.to_xml())
    env = ObjectNavEnv(house=file, sensors=("depth",), camera=SMALL)
    episode = replace(EPISODE, house="ledge", goal="bed", start=Pose(-0.4, 0.0, 0.0))
    line = play_episode(env, Script([Action.MOVE_FORWARD] * 5), episode, seed=0)
    env.close()
    assert (line["end_reason"], line["failure"], line["num_steps"]) == ("fallen", "stairs", 2)
    assert "error" not in line
    assert summarise([line])["falls"] == 1
