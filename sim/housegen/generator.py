"""A furnished home from a seed: floor plan, openings, structure, furniture, lights, and their check.

Everything is drawn from one stream that the seed, the pool and the number of the try begin, so that the same seed
and version give the same bytes of XML. A try whose rooms do not fit, or whose check finds a fault, is thrown away and
the next one begins; the number of tries is bounded and reported.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.errors import ConfigError, HouseError
from sim.gl import mujoco
from sim.housegen.decoration import draw_lamps, draw_structure_looks
from sim.housegen.floor_plan import FloorPlan, PlanError, draw_floor_plan
from sim.housegen.furnishing import furnish
from sim.housegen.furniture import CATALOGUE
from sim.housegen.furniture.catalogue import Catalogue
from sim.housegen.furniture.item import Pool
from sim.housegen.furniture_source import FurnitureSource
from sim.housegen.mjcf import HouseBuilder, Lamp, PlacedItem, RoomBox
from sim.housegen.openings import HALF_WALL_M, OUTER_WALL_M, Opening, cut_openings
from sim.housegen.placement import RoomLayout
from sim.housegen.placement.surfaces import supports_items
from sim.housegen.rooms import PLAN_AREA_M2, PLAN_KINDS, ROOM_RULES, PlanKind, draw_plan_kind
from sim.housegen.structure import build_structure
from sim.houses.writing import house_text
from sim.world.check import check_house

GENERATOR_VERSION = 2
"""Raised whenever the same seed would give another house."""
MAX_TRIES = 12
MAX_PLAN_TRIES = 60
AREA_M2 = (50.0, 400.0)
MAX_BYTES = 395_000
"""Of a house as a file."""
BYTES_PER_GEOM = (1000, 500, 300, 200, 130, 100, 80, 50)
"""What one geom less to draw may cost in the file: less where the house would get too large otherwise."""
_POOL_STREAM = {"train": 0, "heldout": 1, "wide": 2}


@dataclass(frozen=True, kw_only=True)
class HouseConfig:
    """What may be asked of a house; whatever is None is drawn from the seed."""

    pool: Pool = "train"
    kind: PlanKind | None = None
    area_m2: float | None = None
    """Floor area aimed at, to the middle of the walls."""
    clutter: float | None = None
    """0 bare, 1 full of small things."""
    rooms: tuple[str, ...] = ()
    """Kinds of private rooms (gym, office, laundry ...) that it should have if the area allows."""
    name: str = "house"
    """The model's name in the file."""
    movable: bool = False
    """Light chairs, stools, plants and gym equipment get free joints (`sim.housegen.movables`)."""

    def __post_init__(self) -> None:
        if self.pool not in _POOL_STREAM:
            raise ConfigError(f"HouseConfig.pool must be one of {', '.join(_POOL_STREAM)}, got '{self.pool}'.")
        if self.kind is not None and self.kind not in PLAN_KINDS:
            raise ConfigError(f"HouseConfig.kind must be one of {', '.join(PLAN_KINDS)}, got '{self.kind}'.")
        unknown = [room for room in self.rooms if room not in ROOM_RULES]
        if unknown:
            raise ConfigError(f"HouseConfig.rooms: no room kind '{unknown[0]}'. There is: {', '.join(ROOM_RULES)}.")
        if self.area_m2 is not None and not AREA_M2[0] <= self.area_m2 <= AREA_M2[1]:
            raise ConfigError(
                f"HouseConfig.area_m2 must lie in {AREA_M2[0]:.0f}-{AREA_M2[1]:.0f} m2, got {self.area_m2}."
            )
        if self.clutter is not None and not 0.0 <= self.clutter <= 1.0:
            raise ConfigError(f"HouseConfig.clutter must lie in [0, 1], got {self.clutter}.")


@dataclass(frozen=True)
class GeneratedHouse:
    """A house that passed its check, and how it came about."""

    spec: mujoco.MjSpec
    plan: FloorPlan
    geoms: int
    tries: int
    rejects: tuple[str, ...]
    """Why each earlier try was thrown away."""


def generate(
    seed: int,
    *,
    pool: Pool = "train",
    kind: PlanKind | None = None,
    area_m2: float | None = None,
    clutter: float | None = None,
    movable: bool = False,
    catalogue: Catalogue = CATALOGUE,
) -> mujoco.MjSpec:
    """The specification of a new home; the same seed and version, the same bytes of `to_xml()`.

    Args:
        seed: any whole number from 0 on.
        pool: which styles, sizes, colours and textures may appear; "train" and "heldout" share none, "wide" shows
            train's and styles of its own.
        kind: shape of the floor plan; drawn when None.
        area_m2: floor area, 50-400; drawn when None.
        clutter: 0 bare to 1 full of small things; drawn when None.
        movable: light furniture can be pushed.
        catalogue: the styles of furniture that may be drawn.

    Raises:
        ConfigError: a value is outside what is allowed.
        HouseError: no try within the bound gave a house without a fault.
    """
    config = HouseConfig(pool=pool, kind=kind, area_m2=area_m2, clutter=clutter, movable=movable)
    return generate_house(seed, config, catalogue).spec


def generate_house(seed: int, config: HouseConfig | None = None, catalogue: Catalogue = CATALOGUE) -> GeneratedHouse:
    """A new home with its plan and the story of its tries.

    Args:
        seed: any whole number from 0 on.
        config: what is asked of it.
        catalogue: the styles of furniture that may be drawn.

    Raises:
        ConfigError: the seed is negative.
        HouseError: no try within the bound gave a house without a fault; the message lists them.
    """
    config = config or HouseConfig()
    if seed < 0:
        raise ConfigError(f"A house's seed must be 0 or more, got {seed}.")
    rejects: list[str] = []
    for attempt in range(MAX_TRIES):
        rng = np.random.default_rng([seed, _POOL_STREAM[config.pool], attempt])
        try:
            draft = _draw_house(rng, config, catalogue)
        except PlanError as error:
            rejects.append(str(error))
            continue
        spec = _build_small(draft, config)
        faults = check_house(spec) if spec is not None else [f"its file is larger than {MAX_BYTES / 1000:.0f} KB"]
        if spec is not None and not faults:
            return GeneratedHouse(spec, draft.plan, len(spec.geoms), attempt + 1, tuple(rejects))
        rejects.append("; ".join(faults))
    raise HouseError(f"Seed {seed} gave no house without faults in {MAX_TRIES} tries: {' | '.join(rejects)}")


@dataclass(frozen=True)
class _Draft:
    """A home as it was drawn, before it becomes a specification."""

    plan: FloorPlan
    ceiling_m: float
    structure: list[PlacedItem]
    layouts: list[RoomLayout]
    lamps: list[Lamp]


def _draw_house(rng: np.random.Generator, config: HouseConfig, catalogue: Catalogue) -> _Draft:
    """One draw of everything.

    Raises:
        PlanError: no floor plan fits.
    """
    area_m2, kind = _draw_size(rng, config)
    clutter = config.clutter if config.clutter is not None else float(rng.uniform(0.25, 0.85))
    ceiling_m = round(float(rng.uniform(2.5, 2.8)), 2)
    plan, openings = _draw_plan(rng, kind, area_m2, config.rooms)
    finish = draw_structure_looks(rng, plan, config.pool)
    structure = build_structure(plan, openings, ceiling_m, finish)
    source = FurnitureSource(rng, config.pool, clutter, frozenset(room.kind for room in plan.rooms), catalogue)
    layouts = [RoomLayout(index, room.kind, room.rect, openings, ceiling_m) for index, room in enumerate(plan.rooms)]
    for layout in layouts:
        furnish(layout, source)
    return _Draft(plan, ceiling_m, structure, layouts, draw_lamps(rng, plan, ceiling_m))


def _draw_plan(
    rng: np.random.Generator, kind: PlanKind, area_m2: float, rooms: tuple[str, ...]
) -> tuple[FloorPlan, tuple[Opening, ...]]:
    """A plan and the holes in its walls; many plans are drawn before one fits.

    Raises:
        PlanError: none fits.
    """
    for _ in range(MAX_PLAN_TRIES - 1):
        try:
            plan = draw_floor_plan(rng, kind, area_m2, rooms)
            return plan, cut_openings(rng, plan)
        except PlanError:
            continue
    plan = draw_floor_plan(rng, kind, area_m2, rooms)
    return plan, cut_openings(rng, plan)


def _build_small(draft: _Draft, config: HouseConfig) -> mujoco.MjSpec | None:
    """The specification of a drawn home, its parts joined as far as the file's size allows; None: it is too large.

    Homes of the pool `wide` are in no split and need not fit a file: they may be of any size.
    """
    if config.pool == "wide":
        return _build(draft, config, BYTES_PER_GEOM[0])
    at = 0
    while at < len(BYTES_PER_GEOM):
        spec = _build(draft, config, BYTES_PER_GEOM[at])
        size = len(house_text(spec))
        if size <= MAX_BYTES:
            return spec
        steps = 1 + (size > 1.12 * MAX_BYTES) + (size > 1.3 * MAX_BYTES)  # each level saves some 7 percent
        at = min(at + steps, len(BYTES_PER_GEOM) - 1) if at + 1 < len(BYTES_PER_GEOM) else len(BYTES_PER_GEOM)
    return None


def _build(draft: _Draft, config: HouseConfig, bytes_per_geom: int) -> mujoco.MjSpec:
    """The specification of a drawn home."""
    builder = HouseBuilder(config.name, bytes_per_geom=bytes_per_geom)
    builder.add_ground(draft.plan.bounds.grown(OUTER_WALL_M))
    for room in draft.plan.rooms:
        builder.add_room(RoomBox(room.name, room.rect.grown(-HALF_WALL_M)), draft.ceiling_m)
    builder.expect(
        [*draft.structure, *(placement.placed for layout in draft.layouts for placement in layout.placements)]
    )
    for placed in draft.structure:
        builder.add(placed)
    for layout in draft.layouts:
        for placement in layout.placements:
            if config.movable and not supports_items(layout, placement):
                builder.add_movable(placement.placed)
            else:
                builder.add(placement.placed)
    for lamp in draft.lamps:
        builder.add_lamp(lamp)
    return builder.spec


def _draw_size(rng: np.random.Generator, config: HouseConfig) -> tuple[float, PlanKind]:
    """Area and shape, each drawn to suit the other where it is not given."""
    kind = config.kind
    if config.area_m2 is not None:
        return config.area_m2, kind or draw_plan_kind(rng, config.area_m2)
    if kind is None:
        kind = PLAN_KINDS[int(rng.integers(len(PLAN_KINDS)))]
    low, high = PLAN_AREA_M2[kind]
    return float(rng.uniform(low, high)), kind
