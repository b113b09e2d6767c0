"""Tests of the page and the table that describe the shipped houses."""

from __future__ import annotations

import csv
import hashlib
from pathlib import Path

import pytest

from sim.app.commands import episodes as make_episodes
from sim.core.interface import GOAL_CATEGORIES
from sim.gl import mujoco
from sim.houses.labels import read_labels
from sim.robot.body import FLOOR_MASK
from sim.world.storeys import floor_levels
from tests.helpers.worlds import room, with_box
from tools.maintenance import describe_houses


@pytest.fixture
def root(tmp_path: Path) -> Path:
    folder = tmp_path / "val"
    folder.mkdir()
    bed = with_box(room(8, 4), "bed_00", centre_m=(3.3, 0, 0.25), half_m=(0.5, 1.0, 0.25))
    sink = with_box(bed, "sink_00", centre_m=(-3.5, 0, 0.4), half_m=(0.2, 0.2, 0.4))
    behind = with_box(bed, "wall_10", centre_m=(-2.2, 0, 1.25), half_m=(0.05, 2.0, 1.25))
    behind = with_box(behind, "sink_00", centre_m=(-3.7, 0, 0.4), half_m=(0.2, 0.2, 0.4))
    (folder / "val_00.xml").write_text(sink.spec.to_xml())
    (folder / "val_01.xml").write_text(behind.spec.to_xml())
    make_episodes.main(make_episodes.Args(split=folder, episodes=4))
    return tmp_path


def write(root: Path) -> tuple[str, list[dict[str, str]]]:
    """Writes the scene of a package, `package/scenes/house.xml`, and its folders `common` and `textures`."""
    describe_houses.main(describe_houses.Args(out=root / "README.md", root=root))
    with (root / "houses.csv").open(encoding="utf-8", newline="") as file:
        return (root / "README.md").read_text(encoding="utf-8"), list(csv.DictReader(file))


def test_the_table_has_one_row_for_each_house(root: Path) -> None:
    _, rows = write(root)
    assert [(row["split"], row["house"]) for row in rows] == [("val", "val_00"), ("val", "val_01")]
    assert sum(int(row["episodes"]) for row in rows) == 4


def test_seed_and_kind_come_from_the_recipe_with_the_name_of_the_house(root: Path) -> None:
    _, rows = write(root)
    assert [(row["seed"], row["kind"]) for row in rows] == [("110000", "flat"), ("110001", "corridor")]


def test_instances_and_unreachable_instances_are_in_the_table(root: Path) -> None:
    _, (open_house, walled) = write(root)
    assert (open_house["sink"], open_house["bed"], open_house["unreachable"]) == ("1", "1", "")
    assert (walled["sink"], walled["unreachable"]) == ("1", "sink_00")
    assert open_house["chair"] == "0"
    assert set(GOAL_CATEGORIES) <= set(open_house)


def test_the_checksum_is_that_of_the_file(root: Path) -> None:
    _, rows = write(root)
    for row in rows:
        content = (root / "val" / f"{row['house']}.xml").read_bytes()
        assert (row["sha256"], row["kilobytes"]) == (hashlib.sha256(content).hexdigest(), f"{len(content) / 1000:.0f}")


def test_an_upper_floor_that_is_a_body_is_a_level() -> None:
    spec = room(8, 4).spec.copy()
    floor = spec.worldbody.add_body(name="floor_01", pos=(2.0, 0.0, 2.75))
    floor.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=(1.0, 1.0, 0.05), contype=FLOOR_MASK[0])
    model = spec.compile()
    assert floor_levels(model, read_labels(model)) == pytest.approx((0.0, 2.8))


def test_goals_without_an_episode_are_named_on_the_page(root: Path) -> None:
    page, _ = write(root)
    (sentence,) = [line for line in page.splitlines() if line.startswith("No episode of `val`")]
    assert "chair" in sentence
    assert "bed" not in sentence.replace("bathtub", "")


def test_page_and_table_are_deterministic(root: Path) -> None:
    assert write(root) == write(root)
