"""Intersection over union, calibration, and the softmax temperature."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from sim.core.interface import MPCAT40_ID
from sim.training.segmentation.evaluation import GOAL_CHANNELS, Confusions, Iou, Reliability, calibrated_iou, confusion
from sim.training.segmentation.samples import IGNORED
from stubborn.segmentation.rednet import CLASSES


def test_iou_agrees_with_a_computation_by_hand() -> None:
    wall, chair, sofa = (MPCAT40_ID[name] - 1 for name in ("wall", "chair", "sofa"))
    truth = np.array([wall, wall, wall, chair, chair, sofa, IGNORED])
    predicted = np.array([wall, wall, chair, chair, sofa, sofa, wall])
    iou = Iou.of(confusion(predicted, truth))
    assert iou.by_category == pytest.approx({"wall": 2 / 3, "chair": 1 / 3, "sofa": 1 / 2})
    assert iou.goals == pytest.approx((1 / 3 + 1 / 2) / 2)
    assert iou.everything == pytest.approx((2 / 3 + 1 / 3 + 1 / 2) / 3)
    assert iou.accuracy == pytest.approx(4 / 6)


def test_only_an_overconfident_score_has_a_calibration_error() -> None:
    rng = np.random.default_rng(0)
    channel, p = int(GOAL_CHANNELS[0]), 0.7
    truth = np.where(rng.random(20_000) < p, channel, 0)
    probability = np.zeros((CLASSES, truth.size), np.float32)
    probability[channel] = p
    honest, overconfident = Reliability.empty(), Reliability.empty()
    honest.add(probability, truth)
    probability[channel] = 0.95
    overconfident.add(probability, truth)
    assert honest.error < 0.01
    assert overconfident.error == pytest.approx(0.25, abs=0.01)
    ((count, score, right),) = honest.rows()
    assert (count, score) == (20_000, pytest.approx(0.7))
    assert right == pytest.approx(0.7, abs=0.01)


def test_a_constant_error_of_the_logits_is_calibrated_away_on_views_that_it_was_not_fitted_to() -> None:
    """A network that gives walls a far too large logit."""
    rng = torch.Generator().manual_seed(0)
    wall, chair = (MPCAT40_ID[name] - 1 for name in ("wall", "chair"))
    views = []
    for _ in range(8):
        truth = torch.where(torch.rand(32, 32, generator=rng) < 0.5, wall, chair)
        logits = torch.randn(CLASSES, 32, 32, generator=rng)
        logits += 8.0 * torch.nn.functional.one_hot(truth, CLASSES).permute(2, 0, 1)
        logits[wall] += 9.0
        views.append((logits.half(), truth))
    raw = sum(confusion(logits.argmax(dim=0).numpy(), truth.numpy()) for logits, truth in views)
    assert Iou.of(np.asarray(raw)).by_category["chair"] < 0.5
    assert calibrated_iou(views).by_category["chair"] > 0.85


def test_the_interval_of_the_miou_is_over_houses() -> None:
    right, wrong = np.zeros((40, 40), np.int64), np.zeros((40, 40), np.int64)
    chair, wall = GOAL_CHANNELS[0], 0
    right[chair, chair] = wrong[chair, wall] = 10
    counts = Confusions()
    for number in range(8):
        counts.add("views", f"house_{number}", wrong if number % 4 == 0 else right)
        counts.add("views", f"house_{number}", wrong if number % 4 == 0 else right)  # a second view of the house
    counts.add("more", "house_0", right)
    assert counts.folders() == ["views", "more"]
    assert counts.of("more").sum() == 10
    assert counts.of().sum() == 170
    assert counts.goals_text("more") == "1.000"
    value, low, high = (float(text.strip("[],")) for text in counts.goals_text("views").split())
    assert value == 0.75
    assert low in (0.375, 0.5)  # 3 of 8 houses or fewer are right in 2.7 % of the draws, 4 or fewer in 11 %
    assert high == 1.0


def test_the_difference_of_two_networks_is_taken_on_the_same_draws_of_houses() -> None:
    chair, wall = GOAL_CHANNELS[0], 0
    ours, theirs = Confusions(), Confusions()
    for number in range(10):
        easy = 90 if number % 2 else 40
        for counts, right in ((ours, easy + 5), (theirs, easy)):
            matrix = np.zeros((40, 40), np.int64)
            matrix[chair, chair], matrix[chair, wall] = right, 100 - right
            counts.add("views", f"house_{number}", matrix)
    assert ours.goals_text() != theirs.goals_text()
    assert ours.difference_text(theirs) == "+0.050 [0.050, 0.050]"
    assert theirs.difference_text(ours) == "-0.050 [-0.050, -0.050]"
