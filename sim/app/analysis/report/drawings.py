"""Collects the drawings of a page as JSON types: plans of houses, success areas of goals, and paths of robots."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import NotRequired, TypedDict

import numpy as np
from numpy.typing import NDArray

from sim.app.analysis.comparison import Run
from sim.app.analysis.report.plans import PX_M, Plan, Sheet, draw_area, draw_plan, sheet_around
from sim.core.configuration import with_fields
from sim.core.errors import EpisodeError, HouseError
from sim.core.geometry.grid import runs_of
from sim.core.interface import CameraModel, ConfigError, RobotModel, SuccessRule
from sim.episodes.splits import Split, load_split, one_house
from sim.houses.house import House, read_rooms
from sim.robot.config import RobotConfig
from sim.robot.foreign import load_robot
from sim.task.explanations import marks
from sim.task.ground_truth import GroundTruth
from sim.task.metrics import EXPLORED_SHARE
from sim.task.trajectory import Trajectory, read_trajectory, trajectory_file
from sim.world.world import World

Trajectories = Mapping[str, Sequence[Trajectory | None]]
"""Trajectories by episode, one for each run."""
HouseTruth = GroundTruth | None
"""Ground truth of a house; None if the house cannot be loaded."""


def split_of(run: Run) -> Split:
    """Returns the split of a run, or a split with its one house.

    Raises:
        ConfigError: the split does not exist or has another version now.
        HouseError: the one house does not exist.
    """
    config = run.config
    house = config.get("house")
    split = (
        one_house(house, labels=config.get("labels"), root=config.get("root"))
        if house
        else load_split(run.recorded("split"))
    )
    if split.sha256 != run.recorded("split_identity")["sha256"]:
        raise ConfigError(f"'{run.path}' was run in another version of '{split.name}' than the present one.")
    return split


def read_trajectories(runs: Sequence[Run], episode_ids: Sequence[str]) -> tuple[Trajectories, list[str]]:
    """Returns the existing trajectories, and sentences about files that cannot be read."""
    problems: list[str] = []

    def read(run: Run, episode_id: str) -> Trajectory | None:
        file = trajectory_file(run.path, episode_id)
        try:
            return read_trajectory(file) if file.is_file() else None
        except ConfigError as error:
            problems.append(str(error))
            return None

    return {i: [read(run, i) for run in runs] for i in episode_ids}, problems


class DrawnPath(TypedDict):
    """A trajectory on a sheet; `x`, `y` and `a` are the first value, then differences."""

    x: list[int]
    y: list[int]
    """Page units."""
    a: list[int]
    """Heading in degrees, clockwise on the page."""
    d: list[int | None]
    """Distance to the goal in decimetres; None: no path."""
    actions: str
    """One digit per action."""
    hits: list[list[int]]
    """Step, x and y of each contact that stopped a motion."""
    stopped: list[int]
    """The steps of these contacts."""
    seen: list[list[int]]
    """[first, last] of each span of steps with the goal in view."""
    robot: int
    """Radius of the robot in page units."""
    marks: NotRequired[list[list[str | int | None]]]
    """Kind, step, last step and text of each mark."""


@dataclass(frozen=True)
class Drawings:
    """All drawings of a page; those that several episodes share are stored once."""

    plans: dict[str, Plan] = field(default_factory=dict)
    """Plans by house and storey (`sim.app.analysis.report.plans.draw_plan`)."""
    areas: dict[str, str] = field(default_factory=dict)
    """The area where a STOP succeeds, by plan and goal."""
    episodes: dict[str, dict[str, object]] = field(default_factory=dict)
    """Drawings by episode id: the names of plan and area, the shortest path, and a path for each run."""
    house_m2: dict[str, float | None] = field(default_factory=dict)
    """Floor area of all rooms of each house; None if the house declares none."""

    def add(
        self, runs: Sequence[Run], episode_id: str, trajectories: Sequence[Trajectory | None], truth: HouseTruth
    ) -> None:
        """Draws one episode, with its house if that could be loaded."""
        existing = [trajectory for trajectory in trajectories if trajectory is not None]
        if truth is None:
            sheet = sheet_around(np.vstack([trajectory.positions_m for trajectory in existing]))
            episode: dict[str, object] = {"size": sheet.size_px}
            radius_m = RobotModel().radius_m
        else:
            result, floor_z_m = runs[0].results[episode_id], float(existing[0].poses[0, 3])
            sheet = Sheet(truth.space(floor_z_m).frame)
            plan = f"{result.house}@{floor_z_m:g}"
            if plan not in self.plans:
                self.plans[plan] = draw_plan(truth, floor_z_m)
            start_m, radius_m = existing[0].positions_m[0].tolist(), truth.world.robot.radius_m
            episode = {"plan": plan, **self._target(truth, plan, result.goal, floor_z_m, start_m)}
        episode["paths"] = [
            None
            if trajectory is None
            else {**path_on(sheet, trajectory, radius_m=radius_m), "marks": _marks(run, episode_id, trajectory)}
            for run, trajectory in zip(runs, trajectories, strict=True)
        ]
        self.episodes[episode_id] = episode

    def _target(
        self, truth: GroundTruth, plan: str, goal: str, floor_z_m: float, start_m: Sequence[float]
    ) -> dict[str, object]:
        """Draws the area where a STOP succeeds and the shortest path to it, if the house has the goal."""
        try:
            target = truth.target(goal, floor_z_m)
        except EpisodeError:
            return {"goal": goal}
        space, area = truth.space(floor_z_m), f"{plan}/{goal}"
        if area not in self.areas:
            self.areas[area] = draw_area(space, target.reached)
        shortest = space.path(target.distance_m, start_m[0], start_m[1])
        line = [] if shortest is None else Sheet(space.frame).place(shortest).reshape(-1).tolist()
        return {"goal": goal, "area": area, "shortest": line}


def draw_episodes(runs: Sequence[Run], trajectories: Trajectories) -> tuple[Drawings, list[str]]:
    """Returns drawings of the episodes with a trajectory in some run, and sentences about houses without a drawing.

    Episodes in houses that do not exist any more, or have changed, are shown without a plan.
    """
    drawings, problems = Drawings(), []
    split, robot = None, None
    try:
        split, robot = split_of(runs[0]), robot_of(runs[0])
    except (ConfigError, HouseError) as error:
        problems.append(f"The houses are not shown, and their sizes are unknown: {error}")
    for house, episode_ids in _by_house(runs[0], trajectories).items():
        recorded = [i for i in episode_ids if any(trajectory is not None for trajectory in trajectories[i])]
        truth: HouseTruth = None
        if split is not None:
            try:
                loaded = split.load_house(house)
                truth = ground_truth_of(runs[0], loaded, robot) if recorded else None
                rooms = truth.world.rooms if truth is not None else read_rooms(loaded.spec.copy().compile())
                drawings.house_m2[house] = sum(room.area_m2 for room in rooms) or None
            except (ConfigError, HouseError) as error:
                problems.append(f"House '{house}' is not shown, and its size is unknown: {error}")
        for episode_id in recorded:
            drawings.add(runs, episode_id, trajectories[episode_id], truth)
    return drawings, problems


def _by_house(run: Run, episode_ids: Iterable[str]) -> dict[str, list[str]]:
    """Returns the episodes of each house, houses by name."""
    houses: dict[str, list[str]] = {}
    for episode_id in sorted(episode_ids, key=lambda i: run.results[i].house):
        houses.setdefault(run.results[episode_id].house, []).append(episode_id)
    return houses


def ground_truth_of(run: Run, house: House, robot: RobotConfig | None = None) -> GroundTruth:
    """Returns the ground truth of a house with the success rule, the camera and the robot of a run.

    `robot` is `robot_of(run)`, where it is known already.
    """
    tree = run.config.get("config", {})
    success = with_fields(SuccessRule(), tree.get("task", {}).get("success", {}))
    camera = with_fields(CameraModel(), tree.get("camera", {}))
    return GroundTruth(World(house, robot=robot or robot_of(run), rule=success), success=success, camera=camera)


def robot_of(run: Run) -> RobotConfig:
    """Returns the robot of a run: the default robot or that of `--robot`, with the fields that `--config` changed."""
    file = run.config.get("robot")
    recorded = run.config.get("config", {}).get("robot", {})
    root = (recorded.get("file") or {}).get("root")
    robot = load_robot(file, root=Path(root) if root else None)[0] if file else RobotConfig()
    return with_fields(robot, {name: value for name, value in recorded.items() if name != "file"})


def path_on(sheet: Sheet, trajectory: Trajectory, *, radius_m: float) -> DrawnPath:
    """Returns a trajectory on a sheet, of a robot with this radius."""
    places = sheet.place(trajectory.positions_m)
    degrees = np.rad2deg(-np.unwrap(trajectory.poses[:, 2].astype(np.float64))).round().astype(np.int64)
    distances = [round(10.0 * d) if np.isfinite(d) else None for d in trajectory.distance_m.tolist()]
    hits = np.column_stack([trajectory.contacts[:, 0].astype(np.int64), sheet.place(trajectory.contacts[:, 1:])])
    return {
        "x": _differences(places[:, 0]),
        "y": _differences(places[:, 1]),
        "a": _differences(degrees),
        "d": distances,
        "actions": "".join(map(str, trajectory.actions.tolist())),
        "hits": np.unique(hits, axis=0).tolist(),
        "stopped": np.flatnonzero(trajectory.collided).tolist(),
        "seen": [[first, end - 1] for first, end in runs_of(trajectory.goal_share >= EXPLORED_SHARE)],
        "robot": round(radius_m * PX_M),
    }


def _marks(run: Run, episode_id: str, trajectory: Trajectory) -> list[list[str | int | None]]:
    moments = marks(run.results[episode_id], trajectory)
    return [[mark.kind, mark.step, mark.until, mark.words] for mark in moments]


def _differences(values: NDArray[np.integer]) -> list[int]:
    return np.diff(values, prepend=0).tolist()
