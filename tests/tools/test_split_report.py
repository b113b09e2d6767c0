"""The report on the difficulty of a split with known figures."""

from __future__ import annotations

import math
from pathlib import Path

from sim.core.geometry.pose import Pose
from sim.episodes.episode import Episode
from sim.episodes.splits import write_split
from tests.helpers.worlds import room, with_box
from tools.maintenance.split_report import Args, main


def test_the_row_of_a_split_has_its_known_figures(tmp_path: Path, capsys) -> None:
    folder = tmp_path / "tiny"
    folder.mkdir()
    house = with_box(room(6, 6), "sofa_00", centre_m=(2.5, 0, 0.4), half_m=(0.4, 0.8, 0.4))
    house = with_box(house, "chair_00", centre_m=(-2.5, 2.0, 0.4), half_m=(0.2, 0.2, 0.4))
    house = with_box(house, "chair_01", centre_m=(-2.5, -2.0, 0.4), half_m=(0.2, 0.2, 0.4))
    (folder / "home.xml").write_text(house.spec.to_xml())
    asked = [("sofa", 0.0, 1.0), ("sofa", math.pi, 3.0), ("sofa", -math.pi / 2, 2.0), ("chair", 0.0, 2.5)]
    episodes = [
        Episode(f"e{i}", "home", goal, Pose(0.0, 0.0, yaw_rad), far_m) for i, (goal, yaw_rad, far_m) in enumerate(asked)
    ]
    write_split(folder, episodes, {"home": {}}, version="1")
    assert main(Args(splits=(str(folder),), out=tmp_path / "page.md")) == 0
    row = "| tiny | 1 | 36 (36-36) | 1 (1-1) | 0 | 4 | 2.2 (1.0-3.0) | 1 (1-2) | 75 | 25 | 25, 25, 50, 0 |"
    assert row in capsys.readouterr().out
    assert row in (tmp_path / "page.md").read_text()
