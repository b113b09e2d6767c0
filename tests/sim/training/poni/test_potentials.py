"""Partial maps of plans, and the true potentials of their frontiers."""

from __future__ import annotations

import math
import zlib
from pathlib import Path

import numpy as np
import pytest

from sim.core.errors import ConfigError
from sim.core.geometry.grid import GridFrame
from sim.core.geometry.pose import Pose
from sim.core.interface import GOAL_CATEGORIES
from sim.homes.plans.export import export_plans
from sim.homes.plans.plan import Plan, house_of, storey_name
from sim.homes.plans.sight import PlanCamera
from sim.training.plan_env.walks import explore, reachable
from sim.training.poni.potential_files import SYMMETRIES, Batch, SampleSet, held_back, write_samples
from sim.training.poni.potentials import Sample, SampleConfig, Truth, area_potential, sample_of, samples_of
from sim.training.poni.trainer import Choices, add_choices
from stubborn.exploration.patches import LAYERS
from stubborn.mapping.masks import distance_to
from stubborn.mapping.navmap import NavMap
from tests.helpers import wording
from tests.helpers.asciimap import mask_of
from tests.helpers.ground import ground
from tests.helpers.worlds import bed_behind_a_wall

CONFIG = SampleConfig(walks=2, maps=3, most_steps=60, cells=64, map_cells=700)
BED = GOAL_CATEGORIES.index("bed")
TWO_PARTS = """
######..........................
######..........................
................................
.............................###
.............................###
"""


@pytest.fixture(scope="module")
def plan() -> Plan:
    """Returns the plan of two rooms in a row, with a bed in the second one."""
    (exported,) = export_plans(bed_behind_a_wall(), {})
    return exported


@pytest.fixture(scope="module")
def samples(plan: Plan) -> list[Sample]:
    return list(samples_of(plan, CONFIG, seed=3))


def test_a_walk_stays_on_free_ground_and_sees_the_house(plan: Plan):
    camera, start = PlanCamera(plan), Pose(-3.0, 1.0, 3.0)
    for pose, _ in explore(camera, start, np.random.default_rng(0), most_steps=120, unseen_share=0.8):
        row, col = plan.frame.cell(pose.x_m, pose.y_m)
        assert plan.slack_m[row, col] > -0.05
        camera.look(pose, None, _empty(), pose.relative_to(start))
    assert camera.area_seen_m2 > 0.8 * np.count_nonzero(plan.floor) * plan.frame.cell_m**2


def _empty() -> NavMap:
    return NavMap.empty(GridFrame.around_start(700, 0.05))


def test_the_samples_of_a_plan_depend_on_its_name_and_the_seed_only(plan: Plan, samples: list[Sample]):
    again, other = (list(samples_of(plan, CONFIG, seed)) for seed in (3, 4))
    assert len(samples) == len(again) > 3
    for one, same in zip(samples, again, strict=True):
        np.testing.assert_array_equal(one.patch.channels(), same.patch.channels())
        np.testing.assert_array_equal(one.potentials.objects, same.potentials.objects)
    assert any((one.patch.seen != two.patch.seen).any() for one, two in zip(samples, other, strict=False))


def test_frontiers_lie_at_the_border_of_what_was_seen(samples: list[Sample]):
    unseen_bed = 0
    for sample in samples:
        rows, cols = sample.potentials.rows, sample.potentials.cols
        known_m = 0.25 * np.minimum(distance_to(sample.patch.seen), distance_to(sample.patch.trail) - 4.0)
        assert known_m[rows, cols].max() < 0.5  # 1 m around the trail counts as known
        assert (sample.potentials.objects[:, [g for g in range(len(GOAL_CATEGORIES)) if g != BED]] == 0.0).all()
        assert bool(sample.seen_goals >> BED & 1) == bool((sample.patch.goals >> np.uint32(BED) & 1).any())
        unseen_bed += not sample.seen_goals >> BED & 1
    assert unseen_bed > 0
    best = max(float(sample.potentials.objects[:, BED].max()) for sample in samples)
    assert 0.5 < best <= 1.0


def test_each_frontier_cell_has_the_potential_of_its_place_in_the_plan(plan: Plan):
    start, camera, navmap = Pose(-3.0, 1.0, 0.7), PlanCamera(plan), _empty()
    for turns in range(3):
        world = Pose(start.x_m, start.y_m, start.yaw_rad + turns * math.radians(30.0))
        look = camera.look(world, None, navmap, world.relative_to(start))
        navmap.grow_known(*look.touched)  # type: ignore[misc]
    navmap.trail[navmap.frame.cell(0.0, 0.0)] = True
    here = ground(navmap, Pose(0.0, 0.0, math.radians(60.0)), navmap.known_window(20))
    sample = sample_of(Truth(plan, CONFIG), here, start, reachable(plan, start))
    assert sample is not None
    found = sample.potentials
    x_m, y_m = sample.patch.frame.centres(found.rows, found.cols)
    world_m = [start.place_of(float(x), float(y)) for x, y in zip(x_m, y_m, strict=True)]
    distance_m = np.array([plan.distance_m("bed")[plan.frame.cell(*place)] for place in world_m])
    free = np.isfinite(distance_m)
    assert free.sum() >= 5
    np.testing.assert_allclose(found.objects[free, BED], np.maximum(1.0 - distance_m[free] / 5.0, 0.0), atol=0.06)
    assert np.ptp(found.objects[:, BED]) > 0.2
    assert found.area.max() > 0.3


def test_the_object_potential_falls_by_a_fifth_with_each_metre_of_path(plan: Plan):
    truth = Truth(plan, CONFIG)
    for x_m, y_m in ((-2.0, 1.0), (0.0, -1.0), (1.5, -1.0)):
        rows, cols, near = truth.free_cells(np.array([x_m]), np.array([y_m]))
        assert near.all()
        distance_m = float(plan.distance_m("bed")[rows[0], cols[0]])
        assert truth.objects[BED, rows[0], cols[0]] == pytest.approx(max(0.0, 1.0 - distance_m / 5.0), abs=1e-6)
    assert not truth.free_cells(np.array([30.0]), np.array([0.0]))[2].any()


def test_the_area_potential_is_the_share_of_the_parts_that_a_frontier_borders_on():
    unexplored = mask_of(TWO_PARTS, "#")
    rows, cols, part = np.array([2, 2, 1, 2]), np.array([6, 7, 26, 16]), np.array([1, 1, 3, 2])
    shares = area_potential(unexplored, rows, cols, part)
    np.testing.assert_allclose(shares, [12 / 18, 12 / 18, 6 / 18, 0.0], rtol=1e-6)
    assert (area_potential(np.zeros_like(unexplored), rows, cols, part) == 0.0).all()


def test_samples_are_read_back_as_they_were_written(tmp_path: Path, samples: list[Sample]):
    files = [tmp_path / "one.npz", tmp_path / "two.npz", tmp_path / "none.npz"]
    write_samples(files[0], samples[:2], CONFIG, {})
    write_samples(files[1], samples[2:], CONFIG, {})
    write_samples(files[2], [], CONFIG, {})
    stored = SampleSet.read(files, CONFIG)
    assert len(stored) == len(samples)
    batch = stored.batch(range(len(samples)))
    for number, sample in enumerate(samples):
        np.testing.assert_array_equal(batch.channels[number], sample.patch.channels())
        here = batch.sample == number
        np.testing.assert_array_equal(batch.cell[here], sample.potentials.rows * 64 + sample.potentials.cols)
        np.testing.assert_allclose(batch.potentials[here, 0], sample.potentials.area, atol=0.002)
        np.testing.assert_allclose(batch.potentials[here, 1:], sample.potentials.objects, atol=0.002)
        assert (batch.counts[here, 1 + BED] == (not sample.seen_goals >> BED & 1)).all()
        assert batch.counts[here, 0].all()
    with pytest.raises(ConfigError, match=r"\(walks\)"):
        SampleSet.read(files, SampleConfig(walks=9, maps=3, most_steps=60, cells=64, map_cells=700))
    (tmp_path / "broken.npz").write_bytes(b"no zip")
    with pytest.raises(ConfigError, match=wording.IS_NOT_A_FILE_OF_SAMPLES):
        SampleSet.read([tmp_path / "broken.npz"], CONFIG)


def test_the_storeys_of_a_house_are_held_back_together():
    names = [f"large_{number:03d}" for number in range(40)]
    for name in names:
        plan, upper = Path("plans") / f"{name}.npz", Path("plans") / f"{storey_name(name, 1)}.npz"
        assert upper.name == f"{name}_storey_1.npz"
        assert held_back(plan) == held_back(upper) == held_back(Path("samples") / f"large-{upper.name}")
    assert {held_back(Path(f"{name}.npz")) for name in names} == {False, True}


@pytest.mark.parametrize(
    ("name", "house"),
    [("flat", "flat"), ("flat_storey_12", "flat"), ("a_storey_b", "a_storey_b"), ("a_storey_1_storey_2", "a_storey_1")],
)
def test_the_name_of_a_plan_names_its_house(name: str, house: str):
    assert house_of(name) == house


def test_the_plans_of_the_page_on_learned_exploration_are_held_back_as_before():
    names = [f"train_any_{number:06d}" for number in range(240)]
    names += [f"train_large_{number:06d}" for number in range(5000, 5042)]
    held = [name for name in names if held_back(Path(f"{name}.npz"))]
    assert len(held) == 36
    assert held == [name for name in names if zlib.crc32(name.encode()) % 8 == 0]


def test_a_turned_sample_is_the_turned_map_with_its_frontiers(tmp_path: Path, samples: list[Sample]):
    write_samples(tmp_path / "one.npz", samples[:1], CONFIG, {})
    stored = SampleSet.read([tmp_path / "one.npz"], CONFIG)
    plain = stored.batch([0])
    seen = []
    for symmetry in range(SYMMETRIES):
        batch = stored.batch([0], [symmetry])
        turned = np.rot90(plain.channels[0], symmetry // 2, (1, 2))
        turned = turned[:, :, ::-1] if symmetry % 2 else turned
        np.testing.assert_array_equal(batch.channels[0], turned)
        marked, expected = np.zeros(64 * 64), np.zeros(64 * 64)
        marked[batch.cell], expected[plain.cell] = batch.potentials[:, 0] + 1.0, plain.potentials[:, 0] + 1.0
        image = np.rot90(expected.reshape(64, 64), symmetry // 2)
        np.testing.assert_array_equal(marked.reshape(64, 64), image[:, ::-1] if symmetry % 2 else image)
        seen.append(batch.channels.tobytes())
    assert len(set(seen)) == SYMMETRIES
    assert plain.channels.shape[1] == len(LAYERS) + len(GOAL_CATEGORIES)


def test_choices_compare_the_best_predicted_frontier_with_the_best_one():
    maps = 1 + len(GOAL_CATEGORIES)
    true, guess, counts = np.zeros((5, maps), np.float32), np.zeros((5, maps), np.float32), np.zeros((5, maps), bool)
    counts[:, [0, 1 + BED]] = True
    true[:, 0], guess[:, 0] = [0.1, 0.2, 0.8, 0.8, 0.0], [0.9, 0.1, 0.1, 0.2, 0.0]
    true[:, 1 + BED], guess[:, 1 + BED] = [0.0, 0.4, 0.0, 0.8, 0.0], [0.0, 0.1, 0.0, 0.6, 0.0]
    batch = Batch(
        np.zeros((1, 25, 8, 8), np.uint8),
        np.zeros(5, np.int64),
        np.arange(5),
        true,
        counts,
        np.array([4, 4, 7, 7, 9]),
        np.array([1.0, 2.0, 5.0, 6.0, 0.5], np.float32),
    )
    area, objects = Choices(), Choices()
    add_choices(batch, guess, area, objects)
    assert (area.count, objects.count) == (1, 1)  # for the other categories all frontiers are equal
    assert area.hits == {"predicted": 0.0, "random": pytest.approx(1 / 3), "nearest": 0.0}
    assert objects.hits == {"predicted": 1.0, "random": pytest.approx(1 / 3), "nearest": 0.0}
    assert objects.shares()["random_potential"] == pytest.approx((0.4 + 0.8) / 3 / 0.8)
    assert math.isclose(area.shares()["predicted_potential"], 0.25, rel_tol=1e-6)
