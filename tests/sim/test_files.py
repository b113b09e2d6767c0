"""Files are written completely or not at all."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from sim.files import part_file, write_atomically
from sim.interface import ConfigError


def test_a_file_is_replaced_as_a_whole_and_readable_by_all(tmp_path: Path) -> None:
    file = tmp_path / "new" / "a.json"
    write_atomically(file, b"old and long")
    write_atomically(file, b"new")
    assert file.read_bytes() == b"new"
    assert file.stat().st_mode & 0o777 == 0o644
    assert list(file.parent.iterdir()) == [file]


def test_a_failed_replacement_leaves_no_part_file(tmp_path: Path) -> None:
    (tmp_path / "a.json").mkdir()
    with pytest.raises(OSError, match="directory"):
        write_atomically(tmp_path / "a.json", b"new")
    assert [entry.name for entry in tmp_path.iterdir()] == ["a.json"]


def test_a_part_file_is_created_beside_its_file_and_older_parts_of_that_file_are_removed(tmp_path: Path) -> None:
    folder = tmp_path / "videos"
    folder.mkdir()
    gone, of_another, whole = (folder / name for name in (".a.part-99999.mp4", ".b.part-99999.mp4", "a.mp4"))
    for file in (gone, of_another, whole):
        file.touch()
    part = part_file(whole, what="video")
    assert part.parent == folder
    assert str(os.getpid()) in part.name
    assert sorted(folder.iterdir()) == sorted([part, of_another, whole])


def test_an_unwritable_folder_is_reported_with_the_file_and_the_reason(tmp_path: Path) -> None:
    (tmp_path / "videos").touch()
    with pytest.raises(ConfigError, match=r"Cannot write the video .*a\.mp4"):
        part_file(tmp_path / "videos" / "a.mp4", what="video")
