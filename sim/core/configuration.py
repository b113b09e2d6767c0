"""One tree of settings from nested frozen dataclasses: set a field by its path, read a file, write it all as JSON.

A path names a field from the root, with dots: `agent.planning.dilation_m`. Values of a command line are text; values of
a file are JSON or TOML. msgspec converts them to the declared type of the field, and the checks of the dataclass run.
"""

from __future__ import annotations

import dataclasses
import json
import math
import reprlib
import tomllib
import typing
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeGuard, TypeVar, cast

import msgspec

from sim.core.errors import ConfigError, did_you_mean
from sim.core.geometry.numbers import LARGEST, is_number
from sim.core.reading import parse_json, read_bytes, without_mark

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

TreeT = TypeVar("TreeT")
MAX_SETTINGS_BYTES = 1 << 20


def as_json(value: object) -> Any:
    """Returns a configuration as JSON types: dataclasses as objects, tuples as lists, infinity as the text "inf"."""
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {field.name: as_json(getattr(value, field.name)) for field in dataclasses.fields(value)}
    if isinstance(value, Mapping):
        return {str(key): as_json(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [as_json(item) for item in value]
    if isinstance(value, Path):
        return str(value)
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    return value


def field_paths(tree: object, prefix: str = "") -> list[str]:
    """Returns the paths of all fields of a tree that hold no further dataclass, in order."""
    if not _is_node(tree):
        return [prefix]
    paths: list[str] = []
    for field in dataclasses.fields(tree):
        path = f"{prefix}.{field.name}" if prefix else field.name
        paths += field_paths(getattr(tree, field.name), path)
    return paths


def with_fields(tree: TreeT, values: Mapping[str, object]) -> TreeT:
    """Returns a copy of the tree with some fields set.

    Args:
        tree: the root, a frozen dataclass; it is not changed.
        values: path of each field to its value: text as on a command line, JSON's types, or the value itself.

    Raises:
        ConfigError: an unknown path, or a value that is not allowed; fields are set together, so that values which
            are allowed only in combination can be given in one call.
    """
    nested: dict[str, object] = {}
    for path, value in values.items():
        _put(nested, path.split("."), value, path)
    return cast(TreeT, _replaced(cast("DataclassInstance", tree), nested, ""))


def with_absolute_paths(tree: TreeT) -> TreeT:
    """Returns a copy of a frozen dataclass in which every field that is a path is absolute."""
    values = {field.name: getattr(tree, field.name) for field in dataclasses.fields(tree)}  # type: ignore[arg-type]
    paths = {name: value.absolute() for name, value in values.items() if isinstance(value, Path)}
    return dataclasses.replace(tree, **paths)  # type: ignore[type-var]


def as_settings(given: TreeT | Mapping[str, object] | None, default: TreeT, *, name: str) -> TreeT:
    """Returns a configuration that a caller gave as an object, as a dict of some of its fields, or not at all.

    Args:
        given: the configuration; fields that a dict lacks keep their default, and None is the default.
        default: a frozen dataclass.
        name: name of the argument for the error message.

    Raises:
        ConfigError: it is of another type, or the dict holds an unknown field or a value that is not allowed.
    """
    if given is None or isinstance(given, type(default)):
        return default if given is None else given
    if not isinstance(given, Mapping):
        kind = type(default).__name__
        raise ConfigError(f"{name} must be a {kind} or a dict of its fields, got {reprlib.repr(given)}.")
    try:
        return with_fields(default, given)
    except ConfigError as error:
        raise ConfigError(f"{name}: {error}") from None


def parse_assignments(assignments: Iterable[str]) -> dict[str, object]:
    """Returns path and value of each `PATH=VALUE` of a command line; a value is JSON where it can be read as JSON.

    Raises:
        ConfigError: an assignment without `=`, or a path that is given twice.
    """
    values: dict[str, object] = {}
    for assignment in assignments:
        path, separator, text = assignment.partition("=")
        if not separator or not path:
            raise ConfigError(f"--config takes FIELD=VALUE, for example task.max_steps=300; got '{assignment}'.")
        if path in values:
            raise ConfigError(f"--config sets '{path}' twice.")
        values[path] = _value_of(text)
    return values


def assignments_of(values: Mapping[str, object]) -> list[str]:
    """Returns the `PATH=VALUE` texts from which `parse_assignments` reads these values."""
    return [f"{path}={_text_of(value)}" for path, value in values.items()]


def _text_of(value: object) -> str:
    if isinstance(value, str) and _value_of(value) == value:
        return value  # other texts need quotes, such as the name "7"
    return json.dumps(value, separators=(",", ":"))


def _value_of(text: str) -> object:
    try:
        return json.loads(text)
    except (ValueError, RecursionError):
        return text


def read_settings(file: Path) -> dict[str, object]:
    """Returns path and value of each field in a file of settings, `.toml` or `.json`, nested or with dotted paths.

    Raises:
        ConfigError: the file is missing, unreadable, or holds no table of settings.
    """
    content = read_bytes(file, what="--config-file", most=MAX_SETTINGS_BYTES)
    if file.suffix.lower() != ".toml":
        return dict(leaves_of(parse_json(content, dict[str, object], where=f"--config-file '{file}'")))
    try:
        return dict(leaves_of(tomllib.loads(without_mark(content).decode("utf-8"))))
    except RecursionError:
        raise ConfigError(f"--config-file '{file}' is nested too deeply.") from None
    except ValueError as error:
        raise ConfigError(f"--config-file '{file}' is not valid: {error}") from None


def leaves_of(tree: Mapping[str, object], prefix: str = "") -> Iterator[tuple[str, object]]:
    """Yields the dotted path of each value of nested mappings that is not a mapping, after `prefix`, and the value."""
    for key, value in tree.items():
        if isinstance(value, Mapping):
            yield from leaves_of(value, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", value


def _is_node(value: object) -> TypeGuard[DataclassInstance]:
    return dataclasses.is_dataclass(value) and not isinstance(value, type)


def _put(nested: dict[str, object], names: list[str], value: object, path: str) -> None:
    """Enters a value into nested dicts, one level for each name of its path; of two values the later one counts."""
    *outer, last = names
    for name in outer:
        inner = nested.setdefault(name, {})
        if not isinstance(inner, dict):
            raise ConfigError(f"'{path}' is set, and so is a field that contains it.")
        nested = inner
    if isinstance(value, Mapping):
        nested.setdefault(last, {})
        for key, item in value.items():
            _put(nested, [last, key], item, f"{path}.{key}")
    elif isinstance(nested.get(last), dict):
        raise ConfigError(f"'{path}' is set, and so is a field in it.")
    else:
        nested[last] = value


def _replaced(node: DataclassInstance, values: Mapping[str, object], path: str) -> DataclassInstance:
    """Returns a node with the values of nested dicts put into its fields."""
    names = [field.name for field in dataclasses.fields(node)]
    hints = typing.get_type_hints(type(node))
    changed = {}
    for name, value in values.items():
        here = f"{path}.{name}" if path else name
        if name not in names:
            owner = f"'{path}'" if path else "The configuration"
            inner = [field for field in field_paths(node) if field.endswith(f".{name}")]
            similar = did_you_mean(name, names)
            if len(inner) == 1:  # the name is right, and the path before it is missing
                similar = f" Did you mean '{f'{path}.' if path else ''}{inner[0]}'?"
            raise ConfigError(f"There is no field '{here}'.{similar} {owner} has: {', '.join(names)}.")
        current = getattr(node, name)
        if isinstance(value, Mapping) and _is_node(current):
            changed[name] = _replaced(current, value, here)
        elif isinstance(value, Mapping) and isinstance(current, Mapping):
            changed[name] = _with_entries(current, value, typing.get_args(hints[name])[1], here)
        else:
            changed[name] = _converted(value, hints[name], current, here)
    try:
        return dataclasses.replace(node, **changed)
    except ValueError as error:  # ConfigError is one
        prefix = f"{path}." if path else ""
        raise ConfigError(f"{', '.join(prefix + name for name in changed)}: {error}") from None


def _with_entries(current: Mapping[str, Any], values: Mapping[str, object], kind: Any, path: str) -> dict[str, Any]:
    """Returns a mapping of names to nodes of one kind, with new or changed entries."""
    entries = dict(current)
    for name, fields in values.items():
        node, here = entries.get(name) or kind(), f"{path}.{name}"
        if isinstance(fields, kind):
            entries[name] = fields
        elif isinstance(fields, Mapping):
            entries[name] = _replaced(node, fields, here)
        else:
            _converted(fields, kind, node, here)  # refuses it
    return entries


def _converted(value: object, hint: object, current: object, path: str) -> object:
    """Returns a value as the declared type of its field."""
    if _is_node(current) and value is not None:
        raise ConfigError(
            f"'{path}' is a group of fields, set one of them: {', '.join(f.name for f in dataclasses.fields(current))}."
        )
    if hint is Any:
        if value is None and current is None:
            return None
        raise ConfigError(f"'{path}' has no fields here: there is nothing to configure.")
    try:
        converted = msgspec.convert(value, hint, strict=False, dec_hook=_decoded)
        for item in converted if isinstance(converted, tuple) else (converted,):
            if isinstance(item, float) and not is_number(item) and not (item == current == math.inf):
                raise TypeError(f"a finite number of at most {LARGEST:g} is allowed")
        return converted
    except (msgspec.ValidationError, TypeError) as error:
        raise ConfigError(f"'{path}' cannot be {value!r}: {error}. Its value now is {current!r}.") from None


def _decoded(hint: type, value: object) -> object:
    """Returns a value of a type that msgspec does not know."""
    if hint is Path and isinstance(value, str):
        return Path(value)
    raise NotImplementedError(f"no value of type {hint.__name__} can be set")
