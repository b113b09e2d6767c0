"""What trainings write beside the weights: the rows of their curves, and the state that resumes a run."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeVar

import torch

from sim.files import write_atomically
from sim.interface import ConfigError
from sim.reading import convert, reason_of
from stubborn.segmentation.checkpoints import read_checkpoint

ProgressT = TypeVar("ProgressT")


def append_row(file: Path, row: Mapping[str, Any]) -> None:
    """Appends a row to a CSV file; the keys of the first row are its heading, and other keys are left out."""
    heading: list[str] = []
    if file.exists():
        with file.open(newline="", encoding="utf-8", errors="replace") as stream:
            heading = next(csv.reader(stream), [])
    with file.open("a" if heading else "w", newline="", encoding="utf-8") as stream:
        table = csv.DictWriter(stream, heading or list(row), extrasaction="ignore")
        if not heading:
            table.writeheader()
        table.writerow(row)


def cut_rows(file: Path, column: str, most: int) -> None:
    """Removes the rows of a curve that are later than the state from which a run continues.

    Args:
        file: a CSV file; nothing is done where there is none.
        column: name of a column of whole numbers.
        most: rows with a larger number in it are removed.
    """
    if file.is_file():
        heading, *lines = file.read_text(encoding="utf-8").splitlines()
        number = heading.split(",").index(column)
        kept = [line for line in lines if int(line.split(",")[number]) <= most]
        write_atomically(file, "".join(f"{line}\n" for line in (heading, *kept)))


def read_columns(file: Path) -> dict[str, list[float]]:
    """Returns the columns of a CSV file of numbers, NaN for empty fields; nothing where there is no file."""
    if not file.exists():
        return {}
    with file.open(newline="", encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    return {key: [float(row[key] or "nan") for row in rows] for key in (rows[0] if rows else ())}


def save_state(file: Path, parts: Mapping[str, Any], progress: Mapping[str, Any]) -> None:
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
    parts: Mapping[str, Any],
    progress: type[ProgressT],
    *,
    device: torch.device | str = "cpu",
    check: Callable[[ProgressT], None] | None = None,
) -> ProgressT | None:
    """Loads the state of a run into its parts and returns the progress; None: there is no file.

    Args:
        file: `state.pt` of the run.
        parts: as for `save_state`.
        progress: the type of the progress.
        device: where the tensors go.
        check: raises ConfigError for the progress of another run, before anything is loaded.

    Raises:
        ConfigError: the file is broken, or of another network.
    """
    if not file.exists():
        return None
    content = read_checkpoint(file, device=device)
    done = convert(content.get("progress"), progress, where=f"The state '{file}' of the run")
    if check is not None:
        check(done)
    try:
        for name, part in parts.items():
            part.load_state_dict(content[name])
    except (KeyError, RuntimeError, ValueError, TypeError, AttributeError) as error:
        raise ConfigError(f"The state '{file}' of the run is of another network: {reason_of(error)}.") from None
    return done
