"""The requirements for a generated house."""

from __future__ import annotations

from dataclasses import dataclass

from sim.core.errors import ConfigError
from sim.homes.housegen.floor_plan.rooms import PLAN_AREA_M2, PLAN_KINDS, ROOM_RULES, PlanKind
from sim.homes.housegen.furniture.item import Pool
from sim.homes.housegen.hazards import FAMILIES

AREA_M2 = (50.0, 800.0)
"""Smallest and largest floor area of a house."""
POOL_STREAM = {"train": 0, "heldout": 1}
"""Numbers of the pools in the seeds of random generators."""


@dataclass(frozen=True, kw_only=True)
class HouseConfig:
    """Requirements for a generated house; a field that is None is sampled from the seed."""

    pool: Pool = "train"
    """Styles, sizes, colours and textures that may appear."""
    kind: PlanKind | None = None
    """Kind of floor plan."""
    area_m2: float | None = None
    """Floor area of the ground storey. It is met to within 5 %, measured between the walls and to their middle."""
    clutter: float | None = None
    """0 without small objects, 1 with many."""
    rooms: tuple[str, ...] = ()
    """Kinds of private rooms (gym, office, laundry ...) that the house must have."""
    name: str = "house"
    """The model's name in the file."""
    movable: bool = False
    """Light chairs, stools, plants and gym equipment get free joints (`sim.homes.housegen.mjcf.movables`)."""
    storeys: int = 1
    """1, or 2: some rooms are repeated on an upper storey, and a room of the kind `stair_hall` has the stairs."""
    hazards: tuple[str, ...] = ()
    """Families of hazards (`sim.homes.housegen.hazards.FAMILIES`), which are placed on paths."""
    hazard_count: int | None = None
    """Number of hazards; it depends on the area when None."""
    reshape: bool = False
    """Whether about half of the items get other proportions than those of their styles, to train perception."""
    exact: bool = True
    """False: the area may be off by a quarter, and rooms that do not fit are left out, as in the shipped splits."""

    def __post_init__(self) -> None:
        if self.pool not in POOL_STREAM:
            raise ConfigError(f"HouseConfig.pool must be one of {', '.join(POOL_STREAM)}, got '{self.pool}'.")
        if self.kind is not None and self.kind not in PLAN_KINDS:
            raise ConfigError(f"HouseConfig.kind must be one of {', '.join(PLAN_KINDS)}, got '{self.kind}'.")
        unknown = [room for room in self.rooms if room not in ROOM_RULES]
        if unknown:
            raise ConfigError(f"HouseConfig.rooms: unknown kind '{unknown[0]}'. Available: {', '.join(ROOM_RULES)}.")
        unknown = [family for family in self.hazards if family not in FAMILIES]
        if unknown:
            raise ConfigError(f"HouseConfig.hazards: unknown hazard '{unknown[0]}'. Available: {', '.join(FAMILIES)}.")
        if self.area_m2 is not None and not AREA_M2[0] <= self.area_m2 <= AREA_M2[1]:
            raise ConfigError(
                f"HouseConfig.area_m2 must lie in {AREA_M2[0]:.0f}-{AREA_M2[1]:.0f} m2, got {self.area_m2}."
            )
        if self.storeys not in (1, 2):
            raise ConfigError(f"HouseConfig.storeys must be 1 or 2, got {self.storeys}.")
        if self.kind is not None and self.area_m2 is not None:
            low, high = PLAN_AREA_M2[self.kind]
            if not low <= self.area_m2 <= high:
                raise ConfigError(f"A house of the kind '{self.kind}' has {low:.0f}-{high:.0f} m2, got {self.area_m2}.")
        if self.kind == "studio" and self.wanted_rooms:
            raise ConfigError("A house of the kind 'studio' has no place for further rooms or stairs.")
        if self.hazard_count is not None and self.hazard_count < 1:
            raise ConfigError(f"HouseConfig.hazard_count must be at least 1, got {self.hazard_count}.")
        if self.clutter is not None and not 0.0 <= self.clutter <= 1.0:
            raise ConfigError(f"HouseConfig.clutter must lie in [0, 1], got {self.clutter}.")

    @property
    def wanted_rooms(self) -> tuple[str, ...]:
        """The private rooms, with the one that the stairs need."""
        needs_hall = self.storeys == 2 and "stair_hall" not in self.rooms
        return (*self.rooms, "stair_hall") if needs_hall else self.rooms
