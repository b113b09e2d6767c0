"""Viewers of a running episode: MuJoCo's viewer and Rerun."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from sim.app.evaluation.rollout import play_episode
from sim.app.viewers import live, rerun_log, selection
from sim.app.viewers.viewer import VIEWER_IMAGES, Viewer
from sim.core.geometry.pose import Pose
from sim.core.interface import MPCAT40_ID, Action, CameraModel, ConfigError
from sim.env.objectnav import ObjectNavEnv
from sim.env.scene import SceneCache
from sim.episodes.episode import Episode
from tests.helpers import wording
from tests.helpers.results import entries_of
from tests.helpers.runners import Script
from tests.helpers.worlds import sofa_room, with_box, with_movable

SMALL = CameraModel(width_px=160, height_px=120)
EPISODE = Episode("sofa/0", "sofa_room", "sofa", Pose(-1.0, 0.5, math.pi / 6))
ACTIONS = [Action.MOVE_FORWARD, Action.TURN_LEFT, Action.MOVE_FORWARD, Action.STOP]


@pytest.fixture
def env(tmp_path: Path) -> Iterator[ObjectNavEnv]:
    file = tmp_path / "sofa_room.xml"
    furnished = sofa_room()
    furnished = with_box(furnished, "ceiling_00", centre_m=(0, 0, 2.55), half_m=(3, 3, 0.05))
    file.write_text(with_movable(furnished, "stool_00", xy_m=(0.0, -2.0)).spec.to_xml())
    env = ObjectNavEnv(house=file, sensors=("depth",), truth=VIEWER_IMAGES, camera=SMALL)
    yield env
    env.close()


def line_of(env: ObjectNavEnv, *viewers: Viewer) -> dict[str, Any]:
    return entries_of(play_episode(env, Script(ACTIONS), EPISODE, seed=0, viewers=viewers))


class Handle:
    """A replacement of the result of `launch_passive`, without a window."""

    def __init__(self, model: Any, data: Any) -> None:
        self.model, self.data, self.cam, self.open = model, data, SimpleNamespace(), True
        self.shown: list[np.ndarray] = []
        self.texts: list[str] = []

    def is_running(self) -> bool:
        return self.open

    def lock(self) -> contextlib.AbstractContextManager[None]:
        return contextlib.nullcontext()

    def sync(self) -> None:
        self.shown.append(self.data.qpos.copy())

    def set_texts(self, words: tuple[int, int, str, str]) -> None:
        self.texts.append(words[3])

    def close(self) -> None:
        self.open = False


@pytest.fixture
def windows(monkeypatch: pytest.MonkeyPatch) -> list[Handle]:
    opened: list[Handle] = []

    def launch(model: Any, data: Any) -> Handle:
        opened.append(Handle(model, data))
        return opened[-1]

    monkeypatch.setattr(live, "_launch", launch)
    monkeypatch.setattr(live.time, "sleep", lambda seconds: None)
    return opened


def test_the_viewer_shows_each_action_glide_to_where_it_led_and_changes_no_line(
    env: ObjectNavEnv, windows: list[Handle]
) -> None:
    plain = line_of(env)
    view = live.LiveView()
    assert line_of(env, view) == plain
    (window,) = windows
    assert len(window.shown) > 3 * len(ACTIONS)
    assert np.array_equal(window.shown[-1], env.scene.world.data.qpos)
    model = env.scene.world.model
    address = int(model.jnt_qposadr[model.body(live._robot_body(model)).jntadr[0]])
    steps_m = np.linalg.norm(np.diff([qpos[address : address + 2] for qpos in window.shown], axis=0), axis=1)
    assert 0.0 < steps_m.max() < 0.06  # an action of 0.25 m in nine frames
    assert window.texts[-1] == f"not found ({plain['failure']})"
    view.close()
    assert not window.open


def test_the_viewer_has_a_world_of_its_own_without_ceiling_and_with_the_robot(
    env: ObjectNavEnv, windows: list[Handle]
) -> None:
    view = live.LiveView()
    env.reset(options={"episode": EPISODE})
    groups = env.scene.world.model.geom_group.copy()
    view.begin(env)
    (window,) = windows
    ceiling = env.scene.world.labels.geom_category == MPCAT40_ID["ceiling"]
    assert ceiling.any()
    assert (window.model.geom_group[ceiling] == live.CEILING_GROUP).all()
    assert (window.model.geom_group[groups == live.ROBOT_GROUP] == 0).all()
    assert np.array_equal(env.scene.world.model.geom_group, groups)
    before = env.scene.world.data.qpos.copy()
    window.data.qpos[:] = 7.0  # the user moves an object in the window
    assert np.array_equal(env.scene.world.data.qpos, before)


def test_each_house_has_its_window_but_one_that_was_closed_stays_closed_and_the_run_goes_on(
    env: ObjectNavEnv, windows: list[Handle], monkeypatch: pytest.MonkeyPatch
) -> None:
    def next_house() -> None:
        monkeypatch.setattr(env, "_scenes", SceneCache(env._scenes._make))

    view = live.LiveView()
    plain = line_of(env, view)
    line_of(env, view)
    assert len(windows) == 1
    next_house()
    line_of(env, view)
    assert [window.open for window in windows] == [False, True]
    windows[1].close()
    next_house()
    assert line_of(env, view) == plain
    assert len(windows) == 2


def test_view_without_a_display_gives_one_clear_line(monkeypatch: pytest.MonkeyPatch) -> None:
    import glfw

    monkeypatch.setattr(glfw, "init", lambda: False)
    with pytest.raises(ConfigError, match=wording.NEEDS_A_DISPLAY):
        live.require_display()


def options(**changes: Any) -> Any:
    return SimpleNamespace(
        **{"out": None, "workers": 1, "video": False, "view": False, "rerun": False, "rerun_save": False, "mcap": False}
        | changes
    )


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"view": True, "workers": 2}, "--workers 1"),
        ({"rerun": True, "workers": 2}, "--workers 1"),
        ({"rerun": True, "rerun_save": True}, wording.ONLY_ONE_OF_THEM),
    ],
)
def test_options_that_exclude_each_other_are_reported(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        selection.check(options(**changes))


def test_without_rerun_the_message_names_the_package_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rerun_log.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(ConfigError, match=r"^--rerun-save needs .*pip install .*\[rerun\]"):
        selection.check(options(rerun_save=True))


def test_rerun_without_a_screen_or_a_viewer_gives_a_message(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rerun_log.importlib.util, "find_spec", lambda name: object())
    monkeypatch.setattr(rerun_log, "_viewer_listens", lambda: False)
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    with pytest.raises(ConfigError, match="--rerun-save"):
        selection.check(options(rerun=True))
    selection.check(options(rerun_save=True))


def test_points_lie_on_the_walls_they_were_seen_on(env: ObjectNavEnv) -> None:
    env.reset(options={"episode": EPISODE})
    pose = env.scene.world.pose
    points, rows, cols = rerun_log.points_in_world(env.truth_images["depth"], SMALL, pose, stride_px=4)
    categories = env.truth_images["semantic"][rows, cols]
    floor, wall = points[categories == MPCAT40_ID["floor"]], points[categories == MPCAT40_ID["wall"]]
    assert len(floor) > 20
    assert np.abs(floor[:, 2]).max() < 0.02
    assert len(wall) > 20
    assert np.abs(np.abs(wall[:, :2]).max(axis=1) - 3.0).max() < 0.06  # the room is 6 m wide


def test_a_recording_holds_poses_images_points_and_map_and_changes_no_line(env: ObjectNavEnv, tmp_path: Path) -> None:
    pytest.importorskip("rerun", reason="the extra `rerun` (170 MB) is not installed")
    plain = line_of(env)
    assert line_of(env, rerun_log.RerunLog(tmp_path)) == plain
    (file,) = (tmp_path / "rerun").iterdir()
    assert file == rerun_log.rerun_file(tmp_path, EPISODE.episode_id)
    content = file.read_bytes()
    for entity in ("world/robot", "camera/rgb", "seen/depth", "seen/semantic", "world/points/001", "map", "log"):
        assert entity.encode() in content


def test_a_recording_that_is_not_ended_leaves_nothing(env: ObjectNavEnv, tmp_path: Path) -> None:
    pytest.importorskip("rerun", reason="the extra `rerun` (170 MB) is not installed")
    log = rerun_log.RerunLog(tmp_path)
    env.reset(options={"episode": EPISODE})
    log.begin(env)
    assert len(list((tmp_path / "rerun").iterdir())) == 1
    log.close()
    assert list((tmp_path / "rerun").iterdir()) == []
