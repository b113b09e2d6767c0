"""The Stubborn agent: look, plan, step (Luo, Yue, Hong, Agrawal 2022, "Stubborn: A Strong Baseline for Indoor Object
Navigation").

Everything is thought in the start frame of the episode: the pose is the observation's `gps` and `compass`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from sim.geometry.grid import GridFrame, Window
from sim.geometry.pose import Pose
from sim.interface import (
    GOAL_CATEGORIES,
    Action,
    CameraModel,
    ConfigError,
    Observation,
    RobotModel,
    Segmenter,
    wrap_angle,
)
from stubborn.exploration.corners import CornerExplorer, ExplorationConfig, Explorer, Route
from stubborn.exploration.glance import GlanceConfig, Glancer
from stubborn.mapping.collision_marks import CollisionConfig, Jitter, is_collision, mark_collision, mark_visited
from stubborn.mapping.mapper import Mapper, MappingConfig, Sighting
from stubborn.mapping.object_layers import ObjectLayers
from stubborn.navmap import NavMap
from stubborn.planning.planner import Planner, PlanningConfig
from stubborn.planning.untrap import Untrap, UntrapConfig
from stubborn.target.seeker import Approach, TargetConfig, TargetSeeker
from stubborn.target.verification import AcceptAll, Verifier


@dataclass(frozen=True, kw_only=True)
class CollisionAvoidance:
    """The four measures of the paper's ablation (Table "stubborn-ablation"); all on is the full agent."""

    untrap: bool = True
    """Brute-force untrap mode."""
    collision_layers: bool = True
    """Keep collision marks and plan around them."""
    averse_exploration: bool = True
    """Explore on the pessimistic layer; without it on the optimistic one."""
    visited_is_free: bool = True
    """Where the body has been, no collision mark counts."""


@dataclass(frozen=True, kw_only=True)
class AgentConfig:
    """Everything about a Stubborn agent that can be chosen."""

    cell_m: float = 0.05
    map_cells: int = 1440
    """Edge of the global map."""
    window_cells: int = 240
    """Edge of the local window that is planned on."""
    recentre_every_steps: int = 1
    """1: the window always has the robot in its middle (the paper); the published code moves it every 25 steps."""
    mapping: MappingConfig = field(default_factory=MappingConfig)
    collisions: CollisionConfig = field(default_factory=CollisionConfig)
    planning: PlanningConfig = field(default_factory=PlanningConfig)
    exploration: ExplorationConfig = field(default_factory=ExplorationConfig)
    glance: GlanceConfig = field(default_factory=GlanceConfig)
    untrap: UntrapConfig = field(default_factory=UntrapConfig)
    target: TargetConfig = field(default_factory=TargetConfig)
    avoidance: CollisionAvoidance = field(default_factory=CollisionAvoidance)

    def __post_init__(self) -> None:
        if not 1 <= self.window_cells <= self.map_cells:
            raise ConfigError(
                f"AgentConfig needs 1 <= window_cells <= map_cells, got {self.window_cells} and {self.map_cells}."
            )
        if self.recentre_every_steps < 1:
            raise ConfigError(f"AgentConfig.recentre_every_steps must be >= 1, got {self.recentre_every_steps}.")


class StubbornAgent:
    """Maps what it sees and bumps into, explores towards corners, approaches what looks like the goal."""

    def __init__(
        self,
        *,
        camera: CameraModel,
        robot: RobotModel,
        segmenter: Segmenter,
        verifier: Verifier | None = None,
        explorer: Explorer | None = None,
        layers: ObjectLayers | None = None,
        config: AgentConfig = AgentConfig(),
    ) -> None:
        """Parts that a baseline exchanges are passed in.

        Args:
            camera: what the observations are taken with.
            robot: the body that is driven.
            segmenter: where scores come from. One that has `exact = True` is trusted to the outline; with any other the
                rim of the target does not count (see `Mapper.add_scores`) and the agent goes nearer before it stops.
            verifier: judges candidates; by default it accepts all.
            explorer: chooses where to look; by default the paper's, from `config.exploration`.
            layers: keeps the scores; by default over all frames.
            config: everything else.
        """
        self.config = config
        self.robot = robot
        self.segmenter = segmenter
        self._true_outlines = segmenter.spec.exact_outlines
        avoidance = config.avoidance
        self.mapper = Mapper(camera, robot, config.mapping, layers)
        self.planner = Planner(config.planning, trust_visited=avoidance.visited_is_free)
        self.explorer: Explorer = explorer or CornerExplorer(
            config.exploration, self.planner, averse=avoidance.averse_exploration, bumps=avoidance.collision_layers
        )
        self.glancer = Glancer(config.glance, camera)
        self.seeker = TargetSeeker(
            config.target,
            self.planner,
            verifier or AcceptAll(),
            bumps=avoidance.collision_layers,
            true_outlines=self._true_outlines,
        )
        self.untrap = Untrap(config.untrap)
        self.reset(GOAL_CATEGORIES[0], 0)

    def reset(self, goal: str, seed: int) -> None:
        """Start a new episode; `seed` is not used: this agent leaves nothing to chance."""
        self.goal = goal
        self.step = 0
        self.navmap = NavMap.empty(GridFrame.around_start(self.config.map_cells, self.config.cell_m))
        self.window: Window | None = None
        self.pose: Pose | None = None
        self.last_action: Action | None = None
        self.jitter = Jitter()
        self.route: Route | None = None
        """What is being followed, for pictures."""
        self.approach: Approach | None = None
        """The candidate being approached, for pictures."""
        self.explorer.reset()
        self.glancer.reset()
        self.seeker.reset(goal)
        self.untrap.reset()

    def act(self, observation: Observation) -> Action:
        """Look, then decide."""
        before, pose = self.pose, read_pose(observation)
        self._feel(before or pose, pose)
        sighting = self._look(observation, pose)
        self.pose = pose
        self.last_action = self._decide(pose, sighting)
        self.step += 1
        return self.last_action

    def _feel(self, before: Pose, pose: Pose) -> None:
        """Learn from how the last action went."""
        config, moved_m = self.config.collisions, pose.distance_to(before)
        self.jitter.observe(self.last_action, moved_m)
        failed = is_collision(self.last_action, moved_m, self.jitter.failed_below_m(config))
        mark_visited(self.navmap, before, pose, self.robot.radius_m, config)
        if failed and self.config.avoidance.collision_layers:
            mark_collision(self.navmap, pose, config)
        if self.config.avoidance.untrap:
            self.untrap.observe(self.last_action, failed)

    def _look(self, observation: Observation, pose: Pose) -> Sighting:
        """Enter the frame into the map."""
        exact = self.mapper.add_depth(self.navmap, observation["depth"], pose)
        scores = self.segmenter.scores(observation, self.goal)
        exact &= self._true_outlines
        return self.mapper.add_scores(self.navmap, observation["depth"], scores, pose, self.step, exact=exact)

    def _decide(self, pose: Pose, sighting: Sighting) -> Action:
        """Stop at the target, else get unstuck, else approach a candidate, else explore."""
        self.route, self.approach = None, None
        cell = self.seeker.in_reach(self.navmap, sighting)
        if cell is not None and self.seeker.judge(self.navmap, cell):
            return Action.STOP
        escape = self.untrap.next_action()
        if escape is not None:
            return escape
        window = self._follow(pose)
        self.approach = self.seeker.approach(self.navmap, window, pose, self.step)
        if self.approach is not None and self.approach.route is None:
            return self._inspect(self.approach, pose)
        if self.approach is None and self.explorer.looks_around():
            return Action.TURN_LEFT
        if self.approach is None:
            glance = self.glancer.next_action(self.navmap, pose)
            if glance is not None:
                return glance
        self.route = self.approach.route if self.approach else self.explorer.route(self.navmap, window, pose)
        if self.route is None:  # walled in by the map: push in one direction after the other
            return Action.MOVE_FORWARD if self.last_action is Action.TURN_LEFT else Action.TURN_LEFT
        return self.planner.next_action(self.route.plan, self.route.free, pose)

    def _inspect(self, approach: Approach, pose: Pose) -> Action:
        """On a stand: face the candidate, then judge it."""
        off_rad = wrap_angle(approach.bearing_rad - pose.yaw_rad)
        if abs(off_rad) > self.config.planning.aligned_rad:
            return Action.TURN_LEFT if off_rad > 0 else Action.TURN_RIGHT
        if self.seeker.judge(self.navmap, approach.cell):
            if approach.near_enough:
                return Action.STOP
            self.seeker.postpone(self.navmap, self.step)
        return Action.TURN_LEFT

    def _follow(self, pose: Pose) -> Window:
        """The local window, moved with the robot when its time has come."""
        if self.window is None or self.step % self.config.recentre_every_steps == 0:
            self.window = self.navmap.frame.window_at(pose.x_m, pose.y_m, self.config.window_cells)
        return self.window


def read_pose(observation: Observation) -> Pose:
    """The pose in the start frame from `gps` (metres forward, left) and `compass` (radians)."""
    x_m, y_m = (float(v) for v in np.asarray(observation["gps"]).reshape(2))
    return Pose(x_m, y_m, math.remainder(float(np.asarray(observation["compass"]).reshape(())), math.tau))
