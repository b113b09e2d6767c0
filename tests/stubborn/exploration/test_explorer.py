"""The interface of explorers, and an explorer of a user in thirty lines."""

from dataclasses import dataclass

import numpy as np

from sim.core.interface import Action, CameraModel, RobotModel
from stubborn.agent import AgentConfig, StubbornAgent
from stubborn.exploration.explorer import Exploration, Ground, run_explorer
from stubborn.mapping.masks import distance_to
from stubborn.mapping.navmap import CollisionLayer
from stubborn.planning.planner import Goal
from stubborn.segmentation.ground_truth import GroundTruthSegmenter
from tests.helpers.boxed import all_seen, box_in, empty
from tests.helpers.gridworld import SMALL_CAMERA, GridWorld, boxes_from_plan, run_episode
from tests.helpers.ground import ground, route_of


@dataclass(frozen=True)
class FarthestConfig:
    arrived_m: float = 0.3

    def make(self, camera: CameraModel) -> "Farthest":
        return Farthest(self)


class Farthest:
    """Goes to the seen and reachable cell that is farthest from the robot's own trail, and keeps to it."""

    def __init__(self, config: FarthestConfig) -> None:
        self.config = config
        self.reset()

    def reset(self, seed: int = 0) -> None:
        self.goal_xy_m: tuple[float, float] | None = None

    def explore(self, ground: Ground) -> Exploration:
        free, view = ground.free_space(), ground.navmap.view(ground.window)
        if self.goal_xy_m is None:
            score = np.where(free.reachable & (view.frames_in_view > 0), distance_to(view.trail), -1.0)
            row, col = divmod(int(score.argmax()), score.shape[1])
            x_m, y_m = free.frame.centres(row, col)
            self.goal_xy_m = float(x_m), float(y_m)
        x_m, y_m = free.frame.mesh()
        near = np.hypot(x_m - self.goal_xy_m[0], y_m - self.goal_xy_m[1]) < self.config.arrived_m
        route = yield Goal(free, near)
        if route is None or route.length_m == 0.0:
            self.goal_xy_m = None
        return route


def test_the_agent_plans_to_the_cells_that_an_explorer_yields():
    navmap = empty()
    box_in(navmap.seen_obstacle, 1.5)
    all_seen(navmap)
    route = route_of(Farthest(FarthestConfig()), ground(navmap))
    x_m, y_m = route.frame.centres(*np.nonzero(route.goal.cells))
    assert np.hypot(x_m, y_m).max() > 1.7
    assert max(np.abs(x_m).max(), np.abs(y_m).max()) < 1.5
    assert route.length_m < 2.5


def test_an_agent_with_an_explorer_of_ones_own_finds_the_goal():
    plan = """
##############
#      #     #
#      #  bb #
#            #
#            #
#      #     #
##############
"""
    config = AgentConfig(explorer=FarthestConfig())
    agent = StubbornAgent(camera=SMALL_CAMERA, robot=RobotModel(), segmenter=GroundTruthSegmenter(), config=config)
    world = GridWorld(boxes_from_plan(plan, 0.4), (1.2, 1.2, 2.0), camera=SMALL_CAMERA)
    trace = run_episode(world, agent, "bed", max_steps=150)
    assert trace.stopped
    assert trace.goal_distance_m < 1.0


class Undecided:
    """Asks for an unreachable cell, then for a reachable one, and turns when it gets a route."""

    def __init__(self) -> None:
        self.lengths_m: list[float | None] = []

    def reset(self, seed: int = 0) -> None:
        self.lengths_m.clear()

    def explore(self, ground: Ground) -> Exploration:
        free = ground.free_space(layer=CollisionLayer.NONE)
        for cells in (~free.reachable, free.reachable):
            route = yield Goal(free, cells)
            self.lengths_m.append(None if route is None else route.length_m)
        return Action.TURN_RIGHT


def test_an_explorer_learns_which_goals_have_a_route_and_may_turn_instead():
    navmap, explorer = empty(), Undecided()
    box_in(navmap.seen_obstacle, 1.5)
    assert run_explorer(explorer, ground(navmap)) is Action.TURN_RIGHT
    assert explorer.lengths_m == [None, 0.0]
