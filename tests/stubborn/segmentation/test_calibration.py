"""Calibration of logits."""

from __future__ import annotations

import pytest
import torch

from sim.core.interface import ConfigError
from stubborn.segmentation.calibration import Calibration, fit_calibration, fit_temperature
from stubborn.segmentation.rednet import CLASSES
from tests.helpers import wording


def logits_and_truth(scale: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
    """Returns logits whose true posteriors are those of `logits * scale`."""
    torch.manual_seed(0)
    logits = 3.0 * torch.randn(20_000, CLASSES)
    truth = torch.distributions.Categorical(logits=logits * scale).sample()
    return logits, truth


def test_a_single_temperature_is_found() -> None:
    logits, truth = logits_and_truth(torch.full((CLASSES,), 0.5))
    assert fit_temperature(logits, truth) == pytest.approx(2.0, rel=0.05)
    held = fit_calibration(logits, truth, hold=float("inf"))
    assert float(held.scale[0]) == pytest.approx(0.5, rel=0.05)
    assert float(held.offset.abs().max()) == 0.0


def test_a_category_that_is_overconfident_gets_a_smaller_factor() -> None:
    scale = torch.ones(CLASSES)
    scale[4] = 0.4
    logits, truth = logits_and_truth(scale)
    fitted = fit_calibration(logits, truth, hold=1e-4)
    others = torch.cat([fitted.scale[:4], fitted.scale[5:]])
    assert float(fitted.scale[4]) < 0.65 * float(others.mean())


def test_metadata_holds_a_calibration_or_a_temperature() -> None:
    fitted = Calibration(torch.linspace(0.5, 1.5, CLASSES), torch.linspace(-1, 1, CLASSES))
    back = Calibration.from_metadata({"calibration": fitted.to_metadata()})
    torch.testing.assert_close(back.scale, fitted.scale, atol=1e-4, rtol=0)
    torch.testing.assert_close(back.offset, fitted.offset, atol=1e-4, rtol=0)
    assert float(Calibration.from_metadata({"temperature": 2.0}).scale[0]) == 0.5
    assert float(Calibration.from_metadata({}).scale[0]) == 1.0
    with pytest.raises(ConfigError, match=wording.N_40_FACTORS_AND_OFFSETS_GOT_2_AND_2):
        Calibration.from_metadata({"calibration": {"scale": [1, 2], "offset": [0, 0]}})
