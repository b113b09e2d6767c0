"""With the real habitat-lab; `make test-habitat` runs them in its environment, other test runs leave them out."""

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

habitat = pytest.importorskip("habitat")

import stubborn_habitat  # noqa: E402
from sim.core.errors import ConfigError  # noqa: E402
from sim.env.objectnav import ObjectNavEnv  # noqa: E402

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.fixture(scope="module")
def env() -> Iterator[Any]:
    with habitat.Env(
        stubborn_habitat.get_config("val", ["habitat.environment.iterator_options.shuffle=False"])
    ) as made:
        yield made


def test_the_simulator_is_habitat_labs_own(env: Any) -> None:
    from habitat.sims.habitat_simulator.habitat_simulator import HabitatSim

    assert type(env.sim) is HabitatSim
    assert env.task.__class__.__module__.startswith("habitat.")


def test_observations_have_habitats_spaces(env: Any) -> None:
    observations = env.reset()
    assert env.observation_space.contains(dict(observations))
    assert observations["rgb"].std() > 1.0
    assert 0.0 <= observations["depth"].min() < observations["depth"].max() <= 1.0


def test_the_same_actions_give_the_metrics_of_this_project(env: Any) -> None:
    ours = ObjectNavEnv(split="val", sensors=())
    for seed in range(3):
        env.reset()
        info = ours.reset(options={"episode_id": env.current_episode.info["stubborn_id"]})[1]
        rng = np.random.default_rng(seed)
        for action in [*rng.integers(1, 4, 20).tolist(), 0]:
            env.step(action)
            info = ours.step(action)[4]
        lab = env.get_metrics()
        for name in ("success", "spl", "soft_spl", "distance_to_goal"):
            assert lab[name] == pytest.approx(info[name], abs=1e-3), name
    ours.close()


def test_the_shortest_path_follower_succeeds(env: Any) -> None:
    from habitat.tasks.nav.shortest_path_follower import ShortestPathFollower

    env.reset()
    follower = ShortestPathFollower(env.sim, 0.1, False)
    points = [v.agent_state.position for g in env.current_episode.goals for v in g.view_points]
    start = env.sim.get_agent_state().position
    nearest = min(points, key=lambda point: env.sim.geodesic_distance(start, [point]))
    while not env.episode_over:
        env.step(follower.get_next_action(nearest))
    assert env.get_metrics()["success"] == 1.0
    assert env.get_metrics()["spl"] > 0.6


def test_users_register_sensors_measures_actions_and_data_sets() -> None:
    from gym import spaces
    from habitat.config.default_structured_configs import ActionConfig, LabSensorConfig, MeasurementConfig
    from habitat.core.registry import registry
    from habitat.core.simulator import Sensor, SensorTypes
    from habitat.datasets.object_nav.object_nav_dataset import ObjectNavDatasetV1

    @registry.register_sensor(name="Height")
    class Height(Sensor):
        cls_uuid = "height"

        def __init__(self, sim: Any, config: Any, **_: Any) -> None:
            self._sim = sim
            super().__init__(config=config)

        def _get_uuid(self, *_: Any, **__: Any) -> str:
            return self.cls_uuid

        def _get_sensor_type(self, *_: Any, **__: Any) -> Any:
            return SensorTypes.POSITION

        def _get_observation_space(self, *_: Any, **__: Any) -> Any:
            return spaces.Box(-10.0, 10.0, (1,), np.float32)

        def get_observation(self, *_: Any, **__: Any) -> Any:
            return np.array([self._sim.get_agent_state().position[1]], np.float32)

    @registry.register_measure(name="Turns")
    class Turns(habitat.Measure):
        def __init__(self, *_: Any, **__: Any) -> None:
            super().__init__()

        def _get_uuid(self, *_: Any, **__: Any) -> str:
            return "turns"

        def reset_metric(self, *_: Any, **__: Any) -> None:
            self._metric = 0

        def update_metric(self, *_: Any, action: Any, **__: Any) -> None:
            self._metric += action["action"] in (2, 3, "turn_left", "turn_right", "turn_around")

    @registry.register_task_action(name="TurnAround")
    class TurnAround(habitat.core.embodied_task.SimulatorTaskAction):
        def step(self, *_: Any, **__: Any) -> Any:
            for _turn in range(6):
                seen = self._sim.step(2)
            return seen

    @registry.register_dataset(name="OneScene")
    class OneScene(ObjectNavDatasetV1):
        def __init__(self, config: Any = None) -> None:
            whole = registry.get_dataset("stubborn-val")(config)
            vars(self).update(vars(whole))
            self.episodes = [episode for episode in whole.episodes if episode.scene_id.endswith("val_03.xml")]

    config = stubborn_habitat.get_config("val")
    with habitat.config.read_write(config):
        config.habitat.task.lab_sensors.height = LabSensorConfig(type="Height")
        config.habitat.task.measurements.turns = MeasurementConfig(type="Turns")
        config.habitat.task.actions.turn_around = ActionConfig(type="TurnAround")
        config.habitat.dataset.type = "OneScene"
    with habitat.Env(config) as env:
        before = env.reset()
        assert env.current_episode.scene_id.endswith("val_03.xml")
        assert before["height"] == pytest.approx([0.0], abs=0.05)
        after = env.step("turn_around")
        turned = abs(float(after["compass"][0] - before["compass"][0]))
        assert turned == pytest.approx(np.pi, abs=0.05)
        assert env.get_metrics()["turns"] == 1


def test_goals_in_words_are_seen_as_clip_objectgoal_and_judged(tmp_path: Path) -> None:
    few = ["habitat.environment.iterator_options.shuffle=False", "habitat.dataset.content_scenes=['val_00']"]
    with habitat.Env(stubborn_habitat.get_config("words-seen", few)) as env:
        observations = env.reset()
        words = env.current_episode.object_category
        assert (observations["clip_objectgoal"], "objectgoal" in observations) == (words, False)
        assert env.observation_space.contains(dict(observations))
        ours = ObjectNavEnv(split="words-seen", sensors=())
        info = ours.reset(options={"episode_id": env.current_episode.info["stubborn_id"]})[1]
        assert (info["goal"], info["distance_to_goal"]) == (words, pytest.approx(env.get_metrics()["distance_to_goal"]))
        ours.close()
        env.step("stop")
        assert (env.get_metrics()["success"], env.get_metrics()["spl"]) == (0.0, 0.0)
        texts = sorted({episode.object_category for episode in env.episodes})
    vectors = {text: np.full(8, number, np.float32) for number, text in enumerate(texts)}
    np.savez(tmp_path / "goals.npz", **vectors)
    with habitat.Env(stubborn_habitat.get_config("words-seen", few, cache=str(tmp_path / "goals.npz"))) as env:
        for _ in range(2):
            observations = env.reset()
            assert env.observation_space.contains(dict(observations))
            np.testing.assert_array_equal(observations["clip_objectgoal"], vectors[env.current_episode.object_category])
    np.savez(tmp_path / "goals.npz", **{"a unicorn": np.zeros(8)})
    env = habitat.Env(stubborn_habitat.get_config("words-seen", few, cache=str(tmp_path / "goals.npz")))
    with env, pytest.raises(ConfigError, match=f"no vector of '{words}'"):
        env.reset()
    with pytest.raises(ConfigError, match="no episodes with a single goal in words"):
        habitat.Env(stubborn_habitat.get_config("chains-val"))
    others = ["habitat.dataset.content_scenes=['val_00','attic']"]
    with pytest.raises(ConfigError, match="has no house 'attic'"):
        habitat.Env(stubborn_habitat.get_config("words-seen", others))
    with pytest.raises(ConfigError, match="lists no view points"):
        stubborn_habitat.get_config("words-seen", rule="view_points")


def test_goat_subtask_goal_shows_the_present_task_of_goat_bench(tmp_path: Path) -> None:
    from habitat.core.registry import registry

    stubborn_habitat.get_config("val")  # registers the sensors
    described = {"object_id": "chair_02", "lang_desc": "The red chair"}
    episode = SimpleNamespace(
        scene_id="stubborn/val/val_02.xml",
        goals=[[], [{"object_id": "chair_01", "lang_desc": "other"}, described], []],
        tasks=[
            ["sofa", "object", None, None],
            ["chair", "description", "chair_02", None],
            ["bed", "image", "bed_00", 1],
        ],
    )
    kept = {"sofa": [1, 0], "the red chair": [2, 0], "val_02_bed_00_1": [3, 0]}
    np.savez(tmp_path / "goals.npz", **{key: np.array(vector, np.float32) for key, vector in kept.items()})

    def seen(name: str, cache: str) -> list[Any]:
        sensor = registry.get_sensor(name)(config=SimpleNamespace(cache=cache))
        tasks = [SimpleNamespace(active_subtask_idx=number) for number in range(4)]
        return [sensor.get_observation(observations={}, episode=episode, task=task) for task in tasks]

    assert seen("GoatGoalSensor", "") == ["sofa", "the red chair", "", ""]
    assert seen("ClipObjectGoalSensor", "") == ["sofa", "", "", ""]
    cache = str(tmp_path / "goals.npz")
    assert [vector.tolist() for vector in seen("GoatGoalSensor", cache)] == [[1, 0], [2, 0], [3, 0], [0, 0]]
    assert [vector.tolist() for vector in seen("ClipObjectGoalSensor", cache)] == [[1, 0], [0, 0], [0, 0], [0, 0]]
    for broken in (b"no zip", (tmp_path / "goals.npz").read_bytes()[:200]):
        (tmp_path / "bad.npz").write_bytes(broken)
        with pytest.raises(ConfigError, match="cannot be read as"):
            seen("GoatGoalSensor", str(tmp_path / "bad.npz"))
    with pytest.raises(ConfigError, match="missing"):
        seen("GoatGoalSensor", str(tmp_path / "missing.npz"))


def test_the_top_down_map_shows_rooms_and_the_path() -> None:
    from habitat.config.default_structured_configs import TopDownMapMeasurementConfig

    config = stubborn_habitat.get_config("val")
    with habitat.config.read_write(config):
        config.habitat.task.measurements.top_down_map = TopDownMapMeasurementConfig(map_resolution=256)
    with habitat.Env(config) as env:
        env.reset()
        drawn = env.get_metrics()["top_down_map"]["map"]
        assert {0, 1, 2} <= set(np.unique(drawn).tolist())
        assert 0.1 < (drawn > 0).mean() < 0.9


def test_ddppo_trains_two_updates_and_evaluates_its_checkpoint(tmp_path: Path) -> None:
    few = [
        "habitat_baselines.num_updates=2",
        "habitat_baselines.num_checkpoints=1",
        "habitat_baselines.rl.ppo.num_steps=8",
    ]
    for words in (
        few,
        ["--evaluate", "habitat_baselines.test_episode_count=1", "habitat.environment.max_episode_steps=10"],
    ):
        done = subprocess.run(
            [sys.executable, str(EXAMPLES / "train_habitat.py"), *words],
            cwd=tmp_path, capture_output=True, text=True, check=False,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr[-3000:]
    assert list((tmp_path / "habitat_ppo" / "checkpoints").glob("ckpt*.pth"))
    assert "Average episode" in done.stdout + done.stderr


def test_a_script_of_2021_runs(tmp_path: Path) -> None:
    (tmp_path / "old.py").write_text(
        "import habitat\n"
        "config = habitat.get_config()\n"
        "config.defrost()\n"
        "config.merge_from_list(['ENVIRONMENT.MAX_EPISODE_STEPS', 4])\n"
        "config.SIMULATOR.RGB_SENSOR.WIDTH = 64\n"
        "config.SIMULATOR.RGB_SENSOR.HEIGHT = 48\n"
        "config.freeze()\n"
        "env = habitat.Env(config=config)\n"
        "class Own(habitat.Agent):\n"
        "    def reset(self): pass\n"
        "    def act(self, observations):\n"
        "        assert observations['rgb'].shape == (48, 64, 3)\n"
        "        return {'action': 'move_forward'}\n"
        "agent, steps, observations = Own(), 0, env.reset()\n"
        "while not env.episode_over:\n"
        "    observations, steps = env.step(agent.act(observations)), steps + 1\n"
        "print('steps', steps, len(env.episodes))\n"
    )
    words = [sys.executable, "-m", "sim.app.commands.main", "habitat", "old.py", "--episodes", "3"]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert "steps 4 3" in done.stdout, done.stderr[-2000:]


def run(words: list[str], folder: Path, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "sim.app.commands.main", *words],
        cwd=folder, env={**os.environ, **environment}, capture_output=True, text=True, check=False,
    )  # fmt: skip


def test_habitat_labs_own_class_reads_the_files_of_a_split_of_ones_own(tmp_path: Path) -> None:
    folder, written = tmp_path / "mine", tmp_path / "lab"
    for words in (
        ["houses", "generate", "--houses", "1", "--kind", "flat", "--out", str(folder)],
        ["episodes", "--split", str(folder), "--episodes", "3", "--no-pictures"],
        ["habitat", "dataset", "--split", str(folder), "--out", str(written)],
    ):
        done = run(words, tmp_path)
        assert done.returncode == 0, done.stderr
    path = f"habitat.dataset.data_path={written}/lab.json.gz"
    config = habitat.get_config("benchmark/nav/objectnav/objectnav_mp3d.yaml", overrides=[path])
    with habitat.Env(config) as env:
        env.reset()
        assert len(env.episodes) == 3
        assert sorted(int(episode.episode_id) for episode in env.episodes) == [0, 1, 2]
        goal = env.current_episode.goals[0]
        labelled = env.sim.semantic_annotations().objects[goal.object_id]
        assert (labelled.name, labelled.category.name()) == (goal.object_name, goal.object_category)
        points = [v.agent_state.position for g in env.current_episode.goals for v in g.view_points]
        assert len(points) > 24  # denser than those that ship
        assert env.sim.geodesic_distance(points[0], [points[0]]) < 0.1
    with habitat.Env(stubborn_habitat.get_config(str(folder))) as env:
        env.reset()
        assert env.get_metrics()["distance_to_goal"] > 0.0


def test_a_challenge_of_2021_evaluates_an_agent(tmp_path: Path) -> None:
    (tmp_path / "challenge.yaml").write_text("ENVIRONMENT:\n  MAX_EPISODE_STEPS: 3\nTASK:\n  UNKNOWN: 1\n")
    (tmp_path / "agent.py").write_text(
        "import habitat\n"
        "class Own(habitat.Agent):\n"
        "    def reset(self): pass\n"
        "    def act(self, observations): return {'action': 2}\n"
        "habitat.Challenge(eval_remote=False).submit(Own())\n"
    )
    done = run(["habitat", "agent.py", "--episodes", "2"], tmp_path, CHALLENGE_CONFIG_FILE="challenge.yaml")
    assert done.returncode == 0, done.stderr[-2000:]
    printed = done.stdout + done.stderr
    assert "success: 0.0" in printed
    assert "TASK.UNKNOWN=1 has no effect here" in printed
    missing = run(["habitat", "agent.py"], tmp_path, CHALLENGE_CONFIG_FILE="other/challenge.yaml")
    assert "'other/challenge.yaml' does not exist" in missing.stderr


def test_an_environment_class_of_2021_chooses_sensors_scenes_and_data_set(tmp_path: Path) -> None:
    (tmp_path / "task.yaml").write_text(
        "SIMULATOR:\n  SEMANTIC_SENSOR: {WIDTH: 64, HEIGHT: 48}\n  AGENT_0: {SENSORS: ['SEMANTIC_SENSOR']}\n"
        "TASK: {MEASUREMENTS: ['SPL']}\nDATASET: {TYPE: PointNav-v1, EPISODES_DIR: 'episodes/'}\nSEED: 7\n"
    )
    (tmp_path / "old.py").write_text(
        "from habitat import Config, RLEnv, make_dataset\n"
        "from habitat.config.default import get_config\n"
        "from gym.spaces.dict_space import Dict\n"
        "config = get_config(config_paths=['task.yaml'])\n"
        "config.DATASET.CONTENT_SCENES = ['val_05.glb', 'scan.glb']\n"
        "class Own(RLEnv):\n"
        "    def get_reward_range(self): return 0, 1\n"
        "    def get_reward(self, observations): return 0\n"
        "    def get_done(self, observations): return self._env.episode_over\n"
        "    def get_info(self, observations): return self._env.get_metrics()\n"
        "env = Own(config, make_dataset(config.DATASET.TYPE, config=config.DATASET))\n"
        "observations = env.reset()\n"
        "print(observations['semantic'].shape, env.step(1)[3]['spl'], config.DATASET.EPISODES_DIR)\n"
        "cameras = env.habitat_env.sim.get_agent_state().sensor_states\n"
        "print(config.SEED, len({tuple(camera.position) for camera in cameras.values()}), 'height of the cameras')\n"
        "print(env.habitat_env.sim.config.SCENE, {episode.scene_id for episode in env.episodes})\n"
    )
    done = run(["habitat", "old.py", "--split", "val"], tmp_path)
    house = "mjcf_houses/val/val_05.xml"
    printed = f"(48, 64, 1) 0.0 episodes/\n7 1 height of the cameras\n{house} {{'{house}'}}"
    assert printed in done.stdout, done.stderr[-2000:]
