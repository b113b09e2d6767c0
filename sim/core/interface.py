"""The contract between world and agent: actions, observations, categories, camera and robot geometry.

NumPy only: `stubborn` imports this module, so it must not depend on physics, rendering or files.

Frames: the world is z up. The start frame of an episode has its origin at the start pose, x forward and y
to the left; yaw is counter-clockwise, in radians. Images have row 0 at the top.
"""

from __future__ import annotations

import enum
import inspect
import math
import operator
import re
import reprlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, is_dataclass
from types import MappingProxyType
from typing import Any, NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from sim.core.errors import ConfigError
from sim.core.geometry.numbers import require_numbers
from sim.core.geometry.pose import wrap_angle

__all__ = [
    "CLIMB_M", "CONTEXT_FIELDS", "FORWARD_M", "GOAL_CATEGORIES", "MAX_STEPS", "MPCAT40", "MPCAT40_ID", "POSE_SENSORS",
    "SENSORS", "TURN_RAD", "Action", "Agent", "AgentFactory", "AgentSpec", "CameraModel", "ConfigError", "GuessesNames",
    "KeepsMemory", "Observation", "Perceived", "RobotModel", "Scores", "SeesObjects", "SegmentationSpec", "Segmenter",
    "SegmenterFactory", "SegmenterSpec", "StatesConfidence", "StatesModelUse", "StatesSegmentation", "StatesTarget",
    "SuccessRule", "TakesWords", "category_id", "scores_of", "wrap_angle",
]  # fmt: skip


class Action(enum.IntEnum):
    """The discrete actions of Habitat; `MOVES` are those of the ObjectNav challenge 2021, others an agent declares."""

    STOP = 0
    MOVE_FORWARD = 1
    TURN_LEFT = 2
    TURN_RIGHT = 3
    LOOK_UP = 4
    LOOK_DOWN = 5


def as_action(value: object) -> Action | None:
    """Returns the action of an integer of any library, such as a tensor of PyTorch; None: it is no action."""
    if isinstance(value, bool):
        return None
    try:
        return Action(operator.index(value))  # type: ignore[arg-type]
    except (TypeError, ValueError, RuntimeError):
        return None


def require_action(value: object, allowed: Sequence[Action], remedy: str = "") -> Action:
    """Returns the action of an integer; raises ConfigError, which ends with the remedy, if it is not allowed."""
    action = as_action(value)
    if action is None or action not in allowed:
        names = ", ".join(f"{int(known)} {known.name}" for known in allowed)
        raise ConfigError(f"An action is one of {names}; got {reprlib.repr(value)}.{remedy}")
    return action


MOVES: tuple[Action, ...] = (Action.STOP, Action.MOVE_FORWARD, Action.TURN_LEFT, Action.TURN_RIGHT)
"""The actions that every agent has."""
LOOK_RAD = math.radians(30.0)
"""Angle by which LOOK_UP and LOOK_DOWN tilt the camera (`AgentSpec.looks`)."""
MAX_TILT_RAD = math.radians(60.0)
"""Largest tilt of the camera, up and down."""

FORWARD_M = 0.25
"""Commanded displacement of MOVE_FORWARD."""
TURN_RAD = math.radians(30.0)
"""Commanded rotation of TURN_LEFT (positive) and TURN_RIGHT (negative)."""
CLIMB_M = 0.012
"""Height of an edge that the default robot climbs, as a Kobuki does."""
MAX_SIDE_PX = 4096
"""Largest width and height of an image."""
MAX_STEPS = 500
"""Actions after which an episode is truncated."""

# fmt: off
MPCAT40: tuple[str, ...] = (
    "void", "wall", "floor", "chair", "door", "table", "picture", "cabinet", "cushion", "window", "sofa",
    "bed", "curtain", "chest_of_drawers", "plant", "sink", "stairs", "ceiling", "toilet", "stool", "towel",
    "mirror", "tv_monitor", "shower", "column", "bathtub", "counter", "fireplace", "lighting", "beam", "railing",
    "shelving", "blinds", "gym_equipment", "seating", "board_panel", "furniture", "appliances", "clothes", "objects",
    "misc",
)
"""Matterport's 40 categories with void first: `MPCAT40[id]` is the name behind a pixel of `semantic`."""

GOAL_CATEGORIES: tuple[str, ...] = (
    "chair", "table", "picture", "cabinet", "cushion", "sofa", "bed", "chest_of_drawers", "plant", "sink", "toilet",
    "stool", "towel", "tv_monitor", "shower", "bathtub", "counter", "fireplace", "gym_equipment", "seating", "clothes",
)
"""The 21 categories that an episode may ask for; `objectgoal` is an index into this tuple."""
# fmt: on

MPCAT40_ID: Mapping[str, int] = MappingProxyType({name: i for i, name in enumerate(MPCAT40)})
"""mpcat40 id of each category name."""


def category_id(name: str) -> int:
    """Returns the mpcat40 id of a category.

    Raises:
        ConfigError: mpcat40 has no such category, or it is void.
    """
    if name not in MPCAT40[1:]:
        raise ConfigError(
            f"mpcat40 has no category {name!r}. Available: {', '.join(MPCAT40[1:])}. "
            "For goals in words, see docs/words.md#agents."
        )
    return MPCAT40_ID[name]


@dataclass(frozen=True, kw_only=True)
class CameraModel:
    """A pinhole camera with square pixels, level, on the robot's axis."""

    width_px: int = 640
    height_px: int = 480
    hfov_rad: float = math.radians(79.0)
    """Horizontal field of view."""
    height_m: float = 0.88
    """Optical centre above the floor."""
    min_depth_m: float = 0.5
    """Nearer surfaces read 0."""
    max_depth_m: float = 5.0
    """Farther surfaces read this value."""

    def __post_init__(self) -> None:
        require_numbers(self)
        if min(self.width_px, self.height_px) < 1 or max(self.width_px, self.height_px) > MAX_SIDE_PX:
            raise ConfigError(
                f"CameraModel needs 1 to {MAX_SIDE_PX} pixels on each side, got {self.width_px} x {self.height_px}."
            )
        if self.height_m <= 0.0:
            raise ConfigError(f"CameraModel.height_m must be positive, got {self.height_m}.")
        if not 0.0 < self.hfov_rad < math.pi:
            raise ConfigError(f"CameraModel.hfov_rad must lie in (0, pi), got {self.hfov_rad}.")
        if not 0.0 <= self.min_depth_m < self.max_depth_m:
            raise ConfigError(
                f"CameraModel needs 0 <= min_depth_m < max_depth_m, got {self.min_depth_m} and {self.max_depth_m}."
            )

    @property
    def focal_px(self) -> float:
        """Focal length in pixels, the same in both directions."""
        return 0.5 * self.width_px / math.tan(0.5 * self.hfov_rad)

    @property
    def vfov_rad(self) -> float:
        """Vertical field of view."""
        return 2.0 * math.atan(0.5 * self.height_px / self.focal_px)


@dataclass(frozen=True, kw_only=True)
class RobotModel:
    """The properties of the robot that an agent may know."""

    radius_m: float = 0.18
    height_m: float = 0.88
    camera_forward_m: float = 0.0
    """Camera mount ahead of the wheel axis; 0 for the default robot: its camera turns on the spot."""
    clearance_m: float = 0.0128
    """Height of the body's lower side above the floor."""
    climb_m: float = CLIMB_M
    """Height of the highest edge that the wheels climb; any object that is higher is an obstacle."""

    def __post_init__(self) -> None:
        require_numbers(self)
        if self.radius_m <= 0 or self.height_m <= 0:
            raise ConfigError(f"RobotModel needs positive sizes, got {self.radius_m} m and {self.height_m} m.")
        if not 0.0 <= self.climb_m < self.height_m:
            raise ConfigError(f"RobotModel.climb_m must lie in [0, height_m = {self.height_m}), got {self.climb_m} m.")


@dataclass(frozen=True, kw_only=True)
class SuccessRule:
    """The conditions under which a STOP succeeds: a visible point of an instance is near enough, on the same storey."""

    distance_m: float = 1.0
    """Largest distance in plan from the robot's centre to a visible point of the instance's footprint."""
    sight_height_m: float | None = None
    """Height above the floor of the line of sight; None takes the camera's height."""
    same_storey_m: float = 1.0
    """Floors less than this apart are one storey."""

    def __post_init__(self) -> None:
        require_numbers(self)
        if self.distance_m <= 0 or self.same_storey_m <= 0:
            raise ConfigError(
                f"SuccessRule needs distance_m > 0 and same_storey_m > 0, got {self.distance_m} and "
                f"{self.same_storey_m} m."
            )
        if self.sight_height_m is not None and self.sight_height_m <= 0:
            raise ConfigError(f"SuccessRule.sight_height_m must be > 0 m or None, got {self.sight_height_m}.")

    def sight_height_with(self, camera: CameraModel) -> float:
        """Returns the height of the line of sight above the floor, metres, for a robot with this camera."""
        return camera.height_m if self.sight_height_m is None else self.sight_height_m


Observation = Mapping[str, NDArray]
"""The observation of one step: `POSE_SENSORS`, and what was requested of `SENSORS`, `ROBOT_SENSORS`, `GOAL_SENSORS` and
`SEMANTIC_MAP`.

| key | shape | dtype | meaning |
|---|---|---|---|
| rgb | (h, w, 3) | uint8 | colour |
| depth | (h, w) | float32 | metres along the optical axis; 0: none or < 0.5 m; 5.0: 5 m or farther |
| semantic | (h, w) | uint8 | mpcat40 id |
| gps | (2,) | float32 | metres forward and left of the start pose |
| compass | (1,) | float32 | yaw against the start heading, in (-pi, pi] |
| objectgoal | (1,) | int64 | index into `GOAL_CATEGORIES`; -1: it is in words or a picture |
| scan | (rays,) | float32 | lidar, metres; 0: nearer than its range, the maximum range: no return in it |
| bumper | (6,) | int8 | 1: contact in the last action; sector 0 is ahead, the others follow counter-clockwise |
| odometry | (3,) | float32 | pose by wheels and gyro: metres forward and left of the start, yaw in (-pi, pi] |
| imu | (6,) | float32 | accelerations, m/s2, and turn rates, rad/s, in the robot's frame |
| tilt | (1,) | float32 | tilt of the camera, radians, positive: up |
| semantic_map | (cells, cells) | uint8 | true mpcat40 ids around the robot, seen from above; 0: nothing |
| goal | str | | the goal as text (`sim.core.goals.GoalSpec.told`); "": it is a picture |
| goal_picture | (512, 512, 3) | uint8 | the picture of a goal of the kind `picture`, else 0 |
"""

SENSORS: tuple[str, ...] = ("rgb", "depth", "semantic")
"""Image sensors, which are rendered only when requested."""
SEMANTIC_MAP = "semantic_map"
"""The map of categories around the robot (`sim.sensors.semantic_map`), ground truth."""
SCAN = "scan"
"""The lidar (`sim.sensors.scan`)."""
ROBOT_SENSORS: tuple[str, ...] = (SCAN, "bumper", "odometry", "imu", "tilt")
"""The lidar and the sensors of the robot itself (`sim.sensors.measured`), in the observation only when requested."""
GOAL_SENSORS: tuple[str, ...] = ("goal", "goal_picture")
"""The goal of the episode, only when requested."""
POSE_SENSORS: tuple[str, ...] = ("gps", "compass", "objectgoal")
"""Always present."""
CONTEXT_FIELDS: tuple[str, ...] = (
    "goal", "picture", "collided", "odometry", "pose", "start", "motion", "model", "data", "glass", "labels", "tilt",
)  # fmt: skip
"""Fields of `sim.sensors.sensor.SensorContext` that a user's sensor may declare in `reads`."""
TRUE_FIELDS = frozenset({"pose", "start", "motion", "model", "data", "glass", "labels"})
"""The fields that hold ground truth, which a robot cannot measure."""
TRUE_IMAGES = frozenset({"semantic", "geom"})
"""Rendered images that hold ground truth."""


def reads_truth(sensor: Any) -> bool:
    """Returns whether a sensor declares that it reads ground truth.

    Args:
        sensor: name of a standard sensor, or an object with the interface `sim.sensors.sensor.Sensor`. `gps`, `compass`
            and `objectgoal` are part of the task, and those of `ROBOT_SENSORS` are measurements: they do not count,
            although they are computed from the true state.
    """
    if isinstance(sensor, str):
        return sensor in ("semantic", SEMANTIC_MAP) or sensor.endswith("_semantic")
    is_standard = type(sensor).__module__.startswith("sim.sensors.")  # a user's sensor may have the same name
    if is_standard and getattr(sensor, "name", "") in (*POSE_SENSORS, *ROBOT_SENSORS, *GOAL_SENSORS):
        return False
    images = {name.rpartition(":")[2] for name in getattr(sensor, "images", ())}  # `left:semantic` of a camera `left`
    declared = {*images, *getattr(sensor, "reads", ())}
    return not declared.isdisjoint(TRUE_IMAGES | TRUE_FIELDS)


def _require_tuples(spec: object, *names: str) -> None:
    """Raises ConfigError if a field is one name in place of a tuple of names."""
    for name in names:
        if isinstance(value := getattr(spec, name), str):
            raise ConfigError(f"{type(spec).__name__}.{name} must be a tuple of names, got '{value}'.")


class Scores(NamedTuple):
    """Per-pixel class probabilities, reduced to those that the target maps need; float32 (h, w) in [0, 1].

    The resolution may be any whole fraction of the image's.
    """

    target: NDArray[np.float32]
    """Probability of the goal category."""
    best_other: NDArray[np.float32]
    """Highest probability of any other category."""


def scores_of(posteriors: NDArray[np.float32], goal: str) -> Scores:
    """Returns the scores of a goal category, (h, w) each, from posteriors (40, h, w).

    Raises:
        ConfigError: the goal is not a category of mpcat40.
    """
    channel = category_id(goal) - 1
    before, after = posteriors[:channel], posteriors[channel + 1 :]
    return Scores(
        posteriors[channel].copy(), np.maximum(before.max(axis=0, initial=0.0), after.max(axis=0, initial=0.0))
    )


@dataclass(frozen=True, kw_only=True)
class SegmenterSpec:
    """The declaration of a segmenter: its inputs and how exact it is."""

    sensors: tuple[Any, ...] = ("rgb",)
    """Sensors that it reads in the observation, in addition to `depth`: names of `SENSORS`, or a user's objects
    (`sim.sensors.sensor.Sensor`)."""
    truth: tuple[str, ...] = ()
    """Ground-truth images that it reads in the environment and that the agent does not get (`semantic`, `geom`)."""
    exact_outlines: bool = False
    """True: the outlines of its scores are exact to the pixel. With inexact outlines an agent must not trust the
    rim of a target."""
    needs_verification: bool = True
    """False: its scores are the truth, so that an agent need not verify a candidate before it stops."""
    kind: str = "rednet"
    """Name of the fitted parameters that describe its errors best (`stubborn/detection/verifiers/<kind>.json`). A kind
    without parameters of its own gets those of `rednet`, and the run prints a note."""

    def __post_init__(self) -> None:
        if not re.fullmatch(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,99}", self.kind):
            raise ConfigError(f"SegmenterSpec.kind must consist of A-Z, a-z, 0-9, '_', '-' and '.', got '{self.kind}'.")
        _require_tuples(self, "sensors", "truth")
        unknown = sorted(set(self.truth) - TRUE_IMAGES)
        if unknown:
            raise ConfigError(f"SegmenterSpec.truth names '{unknown[0]}'. Available: {', '.join(sorted(TRUE_IMAGES))}.")

    @property
    def uses_ground_truth(self) -> bool:
        """True: it reads true images, or a sensor that declares ground truth."""
        return bool(self.truth) or any(reads_truth(sensor) for sensor in self.sensors)


class Segmenter(Protocol):
    """A source of segmentation: ground truth, a simulated detector, a network."""

    @property
    def spec(self) -> SegmenterSpec:
        """Returns its declaration."""
        ...

    def scores(self, observation: Observation, goal: str) -> Scores:
        """Returns the scores of one frame for the goal category."""
        ...

    def posteriors(self, observation: Observation) -> NDArray[np.float32]:
        """Returns the probability of each category of `MPCAT40` except void, float32 (40, h, w), in their order.

        The resolution may be any whole fraction of the image's. All probabilities of a pixel may be 0 if the frame has
        no information on it. Agents that track objects of all categories (`stubborn-plus`), explorers that map them
        (`poni`, `semexp`, `informed-tour`) and `cloned` read it; others do not.
        """
        ...


@runtime_checkable
class NamesCategories(Protocol):
    """A segmenter that also returns the category of each pixel; viewers show it."""

    def categories(self, observation: Observation) -> NDArray[np.uint8]:
        """Returns the most probable mpcat40 id of each pixel, at any whole fraction of the image's resolution.

        Called after `scores` of the same frame.
        """
        ...


@runtime_checkable
class SegmentsPictures(Protocol):
    """A segmenter that knows what the picture of a goal shows; others get the picture as if the robot saw it."""

    def picture_categories(self) -> NDArray[np.uint8] | None:
        """Returns the mpcat40 id of each pixel of the present goal's picture, (h, w); None: unknown."""
        ...


@runtime_checkable
class SeesObjects(Protocol):
    """A segmenter that tells objects apart and knows their everyday names; agents ask it where goals are in words."""

    def objects(self, observation: Observation) -> tuple[NDArray[np.int32], Sequence[str]] | None:
        """Returns the number of the object at each pixel (h, w), -1: none, and the name of each object.

        None: it does not tell them apart after all.
        """
        ...


@runtime_checkable
class GuessesNames(Protocol):
    """A segmenter that says how probable each everyday name is; agents ask it where goals are in words."""

    def named(self, observation: Observation) -> tuple[NDArray[np.float32], Sequence[str]] | None:
        """Returns the probability that a pixel shows an object of each name, (names, h, w), and the names.

        The resolution is a whole fraction of that of the posteriors. Other objects may have names that are not among
        these. None: it does not know names after all.
        """
        ...


@runtime_checkable
class TakesWords(Protocol):
    """A segmenter with an open vocabulary: it looks for what it is asked for."""

    def ask(self, word: str, names: frozenset[str]) -> None:
        """Called at the start of an episode, before its first frame.

        Args:
            word: the word for the goal, such as "rocking chair"; "": the goal is a category.
            names: the everyday names that it means; with `objects`, detections are given such a name.
        """
        ...


SegmenterFactory = Callable[..., Any]
"""Builds a user's segmenter from keyword arguments:

| argument | type | meaning |
|---|---|---|
| camera | `CameraModel` | camera of the images |
| config | type of `SegmentationSpec.config` | the segmentation's configuration |
| truth | `sim.env.objectnav.ObjectNavEnv` | only if the specification's `truth` names images: the environment |

Arguments for which the factory has no parameter are left out. The object needs a method `scores` or `posteriors`. Some
agents also read `posteriors`, and videos show `categories` (`NamesCategories`).
"""


@dataclass(frozen=True, kw_only=True)
class SegmentationSpec:
    """The declaration of a user's segmentation, for `--semantics package.module:NAME`."""

    make: SegmenterFactory
    spec: SegmenterSpec = SegmenterSpec(kind="own")
    """The declaration of its inputs, its kind, and whether its outlines are exact."""
    description: str = ""
    """One line for lists."""
    config: Any = None
    """Default configuration, a frozen dataclass, or None; `--config detector.FIELD=VALUE` sets its fields."""

    def __post_init__(self) -> None:
        if not callable(self.make):
            raise ConfigError(f"SegmentationSpec.make must be a factory, got {type(self.make).__name__}.")
        if self.config is not None and (isinstance(self.config, type) or not is_dataclass(self.config)):
            raise ConfigError(f"SegmentationSpec.config must be a dataclass object or None, got {self.config!r}.")


class Perceived(NamedTuple):
    """The segmentation of one frame as the agent used it."""

    scores: Scores | None = None
    """Scores of the goal; None: the agent did not ask for them."""
    categories: NDArray[np.uint8] | None = None
    """mpcat40 ids (h, w) at any size; None: the segmentation does not compute them."""


@runtime_checkable
class StatesSegmentation(Protocol):
    """An agent with a segmentation of its own that viewers may show (`AgentSpec.own_segmentation`)."""

    def stated_segmentation(self) -> Perceived | None:
        """Returns the segmentation of the frame that `act` got last, or None; it is called after `act`."""
        ...


class Agent(Protocol):
    """An agent: any object with these two methods, built by an `AgentFactory`."""

    def reset(self, goal: str, seed: int) -> None:
        """Starts a new episode and deletes all state of the last one."""
        ...

    def act(self, observation: Observation) -> Action:
        """Returns the next action. The observation must not be changed."""
        ...


@runtime_checkable
class ReadsPosteriors(Protocol):
    """An agent, or a part of one, that states whether it reads posteriors.

    If it does, a run with a segmentation that has none does not begin.
    """

    @property
    def reads_posteriors(self) -> bool:
        """Returns whether it calls `Segmenter.posteriors` for each goal category."""
        ...


@runtime_checkable
class KeepsMemory(Protocol):
    """An agent with a memory that outlasts a goal of a chain; `reset` is called at each goal of another agent."""

    def next_goal(self, goal: str) -> None:
        """Called after the end of a goal, before the next observation, with the next goal as in `reset`.

        The robot stays where it is, and `gps` and `compass` still refer to the start of the episode.
        """
        ...


@runtime_checkable
class Overridable(Protocol):
    """An agent that accepts that an action other than its own is carried out, such as that of a person."""

    def overridden(self, action: Action) -> None:
        """Called after `act`, before the next observation, with the action that is carried out instead."""
        ...


@runtime_checkable
class Closable(Protocol):
    """An agent with resources that must be freed, such as a process."""

    def close(self) -> None:
        """Frees the resources; called after the last episode."""
        ...


@runtime_checkable
class StatesConfidence(Protocol):
    """An agent that states how sure it is that the object for which it stops is the goal; the report compares it."""

    def stop_confidence(self) -> float | None:
        """Returns a probability or score in [0, 1]; None: unknown. Called after `act` has returned STOP."""
        ...


@runtime_checkable
class StatesTarget(Protocol):
    """An agent that states for which place it stops; whether a wrong STOP was for the goal is then measured."""

    def stop_target_xy_m(self) -> tuple[float, float] | None:
        """Returns a point of the object for which the agent stops, in plan; None: it does not know one.

        x forward and y left of the start pose, as in `gps`. Called after `act` has returned STOP.
        """
        ...


@runtime_checkable
class StatesModelUse(Protocol):
    """An agent that asks a model over HTTP, and states what an episode took of it; the result line has it."""

    def model_use(self) -> Mapping[str, object]:
        """Returns the fields of `sim.task.result.ModelUse`. Called at the end of an episode."""
        ...


AgentFactory = Callable[..., Agent]
"""Builds an agent from keyword arguments:

| argument | type | meaning |
|---|---|---|
| camera | `CameraModel` | camera of the observations |
| robot | `RobotModel` | the robot that the agent drives |
| success | `SuccessRule` | when a STOP counts |
| segmenter | `Segmenter` | source of the scores |
| verifier | `stubborn.detection.verification.Verifier` | judges candidates of the goal |
| config | type of `AgentSpec.config` | the agent's configuration |
| truth | `sim.env.objectnav.ObjectNavEnv` | only with `uses_ground_truth`: the running environment |
| max_steps | int | only where the factory has a parameter of this name: actions of an episode |
| step_timeout_s | float | only where the factory has a parameter of this name: longest time of a call; 0: no limit |
"""


@dataclass(frozen=True, kw_only=True)
class AgentSpec:
    """The declaration of an agent: its factory and its needs. `--agent package.module:NAME` takes one."""

    make: AgentFactory
    description: str = ""
    """One line for `--list-agents`."""
    config: Any = None
    """Default configuration, a frozen dataclass, or None; `--config agent.FIELD=VALUE` sets its fields."""
    sensors: tuple[Any, ...] = ("rgb", "depth")
    """Sensors that the agent reads: names of `SENSORS` or `ROBOT_SENSORS`, or its own objects
    (`sim.sensors.sensor.Sensor`). Those of its segmenter are added."""
    uses_segmentation: bool = True
    """False: its results do not depend on `--semantics`."""
    own_segmentation: str = ""
    """Name of the segmentation that the agent contains, for reports and videos; `--semantics` is then not used. Videos
    show it if the agent has the method of `StatesSegmentation`."""
    uses_ground_truth: bool = False
    """True: it may read the `semantic` sensor and gets the running environment as `truth`; its results say so."""
    goals: Callable[[Any], tuple[str, ...]] | None = None
    """Returns the goal categories that the agent knows, from its configuration; None: all. Runs skip other episodes."""
    words: tuple[str, ...] | None = None
    """Sensors that it reads in addition where goals are in words (`sim.core.wishes`); None: `reset` takes only
    categories."""
    pictures: tuple[str, ...] | None = None
    """Sensors that it reads in addition where goals are pictures, such as `goal_picture`; None: it takes none. `reset`
    gets "" as the goal then."""
    looks: bool = False
    """True: it may also return LOOK_UP and LOOK_DOWN, which tilt the camera by 30 degrees; the sensor `tilt` reads the
    tilt."""
    painter: Callable[[Agent], Any] | None = None
    """Returns a `MapPainter` of viewers, which draws the agent's map; None: viewers draw the true floor plan."""

    def __post_init__(self) -> None:
        _require_tuples(self, "sensors", "words", "pictures")
        if self.own_segmentation:
            object.__setattr__(self, "uses_segmentation", False)
        true = [sensor for sensor in self.sensors if reads_truth(sensor)]
        if true and not self.uses_ground_truth:
            names = ", ".join(f"'{sensor if isinstance(sensor, str) else sensor.name}'" for sensor in true)
            raise ConfigError(
                f"AgentSpec '{self.description or self.make}': sensor {names} reads ground truth: declare "
                "uses_ground_truth=True."
            )

    def build(self, name: str, *, max_steps: int, step_timeout_s: float = 0.0, **parts: Any) -> Agent:
        """Returns a new agent.

        Args:
            name: the agent's name, for the error message.
            max_steps: actions of an episode; given only to a factory that has a parameter of this name.
            step_timeout_s: longest time of a call of the agent, as `max_steps`.
            parts: the other arguments of `AgentFactory`.

        Raises:
            ConfigError: the factory does not take these arguments.
        """
        try:
            signature = inspect.signature(self.make)
            optional = {"max_steps": max_steps, "step_timeout_s": step_timeout_s}
            parts |= {key: value for key, value in optional.items() if key in signature.parameters}
            signature.bind(**parts)
        except TypeError as error:
            raise ConfigError(
                f"Agent '{name}': its factory is called with the arguments {', '.join(parts)}, but: {error}. "
                "A parameter **options accepts those that it does not use."
            ) from None
        return self.make(**parts)
