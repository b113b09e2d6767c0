"""Files that a user or data names are opened by `sim.reading` and `sim.files`, which refuse what is no plain file."""

from __future__ import annotations

import ast
import functools
import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from sim.errors import ConfigError
from sim.evaluation.results import RunDirectory
from sim.files import open_to_grow

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
    ("sim/reading.py", "os.open"): "the function that opens",
    ("sim/files.py", "open"): "the function that opens what grows",
    ("sim/files.py", "os.open"): "the function that opens what grows, and a folder whose names are synced",
    ("sim/cli.py", "os.open"): "os.devnull",
    ("sim/paths.py", "file.read_bytes"): "modules of this project, for the hash of the code",
    ("sim/task/trajectory.py", "part.open"): "a new part file with a name of its own",
    ("sim/datasets/shards.py", "part.open"): "a new part file with a name of its own",
    ("sim/viewers/video.py", "av.open"): "a new part file with a name of its own",
    ("sim/housegen/imported/library.py", "(assets_dir() / TRANSFER_LIST).read_text"): "a file that ships",
    ("sim/housegen/splits/house_list.py", "source.read_bytes"): "textures that ship",
    ("sim/housegen/imported/sources.py", "zipfile.ZipFile"): "is given an open file",
    ("sim/analysis/report/build.py", "(files('sim.analysis.report') / 'page' / name).read_text"): "a file that ships",
    ("sim/commands/bench/report.py", "Path('/proc/cpuinfo').read_text"): "a fixed file of the system",
    ("sim/commands/bench/growth.py", "Path('/proc/self/status').read_text"): "a fixed file of the system",
    ("sim/web/server.py", "hub.open"): "no file",
    ("stubborn/segmentation/lite0.py", "torch.load"): "weights of an installed package",
    ("stubborn/network_files.py", "safe_open"): "takes a name only; open_plain is called just before",
    ("tools/maintenance/site_hooks.py", "file.read_text"): "pages that the maintainer's build has just written",
    ("tools/maintenance/readme_picture.py", "av.open"): "writes to memory",
    ("tools/maintenance/bench_against.py", "tarfile.open"): "the output of git",
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


def test_named_files_are_opened_in_one_place() -> None:
    assert sorted(opened() - set(EXCEPTIONS)) == []


def test_each_exception_is_still_needed() -> None:
    assert sorted(set(EXCEPTIONS) - opened()) == []


@pytest.mark.parametrize("name", [".lock", "results.jsonl", "config.json"])
def test_a_run_whose_file_is_a_pipe_is_refused_without_waiting(name: str, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / name)
    with pytest.raises(ConfigError, match=r"not a plain file|Cannot write|has no|has results"):
        RunDirectory(tmp_path, {"agent": "random"})


def test_a_file_that_grows_is_no_pipe_and_no_folder(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    for name, mode in (("pipe", "ab"), ("pipe", "r+b"), ("pipe", "a+"), ("", "ab")):
        with pytest.raises(OSError, match=r"plain file|device|directory"):
            open_to_grow(tmp_path / name, mode)
    with open_to_grow(tmp_path / "new", "a") as stream:
        stream.write("é")
    assert (tmp_path / "new").read_bytes() == "é".encode()
