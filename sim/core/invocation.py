"""Finds how the user started this process, so that messages name commands as the user would type them."""

from __future__ import annotations

import contextlib
import contextvars
import shlex
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path

SCRIPT = "stubborn"
"""The installed command."""
MAIN = "sim.app.commands.main"
"""The module that the installed command runs."""
MODULES = ("run", "report", "web")
"""Commands that also start as `python -m sim.NAME`."""
RUN_STOPPED = "Stopped. The same command with the same --out resumes the run."
"""The message that `stubborn run` prints after Ctrl-C or SIGTERM."""
_SUBCOMMAND: contextvars.ContextVar[str | None] = contextvars.ContextVar("subcommand", default=None)


def command(*words: object) -> str:
    """Returns a `stubborn` command to be copied into a shell, for example of `report` and a folder.

    It begins as this process did: with `stubborn` or the path to it, or with `python -m sim.NAME` for the commands that
    can be started so. In a process that is not a command of this project it begins with `stubborn`.
    """
    module = _module()
    if module == MAIN:
        start = [python(), "-m", MAIN]
    elif module is not None and module.removeprefix("sim.") in MODULES:
        if words and str(words[0]) in MODULES:
            return shlex.join([python(), "-m", f"sim.{words[0]}", *map(str, words[1:])])
        start = [beside_python(SCRIPT)]
    else:
        start = [_script()]
    return shlex.join([*start, *map(str, words)])


def program() -> str:
    """Returns the command that runs now, without its options: `stubborn web`, `.venv/bin/python -m sim.web`."""
    if (subcommand := _SUBCOMMAND.get()) is not None:
        return command(*subcommand.split())
    if (module := _module()) is not None:
        return shlex.join([python(), "-m", module])
    if sys.argv[0].endswith(".py"):
        return shlex.join([python(), sys.argv[0]])
    return Path(sys.argv[0]).name


@contextlib.contextmanager
def running(subcommand: str) -> Iterator[None]:
    """A context in which `program` names this sub-command of `stubborn`, for example `houses generate`."""
    token = _SUBCOMMAND.set(subcommand)
    try:
        yield
    finally:
        _SUBCOMMAND.reset(token)


def python() -> str:
    """Returns the interpreter as the user would type it: `.venv/bin/python` in the folder above, `python` on the path.

    Links are not followed: the interpreter of a virtual environment is one.
    """
    interpreter = Path(sys.executable or "python")
    with contextlib.suppress(ValueError, OSError):  # OSError: the current folder was removed
        return str(interpreter.relative_to(Path.cwd()))
    on_path = shutil.which("python")
    return "python" if on_path is not None and Path(on_path) == interpreter else str(interpreter)


def _module() -> str | None:
    """Returns the module that `python -m` started; None: the process was started differently."""
    spec = getattr(sys.modules["__main__"], "__spec__", None)
    return None if spec is None else spec.name.removesuffix(".__main__")


def _script() -> str:
    """Returns the installed command as it was typed; `stubborn` where it is on the path or was not typed."""
    typed = Path(sys.argv[0])
    if typed.name != SCRIPT:
        return SCRIPT
    with contextlib.suppress(OSError):  # the current folder was removed
        on_path = shutil.which(SCRIPT)
        if on_path is not None and Path(on_path).absolute() == typed.absolute():
            return SCRIPT
    return str(typed)


def beside_python(name: str) -> str:
    """Returns an installed program of this environment as the user would type it: its name, or its path if needed."""
    program = Path(sys.executable or "python").with_name(name)
    on_path = shutil.which(name)
    if not program.is_file() or (on_path is not None and Path(on_path) == program):
        return name
    with contextlib.suppress(ValueError, OSError):  # OSError: the current folder was removed
        return str(program.relative_to(Path.cwd()))
    return str(program)
