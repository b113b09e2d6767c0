"""The environment keeps Gymnasium's contract and ours."""

from __future__ import annotations

import contextlib
import math
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from sim.core.errors import EpisodeError, HouseError
from sim.core.geometry.pose import Pose
from sim.core.goals import GoalSpec, PictureCamera
from sim.core.interface import Action, CameraModel, ConfigError, RobotModel, SuccessRule
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.episode import Episode
from sim.episodes.splits import Split
from sim.renderer.profiles import get_profile
from sim.task.config import TaskConfig
from tests.helpers import wording
from tests.helpers.worlds import room, with_box

SMALL = CameraModel(width_px=64, height_px=48)


@pytest.fixture
def env(house: Path) -> Iterator[ObjectNavEnv]:
    env = ObjectNavEnv(house=house, goal="sofa", start=Pose(-1.0, 0.5, 0.0), camera=SMALL, max_steps=20)
    yield env
    env.close()


@pytest.mark.filterwarnings("error")
def test_gymnasiums_checker_accepts_the_environment(house: Path) -> None:
    env = gymnasium.make("sim.gym:stubborn/ObjectNav-v0", house=house, camera=SMALL, render_mode="rgb_array")
    check_env(env.unwrapped)
    env.close()


@pytest.mark.filterwarnings("error")
def test_gymnasiums_checker_accepts_goals_in_the_observation(house: Path) -> None:
    options = {"house": house, "camera": SMALL, "sensors": ("goal", "goal_picture"), "render_mode": "rgb_array"}
    env = gymnasium.make("sim.gym:stubborn/ObjectNav-v0", **options)
    check_env(env.unwrapped)
    env.close()


def test_a_goal_in_words_is_observed_as_text_and_one_by_a_picture_as_pixels(house: Path) -> None:
    env = ObjectNavEnv(house=house, camera=SMALL, sensors=("rgb", "goal", "goal_picture"))
    start = Pose(-1.0, 0.5, 0.0)
    try:
        words, _ = env.reset(options={"episode": Episode("a", "sofa_room", "the largest sofa", start)})
        assert words["goal"] == "the largest sofa"
        assert not words["goal_picture"].any()
        at_start = PictureCamera(x_m=-1.0, y_m=0.5, z_m=0.88, yaw_rad=0.0, hfov_rad=SMALL.hfov_rad)
        goals = (GoalSpec("sofa_00", "picture", at_start),)
        seen, _ = env.reset(options={"episode": Episode("b", "sofa_room", "sofa_00", start, goals=goals)})
        assert seen["goal"] == ""
        assert seen["objectgoal"] == [-1]
        picture = seen["goal_picture"]
        assert env.observation_space.contains(seen)
        # The robot's camera at the same place: its picture is the middle rows of the square one.
        rows = picture[64:448].reshape(48, 8, 64, 8, 3).mean(axis=(1, 3))
        assert np.abs(rows - seen["rgb"]).mean() < 6.0
        down = (GoalSpec("sofa_00", "picture", replace(at_start, pitch_rad=0.5)),)
        lower, _ = env.reset(options={"episode": Episode("c", "sofa_room", "sofa_00", start, goals=down)})
        assert np.abs(lower["goal_picture"].astype(float) - picture).mean() > 6.0
    finally:
        env.close()


@pytest.mark.costly
def test_make_needs_no_import_of_ours(house: Path) -> None:
    code = (
        "import gymnasium; env = gymnasium.make('sim.gym:stubborn/ObjectNav-v0', house=r'%s', sensors=('depth',));"
        "print(sorted(env.reset(seed=0)[0])); env.close()"
    )
    answer = subprocess.run([sys.executable, "-c", code % house], capture_output=True, text=True, check=False)
    assert answer.returncode == 0, answer.stderr
    assert answer.stdout.strip() == "['compass', 'depth', 'gps', 'objectgoal']"


def test_gps_and_compass_are_relative_to_the_start_at_any_heading(house: Path) -> None:
    for yaw_rad in (0.0, 2.0):
        env = ObjectNavEnv(house=house, goal="sofa", start=Pose(-1.0, 0.5, yaw_rad), camera=SMALL)
        observation, _ = env.reset(seed=0)
        np.testing.assert_allclose(observation["gps"], 0.0, atol=1e-3)
        for action in (Action.MOVE_FORWARD, Action.TURN_LEFT, Action.TURN_LEFT, Action.TURN_LEFT, Action.MOVE_FORWARD):
            observation, *_ = env.step(action)
        np.testing.assert_allclose(observation["gps"], [0.25, 0.25], atol=3e-3)
        np.testing.assert_allclose(observation["compass"], [math.pi / 2], atol=3e-3)
        env.close()


def test_stop_within_a_metre_of_the_goal_terminates_with_reward_1(env: ObjectNavEnv) -> None:
    env.reset(seed=0)
    for _ in range(9):
        _, reward, terminated, truncated, _ = env.step(Action.MOVE_FORWARD)
        assert (reward, terminated, truncated) == (0.0, False, False)
    _, reward, terminated, truncated, info = env.step(Action.STOP)
    assert (reward, terminated, truncated) == (1.0, True, False)
    assert info["success"] == 1
    assert info["end_reason"] == "stop"
    assert info["spl"] == pytest.approx(1.0, abs=0.2)


def test_stop_far_from_the_goal_terminates_with_reward_0(env: ObjectNavEnv) -> None:
    env.reset(seed=0)
    _, reward, terminated, _, info = env.step(Action.STOP)
    assert (reward, terminated, info["success"], info["spl"]) == (0.0, True, 0, 0)
    assert info["distance_to_goal"] == pytest.approx(2.1, abs=0.1)


@pytest.mark.parametrize(("distance_m", "success"), [(1.0, 1), (0.5, 0)])
def test_a_smaller_success_distance_fails_where_one_metre_succeeds(
    house: Path, distance_m: float, success: int
) -> None:
    """The sofa's front is at x = 2.1 m."""
    start = Pose(1.3, 0.0, 0.0)
    env = ObjectNavEnv(
        house=house, goal="sofa", start=start, camera=SMALL, sensors=(), success=SuccessRule(distance_m=distance_m)
    )
    _, info = env.reset(seed=0)
    assert info["distance_to_goal"] == pytest.approx(max(0.0, 0.8 - distance_m), abs=0.03)
    *_, info = env.step(Action.STOP)
    assert info["success"] == success
    env.close()


@pytest.mark.parametrize(("height_m", "success"), [(0.88, 0), (1.3, 1)])
def test_the_line_of_sight_is_at_the_height_of_the_camera(tmp_path: Path, height_m: float, success: int) -> None:
    low_wall = with_box(room(6, 4), "wall_10", centre_m=(0, -0.5, 0.6), half_m=(0.05, 1.5, 0.6))
    house = with_box(low_wall, "bed_00", centre_m=(0.55, -1.2, 0.25), half_m=(0.5, 0.5, 0.25))
    file = tmp_path / "low_wall.xml"
    file.write_text(house.spec.to_xml())
    camera = CameraModel(width_px=64, height_px=48, height_m=height_m)
    env = ObjectNavEnv(house=file, goal="bed", start=Pose(-0.5, -1.2, 0.0), camera=camera, sensors=())
    env.reset(seed=0)
    assert env.step(Action.STOP)[4]["success"] == success
    env.close()


def test_the_task_configuration_and_its_single_values_are_the_same_options(house: Path) -> None:
    rule = SuccessRule(distance_m=0.5)
    whole = ObjectNavEnv(house=house, task=TaskConfig(success=rule, max_steps=7))
    single = ObjectNavEnv(house=house, success=rule, max_steps=7)
    assert whole.task_config == single.task_config
    assert whole.success_rule is rule


def test_a_profile_is_a_name_an_object_or_a_dict(house: Path) -> None:
    images = []
    good = get_profile("good")
    for profile in ("good", good, {**vars(good), "name": "as good"}):
        env = ObjectNavEnv(house=house, goal="sofa", start=Pose(-1.0, 0.5, 0.0), camera=SMALL, profile=profile)
        images.append(env.reset(seed=0)[0]["rgb"])
        env.close()
    np.testing.assert_array_equal(images[0], images[1])
    np.testing.assert_array_equal(images[0], images[2])


def test_noise_may_be_a_dict_of_its_fields(house: Path) -> None:
    env = ObjectNavEnv(house=house, camera=SMALL, noise={"pose": {"gps_std_m": 0.1}})
    assert env.reset(seed=0)[0]["gps"].any()  # 0, 0 without noise
    env.close()


def test_an_episode_that_was_drawn_ends_the_running_one(env: ObjectNavEnv) -> None:
    env.reset(seed=0)
    env.step(Action.MOVE_FORWARD)
    env.draw_episode(np.random.default_rng(0))
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step(Action.MOVE_FORWARD)


def test_an_episode_is_truncated_not_terminated_at_max_steps(env: ObjectNavEnv) -> None:
    env.reset(seed=0)
    steps = [env.step(Action.TURN_LEFT) for _ in range(20)]
    assert [(terminated, truncated) for _, _, terminated, truncated, _ in steps] == [(False, False)] * 19 + [
        (False, True)
    ]
    assert steps[-1][4]["end_reason"] == "max_steps"
    turned = env.scene.world.pose
    with pytest.raises(EpisodeError, match="has ended"):
        env.step(Action.TURN_LEFT)
    assert env.scene.world.pose == turned


def test_the_same_seed_gives_the_same_episode_and_another_seed_another(house: Path) -> None:
    env = ObjectNavEnv(house=house, camera=SMALL)
    starts = []
    for seed in (1, 1, 2):
        env.reset(seed=seed)
        starts.append(env.episode.start)
    assert starts[0] == starts[1] != starts[2]
    env.close()


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"sensors": ("rgb", "thermal")}, ConfigError, "thermal"),
        ({"profile": "best"}, ConfigError, "best"),
        ({"profile": {"quads": 0}}, ConfigError, r"RenderProfile.quads must be in \[1, 64\], got 0"),
        ({"goal": "spaceship"}, EpisodeError, "spaceship"),
        ({"goal": "toilet"}, EpisodeError, "sofa"),
        ({"start": Pose(2.9, 2.9, 0)}, EpisodeError, "Start|start"),
        ({"house": "nowhere.xml"}, HouseError, "nowhere.xml"),
        ({"house": None, "split": "nosplit"}, ConfigError, "val"),
    ],
)
def test_an_invalid_option_is_named(house: Path, options: dict, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        ObjectNavEnv(**{"house": house, "camera": SMALL, **options}).reset(seed=0)


def test_a_step_before_a_reset_and_after_one_that_failed_is_refused(env: ObjectNavEnv) -> None:
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step(Action.STOP)
    env.reset(seed=0)
    inside = Episode(episode_id="inside", house="sofa_room", goal="sofa", start=Pose(2.5, 0.0, 0.0))
    with pytest.raises(EpisodeError):
        env.reset(options={"episode": inside})
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step(Action.TURN_LEFT)
    env.reset(seed=0)
    env.step(Action.TURN_LEFT)


def test_an_episode_that_was_drawn_can_be_repeated_by_its_id(house: Path) -> None:
    with contextlib.closing(ObjectNavEnv(house=house, camera=SMALL, sensors=())) as env:
        _, info = env.reset(seed=3)
        drawn = env.episode
        env.reset(options={"episode_id": info["episode_id"]})
        assert env.episode is drawn
        with pytest.raises(EpisodeError, match="no episode 'another'"):
            env.reset(options={"episode_id": "another"})


def test_a_closed_environment_says_so(house: Path) -> None:
    env = ObjectNavEnv(house=house, goal="sofa", start=Pose(-1.0, 0.5, 0.0), camera=SMALL, sensors=())
    env.reset(seed=0)
    env.close()
    for use in (lambda: env.step(Action.TURN_LEFT), env.reset):
        with pytest.raises(gymnasium.error.ClosedEnvironmentError, match="closed"):
            use()
    env.close()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"episode": None, "episode_id": "a"}, "episode_id"),
        ({"epsiode_id": "a"}, "got epsiode_id"),
        ({"episode": {"goal": "sofa"}}, r"{.*'goal'.*'sofa'.*}"),
        ({"episode": None}, wording.MUST_BE_AN_EPISODE_GOT_NONE),
    ],
)
def test_unknown_options_of_reset_are_refused(env: ObjectNavEnv, options: dict, message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        env.reset(options=options)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: ObjectNavEnv(labels="rules.json"), wording.LABELS_AND_ROOT_NEED_HOUSE),
        (lambda: ObjectNavEnv(start=Pose(0.0, 0.0, 0.0)), wording.START_NEEDS_HOUSE),
        (lambda: ObjectNavEnv(houses=("val_00", "val_99")), "'val_99'"),
        (lambda: ObjectNavEnv(houses=("val_00", Path("a.xml"))), "'val_00'"),
        (lambda: ObjectNavEnv(houses="val_00"), wording.A_LIST_OF_NAMES),
        (lambda: ObjectNavEnv(cached_houses=0), "cached_houses"),
        (lambda: CameraModel(height_m=-1.0), r"height_m.*-1.0"),
        (lambda: CameraModel(hfov_rad=math.nan), "hfov_rad"),
        (lambda: CameraModel(height_m=math.inf), "height_m"),
        (lambda: CameraModel(width_px=10**6), "1 to 4096 pixels"),
        (lambda: RobotModel(radius_m=math.nan), "RobotModel.radius_m"),
        (lambda: SuccessRule(distance_m=math.nan), "SuccessRule.distance_m"),
        (lambda: SuccessRule(same_storey_m=1e308), r"1e[+]09.*1e[+]308"),
        (lambda: TaskConfig(max_steps=10**12), "max_steps"),
        (lambda: ObjectNavEnv(max_steps=2.5), r"whole number.*2\.5"),  # type: ignore[arg-type]
        (lambda: ObjectNavEnv(goal=3), "goal must be"),  # type: ignore[arg-type]
        (lambda: ObjectNavEnv(split=3), "split must be"),  # type: ignore[arg-type]
        (lambda: ObjectNavEnv(truth="rgb"), "truth must be"),
        (lambda: ObjectNavEnv(house="a.xml", start=(0, 0, 0)), "start must be a Pose"),  # type: ignore[arg-type]
        (lambda: ObjectNavEnv(cameras=["left"]), "cameras must be a dict"),  # type: ignore[arg-type]
        (lambda: Episode("e", "h", "sofa", Pose(math.nan, 0.0, 0.0)), "10000"),
        (lambda: Episode("e", "h", "sofa", Pose(1e308, 0.0, 0.0)), "10000"),
        (lambda: ObjectNavEnv(house="a.xml", start=Pose(0.0, math.inf, 0.0)), "10000"),
        (lambda: Episode("e", "h", "spoon", Pose(0.0, 0.0, 0.0)), "Unknown goal 'spoon'"),
    ],
)
def test_arguments_without_meaning_are_refused_by_name(make: Callable[[], object], message: str) -> None:
    with pytest.raises((ConfigError, EpisodeError), match=message):
        make()


def test_houses_stay_loaded_and_only_they_have_episodes(monkeypatch: pytest.MonkeyPatch) -> None:
    loaded = []
    load = Split.load_house
    monkeypatch.setattr(Split, "load_house", lambda self, name: (loaded.append(name), load(self, name))[1])
    env = ObjectNavEnv(split="traps", houses=("chair_legs", "glass_pane"), cached_houses=2, sensors=())
    for seed in range(6):
        _, info = env.reset(seed=seed)
        assert info["house"] in ("chair_legs", "glass_pane")
    env.close()
    assert sorted(loaded) == ["chair_legs", "glass_pane"]
