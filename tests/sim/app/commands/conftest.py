"""A split with one small house, for commands that run its episodes."""

from __future__ import annotations

from pathlib import Path

import pytest

from sim.core.geometry.pose import Pose
from sim.episodes.episode import Episode
from sim.episodes.splits import write_split
from tests.helpers.worlds import room, with_box


@pytest.fixture(scope="session")
def seats(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The house `seats` with a sofa, and three episodes."""
    folder = tmp_path_factory.mktemp("splits") / "tiny"
    folder.mkdir()
    furnished = with_box(room(7, 5), "sofa_00", centre_m=(3.0, 0.5, 0.4), half_m=(0.4, 0.8, 0.4))
    (folder / "seats.xml").write_text(furnished.spec.to_xml())
    episodes = [Episode(f"tiny_{i}", "seats", "sofa", Pose(-2.0, 0.4 * i, 0.3 * i), 3.5) for i in range(3)]
    write_split(folder, episodes, {"seats": {"sofa": []}}, version="0.0.1")
    return folder
