"""Robots of MuJoCo Menagerie: those with a differential drive get a sidecar of ours, others are refused in one line."""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path
from typing import Any

import pytest

from sim.app.commands import run
from sim.core.geometry.pose import Pose
from sim.core.interface import Action, ConfigError
from sim.houses.labels import opacity
from sim.robot.foreign import absolute_robot, load_robot, robot_sha256
from sim.robot.menagerie import ENTRIES, NOT_DIFFERENTIAL, SIDECARS
from sim.world.world import World
from tests.helpers.worlds import open_floor, with_box

TIAGO = json.loads((SIDECARS / "pal_tiago.json").read_text())
ARM = [name for name in TIAGO["joints"] if name.startswith("arm")]
STAND_IN = f"""
<mujoco>
  <compiler angle="radian" fusestatic="true"/>
  <worldbody>
    <body name="base_link" pos="0.3 0 0.2"><freejoint/>
      <geom name="shell" type="cylinder" size="0.25 0.1" pos="0 0 0.03" mass="40" group="3"/>
      <geom name="paint" type="cylinder" size="0.25 0.1" pos="0 0 0.03" mass="0" contype="0" conaffinity="0"/>
      <body pos="0 0.2 0"><joint name="wheel_left_joint" axis="0 1 0"/><geom size="0.09" mass="4"/></body>
      <body pos="0 -0.2 0"><joint name="wheel_right_joint" axis="0 -1 0"/><geom size="0.09" mass="4"/></body>
      {"".join(f'<body name="{name}" pos="0.1 0 -0.08"><geom size="0.018"/></body>' for name in TIAGO["casters"])}
      <body><joint name="torso_lift_joint" type="slide" axis="0 0 1"/>
      {"".join(f'<body><joint name="{name}"/>' for name in ARM)}
      <geom name="hand" size="0.03" pos="0.1 0 0.5" mass="1"/>
      {"</body>" * len(ARM)}</body>
    </body>
  </worldbody>
</mujoco>
"""
"""A robot with the names of TIAGo that its sidecar needs, so that a test needs no download; its arm turns about z."""


@pytest.fixture
def menagerie() -> Any:
    """Returns the package; skips the test without it."""
    return pytest.importorskip("mujoco_menagerie", reason="needs the extra `menagerie`")


@pytest.fixture
def stand_in(menagerie: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Returns the file of the stand-in for TIAGo in a checkout of Menagerie that has nothing else."""
    del menagerie
    file = tmp_path / "pal_tiago" / "tiago.xml"
    file.parent.mkdir()
    file.write_text(STAND_IN)
    monkeypatch.setenv("MENAGERIE_ROOT", str(tmp_path))
    return file


def test_a_robot_of_menagerie_is_its_model_with_our_sidecar(stand_in: Path, tmp_path: Path) -> None:
    config, camera = load_robot("menagerie:pal_tiago")
    assert config.file is not None
    assert config.file.path == stand_in
    assert (camera.height_m, config.camera_forward_m) == (TIAGO["camera_height_m"], TIAGO["camera_forward_m"])
    assert config.wheels.radius_m == TIAGO["wheel_radius_m"]
    world = World(open_floor(), robot=config)
    world.reset(Pose(0.0, 0.0, 0.0))
    hand, turned = world.data.geom("stubborn_robot/file/hand").xpos, sum(TIAGO["joints"][name] for name in ARM)
    height_m = TIAGO["wheel_radius_m"] + 0.5 + TIAGO["joints"]["torso_lift_joint"]
    assert hand == pytest.approx((0.1 * math.cos(turned), 0.1 * math.sin(turned), height_m), abs=1e-3)
    copy = tmp_path / "copy.xml"
    copy.write_text(STAND_IN)
    copy.with_suffix(".json").write_text(json.dumps(TIAGO | {"camera_height_m": 1.0}))
    assert robot_sha256("menagerie:pal_tiago") != robot_sha256(copy)


def test_viewers_show_the_visual_geoms_of_a_model_and_not_its_collision_geoms(stand_in: Path) -> None:
    model = World(open_floor(), robot=load_robot("menagerie:pal_tiago")[0]).model
    shown = opacity(model)
    assert shown[model.geom("stubborn_robot/file/paint").id] > 0.0
    assert shown[model.geom("stubborn_robot/file/shell").id] == 0.0
    assert shown[model.geom("stubborn_robot/file/left_tyre").id] == 0.0


def test_a_name_stays_valid_in_another_folder() -> None:
    assert absolute_robot("menagerie:pal_tiago") == "menagerie:pal_tiago"
    assert absolute_robot("carrier.xml") == str(Path("carrier.xml").absolute())


@pytest.mark.parametrize("name", [*NOT_DIFFERENTIAL, "unitree_go2", "sketch"])
def test_a_robot_that_cannot_be_driven_is_refused_in_one_line(
    menagerie: Any, name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run.entry(["--robot", f"menagerie:{name}", "--agent", "random"]) == 2
    error = capsys.readouterr().err
    assert len(error.strip().splitlines()) == 1
    assert f"The robots are: {', '.join(ENTRIES)}." in error
    assert ("there is no such robot" in error) == (name == "sketch")
    assert ("has no wheels" in error) == (name == "unitree_go2")
    assert (name in menagerie.names()) == (name != "sketch")


def test_without_the_package_one_line_says_how_to_install_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "mujoco_menagerie", None)
    with pytest.raises(ConfigError, match=r"pip install 'stubborn-objectnav\[menagerie\]'"):
        load_robot("menagerie:pal_tiago")


def test_a_model_that_cannot_be_downloaded_is_reported_in_one_line(
    menagerie: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MENAGERIE_ROOT", str(tmp_path))
    with pytest.raises(ConfigError, match=r"^--robot.*pal_tiago.*[^\n]*$"):
        load_robot("menagerie:pal_tiago")


def test_each_entry_of_the_table_is_a_model_of_menagerie_and_has_a_sidecar(menagerie: Any) -> None:
    assert {file.stem for file in SIDECARS.glob("*.json")} == set(ENTRIES)
    for name, entry in ENTRIES.items():
        assert entry in menagerie.get(name).entry_names
    assert set(NOT_DIFFERENTIAL) <= set(menagerie.names())


@pytest.mark.slow  # some seconds for each robot
@pytest.mark.parametrize("name", ENTRIES)
def test_a_robot_of_menagerie_drives_turns_and_bumps(menagerie: Any, name: str) -> None:
    cache = menagerie.Cache()
    if not (cache.root / name).is_dir() if cache.root else not cache.is_cached(menagerie.get(name)):
        pytest.skip("the model was not downloaded to this machine")
    config, _ = load_robot(f"menagerie:{name}")
    assert config.body.radius_m < 0.6  # its arms are folded: stretched ones reach farther
    wall = with_box(open_floor(), "wall_00", centre_m=(1.35, 0.0, 1.0), half_m=(0.1, 2.0, 1.0))
    world = World(wall, robot=config)
    world.reset(Pose(0.0, 0.0, 0.0))
    assert world.move(Action.MOVE_FORWARD).displacement_m == pytest.approx(0.25, abs=0.003)
    for action, sign in ((Action.TURN_LEFT, 1.0), (Action.TURN_RIGHT, -1.0)):
        assert math.degrees(world.move(action).yaw_change_rad) == pytest.approx(sign * 30.0, abs=0.5)
    motions = [world.move(Action.MOVE_FORWARD) for _ in range(5)]
    assert motions[-1].collided
    assert {contact.instance for contact in motions[-1].contacts} == {"wall_00"}
