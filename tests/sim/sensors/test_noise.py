"""Noise has the statistics of its configuration and is reproducible with the same seed."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sim.core.geometry.pose import Pose
from sim.core.interface import FORWARD_M, SENSORS, Action, CameraModel, ConfigError, wrap_angle
from sim.env.objectnav import ObjectNavEnv
from sim.gl import mujoco
from sim.houses.labels import read_labels
from sim.renderer.gloss import geom_gloss
from sim.robot.conditions import NOMINAL, Conditions
from sim.sensors.actuation_noise import ActuationNoise
from sim.sensors.depth_noise import DepthNoise, NoisyDepth
from sim.sensors.measured import BumperSensor
from sim.sensors.noise import NOISE_PRESETS, NoiseConfig, SensorNoise, get_noise, noise_from_dict
from sim.sensors.pose_noise import NoisyPose, PoseNoise
from sim.sensors.random_fields import smooth_normal
from sim.sensors.rgb_noise import NoisyRgb, RgbNoise
from sim.sensors.semantic_map import MapConfig
from sim.sensors.standard import resolve_sensors
from sim.world.world import World
from tests.helpers import wording
from tests.helpers.worlds import room, sofa_room, with_box

CAMERA = CameraModel()
SHAPE = (CAMERA.height_px, CAMERA.width_px)
SMALL = CameraModel(width_px=64, height_px=48)


def wall(distance_m: float) -> np.ndarray:
    """Returns the depth of a wall that fills the image."""
    return np.full(SHAPE, distance_m, np.float32)


def step_of(near_m: float, far_m: float) -> np.ndarray:
    """Returns the depth of a near surface on the left before a far wall on the right."""
    depth_m = wall(near_m)
    depth_m[:, SHAPE[1] // 2 :] = far_m
    return depth_m


def sensed(config: DepthNoise, depth_m: np.ndarray, seed: int = 0) -> np.ndarray:
    noise = NoisyDepth(replace(config, hole_share=0.0), CAMERA)
    return noise.apply({"depth": depth_m}, {}, np.random.default_rng(seed))["depth"]


PUBLISHED_MM = {1.0: 4.1, 2.0: 16.5, 4.0: 66.0}
"""Random error of a D435 by Intel's formula: 0.08 px of disparity, 388 px of focal length, 5 cm of baseline."""


@pytest.mark.parametrize("distance_m", [1.0, 2.0, 4.0])
@pytest.mark.parametrize("preset", ["realsense", "harsh"])
def test_std_of_a_walls_depth_grows_with_range_as_configured(preset: str, distance_m: float) -> None:
    config = replace(get_noise(preset).depth, step_1_m=0.0, bias_1_m=0.0, baseline_m=0.0)
    error_m = sensed(config, wall(distance_m)).astype(float) - distance_m
    assert error_m.std() == pytest.approx(config.axial_m + config.axial_1_m * distance_m**2, rel=0.05)
    assert abs(error_m.mean()) < 0.05 * error_m.std()
    if preset == "realsense":
        assert 1000.0 * error_m.std() == pytest.approx(PUBLISHED_MM[distance_m], rel=0.05, abs=1.2)


@pytest.mark.parametrize("preset", ["realsense", "harsh"])
def test_errors_of_neighbours_are_alike_within_the_matching_window(preset: str) -> None:
    """Means over windows of w px share w - k of w columns at a distance of k: the correlation is 1 - k / w."""
    config = replace(get_noise(preset).depth, step_1_m=0.0, bias_1_m=0.0, baseline_m=0.0, lateral_px=0.0)
    error_m = np.stack([sensed(config, wall(2.0), seed) for seed in range(4)]).astype(float) - 2.0
    power = (error_m**2).mean()
    for k in (1, 3, 5, config.window_px, 2 * config.window_px):
        wanted = max(0.0, 1.0 - k / config.window_px)
        assert (error_m[:, :, k:] * error_m[:, :, :-k]).mean() / power == pytest.approx(wanted, abs=0.03)
        assert (error_m[:, k:] * error_m[:, :-k]).mean() / power == pytest.approx(wanted, abs=0.03)


def test_the_systematic_error_is_smooth_and_constant_and_differs_between_episodes() -> None:
    """Its standard deviation is 1 % of the distance at 2 m, half of the data sheet's limit, and grows with z^2."""
    config = DepthNoise(bias_1_m=get_noise("realsense").depth.bias_1_m)
    noisy, rng = NoisyDepth(config, SMALL), np.random.default_rng(0)
    errors_m = []
    for _ in range(300):
        noisy.begin(np.zeros(1, np.float32))
        walls = [np.full((48, 64), distance_m, np.float32) for distance_m in (1.0, 1.0, 2.0, 4.0)]
        first, again, *far = (noisy.apply({"depth": depth_m}, {}, rng)["depth"] - depth_m[0, 0] for depth_m in walls)
        np.testing.assert_array_equal(first, again)
        errors_m.append([first, *far])
        assert np.abs(np.diff(first)).max() < 0.05 * 0.005
    std_m = np.array(errors_m)[:, :, 24, 32].std(axis=0)
    np.testing.assert_allclose(std_m, [0.005, 0.02, 0.08], rtol=0.15)


@pytest.mark.parametrize(("near_m", "far_m"), [(0.8, 3.0), (1.0, 2.0), (2.0, 4.0)])
@pytest.mark.parametrize("preset", ["realsense", "harsh"])
def test_a_near_object_casts_a_shadow_to_its_left_as_wide_as_in_a_stereo_camera(
    preset: str, near_m: float, far_m: float
) -> None:
    """The shadow is f b (1 / near - 1 / far) px wide, and the band at the left border f b / far."""
    baseline_m = get_noise(preset).depth.baseline_m
    focal_baseline = CAMERA.focal_px * baseline_m
    depth_m = wall(far_m)
    depth_m[100:200, 300:400] = near_m
    lost = sensed(DepthNoise(baseline_m=baseline_m), depth_m) == 0.0
    shadow_px = focal_baseline * (1.0 / near_m - 1.0 / far_m)
    assert abs(lost[150, 100:].sum() - shadow_px) <= 0.5
    assert lost[150, 300 - round(shadow_px) : 300].all()
    assert abs(lost[:, :100].sum() / SHAPE[0] - focal_baseline / far_m) <= 0.5
    assert not lost[:100, 100:].any()
    assert not lost[200:, 100:].any()
    seen = depth_m[~lost]
    np.testing.assert_array_equal(sensed(DepthNoise(baseline_m=baseline_m), depth_m)[~lost], seen)


def test_a_slanted_wall_and_pixels_without_return_cast_no_shadow() -> None:
    """A wall 0.3 m to the right of the optical axis, and a missing part of a flat one."""
    columns = np.arange(SHAPE[1]) + 0.5 - SHAPE[1] / 2
    beside = np.clip(CAMERA.focal_px * 0.3 / np.maximum(columns, 1e-3), 0.5, 4.9).astype(np.float32)
    config = DepthNoise(baseline_m=0.05)
    assert (sensed(config, np.ascontiguousarray(np.broadcast_to(beside, SHAPE)))[:, 100:] > 0.0).all()
    holed = wall(2.0)
    holed[:, 300:310] = 0.0
    np.testing.assert_array_equal(sensed(config, holed)[:, 100:], holed[:, 100:])


def test_axial_noise_can_be_nguyens() -> None:
    """0.0012 + 0.0019 (z - 0.4)^2: 6.1 mm at 2 m."""
    config = DepthNoise(axial_m=0.0012, axial_1_m=0.0019, axial_from_m=0.4)
    assert sensed(config, wall(2.0)).std() == pytest.approx(0.006064, rel=0.05)


@pytest.mark.parametrize("distance_m", [1.0, 2.0, 4.0])
def test_depth_comes_in_steps_that_grow_with_the_square_of_range(distance_m: float) -> None:
    step_1_m = 0.005
    ramp = np.broadcast_to(np.linspace(0.9 * distance_m, 1.1 * distance_m, SHAPE[1], dtype=np.float32), SHAPE)
    values = np.unique(sensed(DepthNoise(step_1_m=step_1_m), np.ascontiguousarray(ramp)))
    here = np.abs(values - distance_m).argmin()
    assert values[here + 1] - values[here] == pytest.approx(step_1_m * distance_m**2, rel=0.05)
    np.testing.assert_allclose(1.0 / values / step_1_m, np.rint(1.0 / values / step_1_m), atol=1e-3)


def test_shifts_have_the_configured_std_in_both_directions_and_are_uncorrelated() -> None:
    """Depth that grows along one axis measures the shift along it; rounding adds 1/12 px^2."""
    rows, columns = np.mgrid[: SHAPE[0], : SHAPE[1]].astype(np.float32)
    inner = (slice(20, -20), slice(20, -20))
    shifts = [
        ((sensed(DepthNoise(lateral_px=1.5), 1.0 + ramp / 400) - 1.0) * 400 - ramp)[inner] for ramp in (columns, rows)
    ]
    for shift in shifts:
        assert shift.std() == pytest.approx(math.sqrt(1.5**2 + 1 / 12), rel=0.02)
        assert abs(shift.mean()) < 0.02
    assert abs(np.corrcoef(shifts[0].ravel(), shifts[1].ravel())[0, 1]) < 0.01
    assert abs(np.corrcoef(shifts[0][:, 1:].ravel(), shifts[0][:, :-1].ravel())[0, 1]) < 0.01


@pytest.mark.parametrize("radius_px", [1, 2])
def test_edges_spread_the_configured_share(radius_px: int) -> None:
    config = DepthNoise(edge_flying=0.25, edge_radius_px=radius_px)
    images = np.stack([sensed(config, step_of(1.0, 3.0), seed) for seed in range(20)])
    middle = SHAPE[1] // 2
    edge = images[:, :, middle - radius_px : middle + radius_px]
    flying = (edge > 1.0) & (edge < 3.0)
    assert flying.mean() == pytest.approx(0.25, rel=0.05)
    assert edge[flying].mean() == pytest.approx(2.0, rel=0.02)
    assert edge[flying].std() == pytest.approx(2.0 / math.sqrt(12), rel=0.05)
    images[:, :, middle - radius_px : middle + radius_px] = step_of(1.0, 3.0)[
        :, middle - radius_px : middle + radius_px
    ]
    np.testing.assert_array_equal(images, np.broadcast_to(step_of(1.0, 3.0), images.shape))


def test_a_slanted_floor_has_no_edges() -> None:
    below = np.maximum(np.arange(SHAPE[0]) + 0.5 - SHAPE[0] / 2, 1e-3) / CAMERA.focal_px
    floor = np.minimum(CAMERA.height_m / below, 5.0).astype(np.float32)
    depth_m = np.ascontiguousarray(np.broadcast_to(floor[:, None], SHAPE))
    np.testing.assert_array_equal(sensed(DepthNoise(edge_flying=1.0), depth_m), depth_m)


def test_a_surface_next_to_pixels_without_return_has_no_flying_pixels() -> None:
    depth_m = sensed(DepthNoise(edge_flying=1.0), step_of(0.0, 3.0))
    assert set(np.unique(depth_m)) == {0.0, 3.0}


@pytest.mark.parametrize("gloss", [0.35, 0.6, 0.9, 1.0])
def test_glossy_surfaces_lose_the_configured_share_and_matt_ones_nothing(gloss: float) -> None:
    config = DepthNoise(hole_share=0.8, hole_gloss=0.3, hole_patch_px=6.0)
    noisy = NoisyDepth(config, CAMERA)
    noisy.begin(np.array([0.25, gloss], np.float32))
    geom = np.zeros(SHAPE, np.int32)
    geom[:, 100:] = 1
    geom[:40] = -1
    rng = np.random.default_rng(0)
    images = np.stack([noisy.apply({"depth": wall(2.0)}, {"geom": geom}, rng)["depth"] for _ in range(30)])
    lost = images == 0.0
    assert not lost[:, geom < 1].any()
    assert lost[:, geom == 1].mean() == pytest.approx(0.8 * (gloss - 0.3) / 0.7, rel=0.05)
    assert (images[~lost] == 2.0).all()


def test_holes_are_patches_of_the_configured_size() -> None:
    rng = np.random.default_rng(0)
    fields = [smooth_normal(rng, SHAPE, 12.0) for _ in range(20)]
    values = np.stack(fields)
    assert values.std() == pytest.approx(1.0, rel=0.02)
    alike = [float((values[:, :, lag:] * values[:, :, :-lag]).mean()) for lag in (2, 12, 60)]
    assert alike[0] > 0.95  # white noise blurred by a Gaussian of 12 px: exp(-lag^2 / (4 * 12^2))
    assert alike[1] == pytest.approx(math.exp(-0.25), abs=0.05)
    assert abs(alike[2]) < 0.05


def test_gloss_is_of_glass_mirrors_and_polish() -> None:
    xml = """<mujoco><asset>
      <material name="glass" rgba="1 1 1 0.2"/> <material name="mirror" specular="0.9" shininess="0.9"/>
      <material name="chrome" reflectance="0.7"/> <material name="wood" specular="0.15" shininess="0.1"/>
    </asset><worldbody>
      <geom name="floor_00" type="plane" size="3 3 1"/>
      <geom name="shower_00" type="box" size="1 1 1" material="glass"/>
      <geom name="mirror_00" type="box" size="1 1 1" material="mirror"/>
      <geom name="sink_00" type="box" size="1 1 1" material="chrome"/>
      <geom name="table_00" type="box" size="1 1 1" material="wood"/>
      <geom name="cabinet_00" type="box" size="1 1 1" rgba="1 1 1 0.5"/>
      <geom name="window_00" type="box" size="1 1 1" material="wood" rgba=".8 .9 1 .2"/>
      <geom name="mirror_01" type="box" size="1 1 1"/>
      <geom name="mirror_02" type="box" size="1 1 1" material="wood"/>
    </worldbody></mujoco>"""
    model = mujoco.MjModel.from_xml_string(xml)
    gloss = geom_gloss(model, read_labels(model))
    np.testing.assert_allclose(gloss, [0.0, 0.8, 0.81, 0.7, 0.015, 0.5, 0.8, 1.0, 0.015], atol=1e-6)


def test_the_limits_of_depth_keep_their_meaning() -> None:
    """Saturated pixels and those without return do not change; noise leaves [0.5, 5] only to 0."""
    config = replace(get_noise("harsh").depth, baseline_m=0.0, edge_flying=0.0, lateral_px=0.0)
    for value in (0.0, 5.0):
        np.testing.assert_array_equal(sensed(config, wall(value)), value)
    for distance_m in (0.505, 4.95):
        depth_m = sensed(config, wall(distance_m))
        assert ((depth_m == 0.0) | ((depth_m >= 0.5) & (depth_m <= 5.0))).all()
    assert (sensed(config, wall(0.505)) == 0.0).any()
    assert depth_m.dtype == np.float32


def noisy_rgb(config: RgbNoise, rgb: np.ndarray) -> np.ndarray:
    return NoisyRgb(config, CAMERA).apply({"rgb": rgb}, {}, np.random.default_rng(0))["rgb"].astype(float)


@pytest.mark.parametrize("grey", [40, 120, 200])
def test_shot_noise_grows_with_the_square_root_of_light(grey: int) -> None:
    rgb = np.full((*SHAPE, 3), grey, np.uint8)
    noise = RgbNoise(shot_electrons_1=1 / 500, read_std=0.0)
    seen = noisy_rgb(noise, rgb)
    electrons = 500 * grey / 255
    assert seen.std() == pytest.approx(math.sqrt((255 * math.sqrt(electrons) / 500) ** 2 + 1 / 12), rel=0.05)
    assert seen.mean() == pytest.approx(grey, abs=0.05)


def test_read_noise_is_the_same_at_every_grey() -> None:
    for grey in (30, 128, 225):
        rgb = np.full((*SHAPE, 3), grey, np.uint8)
        seen = noisy_rgb(RgbNoise(read_std=4.0), rgb)
        assert seen.std() == pytest.approx(math.sqrt(16.0 + 1 / 12), rel=0.05)
        assert abs(np.corrcoef(seen[..., 0].ravel(), seen[..., 1].ravel())[0, 1]) < 0.01


def test_the_gain_is_one_for_a_frame_and_varies_from_frame_to_frame() -> None:
    noisy, rng = NoisyRgb(RgbNoise(gain_std=0.1), SMALL), np.random.default_rng(0)
    frames = [noisy.apply({"rgb": np.full((48, 64, 3), 120, np.uint8)}, {}, rng)["rgb"] for _ in range(4000)]
    assert all(frame.min() == frame.max() for frame in frames[:20])
    gains = np.array([frame[0, 0, 0] for frame in frames]) / 120
    assert gains.std() == pytest.approx(0.1, rel=0.05)
    assert gains.mean() == pytest.approx(1.0, abs=0.01)


def test_dark_and_bright_saturate() -> None:
    rng = np.random.default_rng(0)
    for grey in (0, 255):
        image = {"rgb": np.full((48, 64, 3), grey, np.uint8)}
        seen = NoisyRgb(RgbNoise(read_std=5.0), SMALL).apply(image, {}, rng)["rgb"]
        assert abs(seen.astype(int) - grey).max() < 30


def test_gps_and_compass_have_the_configured_white_noise() -> None:
    noisy, rng = NoisyPose(PoseNoise(gps_std_m=0.05, compass_std_rad=0.03)), np.random.default_rng(0)
    true = {"gps": np.array([1.0, -2.0], np.float32), "compass": np.array([3.1], np.float32)}
    seen = [noisy.apply(true, {}, rng) for _ in range(4000)]
    gps = np.array([reading["gps"] - true["gps"] for reading in seen])
    yaws = np.array([wrap_angle(float(reading["compass"][0]) - 3.1) for reading in seen])
    assert all(-np.pi < reading["compass"][0] <= np.float32(np.pi) for reading in seen)
    np.testing.assert_allclose(gps.std(axis=0), 0.05, rtol=0.05)
    assert yaws.std() == pytest.approx(0.03, rel=0.05)
    assert abs(np.corrcoef(gps[1:, 0], gps[:-1, 0])[0, 1]) < 0.1


@pytest.mark.parametrize("preset", ["realsense", "harsh"])
def test_a_noisy_robot_knows_its_pose_by_odometry_only(preset: str, house: Path) -> None:
    """Encoders that measure 20 % too much move the robot by less, while gps and compass read whole actions."""
    drive_errors = ActuationNoise(encoder_scale=(1.2, 1.2), gyro_scale=(1.1, 1.1))
    noise = replace(get_noise(preset), actuation=drive_errors)
    sensors, start = ("odometry",), Pose(-1.0, -1.0, 0.3)
    env = ObjectNavEnv(house=house, goal="sofa", start=start, camera=SMALL, noise=noise, sensors=sensors)
    first = env.reset(seed=0)[0]
    seen = [env.step(action)[0] for action in (Action.TURN_LEFT, Action.MOVE_FORWARD)][-1]
    true = env.scene.world.pose.relative_to(start)
    assert env.observation_space.contains(seen)
    env.close()
    for reading in (first, seen):
        np.testing.assert_array_equal([*reading["gps"], *reading["compass"]], reading["odometry"])
    assert np.hypot(*seen["gps"]) == pytest.approx(FORWARD_M, abs=0.01)
    assert math.hypot(true.x_m, true.y_m) == pytest.approx(FORWARD_M / 1.2, abs=0.01)
    assert seen["compass"][0] == pytest.approx(1.1 * true.yaw_rad, abs=0.01)


def test_conditions_are_sampled_from_their_ranges() -> None:
    noise, rng = ActuationNoise(floor_friction_scale=(0.1, 1.0), motor_gain_scale=(0.8, 1.2)), np.random.default_rng(0)
    drawn = [noise.draw(rng) for _ in range(4000)]
    friction = np.log10([each.floor_friction_scale for each in drawn])
    gains = np.array([each.motor_gain_scale for each in drawn])
    assert (friction.min() >= -1.0, friction.max() <= 0.0) == (True, True)
    assert friction.mean() == pytest.approx(-0.5, rel=0.05)
    assert friction.std() == pytest.approx(1.0 / math.sqrt(12), rel=0.05)
    assert gains.std(axis=0) == pytest.approx([0.4 / math.sqrt(12)] * 2, rel=0.05)
    assert abs(np.corrcoef(gains.T)[0, 1]) < 0.05
    assert ActuationNoise().draw(rng) is NOMINAL


def test_conditions_change_floors_and_motors_only_and_are_undone_exactly() -> None:
    world = World(sofa_room())
    model, start = world.model, Pose(0.0, 0.0, 0.0)
    friction, gain, bias = (a.copy() for a in (model.geom_friction, model.actuator_gainprm, model.actuator_biasprm))
    floor = model.geom("floor_00").id
    world.reset(start, Conditions(floor_friction_scale=0.07, motor_gain_scale=(0.9, 1.1)))
    np.testing.assert_allclose(model.geom_friction[floor], friction[floor] * [0.07, 1, 1])
    np.testing.assert_array_equal(np.delete(model.geom_friction, floor, 0), np.delete(friction, floor, 0))
    np.testing.assert_allclose(model.actuator_gainprm[:, 0], gain[:, 0] * [0.9, 1.1])
    np.testing.assert_array_equal(model.actuator_biasprm, bias)
    world.reset(start, Conditions(floor_friction_scale=3.0))
    world.reset(start)
    np.testing.assert_array_equal(model.geom_friction, friction)
    np.testing.assert_array_equal(model.actuator_gainprm, gain)


def drive(world: World, conditions: Conditions) -> list[float]:
    world.reset(Pose(0.0, 0.0, 0.0), conditions)
    motions = [world.move(action) for action in (Action.MOVE_FORWARD, Action.TURN_LEFT, Action.MOVE_FORWARD)]
    return [*(motion.displacement_m for motion in motions), world.pose.x_m, world.pose.y_m, world.pose.yaw_rad]


def test_slip_and_short_moves_come_from_physics() -> None:
    world = World(room(6, 6))
    nominal = drive(world, NOMINAL)
    assert nominal[0] == pytest.approx(0.25, abs=0.001)
    spinning = drive(world, Conditions(floor_friction_scale=0.01))
    assert spinning[0] < 0.1
    sliding = drive(world, Conditions(floor_friction_scale=0.05))
    assert abs(sliding[0] - 0.25) > 0.02  # the wheels have turned by 0.25 m
    uneven = drive(world, Conditions(motor_gain_scale=(0.8, 1.2)))
    assert abs(uneven[4] - nominal[4]) > 0.005
    assert drive(world, NOMINAL) == nominal
    assert drive(world, Conditions(floor_friction_scale=0.05)) == sliding


@pytest.fixture(scope="module")
def house(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("house") / "sofa_room.xml"
    furnished = sofa_room()
    furnished = with_box(
        furnished, "shower_00", centre_m=(1.5, 1.5, 1.0), half_m=(0.3, 0.02, 1.0), rgba=(0.8, 0.9, 0.9, 0.2)
    )
    file.write_text(furnished.spec.to_xml())
    return file


@pytest.fixture
def noisy(house: Path) -> Iterator[ObjectNavEnv]:
    env = ObjectNavEnv(house=house, goal="sofa", start=Pose(-1.0, 0.5, 0.3), camera=SMALL, noise="harsh")
    yield env
    env.close()


def observations_of(env: ObjectNavEnv, seed: int, steps: int = 4) -> list[dict[str, np.ndarray]]:
    seen = [env.reset(seed=seed)[0]]
    return seen + [env.step(Action.MOVE_FORWARD)[0] for _ in range(steps)]


def same(one: list[dict[str, np.ndarray]], other: list[dict[str, np.ndarray]], *names: str) -> bool:
    return all(
        np.array_equal(a[name], b[name]) for a, b in zip(one, other, strict=True) for name in (names or one[0].keys())
    )


def test_the_same_seed_gives_the_same_noise_after_any_other_episode(noisy: ObjectNavEnv) -> None:
    first = observations_of(noisy, 7)
    other = observations_of(noisy, 8)
    assert same(first, observations_of(noisy, 7))
    for name in ("rgb", "depth", "gps", "compass"):
        assert not same(first, other, name), name


def test_episodes_without_a_new_seed_have_noise_of_their_own(noisy: ObjectNavEnv) -> None:
    first, _ = noisy.reset(seed=1)
    second, _ = noisy.reset()
    assert not np.array_equal(first["depth"], second["depth"])


def test_depth_does_not_depend_on_the_other_sensors(noisy: ObjectNavEnv, house: Path) -> None:
    lone = ObjectNavEnv(
        house=house, goal="sofa", start=Pose(-1.0, 0.5, 0.3), camera=SMALL, noise="harsh", sensors=("depth",)
    )
    assert same(observations_of(lone, 7), observations_of(noisy, 7), "depth", "gps", "compass")
    lone.close()


def test_noise_none_changes_nothing_and_needs_no_image(house: Path) -> None:
    noise = SensorNoise(get_noise("none"), SMALL, resolve_sensors(SENSORS))
    assert noise.images == ()
    assert noise.begin(np.random.default_rng(0), np.ones(3, np.float32)) is NOMINAL
    truth = {name: np.zeros(2, np.float32) for name in ("rgb", "depth", "gps", "compass")}
    assert all(value is truth[name] for name, value in noise.apply(truth, {}).items())
    options_of_each: tuple[dict[str, Any], ...] = ({}, {"noise": "none"})
    default, named = (
        ObjectNavEnv(house=house, goal="sofa", start=Pose(-1.0, 0.5, 0.3), camera=SMALL, **options)
        for options in options_of_each
    )
    assert same(observations_of(default, 0), observations_of(named, 3))
    default.close()
    named.close()


def test_noise_does_not_change_the_sampled_episodes(house: Path) -> None:
    starts = []
    for noise in ("none", "realsense"):
        env = ObjectNavEnv(house=house, camera=SMALL, noise=noise)
        starts.append([env.reset(seed=5 if i == 0 else None) and env.episode.start for i in range(3)])
        env.close()
    assert starts[0] == starts[1]


def test_metrics_are_never_noisy(house: Path) -> None:
    """With noise of the sensors alone the metrics and `semantic` are those of a run without noise."""
    sensors_only = replace(get_noise("harsh"), actuation=ActuationNoise())
    runs = []
    for noise in ("none", sensors_only):
        env = ObjectNavEnv(house=house, goal="sofa", start=Pose(-1.0, 0.5, 0.3), camera=SMALL, noise=noise)
        first, info = env.reset(seed=0)
        steps = [env.step(Action.MOVE_FORWARD) for _ in range(4)]
        runs.append(([info, *(step[4] for step in steps)], [first, *(step[0] for step in steps)]))
        env.close()
    assert runs[0][0] == runs[1][0]
    assert same(runs[0][1], runs[1][1], "semantic", "objectgoal")
    assert not same(runs[0][1], runs[1][1], "depth")


def test_noisy_observations_are_in_the_space_and_share_no_memory(noisy: ObjectNavEnv) -> None:
    first, _ = noisy.reset(seed=0)
    kept = {name: value.copy() for name, value in first.items()}
    second = noisy.step(Action.MOVE_FORWARD)[0]
    assert noisy.observation_space.contains(first)
    assert noisy.observation_space.contains(second)
    for name, value in first.items():
        np.testing.assert_array_equal(value, kept[name])
        assert not np.shares_memory(value, second[name])


def test_the_true_readings_are_not_changed() -> None:
    noise = SensorNoise(get_noise("harsh"), CAMERA, resolve_sensors(SENSORS))
    noise.begin(np.random.default_rng(0), np.ones(1, np.float32))
    truth: dict[str, Any] = {
        "rgb": np.full((*SHAPE, 3), 99, np.uint8),
        "depth": step_of(1.0, 3.0),
        "gps": np.zeros(2, np.float32),
        "compass": np.zeros(1, np.float32),
    }
    kept = {name: value.copy() for name, value in truth.items()}
    noise.apply(truth, {"geom": np.zeros(SHAPE, np.int32)})
    for name, value in truth.items():
        np.testing.assert_array_equal(value, kept[name])


@pytest.mark.parametrize(
    ("config", "values", "message"),
    [
        (DepthNoise, {"axial_m": -0.1}, "axial_m"),
        (DepthNoise, {"lateral_px": math.nan}, "lateral_px"),
        (DepthNoise, {"hole_share": 1.5}, "hole_share"),
        (DepthNoise, {"hole_gloss": 1.0}, "hole_gloss"),
        (DepthNoise, {"baseline_m": -0.05}, "baseline_m"),
        (DepthNoise, {"window_px": 6}, "odd"),
        (DepthNoise, {"window_px": 1}, "window_px"),
        (DepthNoise, {"edge_radius_px": 1.5}, "whole"),
        (DepthNoise, {"step_1_m": "fine"}, "fine"),
        (BumperSensor, {"sectors": 6.5}, "sectors must be a whole number"),
        (MapConfig, {"cells": 20.0}, "cells must be a whole number"),
        (RgbNoise, {"gain_std": 2.0}, "gain_std"),
        (RgbNoise, {"read_std": -1.0}, "read_std"),
        (PoseNoise, {"gps_std_m": math.inf}, "gps_std_m"),
        (PoseNoise, {"from_odometry": "yes"}, "from_odometry"),
        (ActuationNoise, {"floor_friction_scale": (1.0, 0.5)}, "floor_friction_scale"),
        (ActuationNoise, {"motor_gain_scale": 0.9}, "motor_gain_scale"),
        (ActuationNoise, {"motor_gain_scale": (0.0, 1.0)}, "motor_gain_scale"),
        (Conditions, {"floor_friction_scale": 0.0}, "floor_friction_scale"),
        (Conditions, {"motor_gain_scale": (1.0, math.nan)}, "motor_gain_scale"),
    ],
)
def test_a_value_out_of_range_is_refused(config: type, values: Mapping[str, Any], message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        config(**values)


def test_a_file_may_name_a_preset_and_change_some_of_it() -> None:
    assert noise_from_dict("harsh") == NOISE_PRESETS["harsh"]
    assert noise_from_dict({}) == NoiseConfig()
    config = noise_from_dict(
        {"preset": "realsense", "depth": {"hole_share": 1.0}, "actuation": {"motor_gain_scale": [0.5, 0.6]}}
    )
    preset = get_noise("realsense")
    assert config.depth == replace(preset.depth, hole_share=1.0)
    assert config.actuation == replace(preset.actuation, motor_gain_scale=(0.5, 0.6))
    assert (config.rgb, config.pose) == (preset.rgb, preset.pose)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ("loud", wording.NONE_REALSENSE_HARSH),
        ({"preset": "loud"}, wording.NONE_REALSENSE_HARSH),
        ({"preset": ["harsh"]}, wording.NONE_REALSENSE_HARSH),
        ({"sonar": {}}, wording.DEPTH_RGB_POSE_ACTUATION),
        ({"depth": {"fog": 1.0}}, "baseline_m"),
        ({"depth": 3}, "depth"),
        ({"depth": {"hole_share": 2}}, "hole_share"),
        ({"actuation": {"motor_gain_scale": ["a", "b"]}}, "motor_gain_scale"),
        (7, "7"),
    ],
)
def test_an_invalid_noise_file_is_refused_with_the_allowed_values(given: Any, message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        noise_from_dict(given)
