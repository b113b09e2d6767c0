"""Where segmentation comes from: names to segmenters. Part of the composition root, with `sim.run`.

`rednet` imports PyTorch only when it is asked for: a process without a network stays small and starts fast.
"""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from types import MappingProxyType
from typing import Any

from sim.detectors.noisy import NoisyConfig, NoisySegmenter
from sim.env.objectnav import ObjectNavEnv
from sim.interface import ConfigError, Segmenter
from stubborn.segmentation.ground_truth import GroundTruthSegmenter
from stubborn.segmentation.shipped import SHIPPED_REDNET

SEMANTICS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {"gt": GroundTruthSegmenter.spec.sensors, "noisy": NoisySegmenter.spec.sensors, "rednet": ("rgb",)}
)
"""Each kind, and the image sensors that it reads beside depth."""


def make_segmenter(semantics: str, env: ObjectNavEnv, *, weights: Path | None = None) -> Segmenter:
    """The segmenter of a kind, one of `SEMANTICS`, for this environment.

    A network gets one thread of this process: with another number the last digits of its scores may differ, and so in
    the end a run's lines.

    Args:
        semantics: the kind.
        env: an environment with its sensors and, for `noisy`, with the truth `geom`.
        weights: of `rednet`; the shipped ones when None.

    Raises:
        ConfigError: the weights are missing, broken or of another network.
    """
    if semantics == "noisy":
        return NoisySegmenter(env)
    if semantics == "gt":
        return GroundTruthSegmenter()
    from stubborn.segmentation.network import RedNetSegmenter

    return RedNetSegmenter.from_file(weights_file(weights), camera=env.camera_model, threads=1)


def truth_needed(semantics: str) -> tuple[str, ...]:
    """True images beside the sensors that a kind needs of its environment."""
    return ("geom",) if semantics == "noisy" else ()


def check_semantics(semantics: str, weights: Path | None) -> None:
    """Raise ConfigError where there is no such kind, or no weights for it."""
    if semantics not in SEMANTICS:
        raise ConfigError(f"Unknown --semantics '{semantics}'. There is: {', '.join(SEMANTICS)}.")
    if weights is not None and semantics != "rednet":
        raise ConfigError(f"--weights go with --semantics rednet, not with '{semantics}'.")
    if semantics == "rednet":
        weights_file(weights)


def weights_file(weights: Path | None) -> Path:
    """The file of a network's weights: the one given, else the shipped one.

    Raises:
        ConfigError: it is not there.
    """
    file = weights or SHIPPED_REDNET
    if not file.is_file():
        hint = "" if weights else " It ships with the package; tools/train_rednet.py makes one of your own."
        raise ConfigError(f"No weights at '{file}'.{hint}")
    return file


def describe_semantics(semantics: str, weights: Path | None) -> dict[str, Any]:
    """What a run's `config.json` says of its segmentation beyond the name: rates, or the checksum of the weights."""
    if semantics == "noisy":
        return {"semantics_config": asdict(NoisyConfig())}
    if semantics == "rednet":
        return {"semantics_config": {"weights_sha256": _sha256(weights_file(weights))}}
    return {}


@functools.cache
def _sha256(file: Path) -> str:
    return hashlib.sha256(file.read_bytes()).hexdigest()
