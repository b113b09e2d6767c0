"""Builds walls, floors and ceilings of a floor plan, as labelled items in their places.

Each room has its own half of a wall, so that it can have its own paint; a hole is cut out of both halves at the same
place. Outer walls extend `OUTER_WALL_M` further outwards. The floors of the rooms are visual only, and one invisible
slab lies under the whole home, until `sim.homes.housegen.ground` makes the floors solid in its place.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sim.homes.housegen.floor_plan import FloorPlan
from sim.homes.housegen.floor_plan.rectangles import (
    EPS_M,
    OPPOSITE,
    SIDES,
    Interval,
    Rect,
    Side,
    frame_around,
    side_point,
    subtract,
)
from sim.homes.housegen.furniture.item import Geom, Item, Look
from sim.homes.housegen.mjcf.placed import PlacedItem
from sim.homes.housegen.mjcf.triangles import mesh_shape
from sim.homes.housegen.structure.doors_windows import OpeningItems, place_door, place_in_wall
from sim.homes.housegen.structure.openings import HALF_WALL_M, JAMB_M, OUTER_WALL_M, Opening, outer_spans
from sim.homes.housegen.structure.parts import CASING_M, StructureLooks, oriented_box, structure_item

BASEBOARD_M = (0.012, 0.08)
"""Thickness and height of baseboards."""
SLAB_M = 0.1
"""Thickness of floors."""
CEILING_M = 0.06
"""Thickness of ceilings."""


def build_structure(
    plan: FloorPlan,
    openings: Sequence[Opening],
    ceiling_m: float,
    looks: StructureLooks,
    *,
    floor_hole: Rect | None = None,
    ceiling_hole: Rect | None = None,
) -> list[PlacedItem]:
    """Returns everything that is part of the building, for one storey with its floor at z = 0.

    The floor and the ceiling of the stair hall may have a hole, the stairwell.
    """
    placed = []
    rects = [room.rect for room in plan.rooms]
    for i, room in enumerate(plan.rooms):
        here = [opening for opening in openings if i in (opening.a, opening.b)]
        is_hall = i == plan.stair_hall()
        floor = _plates(room.rect, floor_hole if is_hall else None, -SLAB_M, 0.0, looks.floors[room.name])
        top_m = ceiling_m + CEILING_M
        ceiling = _plates(room.rect, ceiling_hole if is_hall else None, ceiling_m, top_m, looks.ceiling)
        items = [structure_item("floor", "room", floor), structure_item("ceiling", "room", ceiling)]
        items += _room_walls(rects, i, here, ceiling_m, looks.walls[room.name], looks.trim)
        placed += [PlacedItem(item) for item in items]
    opening_items = OpeningItems(looks)
    for opening in openings:
        if opening.kind == "window":
            placed.append(place_in_wall(opening_items.window(opening), opening))
        elif opening.kind in ("door", "entry"):
            placed += place_door(opening, opening_items)
    return placed


def _plates(rect: Rect, hole: Rect | None, z0_m: float, z1_m: float, look: Look) -> list[Geom]:
    """Returns visual boxes that cover a rectangle except for a hole."""
    pieces = [rect] if hole is None else frame_around(rect, hole)
    return [oriented_box((r.x0, r.x1, r.y0, r.y1, z0_m, z1_m), look, solid=False) for r in pieces]


def _room_walls(
    rects: Sequence[Rect], room: int, openings: Sequence[Opening], ceiling_m: float, paint: Look, trim: Look
) -> list[Item]:
    """Returns one wall item for each side of a room that has any wall; the baseboards are part of the first."""
    rect = rects[room]
    walls, boards = [], []
    for side in SIDES:
        holes = [o for o in openings if o.side_of(room) == side]
        geoms = []
        outer = outer_spans(rects, room, side)
        for lo, hi in subtract(rect.span(side), outer):
            if side in ("north", "south"):
                lo, hi = max(lo, rect.x0 + HALF_WALL_M), min(hi, rect.x1 - HALF_WALL_M)
            geoms += _wall_boxes(rect, side, (lo, hi), 0.0, holes, ceiling_m, paint)
        for span in outer:
            geoms += _wall_boxes(rect, side, _to_corner(rects, room, side, span), OUTER_WALL_M, holes, ceiling_m, paint)
        if geoms:
            walls.append(structure_item("wall", "side", geoms))
        boards += [(side, board) for board in _baseboards(rect, side, holes)]
    if walls and boards:
        walls[0] = structure_item("wall", "side", [*walls[0].geoms, _boards_mesh(boards, rect.centre, trim)])
    return walls


def _to_corner(rects: Sequence[Rect], room: int, side: Side, span: Interval) -> Interval:
    """Returns an outer stretch of wall, longer by its thickness where it ends at an outer corner of the home."""
    rect = rects[room]
    whole = rect.span(side)
    line = rect.line(side)

    def grown(end: float, corner: float, step: float) -> float:
        along = end + step * 0.02
        if abs(end - corner) > EPS_M:
            return end
        for across in (line + 0.02, line - 0.02):  # a room around the corner, or one in the same line
            if any(r.distance_to(*side_point(side, along, across)) <= EPS_M for r in rects):
                return end
        return end + step * OUTER_WALL_M

    return grown(span[0], whole[0], -1.0), grown(span[1], whole[1], 1.0)


def _wall_boxes(
    rect: Rect, side: Side, span: Interval, outward_m: float, holes: Sequence[Opening], ceiling_m: float, paint: Look
) -> list[Geom]:
    """Returns the boxes of one stretch of wall around its holes; neighbouring holes share one lintel."""
    holes = [hole for hole in holes if hole.span[1] > span[0] + EPS_M and hole.span[0] < span[1] - EPS_M]
    boxes: list[tuple[Interval, float, float]] = []
    for lo, hi in subtract(span, [hole.span for hole in holes if hole.top_m >= ceiling_m]):
        here = [(max(h.span[0], lo), min(h.span[1], hi), h) for h in holes if lo < h.centre_m < hi]
        if not here:
            boxes.append(((lo, hi), 0.0, ceiling_m))
            continue
        first, last = min(start for start, _, _ in here), max(end for _, end, _ in here)
        head_m = max(hole.top_m for _, _, hole in here)
        boxes += [(pier, 0.0, ceiling_m) for pier in subtract((lo, hi), [(first, last)])]
        boxes += [(pier, 0.0, head_m) for pier in subtract((first, last), [(start, end) for start, end, _ in here])]
        boxes.append(((first, last), head_m, ceiling_m))
        for start, end, hole in here:
            edges = [(0.0, hole.bottom_m), (hole.top_m, head_m)]
            boxes += [((start, end), z0, z1) for z0, z1 in edges if z1 - z0 > EPS_M]
    geoms = []
    for piece, z0, z1 in boxes:
        strip = rect.strip(side, piece, HALF_WALL_M, outward_m)
        geoms.append(oriented_box((strip.x0, strip.x1, strip.y0, strip.y1, z0, z1), paint, side))
    return geoms


def _baseboards(rect: Rect, side: Side, holes: Sequence[Opening]) -> list[Rect]:
    """Returns footprints of the baseboards along a side, between the door frames."""
    lo, hi = rect.span(side)
    inner = rect.grown(-HALF_WALL_M)
    gaps = []
    for hole in holes:
        if hole.bottom_m == 0.0:
            margin = CASING_M[0] - JAMB_M if hole.kind in ("door", "entry") else 0.0
            gaps.append((hole.span[0] - margin, hole.span[1] + margin))
    pieces = subtract((lo + HALF_WALL_M, hi - HALF_WALL_M), gaps, 0.03)
    return [inner.strip(side, piece, BASEBOARD_M[0]) for piece in pieces]


def _boards_mesh(boards: Sequence[tuple[Side, Rect]], centre: tuple[float, float], look: Look) -> Geom:
    """Returns all baseboards of a room as one mesh of their visible faces: front and upper edge."""
    vertices: list[tuple[float, float, float]] = []
    faces: list[tuple[int, int, int]] = []
    for side, rect in boards:
        back = rect.line(side)
        front = rect.line(OPPOSITE[side])
        n = len(vertices)
        for along in rect.span(side):
            for across, z in ((front, 0.0), (front, BASEBOARD_M[1]), (back, BASEBOARD_M[1])):
                x, y = side_point(side, along, across)
                vertices.append((x - centre[0], y - centre[1], z))
        quads = ((n, n + 3, n + 4, n + 1), (n + 1, n + 4, n + 5, n + 2))
        for a, b, c, d in quads if side in ("north", "west") else [q[::-1] for q in quads]:
            faces += [(a, b, c), (a, c, d)]
    mesh = mesh_shape("boards", np.array(vertices), np.array(faces, dtype=np.int32))
    return Geom("mesh", (), (*centre, 0.0), look, solid=False, mesh=mesh)
