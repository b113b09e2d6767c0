"""Part (k): the start of a command, and the first step of an episode in a house that was not loaded before."""

from __future__ import annotations

import resource
import subprocess
import sys
from collections.abc import Callable

import numpy as np

from sim.app.commands.bench.figures import Figure, Goal, timed
from sim.app.commands.bench.stages import SENSORS, Setting
from sim.core.interface import Action
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.splits import load_split
from sim.world.world import World

LISTING, PLAIN = ("-m", "sim.run", "--list-agents"), ("-c", "import numpy, rich, tyro")


def starts(setting: Setting) -> list[Figure]:
    """(k) Measures the start of a command, and the first step in a new house."""
    return [command(setting), first_step(setting)]


def command(setting: Setting) -> Figure:
    """Measures the processor time of a command that runs no episode, against the import of its libraries."""
    ours_ms, plain_ms = [], []
    for _ in range(1 + setting.amount.starts):  # the first reads the files from disk
        ours_ms.append(_cpu_ms(LISTING))
        plain_ms.append(_cpu_ms(PLAIN))
    value, baseline = float(np.median(ours_ms[1:])), float(np.median(plain_ms[1:]))
    return Figure(
        part="k", what="stubborn run --list-agents, processor time", value=value, unit="ms",
        against="import numpy, rich, tyro", baseline=baseline, ratio=value / baseline,
        goal=Goal(of="value", sign="<=", bound=700.0), count=setting.amount.starts,
    )  # fmt: skip


def first_step(setting: Setting) -> Figure:
    """Measures reset and first step in new houses, against reading and compiling the same house."""
    split = load_split("val")
    firsts = {episode.house: episode for episode in reversed(split.episodes)}
    env = ObjectNavEnv(split="val", sensors=SENSORS)
    ours_ms, plain_ms = [], []
    for house in split.houses[: 1 + setting.amount.starts]:
        plain_ms.append(timed(lambda house=house: World(split.load_house(house))))
        ours_ms.append(timed(_first_step(env, firsts[house])))
    env.close()
    value, baseline = float(np.median(ours_ms[1:])), float(np.median(plain_ms[1:]))
    return Figure(
        part="k", what="the first step in a new house", value=value, unit="ms", against="to read and compile it",
        baseline=baseline, ratio=value / baseline, goal=Goal(of="value", sign="<=", bound=1000.0),
        count=len(ours_ms) - 1,
    )  # fmt: skip


def _first_step(env: ObjectNavEnv, episode: object) -> Callable[[], object]:
    def run() -> None:
        env.reset(seed=0, options={"episode": episode})
        env.step(Action.TURN_LEFT)

    return run


def _cpu_ms(words: tuple[str, ...]) -> float:
    """Returns the processor time of Python with these arguments."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([sys.executable, *words], check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return 1e3 * (after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
