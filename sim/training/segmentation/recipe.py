"""The recipe of a training: windows that grow in phases, learning rate, and how views are sampled.

The first phase trains on small windows, which cost little, the last one on whole views, as the network is used. Widths
are relative to the images that the network is used on, so that one recipe fits every resolution.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from sim.core.interface import ConfigError


@dataclass(frozen=True, kw_only=True)
class Phase:
    """A part of a training."""

    share: float
    """Share of all steps."""
    widths: tuple[float, ...]
    """Widths of the samples, relative to the images that the network is used on; each step draws one."""
    whole_share: float
    """Share of the samples that show the whole view, shrunk; the others are windows at random scales."""
    batches: int = 1
    """Samples of a step, relative to `--batch`: small windows come in larger batches."""


@dataclass(frozen=True, kw_only=True)
class Recipe:
    """The hyperparameters of a training."""

    phases: tuple[Phase, ...]
    warmup_share: float = 0.01
    """Share of the steps in which the rate rises to its peak; it then falls to 0 along half a cosine."""
    weight_decay: float = 0.02
    """Weight decay of AdamW."""
    average: float = 0.9998
    """Decay per step of the exponential average of the weights; less in the first steps."""
    checkpoints: int = 3
    """The averaged weights of this many evaluations are averaged once more: that network is evaluated and saved."""
    checkpoint_share: float = 0.1
    """The evaluations that are averaged are in this last share of the steps so far."""
    object_share: float = 0.8
    """Share of the samples that are drawn by an object: category, then style, then object; windows show it."""

    def __post_init__(self) -> None:
        shares = [phase.share for phase in self.phases]
        if not shares or min(shares) <= 0.0 or abs(sum(shares) - 1.0) > 1e-6:
            raise ConfigError(f"The shares of Recipe.phases must be > 0 and add up to 1, got {shares}.")

    def phase(self, progress: float) -> Phase:
        """Returns the phase after a share of all steps, from 0 to 1."""
        ends = itertools.accumulate(phase.share for phase in self.phases)
        return next((phase for phase, end in zip(self.phases, ends, strict=True) if progress < end), self.phases[-1])

    def width_px(self, phase: Phase, used_px: int, stored_px: int, rng: np.random.Generator) -> int:
        """Returns the width of the samples of one step.

        Args:
            phase: the phase of the step.
            used_px: width of the images that the network is used on.
            stored_px: width of the stored views; samples are not wider.
            rng: draws one of the widths.
        """
        return min(stored_px, max(1, round(used_px * float(rng.choice(phase.widths)))))

    def relative_rate(self, step: int, total: int) -> float:
        """Returns the learning rate of a step relative to its peak: a linear rise, then half a cosine down to 0."""
        warmup = max(1, round(self.warmup_share * total))
        if step < warmup:
            return (step + 1) / warmup
        done = min(1.0, (step - warmup) / max(1, total - warmup))
        return 0.5 * (1.0 + math.cos(math.pi * done))


PROGRESSIVE = Recipe(
    phases=(
        Phase(share=0.27, widths=(0.6, 0.8), whole_share=0.0, batches=2),
        Phase(share=0.59, widths=(1.0,), whole_share=0.5),
        Phase(share=0.14, widths=(1.0, 1.2), whole_share=1.0),
    )
)
"""The recipe of `stubborn train segmentation`. A step costs about the same in all phases."""
