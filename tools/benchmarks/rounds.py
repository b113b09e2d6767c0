"""The worker of `tools.benchmarks.against`: runs rounds of one version of the code, one at each line of input.

    PYTHONPATH=FOLDER python tools/benchmarks/rounds.py PART ...

FOLDER holds that version. Only names that each version has are used. Each line of stdin is the name of a part; the
answer is a line with the seconds of processor time of one step, image, house or start.
"""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from itertools import cycle
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sim import ObjectNavEnv

STEPS = 20
"""Number of steps or images in a round."""


def steps() -> Iterator[float]:
    """Runs whole steps of `stubborn` with ground-truth segmentation; four rounds are in one episode."""
    from stubborn import agents
    from stubborn.segmentation.ground_truth import GroundTruthSegmenter

    env = _env("depth", "semantic")
    agent = agents.make(
        "stubborn", camera=env.camera_model, robot=env.robot_model, segmenter=GroundTruthSegmenter()
    )  # fmt: skip
    for episode in cycle(env.split.episodes[:12]):
        observation, _ = env.reset(seed=0, options={"episode": episode})
        agent.reset(episode.goal, 0)
        for _ in range(4):
            began_s = time.process_time()
            for _ in range(STEPS):
                observation, *_ = env.step(agent.act(observation) or 2)  # a turn in place of STOP
            yield (time.process_time() - began_s) / STEPS


def images() -> Iterator[float]:
    """Turns in place: colour, depth and segmentation."""
    env = _env("rgb", "depth", "semantic")
    for episode in cycle(env.split.episodes[:12]):
        env.reset(seed=0, options={"episode": episode})
        began_s = time.process_time()
        for _ in range(STEPS):
            env.step(2)
        yield (time.process_time() - began_s) / STEPS


def houses() -> Iterator[float]:
    """Starts an episode in a house that is not loaded, and turns once."""
    env = _env("depth", "semantic")
    firsts = {episode.house: episode for episode in reversed(env.split.episodes)}
    for episode in cycle(firsts.values()):
        began_s = time.process_time()
        env.reset(seed=0, options={"episode": episode})
        env.step(2)
        yield time.process_time() - began_s


def starts() -> Iterator[float]:
    """Lists the agents in a process of its own."""
    while True:
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([sys.executable, "-m", "sim.run", "--list-agents"], check=True, stdout=subprocess.DEVNULL)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        yield after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


PARTS: dict[str, Callable[[], Iterator[float]]] = {
    "steps": steps, "images": images, "houses": houses, "starts": starts,
}  # fmt: skip


def _env(*sensors: str) -> ObjectNavEnv:
    from sim import ObjectNavEnv

    return ObjectNavEnv(split="val", sensors=sensors)


def main() -> None:
    """Begins the parts, then runs a round of one at each line of input."""
    rounds = {name: PARTS[name]() for name in sys.argv[1:]}
    for line in sys.stdin:
        print(next(rounds[line.strip()]), flush=True)


if __name__ == "__main__":
    os.environ |= {"LP_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    main()
