"""The Stubborn agent (Luo, Yue, Hong, Agrawal 2022, "Stubborn: A Strong Baseline for Indoor Object Navigation").

At each step the agent evaluates its last action, enters the frame into its map, and chooses an action. All positions
are in the start frame of the episode: the pose is the observation's `gps` and `compass`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np

from sim.core.geometry.grid import GridFrame, Window, cells_near_segment
from sim.core.geometry.pose import Pose
from sim.core.interface import (
    FORWARD_M,
    GOAL_CATEGORIES,
    MAX_STEPS,
    TURN_RAD,
    Action,
    CameraModel,
    ConfigError,
    Observation,
    ReadsPosteriors,
    RobotModel,
    Segmenter,
    SuccessRule,
    wrap_angle,
)
from stubborn.detection.approach import Approach
from stubborn.detection.distances import StopDistances, TargetConfig
from stubborn.detection.seeker import SeekerConfig, SeekerParts, TargetSeekerConfig
from stubborn.detection.verification import AcceptAll, Verifier
from stubborn.detection.wished import STANDS_FOR, WishedSegmenter
from stubborn.exploration.corners import CornerConfig
from stubborn.exploration.explorer import ExplorerConfig, Ground, ReadsSemantics, run_explorer
from stubborn.kernels.grids import MAX_REACH
from stubborn.mapping.collision_marks import CollisionConfig, GpsNoise, is_collision, mark_collision, mark_visited
from stubborn.mapping.felt import FeelConfig, FeltSurfaces, contact_direction
from stubborn.mapping.levelling import LevelledSegmenter, Levelling, LevellingConfig
from stubborn.mapping.mapper import Mapper, MappingConfig, Sighting
from stubborn.mapping.navmap import NavMap
from stubborn.mapping.object_layers import ObjectLayersConfig
from stubborn.planning.avoidance import CollisionAvoidance, collision_policies
from stubborn.planning.planner import Planner, PlanningConfig, Route
from stubborn.planning.standstill import Standstill, StandstillConfig
from stubborn.planning.steering import next_action
from stubborn.planning.untrap import Untrap, UntrapConfig

BUMPER = "bumper"
"""The sensor that `feel` reads if the observation holds it (`--config sensors=[...]` with `bumper`)."""
_TREAD_M = 0.10
"""Half the width of the strip ahead that must have floor before the robot moves forward."""


@dataclass(frozen=True, kw_only=True)
class AgentConfig:
    """All parameters of a Stubborn agent."""

    cell_m: float = 0.05
    """Edge of a cell of the map."""
    map_cells: int = 1440
    """Edge of the global map."""
    window_cells: int = 240
    """Edge of the local window that is planned on."""
    recentre_every_steps: int = 1
    """The window is moved with the robot after this many steps: 1 in the paper, 25 in the published code."""
    levelling: LevellingConfig = field(default_factory=LevellingConfig)
    """With the sensor `imu`, the images of a camera that leans are levelled before they enter the map."""
    mapping: MappingConfig = field(default_factory=MappingConfig)
    collisions: CollisionConfig = field(default_factory=CollisionConfig)
    avoidance: CollisionAvoidance = field(default_factory=CollisionAvoidance)
    feel: FeelConfig | None = None
    """Conclusions from several collisions about the surfaces that cause them; None: each has its own marks, as in the
    paper."""
    standstill: StandstillConfig = field(default_factory=StandstillConfig)
    """With `feel`, the time after which an agent without progress doubts its conclusions."""
    planning: PlanningConfig = field(default_factory=PlanningConfig)
    untrap: UntrapConfig = field(default_factory=UntrapConfig)
    layers: ObjectLayersConfig = field(default_factory=ObjectLayersConfig)
    """Memory of the scores."""
    explorer: ExplorerConfig = field(default_factory=CornerConfig)
    """Chooses where to look; the default is the paper's."""
    target: TargetConfig = field(default_factory=TargetConfig)
    """Distances and steps of the approach to a candidate."""
    seeker: SeekerConfig = field(default_factory=TargetSeekerConfig)
    """Decides on candidates; the default is the paper's."""
    memory: bool = True
    """Whether the next goal of a chain begins with the map and the objects that are known; False: with nothing."""

    def __post_init__(self) -> None:
        if not 1 <= self.window_cells <= self.map_cells:
            raise ConfigError(
                f"AgentConfig needs 1 <= window_cells <= map_cells, got {self.window_cells} and {self.map_cells}."
            )
        if self.recentre_every_steps < 1:
            raise ConfigError(f"AgentConfig.recentre_every_steps must be >= 1, got {self.recentre_every_steps}.")
        unseen_cells = math.ceil(self.planning.unseen_gap_m / self.cell_m) + 2
        if max(self.planning.reach_cells(self.cell_m), unseen_cells) > MAX_REACH:
            raise ConfigError(
                "PlanningConfig.dilation_m, clearance_m, preferred_clearance_m and unseen_gap_m must be at most "
                f"{(MAX_REACH - 2) * self.cell_m:g} m with AgentConfig.cell_m = {self.cell_m:g}."
            )

    def for_robot(self, robot: RobotModel) -> AgentConfig:
        """Returns the configuration for a robot: clearances grow by the excess of its radius over the default."""
        wider_m = robot.radius_m - RobotModel().radius_m
        if wider_m <= 0.0:
            return self
        marks = replace(self.collisions, near_edge_m=self.collisions.near_edge_m + wider_m)
        return replace(self, planning=self.planning.widened(wider_m), collisions=marks)


class StubbornAgent:
    """Maps obstacles, collisions and scores, explores with its explorer, and approaches candidates of the goal."""

    def __init__(
        self,
        *,
        camera: CameraModel,
        robot: RobotModel,
        segmenter: Segmenter,
        success: SuccessRule = SuccessRule(),  # noqa: B008 - frozen
        verifier: Verifier | None = None,
        config: AgentConfig = AgentConfig(),
        max_steps: int = MAX_STEPS,
    ) -> None:
        """Makes the parts of the agent from their configurations.

        Args:
            camera: camera of the observations.
            robot: the robot that the agent drives.
            segmenter: source of the scores. With inexact outlines the rim of the target does not count (see
                `Mapper.add_scores`), and the agent goes nearer before it stops.
            success: the rule by which a STOP counts.
            verifier: judges candidates, if the seeker asks it; by default it accepts all.
            config: all other parameters, with the configurations of explorer, seeker and object layers; see
                `AgentConfig.for_robot`.
            max_steps: actions of an episode; near their end the agent takes more risk.
        """
        self.config = config = config.for_robot(robot)
        self.robot = robot
        self.levelling = Levelling(camera, robot.camera_forward_m, config.levelling)
        self.wished = WishedSegmenter(segmenter, camera)
        self.segmenter = segmenter = LevelledSegmenter(self.wished, self.levelling)
        self.policies = collision_policies(config.avoidance, config.untrap)
        self.mapper = Mapper(camera, robot, config.mapping, config.layers.make(config.mapping.candidate_score))
        feel = config.feel if self.policies.marked else None
        self.felt = None if feel is None else feel.make(robot.radius_m, config.collisions)
        self.planner = Planner(config.planning, self.policies.proven_ground)
        self.explorer = config.explorer.make(camera)
        self.seeker = config.seeker.make(
            SeekerParts(
                camera=camera,
                robot=robot,
                segmenter=segmenter,
                planner=self.planner,
                layers=self.policies.approach,
                target=config.target,
                distances=StopDistances.of(config.target, success, segmenter.spec),
                verifier=verifier or AcceptAll(),
                candidate_score=config.mapping.candidate_score,
                max_steps=max_steps,
                wished=self.wished,
            )
        )
        self.untrap = Untrap(self.policies.untrap_after, turns_reset=config.untrap.turns_reset)
        self.standstill = Standstill(config.standstill)
        self.reset(GOAL_CATEGORIES[0], 0)

    @property
    def reads_posteriors(self) -> bool:
        """See `sim.core.interface.ReadsPosteriors`."""
        by_seeker = isinstance(self.seeker, ReadsPosteriors) and self.seeker.reads_posteriors
        return isinstance(self.explorer, ReadsSemantics) or by_seeker

    def reset(self, goal: str, seed: int) -> None:
        """Starts a new episode.

        Args:
            goal: a goal category, words (`sim.core.wishes`), or "": the first observation has the picture of the goal,
                `goal_picture`.
            seed: for explorers that choose at random.

        Raises:
            WishError: a word of the goal is not known.
        """
        self._look_for(goal)
        self._seed = seed
        self.navmap = NavMap.empty(GridFrame.around_start(self.config.map_cells, self.config.cell_m))
        self.window: Window | None = None
        self.pose: Pose | None = None
        self.last_action: Action | None = None
        self.gps_noise = GpsNoise()
        self.levelling.reset()
        if self.felt is not None:
            self.felt.reset()
        self.planner.own_ground_m = self.config.planning.own_ground_m
        self.standstill.reset()
        self.explorer.reset(seed)
        self.seeker.reset(self.goal)
        self.untrap.reset()

    def next_goal(self, goal: str) -> None:
        """Starts to look for the next goal of a chain; see `sim.core.interface.KeepsMemory`.

        The explored ground and the objects that the seeker tracks stay known; scores on the map are those of one goal.
        """
        if not self.config.memory:
            self.reset(goal, self._seed)
            return
        self._look_for(goal)
        self.navmap.forget_goal()
        self.standstill.reset()
        self.seeker.next_goal(self.goal)

    def _look_for(self, goal: str) -> None:
        self.wished.ask(goal)
        self.goal = self.wished.category
        """The category that is looked for."""
        self.step = 0
        self.route: Route | None = None
        """The route that is followed; None: the agent turns or pushes."""
        self.approach: Approach | None = None
        """The candidate that is approached; None: the agent explores."""

    def act(self, observation: Observation) -> Action:
        """Returns the next action.

        Raises:
            ConfigError: the goal is a picture, and the observation has none.
        """
        if self.wished.awaits_picture:
            self._look_at_picture(observation)
        pose, observation = read_pose(observation), self.levelling.level(observation)
        self._learn_from_last_action(self.pose or pose, pose, observation)
        sighting = self._map(observation, pose)
        self.pose = pose
        self.last_action = self._kept_from_drops(self._decide(pose, sighting), pose)
        self.step += 1
        return self.last_action

    def _look_at_picture(self, observation: Observation) -> None:
        """Sets the goal to what its picture shows.

        Raises:
            ConfigError: the observation has no picture.
        """
        if "goal_picture" not in observation:
            raise ConfigError("The goal is a picture (reset got ''), but the observation has no 'goal_picture'.")
        self.wished.show(observation["goal_picture"])
        self.goal = self.wished.category
        self.seeker.next_goal(self.goal)

    def overridden(self, action: Action) -> None:
        """Records that another action than the agent's own is carried out; see `sim.core.interface.Overridable`."""
        self.last_action = action

    def stop_confidence(self) -> float | None:
        """Returns the confidence in the most recently accepted candidate; see `sim.core.interface.StatesConfidence`."""
        return self.seeker.confidence

    def stop_target_xy_m(self) -> tuple[float, float] | None:
        """Returns the place of the highest score of the last accepted candidate; see `StatesTarget`."""
        if self.seeker.accepted_cell is None:
            return None
        x_m, y_m = self.navmap.frame.centres(*self.seeker.accepted_cell)
        return float(x_m), float(y_m)

    def _learn_from_last_action(self, before: Pose, pose: Pose, observation: Observation) -> None:
        """Marks the ground that was driven over, and a collision where the last forward failed."""
        config, moved_m = self.config.collisions, pose.distance_to(before)
        self.gps_noise.observe(self.last_action, moved_m)
        failed = is_collision(self.last_action, moved_m, self.gps_noise.failed_below_m(config))
        mark_visited(self.navmap, before, pose, self.robot.radius_m, config)
        if self.felt is not None:
            self._feel(self.felt, pose, failed, observation)
        elif failed:
            mark_collision(self.navmap, pose, self.policies.marked, config)
        turned_rad = abs(wrap_angle(pose.yaw_rad - before.yaw_rad))
        turns = self.last_action in (Action.TURN_LEFT, Action.TURN_RIGHT)
        self.untrap.observe(self.last_action, failed or (turns and turned_rad < 0.5 * TURN_RAD))

    def _feel(self, felt: FeltSurfaces, pose: Pose, failed: bool, observation: Observation) -> None:
        """Enters a failed move into the felt surfaces; without progress, avoided places are tried again."""
        touched_rad = contact_direction(pose.yaw_rad, observation.get(BUMPER)) if failed else None
        news = False
        if touched_rad is not None:  # else the wheels slipped, if there is a bumper
            stop = replace(pose, yaw_rad=touched_rad)
            news = felt.add(self.navmap, stop, self.gps_noise.std_m())
        if self.last_action is Action.MOVE_FORWARD:
            own_m = 0.0 if failed and felt.pushes else self.config.planning.own_ground_m
            self.planner.own_ground_m = own_m  # the ground ahead is not free
        self.navmap.times_felt += news
        if self.standstill.observe(self.navmap.seen_area_m2(), news):
            felt.doubt(self.navmap)
            self.seeker.retry()

    def _map(self, observation: Observation, pose: Pose) -> Sighting:
        """Enters the frame into the map, and returns the target points in it."""
        depth, frame = observation["depth"], self.mapper.frame(self.navmap, pose, self.levelling.eye(pose))
        exact_depth = self.mapper.add_depth(frame, depth)
        scores = self.segmenter.scores(observation, self.goal)
        rim_px = 0 if exact_depth and self.segmenter.spec.exact_outlines else self.config.mapping.rim_px
        sighting = self.mapper.add_scores(frame, depth, scores, self.step, rim_px=rim_px)
        if isinstance(self.explorer, ReadsSemantics):
            self.mapper.add_goals(frame, depth, self.segmenter.posteriors(observation))
        self.seeker.observe(self.navmap, observation, pose, self.step)
        return sighting

    def _decide(self, pose: Pose, sighting: Sighting) -> Action:
        """Stops at the target, else gets unstuck, else approaches a candidate, else explores."""
        self.route, self.approach = None, None
        cell = self.seeker.in_reach(self.navmap, sighting)
        if cell is not None and self.seeker.judge(self.navmap, cell):
            return Action.STOP
        escape = self.untrap.next_action()
        if escape is Action.MOVE_FORWARD and self._drop_is_ahead(pose):
            escape = self.untrap.next_action()  # the next turn, to the side of the mode
        if escape is not None:
            return escape
        window = self._local_window(pose)
        self.approach = self.seeker.approach(self.navmap, window, pose, self.step)
        if self.approach is None:
            choice = run_explorer(
                self.explorer,
                Ground(
                    self.navmap,
                    window,
                    pose,
                    self.policies.exploration,
                    self.planner,
                    STANDS_FOR.get(self.goal, self.goal),
                ),
            )
        elif self.approach.route is None:
            choice = self._inspect(self.approach, pose)
        else:
            choice = self.approach.route
        if isinstance(choice, Action):
            return choice
        if choice is None:  # the map shows no path at all: push in one direction after the other
            return Action.MOVE_FORWARD if self.last_action is Action.TURN_LEFT else Action.TURN_LEFT
        self.route = choice
        return next_action(self.route, pose, self.config.planning)

    def _kept_from_drops(self, action: Action, pose: Pose) -> Action:
        """Returns the action, or a turn to the left in place of a forward over a drop.

        Routes keep away from drops, but a forward without a route may lead over one.
        """
        over_drop = action is Action.MOVE_FORWARD and self._drop_is_ahead(pose)
        return Action.TURN_LEFT if over_drop else action

    def _drop_is_ahead(self, pose: Pose) -> bool:
        """Returns whether a forward would lead over a drop on the map."""
        index, ahead = cells_near_segment(self.navmap.frame, pose.xy_m, pose.ahead(FORWARD_M), _TREAD_M)
        return bool(self.navmap.seen_drop[index][ahead].any())

    def _inspect(self, approach: Approach, pose: Pose) -> Action:
        """Turns to the candidate at a viewpoint, then asks the seeker for a decision on it."""
        off_rad = wrap_angle(approach.bearing_rad - pose.yaw_rad)
        if abs(off_rad) > self.config.planning.aligned_rad:
            return Action.TURN_LEFT if off_rad > 0 else Action.TURN_RIGHT
        if self.seeker.judge(self.navmap, approach.cell):
            if approach.near_enough:
                nearer = self.seeker.one_more_forward(self.navmap, approach, pose)
                return Action.MOVE_FORWARD if nearer else Action.STOP
            self.seeker.postpone(self.navmap, self.step)
        return Action.TURN_LEFT

    def _local_window(self, pose: Pose) -> Window:
        """Returns the local window, which is moved with the robot every few steps."""
        if self.window is None or self.step % self.config.recentre_every_steps == 0:
            self.window = self.navmap.frame.window_at(pose.x_m, pose.y_m, self.config.window_cells)
        return self.window


def read_pose(observation: Observation) -> Pose:
    """Returns the pose in the start frame from `gps` (metres forward, left) and `compass` (radians)."""
    x_m, y_m = (float(v) for v in np.asarray(observation["gps"]).reshape(2))
    return Pose(x_m, y_m, math.remainder(float(np.asarray(observation["compass"]).reshape(())), math.tau))
