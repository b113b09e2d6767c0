"""Makes `import habitat_sim`, `import magnum` and `import corrade` work, for habitat-lab and agents that import them.

`MODULES` holds the names that do something here. habitat-lab also imports, for the annotations of parts that
ObjectNav does not use, names of classes that move objects, draw debug lines or read files of other formats: each of
these is a placeholder: a class that can be named and derived from, and whose objects raise an error when they are used.
"""

from __future__ import annotations

import contextlib
import importlib
import importlib.util
import sys
from collections.abc import Mapping
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder
from types import MappingProxyType, ModuleType
from typing import Any

VERSION = "0.3.3"
"""The version of habitat-sim whose interface this is."""
_HERE = "sim.app.bridges.habitat_sim"
MODULES: Mapping[str, Mapping[str, str]] = MappingProxyType(
    {
        "habitat_sim": {
            "simulator": "Simulator",
            "agent": "Agent AgentState SixDOFPose",
            "settings": "ActionSpec ActuationSpec AgentConfiguration CameraSensorSpec Configuration "
            "EquirectangularSensorSpec FisheyeSensorDoubleSphereSpec FisheyeSensorModelType NavMeshSettings "
            "SensorSpec SensorSubType SensorType SimulatorConfiguration",
            "pathfinder": "GreedyFollowerError GreedyGeodesicFollower HitRecord MultiGoalShortestPath PathFinder "
            "ShortestPath",
            "motion": "RigidState",
        },
        "habitat_sim.agent": {
            "agent": "Agent AgentState SixDOFPose",
            "settings": "ActionSpec ActuationSpec AgentConfiguration",
        },
        "habitat_sim.agent.agent": {"agent": "Agent AgentState SixDOFPose", "settings": "AgentConfiguration"},
        "habitat_sim.errors": {"pathfinder": "GreedyFollowerError"},
        "habitat_sim.nav": {
            "pathfinder": "GreedyGeodesicFollower HitRecord MultiGoalShortestPath PathFinder ShortestPath",
            "settings": "NavMeshSettings",
        },
        "habitat_sim.physics": {"motion": "RigidState VelocityControl"},
        "habitat_sim.sensor": {
            "settings": "CameraSensorSpec FisheyeSensorModelType SensorSpec SensorSubType SensorType",
        },
        "habitat_sim.simulator": {
            "simulator": "Simulator",
            "agent": "Agent AgentState",
            "settings": "Configuration SimulatorConfiguration",
        },
        "habitat_sim.utils": {},
        "habitat_sim.utils.common": {
            "maths": "angle_between_quats quat_from_angle_axis quat_from_coeffs quat_from_magnum "
            "quat_from_two_vectors quat_rotate_vector quat_to_angle_axis quat_to_coeffs quat_to_magnum "
            "d3_40_colors_rgb",
        },
        "habitat_sim.geo": {"maths": "BACK FRONT GRAVITY LEFT RIGHT UP", "semantics": "OBB"},
        "habitat_sim.scene": {"semantics": "SemanticLevel SemanticObject SemanticRegion SemanticScene"},
        "magnum": {"maths": "Deg Quaternion Rad Vector3"},
    }
)
"""For each module, our module and the names that come from it."""
PACKAGES = ("habitat_sim", "magnum", "corrade")


class NotHere(type):
    """The class of placeholders; their attributes are placeholders too.

    They can be named, derived from and instantiated, as modules do when they are imported.
    """

    def __getattr__(cls, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return _not_here(f"{cls.__qualname__}.{name}")

    def __or__(cls, other: Any) -> Any:
        return Any

    __ror__ = __or__


class _Unusable:
    """The base of placeholders: an object that raises NotImplementedError when it is used."""

    _stands_for = ""

    def __init__(self, *_: object, **__: object) -> None:
        pass

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        raise NotImplementedError(
            f"'{self._stands_for}' is not part of the habitat_sim that runs on MuJoCo (docs/habitat.md)."
        )


def is_placeholder(module: object) -> bool:
    """Returns whether a module is a placeholder."""
    return isinstance(module, _Module) and module.__name__ not in MODULES


def _not_here(name: str) -> Any:
    return NotHere(name.rpartition(".")[2], (_Unusable,), {"__qualname__": name, "_stands_for": name})


class Finder(MetaPathFinder, Loader):
    """The entry of `sys.meta_path`."""

    def find_spec(self, fullname: str, path: Any = None, target: Any = None) -> ModuleSpec | None:
        """Returns the specification of a module of the three packages, and of habitat-lab, which is then registered
        with; None for any other."""
        if fullname == "habitat":
            spec = PathFinder.find_spec(fullname, path)
            if spec is not None and spec.loader is not None and spec.origin is not None:
                spec.loader = _Registering(spec.loader)
            return spec
        if fullname == "torchvision":
            _declare_operators()
        parent, _, name = fullname.rpartition(".")
        is_name = any(name in names.split() for names in MODULES.get(parent, {}).values())
        if fullname.partition(".")[0] not in PACKAGES or is_name:
            return None
        return ModuleSpec(fullname, self, is_package=True)

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        """Returns the module, still empty."""
        module = _Module(spec.name)
        if spec.name in PACKAGES:
            vars(module)["__version__"] = VERSION
        return module

    def exec_module(self, module: ModuleType) -> None:
        """Fills it with the names of `MODULES`."""
        for source, names in MODULES.get(module.__name__, {}).items():
            ours = importlib.import_module(f"{_HERE}.{source}")
            vars(module).update({name: getattr(ours, name) for name in names.split()})
        if module.__name__ == "habitat_sim":
            vars(module).update(cuda_enabled=False, built_with_bullet=False, stage_id=0, audio_enabled=False)


def _declare_operators() -> None:
    """Declares two operators that the wheel of torchvision on PyPI has only beside a torch with CUDA.

    habitat-baselines imports torchvision and does not use them; without them that import fails.
    """
    import torch

    if torch.version.cuda is None:
        for name in ("nms", "qnms"):
            with contextlib.suppress(RuntimeError):  # it is declared
                torch.library.define(
                    f"torchvision::{name}", "(Tensor dets, Tensor scores, float iou_threshold) -> Tensor"
                )


class _Registering(Loader):
    """Loads habitat-lab, and registers data sets and measures with it."""

    def __init__(self, loader: Loader) -> None:
        self._loader = loader

    def create_module(self, spec: ModuleSpec) -> ModuleType | None:
        """Returns the module, still empty."""
        return self._loader.create_module(spec)

    def exec_module(self, module: ModuleType) -> None:
        """Fills it."""
        self._loader.exec_module(module)
        if f"{_HERE}.lab" not in sys.modules:  # else it imports habitat-lab just now
            importlib.import_module(f"{_HERE}.lab")

    def __getattr__(self, name: str) -> Any:
        return getattr(self._loader, name)  # such as the source, which tracebacks show


class _Module(ModuleType):
    """A module whose other names are modules of `MODULES` or placeholders."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        full = f"{self.__name__}.{name}"
        return importlib.import_module(full) if full in MODULES else _not_here(full)


_FINDER = Finder()


def install() -> None:
    """Provides the three packages in this process, in place of those that may be installed; a second call is harmless.

    Raises:
        ImportError: another `habitat_sim` was imported before.
    """
    if _FINDER in sys.meta_path:
        return
    if "habitat_sim" in sys.modules:
        raise ImportError("habitat_sim was imported before: `import stubborn_habitat` must come first.")
    sys.meta_path.insert(0, _FINDER)
