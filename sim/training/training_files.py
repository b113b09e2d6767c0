"""Files next to the weights: the rows of a training's curves, and the state that resumes a run."""

from __future__ import annotations

import csv
import hashlib
import io
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any, Protocol, TypeVar

import torch

from sim.core.files import open_to_grow, write_atomically
from sim.core.interface import ConfigError
from sim.core.invocation import command
from sim.core.reading import convert, read_bytes, read_csv, reason_of
from stubborn.network_files import read_checkpoint

ProgressT = TypeVar("ProgressT")


def append_row(file: Path, row: Mapping[str, object]) -> None:
    """Appends a row to a CSV file; the keys of the first row are its heading, and other keys are left out."""
    heading: list[str] = []
    if file.exists():
        heading = next(csv.reader(_text_of(file).splitlines()), [])
    with open_to_grow(file, "a" if heading else "w") as stream:
        table = csv.DictWriter(stream, heading or list(row), extrasaction="ignore", lineterminator="\n")
        if not heading:
            table.writeheader()
        table.writerow(row)


def cut_rows(file: Path, column: str, most: int) -> None:
    """Removes the rows of a curve that are later than the state from which a run continues, and incomplete rows.

    A process that is killed may leave an empty file, or a last line without its end.

    Args:
        file: a CSV file of numbers; nothing is done if it does not exist.
        column: name of a column of whole numbers.
        most: rows with a larger number in it are removed.

    Raises:
        ConfigError: the file has no such column.
    """
    if not file.is_file():
        return
    lines = [line.rstrip("\r") for line in _text_of(file).split("\n")[:-1]]  # the last part is not a complete line
    names = lines[0].split(",") if lines else [column]
    if column not in names:
        raise ConfigError(
            f"'{file}' is not a curve of this command: it has no column '{column}'. Choose another folder."
        )
    number = names.index(column)
    rows = [(line, _numbers(line)) for line in lines[1:]]
    kept = [line for line, values in rows if len(values) == len(names) and values[number] <= most]
    write_atomically(file, "".join(f"{line}\n" for line in (*lines[:1], *kept)))


def _numbers(line: str) -> list[float]:
    """Returns the numbers of a row, NaN for empty fields; an empty list if a field is not a number."""
    try:
        return [float(field or "nan") for field in line.split(",")]
    except ValueError:
        return []


def options_of(args: Any, *, may_change: Collection[str], files: Mapping[str, Sequence[Path]]) -> dict[str, str]:
    """Returns the options that a continued run must have in common with its start, as text by the name of the field.

    Args:
        args: dataclass of the options.
        may_change: fields that are left out.
        files: by field, the files in the folders that the field names; they are compared in place of the folders, in
            their order, by name and size.

    Raises:
        OSError: a file does not exist.
    """
    kept = {field.name for field in fields(args)} - set(may_change)
    return {name: str(getattr(args, name)) for name in kept} | {
        name: _list_of(of_option) for name, of_option in files.items()
    }


def _list_of(files: Sequence[Path]) -> str:
    """Returns the number of files and a hash of their names and sizes, independent of their folder."""
    lines = [f"{file.name} {file.stat().st_size}\n" for file in files]
    digest = hashlib.sha256("".join(lines).encode(errors="surrogateescape")).hexdigest()
    return f"{len(files)} files (hash {digest[:12]})"


def require_options(out: Path, before: Mapping[str, str], now: Mapping[str, str]) -> None:
    """Raises ConfigError if options of a run differ from those of its start; both are of `options_of`."""
    for name in sorted({*before, *now}):
        start, present = (options.get(name, "(absent)") for options in (before, now))
        if start != present:
            raise ConfigError(
                f"--out '{out}' holds a run with --{name.replace('_', '-')} = {start}, this command has {present}; "
                "take another folder, or continue with the options of that run."
            )


def read_columns(file: Path) -> dict[str, list[float]]:
    """Returns the columns of a CSV file of numbers, NaN for empty fields; an empty dict if the file does not exist.

    Raises:
        ConfigError: a field is not a number.
    """
    if not file.exists():
        return {}
    rows = read_csv(file, what="Curve")
    try:
        return {key: [float(row[key] or "nan") for row in rows] for key in (rows[0] if rows else ())}
    except ValueError as error:
        raise ConfigError(f"Curve '{file}' is not a table of numbers: {reason_of(error)}.") from None


def _text_of(file: Path) -> str:
    """Returns the text of a curve; bytes that are not UTF-8 are replaced."""
    return read_bytes(file, what="Curve").decode("utf-8", errors="replace")


class HasState(Protocol):
    """A network or an optimiser of PyTorch."""

    def state_dict(self) -> dict[str, Any]: ...  # noqa: D102
    def load_state_dict(self, state_dict: dict[str, Any], /) -> object: ...  # noqa: D102


def save_state(file: Path, parts: Mapping[str, HasState], progress: Mapping[str, object]) -> None:
    """Writes the state of a run; the file is replaced in one step.

    Args:
        file: `state.pt` of the run.
        parts: networks and optimisers by name: objects with `state_dict`.
        progress: JSON values, under the name `progress`.
    """
    content = io.BytesIO()
    torch.save({name: part.state_dict() for name, part in parts.items()} | {"progress": dict(progress)}, content)
    write_atomically(file, content.getvalue())


def load_state(
    file: Path,
    parts: Mapping[str, HasState],
    progress: type[ProgressT],
    *,
    device: torch.device | str = "cpu",
    check: Callable[[ProgressT], None],
) -> ProgressT | None:
    """Loads the state of a run into its parts and returns the progress; None: the file does not exist.

    Args:
        file: `state.pt` of the run.
        parts: as for `save_state`.
        progress: the type of the progress.
        device: where the tensors go.
        check: raises ConfigError for the progress of another run, before anything is loaded.

    Raises:
        ConfigError: the file is broken, of another version of the command, or of another network.
    """
    if not file.exists():
        return None
    content = read_checkpoint(file, device=device)
    try:
        done = convert(content.get("progress"), progress, where="its progress")
    except ConfigError as error:
        raise ConfigError(
            f"The state '{file}' of the run is of another version of this command ({str(error).rstrip('.')}); take "
            "another folder."
        ) from None
    check(done)
    try:
        for name, part in parts.items():
            part.load_state_dict(content[name])
    except (KeyError, RuntimeError, ValueError, TypeError, AttributeError) as error:
        raise ConfigError(f"The state '{file}' of the run is of another network: {reason_of(error)}.") from None
    return done


def print_next_runs(weights: Path, agent: str, field: str) -> None:
    """Prints the path of the trained weights, and the commands that run an agent with `--config FIELD=WEIGHTS`."""
    words = ("--agent", agent, "--semantics", "gt", "--config", f"{field}={weights}")
    print_next_commands(weights, command("run", *words), command("run", *words, "--episodes", "2", "--video"))


def print_next_commands(weights: Path, *commands: str) -> None:
    """Prints the path of the trained weights, and the commands that use them."""
    print(f"weights: {weights}\nnext:", *commands, sep="\n  ", flush=True)
