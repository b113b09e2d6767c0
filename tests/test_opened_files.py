"""Files that users name are opened by `sim.core.reading` and `sim.core.files`, which refuse what is no plain file."""

from __future__ import annotations

import ast
import functools
import os
import sys
import tarfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import torch
from torch import nn

from sim.app.composition.imports import import_attribute
from sim.app.evaluation.results import RunDirectory
from sim.core.errors import ConfigError
from sim.core.files import open_to_grow
from sim.core.geometry import compiling
from sim.core.pictures import image_size_px
from sim.core.reading import read_csv, read_json
from sim.task.result import EpisodeResult
from sim.training.segmentation.dataset import read_members, read_shard
from sim.training.views.coco import decode_mask
from stubborn.network_files import read_checkpoint, with_weights

ROOT = Path(__file__).parents[1]
OPENERS = {
    "open", "io.open", "os.open", "np.load", "np.loadtxt", "np.genfromtxt", "np.fromfile", "np.memmap", "torch.load",
    "zipfile.ZipFile", "zipfile.is_zipfile", "tarfile.open", "tarfile.is_tarfile", "gzip.open", "gzip.GzipFile",
    "cv2.imread", "cv2.VideoCapture", "av.open", "Image.open", "safe_open", "load_file", "ElementTree.parse",
    "ET.parse", "trimesh.load", "MjSpec.from_file", "mujoco.MjSpec.from_file", "MjModel.from_xml_path",
    "mujoco.MjModel.from_xml_path", "tomllib.load", "json.load", "shutil.copy", "shutil.copyfile",
}  # fmt: skip
"""Functions that open a file by its name; the libraries among them also take an open file."""
METHODS = {"open", "read_text", "read_bytes"}
"""Methods of a path that open its file."""
GIVEN_OPEN = {"stream", "fileobj", "packed", "raw"}
"""Names that the project gives to files that are open already."""
EXCEPTIONS = {
    ("sim/core/reading.py", "os.open"): "the function that opens",
    ("sim/core/files.py", "open"): "the function that opens what grows",
    ("sim/core/files.py", "os.open"): "the function that opens what grows, and a folder whose names are synced",
    ("sim/core/store.py", "file.read_bytes"): "a file of the store, which it wrote and whose checksum it tests",
    ("sim/houses/references.py", "file.read_bytes"): "textures that ship",
    ("sim/app/cli.py", "os.open"): "os.devnull",
    ("sim/core/paths.py", "file.read_bytes"): "modules of this project, for the hash of the code",
    ("sim/core/paths.py", "file.read_text"): "a fixed file of the system, /proc/cpuinfo",
    ("sim/app/submissions/sealing.py", "os.open"): "creates a new file that only its owner can read",
    ("sim/task/trajectory.py", "part.open"): "a new part file with a name of its own",
    ("sim/training/views/shards.py", "part.open"): "a new part file with a name of its own",
    ("sim/app/viewers/video.py", "av.open"): "a new part file with a name of its own",
    ("sim/homes/housegen/imported/library.py", "(assets_dir() / TRANSFER_LIST).read_text"): "a file that ships",
    ("sim/episodes/house_list.py", "source.read_bytes"): "textures that ship",
    ("sim/homes/housegen/imported/sources.py", "zipfile.ZipFile"): "is given an open file",
    (
        "sim/app/analysis/report/build.py",
        "(files('sim.app.analysis.report') / 'page' / name).read_text",
    ): "a file that ships",
    ("sim/core/vocabulary.py", "FILE.open"): "a file that ships",
    ("tools/benchmarks/against.py", "tarfile.open"): "the output of git",
    ("tools/maintenance/make_vocabulary.py", "TABLE.read_text"): "a file of the checkout",
    ("tools/maintenance/make_vocabulary.py", "(folder / 'data.noun').read_text"): "files of WordNet of a maintainer",
    ("tools/maintenance/make_vocabulary.py", "(folder / 'index.noun').read_text"): "files of WordNet of a maintainer",
    ("tools/maintenance/mujoco_stubs.py", "file.read_text"): "stubs that were generated just before",
    ("sim/app/web/server.py", "hub.open"): "no file",
    ("sim/app/services/client.py", "opener_for(url).open"): "an address",
    ("stubborn/segmentation/processor.py", "_PROCESSOR.read_text"): "a fixed file of the system, /proc/cpuinfo",
    ("sim/app/composition/segmenters.py", "safe_open"): "as in stubborn/network_files.py",
    ("stubborn/network_files.py", "safe_open"): "takes a name only; open_plain is called just before",
    ("tools/maintenance/site_hooks.py", "file.read_text"): "pages that the maintainer's build has just written",
    ("tools/research/check_descriptions.py", "ET.parse"): "an independent check with readers of its own",
    ("tools/research/check_descriptions.py", "mujoco.MjModel.from_xml_path"): "as above",
    ("tools/research/result_archive.py", "tarfile.open"): "the maintainers' own archive, or memory",
    ("sim/app/bridges/lerobot/dataset.py", "av.open"): "a video that the export has written",
    ("sim/app/bridges/process_guard.py", "open"): "states of processes in /proc, which no user names",
    ("sim/app/bridges/process_guard.py", "os.open"): "/dev/null",
    ("sim/app/bridges/process_boundary.py", "open"): "files of the kernel in /proc/self",
    ("sim/app/bridges/process_boundary.py", "os.open"): "/dev/null",
    ("sim/app/bridges/stubborn_client.py", "os.open"): "/dev/null",
    ("sim/homes/housegen/imported/infinigen_worker.py", "open"): "runs in the user's Python; a new part file",
    ("sim/app/commands/habitat/setup.py", "distribution.read_text"): "a file of the installed package",
    ("tools/research/habitat_names.py", "file.read_text"): "sources of a checkout that a maintainer reads",
    ("sim/app/bridges/habitat_client.py", "open"): "runs in the agent's process; a file that the agent's code names",
}


@functools.cache
def opened() -> frozenset[tuple[str, str]]:
    """Returns the calls that open a file by its name: file of the call and function, as `OPENERS` and `METHODS` say."""
    return frozenset(_opened())


def _opened() -> Iterator[tuple[str, str]]:
    for folder in ("sim", "stubborn", "tools"):
        for file in sorted((ROOT / folder).rglob("*.py")):
            for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
                if not isinstance(node, ast.Call):
                    continue
                name = ast.unparse(node.func)
                given = [ast.unparse(each) for each in node.args[:1]]
                given += [ast.unparse(each.value) for each in node.keywords if each.arg == "fileobj"]
                is_method = isinstance(node.func, ast.Attribute) and node.func.attr in METHODS
                is_library = name.split(".")[0] in ("archive", "self", "webbrowser")
                if (name in OPENERS or (is_method and not is_library)) and not GIVEN_OPEN & set(given):
                    yield str(file.relative_to(ROOT)), name


@pytest.mark.costly
def test_named_files_are_opened_in_one_place() -> None:
    assert sorted(opened() - set(EXCEPTIONS)) == []


def test_each_exception_is_still_needed() -> None:
    assert sorted(set(EXCEPTIONS) - opened()) == []


@pytest.mark.parametrize("name", [".lock", "results.jsonl", "config.json"])
def test_a_run_whose_file_is_a_pipe_is_refused_without_waiting(name: str, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / name)
    with pytest.raises(ConfigError, match=r"not a plain file|Cannot write|has no|has results"):
        RunDirectory(tmp_path, {"agent": "random"}, EpisodeResult)


def test_a_file_that_grows_is_no_pipe_and_no_folder(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    for name, mode in (("pipe", "ab"), ("pipe", "r+b"), ("pipe", "a+"), ("", "ab")):
        with pytest.raises(OSError, match=r"plain file|device|directory"):
            open_to_grow(tmp_path / name, mode)
    with open_to_grow(tmp_path / "new", "a") as stream:
        stream.write("é")
    assert (tmp_path / "new").read_bytes() == "é".encode()


def tar_header(kind: bytes, size: int) -> bytes:
    member = tarfile.TarInfo("a.json")
    member.type, member.size = kind, size
    return member.tobuf(tarfile.USTAR_FORMAT)


TARS = {
    "a pax header of digits": tar_header(tarfile.XHDTYPE, 400_384) + b"1" * 400_384 + bytes(1024),
    "a long name of gigabytes": tar_header(tarfile.GNUTYPE_LONGNAME, 1 << 32) + bytes(1024),
    "pax headers without end": (tar_header(tarfile.XHDTYPE, 8) + b"8 a=bcd\n".ljust(512, b"\0")) * 3000,
}


@pytest.mark.parametrize("content", TARS.values(), ids=TARS)
def test_a_tar_file_of_hostile_headers_is_refused_soon(content: bytes, tmp_path: Path) -> None:
    (tmp_path / "a.tar").write_bytes(content)
    began_s = time.process_time()
    for read in (read_shard, read_members):
        with pytest.raises(ConfigError, match="is broken"):
            list(read(tmp_path / "a.tar"))
    with pytest.raises(ConfigError, match="a tar file, which PyTorch wrote before"):
        read_checkpoint(tmp_path / "a.tar")
    assert time.process_time() - began_s < 3.0


def test_weights_of_whole_numbers_are_refused(tmp_path: Path) -> None:
    layer = nn.Linear(2, 2)
    whole = {name: tensor.to(torch.int16) for name, tensor in layer.state_dict().items()}
    with pytest.raises(ConfigError, match="holds int16 numbers; it needs floating-point ones"):
        with_weights(tmp_path / "w", whole, lambda: nn.Linear(2, 2))


def test_the_size_of_a_jpeg_is_read_behind_markers_that_stand_alone() -> None:
    large = b"\xff\xc0\x00\x11\x08" + b"\x75\x30" * 2 + bytes(10)
    assert image_size_px(b"\xff\xd8\xff\x01" + large) == (30_000, 30_000)
    assert image_size_px(b"\xff\xd8" + b"\xff" * 70_000 + large) == (30_000, 30_000)


@pytest.mark.parametrize(
    "mask",
    [{"size": [2, 2], "counts": [-1, 5]}, {"size": [2, 2], "counts": [10**11]}, {"size": [2, 2]}, {"counts": [4]},
     {"size": [2], "counts": [4]}, {"size": [2, 2], "counts": [1.5, 2.5]}, {"size": [2, 2], "counts": "abc"},
     {"size": [10**6, 10**6], "counts": [10**12]}],
)  # fmt: skip
def test_a_mask_of_other_counts_is_one_line(mask: dict[str, Any]) -> None:
    with pytest.raises(ConfigError, match="The mask of an object"):
        decode_mask(mask)


def test_text_with_the_marks_of_other_programs_is_read(tmp_path: Path) -> None:
    for encoding in ("utf-8-sig", "utf-16", "utf-32"):
        (tmp_path / "a.json").write_bytes('{"é": 1}'.encode(encoding))
        assert read_json(tmp_path / "a.json", dict[str, int], what="File") == {"é": 1}
        (tmp_path / "a.csv").write_bytes("é,b\r\n1,2\r\n".encode(encoding))
        assert read_csv(tmp_path / "a.csv", what="Table") == [{"é": "1", "b": "2"}]


def test_a_module_of_the_user_that_hides_the_package_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "sim.py").write_text("")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("sys.path", [path for path in sys.path if path])
    with pytest.raises(ConfigError, match=r"Your 'sim.py' in the current folder would hide the package 'sim'"):
        import_attribute("mine:A")


def test_numba_has_a_folder_of_its_user_where_nothing_else_can_be_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sim.core.geometry.compiling._can_write", lambda folder: False)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    monkeypatch.setenv("NUMBA_CACHE_DIR", "")
    folder = compiling.choose_cache()
    assert folder is not None
    assert folder.stat().st_mode & 0o777 == 0o700
    assert os.environ["NUMBA_CACHE_DIR"] == str(folder)
    assert compiling.choose_cache() == folder
    folder.chmod(0o777)  # anybody may write code into it
    monkeypatch.setenv("NUMBA_CACHE_DIR", "")
    assert compiling.choose_cache() != folder
