"""Runs the Stubborn agent in a plan until it sees its goal: its map comes from the plan's camera."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sim.core.geometry.pose import Pose
from sim.core.interface import GOAL_CATEGORIES, CameraModel, Observation, RobotModel
from sim.homes.plans.episode import PlanEpisode
from stubborn.agent import AgentConfig, StubbornAgent
from stubborn.mapping.mapper import Sighting
from stubborn.segmentation.ground_truth import GroundTruthSegmenter


class PlanAgent(StubbornAgent):
    """A `StubbornAgent` whose frames are looks in the plan of an episode."""

    def __init__(self, config: AgentConfig, episode: PlanEpisode) -> None:
        mapping = replace(config.mapping, drops=replace(config.mapping.drops, enabled=False))  # a plan has no drops
        super().__init__(
            camera=CameraModel(),
            robot=RobotModel(),
            segmenter=GroundTruthSegmenter(),
            config=replace(config, mapping=mapping),
        )
        self._episode = episode

    def _map(self, observation: Observation, pose: Pose) -> Sighting:
        """Enters the look from the present pose into the map."""
        episode = self._episode
        look = episode.camera.look(episode.robot.pose, episode.goal, self.navmap, pose)
        episode.see(look)
        if look.touched is not None:
            self.navmap.grow_known(*look.touched)
        cells = np.zeros(0, np.int64)
        return Sighting(cells, cells, np.zeros(0, np.float32))


def explore_until_sight(agent: PlanAgent, episode: PlanEpisode) -> None:
    """Runs an episode until a frame shows its goal, or until its steps are used up."""
    agent.reset(episode.goal, seed=0)
    while not episode.done:
        pose = episode.pose
        observation = {
            "gps": np.array([pose.x_m, pose.y_m], np.float32),
            "compass": np.array([pose.yaw_rad], np.float32),
            "objectgoal": np.array([GOAL_CATEGORIES.index(episode.goal)], np.int64),
        }
        action = agent.act(observation)
        if episode.first_seen_step is not None:
            return
        episode.act(action)
