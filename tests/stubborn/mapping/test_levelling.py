"""Images of a camera that leans become those of a level one, by what an accelerometer measures."""

from __future__ import annotations

import math

import cv2
import numpy as np
import pytest

from sim.core.geometry.pose import BodyPose, Pose
from sim.core.interface import GOAL_CATEGORIES, MPCAT40_ID, CameraModel, RobotModel
from sim.renderer.camera import Camera
from sim.world.world import World
from stubborn.agent import StubbornAgent
from stubborn.mapping.levelling import LevelledSegmenter, Levelling, LevellingConfig
from stubborn.segmentation.ground_truth import GroundTruthSegmenter
from tests.helpers.worlds import sofa_room

CAMERA = CameraModel()
G_M_S2 = 9.81
LEANS = [(4.8, 0.0), (-6.0, 2.0), (1.0, -8.0)]
"""Pitch and roll, degrees."""


def imu(pitch_rad: float, roll_rad: float, offset_m_s2: float = 0.0) -> np.ndarray:
    """Returns what an accelerometer measures at rest, with an offset of its first axis."""
    up = BodyPose(0.0, 0.0, 0.0, pitch_rad=pitch_rad, roll_rad=roll_rad).axes[:, 2]
    return np.array([*(G_M_S2 * up + np.array([offset_m_s2, 0.0, 0.0])), 0.0, 0.0, 0.0], np.float32)


def levelling(*, calm_frames: int = 3, offset_m_s2: float = 0.0, **options: float) -> Levelling:
    """Returns a levelling that has seen some frames of a level camera."""
    made = Levelling(CAMERA, 0.0, LevellingConfig(**options))
    for _ in range(calm_frames):
        frame = {"depth": np.ones((480, 640), np.float32), "imu": imu(0.0, 0.0, offset_m_s2)}
        assert made.level(frame) is frame
    return made


@pytest.fixture(scope="module")
def views() -> dict[tuple[float, float], tuple[dict[str, np.ndarray], dict[str, np.ndarray], BodyPose]]:
    """Images of a leaning camera, and of a level one at the same place, by lean."""
    world = World(sofa_room())
    world.reset(Pose(0.0, -1.0, 0.4))
    camera, result = Camera(world.model, world.labels, camera=CAMERA), {}
    for lean in LEANS:
        pitch_rad, roll_rad = map(math.radians, lean)
        body = BodyPose(0.0, -1.0, 0.4, 0.0, 0.0, pitch_rad, roll_rad)
        x_m, y_m, z_m = body.point(0.0, 0.0, CAMERA.height_m).tolist()
        level = BodyPose(x_m, y_m, 0.4, 0.0, z_m - CAMERA.height_m)
        leaning, flat = (camera.render(world.data, pose, ("depth", "semantic")) for pose in (body, level))
        result[lean] = leaning, flat, body
    camera.close()
    return result


@pytest.mark.parametrize("lean", LEANS)
def test_the_levelled_depth_is_that_of_a_level_camera(views, lean):
    leaning, flat, body = views[lean]
    level = levelling().level({"depth": leaning["depth"], "imu": imu(body.pitch_rad, body.roll_rad)})["depth"]
    seen = (level > 0.0) & (flat["depth"] > 0.0)
    assert seen.mean() > 0.75
    error_m = np.abs(level - flat["depth"])[seen]
    assert np.percentile(error_m, 97) < 0.002
    assert np.abs(leaning["depth"] - flat["depth"])[seen].mean() > 20.0 * np.median(error_m)


@pytest.mark.parametrize("lean", LEANS)
def test_the_levelled_scores_are_those_of_a_level_camera(views, lean):
    leaning, flat, body = views[lean]
    made = levelling()
    made.level({**leaning, "imu": imu(body.pitch_rad, body.roll_rad)})
    scores = LevelledSegmenter(GroundTruthSegmenter(), made).scores({}, "sofa")
    wanted = flat["semantic"] == MPCAT40_ID["sofa"]
    inside = made.image(np.ones((480, 640), np.float32)) > 0.0
    assert wanted[inside].sum() > 1000
    assert (scores.target[inside].astype(np.bool_) != wanted[inside]).mean() < 0.005


def test_a_small_lean_changes_nothing():
    frame = {"depth": np.ones((480, 640), np.float32), "imu": imu(math.radians(0.4), 0.0)}
    assert levelling().level(frame) is frame
    assert levelling(from_rad=math.inf).level({**frame, "imu": imu(0.3, 0.0)})["depth"] is frame["depth"]


def test_the_offset_of_the_accelerometer_is_no_lean():
    frame = {"depth": np.ones((480, 640), np.float32), "imu": imu(0.0, 0.0, 0.7)}
    assert levelling(offset_m_s2=0.7).level(frame) is frame
    assert levelling().level(frame) is not frame


def test_the_camera_of_a_robot_that_leans_ahead_is_ahead_of_it():
    made = levelling()
    made.level({"depth": np.ones((480, 640), np.float32), "imu": imu(0.1, 0.0)})
    eye = made.eye(Pose(1.0, 2.0, math.pi / 2))
    assert eye.xy_m == pytest.approx((1.0, 2.0 + CAMERA.height_m * math.sin(0.1)), abs=1e-6)


def test_a_robot_that_leans_maps_no_floor_as_an_obstacle(views):
    """With the nose down by 4.8 degrees, the floor 3 m ahead seems to be 0.25 m high."""
    leaning, flat, body = views[(4.8, 0.0)]
    lean = imu(body.pitch_rad, body.roll_rad)
    eye_m = CAMERA.height_m * math.sin(body.pitch_rad)
    level, levelled, raw = (
        obstacles({**images, "imu": reading}, x_m)
        for images, reading, x_m in ((flat, imu(0.0, 0.0), eye_m), (leaning, lean, 0.0), (leaning, imu(0.0, 0.0), 0.0))
    )
    near_level = cv2.dilate(level.view(np.uint8), np.ones((7, 7), np.uint8)) > 0  # 15 cm
    assert level.sum() > 100
    assert (levelled & ~near_level).sum() <= 5
    assert (raw & ~near_level).sum() > 1000


def obstacles(images: dict[str, np.ndarray], x_m: float) -> np.ndarray:
    """Returns the obstacles that an agent maps from one frame, after some frames of a level camera."""
    agent = StubbornAgent(camera=CAMERA, robot=RobotModel(), segmenter=GroundTruthSegmenter())
    agent.reset(GOAL_CATEGORIES[0], 0)
    for _ in range(3):
        agent.levelling.level({"depth": images["depth"], "imu": imu(0.0, 0.0)})
    agent.act({**images, "gps": np.array([x_m, 0.0], np.float32), "compass": np.zeros(1, np.float32)})
    return agent.navmap.seen_obstacle
