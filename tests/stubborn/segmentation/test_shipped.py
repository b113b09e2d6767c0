"""The shipped network: its size, its model card, and its accuracy in a house of val."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from sim.core.interface import CameraModel
from sim.core.vocabulary import UNSEEN
from sim.env.scene import Scene
from sim.episodes.splits import load_split
from sim.robot.config import RobotConfig
from sim.training.views.views import sample_views
from stubborn.segmentation.checkpoints import load_network
from stubborn.segmentation.network import NetworkSegmenter
from stubborn.segmentation.networks import NETWORKS
from stubborn.segmentation.shipped import SHIPPED_REDNET


def test_it_is_small_and_its_card_agrees_with_it() -> None:
    assert SHIPPED_REDNET.stat().st_size <= 20_000_000
    model, metadata = load_network(SHIPPED_REDNET)
    assert replace(model.config, names=()) == NETWORKS["compact-both"]
    assert len(model.config.names) > 100
    assert UNSEEN.isdisjoint(model.config.names)
    card = SHIPPED_REDNET.with_name("README.md").read_text(encoding="utf-8")
    assert metadata["calibration"]
    assert "calibration error with calibration" in card
    assert f"{metadata['step']} steps, {metadata['hours']} h" in card
    for heading in (
        "mIoU, goal categories present",
        "MIT licence",
        "stubborn train segmentation",
        "| category | IoU |",
    ):
        assert heading in card


@pytest.mark.costly
def test_a_process_that_uses_it_does_not_load_the_compilers_of_pytorch() -> None:
    use = (
        "import sys; from stubborn.segmentation.network import NetworkSegmenter; "
        "from stubborn.segmentation.shipped import SHIPPED_REDNET; NetworkSegmenter.from_file(SHIPPED_REDNET); "
        "print(sorted({'sympy', 'torch._dynamo', 'torch._inductor'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", use], capture_output=True, text=True, check=True, timeout=300)
    assert done.stdout.strip() == "[]"  # 80 MB in each worker


@pytest.mark.costly
def test_it_is_right_at_most_pixels_in_a_house_of_val() -> None:
    scene = Scene(load_split("val").load_house("val_00"), robot=RobotConfig(), camera=CameraModel(), profile="fast")
    try:
        views = list(sample_views(scene, np.random.default_rng(0), 6, stem="v", record={}))
    finally:
        scene.close()
    segmenter = NetworkSegmenter.from_file(SHIPPED_REDNET, threads=1)
    right = total = 0
    for view in views:
        predicted = segmenter.logits(view.rgb, (view.depth_mm / 1000).astype(np.float32)).argmax(dim=0).numpy() + 1
        truth = view.semantic[2::4, 2::4]
        right += int((predicted == truth)[truth > 0].sum())
        total += int((truth > 0).sum())
    assert right / total > 0.6
