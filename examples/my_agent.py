"""An agent of your own: `stubborn run --agent examples.my_agent:AGENT --config agent.keep_m=1.0`.

It drives until something is near, turns to the side with more room, and stops when the goal fills the view. A plain
factory does as well: `--agent examples.my_agent:make`.
"""

from dataclasses import dataclass

import numpy as np

from sim import Action, AgentSpec, CameraModel, Observation, RobotModel, Segmenter


@dataclass(frozen=True)
class WandererConfig:
    """The agent's options."""

    keep_m: float = 0.8
    """It turns where the depth straight ahead is less than this."""
    goal_share: float = 0.15
    """It stops when the goal covers this share of the image."""


class Wanderer:
    """Decides from the current frame alone."""

    def __init__(self, segmenter: Segmenter, config: WandererConfig) -> None:
        self.segmenter, self.config = segmenter, config

    def reset(self, goal: str, seed: int) -> None:
        """Starts a new episode."""
        self.goal, self.turn, self.rng = goal, Action.TURN_LEFT, np.random.default_rng(seed)

    def act(self, observation: Observation) -> Action:
        """Stops at the goal, turns away from what is near, else goes forward."""
        depth = observation["depth"]  # (h, w) metres; 0: no distance, or nearer than 0.5 m
        target = self.segmenter.scores(observation, self.goal).target > 0.5
        if target.mean() > self.config.goal_share:
            return Action.STOP
        middle, third = depth[depth.shape[0] // 2], depth.shape[1] // 3
        if np.min(middle[third:-third]) > self.config.keep_m and self.rng.random() > 0.05:
            self.turn = Action.TURN_LEFT if middle[:third].mean() > middle[-third:].mean() else Action.TURN_RIGHT
            return Action.MOVE_FORWARD
        return self.turn


def make(
    *, camera: CameraModel, robot: RobotModel, segmenter: Segmenter, config: WandererConfig | None, **others: object
) -> Wanderer:
    """Returns the agent; `others` are the parts of `AgentFactory` that it does not use."""
    return Wanderer(segmenter, config or WandererConfig())


AGENT = AgentSpec(make=make, description="drives at random", config=WandererConfig(), sensors=("depth",))
