"""Files are written completely or not at all."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest

from sim.core.files import inside, part_file, require_writable, write_atomically, write_picture, write_together
from sim.core.interface import ConfigError
from tests.helpers import wording


def test_a_file_is_replaced_as_a_whole_and_readable_by_all(tmp_path: Path) -> None:
    file = tmp_path / "new" / "a.json"
    write_atomically(file, b"old and long")
    write_atomically(file, b"new")
    assert file.read_bytes() == b"new"
    assert file.stat().st_mode & 0o777 == 0o644
    assert list(file.parent.iterdir()) == [file]


@pytest.mark.parametrize(("umask", "mode"), [("077", 0o600), ("002", 0o664)])
def test_a_file_has_the_permissions_that_the_umask_allows(umask: str, mode: int, tmp_path: Path) -> None:
    code = "import sys; from pathlib import Path; from sim.core.files import write_atomically as w; w(Path('a'), b'')"
    subprocess.run(["sh", "-c", f"umask {umask}; exec '{sys.executable}' -c \"{code}\""], cwd=tmp_path, check=True)
    assert (tmp_path / "a").stat().st_mode & 0o777 == mode


def test_a_failed_replacement_leaves_no_part_file(tmp_path: Path) -> None:
    (tmp_path / "a.json").mkdir()
    with pytest.raises(OSError, match="directory"):
        write_atomically(tmp_path / "a.json", b"new")
    assert [entry.name for entry in tmp_path.iterdir()] == ["a.json"]


def test_a_part_file_is_created_next_to_its_file_and_older_parts_of_that_file_are_removed(tmp_path: Path) -> None:
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
    with pytest.raises(ConfigError, match=r"a\.mp4"):
        part_file(tmp_path / "videos" / "a.mp4", what="video")


@pytest.mark.parametrize("name", ["../b", "/etc/b", "a/../../b", "..", ".", "", "a\0b", "out/b", "n" * 300])
def test_a_name_from_data_that_leads_out_of_its_folder_is_refused(name: str, tmp_path: Path) -> None:
    folder = tmp_path / "folder"
    folder.mkdir()
    (folder / "out").symlink_to(tmp_path)
    with pytest.raises(ConfigError, match="view"):
        inside(folder, name, what="view")


@pytest.mark.parametrize("name", ["b", "a/b", "a/../b", "b..c", "val 00"])
def test_a_name_from_data_inside_its_folder_is_a_path_of_that_folder(name: str, tmp_path: Path) -> None:
    assert inside(tmp_path, name, what="view") == tmp_path / name


def test_several_files_are_replaced_together_or_not_at_all(tmp_path: Path) -> None:
    first, second = tmp_path / "a.json", tmp_path / "b.json"
    write_together({first: b"old", second: b"old"})
    with pytest.raises(OSError, match="exists"):
        write_together({first: b"new", second: b"new", tmp_path / "a.json" / "c.json": b"new"})
    assert (first.read_bytes(), second.read_bytes()) == (b"old", b"old")
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["a.json", "b.json"]


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda folder: folder / "file" / "run", "file"),
        (lambda folder: folder / "is_folder.png", wording.IS_A_FOLDER),
        (lambda folder: folder / ("n" * 300), "too long"),
        (lambda folder: Path("/proc/nowhere/a.png"), "No such file"),
    ],
)
def test_a_path_that_cannot_be_written_is_refused_before_any_work(
    make: Callable[[Path], Path], message: str, tmp_path: Path
) -> None:
    (tmp_path / "file").touch()
    (tmp_path / "is_folder.png").mkdir()
    with pytest.raises(ConfigError, match=message):
        require_writable(make(tmp_path), name="--out", folder=False)
    require_writable(tmp_path / "new" / "a.png", name="--out", folder=False)
    require_writable(tmp_path, name="--out", folder=True)
    assert not (tmp_path / "new").exists()
    with pytest.raises(ConfigError, match=wording.IS_A_FILE):
        require_writable(tmp_path / "file", name="--out", folder=True)


def test_a_picture_that_cannot_be_written_is_an_error_and_no_file(tmp_path: Path) -> None:
    (tmp_path / "a.png").mkdir()
    with pytest.raises(OSError, match="directory"):
        write_picture(tmp_path / "a.png", np.zeros((2, 2, 3), np.uint8))
    with pytest.raises(ConfigError, match=r"a\.xyz"):
        write_picture(tmp_path / "a.xyz", np.zeros((2, 2, 3), np.uint8))
    write_picture(tmp_path / "b.png", np.full((2, 2, 3), (255, 0, 0), np.uint8))
    picture = cv2.imread(str(tmp_path / "b.png"))
    assert picture is not None
    assert picture[0, 0].tolist() == [0, 0, 255]
