"""`stubborn houses check` on a house of the user's."""

from __future__ import annotations

from pathlib import Path

import pytest

from sim.app.commands.houses.check import Args, main
from tests.helpers.foreign import write_scene

EXAMPLE = Path("examples/my_house.xml")


def test_a_house_of_ones_own_needs_no_furniture(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(Args(house=EXAMPLE, views=1)) == 0
    assert main(Args(house=EXAMPLE, views=0, furnished=True)) == 1
    assert "has no" in capsys.readouterr().out


def test_a_scene_from_elsewhere_is_checked_with_its_rules(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene, labels = write_scene(tmp_path / "scene")
    assert main(Args(house=scene, labels=labels, views=1)) == 0
    assert "no room" not in capsys.readouterr().out


def test_houses_without_episodes_are_checked_whatever_their_endings(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "first.XML").write_bytes(EXAMPLE.read_bytes())
    (tmp_path / "second.mjcf").write_bytes(EXAMPLE.read_bytes())
    assert main(Args(split=str(tmp_path), views=0)) == 0
    printed = capsys.readouterr().out
    assert "first: 0 faults" in printed
    assert "second: 0 faults" in printed


def test_a_wrong_colour_of_an_object_is_one_fault(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = (EXAMPLE.parent / "my_flat.xml").read_text().replace("colour: blue", "color: blue")
    (tmp_path / "flat.xml").write_text(text)
    assert main(Args(house=tmp_path / "flat.xml", views=0)) == 1
    assert "flat: 1 fault, " in capsys.readouterr().out


@pytest.mark.costly
def test_advice_on_a_generated_house_is_a_note_and_no_fault(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(Args(first_seed=5003, seeds=1, kind="flat", area_m2=64.0, views=0)) == 0
    printed = capsys.readouterr().out
    assert "heldout_5003: 0 faults" in printed
    assert "    note: room_kitchen_00 has 5 objects of the kind tea set\n" in printed
