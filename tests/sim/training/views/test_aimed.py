"""Views aimed at rare objects: category, distance, visibility and record."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sim.core.errors import HouseError
from sim.core.interface import MPCAT40_ID, CameraModel
from sim.env.scene import Scene
from sim.robot.config import RobotConfig
from sim.training.views.aimed import DISTANCE_M, MIN_PIXELS, RARE
from sim.training.views.views import sample_views
from tests.helpers import wording
from tests.helpers.worlds import room, with_box

SMALL = CameraModel(width_px=160, height_px=120)
STOOL_M = (2.0, 1.5)


@pytest.fixture(scope="module")
def scene():
    """A room of 8 x 6 m with a stool in a corner, a sofa and a large bed, which is not rare."""
    house = with_box(room(8, 6), "bed_00", centre_m=(-2.5, 0, 0.3), half_m=(1.0, 1.5, 0.3))
    house = with_box(house, "stool_00", centre_m=(*STOOL_M, 0.25), half_m=(0.15, 0.15, 0.25))
    house = with_box(house, "sofa_04", centre_m=(0.0, -2.3, 0.4), half_m=(0.9, 0.4, 0.4))
    scene = Scene(house, robot=RobotConfig(), camera=SMALL, profile="fast")
    yield scene
    scene.close()


def test_aimed_views_show_a_rare_object_from_near_by_and_name_it(scene: Scene) -> None:
    rng = np.random.default_rng(0)
    views = list(sample_views(scene, rng, 24, stem="v", record={}, extras=("instances",), aim="rare"))
    aims = [view.record["aim"] for view in views]
    assert {(aim["category"], aim["instance"]) for aim in aims} == {("stool", "stool_00"), ("sofa", "sofa_04")}
    stools = sum(aim["category"] == "stool" for aim in aims)
    assert stools > 24 / 2  # RARE draws stools four times as often as sofas
    for view, aim in zip(views, aims, strict=True):
        seen = (view.semantic == MPCAT40_ID[aim["category"]]).sum()
        assert seen >= MIN_PIXELS / 16
        assert aim["instance"] in {each["name"] for each in view.annotations or []}
        pose = view.record["pose"]
        if aim["category"] == "stool":
            far_m = math.hypot(pose["x_m"] - STOOL_M[0], pose["y_m"] - STOOL_M[1])
            assert DISTANCE_M[0] - 0.01 <= far_m <= DISTANCE_M[1] + 0.01


def test_a_house_without_rare_objects_is_refused() -> None:
    scene = Scene(room(6, 5), robot=RobotConfig(), camera=SMALL, profile="fast")
    try:
        with pytest.raises(HouseError, match=wording.HAS_NO_OBJECT_OF_STOOL):
            list(sample_views(scene, np.random.default_rng(0), 1, stem="v", record={}, aim="rare"))
    finally:
        scene.close()


def test_only_goals_are_aimed_at() -> None:
    from sim.core.interface import GOAL_CATEGORIES

    assert set(RARE) <= set(GOAL_CATEGORIES)
