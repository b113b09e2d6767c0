"""Views in other light and with a leaning body: the labels stay, light and camera change, the pose says so."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sim.core.geometry.pose import BodyPose, Pose
from sim.core.interface import CameraModel
from sim.core.paths import CACHE_VARIABLE
from sim.core.store import SIZE_VARIABLE
from sim.env.scene import Scene
from sim.episodes.splits import load_split
from sim.homes.housegen import generate
from sim.houses.house import House
from sim.robot.config import RobotConfig
from sim.training.views.variation import MAX_LEAN_DEG, leaning, with_other_light
from sim.training.views.views import camera_to_world, sample_views

CAMERA = CameraModel(width_px=160, height_px=120)


def views_of(house: House, *, lean: bool):
    scene = Scene(house, robot=RobotConfig(), camera=CAMERA, profile="fast")
    views = list(sample_views(scene, np.random.default_rng(0), 6, stem="v", record={}, lean=lean))
    scene.close()
    return views


@pytest.mark.costly
def test_other_light_changes_colours_but_no_label_and_no_depth() -> None:
    house = House("flat", generate(3, kind="studio"))
    text = house.spec.to_xml()
    plain, other = (views_of(one, lean=False) for one in (house, with_other_light(house, np.random.default_rng(1))))
    assert house.spec.to_xml() == text
    assert np.mean([view.rgb for view in plain]) != np.mean([view.rgb for view in other])
    for a, b in zip(plain, other, strict=True):
        np.testing.assert_array_equal(a.semantic, b.semantic)
        np.testing.assert_array_equal(a.depth_mm, b.depth_mm)


def test_a_house_of_a_file_has_the_other_light_also_where_its_model_is_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(CACHE_VARIABLE, str(tmp_path))
    monkeypatch.setenv(SIZE_VARIABLE, "1000")
    house = load_split("val").load_house("val_00")
    lights = []
    for one in (house, with_other_light(house, np.random.default_rng(1))):
        scene = Scene(one, robot=RobotConfig(), camera=CAMERA, profile="fast")
        lights.append(scene.world.model.light_diffuse.copy())
        scene.close()
    assert lights[0].shape == lights[1].shape
    assert not np.allclose(*lights)


def test_a_lean_is_in_the_pose_of_a_view_and_bounded() -> None:
    poses = [leaning(Pose(1.0, 2.0, 0.5, 0.1), np.random.default_rng(seed)) for seed in range(200)]
    lean = [pose for pose in poses if isinstance(pose, BodyPose)]
    assert 40 < len(lean) < 120
    assert max(max(abs(pose.pitch_rad), abs(pose.roll_rad)) for pose in lean) <= np.radians(MAX_LEAN_DEG) + 1e-9
    assert all((pose.x_m, pose.y_m, pose.yaw_rad, pose.floor_z_m) == (1.0, 2.0, 0.5, 0.1) for pose in lean)
    views = views_of(House("flat", generate(3, kind="studio")), lean=True)
    assert {"pitch_rad" in view.record["pose"] for view in views} == {True, False}


def test_the_matrix_of_a_leaning_camera_maps_its_axis_to_where_it_looks() -> None:
    down = camera_to_world(BodyPose(1.0, 2.0, 0.0, 0.1, 0.0, np.radians(90.0)), CAMERA)
    np.testing.assert_allclose(down[:3, 2], (0.0, 0.0, -1.0), atol=1e-9)
