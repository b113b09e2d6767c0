"""A sensor and a noise model of a user, defined outside of the project and used through the environment."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import gymnasium
import numpy as np
import pytest
from gymnasium import spaces
from gymnasium.utils.env_checker import check_env
from numpy.typing import NDArray

from sim.core.geometry.pose import Pose
from sim.core.interface import (
    GOAL_SENSORS,
    POSE_SENSORS,
    ROBOT_SENSORS,
    SEMANTIC_MAP,
    SENSORS,
    Action,
    CameraModel,
    ConfigError,
    reads_truth,
)
from sim.env.objectnav import ObjectNavEnv
from sim.sensors.cameras import CameraSensor
from sim.sensors.noise import NoiseConfig, get_noise
from sim.sensors.sensor import NoiseSettings, SensorContext
from sim.sensors.standard import STANDARD_SENSORS, DepthSensor, resolve_sensors
from tests.helpers import wording
from tests.helpers.worlds import room, with_box

SMALL = CameraModel(width_px=64, height_px=48)


@dataclass(frozen=True)
class BumperNoise:
    """Bumper switches that do not close at some contacts."""

    miss_rate: float = 0.0

    def model(self, camera: CameraModel) -> MissingContacts | None:
        return MissingContacts(self.miss_rate) if self.miss_rate else None


class MissingContacts:
    """Applies a `BumperNoise`."""

    sensors = ("switches",)
    images = ()

    def __init__(self, miss_rate: float) -> None:
        self._miss_rate = miss_rate

    def begin(self, gloss: NDArray[np.float32]) -> None:
        """Does nothing: no state is kept between episodes."""

    def apply(
        self, readings: Mapping[str, NDArray], images: Mapping[str, NDArray], rng: np.random.Generator
    ) -> dict[str, NDArray]:
        closed = readings["switches"] * (rng.random(2) >= self._miss_rate)
        return {"switches": closed.astype(np.int8)}


@dataclass(frozen=True)
class Bumper:
    """Two bumper switches, left and right: 1 after an action during which the body touched something on that side."""

    name: str = "switches"
    images: tuple[str, ...] = ()
    reads: tuple[str, ...] = ("motion", "pose")
    noise: NoiseSettings | None = None

    def space(self, camera: CameraModel) -> spaces.MultiBinary:
        return spaces.MultiBinary(2)

    def read(self, context: SensorContext) -> NDArray:
        closed = np.zeros(2, np.int8)
        for contact in context.motion.contacts if context.motion else ():
            x_m, y_m, _ = contact.position_m
            closed[int(Pose(x_m, y_m, 0.0).relative_to(context.pose).y_m < 0.0)] = 1
        return closed


@dataclass(frozen=True)
class DepthAhead:
    """The depth of the middle pixel: a sensor that needs a rendered image that is not in the observation."""

    name: str = "ahead"
    images: tuple[str, ...] = ("depth",)
    noise: NoiseSettings | None = None

    def space(self, camera: CameraModel) -> spaces.Box:
        return spaces.Box(0.0, camera.max_depth_m, (1,), np.float32)

    def read(self, context: SensorContext) -> NDArray:
        depth_m = context.images["depth"]
        return depth_m[depth_m.shape[0] // 2, depth_m.shape[1] // 2].reshape(1).copy()


@dataclass(frozen=True)
class Fog:
    """Noise of the depth image: no returns beyond some distance."""

    visibility_m: float

    sensors = ("depth",)
    images = ()

    def model(self, camera: CameraModel) -> Fog:
        return self

    def begin(self, gloss: NDArray[np.float32]) -> None:
        """Does nothing: no state is kept between episodes."""

    def apply(
        self, readings: Mapping[str, NDArray], images: Mapping[str, NDArray], rng: np.random.Generator
    ) -> dict[str, NDArray]:
        return {"depth": np.where(readings["depth"] > self.visibility_m, np.float32(0.0), readings["depth"])}


@dataclass(frozen=True, kw_only=True)
class NoiseWithBumper(NoiseConfig):
    """The noise configuration with one more field."""

    bumper: BumperNoise = BumperNoise()


def observations(house: Path, actions: list[Action], **options) -> list[dict[str, NDArray]]:
    env = ObjectNavEnv(
        house=house, goal="sofa", camera=SMALL, **{"start": Pose(-2.0, 0.0, np.pi), "sensors": (), **options}
    )
    try:
        return [env.reset(seed=0)[0], *(env.step(action)[0] for action in actions)]
    finally:
        env.close()


def test_the_standard_sensors_are_those_of_the_interface() -> None:
    assert tuple(STANDARD_SENSORS) == (*SENSORS, *POSE_SENSORS, *ROBOT_SENSORS, *GOAL_SENSORS, SEMANTIC_MAP)


@pytest.mark.filterwarnings("error")
def test_an_environment_with_own_sensors_passes_the_check_of_gymnasium(house: Path) -> None:
    sensors = ("depth", Bumper(), DepthAhead())
    env = gymnasium.make("sim.gym:stubborn/ObjectNav-v0", house=house, goal="sofa", camera=SMALL, sensors=sensors)
    check_env(env.unwrapped)
    assert list(env.reset(seed=0)[0]) == ["depth", "switches", "ahead", *POSE_SENSORS]
    env.close()


def test_a_bumper_reads_the_contacts_of_the_last_action(house: Path) -> None:
    """The wall is 0.82 m ahead; a robot that faces it at a right angle stops at it."""
    seen = observations(house, [Action.MOVE_FORWARD] * 5, sensors=(Bumper(),))
    assert [bool(each["switches"].any()) for each in seen] == [False, False, False, False, True, True]


def test_a_sensor_that_needs_an_image_does_not_add_it_to_the_observation(house: Path) -> None:
    (seen,) = observations(house, [], sensors=(DepthAhead(),), start=Pose(0.0, 0.0, 0.0))
    assert seen["ahead"][0] == pytest.approx(3.0, abs=0.01)  # the wall above the sofa
    assert "depth" not in seen


@pytest.mark.parametrize(
    "options",
    [
        {"sensors": (Bumper(noise=BumperNoise(miss_rate=1.0)),)},
        {"sensors": (Bumper(),), "noise": NoiseWithBumper(bumper=BumperNoise(miss_rate=1.0))},
    ],
    ids=["of the sensor", "a field of the configuration"],
)
def test_own_noise_is_applied_whether_the_sensor_or_the_configuration_has_it(house: Path, options: dict) -> None:
    seen = observations(house, [Action.MOVE_FORWARD] * 5, **options)
    assert not any(each["switches"].any() for each in seen)


def test_a_standard_sensor_takes_an_own_noise_model(house: Path) -> None:
    clear, foggy = (
        observations(house, [], sensors=(sensor,), start=Pose(0.0, 0.0, 0.0))[0]["depth"]
        for sensor in ("depth", replace(DepthSensor(), noise=Fog(2.0)))
    )
    assert foggy.max() <= 2.0 < clear.max()
    np.testing.assert_array_equal(foggy[clear <= 2.0], clear[clear <= 2.0])


def test_a_noise_that_does_not_change_its_sensor_is_refused(house: Path) -> None:
    left = CameraSensor(camera="left", image="depth", noise=Fog(2.0))  # the fog of `depth`
    with pytest.raises(ConfigError, match="'left_depth' has a noise that does not change it but: depth"):
        ObjectNavEnv(house=house, goal="sofa", sensors=("depth", left))


def test_own_sensors_and_noise_do_not_change_the_noise_of_the_others(house: Path) -> None:
    own = (Bumper(noise=BumperNoise(miss_rate=0.5)), DepthAhead())
    with_own, without = (
        observations(house, [Action.TURN_LEFT], sensors=(*SENSORS, *more), noise=get_noise("harsh"))
        for more in (own, ())
    )
    for one, other in zip(with_own, without, strict=True):
        for name in SENSORS + POSE_SENSORS:
            np.testing.assert_array_equal(one[name], other[name])


def test_a_sensor_gets_the_images_that_it_declares_and_no_others(house: Path) -> None:
    class Peeking(DepthAhead):
        def read(self, context: SensorContext) -> NDArray:
            assert list(context.images) == ["depth"]
            return context.images["semantic"]

    with pytest.raises(ConfigError, match=r"'ahead'.*'semantic'"):
        observations(house, [], sensors=(Peeking(),))


def test_a_string_is_not_a_tuple_of_names() -> None:
    with pytest.raises(ConfigError, match="'depth'"):
        resolve_sensors("depth")
    with pytest.raises(ConfigError, match="'depth'"):
        resolve_sensors((replace(DepthAhead(), images="depth"),))  # type: ignore[arg-type]


def test_a_name_given_twice_counts_once_and_two_sensors_with_one_name_are_refused() -> None:
    names = [sensor.name for sensor in resolve_sensors(("depth", "rgb", "depth"))]
    assert names == ["depth", "rgb", *POSE_SENSORS]
    with pytest.raises(ConfigError, match="'depth'"):
        resolve_sensors(("depth", replace(DepthSensor(), noise=Fog(2.0))))


class Constant:
    """A sensor whose reading is given; its space holds one float32 number in [0, 1]."""

    name, images, noise = "constant", (), None

    def __init__(self, value: object) -> None:
        self._value = value

    def space(self, camera: CameraModel) -> spaces.Box:
        return spaces.Box(0.0, 1.0, (1,), np.float32)

    def read(self, context: SensorContext) -> NDArray:
        return self._value  # type: ignore[return-value]


@pytest.mark.parametrize("value", [0.5, np.array([0.5]), np.array([2.0], np.float32), np.zeros(2, np.float32)])
def test_a_reading_that_is_not_in_the_space_of_its_sensor_is_refused(value: object, tmp_path: Path) -> None:
    file = tmp_path / "room.xml"
    house = with_box(room(5, 5), "sofa_00", centre_m=(2.0, 0, 0.4), half_m=(0.3, 0.8, 0.4))
    file.write_text(house.spec.to_xml())
    env = ObjectNavEnv(house=file, sensors=(Constant(value),), camera=SMALL)
    with pytest.raises(ConfigError, match="'constant'"):
        env.reset(seed=0)
    env.close()


class NoNoise:
    name, images, space, read = "half", (), Constant.space, Constant.read


class Gps(Constant):
    name = "gps"


class Imu(Constant):
    name = "imu"


@pytest.mark.parametrize(
    ("sensor", "message"),
    [
        (Constant, wording.CONSTANT_IS_A_CLASS_GIVE_AN_OBJECT),
        (NoNoise(), "NoNoise"),
        (Gps(0.0), "'gps'"),
        (Imu(0.0), "'imu'"),
    ],
)
def test_an_object_that_is_no_sensor_is_refused_in_one_sentence(sensor: object, message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        resolve_sensors((sensor,))  # type: ignore[arg-type]


@pytest.mark.parametrize("field", ["goal", "collided", "odometry", "pose", "start", "motion", "model", "data"])
def test_a_sensor_gets_the_fields_that_it_declares_and_no_others(field: str, house: Path) -> None:
    class Reader(Constant):
        name = "reader"

        def read(self, context: SensorContext) -> NDArray:
            getattr(context, field)
            return np.zeros(1, np.float32)

    with pytest.raises(ConfigError, match=rf"Sensor 'reader' reads context.{field}, which it does not declare"):
        observations(house, [], sensors=(Reader(0.0),))
    declared = Reader(0.0)
    declared.reads = (field,)  # type: ignore[attr-defined]
    assert observations(house, [], sensors=(declared,))[0]["reader"] == 0.0
    assert reads_truth(declared) == (field not in ("goal", "collided", "odometry"))


def test_the_noise_of_a_sensor_gets_the_images_that_it_declares_and_no_others(house: Path) -> None:
    class Peeking(Fog):
        def apply(self, readings: Mapping, images: Mapping, rng: np.random.Generator) -> dict:
            return {"depth": images["semantic"]}

    with pytest.raises(KeyError, match="semantic"):
        observations(house, [], sensors=(replace(DepthSensor(), noise=Peeking(2.0)),))
