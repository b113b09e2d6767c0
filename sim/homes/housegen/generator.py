"""Generates a furnished home from a seed: floor plan, openings, structure, furniture, lights, and their check.

Everything is drawn from one random generator, seeded by the seed, the pool and the number of the try, so that the same
seed and version give the same bytes of XML. A try is rejected if its rooms do not fit or its check finds a fault;
the number of tries is limited and reported.
"""

from __future__ import annotations

import dataclasses
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from sim.core.errors import ConfigError, HouseError
from sim.gl import mujoco
from sim.homes.housegen.config import POOL_STREAM, HouseConfig
from sim.homes.housegen.floor_plan import FloorPlan, PlanError, draw_floor_plan
from sim.homes.housegen.floor_plan.rooms import PLAN_AREA_M2, PLAN_KINDS, PlanKind, draw_plan_kind
from sim.homes.housegen.furnishing import FurnishError, furnish
from sim.homes.housegen.furnishing.furniture_source import FurnitureSource
from sim.homes.housegen.furnishing.placement import RoomLayout
from sim.homes.housegen.furnishing.placement.surfaces import supports_items
from sim.homes.housegen.furniture import CATALOGUE
from sim.homes.housegen.furniture.catalogue import Catalogue
from sim.homes.housegen.ground import lay_ground
from sim.homes.housegen.hazards import PlacedHazard, draw_hazards
from sim.homes.housegen.mjcf.builder import HouseBuilder
from sim.homes.housegen.mjcf.placed import Lamp, PlacedItem
from sim.homes.housegen.structure.building import build_structure
from sim.homes.housegen.structure.openings import (
    HALF_WALL_M,
    OUTER_WALL_M,
    Opening,
    cut_openings,
    plan_rule_faults,
    size_rule_faults,
)
from sim.homes.housegen.surfaces.lighting import DAYLIGHT, draw_lamps
from sim.homes.housegen.surfaces.structure_looks import draw_structure_looks
from sim.homes.housegen.upper_storey import Stairs, UpperStorey, draw_stairs, draw_upper_storey, lifted
from sim.houses.writing import house_text
from sim.world.check import check_house

GENERATOR_VERSION = 6
"""Increased whenever the same seed gives another house; the effect of `HouseConfig.exact` is recorded separately."""
MAX_TRIES = 12
MAX_REASONS = 3
"""Largest number of reasons in the error message of a seed that gives no house."""
MAX_AREA_ERROR = 0.05
"""Largest relative difference between the requested floor area and that of the rooms."""
DRAWN_AREAS = (0.92, 1.1)
"""Range of the areas for which plans are drawn until one has the requested area, relative to it."""
MAX_PLAN_TRIES = 600
"""Each takes about 2 ms."""
MAX_STAIRS_TRIES = 12
"""Plans that are drawn until an upper storey of enough rooms fits on one; each takes about 20 ms."""


@dataclass(frozen=True)
class GeneratedHouse:
    """A house that passed its check."""

    spec: mujoco.MjSpec
    plan: FloorPlan
    rejects: tuple[str, ...]
    """The reason why each earlier try was rejected."""
    styles: Mapping[str, str]
    """Name of the style of each piece of furniture, by the label of its instance (`chair_03`)."""

    @property
    def tries(self) -> int:
        """The number of tries, the last of which succeeded."""
        return len(self.rejects) + 1


def generate(
    seed: int, config: HouseConfig | None = None, *, catalogue: Catalogue = CATALOGUE, **fields: Any
) -> mujoco.MjSpec:
    """Returns the specification of a new home; the same seed and version give the same bytes of `to_xml()`.

    `generate(7, kind="flat", rooms=("gym",))` is short for `generate(7, HouseConfig(kind="flat", rooms=("gym",)))`.
    `sim.write_house` writes the home into a folder.

    Args:
        seed: any whole number from 0 on.
        config: requirements; a field that is None is drawn from the seed.
        catalogue: the styles of furniture that may be drawn.
        **fields: fields of `HouseConfig`, which replace those of `config`.

    Raises:
        ConfigError: a field does not exist, or a value is not allowed.
        HouseError: no try within the bound gave a house without a fault.
    """
    options = [field.name for field in dataclasses.fields(HouseConfig)]
    if unknown := sorted(set(fields) - set(options)):
        raise ConfigError(f"generate has no option '{unknown[0]}'. Available: {', '.join(options)}.")
    return generate_house(seed, replace(config or HouseConfig(), **fields), catalogue).spec


def generate_house(seed: int, config: HouseConfig | None = None, catalogue: Catalogue = CATALOGUE) -> GeneratedHouse:
    """Returns a new home with its plan and the reasons of rejected tries.

    Args:
        seed: any whole number from 0 on.
        config: requirements for it.
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
        rng = np.random.default_rng([seed, POOL_STREAM[config.pool], attempt])
        try:
            draft = _draw_house(rng, config, catalogue)
        except (PlanError, FurnishError) as error:
            rejects.append(str(error))
            continue
        built = _build(draft, config)
        lay_ground(built.spec, house_text(built.spec), seed, POOL_STREAM[config.pool])
        faults = check_house(built.spec, furnished=True)
        if not faults:
            return GeneratedHouse(built.spec, draft.plan, tuple(rejects), built.styles)
        rejects.append("; ".join(faults))
    reasons = "; ".join(f"{reason} ({count} x)" for reason, count in Counter(rejects).most_common(MAX_REASONS))
    raise HouseError(f"Seed {seed} gave no house without faults in {MAX_TRIES} tries: {reasons}.")


@dataclass(frozen=True)
class _Draft:
    """A home before it becomes a specification."""

    plan: FloorPlan
    ceiling_m: float
    structure: list[PlacedItem]
    layouts: list[RoomLayout]
    lamps: list[Lamp]
    time: str
    """Time of day, a key of `DAYLIGHT`."""
    hazards: tuple[PlacedHazard, ...] = ()
    upper: UpperStorey | None = None


def _draw_house(rng: np.random.Generator, config: HouseConfig, catalogue: Catalogue) -> _Draft:
    """Draws one home.

    Raises:
        PlanError: no floor plan fits.
        FurnishError: a room did not get the furniture that it needs.
    """
    area_m2, kind = _draw_size(rng, config)
    clutter = config.clutter if config.clutter is not None else float(rng.uniform(0.25, 0.85))
    ceiling_m = round(float(rng.uniform(2.5, 2.8)), 2)
    plan, openings, stairs = _draw_storeys(rng, kind, area_m2, config)
    if stairs is not None:
        ceiling_m = stairs.ceiling_m
    looks = draw_structure_looks(rng, plan, config.pool)
    structure = build_structure(plan, openings, ceiling_m, looks, ceiling_hole=stairs.flight.well if stairs else None)
    kinds = frozenset(room.kind for room in plan.rooms)
    source = FurnitureSource(rng, config.pool, clutter, kinds, catalogue, reshape=config.reshape)
    layouts = [RoomLayout(index, room.kind, room.rect, openings, ceiling_m) for index, room in enumerate(plan.rooms)]
    for layout in layouts:
        if stairs is not None and layout.kind == "stair_hall":
            stairs.flight.close_off(layout, upper=False)
        furnish(layout, source)
    draft = _Draft(plan, ceiling_m, structure, layouts, draw_lamps(rng, plan, ceiling_m, looks.time), looks.time)
    if stairs is not None:
        draft = replace(draft, upper=draw_upper_storey(rng, stairs, config.pool, source, looks))
    if not config.hazards:
        return draft
    bare = _build(draft, config).spec
    hazards = draw_hazards(rng, config.hazards, config.pool, bare, openings, config.hazard_count)
    return replace(draft, hazards=hazards)


def _draw_storeys(
    rng: np.random.Generator, kind: PlanKind, area_m2: float, config: HouseConfig
) -> tuple[FloorPlan, tuple[Opening, ...], Stairs | None]:
    """Returns the plan of the ground storey, the openings in its walls, and the stairs to a second storey.

    Raises:
        PlanError: no plan fits, or the stairs do not fit into any of the plans.
    """
    error = PlanError("no stairs were drawn")
    for _ in range(MAX_STAIRS_TRIES):
        plan, openings = _draw_plan(rng, kind, area_m2, config)
        if config.storeys == 1:
            return plan, openings, None
        try:
            stairs = draw_stairs(rng, plan, openings)
        except PlanError as fault:
            error = fault
        else:
            return plan, stairs.lower_openings, stairs
    raise error


def _draw_plan(
    rng: np.random.Generator, kind: PlanKind, area_m2: float, config: HouseConfig
) -> tuple[FloorPlan, tuple[Opening, ...]]:
    """Returns a plan and the openings in its walls; many plans are drawn before one fits.

    Raises:
        PlanError: no plan fits.
    """
    must_match = config.exact and config.area_m2 is not None
    rooms, error = config.wanted_rooms, PlanError("no plan was drawn")
    for _ in range(MAX_PLAN_TRIES):
        try:
            drawn_m2 = area_m2 * float(rng.uniform(*DRAWN_AREAS)) if must_match else area_m2
            plan = draw_floor_plan(rng, kind, drawn_m2, rooms)
            if config.exact:
                _require_as_asked(plan, area_m2 if must_match else None, rooms)
            if faults := size_rule_faults(plan):
                raise PlanError(faults[0])
            openings = cut_openings(rng, plan)
            if faults := plan_rule_faults(plan, openings):
                raise PlanError(faults[0])
            return plan, openings
        except PlanError as fault:
            error = fault
    raise error


def _require_as_asked(plan: FloorPlan, area_m2: float | None, rooms: tuple[str, ...]) -> None:
    """Raises PlanError if a plan lacks a room, or its area differs by too much from the requested one."""
    missing = Counter(rooms) - Counter(room.kind for room in plan.rooms)
    if missing:
        raise PlanError(f"no place for {next(iter(missing))}")
    inner_m2 = sum(room.rect.grown(-HALF_WALL_M).area_m2 for room in plan.rooms)
    if area_m2 is None:
        return
    if max(abs(plan.area_m2 - area_m2), abs(inner_m2 - area_m2)) > MAX_AREA_ERROR * area_m2:
        raise PlanError(f"no plan has {area_m2:.0f} m2")


def _build(draft: _Draft, config: HouseConfig) -> HouseBuilder:
    """Returns the builder of a drawn home, which has its specification and the styles of its items."""
    builder = HouseBuilder(config.name)
    builder.add_ground(draft.plan.bounds.grown(OUTER_WALL_M))
    for room in draft.plan.rooms:
        builder.add_room(room.name, room.rect.grown(-HALF_WALL_M), draft.ceiling_m)
    storeys = [(0.0, draft.structure, draft.layouts)]
    if draft.upper is not None:
        draft.upper.add_ground(builder)
        storeys.append((draft.upper.stairs.floor_z_m, draft.upper.structure, draft.upper.layouts))
    for z_m, structure, layouts in storeys:
        for placed in structure:
            builder.add(lifted(placed, z_m))
        for layout in layouts:
            for placement in layout.placements:
                if config.movable and not supports_items(layout, placement):
                    builder.add_movable(lifted(placement.placed, z_m))
                else:
                    builder.add(lifted(placement.placed, z_m))
    for number, hazard in enumerate(draft.hazards):
        hazard.add_to(builder, number)
    builder.set_ambient(DAYLIGHT[draft.time].ambient)
    for lamp in [*draft.lamps, *(draft.upper.lamps if draft.upper else ())]:
        builder.add_lamp(lamp)
    return builder


def _draw_size(rng: np.random.Generator, config: HouseConfig) -> tuple[float, PlanKind]:
    """Returns area and kind of plan; a missing one is drawn to suit the other."""
    kind = config.kind
    if config.area_m2 is not None:
        low, high = config.areas_m2
        area_m2 = low if low == high else float(rng.uniform(low, high))
        return area_m2, kind or draw_plan_kind(rng, area_m2)
    if kind is None:
        kind = PLAN_KINDS[int(rng.integers(len(PLAN_KINDS)))]
    low, high = PLAN_AREA_M2[kind]
    return float(rng.uniform(low, high)), kind
