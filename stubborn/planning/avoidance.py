"""The paper's four measures against collisions, and their effect on mapping and planning."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool

from stubborn.mapping.navmap import CollisionLayer, NavMap
from stubborn.planning.untrap import UntrapConfig


@dataclass(frozen=True, kw_only=True)
class CollisionAvoidance:
    """The four measures of the paper's ablation (Table "stubborn-ablation"), and a rule that the paper does not have.

    The full agent has all of them.
    """

    untrap: bool = True
    """The brute-force untrap mode."""
    collision_layers: bool = True
    """Collision marks are kept and planned around."""
    averse_exploration: bool = True
    """Exploration plans on the pessimistic layer; without this measure it plans on the optimistic layer."""
    optimistic_fallback: bool = True
    """Collision-averse exploration takes the optimistic layer where the pessimistic one has no path. This is the rule
    that the paper does not have."""
    visited_is_free: bool = True
    """Collision marks do not count where the body has been."""


class ProvenFree(NamedTuple):
    """Ground that the robot's own motion has proved free."""

    body: Bool[np.ndarray, "rows cols"]
    """True: the body was here, so no collision mark counts."""
    centre: Bool[np.ndarray, "rows cols"]
    """True: the robot's centre was here, so no obstacle counts."""


ProvenGround = Callable[[NavMap], ProvenFree]
"""Returns the ground of a map that counts as proven free."""


def visited_ground(view: NavMap) -> ProvenFree:
    """Returns the ground that the robot has driven over."""
    return ProvenFree(view.visited, view.trail)


def no_ground(view: NavMap) -> ProvenFree:
    """Returns empty masks: driving over ground proves nothing."""
    nothing = np.zeros_like(view.visited)
    return ProvenFree(nothing, nothing)


@dataclass(frozen=True, kw_only=True)
class CollisionPolicies:
    """The values that the parts of the agent get for a choice of measures."""

    marked: tuple[CollisionLayer, ...]
    """Layers that a failed move is marked in."""
    exploration: tuple[CollisionLayer, ...]
    """Layers to plan on while exploring, in order of preference."""
    approach: tuple[CollisionLayer, ...]
    """Layers to plan on towards a candidate, in order of preference."""
    proven_ground: ProvenGround
    untrap_after: float
    """Failed forwards that begin the untrap mode (`UntrapConfig`); infinite: it never begins."""


def collision_policies(avoidance: CollisionAvoidance, untrap: UntrapConfig) -> CollisionPolicies:
    """Returns the policies of a choice of measures."""
    both = (CollisionLayer.PESSIMISTIC, CollisionLayer.OPTIMISTIC)
    layers = both if avoidance.collision_layers else (CollisionLayer.NONE,)
    averse = layers if avoidance.optimistic_fallback else layers[:1]
    return CollisionPolicies(
        marked=both if avoidance.collision_layers else (),
        exploration=averse if avoidance.averse_exploration else layers[-1:],
        approach=layers,
        proven_ground=visited_ground if avoidance.visited_is_free else no_ground,
        untrap_after=untrap.failed_forwards if avoidance.untrap else math.inf,
    )
