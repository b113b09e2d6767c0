"""Writes a setup for another process: its values are pickled, and a user's code becomes the name that imports it.

An object of a user's code cannot always be pickled: it may hold a function or be of a class that no module has, such as
the configuration of an agent with Habitat's interface. The path of a shipped file becomes a path in the package, which
may lie in another folder on another machine.
"""

from __future__ import annotations

import io
import pickle
from collections.abc import Mapping
from pathlib import Path
from typing import Literal, NamedTuple

from sim.app.composition.agents import find_agent, find_explorer
from sim.app.composition.segmenters import SegmentationKind, find_segmentation
from sim.core.errors import ConfigError
from sim.core.interface import AgentSpec
from stubborn.exploration.explorer import ExplorerConfig

ROOT = Path(__file__).resolve().parents[3]
"""The folder of the packages `sim` and `stubborn`."""


class Reference(NamedTuple):
    """A user's object, as the option that names it, or a shipped file."""

    option: str
    """`agent`, `explorer` or `semantics`; `file` for a shipped file."""
    name: str
    """The value of the option, or the path of the file below `ROOT`."""
    part: Literal["object", "class"] = "object"
    """The object itself, or the class of its configuration."""


def packed(fields: Mapping[str, object], references: Mapping[int, Reference]) -> bytes:
    """Returns fields as bytes; an object whose `id` has a reference is written as that reference.

    Raises:
        ConfigError: a value cannot be pickled.
    """
    stream = io.BytesIO()
    try:
        _Writer(stream, references).dump(fields)
    except (pickle.PicklingError, AttributeError, TypeError) as error:
        raise ConfigError(
            f"The configuration cannot be sent to another process ({error}); define its classes and functions at the "
            "top level of a module."
        ) from None
    return stream.getvalue()


class _Writer(pickle.Pickler):
    def __init__(self, stream: io.BytesIO, references: Mapping[int, Reference]) -> None:
        super().__init__(stream)
        self._references = references

    def persistent_id(self, obj: object) -> Reference | None:
        """Returns the reference of an object; None: it is written by value."""
        if isinstance(obj, Path) and any(obj.is_relative_to(ROOT / package) for package in ("sim", "stubborn")):
            return Reference("file", str(obj.relative_to(ROOT)))
        return self._references.get(id(obj))


class Unpacker(pickle.Unpickler):
    """Reads the fields that `packed` wrote, and imports the user's code in this process; `load` returns a dictionary.

    Raises:
        ConfigError: a user's code cannot be imported here.
    """

    def __init__(self, content: bytes) -> None:
        super().__init__(io.BytesIO(content))
        self._imported: dict[tuple[str, str], AgentSpec | ExplorerConfig | SegmentationKind] = {}

    def persistent_load(self, pid: Reference) -> object:
        """Returns the object of a reference."""
        if pid.option == "file":
            return ROOT / pid.name
        key = pid.option, pid.name
        if key not in self._imported:
            self._imported[key] = _imported(*key)
        imported = self._imported[key]
        if pid.part == "object":
            return imported
        return type(imported.config if isinstance(imported, (AgentSpec, SegmentationKind)) else imported)


def _imported(option: str, name: str) -> AgentSpec | ExplorerConfig | SegmentationKind:
    """Returns the object that a user names, after the import of its module."""
    if option == "semantics":
        return find_segmentation(name, None)
    return find_agent(name) if option == "agent" else find_explorer(name)
