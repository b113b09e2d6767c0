"""The recipes of the episodes of the shipped splits: how many there are, how far away goals are, which starts count.

| split | episodes of a house | rule | distance, m |
|---|--:|---|---|
| val, test | 34 | `any` | 4 to 30 |
| large, large-test | 30 | `hidden` | 12 to 60, 6 to 60 for the only reachable instance of its category |
| hazards, hazards-test | 30 | `hazard` | 2 to 30 |
| train | 10 | `any` | 2 to 30 |
| traps | 3 | `any` | the start of the sidecar with three headings |
| contact-val, contact-test, contact-heldout | 1 | `any` | the start of the sidecar |
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

START_TURNS_RAD = (0.0, 1.8, -2.3)
"""Headings of the episodes of a trap, relative to that of its sidecar: towards the goal, to the left, back right."""
Rule = Literal["any", "hidden", "hazard"]
"""The starts that a split allows, in addition to the limits of the distance:

- `any`: all;
- `hidden`: no instance of the goal is visible at the start by the rule of GT exploration, in whatever direction the
  robot looks; headings are spread evenly over the four quadrants;
- `hazard`: the shortest path to the goal leads past a hazard of the house, where the house has such paths.
"""


@dataclass(frozen=True, kw_only=True)
class EpisodeRecipe:
    """The rules by which the episodes of a split are sampled."""

    per_house: int = 10
    """Number of episodes of each house."""
    rule: Rule = "any"
    min_distance_m: float = 2.0
    """Least geodesic distance from a start to its goal."""
    only_instance_min_distance_m: float | None = None
    """Least distance to a goal with only one reachable instance on the storey; None: `min_distance_m`."""
    max_distance_m: float = 30.0
    """Largest geodesic distance; 30 m are 120 forwards, so 500 steps suffice with the turns."""
    view_points: int = 8
    """Largest number of view points of a goal instance in the files."""
    turns_rad: tuple[float, ...] = (0.0,)
    """Turns of a start that the sidecar of a house fixes; there is one episode for each."""

    def min_distance_for(self, instances: int) -> float:
        """Returns the least distance to a goal with this number of reachable instances."""
        other_m = self.only_instance_min_distance_m
        return self.min_distance_m if instances != 1 or other_m is None else other_m


DEFAULT_RECIPE = EpisodeRecipe()
"""For splits that are not shipped."""
_LARGE = EpisodeRecipe(
    per_house=30, rule="hidden", min_distance_m=12.0, only_instance_min_distance_m=6.0, max_distance_m=60.0
)
_HAZARDS = EpisodeRecipe(per_house=30, rule="hazard")
EPISODE_RECIPES: Mapping[str, EpisodeRecipe] = MappingProxyType(
    {
        "val": EpisodeRecipe(per_house=34, min_distance_m=4.0),
        "test": EpisodeRecipe(per_house=34, min_distance_m=4.0),
        "large": _LARGE,
        "hazards": _HAZARDS,
        "large-test": _LARGE,
        "hazards-test": _HAZARDS,
        "train": EpisodeRecipe(per_house=10, view_points=2),
        "traps": EpisodeRecipe(per_house=3, turns_rad=START_TURNS_RAD),
        **dict.fromkeys(("contact-val", "contact-test", "contact-heldout"), EpisodeRecipe(per_house=1, view_points=2)),
    }
)
"""Recipes by name of the split."""
