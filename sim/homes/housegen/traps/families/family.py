"""A family of traps: parameters that depend on a difficulty and a seed, and the scene that they describe."""

from __future__ import annotations

import abc
import dataclasses
import math
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Literal, Self, TypeVar, get_args

import numpy as np

from sim.core.geometry.pose import Pose
from sim.homes.housegen.traps.site import Span, TrapSite

Difficulty = Literal["easy", "medium", "hard"]
DIFFICULTIES: tuple[Difficulty, ...] = get_args(Difficulty)

CLIMBED_M = 0.006
"""Solids up to this height are meant to be driven over, also where a turn or a forward begins against their edge. The
wheels climb 12 mm ..."""
BLOCKING_M = 0.040
"""... and solids from this height on are meant to block, with room above it. No solid has a height in between."""
UNSEEN_M = (0.05, 0.085)
"""Heights of low solids that block the hull and lie below the obstacle band of a map, which begins at 0.10 m."""
ROBOT_M = 0.36
"""The robot's diameter: no gap on the route is narrower than this plus `SPARE_M`, and no closed one is wider."""
SPARE_M = 0.08
"""Least width of a gap in addition to the robot's."""
CLOSED_M = 0.30
"""Widest gap that counts as closed."""
ItemT = TypeVar("ItemT")


@dataclass(frozen=True)
class Scene:
    """A scene with a start, a goal and the extent of the trap."""

    site: TrapSite
    start: Pose
    goal: str
    zone_m: tuple[float, float, float, float]
    """x0, y0, x1, y1 of the trap."""


class Chance:
    """Draws of one trap; every method has values for the three difficulties, easy first."""

    def __init__(self, family: str, difficulty: Difficulty, seed: int, attempt: int) -> None:
        """The same arguments give the same draws."""
        self.level = DIFFICULTIES.index(difficulty)
        self.rng = np.random.default_rng([zlib.crc32(family.encode()), self.level, seed, attempt])

    def between(self, *spans: Span) -> float:
        """Returns a number from the span of the difficulty, or of the only span, in whole millimetres."""
        low, high = spans[min(self.level, len(spans) - 1)]
        return round(float(self.rng.uniform(low, high)), 3)

    def gap_m(self) -> float:
        """Returns the width of a gap: roomy, moderate, or barely wider than the robot."""
        return self.between((0.74, 0.95), (0.56, 0.72), (ROBOT_M + SPARE_M, 0.54))

    def count(self, *numbers: tuple[int, int]) -> int:
        """Returns a whole number from the (inclusive) span of the difficulty."""
        low, high = numbers[min(self.level, len(numbers) - 1)]
        return int(self.rng.integers(low, high + 1))

    def one_of(self, items: Sequence[ItemT]) -> ItemT:
        """Returns one of several items."""
        return items[int(self.rng.integers(len(items)))]

    def goal(self) -> str:
        """Returns a category of large furniture."""
        return self.one_of(("bed", "sofa", "bathtub"))

    def yaw_rad(self) -> float:
        """Returns a start heading that faces the goal within 30 deg."""
        return round(float(self.rng.uniform(-math.pi / 6, math.pi / 6)), 4)


@dataclass(frozen=True, kw_only=True)
class Parameters(abc.ABC):
    """The parameters of one trap of a family; a family is a subclass. All lengths are in metres."""

    family: ClassVar[str]
    """Name of the family."""
    summary: ClassVar[str]
    """One line on the parts of the trap."""
    held_out: ClassVar[bool] = False
    """True: no agent may be developed or tuned on traps of this family."""
    of_panes: ClassVar[bool] = False
    """True: all that is hidden are panes, so that their length is known."""

    gap_m: float
    """Width of the narrowest passage of the route that leads to the goal."""
    goal: str = "bed"
    """Category of the goal."""
    yaw_rad: float = 0.0
    """Heading of the start."""

    @classmethod
    @abc.abstractmethod
    def draw(cls, chance: Chance) -> Self:
        """Returns parameters for the difficulty of `chance`."""

    @abc.abstractmethod
    def build(self, name: str, seed: int) -> Scene:
        """Returns the scene; `seed` selects the style of the goal."""

    def numbers(self) -> dict[str, float | int | str]:
        """Returns the parameters by name, as the sidecar has them."""
        return {name: value for name, value in dataclasses.asdict(self).items() if name not in ("goal", "yaw_rad")}


def gap_away_from(chance: Chance, width_m: float, gap_m: float, line_m: float, away_m: float) -> float:
    """Returns the lower end of a gap in a wall from 0 to `width_m`; its centre is away from the line of the goal.

    A rest of less than the robot's radius at either end is left out, so that the gap is then at the wall.
    """
    for _ in range(100):
        low = chance.between((0.0, width_m - gap_m))
        low = 0.0 if low < 0.18 else low
        low = round(width_m - gap_m, 3) if low > width_m - gap_m - 0.18 else low
        if abs(low + 0.5 * gap_m - line_m) >= away_m:
            return low
    return 0.0 if line_m > 0.5 * width_m else round(width_m - gap_m, 3)
