"""The mean of the networks of the last evaluations, and what is left of them after a kill."""

from __future__ import annotations

from pathlib import Path

import pytest
import torch

from sim.training.segmentation.steps import AveragedCheckpoints
from stubborn.segmentation.rednet import RedNet, RedNetConfig

TINY = RedNetConfig(width=2, encoder_blocks=(1, 1, 1, 1), bottleneck=False, decoder_blocks=(1, 1, 1, 1), final_blocks=1)


def test_the_last_networks_are_kept_and_averaged_and_later_ones_removed(tmp_path: Path) -> None:
    checkpoints, means = AveragedCheckpoints(tmp_path, 3), []
    for number in (1, 2, 3, 6):
        network = RedNet(TINY)
        for parameter in network.parameters():
            torch.nn.init.constant_(parameter, float(number))
        mean = checkpoints.add(network, 1000 * number)
        values = {float(value) for parameter in mean.parameters() for value in parameter.detach().aminmax()}
        assert len(values) == 1
        means.append(values.pop())
    assert means == pytest.approx([1.0, 1.5, 2.0, 11 / 3], abs=1e-3)
    assert [file.stem for file in sorted(tmp_path.iterdir())] == ["step-0002000", "step-0003000", "step-0006000"]
    checkpoints.cut(3000)
    assert [file.stem for file in sorted(tmp_path.iterdir())] == ["step-0002000", "step-0003000"]


def test_only_networks_of_the_last_share_of_the_steps_are_averaged(tmp_path: Path) -> None:
    checkpoints = AveragedCheckpoints(tmp_path, 3, share=0.1)
    for step, expected in ((500, 1.0), (950, 2.0), (1000, 2.5)):
        network = RedNet(TINY)
        for parameter in network.parameters():
            torch.nn.init.constant_(parameter, {500: 1.0, 950: 2.0, 1000: 3.0}[step])
        mean = checkpoints.add(network, step)
        assert {float(value) for parameter in mean.parameters() for value in parameter.detach().aminmax()} == {expected}
