"""The pictures of the curves of trainings."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from sim.training.cloned import trainer as cloned
from sim.training.poni import trainer as poni


@pytest.mark.parametrize("draw", [cloned.draw_curve, poni.draw_curve])
def test_a_curve_without_rows_is_not_drawn(draw: Callable[[Path], None], tmp_path: Path) -> None:
    draw(tmp_path)
    (tmp_path / "val.csv").write_text("step,minutes\n")
    draw(tmp_path)
    assert not (tmp_path / "curve.png").exists()
