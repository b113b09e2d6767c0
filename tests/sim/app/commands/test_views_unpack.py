"""Shards from other sources: nothing is written outside of --out, and an invalid view gives one line."""

from __future__ import annotations

import io
import json
import tarfile
from pathlib import Path

import cv2
import numpy as np
import pytest

from sim.app import cli
from sim.app.commands.views import unpack as unpack_views
from sim.core.errors import ConfigError
from sim.training.segmentation.dataset import _members, read_members


def png(kind: type, *more: int) -> bytes:
    return cv2.imencode(".png", np.ones((6, 8, *more), kind))[1].tobytes()


def write_shard(file: Path, key: str, **changed: bytes) -> None:
    """Writes a shard of one view, some of whose members may be others."""
    parts = {"rgb.png": png(np.uint8, 3), "depth.png": png(np.uint16), "semantic.png": png(np.uint8), "json": b"{}"}
    parts |= {name.replace("_", "."): content for name, content in changed.items()}
    file.parent.mkdir(parents=True, exist_ok=True)
    with tarfile.open(file, "w") as archive:
        for suffix, content in parts.items():
            entry = tarfile.TarInfo(f"{key}.{suffix}")
            entry.size = len(content)
            archive.addfile(entry, io.BytesIO(content))


def unpacked(views: Path, out: Path) -> int:
    return cli.run(unpack_views.Args, unpack_views.main, ["--views", str(views), "--out", str(out)])


def test_a_view_whose_name_leads_out_of_the_folder_writes_nothing_there(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    stolen = tmp_path / "stolen"
    write_shard(tmp_path / "views" / "a.tar", str(stolen))
    assert unpacked(tmp_path / "views", tmp_path / "out") == 2
    assert "leads out of its folder" in capsys.readouterr().err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["views"]
    write_shard(tmp_path / "views" / "a.tar", "good")
    assert unpacked(tmp_path / "views", tmp_path / "out") == 0
    assert json.loads((tmp_path / "out" / "record" / "good.json").read_text()) == {}


BOMB = png(np.uint8)[:16] + (60_000).to_bytes(4, "big") * 2 + png(np.uint8)[24:]


@pytest.mark.parametrize(
    ("changed", "expected"),
    [
        ({"json": b"[" * 100_000}, "record of view 'v'"),
        ({"json": b'{"a": NaN}'}, "not JSON"),
        ({"semantic_png": BOMB}, "60000 x 60000"),
        ({"semantic_png": b"no image"}, "unsupported format"),
        ({"semantic_png": png(np.uint16)}, "labels of uint16"),
        ({"depth_png": png(np.uint8, 3)}, "depth of uint8"),
        ({"rgb_png": png(np.uint8, 3)[:40]}, "cannot be read"),
    ],
)
def test_a_member_that_is_no_part_of_a_view_is_named(
    changed: dict[str, bytes], expected: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_shard(tmp_path / "views" / "a.tar", "v", **changed)
    assert unpacked(tmp_path / "views", tmp_path / "out") == 2
    message = capsys.readouterr().err
    assert expected in message
    assert message.count("\n") == 1


@pytest.mark.parametrize(
    ("names", "expected"),
    [(("v.rgb.jpg", "v.rgb.png"), "view 'v' has 'rgb' twice"), (("v.rgb.png", "w.rgb.png", "v.depth.png"), "'v'")],
)
def test_a_view_or_a_part_of_it_that_is_stored_twice_is_refused(
    names: tuple[str, ...], expected: str, tmp_path: Path
) -> None:
    with tarfile.open(tmp_path / "a.tar", "w") as archive:
        for name in names:
            archive.addfile(tarfile.TarInfo(name))
    for read in (lambda: list(read_members(tmp_path / "a.tar")), lambda: list(_members(tmp_path / "a.tar"))):
        with pytest.raises(ConfigError, match=expected):
            read()


@pytest.mark.parametrize("kind", [tarfile.SYMTYPE, tarfile.LNKTYPE, tarfile.FIFOTYPE, tarfile.DIRTYPE])
def test_a_member_that_is_no_plain_file_is_refused(
    kind: bytes, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "views").mkdir()
    with tarfile.open(tmp_path / "views" / "a.tar", "w") as archive:
        entry = tarfile.TarInfo("v.rgb.png")
        entry.type, entry.linkname = kind, "v.rgb.png"
        archive.addfile(entry)
    assert unpacked(tmp_path / "views", tmp_path / "out") == 2
    assert "not a plain file" in capsys.readouterr().err
