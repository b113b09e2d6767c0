"""Fits a `Fusion` to tracks with a known true category, and evaluates it on held-out houses.

The parameters are those of highest likelihood of the true categories, with a normal prior on the offsets: a network
makes different errors on different furniture, and an offset that helps only in the houses of the fit does harm in
others. Each track enters several times during its episode, with the views that were known then, because an agent has to
decide after few views.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from jaxtyping import Bool, Float, Float32, Int
from torch import Tensor

from sim.core.interface import GOAL_CATEGORIES, MPCAT40, MPCAT40_ID, ConfigError
from stubborn.detection.evidence import EvidenceConfig
from stubborn.detection.fusion import IS_SURFACE, SURFACES, Fusion

FOLDS = 5
STEPS = 300
"""Steps of Adam."""
MIN_PIXELS = 40
"""Tracks with fewer pixels are left out."""
TRUE_SHARE = 0.25
"""A track has the category of an object if at least this share of its pixels has it; the rest may show the
background."""
OFFSET_PRIOR = 30.0
"""Weight of the prior of the offsets, as a number of tracks."""
PLAUSIBLE = 0.1
"""Goals below this probability, before and after the fit, are left out: nearly all are true negatives."""
_BINS = (0.0, 0.1, 0.3, 0.5, 0.7, 0.85, 0.95, 1.0)


@dataclass(frozen=True)
class Sample:
    """The evidence on one track at one step, with its true category."""

    house: str
    category: int
    """Index of its true category in `MPCAT40[1:]`; -1: no object."""
    view: Int[np.ndarray, " views"]
    """Numbers of the views, see `Evidence.views`."""
    mean: Float32[np.ndarray, "views classes"]
    weight: Float32[np.ndarray, " views"]


def true_category(counts: Int[np.ndarray, " ids"]) -> int:
    """Returns the index of a track's category in `MPCAT40[1:]`, -1: no object, from its pixels of each true id."""
    objects = counts.astype(np.float64)
    objects[0] = 0.0
    objects[1:][IS_SURFACE] = 0.0
    best = int(objects.argmax())
    return best - 1 if best and objects[best] >= TRUE_SHARE * counts.sum() else -1


def samples_of(log: Sequence[Mapping[str, Any]]) -> list[Sample]:
    """Returns the samples of a log.

    Args:
        log: one entry for each episode. It holds `house`; `counts` (n, 41), the number of pixels of each true id for
            each track; `track` (s,), the track of each sample; and for all views of the samples `sample` (m,),
            `view` (m,), `mean` (m, 40) and `weight` (m,).
    """
    result = []
    for episode in log:
        for number, track in enumerate(episode["track"].tolist()):
            mine, counts = episode["sample"] == number, episode["counts"][track]
            if counts.sum() < MIN_PIXELS or not mine.any():
                continue
            result.append(
                Sample(
                    str(episode["house"]),
                    true_category(counts),
                    episode["view"][mine],
                    episode["mean"][mine].astype(np.float32),
                    episode["weight"][mine].astype(np.float32),
                )
            )
    return result


def fit(samples: Sequence[Sample]) -> Fusion:
    """Returns the parameters of highest posterior probability.

    Args:
        samples: see `samples_of`.

    Raises:
        ConfigError: there are fewer than 100 samples.
    """
    if len(samples) < 100:
        raise ConfigError(f"The log holds {len(samples)} samples of tracks; 100 are needed: run more episodes.")
    data = _Data.of(samples)
    names = [name for name in MPCAT40[1:] if name not in SURFACES]
    free = {
        "rings": torch.zeros(4),
        "sharpness": torch.tensor(0.0),
        "growth": torch.tensor(0.0),
        "floor": torch.tensor(-5.0),
        "surface": torch.tensor([-3.0, 1.0, 0.0]),
        "offsets": torch.zeros(len(names)),
    }
    for parameter in free.values():
        parameter.requires_grad_(True)
    optimizer = torch.optim.Adam(free.values(), lr=0.05)
    for _ in range(STEPS):
        optimizer.zero_grad()
        loss = torch.nn.functional.cross_entropy(data.log_odds(free), data.category)
        (loss + OFFSET_PRIOR * (free["offsets"] ** 2).sum() / len(samples)).backward()
        optimizer.step()
    value = {name: parameter.detach().numpy().astype(np.float64) for name, parameter in free.items()}
    rings = np.exp(value["rings"] - value["rings"][EvidenceConfig.near_ring])
    return Fusion(
        ring_weights=tuple(rings.round(4).tolist()),
        sharpness=round(float(np.exp(value["sharpness"])), 4),
        growth=round(float(np.clip(value["growth"], 0.0, 1.0)), 4),
        floor=float(f"{np.exp(value['floor']):.4g}"),
        surface=tuple(value["surface"].round(4).tolist()),
        offsets={name: round(float(offset), 3) for name, offset in zip(names, value["offsets"], strict=True)},
    )


@dataclass(frozen=True)
class _Data:
    """Samples as tensors: sums over the views of each range of distance, since these share a weight."""

    objects: Tensor
    """(n, rings, objects) weighted sum of the share of each category in the posterior without surfaces."""
    behind: Tensor
    """(n, rings) weighted sum of the share of the surfaces."""
    weight: Tensor
    """(n, rings) sum of the weights."""
    category: Tensor
    """(n,) number of the true object; the last number means no object."""

    @classmethod
    def of(cls, samples: Sequence[Sample]) -> _Data:
        rings, kinds = len(EvidenceConfig().rings_m) + 1, int((~IS_SURFACE).sum())
        objects = np.zeros((len(samples), rings, kinds), np.float32)
        behind, weight = (np.zeros((len(samples), rings), np.float32) for _ in range(2))
        category = np.full(len(samples), kinds, np.int64)
        number = np.cumsum(~IS_SURFACE) - 1
        for i, sample in enumerate(samples):
            inside, surface = sample.mean[:, ~IS_SURFACE], sample.mean[:, IS_SURFACE].sum(axis=1)
            of_objects = inside.sum(axis=1)
            ring = sample.view // EvidenceConfig.sectors
            np.add.at(objects[i], ring, (sample.weight / np.maximum(of_objects, 1e-3))[:, None] * inside)
            np.add.at(behind[i], ring, sample.weight * surface / np.maximum(surface + of_objects, 1e-6))
            np.add.at(weight[i], ring, sample.weight)
            if sample.category >= 0:
                category[i] = number[sample.category]
        return cls(*(torch.from_numpy(array) for array in (objects, behind, weight, category)))

    def log_odds(self, free: Mapping[str, Tensor]) -> Tensor:
        """Returns the values of `Fusion.probabilities` before the softmax, (n, objects + 1); the last: no object."""
        factor = (free["rings"] - free["rings"][EvidenceConfig.near_ring]).exp()
        total = (self.weight @ factor)[:, None].clamp(min=1e-6)
        averaged = torch.einsum("nrc,r->nc", self.objects, factor) / total
        behind = ((self.behind @ factor)[:, None] / total).clamp(1e-3, 1.0 - 1e-3)
        total = total.clamp(min=0.05)
        sharpness = free["sharpness"].exp() * total ** free["growth"].clamp(0.0, 1.0)
        z = torch.log_softmax(sharpness * torch.log(averaged + free["floor"].exp()), dim=1) + free["offsets"]
        constant, slope, growth = free["surface"]
        none = constant + slope * torch.logit(behind) + growth * torch.log(total)
        return torch.cat([z, none], dim=1)


def probabilities(fusion: Fusion, samples: Sequence[Sample]) -> Float32[np.ndarray, "n classes"]:
    """Returns the probability of each category of `MPCAT40[1:]`, for each sample."""
    rings, sectors = np.array(fusion.ring_weights, np.float32), EvidenceConfig.sectors
    return np.concatenate(
        [
            fusion.probabilities(sample.mean[None], (sample.weight * rings[sample.view // sectors])[None])
            for sample in samples
        ]
    )


def left_out(samples: Sequence[Sample]) -> Float32[np.ndarray, "n classes"]:
    """Returns the probabilities of each sample with parameters that were fitted to other houses; see `fit`."""
    houses = sorted({sample.house for sample in samples})
    if len(houses) < 2:
        raise ConfigError("Tracks of at least two houses are needed, got those of one: run more episodes.")
    fold = {house: number % min(FOLDS, len(houses)) for number, house in enumerate(houses)}
    result = np.zeros((len(samples), len(IS_SURFACE)), np.float32)
    for number in sorted(set(fold.values())):
        test = [i for i, sample in enumerate(samples) if fold[sample.house] == number]
        others = [sample for sample in samples if fold[sample.house] != number]
        result[test] = probabilities(fit(others), [samples[i] for i in test])
    return result


def judge(
    p: Float[np.ndarray, "n classes"], samples: Sequence[Sample], among: Bool[np.ndarray, "n goals"] | None = None
) -> dict[str, Any]:
    """Returns the quality of the probabilities of goal categories: calibration and ranking.

    Args:
        p: probability of each category of `MPCAT40[1:]`, for each sample.
        samples: the same samples.
        among: pairs of sample and goal that count; by default those with a probability of at least `PLAUSIBLE`.
    """
    from sklearn.metrics import average_precision_score

    goals = np.array([MPCAT40_ID[name] - 1 for name in GOAL_CATEGORIES])
    truth = np.array([sample.category for sample in samples])[:, None] == goals
    among = p[:, goals] >= PLAUSIBLE if among is None else among
    if not among.any():
        raise ConfigError("No track of the log may be a goal: run more episodes.")
    q, y = np.clip(p[:, goals][among].astype(np.float64), 1e-4, 1.0 - 1e-4), truth[among]
    rows = []
    for low, high in itertools.pairwise(_BINS):
        inside = (q >= low) & (q < high)
        if inside.any():
            mean, true = float(q[inside].mean()), float(y[inside].mean())
            rows.append({"from": low, "n": int(inside.sum()), "mean": round(mean, 3), "true": round(true, 3)})
    return {
        "pairs": len(y),
        "true": round(float(y.mean()), 4),
        "log_loss": round(float(-np.where(y, np.log(q), np.log1p(-q)).mean()), 4),
        "brier": round(float(((q - y) ** 2).mean()), 4),
        "average_precision": round(float(average_precision_score(y, q)), 4),
        "calibration": rows,
    }
