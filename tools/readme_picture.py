"""Makes the picture of the README: the robot's view, its segmentation, and the agent's map with path and goal.

python tools/readme_picture.py --episode-id <id> --step 60 --out docs/images/episode.png
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from sim import cli
from sim.env.objectnav import ObjectNavEnv
from sim.evaluation.rollout import episode_seed
from sim.files import write_picture
from sim.viewers.palette import with_legend
from stubborn import draw
from stubborn.agent import StubbornAgent
from stubborn.segmentation.ground_truth import GroundTruthSegmenter


@dataclass(frozen=True, kw_only=True)
class Args:
    """Run an episode up to a step and draw camera, segmentation and map."""

    split: str = "val"
    """Split of the episode."""
    episode_id: str | None = None
    """Id of the episode; the first of the split if not given."""
    step: cli.Amount = 40
    """Number of actions before the picture; fewer if the episode ends earlier."""
    profile: str = "good"
    """Rendering quality of the picture."""
    out: cli.OutFile = Path("docs/images/episode.png")
    """The PNG file."""


def main(args: Args) -> int:
    """Writes the picture; returns the exit status."""
    env = ObjectNavEnv(split=args.split, sensors=("rgb", "depth", "semantic"), profile=args.profile)
    try:
        picture = np.hstack(panels(env, args))
    finally:
        env.close()
    write_picture(args.out, picture)
    print(f"{args.out}: {picture.shape[1]} x {picture.shape[0]} pixels")
    return 0


def panels(env: ObjectNavEnv, args: Args) -> list[NDArray[np.uint8]]:
    """Returns camera image, segmentation and map at the same height, uint8 (h, w, 3) each."""
    episode = env.split.episode(args.episode_id) if args.episode_id else env.split.episodes[0]
    observation, _ = env.reset(options={"episode": episode})
    agent = StubbornAgent(camera=env.camera_model, robot=env.robot_model, segmenter=GroundTruthSegmenter())
    agent.reset(episode.goal, episode_seed(0, episode.episode_id))
    action, done, steps = agent.act(observation), False, 0
    while not done and steps < args.step:
        observation, _, terminated, truncated, _ = env.step(action)
        steps, done = steps + 1, terminated or truncated
        if not done:
            action = agent.act(observation)
    print(f"{episode.episode_id}: looking for {episode.goal}, {steps} steps")
    height = observation["rgb"].shape[0]
    belief = draw.draw_map(agent)
    width = round(belief.shape[1] * height / belief.shape[0])
    belief = np.asarray(cv2.resize(belief, (width, height), interpolation=cv2.INTER_AREA), np.uint8)
    return [observation["rgb"], with_legend(observation["semantic"]), belief]


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
