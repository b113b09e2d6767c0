"""The recipe of a training: its phases, widths and learning rate."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from sim.core.interface import ConfigError
from sim.training.segmentation.recipe import PROGRESSIVE, Phase, Recipe

SMALL, LARGE = (Phase(share=share, widths=(0.5 + share,), whole_share=0.0) for share in (0.25, 0.75))


def test_phases_follow_one_another_with_their_shares_and_the_last_one_has_no_end() -> None:
    recipe = Recipe(phases=(SMALL, LARGE))
    assert [recipe.phase(progress) for progress in (0.0, 0.24, 0.26, 0.99, 1.0, 1.5)] == [SMALL] * 2 + [LARGE] * 4
    widths = [phase.widths[0] for phase in PROGRESSIVE.phases]
    assert widths == sorted(widths)
    with pytest.raises(ConfigError, match=r"0.*1.*\[0.25.*0.25\]"):
        Recipe(phases=(SMALL, SMALL))


def test_widths_are_those_of_the_phase_and_never_wider_than_the_stored_views() -> None:
    rng = np.random.default_rng(0)
    first, *_, last = PROGRESSIVE.phases
    assert {PROGRESSIVE.width_px(first, 160, 320, rng) for _ in range(40)} == {96, 128}
    assert {PROGRESSIVE.width_px(last, 160, 320, rng) for _ in range(40)} == {160, 192}
    assert {PROGRESSIVE.width_px(last, 160, 160, rng) for _ in range(40)} == {160}


def test_the_learning_rate_rises_to_its_peak_and_falls_like_a_cosine_to_zero() -> None:
    recipe = Recipe(phases=(SMALL, LARGE), warmup_share=0.1)
    rates = [recipe.relative_rate(step, 1000) for step in range(1001)]
    assert rates[0] == pytest.approx(0.01)
    assert max(rates) == pytest.approx(1.0)
    assert rates.index(max(rates)) in (99, 100)
    assert all(a >= b for a, b in itertools.pairwise(rates[100:]))
    assert rates[550] == pytest.approx(0.5)
    assert rates[1000] == pytest.approx(0.0)
