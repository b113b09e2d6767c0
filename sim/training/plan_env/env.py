"""Gymnasium environments in house plans: ObjectNav without rendering and without MuJoCo, for training explorers."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal, TypeVar

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from sim.core.errors import ConfigError, EpisodeError
from sim.core.geometry.grid import GridFrame, Window
from sim.core.geometry.pose import Pose
from sim.core.interface import GOAL_CATEGORIES, MAX_STEPS, MOVES, Action, require_action
from sim.core.invocation import command
from sim.homes.plans.episode import PlanEpisode, draw_goal, draw_goal_and_start
from sim.homes.plans.motion_kernels import mark_square, mark_swept
from sim.homes.plans.plan import Plan, read_plan
from sim.homes.plans.sight import PlanCamera, SightConfig
from stubborn.agent import AgentConfig
from stubborn.exploration.explorer import planned
from stubborn.exploration.patches import or_of_blocks
from stubborn.exploration.semexp import head_for
from stubborn.mapping.collision_marks import CollisionConfig, is_collision
from stubborn.mapping.navmap import CollisionLayer, NavMap
from stubborn.planning.avoidance import visited_ground
from stubborn.planning.planner import Planner, PlanningConfig, Route
from stubborn.planning.steering import next_action
from stubborn.planning.untrap import Untrap, UntrapConfig

T = TypeVar("T")
LAYERS = ("seen_obstacle", "in_view", "visited", "trail", "pessimistic_marks", "optimistic_marks", "target")
"""The layers of an observation, in their order: those of `stubborn.mapping.navmap.NavMap`; `in_view` is True where
`frames_in_view` is not 0, `target` where `score_max` is above 0.5."""
_PLANNED_ON = ("seen_obstacle", "pessimistic_marks", "visited", "trail")
"""The layers that routes depend on; a plan has no drops."""


@dataclass(frozen=True, kw_only=True)
class PlanEnvConfig:
    """Options of `PlanEnv`."""

    actions: Literal["primitive", "goal"] = "primitive"
    """`primitive`: the four actions of the task. `goal`: a goal cell that the agent's planner heads for."""
    goal_steps: int = 25
    """Primitive actions towards one goal."""
    plan_every: int = 5
    """Primitive actions between two plans, unless a collision comes before; 1: as the agent does."""
    plan_pool: int = 1
    """Map cells along the edge of a cell of the grid that is planned on; 1: as the agent does. With 2 a plan takes a
    quarter of the time, and obstacles grow by up to a map cell."""
    arrived_m: float | None = None
    """With `actions="goal"`, a step also ends when the path to the goal is not longer than this. A robot that is
    already there, because it is enclosed, plans on the small collision marks, and otherwise moves for one action. None:
    all `goal_steps` are used."""
    ends_at_sight: bool = False
    """True: the episode ends with the first frame that shows the target by the rule of GT exploration."""
    max_steps: int = MAX_STEPS
    """Primitive actions of an episode."""
    cell_m: float = AgentConfig.cell_m
    """Edge of a cell of the map."""
    map_cells: int = AgentConfig.map_cells
    """Edge of the map."""
    window_cells: int = AgentConfig.window_cells
    """Edge of the window around the robot that is observed and planned on."""
    goal_radius_m: float = 0.5
    """Largest distance of an acceptable cell from the goal."""
    sight: SightConfig = field(default_factory=SightConfig)
    planning: PlanningConfig = field(default_factory=PlanningConfig)
    collisions: CollisionConfig = field(default_factory=CollisionConfig)
    untrap: UntrapConfig = field(default_factory=UntrapConfig)

    def __post_init__(self) -> None:
        if self.actions not in ("primitive", "goal"):
            raise ConfigError(f"PlanEnvConfig.actions must be 'primitive' or 'goal', got {self.actions!r}.")
        if min(self.goal_steps, self.plan_every, self.max_steps) < 1:
            raise ConfigError(
                f"PlanEnvConfig needs goal_steps, plan_every and max_steps >= 1, got {self.goal_steps}, "
                f"{self.plan_every} and {self.max_steps}."
            )
        if self.plan_pool < 1 or self.window_cells % self.plan_pool or self.map_cells % self.plan_pool:
            raise ConfigError(
                f"PlanEnvConfig.plan_pool must be >= 1 and divide window_cells and map_cells, got {self.plan_pool}."
            )


class PlanEnv(gymnasium.Env[Any, Any]):
    """Find an object of a category in the plan of an apartment.

    ## Actions
    With `actions="primitive"`, `Discrete(4)`: those of `stubborn/ObjectNav-v0`. With `actions="goal"`, `Box(2)` in
    [0, 1]: row and column of a goal in the window, 0 at its first edge and 1 at its last; the planner of `stubborn`
    drives towards it for `goal_steps` primitive actions, or to the nearest reachable cell if no path exists. With
    `arrived_m` it stops earlier when it is there.

    ## Observations
    A dict: `layers` uint8 (7, window, window), 0 or 1, in the order of `LAYERS`; `goals_seen` uint32 (window, window),
    bit g where goal category g was in view; `pose` float32 (3,), metres forward and left of the start pose and
    heading; `objectgoal` int64 (1,). The window keeps the axes of the start frame, rows are its y; the robot is in the
    middle.

    ## Reward
    Metres by which the action shortened the path to the nearest place where a STOP succeeds.

    ## End
    `terminated` at STOP and, with `ends_at_sight`, when the target was seen; `truncated` after `max_steps` primitive
    actions.

    ## Starting state
    `reset(seed=...)` samples a plan, a goal in it and a start;
    `reset(options={"plan": 3, "goal": "bed", "start": pose})` fixes all or some of them; a start needs its
    plan. The goal can be reached from the start, unless both are fixed.

    ## Info
    The metrics of `sim.homes.plans.episode.PlanEpisode`, and `house` and `goal`.

    Args:
        plans: plan files (`stubborn houses plans`), or a folder of them.
        config: all other options.
        read: returns the plan in a file. Environments that share a cached one hold each plan in memory once.

    Raises:
        ConfigError: no plan is given.
    """

    metadata: dict[str, Any] = {"render_modes": []}  # noqa: RUF012 - declared by Gymnasium

    def __init__(
        self,
        plans: str | Path | Sequence[Path],
        config: PlanEnvConfig | None = None,
        *,
        read: Callable[[Path], Plan] | None = None,
    ) -> None:
        self.config = config or PlanEnvConfig()
        self._read = read or functools.cache(read_plan)
        self.files = sorted(Path(plans).glob("*.npz")) if isinstance(plans, str | Path) else list(plans)
        if not self.files:
            where = f" in '{plans}'" if isinstance(plans, str | Path) else ""
            raise ConfigError(f"No plan{where}: `{command('houses', 'plans')}` writes them.")
        self._camera: tuple[int, PlanCamera] | None = None
        self._frame = GridFrame.around_start(self.config.map_cells, self.config.cell_m)
        self._planner = Planner(self.config.planning, visited_ground)
        size, pool = self.config.window_cells, self.config.plan_pool
        self._pooled = NavMap.empty(GridFrame.around_start(size // pool, pool * self._frame.cell_m))
        self.observation_space = spaces.Dict(
            {
                "layers": spaces.Box(0, 1, (len(LAYERS), size, size), np.uint8),
                "goals_seen": spaces.Box(0, 2**32 - 1, (size, size), np.uint32),
                "pose": spaces.Box(-np.inf, np.inf, (3,), np.float32),
                "objectgoal": spaces.Box(0, len(GOAL_CATEGORIES) - 1, (1,), np.int64),
            }
        )
        primitive = self.config.actions == "primitive"
        self.action_space = spaces.Discrete(len(MOVES)) if primitive else spaces.Box(0.0, 1.0, (2,), np.float32)
        self._episode: PlanEpisode | None = None
        self._navmap: NavMap | None = None
        self._untrap = Untrap(self.config.untrap.failed_forwards, turns_reset=self.config.untrap.turns_reset)
        self._pose = Pose(0.0, 0.0, 0.0)
        """The robot's pose in the start frame."""
        self._last: Action | None = None
        self._failed = False
        """True: the last action was a forward that ended in a collision."""

    @property
    def episode(self) -> PlanEpisode:
        """The running episode; raises ResetNeeded before the first reset."""
        return require_reset(self._episode)

    @property
    def navmap(self) -> NavMap:
        """The agent's map; raises ResetNeeded before the first episode."""
        return require_reset(self._navmap)

    def camera(self, number: int) -> PlanCamera:
        """Returns the camera of a plan."""
        if self._camera is None or self._camera[0] != number:
            self._camera = number, PlanCamera(self._read(self.files[number]), self.config.sight)
        return self._camera[1]

    def reset(
        self, *, seed: int | None = None, options: Mapping[str, Any] | None = None
    ) -> tuple[dict[str, NDArray], dict[str, Any]]:
        """Starts an episode; see the class."""
        super().reset(seed=seed)
        number, goal, start = self._choose(options or {})
        self._episode = PlanEpisode(self.camera(number), goal, start, max_steps=self.config.max_steps)
        self._navmap = NavMap.empty(self._frame)
        self._untrap = Untrap(self.config.untrap.failed_forwards, turns_reset=self.config.untrap.turns_reset)
        self._last, self._failed = None, False
        self._pose = self.episode.pose
        self._mark_driven(self._pose)
        self._look()
        return self._observe(), self._info()

    def step(self, action: Any) -> tuple[dict[str, NDArray], float, bool, bool, dict[str, Any]]:
        """Carries out one action, primitive or towards a goal; see the class."""
        before_m = self.episode.distance_m()
        self._act(action)
        after_m = self.episode.distance_m()
        reward = before_m - after_m if math.isfinite(before_m) and math.isfinite(after_m) else 0.0
        return self._observe(), reward, self._terminated, self.episode.done and not self._terminated, self._info()

    @property
    def window(self) -> Window:
        """The part of the map around the robot; raises ResetNeeded before the first episode."""
        return self.navmap.frame.window_at(self._pose.x_m, self._pose.y_m, self.config.window_cells)

    def _choose(self, options: Mapping[str, Any]) -> tuple[int, str, Pose]:
        """Returns the number of the plan, the goal and the start of an episode: those of the options, else random ones.

        Raises:
            ConfigError: an option or the plan is unknown.
            EpisodeError: the plan does not have this goal, or it cannot be reached.
        """
        unknown = sorted(map(str, set(options) - {"plan", "goal", "start"}))
        if unknown:
            raise ConfigError(f"reset takes the options plan, goal and start, got {', '.join(unknown)}.")
        goal, start = options.get("goal"), options.get("start")
        if start is not None and not isinstance(start, Pose):
            raise ConfigError(f"options['start'] must be a Pose, got {type(start).__name__}.")
        if start is not None and "plan" not in options and len(self.files) > 1:
            raise ConfigError("options['start'] needs options['plan']: each plan has coordinates of its own.")
        number = int(self.np_random.integers(len(self.files)))
        if start is None and goal is not None and "plan" not in options:
            return self._draw_for(goal, first=number)
        number = self._number(options.get("plan", number))
        plan: Plan = self.camera(number).plan
        if start is None:
            return number, *draw_goal_and_start(plan, self.np_random, goal)
        return number, goal or draw_goal(plan, self.np_random, start), start

    def _draw_for(self, goal: str, first: int) -> tuple[int, str, Pose]:
        """Returns a plan from which a goal can be reached, the first that fits in a cycle over all, and a start.

        Raises:
            EpisodeError: the goal is unknown, or it cannot be reached in any plan.
        """
        if goal not in GOAL_CATEGORIES:
            raise EpisodeError(f"Unknown goal '{goal}'. Available: {', '.join(GOAL_CATEGORIES)}.")
        for number in (*range(first, len(self.files)), *range(first)):
            try:
                return number, *draw_goal_and_start(self.camera(number).plan, self.np_random, goal)
            except EpisodeError:
                if len(self.files) == 1:
                    raise
        raise EpisodeError(f"None of the {len(self.files)} plans has a '{goal}' that can be reached.")

    def _number(self, plan: Any) -> int:
        """Returns the number of a plan; raises ConfigError if the plan does not exist."""
        if not isinstance(plan, (int, np.integer)) or not 0 <= plan < len(self.files):
            raise ConfigError(f"options['plan'] must be 0 to {len(self.files) - 1}, got {plan!r}.")
        return int(plan)

    @property
    def _terminated(self) -> bool:
        seen = self.config.ends_at_sight and self.episode.first_seen_step is not None
        return self.episode.stopped or seen

    def _act(self, action: Any) -> None:
        """Carries out one action of the action space."""
        if self.config.actions == "primitive":
            self._move(require_action(action, MOVES))
            return
        share, frame = np.asarray(action, np.float64).reshape(2), self.window.frame
        y_m, x_m = (
            frame.origin_xy_m[axis] + float(np.clip(part, 0.0, 1.0)) * frame.shape[1 - axis] * frame.cell_m
            for axis, part in ((1, share[0]), (0, share[1]))
        )
        self._head_for((x_m, y_m))

    def _head_for(self, xy_m: tuple[float, float]) -> None:
        """Drives towards a point, in the start frame."""
        route: Route | None = None
        planned = 0
        for number in range(self.config.goal_steps):
            if self._terminated or self.episode.done:
                return
            escape = self._untrap.next_action()
            collided = self._last is Action.MOVE_FORWARD and self._failed
            if route is None or collided or number - planned >= self.config.plan_every:
                route, planned = self._plan(xy_m), number
            if escape is not None:
                self._move(escape)
            elif route is None or (self._arrived(route) and number == 0):  # like the agent: turns and pushes
                self._move(Action.MOVE_FORWARD if self._last is Action.TURN_LEFT else Action.TURN_LEFT)
            elif self._arrived(route):
                return
            else:
                self._move(next_action(route, self._pose, self.config.planning))

    def _arrived(self, route: Route) -> bool:
        """Returns whether the end of a route is as near as `arrived_m`."""
        limit_m = self.config.arrived_m
        return limit_m is not None and bool(
            route.distance_m[route.frame.cell(self._pose.x_m, self._pose.y_m)] <= limit_m
        )

    def _plan(self, xy_m: tuple[float, float]) -> Route | None:
        """Returns the route to a point, else to the reachable cell nearest it."""
        view = self._planned_on()
        route = self._plan_on(view, CollisionLayer.PESSIMISTIC, xy_m)
        if route is not None and self._arrived(route):
            return self._plan_on(view, CollisionLayer.OPTIMISTIC, xy_m)
        return route

    def _plan_on(self, view: NavMap, layer: CollisionLayer, xy_m: tuple[float, float]) -> Route | None:
        """Returns the same on one layer of collision marks."""
        free = self._planner.free_space(view, self._pose, layer)
        return planned(head_for(xy_m, free, self.config.goal_radius_m), self._planner, self._pose)

    def _planned_on(self) -> NavMap:
        """Returns the window of the map that is planned on, pooled where the configuration asks for it."""
        pool, window = self.config.plan_pool, self.window
        if pool == 1:
            return self.navmap.view(window)
        rows, cols = (slice(cut.start // pool * pool, cut.stop // pool * pool) for cut in window.index)
        part, pooled = self._frame.part(rows, cols).frame, self._pooled
        pooled.frame = replace(pooled.frame, origin_xy_m=part.origin_xy_m)
        for name in _PLANNED_ON:
            getattr(pooled, name)[:] = or_of_blocks(getattr(self.navmap, name)[rows, cols], pool)
        return pooled

    def _move(self, action: Action) -> None:
        """Carries out a primitive action, enters it and the frame after it into the map."""
        before = self._pose
        moved_m = self.episode.act(action).moved_m
        pose = self._pose = self.episode.pose
        self._failed = is_collision(action, moved_m, self.config.collisions.failed_below_m)
        self._untrap.observe(action, self._failed)
        self._mark_driven(before)
        if self._failed:
            self._mark_collision(pose)
        self._last = action
        self._look()

    def _mark_driven(self, before: Pose) -> None:
        """Enters the ground between an earlier pose and the present one, as `mark_visited` of the agent does."""
        cell_m, pose = self._frame.cell_m, self._pose
        ends = *self._place(before), *self._place(pose)
        rows, cols = (sorted(math.floor(end) for end in along) for along in (ends[::2], ends[1::2]))
        self.navmap.grow_known(*(slice(max(low - 1, 0), high + 2) for low, high in (rows, cols)))
        mark_swept(self.navmap.visited, *ends, self.episode.plan.radius_m / cell_m)
        mark_swept(self.navmap.trail, *ends, self.config.collisions.trail_radius_m / cell_m)

    def _mark_collision(self, pose: Pose) -> None:
        """Enters the marks in front of a failed move, as `mark_collision` of the agent does."""
        c, cell_m = self.config.collisions, self._frame.cell_m
        ahead = *self._place(pose), math.cos(pose.yaw_rad), math.sin(pose.yaw_rad), c.near_edge_m / cell_m
        mark_square(self.navmap.pessimistic_marks, *ahead, c.wide_m / cell_m)
        mark_square(self.navmap.optimistic_marks, *ahead, c.narrow_m / cell_m)

    def _place(self, pose: Pose) -> tuple[float, float]:
        """Returns row and column of a pose on the map, with fractions."""
        (x_m, y_m), cell_m = self._frame.origin_xy_m, self._frame.cell_m
        return (pose.y_m - y_m) / cell_m, (pose.x_m - x_m) / cell_m

    def _look(self) -> None:
        """Enters the frame from the present pose into the map."""
        episode = self.episode
        look = episode.camera.look(episode.robot.pose, episode.goal, self.navmap, self._pose)
        if look.touched is not None:
            self.navmap.grow_known(*look.touched)
        episode.see(look)

    def _observe(self) -> dict[str, NDArray]:
        window, pose = self.window, self._pose
        layers = np.empty((len(LAYERS), *window.frame.shape), np.bool_)
        for number, name in enumerate(LAYERS):
            if name == "in_view":
                np.greater(self.navmap.frames_in_view[window.index], 0, out=layers[number])
            elif name == "target":
                np.greater(self.navmap.score_max[window.index], 0.5, out=layers[number])
            else:
                layers[number] = getattr(self.navmap, name)[window.index]
        return {
            "layers": layers.view(np.uint8),
            "goals_seen": self.navmap.goals_seen[window.index].copy(),
            "pose": np.array([pose.x_m, pose.y_m, pose.yaw_rad], np.float32),
            "objectgoal": np.array([GOAL_CATEGORIES.index(self.episode.goal)], np.int64),
        }

    def _info(self) -> dict[str, Any]:
        measured = dict(self.episode.metrics())
        if measured["first_seen_step"] is None:
            del measured["first_seen_step"]  # Gymnasium's vector environments take numbers only
        return {"house": self.episode.plan.name, "goal": self.episode.goal, **measured}


def require_reset(value: T | None) -> T:
    """Returns a value that `reset` sets; raises ResetNeeded before."""
    if value is None:
        raise gymnasium.error.ResetNeeded("Call reset() before the first step.")
    return value
