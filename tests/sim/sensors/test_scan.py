"""The lidar reads distances in a level plane; it agrees with geometry and with the depth image."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest

import sim.gym  # registers the environment
from sim.app.commands.run import entry
from sim.app.composition.setup import resolve
from sim.app.options import RunOptions
from sim.core.geometry.pose import Pose
from sim.core.interface import AgentSpec, CameraModel, ConfigError, reads_truth
from sim.env.objectnav import ObjectNavEnv
from sim.houses.house import House
from sim.sensors.noise import NoiseConfig, SensorNoise
from sim.sensors.scan import ScanConfig, ScanSensor
from sim.sensors.scan_noise import NoisyScan, ScanNoise
from tests.helpers.agents import make_spy
from tests.helpers.worlds import sofa_room, with_box, with_post

SMALL = CameraModel(width_px=64, height_px=48)
START = Pose(0.5, -0.2, math.radians(20.0))
SCANNER = AgentSpec(make=make_spy, sensors=("scan",), uses_segmentation=False)


def scan_in(house: House, tmp_path: Path, **options: Any) -> np.ndarray:
    """Returns the first reading in a house with a sofa, from `START`."""
    file = tmp_path / "house.xml"
    file.write_text(house.spec.to_xml())
    env = ObjectNavEnv(house=file, goal="sofa", start=START, camera=SMALL, sensors=("depth", "scan"), **options)
    observation, _ = env.reset(seed=0)
    assert env.observation_space.contains(observation)
    env.close()
    return observation["scan"]


def test_a_scan_of_a_room_has_the_distances_to_its_walls(tmp_path: Path) -> None:
    config = ScanConfig(height_m=1.5)  # above the sofa
    read_m = scan_in(sofa_room(), tmp_path, scan=config)
    angles = START.yaw_rad + config.angles_rad
    to_x = (3.0 - np.sign(np.cos(angles)) * START.x_m) / np.abs(np.cos(angles))
    to_y = (3.0 - np.sign(np.sin(angles)) * START.y_m) / np.abs(np.sin(angles))
    np.testing.assert_allclose(read_m, np.minimum(to_x, to_y), atol=1e-5)
    assert config.angles_rad[180] == 0.0
    assert config.angles_rad[270] == pytest.approx(math.pi / 2)  # to the left


def test_at_the_height_of_the_camera_a_scan_agrees_with_the_depth_image(tmp_path: Path) -> None:
    file = tmp_path / "house.xml"
    file.write_text(with_post(sofa_room(), "column_00", xy_m=(1.8, 0.2), radius_m=0.1, height_m=2.0).spec.to_xml())
    camera = CameraModel(height_px=479, width_px=639)  # has a middle row
    columns = np.arange(20, 639, 40)
    slopes = (319 - columns) / camera.focal_px  # left of the axis, per metre ahead
    env = ObjectNavEnv(
        house=file, goal="sofa", start=START, camera=camera, sensors=("depth", "scan"),
        scan={"height_m": camera.height_m, "rays": 3600},
    )  # fmt: skip
    observation, _ = env.reset(seed=0)
    env.close()
    rays = np.rint((np.arctan(slopes) + math.pi) / (math.tau / 3600)).astype(int)
    along_axis_m = observation["scan"][rays] / np.hypot(1.0, slopes)
    np.testing.assert_allclose(along_axis_m, observation["depth"][239, columns], atol=0.02)


def test_a_scan_sees_neither_glass_nor_the_robot_but_what_is_only_visual(tmp_path: Path) -> None:
    house = with_box(sofa_room(), "window_00", centre_m=(0.5, 0.8, 1.0), half_m=(0.5, 0.02, 1.0), group=3)
    screen = with_box(house, "curtain_00", centre_m=(0.5, -1.2, 1.0), half_m=(0.5, 0.02, 1.0))
    curtain = screen.spec.geom("curtain_00")
    curtain.contype = curtain.conaffinity = 0
    quarter = {"rays": 4, "height_m": 0.5}
    start_to_right = 1.2 - 0.02 - 0.2  # the ray to the right looks along -70 deg of the world
    _, right_m, _, left_m = scan_in(screen, tmp_path, scan=quarter)
    assert right_m == pytest.approx(start_to_right / math.cos(math.radians(20.0)), abs=1e-4)
    assert left_m > 3.0


def test_ranges_beyond_the_limits_read_the_limit_or_zero(tmp_path: Path) -> None:
    read_m = scan_in(sofa_room(), tmp_path, scan={"min_range_m": 2.8, "max_range_m": 3.2, "height_m": 1.5})
    assert read_m.max() == np.float32(3.2)
    assert np.count_nonzero(read_m == 0.0) > 50
    assert read_m[read_m > 0.0].min() >= 2.8


def test_rays_of_a_sector_are_symmetric_about_the_heading() -> None:
    config = ScanConfig(rays=181, fov_rad=math.pi)
    assert config.angles_rad[[0, 90, 180]] == pytest.approx([-math.pi / 2, 0.0, math.pi / 2])
    assert ScanConfig(rays=1).angles_rad.tolist() == [0.0]
    assert ScanConfig(rays=4).angles_rad == pytest.approx([-math.pi, -math.pi / 2, 0.0, math.pi / 2])


def test_noise_grows_with_the_distance_and_stays_in_the_range() -> None:
    scan, rng = ScanConfig(rays=10_000, max_range_m=8.0), np.random.default_rng(0)
    noise = NoisyScan(ScanNoise(std_m=0.01, std_share=0.02, dropout=0.1), scan)
    for true_m, std_m in ((1.0, 0.03), (4.0, 0.09)):
        read_m = noise.apply({"scan": np.full(scan.rays, true_m, np.float32)}, {}, rng)["scan"]
        assert np.mean(read_m == 8.0) == pytest.approx(0.1, abs=0.02)
        assert np.std(read_m[read_m < 8.0]) == pytest.approx(std_m, rel=0.05)
    edge_m = noise.apply({"scan": np.tile(np.array([0.0, 0.16, 7.99, 8.0], np.float32), 2500)}, {}, rng)[
        "scan"
    ].reshape(-1, 4)
    assert edge_m.min() == 0.0
    assert edge_m.max() == 8.0
    assert (edge_m[:, 0] == 0.0).all()
    assert (edge_m[:, 3] == 8.0).all()
    assert ScanNoise().model_of(scan) is None


def test_presets_of_noise_change_the_scan_and_keep_the_space(tmp_path: Path) -> None:
    exact = scan_in(sofa_room(), tmp_path)
    noisy = scan_in(sofa_room(), tmp_path, noise="harsh")
    assert 0.001 < np.median(np.abs(noisy - exact)) < 0.2
    own = ScanSensor(noise=ScanNoise(std_m=0.05))
    env = ObjectNavEnv(house=tmp_path / "house.xml", goal="sofa", start=START, camera=SMALL, sensors=(own,))
    assert np.std(env.reset(seed=0)[0]["scan"] - exact) == pytest.approx(0.05, rel=0.3)
    env.close()


def test_gymnasium_makes_it_by_name(house: Path) -> None:
    env = gymnasium.make(sim.gym.ENV_ID, house=house, goal="sofa", sensors=("scan",), scan={"rays": 90})
    observation, _ = env.reset(seed=0)
    assert set(observation) == {"scan", "gps", "compass", "objectgoal"}
    assert observation["scan"].shape == (90,)
    env.close()


@pytest.mark.costly
def test_an_agent_may_declare_it_without_ground_truth_and_the_run_records_it(house: Path, tmp_path: Path) -> None:
    assert not reads_truth("scan")
    assert not reads_truth(ScanSensor())
    setup = resolve(RunOptions(agent=f"{__name__}:SCANNER", config=("scan.rays=12",)))
    assert (setup.config.scan.rays, setup.uses_ground_truth) == (12, False)
    options = ["--agent", f"{__name__}:SCANNER", "--house", str(house), "--episodes", "1", "--out", str(tmp_path / "r")]
    assert entry([*options, "--config", "scan.rays=12", "task.max_steps=2", "camera.width_px=64"]) == 0
    recorded = json.loads((tmp_path / "r/config.json").read_text())["config"]
    assert (recorded["sensors"], recorded["scan"]["rays"]) == (["scan"], 12)


def test_settings_that_are_not_allowed_are_refused() -> None:
    wrongs: tuple[dict[str, Any], ...] = (
        {"rays": 0},
        {"rays": 1.5},
        {"rays": 360.0},
        {"min_range_m": 3.0, "max_range_m": 3.0},
        {"fov_rad": 7.0},
    )
    for wrong in wrongs:
        with pytest.raises(ConfigError, match="ScanConfig"):
            ScanConfig(**wrong)
    with pytest.raises(ConfigError, match=r"ScanNoise.dropout.*\[0.*1\].*2"):
        ScanNoise(dropout=2)


def test_noise_has_the_range_of_the_lidar_that_it_changes() -> None:
    rear = ScanSensor(name="rear", config=ScanConfig(rays=4, max_range_m=2.0))
    noise = SensorNoise(NoiseConfig(scan=ScanNoise(dropout=1.0)), SMALL, (rear, ScanSensor(config=ScanConfig(rays=4))))
    noise.begin(np.random.default_rng(0), np.zeros(0, np.float32))
    readings = {name: np.full(4, 1.0, np.float32) for name in ("rear", "scan")}
    noisy = noise.apply(readings, {})
    assert noisy["rear"].tolist() == [1.0] * 4
    assert noisy["scan"].tolist() == [12.0] * 4


def test_a_sensor_of_the_user_cannot_take_its_name(house: Path) -> None:
    class Liar(ScanSensor):
        """Has the name of the lidar, but could read anything."""

    with pytest.raises(ConfigError, match="'scan'"):
        ObjectNavEnv(house=house, goal="sofa", sensors=(Liar(),))
