"""Writes type stubs of the installed MuJoCo: `python -m tools.maintenance.mujoco_stubs`, which `make types` runs.

MuJoCo's bindings are compiled and ship no types. pybind11-stubgen reads them; this tool corrects the types that their
docstrings lack or state wrongly. The stubs go to `build/typings`, where pyright looks, once for each version of MuJoCo.
"""

from __future__ import annotations

import contextlib
import io
import re
import shutil
from collections.abc import Callable
from pathlib import Path

from pybind11_stubgen import main as stubgen

from sim.gl import mujoco


def _list_of_elements(match: re.Match[str]) -> str:
    """Returns the signature of a property such as `geoms` with the class of its elements."""
    return f"{match[1]} -> list[Mjs{match[2].capitalize()}]:"


OUT = Path("build/typings")
MODULES = ("_callbacks", "_constants", "_enums", "_errors", "_functions", "_render", "_specs", "_structs")
REPLACED: tuple[tuple[str, str | Callable[[re.Match[str]], str]], ...] = (
    (r"-> \.\.\.:", "-> typing.Any:"),  # views by name, whose classes the bindings do not export
    (r": \.\.\.(?=[,)])", ": typing.Any"),
    (r"typing\.Annotated\[(numpy\.typing\.NDArray\[[\w.]+\])(?:, \"[^\"]*\")*\]", r"\1"),
    (r"(?<!-> )numpy\.typing\.NDArray\[numpy\.\w+\](?=,|\)| \| None)", "numpy.typing.ArrayLike"),
    (
        r"(?<!-> )(?:collections\.abc\.)?Sequence\[typing\.Supports\w+ \| typing\.Supports\w+\]",
        "numpy.typing.ArrayLike",
    ),
    (r"(flg_\w+): bool", r"\1: bool | int"),
    (r"(def compile\(self.*) -> typing\.Any:", r"\1 -> mujoco._structs.MjModel:"),
    (r"(def bodies\(self\)) -> list:", r"\1 -> list[MjsBody]:"),
    (r"(def meshes\(self\)) -> list:", r"\1 -> list[MjsMesh]:"),
    (r"(def (geom|site|joint|light|camera|frame|texture|material)s\(self\)) -> list:", _list_of_elements),
)
"""Patterns in generated stubs, and what replaces them. Functions accept all values that NumPy converts to an array."""
HEAD = '''"""MuJoCo {version}, generated from the installed bindings by `tools.maintenance.mujoco_stubs`."""

import numpy
import numpy.typing
import typing
{imports}
__version__: str

class GLContext:
    def __init__(self, width: int, height: int) -> None: ...
    def make_current(self) -> None: ...
    def free(self) -> None: ...
    def as_current(self) -> typing.ContextManager[None]: ...

def set_mjcb_control(callback: typing.Callable[[MjModel, MjData], object] | None) -> None: ...
def __getattr__(name: str) -> typing.Any: ...
'''


def main() -> None:
    """Writes the stubs if those of this version do not exist."""
    folder = OUT / "mujoco"
    stamp = folder / f"{mujoco.__version__}.stamp"
    if stamp.is_file():
        return
    shutil.rmtree(folder, ignore_errors=True)
    for name in MODULES:
        with contextlib.redirect_stderr(io.StringIO()):  # it reports each expression that it cannot read
            stubgen(["--ignore-all-errors", "--output-dir", str(OUT), f"mujoco.{name}"])
    for file in folder.glob("*.pyi"):
        text = file.read_text()
        for pattern, replacement in REPLACED:
            text = re.sub(pattern, replacement, text)
        file.write_text(text)
    imports = "".join(f"from mujoco.{name} import *\n" for name in MODULES)
    (folder / "__init__.pyi").write_text(HEAD.format(version=mujoco.__version__, imports=imports))
    stamp.touch()


if __name__ == "__main__":
    main()
