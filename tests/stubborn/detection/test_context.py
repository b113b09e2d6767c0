"""The objects nearby as evidence: what the model says, what tracks make of it, its files, and the fit."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from sim.core.interface import GOAL_CATEGORIES, MPCAT40_ID, ConfigError
from sim.training.fits.context import fit, log_losses, surroundings
from stubborn.detection.context import OBJECTS, SHIPPED, Context, content_of, read_context
from tests.helpers import wording
from tests.stubborn.detection.test_tracks import PICTURE, TABLE, VIEWS, look, of, tracked

SINK, TOWEL, BED, PICTURE_ID = (OBJECTS.index(name) for name in ("sink", "towel", "bed", "picture"))


def context(radius_m: float = 2.5, **weights: float) -> Context:
    """Returns a model in which an object near a table is more probably one of these categories."""
    weight = np.zeros((len(OBJECTS), len(OBJECTS)), np.float32)
    for name, each in weights.items():
        weight[OBJECTS.index(name), OBJECTS.index("table")] = each
    frequency = np.full(len(OBJECTS), 1.0 / len(OBJECTS), np.float32)
    return Context(radius_m=radius_m, frequency=frequency, constant=np.zeros_like(frequency), weight=weight)


def near(*names: str) -> np.ndarray:
    return np.array([[name in names for name in OBJECTS]], np.float32)


def test_a_fit_needs_a_category_with_enough_objects():
    every = np.arange(120) % len(OBJECTS)
    with pytest.raises(ConfigError, match="No category of objects is 10 times in the plans"):
        fit([(np.zeros((120, len(OBJECTS)), np.float32), every)], 2.5)


def test_the_shipped_model_knows_homes():
    shipped = read_context()
    alone, by_sink = shipped.log_ratios(near()), shipped.log_ratios(near("sink", "toilet"))
    assert by_sink[0, TOWEL] - by_sink[0, BED] > alone[0, TOWEL] - alone[0, BED] + 2.0
    assert shipped.log_ratios(near("sofa"))[0, OBJECTS.index("cushion")] > 1.0
    assert not np.diag(shipped.weight).any()
    assert set(GOAL_CATEGORIES) <= set(OBJECTS)


def test_the_probabilities_that_follow_add_up_to_one():
    shipped = read_context()
    p = shipped.frequency * np.exp(shipped.log_ratios(near("bed", "mirror")))
    assert p.sum() == pytest.approx(1.0, abs=0.01)  # frequencies in the file are rounded
    few = context()
    few.frequency[:2], few.frequency[2:], few.constant[0] = 0.5, 0.0, np.log(3.0)
    np.testing.assert_allclose(np.exp(few.log_ratios(near())[0, :3]), [1.5, 0.5, 1.0], rtol=1e-5)


def test_a_track_is_weighed_by_the_other_tracks_within_the_radius():
    tracks = tracked()
    for pose in VIEWS:
        look(tracks, pose, TABLE, PICTURE, goal="table", taken_for="bed")
    goal, plain = "bed", tracks.probabilities("bed")
    track = int(plain.argmax())
    assert 0.3 < plain[track] < 0.95
    # The picture is 2.2 m from the table, which is a bed with the rest of its probability.
    of_picture = context(bed=0.0)
    of_picture.weight[BED, PICTURE_ID] = 2.0
    higher = tracks.probabilities(goal, 1, of_picture, 1.0)
    assert higher[track] > plain[track] + 0.03
    assert plain[track] < tracks.probabilities(goal, 1, of_picture, 0.5)[track] < higher[track]
    of_picture.weight[BED, PICTURE_ID] = 20.0
    assert 0.99 < tracks.probabilities(goal, 1, of_picture, 1.0).max() <= 1.0
    near_only = Context(
        radius_m=1.5, frequency=of_picture.frequency, constant=of_picture.constant, weight=of_picture.weight
    )
    assert tracks.probabilities(goal, 1, near_only, 1.0)[track] == pytest.approx(plain[track], abs=0.02)
    assert tracks.probabilities(goal, 10**6, of_picture, 1.0).max() == 0.0


def test_only_tracks_with_enough_voxels_are_context_and_certain_ones_give_no_nan():
    tracks = tracked()
    for pose in VIEWS:
        look(tracks, pose, TABLE, PICTURE, goal="table", taken_for="bed")
    (picture,) = of(tracks, "picture")
    of_picture = context()
    of_picture.weight[BED, PICTURE_ID] = 2.0
    tracks.evidence.probability[picture] = np.eye(40, dtype=np.float32)[MPCAT40_ID["picture"] - 1]
    certain = tracks.probabilities("bed", 6, of_picture, 1.0)
    track = int(tracks.probabilities("bed").argmax())
    assert certain[track] > tracks.probabilities("bed")[track] + 0.03
    tracks._size[picture] = 5
    assert tracks.probabilities("bed", 6, of_picture, 1.0)[track] == pytest.approx(
        tracks.probabilities("bed")[track], abs=1e-3
    )


def test_a_track_is_no_context_of_itself():
    tracks = tracked()
    look(tracks, VIEWS[0], TABLE, goal="bed", taken_for="bed")
    plain = tracks.probabilities("bed", least_voxels=20)
    assert (plain > 0.1).sum() == 1
    np.testing.assert_allclose(tracks.probabilities("bed", 20, context(bed=3.0), 1.0), plain, atol=1e-3)


def test_a_file_is_read_as_it_was_written(tmp_path: Path):
    file = tmp_path / "context.json"
    given = context(1.25, bed=1.5, towel=-0.75)
    file.write_text(json.dumps({"context": content_of(given)}))
    found = read_context(file)
    assert found.radius_m == 1.25
    np.testing.assert_array_equal(found.weight, given.weight)
    np.testing.assert_allclose(found.frequency, given.frequency, rtol=1e-2)


@pytest.mark.parametrize(
    ("entry", "value", "message"),
    [
        (("unicorn",), {"frequency": 0.1, "constant": 0.0, "nearby": {}}, "'unicorn'"),
        (("bed", "nearby", "wall"), 1.0, "'wall'"),
        (("bed",), None, wording.EXPECTED_OBJECT_GOT_NULL),
        (("bed", "frequency"), 1e-50, "frequency"),
        (("bed", "constant"), "high", "constant"),
    ],
)
def test_a_wrong_file_is_refused_by_its_entry(tmp_path: Path, entry: tuple[str, ...], value: object, message: str):
    content = json.loads(SHIPPED.read_text())
    *path, last = entry
    part = content["context"]["objects"]
    for name in path:
        part = part[name]
    part[last] = value
    file = tmp_path / "context.json"
    file.write_text(json.dumps(content))
    with pytest.raises(ConfigError, match=message):
        read_context(file)


def test_a_category_that_a_file_leaves_out_has_the_ratio_1(tmp_path: Path):
    content = json.loads(SHIPPED.read_text())
    del content["context"]["objects"]["bed"]
    file = tmp_path / "context.json"
    file.write_text(json.dumps(content))
    found = read_context(file)
    ratios = found.log_ratios(near("mirror", "clothes"))[0]
    assert ratios[BED] == 0.0
    assert (np.delete(ratios, BED) != 0.0).all()
    again = json.loads(json.dumps(content_of(found)))
    assert again["objects"].keys() == content["context"]["objects"].keys()
    content["context"]["objects"] = {}
    file.write_text(json.dumps(content))
    with pytest.raises(ConfigError, match="objects"):
        read_context(file)


def bathroom_and_bedroom(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Returns objects of a house: a sink, a towel and a mirror here, a bed, clothes and a mirror 8 m away; a wall."""
    names = ("sink", "towel", "mirror", "wall", "bed", "clothes", "mirror")
    x_m = np.repeat((0.0, 8.0), (4, 3)) + rng.uniform(-0.5, 0.5, 7)
    return x_m, rng.uniform(-0.5, 0.5, 7), np.array([MPCAT40_ID[name] for name in names])


def test_the_fit_finds_what_is_near_what():
    rng = np.random.default_rng(0)
    houses = [surroundings(*bathroom_and_bedroom(rng), 2.5, rng) for _ in range(200)]
    assert all(len(category) == 6 for _, category in houses)  # a wall is no object
    found = fit(houses[:180], 2.5, steps=200)
    ratio = found.log_ratios(near("sink"))[0]
    assert ratio[TOWEL] > ratio[OBJECTS.index("mirror")] > ratio[OBJECTS.index("clothes")]
    assert not np.diag(found.weight).any()
    assert np.abs(fit(houses[:25], 2.5, steps=200).weight).max() < np.abs(found.weight).max()
    absent = OBJECTS.index("cushion")
    assert found.frequency[absent] == ratio[absent] == 0.0
    alone, with_context = log_losses(found, houses[180:])
    assert with_context < alone - 0.3
    assert alone == pytest.approx(np.log(5.0), abs=0.2)  # five categories, of which one is twice as frequent


def test_a_part_of_what_is_around_is_seen():
    x_m, y_m, category = np.zeros(40), np.arange(40) * 0.01, np.full(40, MPCAT40_ID["chair"])
    category[20:] = MPCAT40_ID["table"]
    rng = np.random.default_rng(0)
    many, _ = surroundings(x_m, y_m, category, 1.0, rng)
    assert many[:, OBJECTS.index("chair")].mean() > 0.9
    few, _ = surroundings(x_m[19:21], y_m[19:21], category[19:21], 1.0, rng)
    again = [surroundings(x_m[19:21], y_m[19:21], category[19:21], 1.0, rng)[0].sum() for _ in range(100)]
    assert few.shape == (2, len(OBJECTS))
    assert 0.8 < np.mean(again) < 1.5  # 0.575 of two


def test_objects_of_unknown_categories_are_not_judged():
    rng = np.random.default_rng(0)
    houses = [surroundings(*bathroom_and_bedroom(rng), 2.5, rng) for _ in range(30)]
    found = fit(houses, 2.5, steps=50)
    cushions = (np.zeros((5, len(OBJECTS)), np.float32), np.full(5, OBJECTS.index("cushion")))
    assert log_losses(found, [*houses, cushions]) == log_losses(found, houses)
    with pytest.raises(ConfigError, match="held back"):
        log_losses(found, [cushions])


def test_too_few_objects_are_refused():
    with pytest.raises(ConfigError, match="100 are needed"):
        fit([], 2.5)
