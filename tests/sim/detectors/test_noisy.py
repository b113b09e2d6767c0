"""The noisy detector: the rates and durations of its errors agree with its configuration."""

from __future__ import annotations

import json
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest

from sim.app.commands import run
from sim.app.options import RunOptions
from sim.core.geometry.pose import Pose
from sim.core.interface import GOAL_CATEGORIES, MPCAT40, MPCAT40_ID, Action, ConfigError
from sim.detectors.confusions import CONFUSIONS
from sim.detectors.noisy import Classification, LabelledObjects, NoisyConfig, NoisySegmenter
from sim.env.objectnav import ObjectNavEnv
from tests.helpers.worlds import room, with_box

COUNT = 6000
LARGE = np.full(COUNT, 0.2)
"""A share of the frame at which no object is missed because of its size."""
FLAWLESS = NoisyConfig(
    lookalike_share=0.0,
    mistake_rate=0.0,
    flicker_rate=0.0,
    miss_rate=0.0,
    miss_share=1e-9,
    blob_logit=0.0,
    outline_px=0.0,
)


def objects(category: str, count: int = COUNT) -> LabelledObjects:
    names = [f"{category}_{i:05d}" for i in range(count)]
    return LabelledObjects.named(names, [category] * count, np.zeros((count, 2)), np.arange(count))


def seen(
    config: NoisyConfig, of: LabelledObjects, *, share=LARGE, eye=(2.0, 0.5), seed: int = 1, frame: int = 0
) -> Classification:
    segmenter = NoisySegmenter(None, config)  # type: ignore[arg-type] # `classify` does not read the episode
    return segmenter.classify(of, share, eye, seed, np.random.default_rng([seed, frame]))


def near(rate: float) -> float:
    """Returns four standard deviations of a share of `COUNT`."""
    return 4.0 * np.sqrt(rate * (1.0 - rate) / COUNT) + 1e-9


def test_views_are_mistaken_as_often_as_the_rates_say():
    config = replace(FLAWLESS, lookalike_share=0.3, lookalike_rate=0.5, mistake_rate=0.1)
    mistaken = (seen(config, objects("chair")).first != MPCAT40_ID["chair"]).mean()
    expected = 0.3 * 0.5 + 0.7 * 0.1
    assert mistaken == pytest.approx(expected, abs=near(expected))


def test_errors_have_the_shares_of_the_table():
    first = seen(replace(FLAWLESS, mistake_rate=1.0), objects("sofa")).first
    for name, share in CONFUSIONS["sofa"].items():
        assert (first == MPCAT40_ID[name]).mean() == pytest.approx(share, abs=near(share))


def test_a_category_without_a_row_has_no_errors():
    config = replace(FLAWLESS, mistake_rate=1.0, flicker_rate=1.0, lookalike_share=1.0)
    assert (seen(config, objects("wall")).first == MPCAT40_ID["wall"]).all()


def test_an_error_lasts_over_the_frames_and_small_moves_of_a_view_and_not_beyond():
    of, config = objects("table"), replace(FLAWLESS, mistake_rate=0.3)
    here = seen(config, of).first
    np.testing.assert_array_equal(here, seen(config, of, frame=99).first)
    moved = seen(config, of, eye=(2.05, 0.52)).first
    assert (moved == here).mean() > 0.95  # except for the few that lie on the edge of a sector
    was_mistaken = here != MPCAT40_ID["table"]
    for elsewhere in ((-2.0, -0.5), (0.6, 0.15), (4.0, 1.0)):  # another side, nearer, farther
        again = seen(config, of, eye=elsewhere).first[was_mistaken] != MPCAT40_ID["table"]
        assert again.mean() == pytest.approx(0.3, abs=0.06)


def test_a_lookalike_resembles_one_category_from_most_sides():
    of, config = objects("cabinet"), replace(FLAWLESS, lookalike_share=0.2, lookalike_rate=0.7)
    views = [seen(config, of, eye=(3 * np.cos(a), 3 * np.sin(a))).first for a in np.arange(8) * np.pi / 4 + 0.1]
    mistaken = np.array(views) != MPCAT40_ID["cabinet"]
    ever = mistaken.any(axis=0)
    assert ever.mean() == pytest.approx(0.2, abs=near(0.2) + 0.001)
    assert mistaken[:, ever].mean() == pytest.approx(0.7, abs=0.05)
    for view, also in zip(views, mistaken, strict=True):
        np.testing.assert_array_equal(view[also], np.array(views).max(axis=0, where=mistaken, initial=0)[also])


def test_flicker_lasts_one_frame():
    of, config = objects("chair"), replace(FLAWLESS, flicker_rate=0.05)
    frames = np.array([seen(config, of, frame=i).first for i in range(8)]) != MPCAT40_ID["chair"]
    assert frames.mean() == pytest.approx(0.05, abs=0.006)
    assert (frames[1:] & frames[:-1]).mean() == pytest.approx(0.05**2, abs=0.002)


@pytest.mark.parametrize("share", [0.0005, 0.003, 0.008, 0.1])
def test_small_objects_are_missed_as_often_as_configured(share: float):
    config = replace(FLAWLESS, miss_rate=0.04, miss_share=0.003)
    expected = 0.04 + 0.96 * np.exp(-share / 0.003)
    missed = (seen(config, objects("cushion"), share=np.full(COUNT, share)).first == 0).mean()
    assert missed == pytest.approx(expected, abs=near(expected))


def test_an_object_missed_at_a_small_size_is_detected_at_a_large_one_and_never_the_reverse():
    of, config = objects("cushion"), replace(FLAWLESS, miss_share=0.003)
    small = seen(config, of, share=np.full(COUNT, 0.002)).first == 0
    large = seen(config, of, share=np.full(COUNT, 0.02), frame=1).first == 0
    assert small.sum() > 1000 > large.sum()
    assert not (large & ~small).any()


def test_confidence_has_the_mean_and_deviation_of_the_config():
    config = replace(FLAWLESS, confidence=(0.8, 0.05), mistaken_confidence=(0.6, 0.05), object_logit=0.0)
    right = seen(config, objects("bed")).confidence
    assert (right.mean(), right.std()) == pytest.approx((0.8, 0.05), abs=0.005)
    wrong = seen(replace(config, mistake_rate=1.0, lookalike_share=0.0), objects("sofa")).confidence
    assert (wrong.mean(), wrong.std()) == pytest.approx((0.6, 0.05), abs=0.005)


def test_the_table_names_categories_and_its_shares_are_shares():
    for name, row in CONFUSIONS.items():
        assert name in MPCAT40
        assert name not in row
        assert set(row) <= set(MPCAT40) - {"void"}
        assert 0.0 < sum(row.values()) <= 1.0 + 1e-9
    for goal in GOAL_CATEGORIES:
        assert any(goal in row for row in CONFUSIONS.values()), f"no category is ever classified as {goal}"


@pytest.fixture(scope="module")
def house(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("semantics") / "two_seats.xml"
    furnished = with_box(room(8, 8), "sofa_00", centre_m=(3.0, 1.2, 0.4), half_m=(0.4, 0.8, 0.4))
    furnished = with_box(furnished, "seating_00", centre_m=(3.0, -1.4, 0.3), half_m=(0.4, 0.6, 0.3))
    file.write_text(furnished.spec.to_xml())
    return file


@pytest.fixture(scope="module")
def env(house: Path):
    start = Pose(0.0, 0.0, 0.0)
    made = ObjectNavEnv(house=house, goal="sofa", start=start, sensors=("depth", "semantic"), truth=("geom",))
    yield made
    made.close()


def scores_of_frames(env: ObjectNavEnv, segmenter: NoisySegmenter, seed: int) -> list[np.ndarray]:
    """Returns the scores of some frames of an episode."""
    observation, _ = env.reset(seed=seed, options={"episode": env.draw_episode(np.random.default_rng(0))})
    frames = []
    for action in (Action.TURN_LEFT, Action.TURN_RIGHT, Action.MOVE_FORWARD, Action.MOVE_FORWARD):
        frames.append(np.stack(segmenter.scores(observation, "sofa")))
        observation, *_ = env.step(action)
    return frames


def test_scores_are_probabilities_at_a_fraction_of_the_image(env: ObjectNavEnv):
    for frame in scores_of_frames(env, NoisySegmenter(env), seed=3):
        assert frame.shape == (2, 120, 160)
        assert frame.dtype == np.float32
        assert frame.min() >= 0.0
        assert frame.sum(axis=0).max() <= 1.0 + 1e-5


def test_the_same_seed_gives_the_same_scores_after_any_other_episode(env: ObjectNavEnv):
    segmenter = NoisySegmenter(env)
    once = scores_of_frames(env, segmenter, seed=3)
    other = scores_of_frames(env, segmenter, seed=4)
    again, fresh = scores_of_frames(env, segmenter, seed=3), scores_of_frames(env, NoisySegmenter(env), seed=3)
    np.testing.assert_array_equal(once, again)
    np.testing.assert_array_equal(once, fresh)
    assert np.abs(np.array(once) - np.array(other)).max() > 0.05


def test_without_errors_the_scores_are_the_ground_truth(env: ObjectNavEnv):
    segmenter = NoisySegmenter(env, FLAWLESS)
    observation, _ = env.reset(seed=0, options={"episode": env.draw_episode(np.random.default_rng(0))})
    truth = observation["semantic"][2::4, 2::4] == MPCAT40_ID["sofa"]
    said = segmenter.scores(observation, "sofa").target > 0.5
    assert truth.sum() > 300
    assert (said & truth).sum() / (said | truth).sum() > 0.9


def test_posteriors_show_the_same_objects_and_mistakes_as_the_scores_of_the_frame(env: ObjectNavEnv):
    segmenter = NoisySegmenter(env, NoisyConfig(blob_logit=0.0, mistake_rate=0.5))
    env.reset(seed=3)
    for _ in range(4):
        observation, *_ = env.step(Action.TURN_LEFT)
        posteriors = segmenter.posteriors(observation)
        assert posteriors.shape == (40, 120, 160)
        assert posteriors.dtype == np.float32
        assert (posteriors >= 0.0).all()
        assert posteriors.sum(axis=0).max() <= 1.0 + 1e-5
        for goal in ("sofa", "seating"):
            target = segmenter.scores(observation, goal).target
            differs = np.abs(posteriors[MPCAT40_ID[goal] - 1] - target) > 0.05
            assert differs.mean() < 0.15  # outlines are blurred in the scores
            inside = np.abs(np.diff(target, axis=0, append=target[-1:])) < 1e-3
            assert differs[inside].mean() < 0.05


def test_a_sofa_taken_for_seating_has_a_high_other_score_and_seating_taken_for_a_sofa_a_high_one(env: ObjectNavEnv):
    mistaken, right = {}, {}
    for seed in range(12):
        observation, _ = env.reset(seed=seed, options={"episode": env.draw_episode(np.random.default_rng(0))})
        semantic = observation["semantic"][2::4, 2::4]
        scores = NoisySegmenter(env, replace(FLAWLESS, mistake_rate=1.0)).scores(observation, "sofa")
        mistaken[seed] = [float(np.median(scores.target[semantic == MPCAT40_ID[c]])) for c in ("sofa", "seating")]
        scores = NoisySegmenter(env, FLAWLESS).scores(observation, "sofa")
        right[seed] = [float(np.median(scores.target[semantic == MPCAT40_ID[c]])) for c in ("sofa", "seating")]
    assert all(sofa < 0.5 for sofa, _ in mistaken.values())
    assert any(seating > 0.5 for _, seating in mistaken.values())
    assert all(seating < 0.5 < sofa for sofa, seating in right.values())


@pytest.mark.costly
def test_a_run_with_noisy_semantics_is_reproducible_and_records_its_settings(house: Path, tmp_path: Path):
    lines = []
    for name in ("once", "twice"):
        args = RunOptions(house=house, goal="sofa", semantics="noisy", episodes=1, out=tmp_path / name)
        assert run.main(replace(args, config=("task.max_steps=40",))) == 0
        config = json.loads((tmp_path / name / "config.json").read_text())
        assert config["config"]["detector"] == json.loads(json.dumps(asdict(NoisyConfig())))
        (line,) = [json.loads(text) for text in (tmp_path / name / "results.jsonl").read_text().splitlines()]
        lines.append({key: value for key, value in line.items() if key not in ("wall_time_s", "steps_per_s")})
    assert lines[0] == lines[1]
    assert lines[0]["semantics"] == "noisy"


def test_rates_outside_their_range_are_refused():
    with pytest.raises(ConfigError, match=r"lookalike_share.*\[0.*1\].*1\.5"):
        NoisyConfig(lookalike_share=1.5)
    with pytest.raises(ConfigError, match="distances_m must grow"):
        NoisyConfig(distances_m=(3.0, 1.0))
    with pytest.raises(ConfigError, match="stride_px and sectors >= 1"):
        NoisyConfig(stride_px=0)
    with pytest.raises(ConfigError, match="blob_px >= 1"):
        NoisyConfig(blob_px=0)
    assert {"lookalike_share", "miss_share"} <= set(asdict(NoisyConfig()))


@pytest.mark.parametrize("goal", ["unicorn", "void"])
def test_an_unknown_goal_is_refused(env: ObjectNavEnv, goal: str):
    with pytest.raises(ConfigError, match=f"no category '{goal}'"):
        NoisySegmenter(env).scores({}, goal)
