"""Imports have one direction: the layers of docs/concepts.md, the rooms in each, and no circle among modules.

Every import counts, also one in a function or under `TYPE_CHECKING`.
"""

from __future__ import annotations

import ast
import functools
import graphlib
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
LAYERS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "core": (("sim.core",), ()),
    "agent": (("stubborn",), ("core",)),
    "simulator": (
        (
            "sim.gl", "sim.houses", "sim.robot", "sim.renderer", "sim.sensors", "sim.world", "sim.task",
            "sim.episodes", "sim.env", "sim.detectors",
        ),
        ("core",),
    ),
    "homes": (("sim.homes",), ("core", "simulator")),
    "training": (("sim.training",), ("core", "agent", "simulator", "homes")),
    "app": (("sim.app",), ("core", "agent", "simulator", "homes", "training")),
    "doors": (
        ("sim.gym", "sim.run", "sim.report", "sim.web", "sim.teleop", "sim.cli"),
        ("core", "agent", "simulator", "homes", "training", "app"),
    ),
    "old names": (("sim.interface", "sim.errors", "sim.configuration", "sim.housegen", "sim.bridges"), ("core",)),
}  # fmt: skip
"""Each layer: its packages, and the layers below it that it may import."""
ROOMS = (
    ("sim.core.errors", "sim.core.deprecation"),
    ("sim.core.geometry",),
    ("sim.core",),
    ("sim.gl",),
    ("sim.houses",),
    ("sim.robot",),
    ("sim.renderer",),
    ("sim.sensors",),
    ("sim.world",),
    ("sim.task",),
    ("sim.episodes",),
    ("sim.env",),
    ("sim.detectors",),
    ("sim.homes.housegen",),
    ("sim.homes.importers",),
    ("sim.homes.plans",),
    ("sim.training",),
    ("sim.app.cli",),
    ("sim.app.options",),
    ("sim.app.viewers",),
    ("sim.app.evaluation",),
    ("sim.app.analysis",),
    ("sim.app.submissions",),
    ("sim.app.services",),
    ("sim.app.bridges",),
    ("sim.app.composition",),
    ("sim.app.web",),
    ("sim.app.commands",),
)
"""The rooms of `sim`, lowest first: a module imports its own room and those before it."""
AGENT_ROOMS = (
    ("stubborn.network_files", "stubborn.kernels"),
    ("stubborn.mapping", "stubborn.segmentation"),
    ("stubborn.planning",),
    ("stubborn.exploration",),
    ("stubborn.detection",),
    ("stubborn.agent",),
    ("stubborn.drawing", "stubborn.baselines"),
    ("stubborn.agents",),
)
"""The rooms of `stubborn`, lowest first."""


def module_files() -> dict[str, Path]:
    files = {}
    for package in ("sim", "stubborn"):
        for file in sorted((ROOT / package).rglob("*.py")):
            parts = file.relative_to(ROOT).with_suffix("").parts
            files[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = file
    return files


FILES = module_files()


@functools.cache
def imported_by() -> dict[str, tuple[str, ...]]:
    """Returns the modules that each module imports."""
    return {name: tuple(imports(name)) for name in FILES}


def imports(module: str) -> Iterator[str]:
    for node in ast.walk(ast.parse(FILES[module].read_text())):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            for alias in node.names:
                full = f"{node.module}.{alias.name}"
                yield full if full in FILES else node.module


def within(module: str, package: str) -> bool:
    return module == package or module.startswith(f"{package}.")


def layer_of(module: str) -> str | None:
    """Returns the layer of a module; None for one of another project and for the packages `sim` and `stubborn`."""
    for layer, (packages, _) in LAYERS.items():
        if any(within(module, package) for package in packages):
            return layer
    return None


def rank(module: str, rooms: tuple[tuple[str, ...], ...]) -> int:
    for number, members in enumerate(rooms):
        if any(within(module, member) for member in members):
            return number
    raise AssertionError(f"'{module}' is in no room: put it into one, or add its room to this table.")


def test_every_module_is_in_a_layer() -> None:
    assert [name for name in FILES if name != "sim" and layer_of(name) is None] == []


@pytest.mark.parametrize("layer", LAYERS)
def test_a_layer_imports_itself_and_the_layers_below_it(layer: str) -> None:
    allowed = {layer, None, *LAYERS[layer][1]}
    modules = [name for name in FILES if layer_of(name) == layer]
    assert [
        f"{module} ({layer}) imports {imported} ({layer_of(imported)})."
        for module in modules
        for imported in imported_by()[module]
        if layer_of(imported) not in allowed
    ] == []


@pytest.mark.parametrize(("package", "rooms"), [("sim", ROOMS), ("stubborn", AGENT_ROOMS)])
def test_a_module_imports_its_own_room_and_those_below(package: str, rooms: tuple[tuple[str, ...], ...]) -> None:
    without = {"sim", "stubborn"} | {name for name in FILES if layer_of(name) in ("doors", "old names")}
    modules = [name for name in FILES if within(name, package) and name not in without]
    packages = {"sim.homes", "sim.app"}  # each holds only a docstring
    assert [
        f"{module} imports {imported}, which is above it."
        for module in modules
        if module not in packages
        for imported in imported_by()[module]
        if within(imported, package) and imported not in without and rank(imported, rooms) > rank(module, rooms)
    ] == []


def test_only_gl_imports_mujoco_and_no_package_imports_tools_or_tests() -> None:
    for module in FILES:
        for imported in imported_by()[module]:
            assert not within(imported, "mujoco") or module == "sim.gl", f"{module} imports {imported}."
            assert not within(imported, "tools"), f"{module} imports {imported}."
            assert not within(imported, "tests"), f"{module} imports {imported}."


def test_no_modules_import_each_other_in_a_circle() -> None:
    graph = {name: {m for m in imported_by()[name] if m in FILES and m != name} for name in FILES}
    graphlib.TopologicalSorter(graph).prepare()  # raises CycleError, which names the circle


def test_every_package_has_a_docstring_about_its_content() -> None:
    for name, file in FILES.items():
        if file.name == "__init__.py":
            assert len(ast.get_docstring(ast.parse(file.read_text())) or "") > 40, f"{name} has no docstring."
