"""An agent of your own in thirty lines: `python -m sim.run --agent examples.my_agent:make`.

It walks until something is near, turns to the side with more room, and stops when the goal fills the view.
"""

import numpy as np

from sim.interface import Action, CameraModel, Observation, RobotModel, Segmenter


class Wanderer:
    """Knows only what it sees right now."""

    def __init__(self, camera: CameraModel, robot: RobotModel, segmenter: Segmenter) -> None:
        self.camera, self.robot, self.segmenter = camera, robot, segmenter

    def reset(self, goal: str, seed: int) -> None:
        """A new episode: remember what to look for."""
        self.goal, self.turn, self.rng = goal, Action.TURN_LEFT, np.random.default_rng(seed)

    def act(self, observation: Observation) -> Action:
        """Stop at the goal, avoid what is near, else walk on."""
        depth = observation["depth"]  # (h, w) metres; 0 is nothing or nearer than 0.5 m
        target = self.segmenter.scores(observation, self.goal).target > 0.5
        if target.mean() > 0.15:
            return Action.STOP
        middle, third = depth[depth.shape[0] // 2], depth.shape[1] // 3
        if np.min(middle[third:-third]) > 0.8 and self.rng.random() > 0.05:
            self.turn = Action.TURN_LEFT if middle[:third].mean() > middle[-third:].mean() else Action.TURN_RIGHT
            return Action.MOVE_FORWARD
        return self.turn


def make(*, camera: CameraModel, robot: RobotModel, segmenter: Segmenter, **options: object) -> Wanderer:
    """The factory that `--agent examples.my_agent:make` calls."""
    return Wanderer(camera, robot, segmenter)
