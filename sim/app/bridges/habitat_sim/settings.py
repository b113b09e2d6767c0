"""Records that describe a simulator: the fields of habitat-lab's configuration with Habitat's defaults.

habitat-lab copies its configuration into these records field by field, and refuses a field that a record lacks. Those
without effect here are present all the same: this module is a list of names, most of which describe a renderer.
"""

from __future__ import annotations

import enum
from dataclasses import dataclass, field
from typing import Any

import numpy as np


class SensorType(enum.IntEnum):
    """What a camera sees."""

    NONE = 0
    COLOR = 1
    DEPTH = 2
    NORMAL = 3
    SEMANTIC = 4


class SensorSubType(enum.IntEnum):
    """How a camera projects; only PINHOLE exists here."""

    NONE = 0
    PINHOLE = 1
    ORTHOGRAPHIC = 2
    EQUIRECTANGULAR = 3
    FISHEYE = 4


class FisheyeSensorModelType(enum.IntEnum):
    """Exists for configurations that name it."""

    DOUBLE_SPHERE = 0


@dataclass
class SensorSpec:
    """A camera of the robot."""

    uuid: str = ""
    sensor_type: SensorType = SensorType.COLOR
    sensor_subtype: SensorSubType = SensorSubType.PINHOLE
    resolution: Any = field(default_factory=lambda: [128, 128])
    """Height and width in pixels."""
    position: Any = field(default_factory=lambda: np.array([0.0, 1.5, 0.0], np.float32))
    """Right of, above and behind the middle of the robot on the floor, metres."""
    orientation: Any = field(default_factory=lambda: np.zeros(3, np.float32))
    """Rotation about the agent's x axis (up), then its y axis (left) and its z axis, radians."""
    hfov: Any = 90.0
    """Horizontal field of view, degrees."""
    noise_model: str = "None"
    """Only "None": noise of all sensors is an option of `stubborn_habitat.configure`."""
    noise_model_kwargs: Any = field(default_factory=dict)
    near: float = 0.01
    far: float = 1000.0
    ortho_scale: float = 0.1
    channels: int = 4
    gpu2gpu_transfer: bool = False
    clear_color: Any = None
    sensor_model_type: FisheyeSensorModelType = FisheyeSensorModelType.DOUBLE_SPHERE


CameraSensorSpec = SensorSpec


class EquirectangularSensorSpec(SensorSpec):
    """Is refused when a simulator is made: cameras here are pinhole cameras."""


@dataclass
class FisheyeSensorDoubleSphereSpec(SensorSpec):
    """Is refused when a simulator is made: cameras here are pinhole cameras."""

    xi: float = 0.0
    alpha: float = 0.0
    focal_length: Any = None
    principal_point_offset: Any = None


@dataclass
class ActuationSpec:
    """How far an action moves: metres or degrees."""

    amount: float = 0.25
    constraint: float | None = None


@dataclass
class ActionSpec:
    """An action of the agent: `stop`, `move_forward`, `turn_left`, `turn_right`, `look_up` or `look_down`."""

    name: str
    actuation: ActuationSpec | None = None


def _default_actions() -> dict[Any, ActionSpec]:
    return {
        "move_forward": ActionSpec("move_forward", ActuationSpec(0.25)),
        "turn_left": ActionSpec("turn_left", ActuationSpec(10.0)),
        "turn_right": ActionSpec("turn_right", ActuationSpec(10.0)),
    }


@dataclass
class AgentConfiguration:
    """The agent. Its size is that of this project's robot, whatever `height` and `radius` say."""

    height: float = 1.5
    radius: float = 0.1
    mass: float = 32.0
    sensor_specifications: list[SensorSpec] = field(default_factory=lambda: [SensorSpec()])
    action_space: dict[Any, ActionSpec] = field(default_factory=_default_actions)
    body_type: str = "cylinder"
    linear_acceleration: float = 20.0
    angular_acceleration: float = 4 * 3.14
    linear_friction: float = 0.5
    angular_friction: float = 1.0
    coefficient_of_restitution: float = 0.0


@dataclass
class NavMeshSettings:
    """The navigation mesh of Habitat. The free space here is that of the robot, whatever these say."""

    cell_size: float = 0.05
    cell_height: float = 0.2
    agent_height: float = 1.5
    agent_radius: float = 0.1
    agent_max_climb: float = 0.2
    agent_max_slope: float = 45.0
    include_static_objects: bool = False
    filter_low_hanging_obstacles: bool = True
    filter_ledge_spans: bool = True
    filter_walkable_low_height_spans: bool = True

    def set_defaults(self) -> None:
        """Restores the defaults."""
        self.__init__()


@dataclass
class SimulatorConfiguration:
    """The simulator."""

    scene_id: str = "NONE"
    """A house: an MJCF file, or `split/house.xml` at the end of a path."""
    scene_dataset_config_file: str = "default"
    random_seed: int = 0
    default_agent_id: int = 0
    allow_sliding: bool = True
    """Whether `step_filter` slides along obstacles; actions do what `stubborn_habitat.configure(motion=...)` says."""
    create_renderer: bool = True
    enable_physics: bool = False
    enable_gfx_replay_save: bool = False
    enable_hbao: bool = False
    frustum_culling: bool = True
    gpu_device_id: int = 0
    leave_context_with_background_renderer: bool = False
    load_semantic_mesh: bool = True
    navmesh_settings: NavMeshSettings | None = None
    override_scene_light_defaults: bool = False
    physics_config_file: str = ""
    requires_textures: bool = True
    scene_light_setup: str = ""


class Configuration:
    """A simulator and its agents."""

    def __init__(
        self, sim_cfg: SimulatorConfiguration, agents: list[AgentConfiguration], *_: object, **__: object
    ) -> None:
        self.sim_cfg, self.agents = sim_cfg, agents
        self.metadata_mediator = None
        self.enable_batch_renderer = False
