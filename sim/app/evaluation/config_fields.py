"""Differences between two nested JSON objects, such as the `config.json` of two runs."""

from __future__ import annotations

import enum
import json
from collections.abc import Mapping

from sim.app.options import RunOptions
from sim.core.option_types import meanings


class Absent(enum.Enum):
    """The value of a field that one of the two objects does not have."""

    ABSENT = "(absent)"


ABSENT = Absent.ABSENT
HOUSES = ("split", "house", "labels", "root")
"""Options that name the houses."""
Difference = tuple[str, object, object]
"""Dotted path of a field, its value in the first object and in the second; `ABSENT` in an object without it."""
Record = Mapping[str, object]
"""The content of a `config.json`."""
OPTIONS = meanings(RunOptions)
"""The meaning of each option that a `config.json` holds."""
DERIVED = frozenset({"versions", "codes", "settings", "segmentation"})
"""Entries of a `config.json` that follow from the code, or from other entries: `config` is the tree with `settings`."""


def differing_fields(a: Mapping[str, object], b: Mapping[str, object]) -> list[Difference]:
    """Returns the fields in which two nested JSON objects differ, sorted by path; a list is one value.

    An object that only one side has is reported field by field.
    """
    return sorted(_differences("", a, b), key=lambda difference: difference[0])


def run_differences(first: Record, second: Record, *, resumed: bool = False) -> list[Difference]:
    """Returns the fields of two `config.json` in which the runs differ, without options that change no result.

    Files and houses with equal checksums are equal: the folder of a file is another one after a checkout has moved, and
    on other machines.

    Args:
        first: content of the first file.
        second: content of the second file.
        resumed: without the fields in which a run may differ from the one that it resumes or is merged with.
    """
    ignored = {name for name, option in OPTIONS.items() if option.compared == "never"}
    if resumed:
        ignored |= {name for name, option in OPTIONS.items() if option.compared == "between runs"} | DERIVED
    return [
        (path, a, b)
        for path, a, b in differing_fields(first, second)
        if path.partition(".")[0] not in ignored and not _is_same_file(path, first, second)
    ]


def _is_same_file(path: str, first: Record, second: Record) -> bool:
    """Returns whether a field of two `config.json` names a file, or houses, with the same checksum in both."""
    field = path.removeprefix("config.")
    options = {name for name, option in OPTIONS.items() if option.file_field and field in (name, option.file_field)}
    sums = [(_sums(first).get(name), _sums(second).get(name)) for name in (field, *options)]
    if path in HOUSES:
        sums = [(_sums(first, "split_identity").get("sha256"), _sums(second, "split_identity").get("sha256"))]
    return any(a is not None and a == b for a, b in sums)


def _sums(record: Record, name: str = "files_sha256") -> Mapping[str, str]:
    sums = record.get(name)
    return sums if isinstance(sums, Mapping) else {}


def field_text(value: object) -> str:
    """Returns a value as JSON, or "(absent)"."""
    return ABSENT.value if value is ABSENT else json.dumps(value, ensure_ascii=False)


def _differences(path: str, a: object, b: object) -> list[Difference]:
    first, second = _fields(a, b), _fields(b, a)
    if first is None or second is None:
        return [] if a == b and isinstance(a, bool) == isinstance(b, bool) else [(path, a, b)]
    differences: list[Difference] = []
    for key in {*first, *second}:
        inner = f"{path}.{key}" if path else key
        differences += _differences(inner, first.get(key, ABSENT), second.get(key, ABSENT))
    return differences


def _fields(value: object, other: object) -> Mapping[str, object] | None:
    """Returns the fields of an object; {} for an absent one paired with such an object; None for any other value."""
    if isinstance(value, Mapping):
        return value if value or other is not ABSENT else None
    return {} if value is ABSENT and isinstance(other, Mapping) and other else None
