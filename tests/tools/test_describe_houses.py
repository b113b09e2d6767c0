"""Tests of the page that describes the shipped houses."""

from __future__ import annotations

from pathlib import Path

import pytest

from sim.commands import episodes as make_episodes
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


def page(root: Path, measure: int) -> str:
    describe_houses.main(describe_houses.Args(out=root / "README.md", root=root, measure=measure))
    return (root / "README.md").read_text()


def test_categories_and_unreachable_instances_are_on_the_page(root: Path) -> None:
    text = page(root, measure=0)
    assert "| sink | 2 | 1 |" in text
    assert "| bed | 2 | 2 |" in text
    assert "not goals: val_01: sink_00." in text
    assert "fast ms" not in text


def test_the_page_without_measurements_is_deterministic(root: Path) -> None:
    assert page(root, measure=0) == page(root, measure=0)


def test_measured_rendering_times_are_on_the_page(root: Path) -> None:
    text = page(root, measure=2)
    (row,) = [line for line in text.splitlines() if line.startswith("| val_00 |")]
    fast_ms, good_ms, void = (float(cell) for cell in row.split("|")[-4:-1])
    assert fast_ms > 0.0
    assert good_ms > 0.0
    assert 0.0 < void < 1.0  # such a room has no ceiling
    assert "--measure 2" in text
