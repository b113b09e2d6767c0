"""The animated picture of the README."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from sim.app.viewers.video import VideoWriter
from tools.maintenance.readme_picture import animation, frames_of, thinned


def frames(count: int) -> list[NDArray[np.uint8]]:
    """Returns frames of which each is brighter than the one before."""
    return [np.full((48, 64, 3), 40 + 20 * i, np.uint8) for i in range(count)]


def test_a_picture_has_the_frames_of_the_video_at_its_speed_and_repeats(tmp_path: Path) -> None:
    writer = VideoWriter(tmp_path / "a.mp4", size_px=(64, 48))
    for frame in frames(5):
        writer.write(frame)
    writer.finish()
    with Image.open(io.BytesIO(animation(frames_of(tmp_path / "a.mp4"), frames_per_s=5, quality=80))) as picture:
        assert (picture.format, picture.size, picture.n_frames) == ("WEBP", (64, 48), 5)  # type: ignore[attr-defined]
        assert picture.info["loop"] == 0
        picture.seek(4)
        assert np.asarray(picture.convert("RGB")).mean() == pytest.approx(120, abs=4)
        assert picture.info["timestamp"] + picture.info["duration"] == 1000


def test_a_long_video_is_thinned_evenly_and_keeps_its_ends() -> None:
    assert [int(frame[0, 0, 0]) for frame in thinned(frames(9), 3)] == [40, 120, 200]
    assert len(thinned(frames(3), 80)) == 3
