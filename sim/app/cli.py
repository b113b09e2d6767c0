"""Builds command lines from dataclasses, and reports each error of a command in one line on stderr.

`run` is the entry point of every command, including those in `tools`. Exit status 2 is an error that the user can
correct: a wrong option, a broken file, a full disk. 130 and 143 are Ctrl-C and SIGTERM. `--debug`, which every command
takes, shows the traceback as well.

An option's range is declared with its type (`Seed`, `Count`, `Share`, ...), and is checked here; a file or folder that
the command writes is an `OutFile`, `OutPicture` or `OutFolder`, and is refused before any work if it cannot be written.
"""

from __future__ import annotations

import contextlib
import ctypes
import dataclasses
import io
import math
import os
import re
import signal
import sys
import threading
import time
import traceback
import types
import typing
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NoReturn, TypeVar

import tyro
from msgspec import Meta

from sim.core import invocation
from sim.core.errors import ConfigError, ObjectNavError, debug, debugging
from sim.core.files import PICTURE_SUFFIXES, require_writable
from sim.core.option_types import (  # noqa: F401 - commands take the types of their options from here
    Amount,
    Count,
    NotNegative,
    OutFile,
    OutFolder,
    OutPicture,
    Positive,
    Seed,
    Share,
    Written,
)  # fmt: skip
from sim.core.reading import first_unprintable, printable, reason_of

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

ItemT = TypeVar("ItemT")
ArgsT = TypeVar("ArgsT", bound="DataclassInstance")
DEBUG_HELP = "Every command also takes --debug, which shows the traceback of an error."

OnUnlessNo = Annotated[bool, tyro.conf.arg(help_behavior_hint="")]
"""A switch that is on by default. Its option is `--no-NAME`, and its help text describes that option."""

LAST_WORDS_S = 10.0
"""Longest time in which threads and exit handlers may end after a command has returned."""


class Terminated(KeyboardInterrupt):
    """SIGTERM: ends the command like Ctrl-C, so that its workers end and its unfinished files are removed."""


_STOPS = {KeyboardInterrupt.__name__, Terminated.__name__}


def is_stop(error: BaseException) -> bool:
    """Returns whether an error is Ctrl-C or SIGTERM.

    One that arrives while a call of C converts its arguments, as calls of OpenGL do, is hidden in the error of ctypes:
    "argument 1: Terminated: ".
    """
    hidden = isinstance(error, ctypes.ArgumentError) and not _STOPS.isdisjoint(str(error).split(": "))
    return hidden or isinstance(error, KeyboardInterrupt)


def chosen(text: str, names: Iterable[str], *, option: str) -> list[str]:
    """Returns the names of a comma-separated option, in the order of `names`.

    Raises:
        ConfigError: a name is unknown or missing.
    """
    known, selected = list(names), [name.strip() for name in text.split(",") if name.strip()]
    if not selected or not set(selected) <= set(known):
        raise ConfigError(f"{option} must be some of {','.join(known)}, got '{text}'.")
    return [name for name in known if name in selected]


def first_of(items: Sequence[ItemT], count: int | None, *, option: str, source: str) -> Sequence[ItemT]:
    """Returns the first items of a source that an option counts; all if the count is None.

    Raises:
        ConfigError: the source has fewer.
    """
    if count is not None and count > len(items):
        raise ConfigError(f"{option} must be at most {len(items)}, all of {source}, got {count}.")
    return items[:count]


def run(
    args_type: type[ArgsT],
    main: Callable[[ArgsT], int],
    argv: Sequence[str] | None = None,
    *,
    stopped: str = "Stopped.",
) -> int:
    """Parses the command line into `args_type` and returns the exit status of `main`, or that of its error.

    Args:
        args_type: dataclass of the options.
        main: the command.
        argv: the words of the command line; those of the process when None.
        stopped: the message that is printed after Ctrl-C or SIGTERM.
    """
    words = list(sys.argv[1:] if argv is None else argv)
    _print_any_text()
    with debugging("--debug" in words), _sigterm_ends():
        try:
            args = parse(args_type, [word for word in words if word != "--debug"])
            check(args)
            return main(args)
        except BrokenPipeError:  # the reader of the output has ended, as `head` does
            os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
            return 1
        except ObjectNavError as error:
            return _refused(str(error))
        except OSError as error:
            names = " and ".join(f"'{name}'" for name in (error.filename, error.filename2) if name is not None)
            return _refused(f"{names or 'A file'} cannot be read or written: {reason_of(error)}.")
        except MemoryError:
            return _refused("There is not enough memory for this.")
        except (KeyboardInterrupt, ctypes.ArgumentError) as stop:
            if not is_stop(stop):
                raise
            print(f"\n{stopped}", file=sys.stderr)
            return 143 if Terminated.__name__ in (type(stop).__name__, *str(stop).split(": ")) else 130


def leave_soon(status: int) -> int:
    """Ensures that the process ends within `LAST_WORDS_S`; returns its exit status.

    Threads and exit handlers of a user's code could otherwise keep it running.
    """

    def leave() -> None:
        time.sleep(LAST_WORDS_S)
        os._exit(status)

    with contextlib.suppress(OSError, ValueError):
        sys.stdout.flush()
    threading.Thread(target=leave, daemon=True, name="end").start()
    return status


def parse(args_type: type[ArgsT], argv: Sequence[str] | None = None) -> ArgsT:
    """Returns the command line as an `args_type`.

    Raises:
        ConfigError: an option does not exist, or its value cannot be read or is not printable text.
        SystemExit: status 0 after `--help`.
    """
    words = sys.argv[1:] if argv is None else argv
    if (bad := first_unprintable(words)) is not None:
        raise ConfigError(f"'{printable(bad)}' holds a control character or a byte that is not UTF-8; give plain text.")
    messages = io.StringIO()
    description = f"{(args_type.__doc__ or '').strip()}\n\n{DEBUG_HELP}"
    try:
        with contextlib.redirect_stderr(messages):
            options = (tyro.conf.FlagCreatePairsOff,)
            shown = _without_empty_defaults(args_type)
            joined = _joined(args_type, words)
            args = tyro.cli(shown, prog=invocation.program(), args=joined, description=description, config=options)
            return args_type(**vars(args))
    except SystemExit as stop:
        if stop.code in (0, None):
            raise
        raise ConfigError(_message_in_box(messages.getvalue())) from None


def _joined(args_type: type, words: Sequence[str]) -> list[str]:
    """Returns the words of a command line in which the values of a repeated option follow its first name.

    Without this, only the last values of an option that takes several would count.
    """
    hints = typing.get_type_hints(args_type)
    several = {f"--{name.replace('_', '-')}" for name, hint in hints.items() if ... in typing.get_args(_bare(hint))}
    current: list[str] = []
    parts, of_option = [current], dict[str, list[str]]()
    for word in words:
        name, is_pair, value = word.partition("=")
        name = name.replace("_", "-")
        if name in of_option:
            current = of_option[name]
            current.extend([value] if is_pair else [])
        elif word.startswith("--"):
            current = [name, value] if name in several and is_pair else [word]
            parts.append(current)
            if name in several:
                of_option[name] = current
        else:
            current.append(word)
    return [word for part in parts for word in part]


_POSITIONAL = typing.get_args(tyro.conf.Positional[str])[1]
"""The mark of positional arguments, which several commands require."""


def _without_empty_defaults(args_type: type[ArgsT]) -> type[ArgsT]:
    """Returns a dataclass with the same options, whose help text shows neither "(default: None)" nor "(default: )".

    The help text of such an option describes what happens if it is not given.
    """
    hints = typing.get_type_hints(args_type, include_extras=True)
    empty = [
        field.name
        for field in dataclasses.fields(args_type)
        if field.default in (None, ()) or _POSITIONAL in getattr(hints[field.name], "__metadata__", ())
    ]
    silent = {name: Annotated[hints[name], tyro.conf.arg(help_behavior_hint="")] for name in empty}
    names = {"__annotations__": silent, "__doc__": args_type.__doc__, "__module__": args_type.__module__}
    return typing.cast(type[ArgsT], type(args_type.__name__, (args_type,), names))


def check(args: DataclassInstance) -> None:
    """Checks that options are in the ranges of their types, and that the command's output can be written.

    Raises:
        ConfigError: an option fails the check; the message names it, its value and what is allowed.
    """
    hints = typing.get_type_hints(type(args), include_extras=True)
    for field in dataclasses.fields(args):
        _check_value(f"--{field.name.replace('_', '-')}", getattr(args, field.name), hints[field.name])


def require_unset(args: DataclassInstance, names: Iterable[str], why: str) -> None:
    """Raises ConfigError if an option with one of these names is not its default; `why` follows its name."""
    for field in dataclasses.fields(args):
        value = getattr(args, field.name)
        if field.name in names and value != field.default:
            raise ConfigError(f"--{'no-' if value is False else ''}{field.name.replace('_', '-')} {why}")


def _check_value(name: str, value: object, hint: object) -> None:
    """Raises ConfigError if a value is not in the range of its type."""
    if dataclasses.is_dataclass(value):
        for field in dataclasses.fields(value):
            _check_value(f"{name}.{field.name.replace('_', '-')}", getattr(value, field.name), object)
        return
    if isinstance(value, tuple):
        inner = next(iter(typing.get_args(_bare(hint))), object)
        for item in value:
            _check_value(name, item, inner)
        return
    if isinstance(value, float) and not math.isfinite(value):
        raise ConfigError(f"{name} must be a finite number, got {value}.")
    for mark in _marks(hint):
        if isinstance(mark, Written) and isinstance(value, Path):
            require_writable(value, name=name, folder=mark.folder)
            if mark.picture and value.suffix.lower() not in PICTURE_SUFFIXES:
                raise ConfigError(f"{name} '{value}' must end with one of {', '.join(PICTURE_SUFFIXES)}.")
        elif isinstance(mark, Meta) and isinstance(value, int | float):
            _require_range(name, value, mark)


def _require_range(name: str, value: float, mark: Meta) -> None:
    """Raises ConfigError if a number is beyond the bounds of its type."""
    bounds = (
        ("at least", mark.ge, lambda low: value >= low),
        ("more than", mark.gt, lambda low: value > low),
        ("at most", mark.le, lambda high: value <= high),
        ("less than", mark.lt, lambda high: value < high),
    )
    for words, bound, holds in bounds:
        if bound is not None and not holds(bound):
            raise ConfigError(f"{name} must be {words} {bound:g}, got {value}.")


def _bare(hint: object) -> object:
    """Returns a type without `Annotated` and `| None`."""
    while True:
        if typing.get_origin(hint) is Annotated:
            hint = typing.get_args(hint)[0]
        elif typing.get_origin(hint) in (typing.Union, types.UnionType):
            hint = next(member for member in typing.get_args(hint) if member is not type(None))
        else:
            return hint


def _marks(hint: object) -> Iterator[object]:
    """Yields the marks of a type, also of one inside `| None`."""
    if typing.get_origin(hint) is Annotated:
        inner, *marks = typing.get_args(hint)
        yield from marks
        yield from _marks(inner)
    elif typing.get_origin(hint) in (typing.Union, types.UnionType):
        for member in typing.get_args(hint):
            yield from _marks(member)


def _refused(message: str) -> int:
    """Prints an error in one line, after its traceback with `--debug`; returns the exit status."""
    if debug():
        traceback.print_exc()
    print(f"error: {printable(' '.join(message.split()))}", file=sys.stderr)
    return 2


@contextlib.contextmanager
def _sigterm_ends() -> Iterator[None]:
    """Makes SIGTERM raise `Terminated`; it has no effect outside of the main thread."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGTERM, _raise_terminated)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def _raise_terminated(number: int, frame: types.FrameType | None) -> NoReturn:
    raise Terminated


def _print_any_text() -> None:
    """Prints characters that the terminal's encoding lacks as escapes; by default they raise an error."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


_NO_NUMBER = re.compile(
    r"Error parsing (?P<option>--\S+): .*"
    r"(?:invalid literal for int\(\) with base 10|could not convert string to float): (?P<text>'.*')$"
)
"""Python's words for a text that is no number, as tyro passes them on, also for an option that may be None."""


def _message_in_box(box: str) -> str:
    """Returns the message inside the frame that tyro prints around it, and the names of similar options.

    Rules separate the message from help texts, which are left out. Without UTF-8, tyro draws the title as a first part.
    """
    lines = [line.strip().strip("│").strip() for line in box.splitlines() if not line.startswith(("╭", "╰"))]
    parts = re.split(r"\n[─-]+\n", "\n".join(line for line in lines if line))
    blocks = [part.split("\n") for part in parts[len(parts) > 1 and "╭" not in box :]]
    message = " ".join(blocks[0]) or "The command line could not be read. Try --help."
    similar = [line for block in blocks if block[0].startswith("Perhaps you meant") for line in block[1:]]
    names = " or ".join(line.split()[0] for line in similar if line.startswith("--"))
    if (match := _NO_NUMBER.match(message)) is not None:
        option, text = match["option"], match["text"]
        return f"{option} must be a {'whole ' * ('int()' in message)}number, got {text}."
    return f"{message}. Did you mean {names}?" if names else message
