"""`sim` and `stubborn` export the names that users need and import them at the first use."""

from __future__ import annotations

import ast
import importlib
import inspect
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

import sim
import stubborn

PACKAGES = (sim, stubborn)
NAMES = [(package, name) for package in PACKAGES for name in package.__all__]


def modules_of(package: ModuleType) -> dict[str, str]:
    """Returns the module of each name in the stub of a package."""
    stub = ast.parse(Path(str(package.__file__)).with_suffix(".pyi").read_text())
    return {
        alias.name: f"{package.__name__}.{node.module}"
        for node in stub.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }


@pytest.mark.parametrize(("package", "name"), NAMES, ids=lambda value: getattr(value, "__name__", value))
def test_a_public_name_is_the_object_of_its_module(package: ModuleType, name: str) -> None:
    module = importlib.import_module(modules_of(package)[name])
    assert name in dir(package)
    assert getattr(package, name) is getattr(module, name)
    value = getattr(module, name)
    if inspect.isclass(value) or inspect.isfunction(value):
        assert value.__module__ == module.__name__, f"{name} is defined in {value.__module__}."


@pytest.mark.parametrize("package", PACKAGES, ids=lambda package: package.__name__)
def test_a_name_that_does_not_exist_raises_the_usual_error(package: ModuleType) -> None:
    with pytest.raises(AttributeError, match="Sofa"):
        package.Sofa  # noqa: B018 - the access raises


OLD_NAMES = (
    ("sim.interface", "Action"), ("sim.errors", "HouseError"), ("sim.configuration", "with_fields"),
    ("sim.housegen", "generate"), ("stubborn", "LabelledView"), ("stubborn", "ViewDataset"),
)  # fmt: skip


@pytest.mark.parametrize(("module", "name"), OLD_NAMES)
def test_an_old_name_works_and_says_where_the_new_one_is(module: str, name: str) -> None:
    with pytest.warns(DeprecationWarning, match=r"is now '.*'; the old name is removed in 0\.4\.0") as warned:
        value = getattr(importlib.import_module(module), name)
    assert value.__name__ == name
    assert warned[0].filename == __file__


def test_packages_import_nothing_large_and_the_contract_needs_no_simulator() -> None:
    contract = (
        "Action, AgentSpec, CameraModel, GOAL_CATEGORIES, MPCAT40_ID, Observation, RobotModel, Scores, SegmenterSpec"
    )
    steps = (
        "import sim", "import stubborn", f"from sim import {contract}",
        "import gymnasium, sim.gym, sim.core.geometry.grid as g; gymnasium.spec(sim.gym.ENV_ID); g.GridFrame",
    )  # fmt: skip
    large = ("gymnasium", "mujoco", "numba", "numpy", "torch")
    shown = f"print(*(name for name in {large} if name in sys.modules))"
    code = "import sys\n" + "".join(f"{step}\n{shown}\n" for step in steps)
    printed = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert printed.splitlines()[:3] == ["", "", "numpy"]
    assert "gymnasium" in printed.splitlines()[3]


def test_an_old_module_has_no_other_names() -> None:
    assert not hasattr(importlib.import_module("sim.errors"), "SofaError")
