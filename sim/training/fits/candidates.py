"""Records the candidates that an agent finds, with the truth: the data of the verifier's fit."""

from __future__ import annotations

from collections.abc import Callable

from sim.core.errors import EpisodeError, PhysicsError
from sim.core.interface import Observation, Segmenter
from sim.core.reading import Number
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.episode import Episode
from sim.training.fits.log_line import LogLine
from stubborn.agent import AgentConfig, StubbornAgent
from stubborn.detection.classifiers import Features
from stubborn.detection.distances import TargetConfig

NEVER = 1_000_000
"""A step that no episode reaches."""


class CandidateLine(LogLine, frozen=True, kw_only=True):
    """A line of the log."""

    candidates: tuple[tuple[Number, Number, Number, Number, Number, Number, Number], ...] = ()


class CandidateRecorder:
    """Runs whole episodes as the verifier of an agent, which rejects every candidate and records it with the truth.

    Candidates that are verified from too far away to stop (`Approach.near_enough` is False) are not recorded: a STOP
    fails there at a true instance too, which would be recorded as a false candidate.
    """

    may_refuse = True

    def __init__(self, env: ObjectNavEnv, segmenter: Segmenter) -> None:
        self._env = env
        self.candidates: list[list[float]] = []
        """Those of the last episode: features; 1 where a STOP would have succeeded, else 0; the robot's x and y in
        metres."""
        self.agent = StubbornAgent(
            camera=env.camera_model,
            robot=env.robot_model,
            success=env.success_rule,
            segmenter=segmenter,
            verifier=self,
            config=AgentConfig(target=TargetConfig(verify_until_step=NEVER, last_resort_step=NEVER)),
        )

    def accepts(self, goal: str, features: Features) -> bool:
        """Records the candidate and returns False."""
        approach = self.agent.approach
        if approach is not None and not approach.near_enough:
            return False
        world, task = self._env.scene.world, self._env.scene.task
        x_m, y_m, floor_z_m = world.pose.x_m, world.pose.y_m, world.pose.floor_z_m
        truth = task.truth.succeeds_now(goal, x_m, y_m, floor_z_m)
        self.candidates.append([round(float(value), 4) for value in (*features, truth, x_m, y_m)])
        return False

    def would_accept(self, goal: str, features: Features) -> bool:
        """Returns False and records nothing, so that the nearest candidate is visited first."""
        return False

    def run(self, episode: Episode, seed: int) -> int:
        """Runs an episode to its last step; returns the number of its steps, 0 if it failed."""
        self.candidates = []
        ran = run_whole(self._env, self.agent, episode, seed)
        return self._env.scene.task.num_steps if ran else 0


def run_whole(
    env: ObjectNavEnv,
    agent: StubbornAgent,
    episode: Episode,
    seed: int,
    after_choice: Callable[[Observation], None] | None = None,
) -> bool:
    """Runs an episode with an agent that accepts nothing, to its last step; returns False if it failed."""
    try:
        observation, _ = env.reset(seed=seed, options={"episode": episode})
        agent.reset(episode.goal, seed)
        ended = False
        while not ended:
            action = agent.act(observation)
            if after_choice is not None:
                after_choice(observation)
            observation, _, terminated, truncated, _ = env.step(action)
            ended = terminated or truncated
    except (EpisodeError, PhysicsError):
        return False
    return True
