"""The explorer with the learned policy: its input, its goals, its controls, and its network."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from safetensors.torch import save_file

from sim.geometry.grid import GridFrame
from sim.geometry.pose import Pose
from sim.interface import GOAL_CATEGORIES, ConfigError
from stubborn.exploration.patches import patch_around
from stubborn.exploration.semexp import SHIPPED, SemExpConfig, SemExpExplorer
from stubborn.exploration.semexp_input import GEOMETRY, PolicyInput, ViewConfig, observe
from stubborn.exploration.semexp_net import (
    FILES,
    TRUTH,
    NetConfig,
    SemExpNet,
    as_tensors,
    scores,
)
from stubborn.mapping.navmap import NavMap
from tests.helpers.gridworld import SMALL_CAMERA
from tests.helpers.ground import ground, route_of

BED, SINK = GOAL_CATEGORIES.index("bed"), GOAL_CATEGORIES.index("sink")
VIEW = ViewConfig()


def open_map() -> NavMap:
    """Returns ground in view from x = -6 to 6 m, a bed ahead of the start and a wall left of it."""
    navmap = NavMap.empty(GridFrame.around_start(400, 0.05))
    for name, x_m, y_m, value in (
        ("frames_in_view", (-6.0, 6.0), (-6.0, 6.0), 256),  # its lowest byte is 0
        ("seen_obstacle", (-6.0, 6.0), (4.0, 4.1), True),
        ("goals_seen", (2.0, 3.9), (-0.5, 0.5), 1 << BED),
    ):
        (row_0, col_0), (row_1, col_1) = navmap.frame.cell(x_m[0], y_m[0]), navmap.frame.cell(x_m[1], y_m[1])
        cells = slice(row_0, row_1 + 1), slice(col_0, col_1 + 1)
        getattr(navmap, name)[cells] = value
        navmap.grow_known(*cells)
    return navmap


class Always:
    """A policy that wants one goal cell, and keeps its inputs."""

    def __init__(self, cell: int = 0) -> None:
        self.cell, self.given = cell, []

    def __call__(self, given: PolicyInput) -> np.ndarray:
        self.given.append(given)
        return np.where(np.arange(VIEW.goal_cells**2) == self.cell, np.float32(50.0), np.float32(0.0))


def explorer(policy: Always, **options: object) -> SemExpExplorer:
    return SemExpExplorer(SemExpConfig(**options), VIEW, policy)  # type: ignore[arg-type]


@pytest.mark.parametrize("at", [(0.0, 0.0, 0.0), (1.37, -2.2, 2.0), (9.0, 9.0, 0.0)])
def test_the_input_is_the_patch_around_the_robot(at: tuple[float, float, float]):
    navmap, pose = open_map(), Pose(*at)
    given = observe(navmap, pose, "bed", VIEW)
    for square, pool in ((given.near, VIEW.local_pool), (given.far, VIEW.global_pool)):
        patch = patch_around(navmap, pose, cells=VIEW.cells, pool=pool)
        for bit, name in enumerate(GEOMETRY[:3]):
            np.testing.assert_array_equal(square.geometry >> bit & 1, getattr(patch, name))
        frontier = square.geometry >> GEOMETRY.index("frontier") & 1
        assert not (frontier & ~patch.seen).any()
        assert not (frontier & patch.obstacle).any()
        assert not frontier[patch.robot] or abs(at[0]) > 6
        blocks = np.bitwise_or.reduce(patch.goals.reshape(15, 4, 15, 4), axis=(1, 3))
        np.testing.assert_array_equal(square.goals, blocks)
    assert given.goal == BED
    np.testing.assert_allclose(given.heading, (math.cos(at[2]), math.sin(at[2])), atol=1e-6)


def test_an_unknown_map_and_a_map_that_is_not_a_multiple_of_the_blocks_can_be_observed():
    empty = observe(NavMap.empty(GridFrame.around_start(401, 0.05)), Pose(0.0, 0.0, 0.0), "bed", VIEW)
    assert not empty.near.geometry.any()
    navmap = NavMap.empty(GridFrame.around_start(401, 0.05))
    navmap.frames_in_view[-1, -1] = 1
    navmap.grow_known(slice(400, 401), slice(400, 401))
    geometry = observe(navmap, Pose(9.9, 9.9, 0.0), "bed", VIEW).near.geometry
    assert (geometry >> GEOMETRY.index("seen") & 1).sum() == 1


def test_a_goal_cell_is_where_its_block_of_the_input_is():
    given = observe(open_map(), Pose(0.9, -0.4, 0.0), "bed", VIEW)
    row, col = (int(index.mean().round()) for index in np.nonzero(given.near.goals))
    x_m, y_m = given.place_xy_m(row * VIEW.goal_cells + col)
    assert x_m == pytest.approx(2.95, abs=0.5)
    assert y_m == pytest.approx(0.0, abs=0.5)


def test_a_goal_is_kept_for_25_steps_and_a_new_one_chosen_when_it_is_reached():
    policy, navmap = Always(7 * 15 + 13), open_map()
    explore = explorer(policy)
    x_m, y_m = observe(navmap, Pose(-0.5, 0.0, 0.0), "chair", VIEW).place_xy_m(policy.cell)
    for step in range(26):
        route = route_of(explore, ground(navmap, Pose(-0.5 + 0.01 * step, 0.0, 0.0)))
        assert len(policy.given) == (1 if step < 25 else 2)
        if step < 25:
            assert explore.place_xy_m == pytest.approx((x_m, y_m))
            assert route.goal.cells[route.frame.cell(x_m, y_m)]
    there = explore.place_xy_m
    assert there is not None
    route_of(explore, ground(navmap, Pose(there[0] - 0.7, there[1], 0.0)))
    assert len(policy.given) == 3


def test_a_goal_behind_a_wall_is_approached_at_the_nearest_reachable_cell():
    navmap = open_map()
    row, _ = navmap.frame.cell(0.0, 4.05)
    navmap.seen_obstacle[row - 1 : row + 2] = True
    route = route_of(explorer(Always(14 * 15 + 7)), ground(navmap))
    _, y_m = route.frame.centres(*np.nonzero(route.goal.cells))
    assert 3.5 < y_m.mean() < 4.0


def test_the_control_shuffles_the_categories_by_a_permutation_of_the_episode():
    navmap, seen = open_map(), Always()
    explore = explorer(seen, semantics="shuffled")
    shown = set()
    for seed in (1, 1, 2, 3, 4):
        explore.reset(seed)
        route_of(explore, ground(navmap))
        bits = int(np.bitwise_or.reduce(seen.given[-1].near.goals, axis=None))
        assert bits == 1 << explore.order.index(BED)
        assert sorted(explore.order) == list(range(len(GOAL_CATEGORIES)))
        shown.add(bits)
    assert len(shown) > 1
    first, second = (given.near.goals for given in seen.given[:2])
    np.testing.assert_array_equal(first, second)
    plain = observe(navmap, Pose(0.0, 0.0, 0.0), "bed", VIEW)
    np.testing.assert_array_equal(first != 0, plain.near.goals != 0)
    np.testing.assert_array_equal(seen.given[0].near.geometry, plain.near.geometry)


def test_without_semantics_the_policy_sees_the_geometry_only():
    policy = Always()
    route_of(explorer(policy, semantics="none"), ground(open_map()))
    assert not policy.given[0].near.goals.any()
    assert not policy.given[0].far.goals.any()
    assert policy.given[0].near.geometry.any()


def test_the_wrong_goal_is_another_one_of_the_episode_and_never_the_true_one():
    policy, navmap, goals = Always(), open_map(), []
    explore = explorer(policy, goal="wrong")
    for seed in range(30):
        explore.reset(seed)
        for step in range(2):
            explore.place_xy_m = None
            route_of(explore, ground(navmap, goal="sink"))
            goals.append(policy.given[-1].goal)
            assert goals[-1] == goals[-1 - step]
    assert SINK not in goals
    assert len(set(goals)) > 8


def test_draws_follow_the_policy_and_the_seed():
    explore = explorer(Always(), sampled=True)
    explore.score = lambda _: np.log(np.where(np.arange(225) < 2, [0.7, 0.3][0], 1e-9)).astype(np.float32)
    chosen = []
    for seed in (0, 0, *range(20)):
        explore.reset(seed)
        route_of(explore, ground(open_map()))
        chosen.append(explore.place_xy_m)
    assert chosen[0] == chosen[1]
    assert len(set(chosen)) == 2


@pytest.fixture(scope="module")
def net() -> SemExpNet:
    torch.manual_seed(0)
    return SemExpNet(NetConfig(goal_cells=15, width=6, relations=3)).eval()


def test_the_network_scores_every_goal_cell_and_learns_from_everything_it_is_given(net: SemExpNet):
    given = observe(open_map(), Pose(0.3, 0.2, 0.4), "bed", VIEW)
    plain = scores(net, given)
    assert plain.shape == (225,)
    none = given.near._replace(goals=np.zeros_like(given.near.goals))
    changed = (
        replace(given, goal=SINK),
        replace(given, heading=-given.heading),
        replace(given, near=none),
        replace(given, far=given.far._replace(goals=np.zeros_like(given.far.goals))),
        replace(given, far=given.far._replace(geometry=np.zeros_like(given.far.geometry))),
    )
    for other in changed:
        assert np.abs(scores(net, other) - plain).max() > 1e-7
    logits, value = net(*as_tensors(given), torch.ones(1, len(TRUTH)))
    (logits.logsumexp(1).sum() + value.sum()).backward()
    assert all(weight.grad is not None and weight.grad.abs().sum() > 0 for weight in net.parameters())


def test_weights_are_read_back_and_wrong_files_refused_by_a_sentence(net: SemExpNet, tmp_path: Path):
    file = tmp_path / "semexp.safetensors"
    FILES.save(file, net, {"steps": 3})
    again = FILES.load(file)[0]
    assert again.config == net.config
    given = observe(open_map(), Pose(0.0, 0.0, 0.0), "bed", VIEW)
    np.testing.assert_array_equal(scores(again, given), scores(net, given))
    assert SemExpConfig(weights=str(file)).make(SMALL_CAMERA).view == VIEW

    header = {"semexp_config": '{"goal_cells": 15, "width": 6, "relations": 3}'}
    tensors = {name: tensor.clone() for name, tensor in net.state_dict().items()}
    wrong = {
        "No weights at": None,
        "cannot be read": b"nothing",
        "header has no 'semexp_config'": (tensors, {}),
        "are not of semexp, field .width": (tensors, {"semexp_config": '{"width": 4096}'}),
        "are not of semexp": (tensors, {"semexp_config": "{"}),
        "'goal.weight' is missing": ({k: v for k, v in tensors.items() if k != "goal.weight"}, header),
        r"'goal.weight' is \(2,\), not \(21, 6\)": (tensors | {"goal.weight": torch.zeros(2)}, header),
        "'odd' is not in it": (tensors | {"odd": torch.zeros(2)}, header),
        "holds NaN": (tensors | {"goal.weight": torch.full((21, 6), torch.nan)}, header),
    }
    for number, (message, content) in enumerate(wrong.items()):
        bad = tmp_path / f"{number}.safetensors"
        if isinstance(content, bytes):
            bad.write_bytes(content)
        elif content is not None:
            save_file(content[0], bad, metadata=content[1])
        with pytest.raises(ConfigError, match=message):
            FILES.load(bad)


def test_the_shipped_weights_are_small_and_choose_in_a_few_milliseconds():
    assert SHIPPED.stat().st_size < 5_000_000
    assert SemExpConfig().make(SMALL_CAMERA).view == VIEW


def test_options_that_make_no_sense_are_refused():
    with pytest.raises(ConfigError, match="goal_steps >= 1 and arrived_m > 0, got 0 and"):
        SemExpConfig(goal_steps=0)
    with pytest.raises(ConfigError, match="a global_pool that local_pool divides, got goal_cells 15, local_pool 4"):
        ViewConfig(global_pool=10)
