"""Runs one agent in one trap and records every step, for `stubborn traps report` and `tests/traps`."""

from __future__ import annotations

from dataclasses import dataclass, field

import msgspec
import numpy as np

from sim.app.evaluation.rollout import ask, next_action
from sim.core.interface import Action, Agent
from sim.core.reading import Count, Name, Number
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.episode import Episode
from sim.episodes.seeds import episode_seeds
from sim.gl import mujoco
from sim.robot.body import PREFIX
from sim.robot.contacts import Contact
from sim.robot.drive import Motion
from sim.task.result import EpisodeMetrics
from sim.world.world import World


class TrapResult(msgspec.Struct, frozen=True, kw_only=True):
    """A line of the results of traps, and a row of `traps.csv`."""

    trap: Name
    episode_id: Name
    agent: Name
    escaped: bool
    steps: Count
    steps_in_trap: Count
    collisions: Count
    trapped: bool
    spl: Number
    forward_mean_m: Number | None
    deepest_mm: Number
    fell: bool


@dataclass
class Trial:
    """The record of one episode; positions are in world coordinates, metres."""

    trap: str
    episode_id: str
    agent: str
    metrics: EpisodeMetrics | None = None
    """Metrics of the task at the end; None: the episode still runs."""
    positions_m: list[tuple[float, float]] = field(default_factory=list)
    """Positions of the robot's centre, the start first."""
    yaws_rad: list[float] = field(default_factory=list)
    motions: list[Motion] = field(default_factory=list)
    deepest_m: float = 0.0
    """Largest penetration of the hull into anything, over all physics steps."""
    steps_in_trap: int = 0
    """Actions that began in the trap's zone."""

    @property
    def escaped(self) -> bool:
        """Returns whether the goal was found; every trap is on the path to it."""
        return self.metrics is not None and bool(self.metrics.success)

    @property
    def forwards_m(self) -> list[float]:
        """Displacement of each forward action."""
        return [motion.displacement_m for motion in self.motions if motion.action == Action.MOVE_FORWARD]

    def result(self) -> TrapResult:
        """Returns the result of the episode, which must have ended."""
        assert self.metrics is not None
        forwards_m = self.forwards_m
        return TrapResult(
            trap=self.trap,
            episode_id=self.episode_id,
            agent=self.agent,
            escaped=self.escaped,
            steps=len(self.motions),
            steps_in_trap=self.steps_in_trap,
            collisions=self.metrics.collisions,
            trapped=bool(self.metrics.trapped),
            spl=round(self.metrics.spl, 3),
            forward_mean_m=round(float(np.mean(forwards_m)), 4) if forwards_m else None,
            deepest_mm=round(1000 * self.deepest_m, 2),
            fell=self.metrics.end_reason == "fallen",
        )

    @property
    def stops(self) -> list[tuple[int, Contact]]:
        """Step and contact of every contact that stopped a motion."""
        return [(i, contact) for i, motion in enumerate(self.motions) for contact in motion.contacts if contact.stopped]


class DeepestContact:
    """A MuJoCo control callback that records the largest penetration of the robot's hull over all physics steps."""

    def __init__(self, hull_geoms: frozenset[int]) -> None:
        self._hull = hull_geoms
        self.depth_m = 0.0

    def __call__(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        """Updates `depth_m`; MuJoCo calls this in each step."""
        if data.ncon <= 2:
            return
        depths_m = data.contact.includemargin - data.contact.dist
        for pair, depth_m in zip(data.contact.geom.tolist(), depths_m.tolist(), strict=True):
            if not self._hull.isdisjoint(pair):
                self.depth_m = max(self.depth_m, depth_m)


def hull_of(world: World) -> frozenset[int]:
    """Returns the geoms of the robot's hull."""
    return frozenset(world.model.geom(f"{PREFIX}{part}_hull").id for part in ("lower", "upper"))


def run_trial(env: ObjectNavEnv, agent: Agent, name: str, episode: Episode) -> Trial:
    """Runs one episode of a trap to its end.

    Raises:
        AgentError: the agent failed.
        PhysicsError: the robot fell or tipped over, or the simulation diverged.
    """
    trial = Trial(episode.house, episode.episode_id, name)
    seed = episode_seeds(0, episode.episode_id).environment
    observation, _ = env.reset(seed=seed, options={"episode": episode})
    where = f"Agent '{name}' in house '{episode.house}'"
    ask(f"{where}, reset", lambda: agent.reset(episode.goal, seed))
    zone = env.split.sidecar(episode.house).zone_m
    world = env.scene.world
    deepest = DeepestContact(hull_of(world))
    mujoco.set_mjcb_control(deepest)
    try:
        done = False
        while not done:
            _record_pose(trial, env)
            trial.steps_in_trap += zone is not None and _inside(zone, trial.positions_m[-1])
            observation, _, terminated, truncated, _ = env.step(next_action(agent, observation, where, env.actions))
            assert env.motion is not None
            trial.motions.append(env.motion)
            done = terminated or truncated
    finally:
        mujoco.set_mjcb_control(None)
    _record_pose(trial, env)
    trial.deepest_m, trial.metrics = deepest.depth_m, env.scene.task.metrics()
    return trial


def _record_pose(trial: Trial, env: ObjectNavEnv) -> None:
    """Appends the pose of the robot to the record."""
    pose = env.scene.world.pose
    trial.positions_m.append((pose.x_m, pose.y_m))
    trial.yaws_rad.append(pose.yaw_rad)


def _inside(zone: tuple[float, float, float, float], place_m: tuple[float, float]) -> bool:
    """Returns whether a point lies in a zone x0, y0, x1, y1."""
    x0, y0, x1, y1 = zone
    return bool(np.all([x0 <= place_m[0] <= x1, y0 <= place_m[1] <= y1]))
