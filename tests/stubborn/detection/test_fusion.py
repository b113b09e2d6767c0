"""The fusion of views: competing categories, the weight of the distance, its files, and the fit of its parameters."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import torch

from sim.core.interface import MPCAT40, ConfigError, SegmenterSpec
from sim.training.fits.fusion import Sample, _Data, fit, judge, left_out, probabilities, samples_of, true_category
from stubborn.detection.evidence import EvidenceConfig
from stubborn.detection.fusion import FOLDER, IS_SURFACE, SURFACES, Fusion, fusion_for, read_fusion

CHAIR, TABLE, WALL = (MPCAT40.index(name) - 1 for name in ("chair", "table", "wall"))
CLASSES = len(MPCAT40) - 1
NEAR, FAR = 12, 36
"""Numbers of a view of full weight, and of one from far away."""


def posterior(**shares: float) -> np.ndarray:
    """Returns the posterior of a view; the rest is spread over all other categories."""
    result = np.full(CLASSES, (1.0 - sum(shares.values())) / (CLASSES - len(shares)), np.float32)
    for name, share in shares.items():
        result[MPCAT40.index(name) - 1] = share
    return result


def fused(fusion: Fusion, *views: tuple[np.ndarray, float]) -> np.ndarray:
    mean = np.stack([mean for mean, _ in views])[None]
    return fusion.probabilities(mean, np.array([[weight for _, weight in views]], np.float32))[0]


def test_the_wall_behind_an_object_takes_nothing_from_it():
    alone, hung = fused(Fusion(), (posterior(chair=0.9), 1.0)), fused(Fusion(), (posterior(chair=0.5, wall=0.45), 1.0))
    assert alone.sum() == pytest.approx(1.0, abs=1e-5)
    assert hung[CHAIR] == pytest.approx(alone[CHAIR], abs=0.06)
    assert fused(Fusion(), (posterior(chair=0.02, wall=0.97), 1.0))[CHAIR] < 0.5 * hung[CHAIR]


def test_views_are_averaged_by_weight_and_more_views_are_surer():
    chair, table = posterior(chair=0.8, table=0.15), posterior(chair=0.15, table=0.8)
    fusion = Fusion(growth=0.5)
    assert fused(fusion, (chair, 1.0), (table, 1.0))[CHAIR] == pytest.approx(
        fused(fusion, (chair, 1.0), (table, 1.0))[TABLE], abs=1e-5
    )
    assert fused(fusion, (chair, 1.0), (table, 0.2))[CHAIR] > 0.6
    assert fused(fusion, (chair, 1.0), (chair, 1.0))[CHAIR] > fused(fusion, (chair, 1.0))[CHAIR] + 0.02


def test_an_offset_moves_the_log_odds_of_its_category():
    view = (posterior(chair=0.5, table=0.45), 1.0)
    plain, shifted = fused(Fusion(), view), fused(Fusion(offsets={"table": 1.0}), view)
    ratio = (shifted[TABLE] / shifted[CHAIR]) / (plain[TABLE] / plain[CHAIR])
    assert ratio == pytest.approx(np.e, rel=1e-3)


def test_a_track_without_views_has_no_nan():
    p = Fusion().probabilities(np.zeros((1, 2, CLASSES), np.float32), np.zeros((1, 2), np.float32))
    assert np.isfinite(p).all()
    assert p.sum() == pytest.approx(1.0, abs=1e-5)


def test_many_uninformative_views_give_no_nan():
    uniform = np.full((1, 48, CLASSES), 1.0 / CLASSES, np.float32)
    p = Fusion(growth=1.0, sharpness=1.5).probabilities(uniform, np.ones((1, 48), np.float32))
    assert np.isfinite(p).all()


@pytest.mark.parametrize(
    "wrong", [{"offsets": {"wall": 1.0}}, {"offsets": {"unicorn": 1.0}}, {"sharpness": 0.0}, {"ring_weights": ()}]
)
def test_wrong_parameters_are_refused(wrong: dict):
    with pytest.raises(ConfigError, match="Fusion"):
        Fusion(**wrong)


def test_every_imperfect_segmentation_has_a_file_and_exact_ones_need_no_file():
    assert fusion_for(SegmenterSpec(needs_verification=False)) == Fusion()
    for kind in ("rednet", "noisy"):
        assert fusion_for(SegmenterSpec(kind=kind)) == read_fusion(FOLDER / f"{kind}.json")
        assert len(fusion_for(SegmenterSpec(kind=kind)).ring_weights) == len(EvidenceConfig().rings_m) + 1


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"sharpness": None}, "sharpness"),
        ({"sharpness": "high"}, "sharpness"),
        ({"ring_weights": [1.0]}, "ring_weights"),
        ({"floor": -1.0}, "floor"),
        ({"offsets": {"unicorn": 1.0}}, "unicorn"),
    ],
)
def test_a_wrong_file_is_refused_by_its_field(tmp_path: Path, change: dict, message: str):
    content = json.loads((FOLDER / "rednet.json").read_text())
    content["fusion"] |= change
    file = tmp_path / "fusion.json"
    file.write_text(json.dumps(content))
    with pytest.raises(ConfigError, match=message):
        fusion_for(SegmenterSpec(), file)
    with pytest.raises(ConfigError, match="nowhere"):
        fusion_for(SegmenterSpec(), tmp_path / "nowhere.json")


def test_a_track_has_the_category_of_a_quarter_of_its_pixels():
    counts = np.zeros(len(MPCAT40), np.int64)
    counts[MPCAT40.index("wall")], counts[MPCAT40.index("chair")], counts[0] = 60, 30, 10
    assert true_category(counts) == CHAIR
    counts[MPCAT40.index("chair")] = 10
    assert true_category(counts) == -1


def sampled(n: int, *, chairs_called_tables: float = 0.0, far_lies: bool = False) -> list[Sample]:
    """Returns tracks of chairs and tables whose network takes some chairs for tables, or is wrong from far away."""
    rng = np.random.default_rng(0)
    result = []
    for i in range(n):
        category = (CHAIR, TABLE)[i % 2]
        seen = TABLE if category == CHAIR and rng.random() < chairs_called_tables else category
        views = [NEAR] if i % 3 else [NEAR, FAR]
        mean = []
        for view in views:
            shown = rng.choice([CHAIR, TABLE]) if far_lies and view == FAR else seen
            mean.append(posterior(**{MPCAT40[1 + shown]: 0.7, "wall": 0.1}))
        weight = np.ones(len(views), np.float32)
        result.append(Sample(f"house_{i % 7}", category, np.array(views), np.stack(mean), weight))
    return result


@pytest.mark.costly
def test_the_fit_finds_how_often_a_category_is_missed():
    samples = sampled(400, chairs_called_tables=0.4)
    fusion = fit(samples)
    assert fusion.offsets["chair"] - fusion.offsets["table"] > 0.3
    p = probabilities(fusion, [each for each in samples if each.mean[0].argmax() == TABLE])
    assert p[:, TABLE].mean() == pytest.approx(1.0 / 1.4, abs=0.1)  # true tables among apparent ones
    plain, quality = judge(probabilities(Fusion(), samples), samples), judge(left_out(samples), samples)
    assert quality["log_loss"] < plain["log_loss"]
    assert sum(row["n"] for row in quality["calibration"]) == quality["pairs"]


@pytest.mark.costly
def test_the_fit_finds_that_far_views_are_worth_less():
    assert fit(sampled(400, far_lies=True)).ring_weights[3] < 0.3 < fit(sampled(400)).ring_weights[3]


def test_the_fit_maximises_the_likelihood_that_the_agent_computes():
    samples = sampled(200, far_lies=True)
    fusion = fit(samples)
    free = {
        "rings": torch.tensor(np.log(fusion.ring_weights)),
        "sharpness": torch.tensor(np.log(fusion.sharpness)),
        "growth": torch.tensor(fusion.growth),
        "floor": torch.tensor(np.log(fusion.floor)),
        "surface": torch.tensor(fusion.surface),
        "offsets": torch.tensor([fusion.offsets[name] for name in MPCAT40[1:] if name not in SURFACES]),
    }
    p = torch.softmax(_Data.of(samples).log_odds({k: v.float() for k, v in free.items()}), dim=1).numpy()
    np.testing.assert_allclose(p[:, :-1], probabilities(fusion, samples)[:, ~IS_SURFACE], atol=2e-4)


def test_too_few_tracks_are_refused():
    with pytest.raises(ConfigError, match="100 are needed"):
        fit(sampled(50))


def test_a_track_enters_as_often_as_it_was_logged():
    counts = np.zeros((3, len(MPCAT40)), np.int32)
    counts[:2, MPCAT40.index("chair")] = 50  # no pixel shows the third one
    episode = {
        "house": "a",
        "counts": counts,
        "track": np.array([0, 0, 1, 2]),
        "sample": np.array([0, 1, 1, 1, 2, 3]),
        "view": np.array([NEAR, NEAR, NEAR + 1, FAR, NEAR, NEAR]),
        "mean": np.stack([posterior(chair=0.9)] * 6),
        "weight": np.ones(6, np.float16),
    }
    samples = samples_of([episode])
    assert [len(each.view) for each in samples] == [1, 3, 1]
    assert {each.category for each in samples} == {CHAIR}
