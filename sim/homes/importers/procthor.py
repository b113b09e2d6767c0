"""Builds a house from a ProcTHOR house: rooms, walls, doors, windows, light and furniture of our generator.

The meshes of ProcTHOR's assets belong to Unity's engine and are not available. Each object becomes a piece of our
furniture of the same category in the size of its asset, or a labelled box (`sim.homes.importers.fitting`).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from sim.gl import mujoco
from sim.homes.housegen.floor_plan.plan import FloorPlan
from sim.homes.housegen.floor_plan.rectangles import Rect
from sim.homes.housegen.furniture.item import Look, Pool
from sim.homes.housegen.mjcf.builder import HouseBuilder
from sim.homes.housegen.mjcf.placed import PlacedItem
from sim.homes.housegen.structure.building import build_structure
from sim.homes.housegen.structure.doors_windows import OpeningItems, place_leaf
from sim.homes.housegen.structure.openings import HALF_WALL_M, JAMB_M, OUTER_WALL_M, Leaf, Opening, leaf_keep_out
from sim.homes.housegen.structure.parts import StructureLooks
from sim.homes.housegen.surfaces import materials
from sim.homes.housegen.surfaces.lighting import DAYLIGHT, draw_lamps
from sim.homes.housegen.surfaces.structure_looks import draw_structure_looks
from sim.homes.importers.fitting import Fitter, tinted
from sim.homes.importers.losses import Losses
from sim.homes.importers.procthor_files import Asset, Material, Source, SourceHouse, parse_house
from sim.homes.importers.procthor_objects import ObjectPlacer, Standing
from sim.homes.importers.procthor_plan import DoorHole, Layout, lay_out

Doors = Literal["open", "as-is"]
LAMP_CEILING_M = 2.8
"""Lamps hang as if no ceiling were higher than this."""
MIN_LAMP_M2 = 5.0
"""Smaller rectangles of a room get no lamp of their own."""
OPEN_RAD = math.pi / 2
PASSAGE_M = 0.75
"""Length of the floor in front of a door that no other leaf should cover."""
FLOORS = {
    "carpet": ("carpet", "rug", "fabric"), "tiles": ("tile", "brick", "concrete", "grey", "ceramic"),
    "stone": ("marble", "stone", "granite"), "boards": ("wood", "parquet", "plank", "bedroomfloor", "floor"),
}  # fmt: skip
"""Our kinds of floors, each with the words that name it in ProcTHOR's materials; the first that is found counts."""


@dataclass(frozen=True)
class Imported:
    """A house with the report of its import."""

    spec: mujoco.MjSpec
    report: Mapping[str, Any]


@dataclass(frozen=True, kw_only=True)
class ProcthorConfig:
    """Options for the import of a ProcTHOR house."""

    doors: Doors = "open"
    """`open`: inner doors are opened to a right angle; `as-is`: to the angle of the source."""
    pool: Pool = "heldout"
    """Styles, colours and textures that may appear."""
    seed: int = 0
    """Seed of styles and colours."""


def import_house(source: Source, assets: Mapping[str, Asset], config: ProcthorConfig) -> Imported:
    """Returns the imported house.

    Args:
        source: one house of a file.
        assets: the asset database.
        config: options.

    Raises:
        HouseError: the house is broken; the message names file, line and place.
    """
    house, losses = parse_house(source), Losses()
    layout = lay_out(house, source.where, losses)
    rng = np.random.default_rng([config.seed, *source.name.encode()])
    looks = _looks(rng, house, layout, config.pool)
    placer = ObjectPlacer(layout, assets, Fitter(rng, config.pool), losses, source.where)
    placer.place(house.objects)
    doors, leaves = _doors(layout, placer.standing, config.doors, OpeningItems(looks), losses)
    structure = [*build_structure(layout.plan, (*layout.openings, *doors), layout.ceiling_m, looks), *leaves]
    builder = HouseBuilder(source.name)
    builder.add_ground(layout.plan.bounds.grown(OUTER_WALL_M))
    for room in layout.plan.rooms:
        builder.add_room(room.name, room.rect.grown(-HALF_WALL_M), layout.ceiling_m)
    for part in structure:
        builder.add(part)
    for number, item in enumerate(placer.standing):
        free = item.is_loose and not _touches(number, placer.standing)
        (builder.add_movable if free else builder.add)(item.placed)
    builder.set_ambient(DAYLIGHT[looks.time].ambient)
    for lamp in draw_lamps(rng, _lit(layout), min(layout.ceiling_m, LAMP_CEILING_M), looks.time):
        builder.add_lamp(lamp)
    return Imported(builder.spec, _report(source, house, layout, losses))


def _report(source: Source, house: SourceHouse, layout: Layout, losses: Losses) -> dict[str, object]:
    inner = [door.opening for door in layout.doors if door.opening.b is not None]
    return {
        "house": source.name,
        "source": source.where,
        "rooms": len(house.rooms),
        "area_m2": round(layout.plan.area_m2, 2),
        "ceiling_m": layout.ceiling_m,
        "inner_doors": len(inner),
        "outer_doors": len(layout.doors) - len(inner),
        "windows": sum(opening.kind == "window" for opening in layout.openings),
        **losses.as_json(),
    }


def _looks(rng: np.random.Generator, house: SourceHouse, layout: Layout, pool: Pool) -> StructureLooks:
    """Returns the looks of walls and floors: the kind of floor and the colour of the paint are those of the source."""
    looks = draw_structure_looks(rng, layout.plan, pool)
    walls, floors = dict(looks.walls), dict(looks.floors)
    paint = {wall.roomId: wall.material.color for wall in house.walls if isinstance(wall.material, Material)}
    made: dict[int, tuple[Look, Look]] = {}
    for room, index in zip(layout.plan.rooms, layout.room_of, strict=True):
        if index not in made:
            source = house.rooms[index]
            kind, rgb = _floor_kind(source.floorMaterial), paint.get(source.id)
            wall = walls[room.name]
            floor = materials.floor_look_of(kind, rng, pool) if kind else floors[room.name]
            made[index] = (wall if rgb is None else tinted(wall, (rgb.r, rgb.g, rgb.b)), floor)
        walls[room.name], floors[room.name] = made[index]
    return replace(looks, walls=walls, floors=floors)


def _floor_kind(material: Material | str | None) -> str | None:
    """Returns our kind of floor for a material of the source, or None if its name does not tell."""
    name = (material.name if isinstance(material, Material) else material or "").lower()
    return next((kind for kind, words in FLOORS.items() if any(word in name for word in words)), None)


def _lit(layout: Layout) -> FloorPlan:
    """Returns the rectangles that get a lamp: the largest of each room, and others that are large enough."""
    seen: set[int] = set()
    rooms = []
    for room, index in zip(layout.plan.rooms, layout.room_of, strict=True):
        if index not in seen or room.rect.area_m2 >= MIN_LAMP_M2:
            rooms.append(room)
        seen.add(index)
    return replace(layout.plan, rooms=tuple(rooms))


def _doors(
    layout: Layout, standing: Sequence[Standing], doors: Doors, items: OpeningItems, losses: Losses
) -> tuple[list[Opening], list[PlacedItem]]:
    """Returns the openings of the doors, and the leaves of those that have any, which are not part of the openings."""
    openings: list[Opening] = []
    leaves: list[PlacedItem] = []
    swept: list[Rect] = []
    for door in layout.doors:
        openings.append(door.opening)
        if door.opening.kind == "entry" or not door.leaves:
            continue
        openness = door.openness
        if doors == "open" and openness < 1.0:
            losses.changes["A door that was not fully open was opened."] += 1
            openness = 1.0
        halves = _leaf_openings(door, openness, layout, standing, [*swept, *_passages(layout, door)])
        swept += [leaf_keep_out(half, layout.plan.rooms[half.leaf.room].rect) for half in halves if half.leaf]
        leaves += [place_leaf(half, items) for half in halves]
    return openings, leaves


def _passages(layout: Layout, door: DoorHole) -> Iterator[Rect]:
    """Yields the floor in front of all other doors, on both sides."""
    for other in layout.doors:
        for room in (other.opening.a, other.opening.b) if other is not door else ():
            if room is not None:
                rect = layout.plan.rooms[room].rect
                yield rect.strip(other.opening.side_of(room), other.opening.span, PASSAGE_M)


def _leaf_openings(
    door: DoorHole, openness: float, layout: Layout, standing: Sequence[Standing], keep_free: Sequence[Rect]
) -> list[Opening]:
    """Returns an opening for each leaf of a door, which swings to the side where it meets least furniture.

    Args:
        door: a door with leaves.
        openness: 0 is closed, 1 a right angle.
        layout: of the house.
        standing: all objects.
        keep_free: places that count more than furniture: other leaves, and the floor in front of other doors.
    """
    hole = door.opening
    lo, hi = hole.clear_span()
    middle = 0.5 * (lo + hi)
    spans = [(lo, hi)] if door.leaves == 1 else [(lo, middle), (middle, hi)]
    choices = []
    for room in (hole.a, hole.b):
        assert room is not None
        for first_hinge in (True, False) if door.leaves == 1 else (True,):
            made = [
                replace(
                    hole, span=(a - JAMB_M, b + JAMB_M), leaf=Leaf(room, first_hinge == (n == 0), openness * OPEN_RAD)
                )
                for n, (a, b) in enumerate(spans)
            ]
            zones = [leaf_keep_out(leaf, layout.plan.rooms[room].rect) for leaf in made]
            met = sum(zone.overlaps(item.footprint) for zone in zones for item in standing)
            depth = layout.plan.rooms[room].rect.across_m(hole.side_of(room))
            met += 3 * sum(zone.overlaps(area) for zone in zones for area in keep_free)
            choices.append((met + 10 * (depth < (hi - lo) / door.leaves + HALF_WALL_M), len(choices), made))
    return min(choices, key=lambda choice: choice[:2])[2]


def _touches(number: int, standing: Sequence[Standing]) -> bool:
    """Returns whether the footprint of an object overlaps another one's, so that it cannot be pushed freely."""
    own = standing[number]
    return any(own.footprint.overlaps(item.footprint) for n, item in enumerate(standing) if n != number)
