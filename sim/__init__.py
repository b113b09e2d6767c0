"""The world: procedural apartments, a wheeled robot with contacts, cameras, the ObjectNav task and its runner.

`sim` names what users of the simulator need. A name is imported from its module when it is first used, so that
`import sim` imports neither MuJoCo nor Gymnasium nor torch. `import sim.gym` registers the Gymnasium environment.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sim.env.objectnav import ObjectNavEnv
    from sim.episodes.splits import Episode, load_split
    from sim.errors import ConfigError, ObjectNavError
    from sim.geometry.pose import Pose
    from sim.housegen.config import HouseConfig
    from sim.housegen.furniture import CATALOGUE
    from sim.housegen.furniture.catalogue import Style
    from sim.housegen.furniture.workbench import Workbench
    from sim.housegen.generator import generate
    from sim.houses.load import load_house
    from sim.houses.writing import house_text, write_house
    from sim.interface import (
        GOAL_CATEGORIES,
        MPCAT40,
        MPCAT40_ID,
        Action,
        Agent,
        AgentSpec,
        CameraModel,
        Observation,
        RobotModel,
        Scores,
        SegmentationSpec,
        Segmenter,
        SegmenterSpec,
        SuccessRule,
    )
    from sim.robot.foreign import load_robot
    from sim.sensors.noise import NoiseConfig
    from sim.sensors.sensor import Sensor, SensorContext

__all__ = [
    "CATALOGUE",
    "GOAL_CATEGORIES",
    "MPCAT40",
    "MPCAT40_ID",
    "Action",
    "Agent",
    "AgentSpec",
    "CameraModel",
    "ConfigError",
    "Episode",
    "HouseConfig",
    "NoiseConfig",
    "ObjectNavEnv",
    "ObjectNavError",
    "Observation",
    "Pose",
    "RobotModel",
    "Scores",
    "SegmentationSpec",
    "Segmenter",
    "SegmenterSpec",
    "Sensor",
    "SensorContext",
    "Style",
    "SuccessRule",
    "Workbench",
    "generate",
    "house_text",
    "load_house",
    "load_robot",
    "load_split",
    "write_house",
]

_MODULE_OF = {
    "CATALOGUE": "sim.housegen.furniture",
    "GOAL_CATEGORIES": "sim.interface",
    "MPCAT40": "sim.interface",
    "MPCAT40_ID": "sim.interface",
    "Action": "sim.interface",
    "Agent": "sim.interface",
    "AgentSpec": "sim.interface",
    "CameraModel": "sim.interface",
    "ConfigError": "sim.errors",
    "Episode": "sim.episodes.splits",
    "HouseConfig": "sim.housegen.config",
    "NoiseConfig": "sim.sensors.noise",
    "ObjectNavEnv": "sim.env.objectnav",
    "ObjectNavError": "sim.errors",
    "Observation": "sim.interface",
    "Pose": "sim.geometry.pose",
    "RobotModel": "sim.interface",
    "Scores": "sim.interface",
    "SegmentationSpec": "sim.interface",
    "Segmenter": "sim.interface",
    "SegmenterSpec": "sim.interface",
    "Sensor": "sim.sensors.sensor",
    "SensorContext": "sim.sensors.sensor",
    "Style": "sim.housegen.furniture.catalogue",
    "SuccessRule": "sim.interface",
    "Workbench": "sim.housegen.furniture.workbench",
    "generate": "sim.housegen.generator",
    "house_text": "sim.houses.writing",
    "load_house": "sim.houses.load",
    "load_robot": "sim.robot.foreign",
    "load_split": "sim.episodes.splits",
    "write_house": "sim.houses.writing",
}


if not TYPE_CHECKING:  # a type checker reports names that do not exist only without this function

    def __getattr__(name: str) -> Any:
        """Returns a name of `__all__` from its module, which is imported now."""
        if name not in _MODULE_OF:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        from importlib import import_module

        value = getattr(import_module(_MODULE_OF[name]), name)
        globals()[name] = value
        return value


def __dir__() -> list[str]:
    """Returns the names of `__all__` and what is imported already."""
    return sorted({*globals(), *__all__})
