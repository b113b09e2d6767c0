"""The explorer that follows predicted potentials, its controls, and the file of its network."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import torch

from sim.core.geometry.grid import GridFrame
from sim.core.geometry.pose import Pose
from sim.core.interface import GOAL_CATEGORIES, ConfigError
from stubborn.exploration.patches import LAYERS, patch_around
from stubborn.exploration.poni import PoniConfig, PoniExplorer
from stubborn.exploration.poni_net import FILES, MAPS, SHIPPED, PoniNet, PoniNetConfig, Predictor
from stubborn.mapping.navmap import NavMap
from stubborn.network_files import read_weights
from tests.helpers import wording
from tests.helpers.gridworld import SMALL_CAMERA
from tests.helpers.ground import corridor, ground, route_of, see
from tests.helpers.slopes import Slopes

SMALL = PoniNetConfig(cells=32, pool=8, widths=(4, 4, 4, 4))
BED = GOAL_CATEGORIES.index("bed")
START = Pose(0.5, 0.0, 0.0)


def corridor_with_bed(x_m: tuple[float, float] = (-4.0, 4.0)) -> NavMap:
    navmap = corridor(x_m)
    navmap.goals_seen[navmap.frame.cell(2.0, 0.9)] = 1 << BED
    return navmap


def explorer(**options: object) -> tuple[PoniExplorer, Slopes]:
    slopes = Slopes()
    return PoniExplorer(PoniConfig(**options), slopes), slopes  # type: ignore[arg-type]


def goal_x_m(explore: PoniExplorer, navmap: NavMap, pose: Pose = START, goal: str = "bed") -> float:
    route = route_of(explore, ground(navmap, pose, navmap.frame.window_at(0.0, 0.0, 300), goal=goal))
    x_m, _ = route.frame.centres(*np.nonzero(route.goal.cells))
    return float(x_m.mean())


def test_alpha_weighs_the_area_against_the_object():
    assert goal_x_m(explorer(alpha=0.1)[0], corridor_with_bed()) > 3.0
    assert goal_x_m(explorer(alpha=0.9)[0], corridor_with_bed()) < -3.0


def test_a_path_that_costs_makes_a_nearer_frontier_the_best():
    navmap, here = corridor_with_bed(), Pose(-2.0, 0.0, 0.0)
    assert goal_x_m(explorer(alpha=0.1)[0], navmap, here) > 3.0
    assert goal_x_m(explorer(alpha=0.1, path_weight_per_m=0.5)[0], navmap, here) < -3.0


def test_a_frontier_is_kept_for_some_steps_and_then_judged_again():
    explore, slopes = explorer(alpha=0.1, replan_steps=3)
    navmap = corridor_with_bed()
    for _ in range(4):
        assert goal_x_m(explore, navmap) > 3.0
    assert len(slopes.shown) == 1
    goal_x_m(explore, navmap)
    assert len(slopes.shown) == 2


def test_a_frontier_is_judged_again_when_a_wall_makes_the_path_long():
    for detour_m, times in ((0.5, 2), (9.0, 1)):
        explore, slopes = explorer(alpha=0.1, detour_m=detour_m)
        navmap = NavMap.empty(GridFrame.around_start(400, 0.05))
        see(navmap, (-4.0, 4.0), (-2.5, 2.5))
        for y_m in ((-2.6, -2.5), (2.5, 2.6)):
            see(navmap, (-4.0, 4.0), y_m, wall=True)
        navmap.trail[navmap.frame.cell(0.0, 0.0)] = True
        assert goal_x_m(explore, navmap) > 3.0
        see(navmap, (3.0, 3.1), (-1.8, 2.5), wall=True)
        assert goal_x_m(explore, navmap) > 3.0
        assert len(slopes.shown) == times


def test_a_frontier_is_given_up_when_the_robot_does_not_leave_its_place():
    explore, _ = explorer(alpha=0.1, replan_steps=99, stalled_steps=5, piece_m=3.0)
    navmap = corridor_with_bed()
    for _ in range(5):
        assert goal_x_m(explore, navmap) > 3.0
    assert goal_x_m(explore, navmap) < -3.0


def test_a_frontier_that_was_reached_is_done_with():
    explore, _ = explorer(alpha=0.1)
    navmap = corridor_with_bed()
    assert goal_x_m(explore, navmap) > 3.0
    assert goal_x_m(explore, navmap, Pose(4.1, -0.4, 0.0)) > 3.0  # the rest of it, half a metre to the left
    assert goal_x_m(explore, navmap, Pose(4.1, 0.4, 0.0)) < -3.0


def test_beyond_the_patch_a_frontier_has_no_potential():
    far = corridor_with_bed((-4.0, 8.0))  # the patch ends at 6.4 m
    assert goal_x_m(explorer(alpha=0.1)[0], far) < -3.0


def test_without_a_frontier_the_robot_goes_far_from_its_trail():
    navmap = corridor_with_bed((-4.0, 3.0))
    for x_m in ((-4.1, -4.0), (3.0, 3.1)):
        see(navmap, x_m, (-1.1, 1.1), wall=True)
    explore, slopes = explorer(alpha=0.1)
    assert goal_x_m(explore, navmap) < -3.0
    assert not slopes.shown


def test_the_controls_change_the_goal_or_the_categories_and_nothing_else():
    channels = {}
    for semantics in ("seen", "shuffled", "none"):
        explore, slopes = explorer(semantics=semantics)
        explore.reset(5)
        goal_x_m(explore, corridor_with_bed())
        channels[semantics] = slopes.shown[0]
    first = len(LAYERS)
    for shown in channels.values():
        np.testing.assert_array_equal(shown[:first], channels["seen"][:first])
    assert channels["seen"][first + BED].any()
    assert not channels["none"][first:].any()
    marked = [int(each.any(axis=(1, 2)).argmax()) for each in (channels["seen"][first:], channels["shuffled"][first:])]
    assert marked[0] == BED != marked[1]
    np.testing.assert_array_equal(channels["shuffled"][first + marked[1]], channels["seen"][first + BED])

    explore, _ = explorer(alpha=0.1, goal="wrong")
    ends = set()
    for seed in range(40):
        explore.reset(seed)
        assert goal_x_m(explore, corridor_with_bed(), goal="bed") < -3.0  # no other category has a potential
        explore.reset(seed)
        ends.add(goal_x_m(explore, corridor_with_bed(), goal="chair") > 3.0)
    assert ends == {True, False}  # the wrong goal is the bed in some episodes


def test_the_controls_of_an_episode_come_from_its_seed():
    orders = []
    for seed in (3, 3, 4):
        explore, slopes = explorer(semantics="shuffled")
        explore.reset(seed)
        goal_x_m(explore, corridor_with_bed())
        orders.append(slopes.shown[0].tobytes())
    assert orders[0] == orders[1] != orders[2]


@pytest.mark.parametrize(
    "options", [{"alpha": 1.1}, {"path_weight_per_m": -0.1}, {"replan_steps": 0}, {"arrived_m": 0.55}]
)
def test_settings_that_make_no_sense_are_refused(options: dict[str, float]):
    with pytest.raises(ConfigError, match=next(iter(options))):
        PoniConfig(**options)  # type: ignore[arg-type]


def test_weights_are_read_back_with_their_sizes(tmp_path: Path):
    torch.manual_seed(0)
    model = PoniNet(SMALL).eval()
    FILES.save(tmp_path / "net.safetensors", model.half().float(), {"plans": 7})
    loaded, metadata = FILES.load(tmp_path / "net.safetensors")
    assert (loaded.config, metadata) == (SMALL, {"plans": 7})
    channels = (np.random.default_rng(0).random((len(LAYERS) + len(GOAL_CATEGORIES), 32, 32)) < 0.1).astype(np.uint8)
    one, other = (Predictor(each).predict(channels) for each in (model, loaded))
    np.testing.assert_array_equal(one, other)
    assert one.shape == (MAPS, 32, 32)
    assert 0.0 <= one.min() < one.max() <= 1.0
    explore = PoniConfig(weights=str(tmp_path / "net.safetensors")).make(SMALL_CAMERA)
    assert abs(goal_x_m(explore, corridor_with_bed())) > 3.0


def test_a_wrong_file_is_refused_with_the_reason(tmp_path: Path):
    file = tmp_path / "net.safetensors"
    with pytest.raises(ConfigError, match="No weights at"):
        FILES.load(file)
    file.write_bytes(b"something else")
    with pytest.raises(ConfigError, match=wording.CANNOT_BE_READ):
        FILES.load(file)
    from safetensors.torch import save_file

    save_file({"a": torch.zeros(2)}, file)
    with pytest.raises(ConfigError, match=wording.ARE_NOT_OF_PONI):
        FILES.load(file)
    model = PoniNet(SMALL)
    del model.head
    FILES.save(file, model)
    with pytest.raises(ConfigError, match=r"'head\.weight' is missing"):
        FILES.load(file)
    model = PoniNet(SMALL)
    model.head = torch.nn.Conv2d(4, 2, 1)
    FILES.save(file, model)
    with pytest.raises(ConfigError, match=r"'head\.weight' is \(2, 4, 1, 1\), not \(88, 4, 1, 1\)"):
        FILES.load(file)
    model = PoniNet(SMALL)
    with torch.no_grad():
        model.head.weight[0, 0] = 1e6  # infinite in 16 bits
    with pytest.raises(ConfigError, match=r"'head\.weight'"):
        FILES.save(file, model)
    FILES.save(file, PoniNet(SMALL))
    tensors, header = read_weights(file)
    for bad in (torch.nan, torch.inf):
        tensors["head.weight"][0, 0] = bad
        save_file(tensors, file, metadata={key: json.dumps(value) for key, value in header.items()})
        with pytest.raises(ConfigError, match=r"'head\.weight' holds NaN"):
            FILES.load(file)
    with pytest.raises(ConfigError, match="multiple of 16"):
        PoniNetConfig(cells=40)


def test_the_shipped_network_is_small_and_reads_the_categories():
    assert SHIPPED.stat().st_size < 5e6
    predictor = Predictor(FILES.load(SHIPPED)[0])
    navmap = corridor_with_bed()
    see(navmap, (1.5, 3.0), (0.2, 0.9), wall=True)
    navmap.goals_seen[navmap.seen_obstacle & (navmap.frame.mesh()[1] < 1.0)] = 1 << BED
    patch = patch_around(navmap, START, cells=predictor.cells, pool=predictor.pool)
    shown = patch.channels()
    hidden = shown.copy()
    hidden[len(LAYERS) :] = 0
    at = patch.frame.cell(4.0, 0.0)
    seen, none = (predictor.predict(channels)[:, *at] for channels in (shown, hidden))
    assert np.abs(seen - none)[1:].max() > 0.01
