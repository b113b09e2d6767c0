"""Detects a processor that computes in bf16, and what follows for the configuration of a network."""

from __future__ import annotations

from pathlib import Path

import pytest

from sim.app.composition import segmenters
from stubborn.segmentation import processor


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("processor : 0\nflags\t\t: fpu avx2 avx512_bf16 sse\n", True),
        ("flags : amx_bf16\n", True),
        ("flags : fpu avx2 avx512_bf160\n", False),
        ("Features : asimd\n", False),
        (None, False),  # another system
    ],
)
def test_bf16_is_read_from_the_flags_of_the_processor(
    text: str | None, expected: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "cpuinfo"
    if text is not None:
        file.write_text(text)
    monkeypatch.setattr(processor, "_PROCESSOR", file)
    assert processor.computes_bf16.__wrapped__() is expected


@pytest.mark.parametrize("fast", [True, False])
def test_a_network_averages_over_the_mirror_image_where_the_processor_computes_in_bf16(
    fast: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(segmenters, "computes_bf16", lambda: fast)
    config = segmenters.detector_config(segmenters.KINDS["rednet"], None)
    assert isinstance(config, segmenters.NetworkConfig)
    assert config.mirrored is fast
    assert segmenters.precision_of(config) == ("bf16" if fast else "fp32")
    assert segmenters.detector_record(config)["precision"] == segmenters.precision_of(config)
    assert segmenters.precision_of(segmenters.detector_config(segmenters.KINDS["noisy"], None)) is None
