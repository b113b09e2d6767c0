"""A house by MolmoSpaces' rules gets its labels from its metadata, its floor at z = 0, rooms, and an open door."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.app.commands.importing import molmospaces as command
from sim.core.errors import ConfigError
from sim.episodes.splits import labels_of
from sim.homes.importers.molmospaces import import_scene, rules_of
from sim.houses.geoms import data_at_rest
from sim.houses.house import read_rooms
from sim.houses.labels import read_labels
from sim.houses.load import load_house
from sim.world.check import check_own_house
from tests.helpers.messages import require_result_or_one_line
from tests.helpers.molmospaces import OBJECTS, write_scene


@pytest.fixture(scope="module")
def split(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("molmospaces")
    write_scene(folder / "scenes")
    assert command.main(command.Args(path=folder / "scenes", out=folder / "out", pictures=0)) == 0
    return folder / "out"


def test_objects_have_the_categories_of_the_metadata(split: Path) -> None:
    house = load_house(split / "train_1.xml", labels_path=labels_of(split))
    labels = read_labels(house.spec.copy().compile(), rules=house.rules, ignore_prefix="")
    found = {each.name: each.category for each in labels.instances}
    assert {name: found[name] for name in OBJECTS} == dict(
        zip(OBJECTS, ("bed", "chair", "door", "objects"), strict=True)
    )
    assert "doorway_d00d_1_1_2" not in found  # the leaf belongs to its door
    assert labels.void_geoms == 0
    report = json.loads((split / "import.json").read_text())["train_1"]
    assert (report["rooms"], report["area_m2"]) == (2, 32.0)
    assert report["changes"]["A hinged door was opened."] == 1


def test_the_floor_is_at_zero_and_the_open_door_lets_the_robot_pass(split: Path) -> None:
    house = load_house(split / "train_1.xml", labels_path=labels_of(split))
    assert [room.floor_z_m for room in read_rooms(house.spec.copy().compile())] == pytest.approx([0.0, 0.0])
    model = house.spec.copy().compile()
    data = data_at_rest(model)
    assert data.body("bed_0f3a_1_0_3").xpos == pytest.approx([7.0, 1.0, 0.3], abs=1e-6)
    leaf = data.geom_xpos[np.flatnonzero(model.geom_bodyid == model.body("doorway_d00d_1_1_2").id)]
    assert leaf == pytest.approx(np.tile([3.55, 1.5, 1.05], (2, 1)), abs=0.01)
    assert check_own_house(house)[0] == []


def test_a_door_that_stays_closed_is_reported_by_the_check(split: Path, tmp_path: Path) -> None:
    file = write_scene(tmp_path / "scenes")
    assert command.main(command.Args(path=file, out=tmp_path / "out", pictures=0, doors="as-is")) == 0
    house = load_house(tmp_path / "out" / "train_1.xml", labels_path=labels_of(tmp_path / "out"))
    assert any("cannot enter" in fault for fault in check_own_house(house)[0])


def test_rules_of_types_fit_all_houses_and_those_of_other_names_one() -> None:
    assert rules_of({"bed_0f3a_1_0_3": "bed", "bed_77_2_0_9": "bed", "sofa_1": "sofa", "chair_1f_1_0_2": "table"}) == {
        r"^sofa_1$": "sofa",
        r"^chair_1f_1_0_2$": "table",
        r"^bed_[0-9a-f]+_\d+_0_\d+$": "bed",
    }


def test_broken_houses_are_one_line_with_their_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(ConfigError, match="MolmoSpaces"):
        command.main(command.Args(path=tmp_path, out=tmp_path / "out"))
    file = write_scene(tmp_path / "scenes")
    (tmp_path / "scenes" / "train_1_assets" / "room_2.obj").unlink()
    write_scene(tmp_path / "scenes", name="train_2", objects={"bed": {"category": 3}})
    write_scene(tmp_path / "scenes", name="train_3")
    outside = (tmp_path / "scenes" / "train_3.xml").read_text().replace("train_3_assets/room_2", "../../elsewhere")
    (tmp_path / "scenes" / "train_3.xml").write_text(outside)
    assert command.main(command.Args(path=file.parent, out=tmp_path / "out", pictures=0)) == 1
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 3
    assert all(f"train_{number}" in line and str(file.parent) in line for number, line in enumerate(lines, start=1))


@pytest.mark.costly
@settings(max_examples=8)
@given(
    st.recursive(
        st.none() | st.booleans() | st.floats() | st.text(max_size=4),
        lambda inner: (
            st.lists(inner, max_size=2)
            | st.dictionaries(st.sampled_from([*OBJECTS, "category", "objects"]), inner, max_size=3)
        ),
        max_leaves=6,
    )
)
def test_any_metadata_gives_a_house_or_one_line(tmp_path_factory: pytest.TempPathFactory, objects: Any) -> None:
    file = write_scene(tmp_path_factory.mktemp("any"), objects=objects)
    require_result_or_one_line(lambda: import_scene(file, doors="open"), "train_1")
