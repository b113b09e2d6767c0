"""Third-party robots keep their masses and shapes and drive like ours; unusable files are refused."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from sim.app.commands import run
from sim.core.geometry.pose import Pose
from sim.core.interface import Action, ConfigError
from sim.env.objectnav import ObjectNavEnv
from sim.robot.config import RobotConfig
from sim.robot.foreign import load_robot, robot_sha256
from sim.world.world import World
from tests.helpers.foreign import HOLLOW, ROBOT, TWO_BODIES, write_robot
from tests.helpers.worlds import open_floor, room, with_box


@pytest.fixture(scope="module")
def carrier(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Returns a robot in another style: a deck on two wheels and a caster, with a mast and a head."""
    return write_robot(tmp_path_factory.mktemp("robot") / "carrier")


def _tyres(world: World) -> np.ndarray:
    return np.array([world.data.geom(f"stubborn_robot/file/{side}_tyre").xpos for side in ("left", "right")])


def test_a_robot_keeps_its_own_masses_and_shapes(carrier: Path, capfd: pytest.CaptureFixture[str]) -> None:
    config, camera = load_robot(carrier)
    assert config.model.radius_m == pytest.approx(math.hypot(0.02 + 0.14, 0.12) + 0.005)  # the deck's corner and skin
    assert config.model.height_m == pytest.approx(0.075 + 0.1 + 0.65 + 0.05 + 0.005)
    assert camera.height_m == 0.82
    world = World(open_floor(), robot=config)
    world.reset(Pose(1.0, 2.0, 0.5 * math.pi))
    base = world.model.body("stubborn_robot/base").id
    assert world.model.body_subtreemass[base] == pytest.approx(9 + 2 * 0.5 + 0.1 + 1.5 + 0.8)
    np.testing.assert_allclose(world.data.geom("stubborn_robot/file/deck").xpos, (1.0, 2.02, 0.135), atol=1e-3)
    np.testing.assert_allclose(_tyres(world), [(0.85, 2.0, 0.075), (1.15, 2.0, 0.075)], atol=1e-3)
    ours, hull = (
        World(open_floor()).model.geom("stubborn_robot/lower_hull"),
        world.model.geom("stubborn_robot/file/mast.0"),
    )
    for field in ("friction", "condim", "solref", "priority", "contype", "conaffinity", "group"):
        np.testing.assert_array_equal(getattr(hull, field), getattr(ours, field))
    assert hull.margin[0] == world.config.body.skin_m == 0.005
    assert capfd.readouterr().err == ""  # MuJoCo gave no warning


def test_the_checksum_of_a_robot_covers_its_meshes(tmp_path: Path) -> None:
    robot = write_robot(tmp_path / "r")
    before = robot_sha256(robot)
    mesh = robot.parent / "parts" / "cube.obj"
    mesh.write_text(mesh.read_text() + "# changed\n")
    assert robot_sha256(robot) != before


def test_a_folder_is_no_robot() -> None:
    with pytest.raises(ConfigError, match=r"--robot.*'/'"):
        load_robot("/")


def test_the_pose_of_the_robot_in_its_file_does_not_matter(carrier: Path, tmp_path: Path) -> None:
    elsewhere = write_robot(tmp_path / "r", robot=ROBOT.replace('pos="0.4 0.1 0.075"', 'pos="-3 2 0.4"'))
    (here, _), (there, _) = load_robot(carrier), load_robot(elsewhere)
    assert there.body.height_m == pytest.approx(here.body.height_m)
    assert there.body.radius_m == pytest.approx(here.body.radius_m)
    worlds = [World(open_floor(), robot=config) for config in (here, there)]
    for world in worlds:
        world.reset(Pose(1.0, 0.0, 0.0))
    np.testing.assert_allclose(_tyres(worlds[0]), _tyres(worlds[1]), atol=1e-6)


def test_motors_have_the_same_force_and_lag_per_kilogram_as_ours(carrier: Path) -> None:
    theirs, ours = load_robot(carrier)[0], RobotConfig()
    for of in (lambda wheels: wheels.max_push_n, lambda wheels: wheels.motor_gain_nm_s / wheels.radius_m**2):
        assert of(theirs.wheels) / theirs.body.mass_kg == pytest.approx(of(ours.wheels) / ours.body.mass_kg)


@pytest.mark.parametrize("box_floor", [False, True])
def test_a_third_party_robot_drives_as_exactly_as_ours(carrier: Path, box_floor: bool) -> None:
    world = World(room(6, 6, box_floor=box_floor), robot=load_robot(carrier)[0])
    world.reset(Pose(0.0, 0.0, 0.3))
    for action in (Action.MOVE_FORWARD, Action.TURN_LEFT, Action.MOVE_FORWARD, Action.TURN_RIGHT) * 2:
        motion = world.move(action)
        assert motion.ended == "reached"
        forward_m, turn = (0.25, 0.0) if action == Action.MOVE_FORWARD else (0.0, math.radians(30.0))
        assert motion.displacement_m == pytest.approx(forward_m, abs=0.002)
        assert abs(motion.yaw_change_rad) == pytest.approx(turn, abs=0.003)
        assert motion.yaw_change_rad * (1 if action == Action.TURN_LEFT else -1) > -0.003
    x, y = (0.5 * (trig(0.3) + trig(0.3 + math.pi / 6)) for trig in (math.cos, math.sin))
    assert (world.pose.x_m, world.pose.y_m) == pytest.approx((x, y), abs=0.01)


@pytest.mark.parametrize(
    ("low_m", "high_m", "stops_at_m"),
    [(0.0, 0.3, 1.0 - 0.165), (0.3, 0.5, 1.0 - 0.035), (0.76, 0.86, 1.0 - 0.055), (0.95, 1.2, math.inf)],
    ids=["deck", "mast", "head", "nothing"],
)
def test_a_third_party_robot_collides_with_its_own_shape(
    carrier: Path, low_m: float, high_m: float, stops_at_m: float
) -> None:
    centre, half = (1.25, 0.0, 0.5 * (low_m + high_m)), (0.25, 0.5, 0.5 * (high_m - low_m))
    world = World(with_box(open_floor(), "table_00", centre_m=centre, half_m=half), robot=load_robot(carrier)[0])
    world.reset(Pose(0.0, 0.0, 0.0))
    motions = [world.move(Action.MOVE_FORWARD) for _ in range(6)]
    if math.isinf(stops_at_m):
        assert not any(motion.collided for motion in motions)
        return
    hit = next(motion for motion in motions if motion.collided)
    assert [contact.instance for contact in hit.contacts] == ["table_00"]
    assert world.pose.x_m == pytest.approx(stops_at_m, abs=0.012)  # it backs off by millimetres


def test_a_robot_whose_file_faces_another_direction_drives_in_the_same_direction(carrier: Path, tmp_path: Path) -> None:
    turned = ROBOT.replace('pos="0.4 0.1 0.075">', 'pos="0.4 0.1 0.075" euler="90 0 0">')
    with pytest.raises(ConfigError, match=r"\+x.*heading_deg"):
        load_robot(write_robot(tmp_path / "as_it_is", robot=turned))
    config, _ = load_robot(write_robot(tmp_path / "given", robot=turned, heading_deg=90))
    ours, _ = load_robot(carrier)
    assert config.body.radius_m == pytest.approx(ours.body.radius_m)
    ends = []
    for robot in (config, ours):
        world = World(room(6, 6), robot=robot)
        world.reset(Pose(0.0, 0.0, 0.0))
        for action in (Action.MOVE_FORWARD, Action.TURN_LEFT, Action.MOVE_FORWARD):
            world.move(action)
        ends.append((world.pose.x_m, world.pose.y_m, world.pose.yaw_rad))
    assert ends[0] == pytest.approx(ends[1], abs=2e-3)
    assert ends[0][1] > 0.05


def test_the_track_is_that_of_the_sidecar(tmp_path: Path) -> None:
    config, _ = load_robot(write_robot(tmp_path / "r", track_m=0.26))
    assert config.wheels.half_track_m == pytest.approx(0.13)
    world = World(open_floor(), robot=config)
    world.reset(Pose(1.0, 2.0, 0.5 * math.pi))
    np.testing.assert_allclose(_tyres(world), [(0.87, 2.0, 0.075), (1.13, 2.0, 0.075)], atol=1e-3)
    assert math.degrees(world.move(Action.TURN_LEFT).yaw_change_rad) == pytest.approx(30.0, abs=0.2)


def test_the_limits_of_speed_and_acceleration_are_those_of_the_sidecar(carrier: Path, tmp_path: Path) -> None:
    slow, _ = load_robot(write_robot(tmp_path / "r", speed_m_s=0.2, acceleration_m_s2=0.4))
    durations_s = []
    for config in (slow, load_robot(carrier)[0]):
        world = World(open_floor(), robot=config)
        world.reset(Pose(0.0, 0.0, 0.0))
        durations_s.append(world.move(Action.MOVE_FORWARD).duration_s)
    assert durations_s == pytest.approx([0.25 / 0.2 + 0.2 / 0.4, 1.0], abs=0.15)


def test_joints_are_fixed_where_the_sidecar_says(tmp_path: Path) -> None:
    config, _ = load_robot(write_robot(tmp_path / "r", joints={"pan": 0.5 * math.pi}))
    world = World(open_floor(), robot=config)
    world.reset(Pose(0.0, 0.0, 0.0))
    head = world.data.geom("stubborn_robot/file/head.0").xmat.reshape(3, 3)
    np.testing.assert_allclose(head[:, 0], (0.0, 1.0, 0.0), atol=1e-3)


def test_the_camera_is_mounted_where_the_sidecar_says(tmp_path: Path) -> None:
    (tmp_path / "room.xml").write_text(
        with_box(room(4, 4), "sofa_00", centre_m=(0, 1.5, 0.2), half_m=(0.2, 0.2, 0.2)).spec.to_xml()
    )
    depths = []
    for number, forward_m in enumerate((0.0, 0.12, -0.1)):
        config, camera = load_robot(write_robot(tmp_path / str(number), camera_forward_m=forward_m))
        assert config.model.camera_forward_m == forward_m
        start = Pose(-1.0, 0.0, 0.0)
        env = ObjectNavEnv(
            house=tmp_path / "room.xml", goal="sofa", start=start, robot=config, camera=camera, sensors=("depth",)
        )
        try:
            observation, _ = env.reset(seed=0)
            depths.append(float(observation["depth"][240, 320]))
            assert observation["gps"] == pytest.approx((0.0, 0.0), abs=0.002)  # the robot's place, not the camera's
        finally:
            env.close()
    assert depths == pytest.approx([3.0, 2.88, 3.1], abs=0.01)


def test_a_run_records_its_robot_and_is_not_resumed_with_another(
    carrier: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    house = with_box(room(6, 4), "sofa_00", centre_m=(2.5, 0, 0.4), half_m=(0.4, 0.8, 0.4))
    (tmp_path / "lounge.xml").write_text(house.spec.to_xml())
    options = ["--house", str(tmp_path / "lounge.xml"), "--agent", "oracle", "--out", str(tmp_path / "run")]
    options += ["--start-deg", "-2 0 90", "--episodes", "1"]
    assert run.entry([*options, "--robot", str(carrier)]) == 0
    config = json.loads((tmp_path / "run" / "config.json").read_text())
    assert config["robot"] == str(carrier)
    assert len(config["files_sha256"]["robot"]) == 64
    assert run.entry(options) == 2
    assert "robot" in capsys.readouterr().err
    options[-3:] = ["0 1.81 53", "--episodes", "1"]  # ours fits there, a corner of the deck does not
    assert run.entry([*options, "--robot", str(carrier), "--out", str(tmp_path / "tight")]) == 2
    assert "the robot (radius 0.20" in capsys.readouterr().err


WRONG = {
    "no such joint": ({"wheel_joints": ["hub_l", "hub_x"]}, {}, "no joint 'hub_x'.*The hinges are: hub_l, hub_r, pan"),
    "one joint": ({"wheel_joints": ["hub_l"]}, {}, '"wheel_joints": '),
    "swapped joints": ({"wheel_joints": ["hub_r", "hub_l"]}, {}, r"on the left \(\+y\)"),
    "no radius of the wheels": ({"wheel_radius_m": None}, {}, '"wheel_radius_m", a number > 0; it has null'),
    "an unknown key": ({"wheel_radius": 0.1}, {}, "unknown key 'wheel_radius'. The keys are: wheel_joints"),
    "an unknown caster": ({"casters": ["caster"]}, {}, "no geom and no body 'caster'"),
    "a caster that is not named": ({"casters": []}, {}, r"reaches down to -?0\.00\d m .*'castor'.*sliding.*casters"),
    "a track that is no length": ({"track_m": -0.3}, {}, '"track_m", a number > 0; it has -0.3'),
    "joints as a list": ({"joints": ["pan"]}, {}, '"joints" in its sidecar must be an object with a position'),
    "a wheel in a pose": ({"joints": {"hub_l": 1.0}}, {}, "must not name the wheel joint 'hub_l'"),
    "a pose out of range": ({"joints": {"pan": 2.0}}, {}, r"'pan' in the sidecar must lie in \[-1.571, 1.571\] rad"),
    "a radius that is too small": ({"radius_m": 0.15}, {}, r"radius_m in the sidecar is 0\.150 m.*at least 0\.205"),
    "a camera outside": ({"camera_forward_m": 0.5}, {}, r"camera_forward_m must be within .* 0\.205 m"),
    "a robot that heads along y": ({}, {'"0.4 0.1 0.075"': '"0.4 0.1 0.075" euler="90 0 0"'}, "with .x ahead"),
    "a wheel that slides": ({}, {'name="hub_l"': 'name="hub_l" type="slide"'}, "'hub_l' is a slide"),
    "a mesh that is missing": ({}, {"cube.obj": "deck.obj"}, r"deck\.obj"),
    "another format": ({}, {"<mujoco": "<robot"}, "not an MJCF file that MuJoCo can read"),
    "two bodies": ({"casters": None}, {ROBOT: TWO_BODIES}, "belong to different bodies of the world"),
    "no collision geom": ({}, {"</default>\n  </default>": HOLLOW}, "no collision geom"),
}


@pytest.mark.parametrize(("sidecar", "changed", "sentence"), WRONG.values(), ids=WRONG)
def test_an_unusable_robot_is_refused_in_one_sentence(
    tmp_path: Path, sidecar: dict[str, object], changed: dict[str, str], sentence: str
) -> None:
    text = ROBOT
    for before, after in changed.items():
        assert before in text
        text = text.replace(before, after)
    file = write_robot(tmp_path / "r", robot=text, **sidecar)
    with pytest.raises(ConfigError, match=sentence) as refused:
        load_robot(file)
    assert "carrier.xml" in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_missing_sidecar_is_reported_with_its_name(carrier: Path, tmp_path: Path) -> None:
    (tmp_path / "carrier.xml").write_text(carrier.read_text())
    with pytest.raises(ConfigError, match=r"'.*carrier\.json'"):
        load_robot(tmp_path / "carrier.xml")


def test_small_wheels_climb_less_than_ours(carrier: Path, tmp_path: Path) -> None:
    assert load_robot(carrier)[0].model.climb_m == RobotConfig().climb_m
    small = write_robot(tmp_path / "r", wheel_radius_m=0.06)
    assert load_robot(small)[0].model.climb_m == pytest.approx(0.18 * 0.06)
