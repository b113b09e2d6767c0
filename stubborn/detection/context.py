"""The objects around an object as evidence for its category: towels hang near sinks, cushions lie on sofas.

The ratio P(category | objects nearby) / P(category) multiplies the probabilities of a track. The ratios describe how
homes are furnished, not a segmentation: they are fitted to house plans (`stubborn train context`), and the shipped ones
to those of generated houses. Only a share of their logarithm counts (`TrackSeekerConfig.context_share`), because a
network has seen the surroundings in its images too, and because other homes are furnished otherwise.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import msgspec
import numpy as np
from jaxtyping import Float32

from sim.core.interface import MPCAT40, ConfigError
from sim.core.reading import Number, read_json

SHIPPED = Path(__file__).with_name("context.json")
"""The ratios of generated houses."""
STRUCTURE = (
    "wall", "floor", "door", "window", "stairs", "ceiling", "column", "lighting", "beam", "railing", "misc",
)  # fmt: skip
"""Classes that are not objects: they do not begin tracks, but their probability counts against existing tracks."""
OBJECTS = tuple(name for name in MPCAT40[1:] if name not in STRUCTURE)
"""The categories of tracks, which are evidence for each other."""
IS_OBJECT = np.array([name not in STRUCTURE for name in MPCAT40[1:]])
"""One entry for each category of `MPCAT40` except void."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Context:
    """A log-linear model of the category of an object, given the categories nearby.

    Its arrays are in the order of `OBJECTS`.
    """

    radius_m: float
    """Objects are nearby if their middles are nearer than this in the plan."""
    frequency: Float32[np.ndarray, " objects"]
    """Share of each category among all objects; 0: unknown category, its ratio is always 1."""
    constant: Float32[np.ndarray, " objects"]
    """Log-odds of each category with nothing nearby, in addition to the logarithm of its frequency."""
    weight: Float32[np.ndarray, "objects objects"]
    """Log-odds to add for the category of a row if one of a column is nearby. The diagonal is 0: two tracks of one
    category may be parts of one object."""

    def log_ratios(self, nearby: Float32[np.ndarray, "n objects"]) -> Float32[np.ndarray, "n objects"]:
        """Returns log(P(category | nearby) / P(category)).

        Args:
            nearby: for each category, the probability that an object of it is nearby.
        """
        known = self.frequency > 0.0
        prior = np.log(self.frequency[known])
        log_odds = nearby @ self.weight[known].T + self.constant[known] + prior
        log_odds -= log_odds.max(axis=1, keepdims=True)
        result = np.zeros_like(nearby)
        result[:, known] = log_odds - np.log(np.exp(log_odds).sum(axis=1, keepdims=True)) - prior
        return result


class _Object(msgspec.Struct):
    frequency: Annotated[float, msgspec.Meta(ge=1e-6, le=1.0)]
    constant: Number
    nearby: dict[str, Number]


class _Parameters(msgspec.Struct):
    radius_m: Annotated[float, msgspec.Meta(gt=0.0, le=100.0)]
    objects: Annotated[dict[str, _Object], msgspec.Meta(min_length=1)]


class _File(msgspec.Struct):
    """A file of `stubborn train context`."""

    context: _Parameters


def read_context(file: Path = SHIPPED) -> Context:
    """Returns the model in a file that `stubborn train context` wrote.

    Raises:
        ConfigError: the file is missing or holds something else.
    """
    context = read_json(file, _File, what="Context file").context
    unknown = {*context.objects, *(name for ratios in context.objects.values() for name in ratios.nearby)} - set(
        OBJECTS
    )
    if unknown:
        raise ConfigError(f"Context file '{file}': unknown object '{min(unknown)}'; known are {', '.join(OBJECTS)}.")
    frequency, constant = np.zeros((2, len(OBJECTS)), np.float32)
    weight = np.zeros((len(OBJECTS), len(OBJECTS)), np.float32)
    for name, ratios in context.objects.items():
        number = OBJECTS.index(name)
        frequency[number], constant[number] = ratios.frequency, ratios.constant
        weight[number] = [ratios.nearby.get(other, 0.0) for other in OBJECTS]
    return Context(radius_m=context.radius_m, frequency=frequency, constant=constant, weight=weight)


def content_of(context: Context) -> dict[str, object]:
    """Returns the entry `context` of a file that `read_context` reads."""
    rows = zip(OBJECTS, context.frequency, context.constant, context.weight, strict=True)
    objects = {
        name: {
            "frequency": float(f"{frequency:.3g}"),
            "constant": round(float(constant), 2),
            "nearby": {other: round(float(v), 2) for other, v in zip(OBJECTS, weight, strict=True) if abs(v) >= 0.005},
        }
        for name, frequency, constant, weight in rows
        if frequency > 0.0
    }
    return {"radius_m": context.radius_m, "objects": objects}
