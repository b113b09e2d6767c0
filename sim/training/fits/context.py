"""Fits a `Context` to the objects of houses.

An agent has seen only a part of the objects around a track. Therefore each object is fitted with a random part of the
objects around it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch
from jaxtyping import Float32, Float64, Int

from sim.core.interface import MPCAT40, MPCAT40_ID, ConfigError
from sim.homes.plans.plan import Plan
from stubborn.detection.context import OBJECTS, Context

MIN_OBJECTS = 10
"""A category with fewer objects is unknown: its ratio is 1."""
MIN_SEEN = 0.15
"""A random share of the objects around an object is seen, between this and 1."""
PRIOR = 3.0
"""Weight of the normal prior of the log-odds, as a number of objects."""
_NUMBER = np.full(len(MPCAT40), -1)
_NUMBER[[MPCAT40_ID[name] for name in OBJECTS]] = np.arange(len(OBJECTS))
Surroundings = tuple[Float32[np.ndarray, "_ objects"], Int[np.ndarray, " _"]]  # `_`: houses differ in their number
"""The categories nearby (1 or 0) for each object, and its own category, by their numbers in `OBJECTS`."""


def surroundings(
    x_m: Float64[np.ndarray, " instances"],
    y_m: Float64[np.ndarray, " instances"],
    category: Int[np.ndarray, " instances"],
    radius_m: float,
    rng: np.random.Generator,
) -> Surroundings:
    """Returns the categories around each object of one house when a random part of the objects is seen.

    Args:
        x_m: middle of each object; `y_m` is its other coordinate.
        category: id of each object in mpcat40; other classes than `OBJECTS` are left out.
        radius_m: see `Context.radius_m`.
        rng: chooses the objects that are seen.
    """
    number = _NUMBER[category]
    x_m, y_m, number = (values[number >= 0] for values in (x_m, y_m, number))
    near = np.hypot(x_m[:, None] - x_m, y_m[:, None] - y_m) < radius_m
    np.fill_diagonal(near, False)
    near &= rng.random(near.shape) < rng.uniform(MIN_SEEN, 1.0, (len(near), 1))
    is_of = number[:, None] == np.arange(len(OBJECTS))
    return (near.astype(np.float32) @ is_of > 0.0).astype(np.float32), number


def around(plan: Plan, radius_m: float, rng: np.random.Generator) -> Surroundings:
    """Returns the categories around each object of one plan."""
    on_storey = plan.span_low_m < plan.ceiling_m  # spans reach above the ceiling, into the next storey
    instances, number = np.unique(plan.span_instance[on_storey], return_inverse=True)
    low, high = np.full((2, instances.size), np.inf), np.zeros((2, instances.size))
    for axis, cell in enumerate(np.divmod(plan.span_cell[on_storey], plan.frame.shape[1])):
        np.minimum.at(low[axis], number, cell)
        np.maximum.at(high[axis], number, cell)
    middle_m = 0.5 * plan.frame.cell_m * (low + high)
    return surroundings(middle_m[1], middle_m[0], plan.categories[instances].astype(np.intp), radius_m, rng)


def fit(houses: Sequence[Surroundings], radius_m: float, *, steps: int = 400) -> Context:
    """Returns the parameters of highest posterior probability.

    Args:
        houses: see `surroundings`.
        radius_m: the radius with which they were found.
        steps: number of steps of Adam.

    Raises:
        ConfigError: there are fewer than 100 objects, or too few of each category.
    """
    count = sum(len(category) for _, category in houses)
    if count < 100:
        raise ConfigError(f"The plans have {count} objects; 100 are needed: give more plans.")
    nearby, category = (np.concatenate(parts) for parts in zip(*houses, strict=True))
    counts = np.bincount(category, minlength=len(OBJECTS)) + 0.5
    known = counts >= MIN_OBJECTS
    if not known.any():
        raise ConfigError(f"No category of objects is {MIN_OBJECTS} times in the plans: give more plans.")
    nearby, category = nearby[known[category]], category[known[category]]
    frequency = known * counts / max((known * counts).sum(), 1.0)
    prior = torch.from_numpy(np.log(frequency, where=known, out=np.full(len(OBJECTS), -np.inf)).astype(np.float32))
    weight = torch.zeros(len(OBJECTS), len(OBJECTS), requires_grad=True)
    constant = torch.zeros(len(OBJECTS), requires_grad=True)
    others = 1.0 - torch.eye(len(OBJECTS))
    x, y = torch.from_numpy(nearby), torch.from_numpy(category)
    optimizer = torch.optim.Adam([weight, constant], lr=0.05)
    for _ in range(steps):
        optimizer.zero_grad()
        loss = torch.nn.functional.cross_entropy(x @ (weight * others).T + constant + prior, y)
        (loss + PRIOR * (weight**2).sum() / len(y)).backward()
        optimizer.step()
    return Context(
        radius_m=radius_m,
        frequency=frequency.astype(np.float32),
        constant=constant.detach().numpy() * known,
        weight=(weight * others).detach().numpy() * known[:, None],
    )


def log_losses(context: Context, houses: Sequence[Surroundings]) -> tuple[float, float]:
    """Returns the mean log loss of known categories of objects: by their frequency alone, and by the objects nearby.

    Raises:
        ConfigError: the houses have no object of a known category.
    """
    nearby, category = (np.concatenate(parts) for parts in zip(*houses, strict=True))
    known = context.frequency[category] > 0.0
    if not known.any():
        raise ConfigError("The plans held back have no object of a category that the others have: give more plans.")
    nearby, category = nearby[known], category[known]
    frequency = np.log(context.frequency[category])
    ratio = context.log_ratios(nearby)[np.arange(len(category)), category]
    return -float(frequency.mean()), -float((frequency + ratio).mean())
