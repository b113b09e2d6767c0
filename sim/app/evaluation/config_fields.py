"""Differences between two nested JSON objects, such as the `config.json` of two runs."""

from __future__ import annotations

import enum
import json
from collections.abc import Mapping
from typing import Any


class Absent(enum.Enum):
    """The value of a field that one of the two objects does not have."""

    ABSENT = "(absent)"


ABSENT = Absent.ABSENT
Difference = tuple[str, Any, Any]
"""Dotted path of a field, its value in the first object and in the second; `ABSENT` in an object without it."""


def differing_fields(a: Mapping[str, Any], b: Mapping[str, Any]) -> list[Difference]:
    """Returns the fields in which two nested JSON objects differ, sorted by path; a list is one value.

    An object that only one side has is reported field by field.
    """
    return sorted(_differences("", a, b), key=lambda difference: difference[0])


def is_same_file(path: str, first: Mapping[str, Any], second: Mapping[str, Any]) -> bool:
    """Returns whether a field of two `config.json` names a file that has the same checksum in both.

    The folder of a file is another one after a checkout has moved, and on other machines.
    """
    name = {
        "weights": "weights",
        "config.detector.weights": "weights",
        "verifier": "verifier",
        "config.verification.parameters": "verifier",
        "config.robot.file.path": "robot",
    }.get(path, path.removeprefix("config."))
    for each in (name, path.removeprefix("config.")):
        sums = [record.get("files_sha256", {}).get(each) for record in (first, second)]
        if sums[0] is not None and sums[0] == sums[1]:
            return True
    return False


def field_text(value: Any) -> str:
    """Returns a value as JSON, or "(absent)"."""
    return ABSENT.value if value is ABSENT else json.dumps(value, ensure_ascii=False)


def _differences(path: str, a: Any, b: Any) -> list[Difference]:
    first, second = _fields(a, b), _fields(b, a)
    if first is None or second is None:
        return [] if a == b and isinstance(a, bool) == isinstance(b, bool) else [(path, a, b)]
    found: list[Difference] = []
    for key in {*first, *second}:
        inner = f"{path}.{key}" if path else key
        found += _differences(inner, first.get(key, ABSENT), second.get(key, ABSENT))
    return found


def _fields(value: Any, other: Any) -> Mapping[str, Any] | None:
    """Returns the fields of an object; {} for an absent one paired with such an object; None for any other value."""
    if isinstance(value, Mapping):
        return value if value or other is not ABSENT else None
    return {} if value is ABSENT and isinstance(other, Mapping) and other else None
