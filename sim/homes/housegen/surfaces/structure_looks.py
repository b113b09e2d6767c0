"""Draws the looks of a home's structure, and its time of day."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sim.homes.housegen.floor_plan import FloorPlan
from sim.homes.housegen.furniture.item import Look, Pool
from sim.homes.housegen.structure.parts import StructureLooks
from sim.homes.housegen.surfaces import materials
from sim.homes.housegen.surfaces.lighting import draw_time, draw_views

TRIM = {"train": (0.94, 0.94, 0.92, 1.0), "heldout": (0.90, 0.88, 0.83, 1.0)}
WALLPAPER_ROOMS = frozenset(("living_room", "bedroom", "dining_room", "studio"))
"""Rooms that may have patterned wallpaper; one room of a home at most."""
MAX_CHROMA = 0.25
"""Largest difference between the parts red, green and blue of the colour of a floor of stone or tiles in hallways."""


def draw_structure_looks(rng: np.random.Generator, plan: FloorPlan, pool: Pool) -> StructureLooks:
    """Returns paint and floors by room; rooms without a wall between them share theirs."""
    walls = {}
    main_wall = _wall_look(rng, pool, "hallway")
    shared = _open_rooms(plan)
    has_wallpaper = False
    for i, room in enumerate(plan.rooms):
        own = _wall_look(rng, pool, room.kind, paper=not has_wallpaper and room.kind in WALLPAPER_ROOMS)
        has_wallpaper = has_wallpaper or _is_wallpaper(own)
        walls[room.name] = main_wall if room.kind == "hallway" or i in shared else own
    floors = _floors(rng, plan, pool)
    trim = Look(TRIM[pool], specular=0.2)
    time = draw_time(rng)
    door = materials.look("wood", rng, pool) if rng.random() < 0.5 else materials.look("lacquer", rng, pool)
    frame = trim if rng.random() < 0.6 else door
    return StructureLooks(
        walls, floors, replace(materials.ceiling_look(rng, pool), texture=None), trim, door,
        frame, materials.look("metal", rng, pool), draw_views(rng, pool, time), time,
    )  # fmt: skip


def _floors(rng: np.random.Generator, plan: FloorPlan, pool: Pool) -> dict[str, Look]:
    """Returns the floor of each room: a home has few, and they change at doors.

    Hallways and most living rooms have one hard floor; bedrooms have boards or carpet; rooms with water have tiles or
    stone. Rooms without a wall between them share a hard floor, but for a kitchen, which has tiles or stone of its own.
    """
    main = materials.floor_look("hallway", rng, pool)
    while not _is_calm(main):
        main = materials.floor_look("hallway", rng, pool)
    living, wooden = materials.floor_look("living_room", rng, pool), materials.floor_look_of("boards", rng, pool)
    if rng.random() < 0.7 and _is(main, "planks", "parquet", "marble"):
        living = main
    elif _open_rooms(plan) and _is(living, "carpet"):
        living = wooden
    private = materials.floor_look("bedroom", rng, pool)
    if rng.random() < 0.6 and _is(main, "planks", "parquet"):
        private = main
    wet = [materials.floor_look("bathroom", rng, pool) for _ in range(2)]
    kitchen, laundry = (materials.floor_look(kind, rng, pool) for kind in ("kitchen", "laundry"))
    while kitchen == living:
        kitchen = materials.floor_look("kitchen", rng, pool)
    shared, floors = _open_rooms(plan), {}
    for i, room in enumerate(plan.rooms):
        if room.kind in ("hallway", "stair_hall"):
            floor = main
        elif room.kind == "bathroom":
            floor = wet[int(rng.integers(2))]
        elif room.kind in ("kitchen", "laundry"):
            floor = kitchen if room.kind == "kitchen" else laundry
        elif room.kind == "studio":
            floor = wooden if _is(living, "carpet") else living
        elif room.kind == "gym":
            floor = materials.floor_look("gym", rng, pool)
        else:
            floor = living if i in shared or room.kind in ("living_room", "dining_room") else private
        floors[room.name] = floor
    return floors


def _is(look: Look, *kinds: str) -> bool:
    """Returns whether the texture of a floor is of one of some kinds: tiles, carpet, planks, parquet, marble."""
    return look.texture is not None and look.texture.startswith(kinds)


def _is_calm(look: Look) -> bool:
    """Returns whether a floor suits all hallways of a home: wood, or tiles without a strong colour."""
    return _is(look, "planks", "parquet") or max(look.rgba[:3]) - min(look.rgba[:3]) < MAX_CHROMA


def _wall_look(rng: np.random.Generator, pool: Pool, room_kind: str, *, paper: bool = False) -> Look:
    """Returns tiles for wet rooms, else paint, more often smooth than rough; wallpaper only with `paper`."""
    look = materials.wall_look(rng, pool, room_kind)
    smooth = bool(rng.random() < 0.6)
    if look.texture is None or look.texture.startswith("tiles"):
        return look
    plain = not paper if _is_wallpaper(look) else smooth
    return replace(look, texture=None) if plain else look


def _is_wallpaper(look: Look) -> bool:
    return look.texture is not None and look.texture.startswith("paper")


def _open_rooms(plan: FloorPlan) -> set[int]:
    """Returns the indices of rooms that are connected to another one without any wall."""
    return {room for join in plan.joins if join.kind in ("open", "partial") for room in (join.a, join.b)}
