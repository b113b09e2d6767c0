"""Habitat's evaluation loop over our episodes: the same episodes and metrics as a run, with Habitat's names."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sim.app.bridges.habitat import Benchmark, Challenge, Config, Env, RLEnv, get_config, stand_in
from sim.app.bridges.habitat.config import settings_of
from sim.app.bridges.habitat.env import default_options
from sim.app.commands.main import entry as stubborn
from sim.app.composition.environments import episodes_of
from sim.app.composition.setup import resolve
from sim.app.evaluation.rollout import play_episode
from sim.app.options import RunOptions
from sim.core.errors import AgentError, ConfigError, EpisodeError
from sim.core.geometry.pose import Pose
from sim.core.interface import Action
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.episode import Episode
from sim.episodes.habitat import to_agent_state
from sim.episodes.seeds import episode_seeds
from sim.episodes.splits import write_split
from tests.helpers import wording
from tests.helpers.habitat_agents import Wanderer
from tests.helpers.runners import Script
from tests.helpers.worlds import sofa_room, with_box

SMALL = {"width_px": 64, "height_px": 48}
BOMB = "a: &a [1, 1, 1, 1, 1, 1, 1, 1, 1]\n" + "".join(
    f"{now}: &{now} [{', '.join([f'*{before}'] * 9)}]\n" for before, now in ("ab", "bc", "cd", "de")
)
"""YAML whose aliases stand for many values."""
SCRIPT = """
import argparse
import habitat
from habitat.sims.habitat_simulator.actions import HabitatSimActions

parser = argparse.ArgumentParser()
parser.add_argument("--steps", type=int)
args = parser.parse_args()


class Forward(habitat.Agent):
    def reset(self):
        self.steps = 0

    def act(self, observations):
        self.steps += 1
        return HabitatSimActions.stop if self.steps > args.steps else HabitatSimActions.move_forward


config = habitat.get_config("benchmark/nav/objectnav.yaml")
config.SIMULATOR.RGB_SENSOR.WIDTH = config.SIMULATOR.DEPTH_SENSOR.WIDTH = 64
env = habitat.Env(config=config)
agent = Forward()
observations = env.reset()
agent.reset()
while not env.episode_over:
    observations = env.step(agent.act(observations))
habitat.logger.info("ends")
print(env.current_episode.object_category, observations["rgb"].shape, env.get_metrics()["num_steps"])
"""


@pytest.fixture(autouse=True)
def _no_stand_in_remains() -> Iterator[None]:
    yield
    stand_in.remove()


@pytest.fixture
def env(house: Path) -> Iterator[Env]:
    with Env(house=house, episodes=2, camera=SMALL, max_steps=5) as env:
        yield env


@pytest.fixture
def split(house: Path, tmp_path: Path) -> Path:
    """A split of one house with three episodes, the second of which asks for a category that HM3D lacks."""
    folder = tmp_path / "mine"
    folder.mkdir()
    world = sofa_room()
    text = with_box(world, "table_00", centre_m=(-2.5, 0, 0.4), half_m=(0.3, 0.3, 0.4)).spec.to_xml()
    (folder / "sofa_room.xml").write_text(text)
    start = Pose(-1.0, 0.0, 0.5)
    episodes = [Episode(f"mine_{i}", "sofa_room", goal, start, 2.0) for i, goal in enumerate(("sofa", "table", "sofa"))]
    state = to_agent_state(start)
    goal = {"object_id": "sofa_00", "object_category": "sofa", "position": [2.5, 0.4, 0.0]}
    goal["view_points"] = [{"agent_state": state, "iou": None}]
    write_split(folder, episodes, {"sofa_room": {"sofa": [goal]}}, version="1")
    return folder


def test_an_agent_that_turns_if_more_than_half_a_turn_is_missing_does_not_swing(split: Path) -> None:
    with Env(split=split, camera=SMALL) as env:
        env.reset()
        env.step("turn_right")
        observations = env.step("turn_right")
        turns = []
        for _ in range(8):  # to 45 degrees on the right: half a turn is missing at 60 and at 30 degrees
            missing_deg = -45.0 - math.degrees(float(observations["compass"][0]))
            turns.append("turn_right" if missing_deg < -15.001 else "turn_left" if missing_deg > 15.001 else None)
            if turns[-1] is None:
                break
            observations = env.step(turns[-1])
    assert turns == [None]


def test_a_loop_gives_the_metrics_of_a_run_with_habitats_names(split: Path) -> None:
    actions = [Action.MOVE_FORWARD, Action.TURN_LEFT, Action.MOVE_FORWARD, Action.STOP]
    with Env(split=split, episodes=2, camera=SMALL) as env:
        env.reset()
        observations = env.reset()
        for action in actions:
            assert not env.episode_over
            observations = env.step({"action": int(action)})
        assert env.episode_over
        metrics, episode = env.get_metrics(), env.current_episode
        with pytest.raises(EpisodeError, match="has ended"):
            env.step(0)
    own = ObjectNavEnv(split=split, camera=SMALL, sensors=("depth",))
    line = play_episode(
        own,
        Script(actions),
        own.split.episode(episode.episode_id),
        seed=episode_seeds(0, episode.episode_id).environment,
    )
    own.close()
    assert (metrics["spl"], metrics["success"], metrics["num_steps"]) == (line.spl, line.success, line.num_steps)
    assert metrics["distance_to_goal"] == pytest.approx(line.distance_to_goal)
    assert metrics["softspl"] == metrics["soft_spl"] == pytest.approx(line.soft_spl)
    assert metrics["collisions"] == {"count": line.collisions, "is_collision": False}
    assert observations["gps"].shape == (2,)


def test_an_environment_with_rewards_extends_the_base_class(house: Path) -> None:
    class Moved(RLEnv):
        def get_reward(self, observations: Any) -> float:
            return float(observations["gps"][0])

        def get_done(self, observations: Any) -> bool:
            return self._env.episode_over

        def get_info(self, observations: Any) -> dict[str, Any]:
            return self.habitat_env.get_metrics()

    with Moved(house=house, episodes=1, camera=SMALL, max_steps=2) as env:
        env.reset()
        observations, reward, done, info = env.step({"action": 1})
        assert (reward, done, info["num_steps"]) == (observations["gps"][0], False, 1)
        assert env.step(action="turn_left")[2]
        with pytest.raises(NotImplementedError):
            env.get_reward_range()


def test_episodes_have_habitats_fields_and_come_in_the_order_of_the_split(split: Path) -> None:
    with Env(split=split, camera=SMALL, categories="hm3d") as env:
        assert env.number_of_episodes == 2
        assert [episode.episode_id for episode in env.episodes] == ["mine_0", "mine_2"]
        assert env.current_episode.episode_id == "mine_0"
        assert env.reset()["objectgoal"].tolist() == [5]
        episode = env.current_episode
        assert (episode.scene_id, episode.goals_key) == ("mjcf_houses/mine/sofa_room.xml", "sofa_room.xml_sofa")
        assert [goal.object_category for goal in episode.goals] == [episode.object_category]
        assert episode.goals[0].view_points[0].agent_state.position == episode.start_position
        np.testing.assert_allclose(env.sim.get_agent_state().position, episode.start_position, atol=1e-3)
    with pytest.raises(ConfigError, match=wording.EPISODES_MUST_BE_1_TO_3_GOT_4):
        Env(split=split, episodes=4)
    for options in ({"split": split, "episodes": 0}, {"house": split / "sofa_room.xml", "episodes": -1}):
        with pytest.raises(ConfigError, match=wording.EPISODES_MUST_BE_AT_LEAST_1_GOT):
            Env(**options)


def test_a_run_of_an_agent_with_six_categories_has_only_their_episodes(split: Path) -> None:
    def planned(*config: str, only: tuple[str, ...] = ()) -> list[str]:
        agent = f"habitat:{Wanderer.__module__}:Wanderer"
        options = RunOptions(agent=agent, split=str(split), episodes=2, only=only, config=config)
        return [episode.episode_id for episode in episodes_of(resolve(options))[0]]

    assert planned() == ["mine_0", "mine_1"]
    assert planned("agent.categories=hm3d") == ["mine_0", "mine_2"]
    with pytest.raises(ConfigError, match=wording.NO_SUCH_EPISODE):
        planned("agent.categories=hm3d", only=("mine_1",))


def test_observations_lie_in_the_space_and_the_episodes_repeat(env: Env) -> None:
    first = [env.reset(), env.current_episode.episode_id]
    assert env.observation_space.contains(dict(first[0]))
    env.reset()
    assert env.current_episode.episode_id != first[1]
    env.reset()
    assert env.current_episode.episode_id == first[1]
    assert not env.sim.previous_step_collided


def test_the_limit_of_steps_ends_an_episode_and_a_wrong_action_is_named(env: Env) -> None:
    env.reset()
    for _ in range(5):
        env.step("turn_left")
    assert env.episode_over
    env.reset()
    with pytest.raises(AgentError, match="'fly'"):
        env.step("fly")


def test_a_benchmark_returns_the_mean_of_each_metric(house: Path) -> None:
    benchmark = Benchmark(None, house=house, episodes=2, camera=SMALL)
    means = benchmark.evaluate(Wanderer(stop_after=2))
    assert means["num_steps"] == 3.0
    assert {"success", "spl", "softspl", "distance_to_goal", "collisions/count", "collisions/is_collision"} <= set(
        means
    )
    with pytest.raises(ConfigError, match=r"num_episodes must be 1 to 2, got 3"):
        benchmark.evaluate(Wanderer(), num_episodes=3)
    with pytest.raises(ConfigError, match=wording.NO_EVALUATION_SERVER):
        Challenge(eval_remote=True)


def test_two_agents_of_a_benchmark_are_measured_on_the_same_episodes(
    house: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    benchmark = Benchmark(None, house=house, episodes=3, camera=SMALL)
    begun: list[str] = []
    reset = Env.reset

    def noted(env: Env) -> Any:
        observations = reset(env)
        begun.append(env.current_episode.episode_id)
        return observations

    monkeypatch.setattr(Env, "reset", noted)
    for _ in range(2):
        benchmark.evaluate(Wanderer(stop_after=0), num_episodes=2)
    assert begun[:2] == begun[2:]


def test_metrics_before_the_first_episode_are_refused(env: Env) -> None:
    with pytest.raises(EpisodeError, match=wording.CALL_RESET_FIRST):
        env.get_metrics()


@pytest.mark.parametrize("position", [0.9, [0.1, 0.9, 0], [0.9], "high"])
def test_a_camera_off_the_axis_is_refused(house: Path, position: Any) -> None:
    with pytest.raises(ConfigError, match="POSITION"):
        Env(house=house, position=position)


def test_what_habitats_environment_has_and_this_one_lacks_is_said_with_what_there_is(split: Path) -> None:
    with Env(split=split, camera=SMALL) as env:
        with pytest.raises(AttributeError, match=r"^Env.*'task'.*current_episode"):
            _ = env.task
        with pytest.raises(AttributeError, match=r"^Env\.sim.*'pathfinder'"):
            _ = env.sim.pathfinder
        assert not hasattr(env, "task")
        with pytest.raises(AgentError, match=r"^Unknown.*'fly'.*0"):
            env.step("fly")


def test_a_mistyped_configuration_is_refused_and_one_of_habitats_is_not(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "configs").mkdir()
    monkeypatch.chdir(tmp_path)
    for path in ("configs/none.yaml", str(tmp_path / "none.yaml")):
        with pytest.raises(ConfigError, match=r"^There.*'.*none\.yaml'.*folder\.$"):
            get_config(path)
    assert get_config("benchmark/nav/objectnav/objectnav_hm3d.yaml") == get_config()
    assert get_config().habitat.environment.iterator_options.shuffle is False
    assert get_config().habitat.task.measurements.success.success_distance == 1.0
    with pytest.raises(AttributeError, match=r"no 'x' here\. It is empty\.$"):
        _ = get_config().habitat.task.measurements.spl.x


def test_a_configuration_file_of_either_layout_sets_split_steps_and_camera(tmp_path: Path) -> None:
    old, new = tmp_path / "old.yaml", tmp_path / "new.yaml"
    old.write_text(
        "ENVIRONMENT: {MAX_EPISODE_STEPS: 30}\nSIMULATOR: {RGB_SENSOR: {WIDTH: 64}, DEPTH_SENSOR: {WIDTH: 64}}\n"
        "TASK: {POSSIBLE_ACTIONS: [STOP, MOVE_FORWARD, LOOK_UP]}\n"
    )
    new.write_text("habitat:\n  dataset: {split: test}\n  task: {actions: {look_up: {}, stop: {}}}\n")
    config = get_config(str(old))
    assert settings_of(config) == {"max_steps": 30, "width_px": 64}
    assert config.TASK.POSSIBLE_ACTIONS == ["STOP", "MOVE_FORWARD"]
    config = get_config([str(new)], ["habitat.environment.max_episode_steps=9"])
    assert settings_of(config) == {"split": "test", "max_steps": 9}
    assert set(config.habitat.task.actions) == {"stop", "move_forward", "turn_left", "turn_right"}
    copy = config.clone()
    copy.habitat.dataset.split = "val"
    assert config.habitat.dataset.split == "test"
    with pytest.raises(AttributeError, match=r"has no 'TASKS' here\. It has: ENVIRONMENT, SIMULATOR, TASK"):
        _ = config.TASKS


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("- 1\n", wording.MUST_BE_A_MAPPING),
        ("a: [", "YAML"),
        (BOMB, "more than"),
        ("!!python/object/apply:os.system ['true']", "YAML"),
    ],
)  # fmt: skip
def test_a_configuration_file_that_is_none_is_refused_in_one_line(tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "broken.yaml").write_text(text)
    with pytest.raises(ConfigError, match=message) as caught:
        get_config(str(tmp_path / "broken.yaml"))
    assert "\n" not in str(caught.value)


def test_the_images_have_one_camera() -> None:
    config = get_config()
    config.SIMULATOR.RGB_SENSOR.WIDTH, config.SIMULATOR.DEPTH_SENSOR.WIDTH = 64, 32
    with pytest.raises(ConfigError, match=r"RGB_SENSOR\.WIDTH=64.*DEPTH_SENSOR\.WIDTH=32"):
        Env(config)
    with pytest.raises(ConfigError, match="Unknown split 'val_mini'"):
        Env(Config(DATASET=Config(SPLIT="val_mini")))
    with default_options(split="nowhere"), pytest.raises(ConfigError, match="Unknown split 'nowhere'"):
        Env()


@pytest.mark.parametrize(
    "overrides",
    [
        ["SIMULATOR.DEPTH_SENSOR.NORMALIZE_DEPTH", "False", "ENVIRONMENT.MAX_EPISODE_STEPS", "100"],
        ["SIMULATOR.DEPTH_SENSOR.NORMALIZE_DEPTH=False", "ENVIRONMENT.MAX_EPISODE_STEPS=100"],
        ["SIMULATOR.DEPTH_SENSOR.NORMALIZE_DEPTH=false", "ENVIRONMENT.MAX_EPISODE_STEPS", 100],
    ],
)
def test_overrides_have_values_of_python_and_of_json(overrides: list[Any]) -> None:
    assert settings_of(get_config(None, overrides)) == {"normalize_depth": False, "max_steps": 100}
    config = get_config(None, ["TASK.A=None", "TASK.B=null", "TASK.C=['x']", "TASK.D=3.0.0", "TASK.E", "some text"])
    assert [config.TASK[name] for name in "ABCDE"] == [None, None, ["x"], "3.0.0", "some text"]


def test_the_tree_under_habitat_is_a_configuration_and_an_unknown_tree_is_none() -> None:
    config = get_config(None, ["habitat.environment.max_episode_steps=9"])
    assert settings_of(config.habitat) == settings_of(config) == {"max_steps": 9}
    with pytest.raises(ConfigError, match=r"ENVIRONMENT.*TASK_CONFIG\.$"):
        settings_of(Config(TASK_CONFIG=config))
    with pytest.raises(ConfigError, match=r"SPLIT=.*'a'.*habitat\.dataset\.split=.*'b'"):
        settings_of(get_config(None, ["DATASET.SPLIT=a", "habitat.dataset.split=b"]))


def test_entries_of_a_configuration_that_change_nothing_are_named(
    house: Path, caplog: pytest.LogCaptureFixture
) -> None:
    config = get_config(None, ["SIMULATOR.TURN_ANGLE=15", "SIMULATOR.RGB_SENSORR.WIDTH=64", "TASK.SEED=1"])
    Env(config, house=house, episodes=1).close()
    said = [record.getMessage() for record in caplog.records]
    assert "These entries of the configuration have no effect: SIMULATOR.TURN_ANGLE=15 (here 30)." in said
    assert "These entries of the configuration are unknown here: SIMULATOR.RGB_SENSORR.WIDTH, TASK.SEED." in said
    caplog.clear()
    Env(get_config(None, ["ENVIRONMENT.MAX_EPISODE_STEPS=9"]), house=house, episodes=1).close()
    assert not caplog.records


def test_a_script_may_choose_episodes_and_give_a_benchmark_its_configuration(split: Path) -> None:
    with Env(split=split, camera=SMALL) as env:
        chosen = env.episodes[::-1][:2]
        env.episodes = chosen
        env.reset()
        assert (env.current_episode.episode_id, env.number_of_episodes) == (chosen[0].episode_id, 2)
        with pytest.raises(ConfigError, match=r"env\.episodes"):
            env.episodes = []
    config = get_config(None, ["ENVIRONMENT.MAX_EPISODE_STEPS=2"])
    assert Benchmark(config, split=split, camera=SMALL).evaluate(Wanderer(), 1)["num_steps"] == 2.0


def test_an_observation_that_is_not_there_is_named_with_those_that_are(env: Env) -> None:
    with pytest.raises(KeyError, match=r"no observation 'objectgoals'; there are .*objectgoal"):
        env.reset()["objectgoals"]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"episodes": "3"}, "episodes must be an integer, got '3'"),
        ({"seed": "x"}, "seed must be an integer, got 'x'"),
        ({"camera": 3}, "camera must be a CameraModel or a dict"),
        ({"hfov_deg": True}, "hfov_deg must be a number, got True"),
        ({"normalize_depth": "no"}, "normalize_depth must be True or False"),
    ],
)
def test_an_option_of_another_type_is_refused(options: dict[str, Any], message: str) -> None:
    with pytest.raises(ConfigError, match=f"^{message}"):
        Env(**options)


def test_no_path_to_the_goal_is_an_infinite_distance(env: Env) -> None:
    env.reset()
    env._info["distance_to_goal"] = None
    assert env.get_metrics()["distance_to_goal"] == math.inf


def test_a_script_runs_with_its_arguments(house: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "evaluate.py").write_text(SCRIPT)
    assert stubborn(["habitat", f"{tmp_path / 'evaluate.py'} --steps 2", "--house", str(house), "--episodes", "1"]) == 0
    printed = capsys.readouterr()
    assert printed.out == "sofa (480, 64, 3) 3\n"
    assert stand_in.NOTE in printed.err
    assert printed.err.endswith("ends\n")


@pytest.mark.parametrize(
    ("text", "status", "message"),
    [
        ("import habitat.datasets", 2, "'habitat.datasets' is not part of the stand-in"),
        ("1 / 0", 2, "script.py': ZeroDivisionError: division by zero (test_an_error"),
        ("raise SystemExit(3)", 3, ""),
        ("raise SystemExit('No weights.')", 1, "No weights."),
        ("def f(:", 2, "SyntaxError"),
        (None, 2, "There is no script"),
    ],
)
def test_an_error_of_a_script_is_one_line(
    tmp_path: Path, text: str | None, status: int, message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "script.py"
    if text is not None:
        file.write_text(text)
    assert stubborn(["habitat", str(file)]) == status
    printed = capsys.readouterr().err.removeprefix(stand_in.NOTE + "\n")
    assert message in printed
    assert printed.count("\n") <= 1


def test_metrics_are_numbers_that_json_can_hold(env: Env) -> None:
    env.reset()
    assert json.loads(json.dumps(env.get_metrics())) == env.get_metrics()
