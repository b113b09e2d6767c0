"""Imports the users' objects that options name as `package.module:NAME`."""

from __future__ import annotations

import contextlib
import importlib
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from types import FrameType
from typing import Any

from sim.app.evaluation.own_code import place_of, text_of
from sim.app.evaluation.watch import FACTORY_S, is_stop
from sim.core.errors import ConfigError, did_you_mean


class _TooLong(BaseException):
    """An import took longer than `FACTORY_S`; it is not an `Exception`, which handlers in the module could catch."""


@contextlib.contextmanager
def _limited() -> Iterator[None]:
    """Raises `_TooLong` in the block after `FACTORY_S`; only in the main thread, where Python handles signals."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def stop(number: int, frame: FrameType | None) -> None:
        raise _TooLong(f"the import did not end within {FACTORY_S:g} s")

    before = signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, FACTORY_S)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


def _require_unhidden() -> None:
    """Raises ConfigError if the current folder has modules that would hide this project's in spawned workers."""
    ours = Path(__file__).resolve().parents[3]
    for name in ("sim", "stubborn"):
        for file in (Path(f"{name}.py"), Path(name) / "__init__.py"):
            if file.is_file() and file.resolve() != ours / file:
                raise ConfigError(
                    f"Your '{file}' in the current folder would hide the package '{name}' of this project; rename it, "
                    "or run the command in another folder."
                )


def _require_module_name(name: str, module: str, attribute: str, prefix: str) -> None:
    """Raises ConfigError if the user gave the path of a file in place of the name of its module."""
    if "/" not in module and not Path(module).is_file():
        return
    file = Path(module.removesuffix(".py"))
    if file.is_absolute() or ".." in file.parts:
        place, file = f", in the folder '{file.parent}' or with it on PYTHONPATH", Path(file.name)
    else:
        place = ""
    raise ConfigError(
        f"'{name}': '{module}' is a path; give the name of the module: "
        f"'{prefix}{'.'.join(file.parts)}:{attribute}'{place}."
    )


def import_attribute(
    name: str, explain: Callable[[BaseException], str | None] = lambda error: None, *, prefix: str = ""
) -> Any:
    """Returns an object of a module that is in the current folder or on the path.

    Args:
        name: of the object, `package.module:NAME`, as the user gave it.
        explain: returns a sentence about an error of the import if it knows the cause, else None.
        prefix: beginning of the name, before that of the module.

    Raises:
        ConfigError: the module cannot be imported, its import does not end within two minutes, or it has no such name.
    """
    module_name, _, attribute = name.removeprefix(prefix).partition(":")
    _require_module_name(name, module_name, attribute, prefix)
    if "" not in sys.path:
        _require_unhidden()
        sys.path.insert(0, "")  # `python -m` has it; spawned workers and installed scripts do not
    folder = os.getcwd()
    try:
        with _limited():
            module = importlib.import_module(module_name)
    except ModuleNotFoundError as error:
        if error.name is None or f"{module_name}.".startswith(f"{error.name}."):
            reason = f"no module '{error.name}' can be imported from here."
        else:
            reason = f"it imports '{error.name}', which is not installed{place_of(error, below=__file__)}."
        reason = explain(error) or reason
        raise ConfigError(f"'{name}': {reason}") from None
    except BaseException as error:  # the user's code
        if is_stop(error):
            raise
        place = "" if isinstance(error, SyntaxError) else place_of(error, below=__file__)  # its text names the line
        reason = explain(error) or f"{type(error).__name__}: {text_of(error)}{place}"
        raise ConfigError(f"'{name}': module '{module_name}' cannot be imported: {reason}") from error
    finally:
        os.chdir(folder)  # the options' paths are relative to it
    try:
        return vars(module)[attribute]
    except KeyError:
        hint = did_you_mean(attribute, vars(module))
        raise ConfigError(f"'{name}': module '{module_name}' has no '{attribute}'.{hint}") from None
