"""The explorer with the learned policy: its input, its goals, its controls, and its network."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from safetensors.torch import save_file

from sim.core.geometry.grid import GridFrame
from sim.core.geometry.pose import Pose
from sim.core.interface import GOAL_CATEGORIES, ConfigError
from stubborn.exploration.patches import patch_around
from stubborn.exploration.semexp import SHIPPED, SemExpConfig, SemExpExplorer
from stubborn.exploration.semexp_input import CELLS, GEOMETRY, GIBSON, PolicyInput, observe
from stubborn.exploration.semexp_net import FILES, NetConfig, SemExpNet, action_of, as_arrays, load
from stubborn.mapping.navmap import NavMap
from tests.helpers import wording
from tests.helpers.gridworld import SMALL_CAMERA
from tests.helpers.ground import ground, route_of, run_explorer

BED, SINK = GOAL_CATEGORIES.index("bed"), GOAL_CATEGORIES.index("sink")


def open_map() -> NavMap:
    """Returns ground in view from x = -6 to 6 m, a bed ahead of the start and a wall left of it."""
    navmap = NavMap.empty(GridFrame.around_start(400, 0.05))
    for name, x_m, y_m, value in (
        ("frames_in_view", (-6.0, 6.0), (-6.0, 6.0), 1 << 16),  # its two lowest bytes are 0
        ("seen_obstacle", (-6.0, 6.0), (4.0, 4.1), True),
        ("goals_seen", (2.0, 3.9), (-0.5, 0.5), 1 << BED),
    ):
        (row_0, col_0), (row_1, col_1) = navmap.frame.cell(x_m[0], y_m[0]), navmap.frame.cell(x_m[1], y_m[1])
        cells = slice(row_0, row_1 + 1), slice(col_0, col_1 + 1)
        getattr(navmap, name)[cells] = value
        navmap.grow_known(*cells)
    return navmap


class Always:
    """A policy that wants one point of the local map, given as shares of its rows and columns, and keeps its inputs."""

    def __init__(self, row: float = 0.5, col: float = 0.1) -> None:
        self.share, self.given = np.array([row, col]), []

    def __call__(self, given: PolicyInput) -> tuple[np.ndarray, np.ndarray]:
        self.given.append(given)
        return np.log(self.share / (1.0 - self.share)), np.zeros(2)


def explorer(policy: Always, **options: object) -> SemExpExplorer:
    return SemExpExplorer(SemExpConfig(**options), policy)  # type: ignore[arg-type]


def layer(given: PolicyInput, name: str, *, whole: bool = False) -> np.ndarray:
    return given.geometry >> GEOMETRY.index(name) + (len(GEOMETRY) if whole else 0) & 1


@pytest.mark.parametrize("at", [(0.0, 0.0, 0.0), (1.37, -2.2, 2.0), (9.0, 9.0, 0.0)])
def test_the_input_is_the_map_around_the_robot_and_around_the_start(at: tuple[float, float, float]):
    navmap, pose = open_map(), Pose(*at)
    given = observe(navmap, pose, BED)
    for whole, centre, pool in ((False, pose, 2), (True, Pose(0.0, 0.0, 0.0), 4)):
        patch = patch_around(navmap, centre, cells=CELLS, pool=pool)
        for name in ("obstacle", "seen", "trail"):
            np.testing.assert_array_equal(layer(given, name, whole=whole), getattr(patch, name))
        robot = np.argwhere(layer(given, "robot", whole=whole))
        assert len(robot) == 9
        x_m, y_m = patch.frame.centres(*robot.mean(0))
        assert math.hypot(x_m - pose.x_m, y_m - pose.y_m) < patch.frame.cell_m
    np.testing.assert_array_equal(given.goals, patch_around(navmap, pose, cells=CELLS, pool=2).goals)
    assert given.goal == BED
    assert given.heading == round((math.degrees(at[2]) + 180) / 5)


def test_the_robot_may_be_outside_of_the_global_map():
    navmap = NavMap.empty(GridFrame.around_start(800, 0.05))
    given = observe(navmap, Pose(14.0, -16.0, -3.2), BED)
    assert layer(given, "robot").sum() == 9
    assert layer(given, "robot", whole=True).sum() == 0
    assert 0 <= given.heading < 72


def test_an_unknown_map_and_a_map_that_is_not_a_multiple_of_the_blocks_can_be_observed():
    empty = observe(NavMap.empty(GridFrame.around_start(401, 0.05)), Pose(0.0, 0.0, 0.0), BED)
    assert not layer(empty, "seen").any()
    navmap = NavMap.empty(GridFrame.around_start(401, 0.05))
    navmap.frames_in_view[-1, -1] = 1
    navmap.grow_known(slice(400, 401), slice(400, 401))
    assert layer(observe(navmap, Pose(9.9, 9.9, 0.0), BED), "seen").sum() == 1


def test_a_point_of_the_local_map_is_where_its_input_is():
    given = observe(open_map(), Pose(0.9, -0.4, 0.0), BED)
    x_m, y_m = given.place_xy_m((np.argwhere(given.goals).mean(0) + 0.5) / CELLS)
    assert x_m == pytest.approx(2.95, abs=0.1)
    assert y_m == pytest.approx(0.0, abs=0.1)


def test_a_goal_is_kept_for_25_steps_and_a_new_one_chosen_when_it_is_reached():
    policy, navmap = Always(0.5, 0.9), open_map()
    explore = explorer(policy)
    x_m, y_m = observe(navmap, Pose(-0.5, 0.0, 0.0), BED).place_xy_m(policy.share)
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
    route = route_of(explorer(Always(0.95, 0.5)), ground(navmap))
    _, y_m = route.frame.centres(*np.nonzero(route.goal.cells))
    assert 3.5 < y_m.mean() < 4.0


def test_the_control_shuffles_the_categories_by_a_permutation_of_the_episode():
    navmap, seen = open_map(), Always()
    explore = explorer(seen, semantics="shuffled")
    shown = set()
    for seed in (1, 1, 2, 3, 4):
        explore.reset(seed)
        route_of(explore, ground(navmap))
        bits = int(np.bitwise_or.reduce(seen.given[-1].goals, axis=None))
        assert bits == 1 << explore.shuffled.index("bed")
        assert sorted(filter(None, explore.shuffled)) == sorted(GOAL_CATEGORIES)
        shown.add(bits)
    assert len(shown) > 1
    np.testing.assert_array_equal(seen.given[0].goals, seen.given[1].goals)
    plain = observe(navmap, Pose(0.0, 0.0, 0.0), BED)
    np.testing.assert_array_equal(seen.given[0].goals != 0, plain.goals != 0)
    np.testing.assert_array_equal(seen.given[0].geometry, plain.geometry)


def test_without_semantics_the_policy_sees_the_geometry_only():
    policy = Always()
    route_of(explorer(policy, semantics="none"), ground(open_map()))
    assert not policy.given[0].goals.any()
    assert policy.given[0].geometry.any()


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
    chosen = {}
    for sampled in (True, False):
        explore = SemExpExplorer(SemExpConfig(sampled=sampled), lambda _: (np.zeros(2), np.ones(2)))
        chosen[sampled] = []
        for seed in (0, 0, *range(20)):
            explore.reset(seed)
            run_explorer(explore, ground(open_map()))
            chosen[sampled].append(explore.place_xy_m)
    assert chosen[True][0] == chosen[True][1]
    assert len(set(chosen[True])) == 20
    assert len(set(chosen[False])) == 1


@pytest.fixture(scope="module")
def net() -> SemExpNet:
    torch.manual_seed(0)
    return SemExpNet(NetConfig(cells=40, hidden=8)).eval()


def test_the_network_depends_on_everything_it_is_given_and_learns_from_it(net: SemExpNet):
    given = observe(open_map(), Pose(0.3, 0.2, 0.4), BED, cells=40)
    given = replace(given, goals=np.full_like(given.goals, 1 << BED))
    plain, deviation = action_of(net, given)
    assert plain.shape == deviation.shape == (2,)
    changed = (
        replace(given, goal=SINK),
        replace(given, heading=0),
        replace(given, goals=np.zeros_like(given.goals)),
        replace(given, geometry=given.geometry & 15),
        replace(given, geometry=given.geometry & 240),
    )
    for other in changed:
        assert np.abs(action_of(net, other)[0] - plain).max() > 1e-7
    mean, logstd, value = net(**{name: torch.from_numpy(array)[None] for name, array in as_arrays(given).items()})
    (mean.sum() + logstd.sum() + value.sum()).backward()
    assert all(weight.grad is not None and weight.grad.abs().sum() > 0 for weight in net.parameters())


PUBLISHED = {
    **{f"network.main.{i}.weight": (after, before, 3, 3) for i, before, after in (
        (1, 24, 32), (4, 32, 64), (7, 64, 128), (10, 128, 64), (12, 64, 32))},
    **{f"network.main.{i}.bias": (after,) for i, after in ((1, 32), (4, 64), (7, 128), (10, 64), (12, 32))},
    "network.linear1.weight": (256, 7216), "network.linear1.bias": (256,),
    "network.linear2.weight": (256, 256), "network.linear2.bias": (256,),
    "network.critic_linear.weight": (1, 256), "network.critic_linear.bias": (1,),
    "network.orientation_emb.weight": (72, 8), "network.goal_emb.weight": (16, 8),
    "dist.fc_mean.weight": (2, 256), "dist.fc_mean.bias": (2,), "dist.logstd._bias": (2, 1),
}  # fmt: skip
"""Names and shapes of the tensors of a published checkpoint, by the published code: 240 x 240 cells, 16 categories."""


def test_a_published_checkpoint_is_read_and_gets_its_own_categories(tmp_path: Path):
    random = torch.Generator().manual_seed(0)
    file = tmp_path / "sem_exp.pth"
    torch.save({name: 0.05 * torch.randn(shape, generator=random) for name, shape in PUBLISHED.items()}, file)
    explore = SemExpConfig(weights=str(file)).make(SMALL_CAMERA)
    assert explore.channels == GIBSON
    assert explore.cells == 120
    explore.reset(0)
    route_of(explore, ground(open_map(), goal="bed"))
    assert explore.place_xy_m is not None
    with pytest.raises(ConfigError, match="'cushion'"):
        explore.policy_goal("cushion")


EMBEDDING, LINEAR = (f"network.{name}.weight" for name in ("goal_emb", "linear1"))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"nothing", "PyTorch"),
        ({"state": torch.zeros(2)}, f"they need the tensors {EMBEDDING} and {LINEAR}"),
        ({EMBEDDING: torch.zeros(16, 8), LINEAR: torch.zeros(2, 3)}, wording.ARE_NOT_OF_SEMEXP),
        ({EMBEDDING: torch.zeros(16, 8), LINEAR: torch.zeros(256, 7216)}, "is missing"),
        ([1, 2], wording.HOLD_A_LIST_NOT_A_TABLE_OF_TENSORS),
    ],
)
def test_a_file_that_is_no_checkpoint_is_refused_by_a_sentence(content: object, message: str, tmp_path: Path):
    file = tmp_path / "weights.pth"
    if isinstance(content, bytes):
        file.write_bytes(content)
    else:
        torch.save(content, file)
    with pytest.raises(ConfigError, match=message):
        load(file)


def test_weights_are_read_back_and_wrong_files_refused_by_a_sentence(net: SemExpNet, tmp_path: Path):
    file = tmp_path / "semexp.safetensors"
    FILES.save(file, net, {"steps": 3})
    again = FILES.load(file)[0]
    assert again.config == net.config
    given = observe(open_map(), Pose(0.0, 0.0, 0.0), BED, cells=40)
    np.testing.assert_allclose(action_of(again, given)[0], action_of(net, given)[0], atol=1e-2)  # 16 bits
    assert SemExpConfig(weights=str(file)).make(SMALL_CAMERA).cells == 40

    header = {"semexp_config": '{"cells": 40, "hidden": 8}'}
    tensors = {name: tensor.clone() for name, tensor in net.state_dict().items()}
    wrong = {
        "No weights at": None,
        "cannot be read": b"nothing",
        "header has no 'semexp_config'": (tensors, {}),
        "are not of semexp, field .hidden": (tensors, {"semexp_config": '{"hidden": 4096}'}),
        "are not of semexp": (tensors, {"semexp_config": "{"}),
        f"'{EMBEDDING}' is missing": ({k: v for k, v in tensors.items() if k != EMBEDDING}, header),
        rf"'{EMBEDDING}' is \(2,\), not \(21, 8\)": (tensors | {EMBEDDING: torch.zeros(2)}, header),
        "'odd' is not in it": (tensors | {"odd": torch.zeros(2)}, header),
        "holds NaN": (tensors | {EMBEDDING: torch.full((21, 8), torch.nan)}, header),
    }
    for number, (message, content) in enumerate(wrong.items()):
        bad = tmp_path / f"{number}.safetensors"
        if isinstance(content, bytes):
            bad.write_bytes(content)
        elif content is not None:
            save_file(content[0], bad, metadata=content[1])
        with pytest.raises(ConfigError, match=message):
            FILES.load(bad)
    FILES.save(file, SemExpNet(NetConfig(cells=8, categories=5)))
    with pytest.raises(ConfigError, match=wording.NEEDS_21_OR_16_SEMANTIC_CHANNELS_GOT_5):
        SemExpConfig(weights=str(file)).make(SMALL_CAMERA)


def test_the_shipped_weights_are_small():
    assert SHIPPED.stat().st_size < 5_000_000
    assert SemExpConfig().make(SMALL_CAMERA).cells == CELLS


def test_options_that_make_no_sense_are_refused():
    with pytest.raises(ConfigError, match="goal_steps >= 1 and arrived_m > 0, got 0 and"):
        SemExpConfig(goal_steps=0)
