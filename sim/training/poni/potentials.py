"""Partial maps of a house plan with the true potentials of their frontiers, to train a predictor without interaction.

A walk imitates an exploration: the robot follows shortest paths to places that it has not seen, and its camera fills
the agent's map. Some of these maps become samples. For each frontier of such a map, the area potential is the
share of the unexplored free floor in the connected parts that it borders on, and the object potential of a goal
category falls linearly with the geodesic distance to the nearest place where a STOP for it succeeds (Ramakrishnan et
al. 2022, arXiv:2201.10029, which masks a path by squares instead of camera views).
"""

from __future__ import annotations

import math
import zlib
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float32, Int
from numpy.typing import NDArray

from sim.core.errors import EpisodeError
from sim.core.geometry.fast_marching import travel_times
from sim.core.geometry.grid import GridFrame
from sim.core.geometry.pose import Pose
from sim.core.interface import GOAL_CATEGORIES
from sim.homes.plans.episode import draw_goal_and_start
from sim.homes.plans.plan import Plan
from sim.homes.plans.sight import PlanCamera
from sim.training.plan_env.walks import explore, reachable
from stubborn.agent import AgentConfig
from stubborn.exploration.explorer import Ground
from stubborn.exploration.frontiers import Frontiers
from stubborn.exploration.patches import MapPatch, patch_around
from stubborn.mapping.collision_marks import CollisionConfig, mark_visited
from stubborn.mapping.masks import large_parts, nearest, numbered_parts
from stubborn.mapping.navmap import CollisionLayer, NavMap
from stubborn.planning.avoidance import visited_ground
from stubborn.planning.planner import Planner, PlanningConfig

_NEAR_CELLS = 4
"""A frontier cell of the map belongs to the free cell of the plan that is nearest, at most this far away: 0.2 m."""
_BORDER_CELLS = 7
"""A frontier borders on unexplored free floor within this distance, 0.35 m. Two rooms are farther from each other."""
_DISC = np.argwhere(
    np.hypot(*np.mgrid[-_BORDER_CELLS : _BORDER_CELLS + 1, -_BORDER_CELLS : _BORDER_CELLS + 1]) <= _BORDER_CELLS
)


@dataclass(frozen=True, kw_only=True)
class SampleConfig:
    """Walks, maps and potentials."""

    walks: int = 6
    """Walks in each plan."""
    maps: int = 8
    """Samples of each walk."""
    most_steps: int = 300
    """Actions of a walk."""
    unseen_share: float = 0.8
    """Share of the legs of a walk that lead to a place not seen before; the others lead anywhere."""
    reach_m: float = 5.0
    """The object potential is 0 at this geodesic distance and beyond."""
    cells: int = 128
    """Edge of the patch in blocks."""
    pool: int = 5
    """Edge of a block in map cells: 0.25 m, so that 128 blocks are 32 m."""
    map_cells: int = AgentConfig.map_cells
    """Edge of the map."""
    own_known_m: float = 1.0
    """See `PoniConfig.own_known_m`."""
    least_length_m: float = 0.40
    """Shorter frontiers are left out if a longer one exists."""
    margin_cells: int = 20
    """See `PoniConfig.margin_cells`."""


@dataclass(frozen=True, eq=False)
class Potentials:
    """The frontiers of a map, cell by cell of a patch, and their true potentials."""

    rows: Int[np.ndarray, " n"]
    """Rows of the patch's cells with a frontier."""
    cols: Int[np.ndarray, " n"]
    area: Float32[np.ndarray, " n"]
    """Area potential, in [0, 1]."""
    objects: Float32[np.ndarray, "n goals"]
    """Object potential of each goal category, in [0, 1]."""
    part: Int[np.ndarray, " n"]
    """Number of the connected frontier."""
    path_m: Float32[np.ndarray, " n"]
    """Length of the path from the robot, slow ground counted longer."""


@dataclass(frozen=True, eq=False)
class Sample:
    """A partial map and the potentials of its frontiers."""

    patch: MapPatch
    seen_goals: int
    """Bit g is set where goal category g was seen anywhere on the map."""
    potentials: Potentials


def samples_of(plan: Plan, config: SampleConfig, seed: int) -> Iterator[Sample]:
    """Yields the samples of a plan; the iterator is empty if no goal can be reached."""
    rng = np.random.default_rng([seed, zlib.crc32(plan.name.encode())])  # independent of other plans
    truth, camera = Truth(plan, config), PlanCamera(plan)
    planner = Planner(PlanningConfig(), visited_ground)
    for _ in range(config.walks):
        try:
            _, start = draw_goal_and_start(plan, rng)
        except EpisodeError:
            return
        chosen = set(rng.choice(config.most_steps, size=min(config.maps, config.most_steps), replace=False).tolist())
        navmap = NavMap.empty(GridFrame.around_start(config.map_cells, AgentConfig.cell_m))
        everywhere = reachable(plan, start)
        before = Pose(0.0, 0.0, 0.0)
        walk = explore(camera, start, rng, most_steps=config.most_steps, unseen_share=config.unseen_share)
        for step, (world, moved) in enumerate(walk):
            pose = world.relative_to(start)
            if moved:
                mark_visited(navmap, before, pose, plan.radius_m, CollisionConfig())
            before = pose
            look = camera.look(world, None, navmap, pose)
            if look.touched is not None:
                navmap.grow_known(*look.touched)
            if step in chosen:
                ground = Ground(
                    navmap,
                    navmap.known_window(config.margin_cells),
                    pose,
                    (CollisionLayer.PESSIMISTIC,),
                    planner,
                    GOAL_CATEGORIES[0],
                )
                sample = sample_of(truth, ground, start, everywhere)
                if sample is not None:
                    yield sample


class Truth:
    """The true potentials in one plan."""

    def __init__(self, plan: Plan, config: SampleConfig) -> None:
        self.plan, self.config = plan, config
        self.objects = np.zeros((len(GOAL_CATEGORIES), *plan.frame.shape), np.float32)
        """(goals, rows, cols) Object potential of each goal category at each free cell; 0 without a path."""
        for goal in plan.goals():
            self.objects[GOAL_CATEGORIES.index(goal)] = np.maximum(1.0 - plan.distance_m(goal) / config.reach_m, 0.0)
        self._nearest = nearest(plan.free)

    def free_cells(
        self, x_m: NDArray[np.float64], y_m: NDArray[np.float64]
    ) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.bool_]]:
        """Returns the rows and columns of the free cells nearest to points, and whether they are near."""
        rows, cols = self.plan.frame.cells(x_m, y_m)
        inside = self.plan.frame.contains(rows, cols)
        rows, cols = (np.clip(index, 0, n - 1) for index, n in zip((rows, cols), self.plan.frame.shape, strict=True))
        near = inside & (self._nearest.gap_cells[rows, cols] <= _NEAR_CELLS)
        return self._nearest.rows[rows, cols], self._nearest.cols[rows, cols], near

    def unexplored(
        self, known: Frontiers, start: Pose, everywhere: Bool[np.ndarray, "rows cols"]
    ) -> Bool[np.ndarray, "rows cols"]:
        """Returns the cells of `everywhere` that are unknown on a map."""
        rows, cols = np.nonzero(everywhere)
        x_m, y_m = self.plan.frame.centres(rows, cols)
        dx, dy, cos, sin = x_m - start.x_m, y_m - start.y_m, math.cos(start.yaw_rad), math.sin(start.yaw_rad)
        at = known.free.frame.cells(cos * dx + sin * dy, cos * dy - sin * dx)
        inside = known.free.frame.contains(*at)
        unknown = np.ones(rows.size, np.bool_)
        unknown[inside] = known.unknown[at[0][inside], at[1][inside]]
        unexplored = np.zeros_like(everywhere)
        unexplored[rows, cols] = unknown
        return unexplored


def area_potential(
    unexplored: Bool[np.ndarray, "rows cols"],
    rows: Int[np.ndarray, " n"],
    cols: Int[np.ndarray, " n"],
    part: Int[np.ndarray, " n"],
) -> Float32[np.ndarray, " n"]:
    """Returns the share of the unexplored floor that lies in the connected parts on which each frontier borders.

    Args:
        unexplored: the unexplored free floor of a plan.
        rows: rows of the frontiers' cells.
        cols: their columns.
        part: number of the frontier that each cell belongs to; all cells of a frontier get the same potential.
    """
    labels, sizes = numbered_parts(unexplored)
    sizes = sizes.astype(np.float64)
    sizes[0] = 0.0
    labels = np.pad(labels, _BORDER_CELLS)
    beyond = labels[rows[:, None] + _DISC[:, 0], cols[:, None] + _DISC[:, 1]]
    borders = np.zeros((int(part.max(initial=0)) + 1, sizes.size), np.bool_)
    borders[np.broadcast_to(part[:, None], beyond.shape), beyond] = True
    return (borders @ sizes / max(sizes.sum(), 1.0))[part].astype(np.float32)


def sample_of(truth: Truth, ground: Ground, start: Pose, everywhere: Bool[np.ndarray, "rows cols"]) -> Sample | None:
    """Returns the sample of a map, or None if no frontier is on the patch.

    Args:
        truth: of the plan.
        ground: the map and the robot's pose in the start frame.
        start: the start pose in the world.
        everywhere: the free cells that can be reached from there.
    """
    config = truth.config
    known = Frontiers.of(ground, own_known_m=config.own_known_m, margin_cells=config.margin_cells)
    patch = patch_around(ground.navmap, ground.pose, cells=config.cells, pool=config.pool)
    long = large_parts(known.cells, config.least_length_m / known.free.frame.cell_m)
    frontiers = long if long.any() else known.cells
    parts, _ = numbered_parts(frontiers)
    rows, cols = np.nonzero(frontiers)
    x_m, y_m = known.free.frame.centres(rows, cols)
    at = patch.frame.cells(x_m, y_m)
    cos, sin = math.cos(start.yaw_rad), math.sin(start.yaw_rad)
    plan_rows, plan_cols, near = truth.free_cells(start.x_m + cos * x_m - sin * y_m, start.y_m + sin * x_m + cos * y_m)
    kept = near & patch.frame.contains(*at)
    if not kept.any():
        return None
    part = parts[rows, cols]
    unexplored = truth.unexplored(known, start, everywhere)
    area = np.zeros(rows.size, np.float32)
    area[near] = area_potential(unexplored, plan_rows[near], plan_cols[near], part[near])
    here = np.zeros(known.free.frame.shape, np.bool_)
    here[known.free.frame.cell(ground.pose.x_m, ground.pose.y_m)] = True
    path_m = travel_times(here, known.free.reachable, known.free.speed, known.free.frame.cell_m)[rows, cols]
    block = (at[0] * config.cells + at[1])[kept]
    order = np.argsort(path_m[kept], kind="stable")  # of several frontier cells of a block, the nearest one counts
    blocks, first = np.unique(block[order], return_index=True)
    chosen = np.flatnonzero(kept)[order][first]
    objects = truth.objects[:, plan_rows[chosen], plan_cols[chosen]].T
    potentials = Potentials(
        blocks // config.cells, blocks % config.cells, area[chosen], objects, part[chosen], path_m[chosen]
    )
    seen_goals = int(np.bitwise_or.reduce(ground.navmap.goals_seen[known.window.index], axis=None))
    return Sample(patch, seen_goals, potentials)
