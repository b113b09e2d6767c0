"""Third-party scenes: unsupported elements are removed and reported, and our robot is not affected."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from sim.app.commands import run
from sim.core.errors import HouseError
from sim.core.geometry.pose import Pose
from sim.core.interface import MPCAT40_ID, Action
from sim.env.objectnav import ObjectNavEnv
from sim.gl import mujoco
from sim.houses.labels import ROBOT_PREFIX
from sim.houses.load import load_house
from sim.task.ground_truth import GroundTruth
from sim.world.world import World
from tests.helpers import wording
from tests.helpers.foreign import LABELS, SCENE, write_scene
from tests.helpers.worlds import room


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Returns a scene in another style, and its label rules."""
    return write_scene(tmp_path_factory.mktemp("scene") / "elsewhere")


@pytest.fixture(scope="module")
def world(scene: tuple[Path, Path]) -> World:
    return World(load_house(scene[0], labels_path=scene[1]))


def test_unsupported_elements_are_removed_and_reported(scene: tuple[Path, Path]) -> None:
    house = load_house(scene[0], labels_path=scene[1])
    assert house.notes == (
        "Removed: 1 keyframe (home), 1 sensor, 1 actuator (open), 1 camera (overview).",
        "Fixed in the pose of the file: 1 joint (sideboard_hinge).",
        "2 visible geoms have no label and became void: Gadget.box, Widget.",
    )
    with pytest.raises(HouseError, match=wording.MUST_NOT_HAVE_CAMERAS):
        load_house(scene[0])


def test_the_robot_is_the_same_in_every_style_of_file(world: World) -> None:
    """The file's compiler settings, options and default classes do not change the robot."""
    ours = World(room())
    for name in ("base", "left_wheel", "right_wheel"):
        for field in ("mass", "inertia", "ipos"):
            np.testing.assert_allclose(*(getattr(w.model.body(f"stubborn_robot/{name}"), field) for w in (world, ours)))
    for geom in ("lower_hull", "upper_hull", "left_tyre"):
        for field in ("friction", "condim", "solref", "margin", "priority", "contype", "conaffinity", "group", "size"):
            np.testing.assert_array_equal(
                *(getattr(w.model.geom(f"stubborn_robot/{geom}"), field) for w in (world, ours))
            )
    for field in ("timestep", "integrator", "cone", "disableflags", "enableflags"):
        assert getattr(world.model.opt, field) == getattr(ours.model.opt, field)


def test_bodies_with_a_free_joint_can_be_pushed_and_those_with_a_hinge_stay(world: World) -> None:
    world.reset(Pose(-2.05, 1.2, 0.0))
    before = world.data.body("Stool_7").xpos.copy()
    for _ in range(3):
        world.move(Action.MOVE_FORWARD)
    assert np.hypot(*(world.data.body("Stool_7").xpos - before)[:2]) > 0.05
    model = world.model
    hinged = model.geom_bodyid[[g for g in range(model.ngeom) if model.geom(g).name.startswith("Sideboard_door")]]
    assert len(hinged)
    assert not model.body_weldid[hinged].any()


def test_a_doorway_in_a_mesh_is_open(world: World) -> None:
    truth = GroundTruth(world)
    distance_m = truth.space().distance_at(truth.target("sofa").distance_m, -1.0, 0.0)
    assert 1.3 < distance_m < 2.6  # straight through, to within 1 m of the sofa's corner
    assert truth.target("sofa").region.satisfied(np.array([[1.3, 0.1]])).all()


def test_the_camera_shows_labels_and_unlabelled_geoms_as_void(scene: tuple[Path, Path]) -> None:
    start = Pose(0.6, -0.6, -0.43)
    env = ObjectNavEnv(house=scene[0], labels=scene[1], goal="sofa", start=start, truth=("geom",), profile="good")
    try:
        observation, _ = env.reset(seed=0)
        numbers, model = env.truth_images["geom"], env.scene.world.model
    finally:
        env.close()
    for geom, category in (("Gadget.box", "void"), ("Ground", "floor"), ("Shell.E", "wall")):
        number = model.geom(geom).id
        assert set(observation["semantic"][numbers == number]) == {MPCAT40_ID[category]}, geom
    assert observation["rgb"].std() > 5.0


@pytest.mark.costly
def test_the_oracle_succeeds_and_the_run_reports_removed_elements(
    scene: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    options = ["--house", str(scene[0]), "--labels", str(scene[1]), "--agent", "oracle", "--episodes", "3"]
    assert run.entry([*options, "--out", str(tmp_path / "run")]) == 0
    output = capsys.readouterr().out
    assert "House 'flat': 2 visible geoms have no label and became void: Gadget.box, Widget." in output
    lines = [json.loads(line) for line in (tmp_path / "run" / "results.jsonl").read_text().splitlines()]
    assert [line["success"] for line in lines] == [1.0, 1.0, 1.0]


def test_a_scene_without_a_floor_is_refused_with_the_names_of_unlabelled_geoms(tmp_path: Path) -> None:
    rules = {pattern: category for pattern, category in LABELS.items() if category != "floor"}
    house, labels = write_scene(tmp_path / "s", labels=rules)
    with pytest.raises(HouseError, match=r"floor.*3.*label.*Ground.*Gadget.box"):
        load_house(house, labels_path=labels)


def test_a_missing_mesh_is_reported_in_one_sentence(tmp_path: Path) -> None:
    house, labels = write_scene(tmp_path / "s", scene=SCENE)
    (house.parent / "meshes" / "arch.obj").unlink()
    with pytest.raises(HouseError, match=r"flat\.xml.*arch\.obj") as refused:
        load_house(house, labels_path=labels)
    assert "\n" not in str(refused.value)


def test_a_house_may_have_names_that_begin_with_robot_but_not_with_our_prefix(tmp_path: Path) -> None:
    spec = room(6, 6).spec
    for number, name in enumerate(("robot/base", "robot/arm")):
        body = spec.worldbody.add_body(name=name, pos=[1.0 + number, 1.0, 0.4])
        body.add_geom(name=f"table_{number:02d}", type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.2, 0.2, 0.4])
    file = tmp_path / "house.xml"
    file.write_text(spec.to_xml())
    world = World(load_house(file))
    assert [each.name for each in world.labels.of_category("table")] == ["table_00", "table_01"]
    assert not world.free_space().is_free(1.0, 1.0)
    spec.bodies[-1].name = f"{ROBOT_PREFIX}base"
    file.write_text(spec.to_xml())
    with pytest.raises(HouseError, match=wording.ARE_THE_ROBOT_S):
        load_house(file)
