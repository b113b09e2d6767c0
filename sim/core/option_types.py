"""Types of options: each states the range of its values, or that it is a path which the command writes.

An `Option` in the type of a field states what else depends on it: `noise: Annotated[str, Option(of_world=True)]`.
"""

from __future__ import annotations

import dataclasses
import functools
import typing
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Literal

from msgspec import Meta

from sim.core.reading import Seed as Seed


@dataclasses.dataclass(frozen=True)
class Written:
    """Marks an option as the path that the command writes."""

    folder: bool
    picture: bool = False
    """It is the file of a picture."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Option:
    """States what an option of a run, or a part of its configuration, means; an unmarked field has the defaults."""

    recorded: bool = True
    """`config.json` holds it."""
    compared: Literal["always", "between runs", "never"] = "always"
    """Whether two runs with different values are different runs. `between runs`: a comparison of two runs names it, but
    a run can be resumed, or merged with another one, with another value. `never`: results do not depend on it, or it is
    random in each run."""
    published: bool = True
    """A submission contains it."""
    of_world: bool = False
    """It belongs to house, robot, sensors or task, so that it applies to a person who drives as well."""
    of_episodes: bool = False
    """It states which episodes are run or drawn."""
    plain: bool = False
    """It names neither a file nor code, so that the page takes it from the record of a run that it shows again."""
    viewer: bool = False
    """It starts a viewer."""
    file_field: str = ""
    """Path of the field of the configuration that holds the file which it names. `config.json` has the checksum of the
    file under the name of the option; two files with equal checksums are equal. "": it names no such file."""


@functools.cache
def meanings(options: type) -> Mapping[str, Option]:
    """Returns what each field of a dataclass means, by its name."""
    hints = typing.get_type_hints(options, include_extras=True)
    of_field = {
        field.name: [mark for mark in getattr(hints[field.name], "__metadata__", ()) if isinstance(mark, Option)]
        for field in dataclasses.fields(options)
    }
    return {name: marks[0] if marks else Option() for name, marks in of_field.items()}


Count = Annotated[int, Meta(ge=1, le=10_000_000)]
"""A count, at least 1."""
Amount = Annotated[int, Meta(ge=0, le=10_000_000)]
"""A count, at least 0."""
Share = Annotated[float, Meta(ge=0.0, le=1.0)]
Positive = Annotated[float, Meta(gt=0.0, le=1e9)]
NotNegative = Annotated[float, Meta(ge=0.0, le=1e9)]
OutFile = Annotated[Path, Written(folder=False)]
OutPicture = Annotated[Path, Written(folder=False, picture=True)]
OutFolder = Annotated[Path, Written(folder=True)]
