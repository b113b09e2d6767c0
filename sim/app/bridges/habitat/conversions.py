"""Converts observations to Habitat's form, and the actions of a Habitat agent to `Action`.

| observation | Habitat's form |
|---|---|
| rgb | uint8 (h, w, 3), unchanged |
| depth | float32 (h, w, 1), scaled from [min_depth_m, max_depth_m] of the camera to [0, 1]; 0: nearer, or no return |
| semantic | int32 (h, w, 1), mpcat40 id |
| gps | float32 (2,), metres forward and **right** of the start pose |
| compass | float32 (1,), radians, counter-clockwise; rounded to `COMPASS_STEP_RAD` |
| objectgoal | int64 (1,), index into the categories of MP3D (those of this project) or HM3D |

Source: `habitat.tasks.nav` and `habitat.sims.habitat_simulator` of Habitat-Lab 0.3.
"""

from __future__ import annotations

import math
import operator
import reprlib
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from sim.app.bridges.habitat_client import HABITAT_ACTIONS
from sim.app.bridges.stubborn_client import Observation as _Observation
from sim.app.bridges.stubborn_client import from_habitat
from sim.core.errors import AgentError, ConfigError, did_you_mean
from sim.core.interface import GOAL_CATEGORIES, Action, CameraModel, Observation

HM3D_GOALS = ("chair", "bed", "plant", "toilet", "tv_monitor", "sofa")
"""The six goal categories of the ObjectNav challenges 2022 and 2023, in their order."""
CATEGORIES: Mapping[str, tuple[str, ...]] = MappingProxyType({"mp3d": GOAL_CATEGORIES, "hm3d": HM3D_GOALS})
"""Goal categories by the name of the data set that numbers them."""
COMPASS_STEP_RAD = math.radians(0.2)
"""The compass is rounded to it. Agents turn until a place is at most half a turning step aside. The turns of this robot
end 0.05 degrees too far, so that without rounding such an agent oscillates between two headings."""


class Observations(_Observation):
    """The observation of one step: a dict of arrays by the name of the sensor."""


@dataclass(frozen=True, kw_only=True)
class Conversion:
    """The conversion of observations for one agent or environment."""

    camera: CameraModel
    categories: str = "mp3d"
    """The numbering of goal categories, a key of `CATEGORIES`."""
    normalize_depth: bool = True
    """False: depth is in metres."""

    def __post_init__(self) -> None:
        if self.categories not in CATEGORIES:
            hint = did_you_mean(str(self.categories), CATEGORIES)
            raise ConfigError(f"categories must be one of {', '.join(CATEGORIES)}, got '{self.categories}'.{hint}")

    @property
    def goals(self) -> tuple[str, ...]:
        """The goal categories in the order of their numbers."""
        return CATEGORIES[self.categories]

    def goal_number(self, goal: str) -> int:
        """Returns the number of a goal category.

        Raises:
            AgentError: the data set has no such category.
        """
        if goal not in self.goals:
            raise AgentError(
                f"The goal '{goal}' is not one of the categories of {self.categories} ({', '.join(self.goals)}); "
                "--goal chooses episodes of one category."
            )
        return self.goals.index(goal)

    def observations(self, observation: Observation) -> Observations:
        """Returns an observation in Habitat's form; it shares no memory with the given one."""
        converted = Observations({name: np.array(value) for name, value in observation.items()})
        if "depth" in converted:
            converted["depth"] = self._depth(converted["depth"])[:, :, None]
        if "semantic" in converted:
            converted["semantic"] = converted["semantic"].astype(np.int32)[:, :, None]
        forward_m, left_m = observation["gps"]
        converted["gps"] = np.array([forward_m, 0.0 - left_m], np.float32)
        converted["compass"] = (np.round(observation["compass"] / COMPASS_STEP_RAD) * COMPASS_STEP_RAD).astype(
            np.float32
        )
        number = self.goal_number(GOAL_CATEGORIES[int(observation["objectgoal"][0])])
        converted["objectgoal"] = np.array([number], np.int64)
        return converted

    def _depth(self, depth_m: np.ndarray) -> np.ndarray:
        """Returns depth clipped to the camera's range and scaled, float32 (h, w)."""
        near_m, far_m = self.camera.min_depth_m, self.camera.max_depth_m
        clipped = np.clip(depth_m, near_m, far_m)
        return ((clipped - near_m) / (far_m - near_m) if self.normalize_depth else clipped).astype(np.float32)


def to_action(chosen: object) -> Action:
    """Returns the action that a Habitat agent gave: a number, a name, or a dict with the key `action`.

    A number may be an integer of Python or NumPy, or a tensor or array of one element; a name may be in upper case.

    Raises:
        AgentError: it is not an action of Habitat's.
    """
    try:
        return Action(operator.index(from_habitat(chosen)))
    except Exception:  # that of the user's class too
        names = ", ".join(f"{number} {name}" for name, number in HABITAT_ACTIONS.items())
        raise AgentError(
            f'Unknown action {reprlib.repr(chosen)}. An action is one of {names}, or a dict {{"action": one of these}}.'
        ) from None
