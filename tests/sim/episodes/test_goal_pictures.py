"""Pictures as goals: each shows its object clearly, and only objects that a picture can tell apart are asked for."""

from __future__ import annotations

import numpy as np
import pytest

from sim.core.goals import GoalSpec
from sim.core.interface import MPCAT40_ID, CameraModel
from sim.env.scene import Scene
from sim.episodes.goal_pictures import GoalPictures
from sim.robot.config import RobotConfig
from tests.helpers.worlds import room, with_box, with_facts


def scene_with(*chairs: tuple[float, float, str]) -> Scene:
    """A room with chairs, cubes of 0.6 m, at some places, with some colours."""
    house, facts = room(8, 8), {}
    for i, (x_m, y_m, colour) in enumerate(chairs):
        house = with_box(house, f"chair_0{i}", centre_m=(x_m, y_m, 0.3), half_m=(0.3, 0.3, 0.3))
        facts[f"chair_0{i}"] = f"name: armchair; colour: {colour}"
    scene = Scene(
        with_facts(house, **facts), robot=RobotConfig(), camera=CameraModel(width_px=160, height_px=120), profile="fast"
    )
    scene.world.restore()
    return scene


def picture_of(scene: Scene, name: str, seed: int = 0):
    pictures = GoalPictures(scene.task)
    item = next(item for item in scene.task.truth.meaning.objects if item.instance.name == name)
    try:
        return pictures.of(item, np.random.default_rng(seed))
    finally:
        pictures.close()


@pytest.mark.parametrize("seed", range(3))
def test_a_picture_shows_its_object_in_the_middle(seed):
    scene = scene_with((0.0, 0.0, "red"))
    camera = picture_of(scene, "chair_00", seed)
    assert camera is not None
    semantic = scene.picture_of(GoalSpec("chair_00", "picture", camera), "semantic")
    assert semantic is not None
    shows = semantic == MPCAT40_ID["chair"]
    assert shows.mean() >= 0.05
    assert np.abs(np.argwhere(shows).mean(axis=0) / len(shows) - 0.5).max() < 0.2
    assert camera.z_m != pytest.approx(scene.camera.camera.height_m)
    scene.close()


def test_twins_in_one_room_are_not_asked_for():
    scene = scene_with((-2.0, 0.0, "red"), (2.0, 0.0, "red"))
    assert picture_of(scene, "chair_00") is None
    scene.close()
    scene = scene_with((-2.0, 0.0, "red"), (2.0, 0.0, "blue"))
    assert picture_of(scene, "chair_00") is not None
    scene.close()


def test_an_object_of_the_same_category_beside_it_spoils_all_pictures():
    around = [(0.9 * x, 0.9 * y, "blue") for x in (-1, 0, 1) for y in (-1, 0, 1) if (x, y) != (0, 0)]
    scene = scene_with((0.0, 0.0, "red"), *around)
    assert picture_of(scene, "chair_00") is None
    scene.close()
