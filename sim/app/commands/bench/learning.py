"""Part (j): steps per second of the environment alone, as in a training, by image size, sensors and environments."""

from __future__ import annotations

import itertools
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace

import gymnasium
import numpy as np

from sim.app.commands.bench.figures import Figure, Goal
from sim.app.commands.bench.growth import memory_mb
from sim.app.commands.bench.stages import Setting
from sim.core.interface import Action, CameraModel
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.splits import load_split

SIZES_PX = ((640, 480), (256, 192), (128, 96), (64, 48))
SENSOR_SETS: tuple[tuple[str, ...], ...] = (("rgb", "depth"), ("depth",), ())
VECTORS = ((1, "sync"), (2, "sync"), (1, "async"), (2, "async"), (4, "async"))
"""Number of environments, and the kind of vector."""
VECTOR_SIZE_PX = (128, 96)
CACHED = 2
"""Number of houses that stay loaded in the measurement with resets."""
ROUNDS = 5
"""Number of rounds; in each round, all cases are measured once, and the fastest round of each case counts."""
_MOVES = (Action.MOVE_FORWARD, Action.MOVE_FORWARD, Action.TURN_LEFT, Action.TURN_RIGHT)


class Walk:
    """An environment in which a robot walks at random; every walk with one seed is the same."""

    def __init__(self, size_px: tuple[int, int], sensors: Sequence[str]) -> None:
        self._env = ObjectNavEnv(split="val", sensors=sensors, camera=_camera(size_px))
        self._episode = self._env.split.episodes[0]
        self._rng = np.random.default_rng(0)
        self._env.reset(seed=0, options={"episode": self._episode})

    def seconds(self, steps: int) -> float:
        """Returns the processor time that the next steps take, without the starts of episodes."""
        spent_s = 0.0
        for _ in range(steps):
            action = _MOVES[self._rng.integers(len(_MOVES))]
            began_s = time.process_time()
            _, _, terminated, truncated, _ = self._env.step(action)
            spent_s += time.process_time() - began_s
            if terminated or truncated:
                self._env.reset(seed=0, options={"episode": self._episode})
        return spent_s

    def close(self) -> None:
        """Frees the renderer."""
        self._env.close()


def steps_of_training(setting: Setting) -> list[Figure]:
    """(j) Measures random steps, without agent: by size and sensors in one process, then of vector environments."""
    return [*_single(setting), *_with_resets(setting), *_vectors(setting)]


def _single(setting: Setting) -> Iterator[Figure]:
    """Yields the rate of one environment for each size and set of sensors, against the largest.

    It is per second of processor time, which depends little on other processes of the machine.
    """
    cases = list(itertools.product(SIZES_PX[: setting.amount.image_sizes], SENSOR_SETS))
    walks = [Walk(size_px, sensors) for size_px, sensors in cases]
    steps = max(1, setting.amount.training_steps // ROUNDS)
    fastest_s = [float("inf")] * len(cases)
    for walk in walks:
        walk.seconds(2)  # compiles, and makes the colour buffer
    for _ in range(ROUNDS):
        for i, walk in enumerate(walks):
            fastest_s[i] = min(fastest_s[i], walk.seconds(steps))
    for walk in walks:
        walk.close()
    first = _words(*cases[0])
    for case, taken_s in zip(cases, fastest_s, strict=True):
        yield _figure(f"steps, {_words(*case)}", steps / taken_s, first, steps / fastest_s[0], steps)


def _with_resets(setting: Setting) -> Iterator[Figure]:
    """Yields the rate of random actions, a quarter of which are STOP, in houses that stay loaded, and their memory.

    The baseline is the rate of steps without STOP in one of the houses.
    """
    houses = load_split("val").houses[: min(CACHED, setting.amount.image_sizes)]
    before = memory_mb()["VmRSS"]
    env = ObjectNavEnv(
        split="val", houses=houses, cached_houses=len(houses), sensors=("depth",), camera=_camera(VECTOR_SIZE_PX)
    )
    goals = {(episode.house, episode.goal): episode for episode in env.split.episodes}
    for episode in list(goals.values())[: setting.amount.training_steps]:
        env.reset(options={"episode": episode})  # loads the house and computes the distances to the goal
    grown_mb = (memory_mb()["VmRSS"] - before) / len(houses)
    walk, steps = Walk(VECTOR_SIZE_PX, ("depth",)), max(1, setting.amount.training_steps // ROUNDS)
    rng, moving_s, with_resets_s = np.random.default_rng(0), float("inf"), float("inf")
    env.reset(seed=0)
    walk.seconds(2)
    for _ in range(ROUNDS):
        moving_s = min(moving_s, walk.seconds(steps))
        began_s = time.process_time()
        for action in rng.integers(len(Action), size=steps).tolist():
            _, _, terminated, truncated, _ = env.step(action)
            if terminated or truncated:
                env.reset()
        with_resets_s = min(with_resets_s, time.process_time() - began_s)
    walk.close()
    env.close()
    words = _size(VECTOR_SIZE_PX)
    figure = _figure(
        f"steps, random with resets, depth, {words}, {len(houses)} houses loaded",
        steps / with_resets_s, "the same, no STOP", steps / moving_s, steps,
    )  # fmt: skip
    yield replace(figure, goal=Goal(of="value", sign=">=", bound=150.0))
    yield Figure(
        part="j", what="memory of a loaded house with all its goals", value=grown_mb, unit="MB",
        against="of the process before", baseline=before, ratio=grown_mb / before, count=len(houses),
    )  # fmt: skip


def _vectors(setting: Setting) -> Iterator[Figure]:
    """Yields the rate of all environments together for each kind of vector, against one environment."""
    steps = max(1, setting.amount.training_steps // ROUNDS)
    rates: list[float] = []
    for number, mode in VECTORS[: setting.amount.vectors]:
        rates.append(_vector_rate(number, mode, steps))
        words = f"steps, {number} x depth, {_size(VECTOR_SIZE_PX)}, {mode}"
        yield _figure(words, rates[-1], "1 of them, sync", rates[0], steps)


def _vector_rate(number: int, mode: str, steps: int) -> float:
    """Returns the steps per second of a vector of environments, all together, in the fastest of the rounds."""
    split = load_split("val")
    house = split.house_file(split.houses[0])
    envs = gymnasium.make_vec(
        "sim.gym:stubborn/ObjectNav-v0",
        num_envs=number,
        vectorization_mode=mode,
        vector_kwargs={"context": "spawn"} if mode == "async" else {},
        house=house,
        sensors=("depth",),
        camera=_camera(VECTOR_SIZE_PX),
    )
    rng, fastest_s = np.random.default_rng(0), float("inf")
    envs.reset(seed=0)
    for _ in range(ROUNDS):
        began_s = time.perf_counter()
        for _ in range(steps):
            envs.step(np.array([_MOVES[i] for i in rng.integers(len(_MOVES), size=number)]))
        fastest_s = min(fastest_s, time.perf_counter() - began_s)
    envs.close()
    return number * steps / fastest_s


def _figure(what: str, value: float, against: str, baseline: float, count: int) -> Figure:
    return Figure(
        part="j", what=what, value=value, unit="/s", against=against, baseline=baseline, ratio=value / baseline,
        count=ROUNDS * count,
    )  # fmt: skip


def _camera(size_px: tuple[int, int]) -> CameraModel:
    return CameraModel(width_px=size_px[0], height_px=size_px[1])


def _size(size_px: tuple[int, int]) -> str:
    return f"{size_px[0]} x {size_px[1]}"


def _words(size_px: tuple[int, int], sensors: Sequence[str]) -> str:
    return f"{' + '.join(sensors) or 'no image'}, {_size(size_px)}"
