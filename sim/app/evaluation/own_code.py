"""Finds the line of a user's own code in which an error was raised, and hashes the code to distinguish versions."""

from __future__ import annotations

import ast
import hashlib
import sys
import sysconfig
import traceback
from collections.abc import Iterable, Iterator
from pathlib import Path

from sim.core.reading import printable, read_bytes, sha256_of

MAX_CHARACTERS = 2000
"""Longest text of an error in results and messages."""
_OURS = tuple(Path(__file__).resolve().parents[3] / name for name in ("sim", "stubborn"))
_LIBRARIES = tuple(Path(sysconfig.get_path(name)).resolve() for name in ("stdlib", "platstdlib", "purelib", "platlib"))


def place_of(error: BaseException, *, below: str) -> str:
    """Returns " (mine/agent.py, line 12)": the innermost line of the code that raised an error.

    Code of the user has priority over this project, and this project over libraries: if a user's network gets an array
    of a wrong shape, the message names the line of the call and not one inside of PyTorch.

    Args:
        error: an error that was raised.
        below: file of the function that called the code; frames of this file do not count.

    Returns:
        The place in brackets after a space; "" if there is no frame.
    """
    frames = [frame for frame in traceback.extract_tb(error.__traceback__) if frame.filename != below]
    for tier in (_is_users, _is_not_library, lambda file: True):
        for frame in reversed(frames):
            if tier(Path(frame.filename)):
                return f" ({_short(Path(frame.filename))}, line {frame.lineno})"
    return ""


def described(error: BaseException, *, below: str) -> str:
    """Returns "ValueError: its message (mine/agent.py, line 12)"; `below` as for `place_of`."""
    return f"{type(error).__name__}: {text_of(error)}{place_of(error, below=below)}"


def text_of(error: BaseException) -> str:
    """Returns an error's message in one line of at most `MAX_CHARACTERS`, even if the error's class cannot print it."""
    try:
        text = str(error)
    except BaseException as fault:
        return f"its message cannot be read ({type(fault).__name__})"
    return one_line(text) or "no message"


def one_line(text: str, most: int = MAX_CHARACTERS) -> str:
    """Returns a text in one line that a terminal, JSON and UTF-8 can hold; a long text is truncated."""
    cut = f" ... ({len(text)} characters)" if len(text) > most else ""
    return printable(" ".join(text[:most].split())) + cut


def hash_of_own(modules: Iterable[str], files: Iterable[Path] = ()) -> str:
    """Returns a hash (12 hex digits) of a user's modules and of all that they import from the same source folder.

    Imports are read from the source, so that imports inside functions count, whether they have run or not.

    Args:
        modules: names of imported modules; those of this project and of libraries do not count.
        files: further files; if one is a Python file, the modules that it imports from its folder count, too.

    Returns:
        The hash; "" if no module is a user's and there are no files.
    """
    contents: dict[Path, tuple[str, bytes]] = {}
    for name in modules:
        file = Path(getattr(sys.modules.get(name), "__file__", None) or "<none>").resolve()
        if file.suffix == ".py" and file.is_file() and _is_users(file):
            root = file.parents[name.count(".") + (file.name == "__init__.py")]
            _read_with_imports(file, root, contents)
    digest, others = hashlib.sha256(), sorted({file.resolve() for file in files})
    for file in others:
        if file.suffix == ".py":
            _read_with_imports(file, file.parent, contents)
    for place, source in sorted(contents.values()):
        digest.update(place.encode() + source)
    for file in (path for path in others if path.suffix != ".py"):
        digest.update(file.name.encode() + bytes.fromhex(sha256_of(file, what="File of an agent")))
    return digest.hexdigest()[:12] if contents or others else ""


def _read_with_imports(file: Path, root: Path, contents: dict[Path, tuple[str, bytes]]) -> None:
    """Adds a file and the files below `root` that it imports to the contents, with their paths relative to `root`."""
    if file in contents:
        return
    source = read_bytes(file, what="Module")
    contents[file] = str(file.relative_to(root)), source
    for module in _imported(source, file, root):
        path = root.joinpath(*module.split("."))
        for candidate in (path.with_name(f"{path.name}.py"), path / "__init__.py"):
            if candidate.is_file() and _is_users(candidate):
                _read_with_imports(candidate, root, contents)


def _imported(source: bytes, file: Path, root: Path) -> Iterator[str]:
    """Yields the names of the modules that a source may import, with their packages; none if it cannot be parsed."""
    try:
        nodes = list(ast.walk(ast.parse(source)))
    except (SyntaxError, ValueError):
        return
    package = file.relative_to(root).parent.parts
    names: list[str] = []
    for node in nodes:
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            parts = (*package[: len(package) + 1 - node.level], *filter(None, [node.module])) if node.level else ()
            base = ".".join(parts) if node.level else node.module or ""
            names += [base, *(f"{base}.{alias.name}".lstrip(".") for alias in node.names)]
    for name in filter(None, names):
        parts = name.split(".")
        yield from (".".join(parts[: end + 1]) for end in range(len(parts)))


def _is_users(file: Path) -> bool:
    return _is_not_library(file) and not any(file.resolve().is_relative_to(folder) for folder in _OURS)


def _is_not_library(file: Path) -> bool:
    if str(file).startswith("<"):  # <frozen importlib._bootstrap>
        return False
    return not any(file.resolve().is_relative_to(folder) for folder in _LIBRARIES)


def _short(file: Path) -> str:
    """Returns a path relative to the current folder if the file is below it, else its last two names."""
    try:
        return str(file.resolve().relative_to(Path.cwd().resolve()))
    except ValueError:
        return str(Path(*file.parts[-2:]))
