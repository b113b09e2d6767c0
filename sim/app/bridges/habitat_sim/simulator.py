"""Habitat's `Simulator`: one house with one robot and its cameras; habitat-lab's class `HabitatSim` is made from it."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.app.bridges.habitat_sim.agent import Agent, AgentState
from sim.app.bridges.habitat_sim.maths import Deg, Quaternion, Rad, Vector3, quat_from_coeffs
from sim.app.bridges.habitat_sim.options import current_options
from sim.app.bridges.habitat_sim.pathfinder import GreedyGeodesicFollower, PathFinder
from sim.app.bridges.habitat_sim.scenes import find_house
from sim.app.bridges.habitat_sim.semantics import SemanticScene, semantic_scene
from sim.app.bridges.habitat_sim.settings import (
    ActionSpec,
    ActuationSpec,
    AgentConfiguration,
    CameraSensorSpec,
    Configuration,
    SensorSpec,
    SensorSubType,
    SensorType,
)
from sim.app.services.frames import Frame, register
from sim.core.errors import ConfigError, EpisodeError, HouseError
from sim.core.geometry.pose import BodyPose, Pose
from sim.core.interface import Action, CameraModel
from sim.detectors.noisy import LabelledObjects
from sim.episodes.habitat import to_rotation
from sim.renderer.camera import Camera
from sim.renderer.gloss import geom_gloss
from sim.robot.conditions import Conditions
from sim.robot.config import DriveConfig, MotionKind, RobotConfig
from sim.sensors.noise import SensorNoise, get_noise
from sim.sensors.standard import resolve_sensors
from sim.task.objectnav import Task
from sim.world.world import World

_BESIDE_M = (0.0, 0.01, 0.02, 0.03, 0.05)
"""Distances at which the robot is put if there is no room for it where a script put it."""
FAR_M = 100.0
"""Depth of surfaces that are farther away, and of no surface."""
_IMAGES = {SensorType.COLOR: "rgb", SensorType.DEPTH: "depth", SensorType.SEMANTIC: "geom"}
_ACTIONS = {
    "stop": Action.STOP,
    "move_forward": Action.MOVE_FORWARD,
    "turn_left": Action.TURN_LEFT,
    "turn_right": Action.TURN_RIGHT,
}


class Simulator:
    """One house, one robot.

    Args:
        config: house, cameras and actions. An action moves by its `ActuationSpec.amount`, metres or degrees.

    Raises:
        HouseError: there is no such house.
        ConfigError: something that is not here, such as a fisheye camera or a second agent.
    """

    def __init__(self, config: Configuration) -> None:
        self._options = current_options()
        self._loaded: tuple[str, RobotConfig] | None = None
        self._cameras: dict[CameraModel, Camera] = {}
        self._seed = int(config.sim_cfg.random_seed)
        self._configure(config)

    def _configure(self, config: Configuration) -> None:
        self.config = config
        if config.enable_batch_renderer:
            raise ConfigError("There is no batch rendering here: set renderer.enable_batch_renderer to false.")
        if len(config.agents) != 1:
            raise ConfigError(f"There is one robot here; the configuration has {len(config.agents)} agents.")
        scene = config.sim_cfg.scene_id
        if scene in ("", "NONE"):
            raise HouseError("scene_id must name a house: an MJCF file, or split/house.xml.")
        self.agents = [Agent(config.agents[0])]
        robot = _robot(config.agents[0], self._options.motion)
        if (scene, robot) != self._loaded:
            self._load(scene, robot)
            self._loaded = scene, robot
        self.agents[0].enter(self.world, self.settle)
        self._groups = _cameras(config.agents[0].sensor_specifications)
        self._noises: dict[str, SensorNoise] = {}
        self._fresh, self._collided = True, False
        self._put_initially()

    def _load(self, scene: str, robot: RobotConfig) -> None:
        """Compiles a house with the robot in it."""
        self._free_cameras()
        self.world = World(find_house(scene), robot=robot)
        self.world.restore()
        self._gloss = geom_gloss(self.world.model, self.world.labels)
        self._task = Task(self.world)
        self.pathfinder = PathFinder(self._task.truth, self._seed)
        self._semantic_scene: SemanticScene | None = None
        instances = np.append(self.world.labels.geom_instance + 1, 0)  # the last entry is that of geom -1
        self._semantic_ids = instances.astype(np.uint32)
        self._objects, self._frame_number = LabelledObjects.of(self.world), 0

    def _put_initially(self) -> None:
        """Puts the agent at a random place, as Habitat does, until it is put elsewhere."""
        place = self.pathfinder.get_random_navigable_point()
        state = AgentState(np.asarray(place), quat_from_coeffs(to_rotation(0.5 * math.pi)))
        self.agents[0].set_state(state, is_initial=True)

    @property
    def semantic_scene(self) -> SemanticScene:
        """The labelled objects, rooms and storeys."""
        if self._semantic_scene is None:
            self._semantic_scene = semantic_scene(self.world)
        return self._semantic_scene

    @property
    def previous_step_collided(self) -> bool:
        """Whether a contact ended the last action early."""
        return self._collided

    def distance_to_goal_m(self, category: str) -> float | None:
        """Returns the distance to the nearest place where a STOP for a category succeeds (docs/task.md); None: no path.

        Objects count where the house file puts them.

        Raises:
            EpisodeError: the house has no instance.
        """
        return self._task.distance_from(category, self.agents[0].pose)

    def stop_succeeds(self, category: str) -> bool:
        """Returns whether a STOP for a category succeeds now: a visible point of an instance is within 1 m."""
        pose = self.agents[0].pose
        return self._task.truth.succeeds_now(category, pose.x_m, pose.y_m, pose.floor_z_m)

    def seed(self, new_seed: int) -> None:
        """Seeds random places and noise."""
        self._seed = int(new_seed)
        self.pathfinder.seed(self._seed)

    def reset(self, agent_ids: int | Sequence[int] | None = None) -> dict[str, Any]:
        """Restores the house and the agent's initial state; returns what the cameras see.

        Physics restarts at the next action or observation.
        """
        self.world.restore()
        self.agents[0].reset()
        self._fresh, self._collided = True, False
        return self._render()

    def reconfigure(self, config: Configuration) -> None:
        """Takes another configuration; the house is loaded only if it is another one."""
        self._configure(config)

    def step(self, action: Any, dt: float = 1.0 / 60.0) -> dict[Any, Any]:
        """Performs an action from rest to rest; returns what the cameras then see, and `collided`.

        Args:
            action: a key of the agent's `action_space`; {0: KEY} gives {0: observations}.
            dt: exists for scripts that give it; an action takes the time that the robot needs.
        """
        if isinstance(action, Mapping):
            return {agent: self.step(key) for agent, key in action.items()}
        space = self.agents[0].agent_config.action_space
        if action not in space:
            raise ConfigError(f"Unknown action {action!r}. Available: {', '.join(map(repr, space))}.")
        self.act(space[action])
        observations = self._render()
        observations["collided"] = self._collided
        return observations

    def act(self, spec: ActionSpec) -> None:
        """Performs an action without looking."""
        if spec.name in ("look_up", "look_down"):
            by = spec.actuation or ActuationSpec(0.0)
            self._look(by.amount if spec.name == "look_up" else -by.amount, by.constraint)
            return
        if spec.name not in _ACTIONS:
            raise ConfigError(f"Unknown action '{spec.name}'. Available: {', '.join(_ACTIONS)}, look_up, look_down.")
        self.settle()
        motion = self.world.move(_ACTIONS[spec.name])
        self._collided = motion.collided

    def _look(self, degrees: float, most: float | None) -> None:
        """Tilts the cameras, up to `most` degrees above and below the horizon; None: as far as asked."""
        self._collided = False
        for sensor in self.agents[0].sensors.values():
            rotation, by = sensor.node.rotation, degrees
            if most is not None:
                tilt = 2.0 * math.degrees(math.atan2(rotation.vector[0], rotation.scalar))
                by = min(max(degrees, -most - tilt), most - tilt)
            sensor.node.rotation = rotation * Quaternion.rotation(Deg(by), Vector3.x_axis())

    def settle(self) -> None:
        """Puts the robot where the agent was put, in physics, and begins the episode after a reset."""
        agent = self.agents[0]
        if self._fresh:
            conditions = self._conditions()
            _beside(agent.pose, lambda pose: self.world.reset(pose, conditions))
            self._fresh = False
        elif agent.put is not None:
            _beside(agent.put, self.world.put)
        agent.put = None

    def _conditions(self) -> Conditions:
        """Begins the noise of an episode, each camera's from a generator of its own; returns that of its physics."""
        config, rng = get_noise(self._options.noise), np.random.default_rng(self._seed)
        self._seed += 1
        drive = SensorNoise(config, CameraModel(), ())
        self._noises = {}
        for model, specs in self._groups.items():
            for spec in specs:
                names = [_IMAGES[spec.sensor_type]] if spec.sensor_type != SensorType.SEMANTIC else []
                self._noises[spec.uuid] = SensorNoise(config, model, resolve_sensors(names))
        for noise in self._noises.values():
            noise.begin(rng.spawn(1)[0], self._gloss)
        return drive.begin(rng.spawn(1)[0], self._gloss)

    def get_sensor_observations(self, agent_ids: int | Sequence[int] = 0) -> dict[Any, Any]:
        """Returns what the cameras see: uint8 (h, w, 4), metres float32 (h, w), object indices uint32 (h, w).

        With a list of agents, it is the value of each of them in a dict.
        """
        if self._fresh:
            self.settle()
        self._collided = False
        return {agent: self._render() for agent in agent_ids} if isinstance(agent_ids, Sequence) else self._render()

    def _render(self) -> dict[str, Any]:
        """Returns the image of each camera."""
        agent, observations = self.agents[0], dict[str, Any]()
        for model, specs in self._groups.items():
            for seen in _by_eye(agent, specs):
                noises = [self._noises[spec.uuid] for spec in seen if spec.uuid in self._noises]
                names = {_IMAGES[spec.sensor_type] for spec in seen}.union(*(noise.images for noise in noises))
                if self._options.detectors and "rgb" in names:
                    names |= {"depth", "geom"}
                if model not in self._cameras:
                    self._cameras[model] = Camera(
                        self.world.model, self.world.labels, camera=model, profile=self._options.profile
                    )
                eye = agent.eye(seen[0].uuid, model.height_m)
                images = self._cameras[model].render(self.world.data, eye, sorted(names))
                observations |= {spec.uuid: self._observation(spec, images) for spec in seen}
                if self._options.detectors and "rgb" in names:
                    colour = next(spec.uuid for spec in seen if spec.sensor_type == SensorType.COLOR)
                    self._register(observations[colour], images, model, eye)
        return observations

    def _register(self, rgba: NDArray, images: Mapping[str, NDArray], camera: CameraModel, eye: BodyPose) -> None:
        """Sends a picture with its truth to the server of detectors."""
        contract = CameraModel(
            width_px=camera.width_px, height_px=camera.height_px, hfov_rad=camera.hfov_rad, height_m=camera.height_m
        )
        depth = np.minimum(images["depth"], contract.max_depth_m)
        depth[depth < contract.min_depth_m] = 0.0
        self._frame_number += 1
        frame = Frame(
            rgb=np.ascontiguousarray(rgba[..., :3]),
            depth=depth.astype(np.float32),
            objects=self._objects.of_geom[images["geom"]].astype(np.int16),
            names=tuple(instance.name for instance in self.world.labels.instances),
            categories=tuple(instance.category for instance in self.world.labels.instances),
            middles_xy_m=self._objects.middle_xy_m,
            eye_xy_m=(eye.x_m, eye.y_m),
            seed=self._seed,
            number=self._frame_number,
            camera=contract,
        )
        register(self._options.detectors, frame)

    def _observation(self, spec: SensorSpec, images: Mapping[str, NDArray]) -> NDArray:
        """Returns the image of one camera in Habitat's form, with noise."""
        name = _IMAGES[spec.sensor_type]
        image = images[name]
        if spec.sensor_type == SensorType.SEMANTIC:
            return self._semantic_ids[image]
        if spec.uuid in self._noises:
            image = self._noises[spec.uuid].apply({name: image}, images)[name]
        return cv2.cvtColor(image, cv2.COLOR_RGB2RGBA) if spec.sensor_type == SensorType.COLOR else image

    def get_agent(self, agent_id: int) -> Agent:
        """Returns the agent."""
        return self.agents[agent_id]

    def initialize_agent(self, agent_id: int, initial_state: AgentState | None = None) -> Agent:
        """Puts the agent at a state, or at a random place."""
        if initial_state is None:
            self._put_initially()
        else:
            self.agents[agent_id].set_state(initial_state, is_initial=True)
        return self.agents[agent_id]

    def last_state(self, agent_id: int = 0) -> AgentState:
        """Returns the state of the agent."""
        return self.agents[agent_id].get_state()

    def make_greedy_follower(
        self, agent_id: int = 0, goal_radius: float | None = None, **keys: Any
    ) -> GreedyGeodesicFollower:
        """Returns a follower of shortest paths; `keys` are those of `GreedyGeodesicFollower`."""
        self.settle()
        return GreedyGeodesicFollower(self.pathfinder, self.agents[agent_id], goal_radius, **keys)

    def step_filter(self, start_pos: Any, end_pos: Any) -> Vector3:
        """Returns where a kinematic motion ends; it slides if `allow_sliding` is set."""
        sliding = self.config.sim_cfg.allow_sliding
        step = self.pathfinder.try_step if sliding else self.pathfinder.try_step_no_sliding
        return step(start_pos, end_pos)

    def step_physics(self, dt: float = 1.0 / 60.0, scene_id: int = 0) -> None:
        """Does nothing: an action includes the time until the robot is at rest."""

    def step_world(self, dt: float = 1.0 / 60.0) -> float:
        """Does nothing, and returns the simulated time, seconds."""
        return self.get_world_time()

    def get_world_time(self) -> float:
        """Returns the simulated time since the episode began, seconds."""
        return float(self.world.data.time)

    def add_sensor(self, sensor_spec: SensorSpec, agent_id: int | None = None) -> None:
        """Adds a camera."""
        config = self.agents[0].agent_config
        self._change_sensors([*config.sensor_specifications, sensor_spec])

    def remove_sensor(self, sensor_uuid: str, agent_id: int | None = None) -> None:
        """Removes a camera."""
        config = self.agents[0].agent_config
        self._change_sensors([spec for spec in config.sensor_specifications if spec.uuid != sensor_uuid])

    def _change_sensors(self, specs: list[SensorSpec]) -> None:
        agent = self.agents[0]
        self._groups = _cameras(specs)
        agent.agent_config.sensor_specifications = specs
        kept = agent.sensors
        agent.sensors = Agent(agent.agent_config).sensors
        agent.sensors |= {uuid: sensor for uuid, sensor in kept.items() if uuid in agent.sensors}

    def get_sensor(self, sensor_uuid: str) -> _View:
        """Returns a camera that can be asked for its image alone."""
        return _View(self, sensor_uuid)

    def get_object_template_manager(self) -> _NoObjects:
        """Returns a manager without objects: houses hold their furniture."""
        return _NoObjects()

    get_rigid_object_manager = get_articulated_object_manager = get_object_template_manager

    def recompute_navmesh(
        self, pathfinder: PathFinder, navmesh_settings: Any = None, include_static_objects: bool = True
    ) -> bool:
        """Returns True: the free space is always that of the house and the robot."""
        return True

    @property
    def curr_scene_name(self) -> str:
        """The house."""
        return self.config.sim_cfg.scene_id

    @property
    def gfx_replay_manager(self) -> Any:
        """Is not here."""
        raise NotImplementedError("There is no replay of graphics here: `stubborn run --record` writes videos.")

    def close(self, destroy: bool = True) -> None:
        """Frees the cameras."""
        self._free_cameras()

    def _free_cameras(self) -> None:
        for camera in self._cameras.values():
            camera.close()
        self._cameras = {}

    def __enter__(self) -> Simulator:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


class _View:
    """One camera of a simulator."""

    def __init__(self, simulator: Simulator, uuid: str) -> None:
        self._simulator, self._uuid = simulator, uuid
        self.node = simulator.agents[0].sensors[uuid].node

    def draw_observation(self) -> None:
        """Does nothing: `get_observation` renders."""

    def get_observation(self) -> NDArray:
        """Returns the image."""
        return self._simulator._render()[self._uuid]


class _NoObjects:
    """A manager of objects that has none."""

    def load_configs(self, path: str) -> list[int]:
        """Raises ConfigError: objects of Habitat's data sets cannot be loaded."""
        raise ConfigError(f"'{path}': objects of Habitat's data sets cannot be added to a house here.")

    def get_num_objects(self) -> int:
        """Returns 0."""
        return 0

    def remove_all_objects(self) -> None:
        """Does nothing."""


def _beside(pose: Pose, put: Callable[[Pose], None]) -> None:
    """Calls `put` with a pose, or with one as near to it as the furniture allows: free space has cells of 2.5 cm.

    Raises:
        EpisodeError: there is no room for the robot within 5 cm.
    """
    first: EpisodeError | None = None
    for distance_m in _BESIDE_M:
        for angle in np.linspace(0.0, 2.0 * math.pi, 8 if distance_m else 1, endpoint=False):
            dx_m, dy_m = distance_m * math.cos(angle), distance_m * math.sin(angle)
            try:
                return put(replace(pose, x_m=pose.x_m + dx_m, y_m=pose.y_m + dy_m))
            except EpisodeError as error:
                first = first or error
    assert first is not None
    raise first


def _robot(agent: AgentConfiguration, motion: MotionKind) -> RobotConfig:
    """Returns the robot with the lengths of the agent's actions."""
    amounts = {
        spec.name: float(spec.actuation.amount) for spec in agent.action_space.values() if spec.actuation is not None
    }
    turns = {amounts.get("turn_left"), amounts.get("turn_right")} - {None}
    if len(turns) > 1:
        raise ConfigError(f"turn_left and turn_right must turn by one angle, got {amounts}.")
    drive = DriveConfig()
    if "move_forward" in amounts:
        drive = replace(drive, forward_m=amounts["move_forward"])
    if turns:
        drive = replace(drive, turn_rad=math.radians(turns.pop() or 0.0))
    return RobotConfig(drive=drive, motion=motion)


def _cameras(specs: Sequence[SensorSpec]) -> dict[CameraModel, list[SensorSpec]]:
    """Returns the sensors by the camera that renders them."""
    groups: dict[CameraModel, list[SensorSpec]] = defaultdict(list)
    for spec in specs:
        if type(spec) is not CameraSensorSpec or spec.sensor_subtype != SensorSubType.PINHOLE:
            raise ConfigError(f"Sensor '{spec.uuid}': cameras here are pinhole cameras.")
        if spec.sensor_type not in _IMAGES:
            raise ConfigError(f"Sensor '{spec.uuid}': there are colour, depth and semantic cameras here.")
        if spec.noise_model not in ("None", "", None):
            raise ConfigError(
                f"Sensor '{spec.uuid}': noise model '{spec.noise_model}' of habitat-sim is not here; "
                "stubborn_habitat.configure(noise='realsense') has noise of its own."
            )
        height_px, width_px = (int(side) for side in np.asarray(spec.resolution).tolist())
        hfov = spec.hfov if isinstance(spec.hfov, Rad) else Deg(np.asarray(spec.hfov).item())
        up_m = max(0.01, float(np.asarray(spec.position)[1]))
        model = CameraModel(
            width_px=width_px, height_px=height_px, hfov_rad=float(Rad(hfov)), height_m=up_m, min_depth_m=0.0,
            max_depth_m=FAR_M,
        )  # fmt: skip
        groups[model].append(spec)
    return dict(groups)


def _by_eye(agent: Agent, specs: Sequence[SensorSpec]) -> list[list[SensorSpec]]:
    """Returns the sensors that look from one place in one direction together."""
    together: dict[Any, list[SensorSpec]] = defaultdict(list)
    for spec in specs:
        node = agent.sensors[spec.uuid].node
        rotation = node.rotation
        key = (*node.translation.tolist(), *np.round(rotation.vector, 6).tolist(), round(rotation.scalar, 6))
        together[key].append(spec)
    return list(together.values())
