"""Demonstrations: their content, and invalid files."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sim.core.geometry.pose import Pose
from sim.core.interface import MPCAT40_ID, Action, CameraModel, ConfigError
from sim.renderer.camera import Camera
from sim.training.cloned.demonstrations import (
    Demonstration,
    demonstrate,
    list_demonstrations,
    read_demonstration,
    write_demonstration,
)
from sim.world.world import World
from tests.helpers import wording
from tests.helpers.worlds import room, with_box

CAMERA = CameraModel(width_px=64, height_px=48)
START = Pose(-1.0, 0.0, 0.0)
POSES = [START, replace(START, x_m=-0.75), replace(START, x_m=-0.75, yaw_rad=math.radians(30.0))]
ACTIONS = [Action.MOVE_FORWARD, Action.TURN_LEFT, Action.STOP]


@pytest.fixture(scope="module")
def shown() -> Demonstration:
    """Returns images of a bed: from two metres, from nearer, and after a turn."""
    world = World(with_box(room(6, 4), "bed_00", centre_m=(1.9, 0.0, 0.5), half_m=(0.5, 0.6, 0.5)))
    camera = Camera(world.model, world.labels, camera=CAMERA)
    try:
        return demonstrate(POSES, ACTIONS, world, camera, goal="bed", house="room", success=True)
    finally:
        camera.close()


def test_each_action_has_the_view_before_it(shown: Demonstration):
    middle = shown.depth_mm[:, 24, 32]
    assert shown.depth_mm.shape == shown.semantic.shape == (3, 48, 64)
    assert shown.semantic[0, 24, 32] == shown.semantic[1, 24, 32] == MPCAT40_ID["bed"]
    assert middle[0] == pytest.approx(2400, abs=10)
    assert middle[0] - middle[1] == pytest.approx(250, abs=3)
    bed = (shown.semantic == MPCAT40_ID["bed"]).mean((1, 2))
    assert bed[0] < bed[1]
    columns = np.flatnonzero((shown.semantic[2] == MPCAT40_ID["bed"]).any(0))
    assert columns.mean() > 40  # after a turn to the left the bed is on the right
    np.testing.assert_allclose(shown.poses[:, 0], [0.0, 0.25, 0.25], atol=1e-6)
    np.testing.assert_allclose(shown.poses[:, 2], [0.0, 0.0, math.radians(30.0)], atol=1e-6)
    assert shown.actions.tolist() == [int(action) for action in ACTIONS]


def test_an_episode_without_an_action_is_refused():
    unused: Any = None
    with pytest.raises(ConfigError, match=wording.AT_LEAST_ONE_ACTION):
        demonstrate([], [], unused, unused, goal="bed", house="room", success=False)


def test_a_file_has_its_arrays_and_nothing_else(shown: Demonstration, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    written: dict[str, Any] = {}
    monkeypatch.setattr(np, "savez_compressed", lambda _, **arrays: written.update(arrays))  # as before NumPy 2.1
    write_demonstration(tmp_path / "one.npz", shown)
    assert set(written) == {"depth_mm", "semantic", "poses", "actions", "about"}


def test_a_file_holds_the_demonstration(shown: Demonstration, tmp_path: Path):
    file = tmp_path / "folder" / "one.npz"
    write_demonstration(file, shown)
    again = read_demonstration(file)
    for name in ("depth_mm", "semantic", "poses", "actions"):
        np.testing.assert_array_equal(getattr(again, name), getattr(shown, name))
    assert (again.goal, again.house, again.success) == ("bed", "room", True)
    assert list_demonstrations([tmp_path, file.parent]) == [file.resolve()]
    with pytest.raises(ConfigError, match="No demonstration in"):
        list_demonstrations([tmp_path, tmp_path / "nothing"])


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"actions": np.array([1, 2], np.uint8)}, "for 2 actions"),
        ({"actions": np.array([1, 2, 9], np.uint8)}, wording.OUT_OF_RANGE),
        ({"semantic": np.full((3, 48, 64), 41, np.uint8)}, wording.OUT_OF_RANGE),
        ({"semantic": np.zeros((3, 4, 4), np.uint8)}, r"\(3, 48, 64\) and \(3, 4, 4\)"),
        ({"depth_mm": np.zeros((3, 48, 64))}, "depth_mm is float64"),
        ({"poses": np.full((3, 3), np.nan, np.float32)}, "not finite"),
        (
            {
                "actions": np.zeros(0, np.uint8),
                "poses": np.zeros((0, 3), np.float32),
                "semantic": np.zeros((0, 48, 64), np.uint8),
                "depth_mm": np.zeros((0, 48, 64), np.uint16),
            },
            wording.IT_HAS_NO_ACTION,
        ),
        ({"goal": "spoon"}, "'spoon'"),
    ],
)
def test_a_file_that_makes_no_sense_is_refused(shown: Demonstration, tmp_path: Path, change: dict, message: str):
    write_demonstration(tmp_path / "bad.npz", replace(shown, **change))
    with pytest.raises(ConfigError, match=message):
        read_demonstration(tmp_path / "bad.npz")
