"""The requirements for a generated house."""

from __future__ import annotations

from dataclasses import dataclass

from sim.core.errors import ConfigError
from sim.homes.housegen.floor_plan.rooms import PLAN_AREA_M2, PLAN_KINDS, ROOM_RULES, PlanKind
from sim.homes.housegen.furniture.item import Pool
from sim.homes.housegen.hazards import FAMILIES
from sim.world.plan_requirements import MAX_ROOMS

AREA_M2 = (50.0, 800.0)
"""Smallest and largest floor area of a house."""
AreaM2 = float | tuple[float, float]
"""A floor area, or the smallest and the largest of a range, square metres."""
ROOMS = tuple(kind for kind in ROOM_RULES if kind not in ("hallway", "studio"))
"""Kinds of rooms that may be requested."""
POOL_STREAM = {"train": 0, "heldout": 1}
"""Numbers of the pools in the seeds of random generators."""


def parse_area(text: str) -> AreaM2:
    """Returns the area of an option: "90" for one area, "80:120" for a range.

    Raises:
        ConfigError: the text is neither a number nor two numbers with a colon between them.
    """
    try:
        numbers = [float(part) for part in text.split(":")]
    except ValueError:
        numbers = []
    if len(numbers) == 1:
        return numbers[0]
    if len(numbers) != 2:
        raise ConfigError(f"An area must be a number or a range such as 80:120, in m2, got '{text}'.")
    return numbers[0], numbers[1]


def shown_area(area_m2: AreaM2 | None) -> str:
    """Returns an area in the form that `parse_area` reads; "" for None."""
    if area_m2 is None:
        return ""
    return ":".join(f"{value:g}" for value in area_m2) if isinstance(area_m2, tuple) else f"{area_m2:g}"


@dataclass(frozen=True, kw_only=True)
class HouseConfig:
    """Requirements for a generated house; a field that is None is sampled from the seed."""

    pool: Pool = "train"
    """Styles, sizes, colours and textures that may appear."""
    kind: PlanKind | None = None
    """Kind of floor plan."""
    area_m2: AreaM2 | None = None
    """Floor area of the ground storey, or a range from which it is drawn. It is met to within 5 %, measured between the
    walls and to their middle."""
    clutter: float | None = None
    """0 without small objects, 1 with many."""
    rooms: tuple[str, ...] = ()
    """Kinds of rooms (gym, office, bathroom ...) that the house has at least, as often as they are named."""
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
        unknown = [room for room in self.rooms if room not in ROOMS]
        if unknown:
            raise ConfigError(f"HouseConfig.rooms: unknown kind '{unknown[0]}'. Available: {', '.join(ROOMS)}.")
        for room, most in MAX_ROOMS.items():
            if self.rooms.count(room) > most:
                raise ConfigError(
                    f"HouseConfig.rooms: a house has at most {most} of the kind '{room}', got {self.rooms.count(room)}."
                )
        unknown = [family for family in self.hazards if family not in FAMILIES]
        if unknown:
            raise ConfigError(f"HouseConfig.hazards: unknown hazard '{unknown[0]}'. Available: {', '.join(FAMILIES)}.")
        if self.area_m2 is not None:
            self._check_area(*self.areas_m2)
        if self.storeys not in (1, 2):
            raise ConfigError(f"HouseConfig.storeys must be 1 or 2, got {self.storeys}.")
        if self.kind == "studio" and self.wanted_rooms:
            raise ConfigError("A house of the kind 'studio' has no place for further rooms or stairs.")
        if self.hazard_count is not None and self.hazard_count < 1:
            raise ConfigError(f"HouseConfig.hazard_count must be at least 1, got {self.hazard_count}.")
        if self.clutter is not None and not 0.0 <= self.clutter <= 1.0:
            raise ConfigError(f"HouseConfig.clutter must lie in [0, 1], got {self.clutter}.")

    def _check_area(self, low_m2: float, high_m2: float) -> None:
        """Raises ConfigError if the range of areas is empty, or larger than what a house of its kind may have."""
        given = shown_area(self.area_m2)
        if low_m2 > high_m2:
            raise ConfigError(f"HouseConfig.area_m2 must be a range from a smaller to a larger area, got {given}.")
        if not AREA_M2[0] <= low_m2 <= high_m2 <= AREA_M2[1]:
            raise ConfigError(f"HouseConfig.area_m2 must lie in {AREA_M2[0]:.0f}-{AREA_M2[1]:.0f} m2, got {given}.")
        if self.kind is not None:
            low, high = PLAN_AREA_M2[self.kind]
            if not low <= low_m2 <= high_m2 <= high:
                raise ConfigError(f"A house of the kind '{self.kind}' has {low:.0f}-{high:.0f} m2, got {given}.")

    @property
    def areas_m2(self) -> tuple[float, float]:
        """Smallest and largest floor area; those that a house of its kind may have when no area is given."""
        if self.area_m2 is None:
            return PLAN_AREA_M2[self.kind] if self.kind else AREA_M2
        return self.area_m2 if isinstance(self.area_m2, tuple) else (self.area_m2, self.area_m2)

    @property
    def wanted_rooms(self) -> tuple[str, ...]:
        """The rooms beyond a living room and a kitchen, which every house has, with the one that the stairs need."""
        rooms = list(self.rooms)
        for kind in ("living_room", "kitchen"):
            if kind in rooms:
                rooms.remove(kind)
        if self.storeys == 2 and "stair_hall" not in rooms:
            rooms.append("stair_hall")
        return tuple(rooms)
