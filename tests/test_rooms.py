"""Imports have one direction: packages of `sim` and `stubborn` in a fixed order, and no cycle among modules."""

from __future__ import annotations

import ast
import functools
import graphlib
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
ROOMS = (
    ("sim.errors",),
    ("sim.geometry",),
    ("sim.reading", "sim.interface", "sim.gl", "sim.files", "sim.paths", "sim.configuration"),
    ("sim.invocation", "sim.cli"),
    ("sim.houses",),
    ("sim.robot",),
    ("sim.sensors",),
    ("sim.world",),
    ("sim.housegen",),
    ("sim.importers",),
    ("sim.task",),
    ("sim.episodes",),
    ("sim.plans",),
    ("sim.env",),
    ("sim.detectors",),
    ("sim.datasets",),
    ("sim.bridges.ros",),
    ("sim.viewers",),
    ("sim.evaluation",),
    ("sim.analysis",),
    ("sim.submissions",),
    ("sim.bridges",),
    ("sim.composition", "sim.twin"),
    ("sim.web",),
    ("sim.gym", "sim.run", "sim.report", "sim.teleop"),
    ("sim.commands",),
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
KNOWN_TO_THE_AGENT = ("sim.interface", "sim.geometry", "sim.reading")
"""Modules of `sim` that `stubborn` may import."""
COMPOSITION_ROOTS = ("sim.composition", "sim.commands", "sim.run", "sim.teleop", "sim.twin")
"""Modules that may import both `sim` and `stubborn`."""


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


def imports(module: str, *, at_import_time: bool = False) -> Iterator[str]:
    """Returns the modules that a module imports, with those inside functions unless only import time counts."""
    tree = ast.parse(FILES[module].read_text())
    nodes = top_level(tree) if at_import_time else ast.walk(tree)
    for node in nodes:
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            for alias in node.names:
                full = f"{node.module}.{alias.name}"
                yield full if full in FILES else node.module


def pairs_of(package: str) -> Iterator[tuple[str, str]]:
    """Yields each module of a package with each module that it imports."""
    yield from ((name, imported) for name in FILES if within(name, package) for imported in imported_by()[name])


def top_level(tree: ast.Module) -> Iterator[ast.stmt]:
    for node in tree.body:
        if isinstance(node, (ast.Import, ast.ImportFrom)):
            yield node


def within(module: str, room: str) -> bool:
    return module == room or module.startswith(f"{room}.")


def rank(module: str, rooms: tuple[tuple[str, ...], ...]) -> int:
    for number, members in enumerate(rooms):
        if any(within(module, member) for member in members):
            return number
    raise AssertionError(f"'{module}' is in no room: put it into one, or add its room to this table.")


@pytest.mark.parametrize(("package", "rooms"), [("sim", ROOMS), ("stubborn", AGENT_ROOMS)])
def test_a_module_imports_its_own_room_and_those_below(package: str, rooms: tuple[tuple[str, ...], ...]) -> None:
    modules = [name for name in FILES if within(name, package) and name != package]
    above = [
        f"{module} imports {imported}, which is above it."
        for module in modules
        for imported in imported_by()[module]
        if within(imported, package) and rank(imported, rooms) > rank(module, rooms)
    ]
    assert above == []


def test_the_agent_knows_of_the_world_only_its_interface() -> None:
    for module, imported in pairs_of("stubborn"):
        assert not within(imported, "mujoco"), f"{module} imports {imported}."
        if within(imported, "sim"):
            assert any(within(imported, known) for known in KNOWN_TO_THE_AGENT), f"{module} imports {imported}."


def test_only_the_composition_roots_know_the_agent_and_only_gl_imports_mujoco() -> None:
    for module, imported in pairs_of("sim"):
        if within(imported, "stubborn"):
            assert any(within(module, root) for root in COMPOSITION_ROOTS), f"{module} imports {imported}."
        assert not within(imported, "mujoco") or module == "sim.gl", f"{module} imports {imported}."
        assert not within(imported, "tools"), f"{module} imports {imported}."
        assert not within(imported, "tests"), f"{module} imports {imported}."


def test_no_modules_import_each_other_in_a_circle() -> None:
    graph = {name: {m for m in imports(name, at_import_time=True) if m in FILES and m != name} for name in FILES}
    graphlib.TopologicalSorter(graph).prepare()  # raises CycleError, which names the cycle


def test_every_package_has_a_docstring_about_its_content() -> None:
    for name, file in FILES.items():
        if file.name == "__init__.py":
            assert len(ast.get_docstring(ast.parse(file.read_text())) or "") > 40, f"{name} has no docstring."
