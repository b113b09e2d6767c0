"""Part (i): growth of step time and worker memory with house area, geoms, episode length and map size."""

from __future__ import annotations

import itertools
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from sim.app.commands.bench.figures import Figure, Goal
from sim.app.commands.bench.making import write_house
from sim.app.commands.bench.stages import SENSORS, Rig, Setting, stubborn_agent
from sim.app.evaluation.processes import ProcessPool
from sim.app.evaluation.rollout import play_episode
from sim.app.evaluation.workers import RunnerSpec, run_in_pool
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.episode import Episode
from sim.episodes.house_list import copy_textures
from sim.episodes.splits import load_split
from sim.gl import mujoco
from sim.homes.housegen.generator import HouseConfig

AREAS_M2 = (50.0, 100.0, 200.0, 400.0)
GEOMS = (100, 500, 1000, 2000)
MAP_CELLS = (720, 1440, 2880)
_TURN_STEPS = 10
"""Number of steps of one size before the next size has its turn."""
_SEEDS = (3, 4)


def growth(setting: Setting) -> list[Figure]:
    """(i) Returns all figures of growth."""
    return [
        *by_area(setting),
        *by_geoms(setting),
        *by_episode_length(setting),
        *by_map(setting),
        *worker_memory(setting),
    ]


def by_area(setting: Setting) -> list[Figure]:
    """Measures step time against house area, in generated houses of 50 to 400 m2."""
    with tempfile.TemporaryDirectory() as folder:
        copy_textures(Path(folder) / "textures")
        rigs = {}
        for area_m2, seed in itertools.product(AREAS_M2, _SEEDS):
            file = Path(folder) / f"{area_m2:.0f}_{seed}.xml"
            write_house(file, seed, HouseConfig(pool="heldout", area_m2=area_m2))
            rigs[area_m2, seed] = _rig_in(file)
        of_houses = _steps_in_turn(rigs, setting.amount.growth_steps)
    ms = {area_m2: np.concatenate([of_houses[area_m2, seed] for seed in _SEEDS]) for area_m2 in AREAS_M2}
    goals = {400.0: Goal(of="ratio", sign="<=", bound=1.3)}
    return [_grown(f"a step in {area:.0f} m2", ms[area], ms[100.0], "100 m2", goals.get(area)) for area in AREAS_M2]


def by_geoms(setting: Setting) -> list[Figure]:
    """Measures step time against the number of geoms in one hall."""
    with tempfile.TemporaryDirectory() as folder:
        rigs = {}
        for count in GEOMS:
            file = Path(folder) / f"{count}.xml"
            file.write_text(hall(count).to_xml(), encoding="utf-8")
            rigs[count] = _rig_in(file)
        ms = _steps_in_turn(rigs, setting.amount.growth_steps)
    return [_grown(f"a step among {count} geoms", ms[count], ms[GEOMS[0]], f"{GEOMS[0]} geoms") for count in GEOMS[1:]]


def by_episode_length(setting: Setting) -> list[Figure]:
    """Measures step time at the end of long episodes against that at their beginning."""
    env = ObjectNavEnv(split="val", sensors=SENSORS)
    rig = Rig(env, stubborn_agent(env), env.split.episodes, stops=False)
    length = 500 if setting.amount.growth_steps > 50 else 2 * setting.amount.growth_steps
    episodes = 2 if length == 500 else 1
    ms = np.array([sum(rig.step()) for _ in range(episodes * length)]).reshape(episodes, length)
    env.close()
    fifth = length // 5
    early, late = ms[:, fifth : 2 * fifth].reshape(-1), ms[:, -fifth:].reshape(-1)
    what = f"a step, {length - fifth} to {length} steps into an episode"
    return [_grown(what, late, early, f"{fifth} to {2 * fifth} steps into it")]


def by_map(setting: Setting) -> list[Figure]:
    """Measures step time of the agent against the size of its map."""
    env = ObjectNavEnv(split="val", sensors=SENSORS)
    episode = env.split.episodes[:1]
    ms: dict[int, np.ndarray] = {}
    for cells in MAP_CELLS:  # the same steps of the same episode, so that they cannot take turns in one environment
        rig = Rig(env, stubborn_agent(env, map_cells=cells), episode, stops=False)
        ms[cells] = np.array([rig.step()[0] for _ in range(setting.amount.growth_steps)])
    env.close()
    paper = MAP_CELLS[1]
    return [
        _grown(f"the agent's step, map of {cells} x {cells} cells", ms[cells], ms[paper], f"{paper} x {paper}")
        for cells in MAP_CELLS
        if cells != paper
    ]


def worker_memory(setting: Setting) -> list[Figure]:
    """Measures the resident memory of a worker after many episodes against that after its first ones."""
    first = load_split("val").episodes[: setting.amount.memory_episodes]
    episodes = sorted(first, key=lambda episode: episode.house)
    spec = RunnerSpec("sim.app.commands.bench.growth:MemoryRunner", None)
    lines = list(run_in_pool(ProcessPool(spec), episodes, max_workers=1, on_death=_raise))
    settled = lines[min(len(lines) - 1, len(lines) // 5)]["resident_mb"]
    last, peak = lines[-1]["resident_mb"], lines[-1]["peak_mb"]
    goal, flat = Goal(of="value", sign="<=", bound=500.0), Goal(of="ratio", sign="<=", bound=1.1)
    begun = lines[0]["begun_mb"]
    return [
        _memory(f"memory of a worker, at most in {len(lines)} episodes", peak, begun, "before its first episode", goal),
        _memory(f"memory of a worker after {len(lines)} episodes", last, settled, f"after {len(lines) // 5 + 1}", flat),
    ]


class MemoryRunner:
    """Runs episodes and returns the memory of its process; see `sim.app.evaluation.workers.Runner`."""

    def __init__(self, _: None) -> None:
        self._env = ObjectNavEnv(split="val", sensors=SENSORS, max_steps=100)
        self._agent = stubborn_agent(self._env)
        self._begun_mb = memory_mb()["VmRSS"]

    def run(self, episode: Episode) -> dict[str, Any]:
        """Returns resident megabytes: now, the maximum so far, and before the first episode."""
        play_episode(self._env, self._agent, episode, seed=0)
        memory = memory_mb()
        return {"resident_mb": memory["VmRSS"], "peak_mb": memory["VmHWM"], "begun_mb": self._begun_mb}

    def close(self) -> None:
        """Frees the renderer."""
        self._env.close()


def memory_mb() -> dict[str, float]:
    """Returns the resident memory of this process in megabytes: `VmRSS` now, `VmHWM` the maximum."""
    lines = (line.partition(":") for line in Path("/proc/self/status").read_text().splitlines())
    found = {name: rest.split()[0] for name, _, rest in lines if name in ("VmRSS", "VmHWM")}
    return {name: 1024e-6 * int(kilobytes) for name, kilobytes in found.items()}


def hall(geoms: int) -> mujoco.MjSpec:
    """Returns a hall of 12 x 12 m with this number of geoms: walls, floor, a bed, and small boxes along the walls."""
    spec, half_m = mujoco.MjSpec(), 6.0
    world = spec.worldbody
    world.add_light(pos=(0, 0, 2.4), dir=(0, 0, -1))
    world.add_geom(name="floor_00", type=mujoco.mjtGeom.mjGEOM_PLANE, size=(half_m, half_m, 1))
    box = mujoco.mjtGeom.mjGEOM_BOX
    for i, (x, y) in enumerate(((1, 0), (-1, 0), (0, 1), (0, -1))):
        size = (0.05 if x else half_m, 0.05 if y else half_m, 1.25)
        world.add_geom(name=f"wall_{i:02d}", type=box, pos=(x * half_m, y * half_m, 1.25), size=size)
    world.add_geom(name="bed_00", type=box, pos=(3.5, 3.5, 0.25), size=(0.8, 1.0, 0.25))
    rng = np.random.default_rng(0)
    for i in range(geoms - 6):
        along, out = rng.uniform(-5.5, 5.5), rng.uniform(5.4, 5.9)
        x, y = ((along, out), (out, along), (along, -out), (-out, along))[i % 4]
        size = rng.uniform(0.02, 0.08, 3)
        world.add_geom(name=f"objects_{i:04d}", type=box, pos=(x, y, rng.uniform(0.1, 2.0)), size=size)
    site = mujoco.mjtGeom.mjGEOM_BOX
    world.add_site(name="room_living_00", type=site, pos=(0, 0, 1.25), size=(half_m, half_m, 1.25))
    return spec


def _rig_in(file: Path) -> Rig:
    env = ObjectNavEnv(house=file, sensors=SENSORS)
    episodes = [env.draw_episode(np.random.default_rng(i), episode_id=str(i)) for i in range(3)]
    return Rig(env, stubborn_agent(env), episodes, stops=False)


def _steps_in_turn(rigs: Mapping[Any, Rig], steps: int) -> dict[Any, np.ndarray]:
    """Returns milliseconds of agent and environment together, (steps,) per rig; the rigs take turns."""
    ms: dict[Any, list[float]] = {size: [] for size in rigs}
    for rig in rigs.values():
        for _ in range(2):  # compiles code and builds grids
            rig.step()
    while any(len(taken) < steps for taken in ms.values()):
        for size, rig in rigs.items():
            ms[size] += [sum(rig.step()) for _ in range(min(_TURN_STEPS, steps - len(ms[size])))]
    for rig in rigs.values():
        rig.env.close()
    return {size: np.array(taken) for size, taken in ms.items()}


def _grown(what: str, ms: np.ndarray, baseline: np.ndarray, against: str, goal: Goal | None = None) -> Figure:
    value, least = float(np.median(ms)), float(np.median(baseline))
    return Figure(
        part="i", what=what, value=value, unit="ms", against=against, baseline=least, ratio=value / least, goal=goal,
        count=len(ms),
    )  # fmt: skip


def _memory(what: str, value: float, baseline: float, against: str, goal: Goal | None) -> Figure:
    return Figure(
        part="i", what=what, value=value, unit="MB", against=against, baseline=baseline, ratio=value / baseline,
        goal=goal, count=1,
    )  # fmt: skip


def _raise(episode: Episode, reason: str) -> Any:
    raise RuntimeError(f"Episode '{episode.episode_id}': {reason}")
