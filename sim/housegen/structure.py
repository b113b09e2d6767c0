"""Walls, floors, ceilings, doors and windows of a floor plan, as labelled items in their places.

Each room builds its own half of a wall, so that it can have its own paint; a hole is cut out of both halves at the
same place. Outer walls reach `OUTER_WALL_M` further out. Wheels run on one invisible slab under the whole home, so
that they never cross a seam; the floors of the rooms are only seen.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sim.housegen.floor_plan import FloorPlan
from sim.housegen.furniture.item import Geom, Item, Look
from sim.housegen.mjcf import PlacedItem
from sim.housegen.openings import HALF_WALL_M, JAMB_M, OUTER_WALL_M, Opening, outer_spans
from sim.housegen.rectangles import EPS_M, OPPOSITE, SIDES, Interval, Rect, Side, subtract
from sim.housegen.triangles import mesh_shape

BASEBOARD_M = (0.012, 0.08)
"""Thickness and height."""
CASING_M = (0.07, 0.014)
"""Width and thickness of the boards around a door."""
SLAB_M = 0.1
"""Thickness of floors."""
Box3 = tuple[float, float, float, float, float, float]
"""x0, x1, y0, y1, z0, z1."""


@dataclass(frozen=True)
class StructureLooks:
    """The looks of one home's structure."""

    walls: Mapping[str, Look]
    """By room name."""
    floors: Mapping[str, Look]
    """By room name."""
    ceiling: Look
    outside: Look
    trim: Look
    """Baseboards and window frames."""
    door: Look
    door_frame: Look
    handle: Look
    sky: Look


def build_structure(
    plan: FloorPlan, openings: Sequence[Opening], ceiling_m: float, finish: StructureLooks
) -> list[PlacedItem]:
    """Everything that is part of the building; doors and windows of one size are one design."""
    placed = []
    rects = [room.rect for room in plan.rooms]
    for i, room in enumerate(plan.rooms):
        here = [opening for opening in openings if i in (opening.a, opening.b)]
        items = [_floor(room.rect, finish.floors[room.name]), _ceiling(room.rect, ceiling_m, finish.ceiling)]
        items += _room_walls(rects, i, here, ceiling_m, finish.walls[room.name], finish.trim)
        placed += [PlacedItem(item) for item in items]
    designs = _Designs(finish)
    for opening in openings:
        if opening.kind == "window":
            placed.append(_in_wall(designs.window(opening), opening))
        elif opening.kind in ("door", "entry"):
            placed += _door(opening, designs)
    return placed


def oriented_box(box: Box3, look: Look, facing: Side | None = None, *, solid: bool = True) -> Geom:
    """A box; with `facing` its local z looks along that side's normal and its local x stays level.

    MuJoCo lays a texture true to scale only on the faces along a box's local z: the visible face of a wall must be
    one of them.
    """
    x0, x1, y0, y1, z0, z1 = box
    at = (round(0.5 * (x0 + x1), 4), round(0.5 * (y0 + y1), 4), round(0.5 * (z0 + z1), 4))
    half = np.round([0.5 * (x1 - x0), 0.5 * (y1 - y0), 0.5 * (z1 - z0)], 4)
    if facing is None or look.texture is None:
        return Geom("box", tuple(half.tolist()), at, look, solid=solid)
    if facing in ("north", "south"):  # local x, y, z = world x, z, -y
        return Geom("box", (float(half[0]), float(half[2]), float(half[1])), at, look, (math.pi / 2, 0.0, 0.0), solid)
    # local x, y, z = world y, z, x
    return Geom(
        "box", (float(half[1]), float(half[2]), float(half[0])), at, look, (math.pi / 2, math.pi / 2, 0.0), solid
    )


def _item(category: str, style: str, geoms: Sequence[Geom]) -> Item:
    return Item(category, style, (0.0, 0.0, 0.0), tuple(geoms))


def _seen_boxes(boxes: Sequence[Box3], look: Look) -> list[Geom]:
    """Boxes that nothing touches."""
    return [oriented_box(box, look, solid=False) for box in boxes]


def _floor(rect: Rect, look: Look) -> Item:
    return _item("floor", "room", [oriented_box((rect.x0, rect.x1, rect.y0, rect.y1, -SLAB_M, 0.0), look, solid=False)])


def _ceiling(rect: Rect, ceiling_m: float, look: Look) -> Item:
    box = (rect.x0, rect.x1, rect.y0, rect.y1, ceiling_m, ceiling_m + 0.06)
    return _item("ceiling", "room", [oriented_box(box, look, solid=False)])


def _room_walls(
    rects: Sequence[Rect], room: int, openings: Sequence[Opening], ceiling_m: float, paint: Look, trim: Look
) -> list[Item]:
    """One wall item for each side of a room that has any wall, and the baseboards as part of the first."""
    rect = rects[room]
    walls, boards = [], []
    for side in SIDES:
        holes = [o for o in openings if o.side_of(room) == side]
        geoms = []
        outer = outer_spans(rects, room, side)
        for lo, hi in subtract(rect.span(side), outer):
            if side in ("north", "south"):
                lo, hi = max(lo, rect.x0 + HALF_WALL_M), min(hi, rect.x1 - HALF_WALL_M)
            geoms += _pierced(rect, side, (lo, hi), 0.0, holes, ceiling_m, paint)
        for span in outer:
            geoms += _pierced(rect, side, _round_corner(rects, room, side, span), OUTER_WALL_M, holes, ceiling_m, paint)
        if geoms:
            walls.append(_item("wall", "side", geoms))
        boards += [(side, board) for board in _baseboards(rect, side, holes)]
    if walls and boards:
        walls[0] = _item("wall", "side", [*walls[0].geoms, _boards_mesh(boards, rect.centre, trim)])
    return walls


def _round_corner(rects: Sequence[Rect], room: int, side: Side, span: Interval) -> Interval:
    """An outer stretch, longer by the wall's thickness where it ends at an outer corner of the home."""
    rect = rects[room]
    whole = rect.span(side)
    sign = 1.0 if side in ("east", "north") else -1.0
    beyond = rect.line(side) + sign * 0.02

    def grown(end: float, corner: float, step: float) -> float:
        along = end + step * 0.02
        point = (beyond, along) if side in ("east", "west") else (along, beyond)
        free = all(r.distance_to(*point) > EPS_M for r in rects)
        return end + step * OUTER_WALL_M if abs(end - corner) < EPS_M and free else end

    return grown(span[0], whole[0], -1.0), grown(span[1], whole[1], 1.0)


def _pierced(
    rect: Rect, side: Side, span: Interval, outward_m: float, holes: Sequence[Opening], ceiling_m: float, paint: Look
) -> list[Geom]:
    """Boxes of one stretch of wall around its holes; over neighbouring holes lies one lintel."""
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
    """Footprints of the boards along a side, between the door frames."""
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
    """All baseboards of a room in one mesh: of each only its face and its upper edge, which is all that is seen."""
    vertices: list[tuple[float, float, float]] = []
    faces: list[tuple[int, int, int]] = []
    for side, rect in boards:
        back = rect.line(side)
        front = rect.line(OPPOSITE[side])
        n = len(vertices)
        for along in rect.span(side):
            for across, z in ((front, 0.0), (front, BASEBOARD_M[1]), (back, BASEBOARD_M[1])):
                x, y = (across, along) if side in ("east", "west") else (along, across)
                vertices.append((x - centre[0], y - centre[1], z))
        quads = ((n, n + 3, n + 4, n + 1), (n + 1, n + 4, n + 5, n + 2))
        for a, b, c, d in quads if side in ("north", "west") else [q[::-1] for q in quads]:
            faces += [(a, b, c), (a, c, d)]
    mesh = mesh_shape("boards", np.array(vertices), np.array(faces, dtype=np.int32))
    return Geom("mesh", (), (*centre, 0.0), look, solid=False, mesh=mesh)


def _in_wall(item: Item, hole: Opening) -> PlacedItem:
    """A design for a hole in a north wall, turned to the hole's own wall."""
    yaw = {"north": 0.0, "west": math.pi / 2, "south": math.pi, "east": -math.pi / 2}[hole.side]
    x, y = (hole.centre_m, hole.line_m) if hole.side in ("north", "south") else (hole.line_m, hole.centre_m)
    return PlacedItem(item, x, y, 0.0, yaw)


class _Designs:
    """The home's windows and doors by size, each made once."""

    def __init__(self, finish: StructureLooks) -> None:
        self._finish = finish
        self._made: dict[tuple[object, ...], Item] = {}

    def window(self, hole: Opening) -> Item:
        """The window for a hole; in the frame of `_in_wall`."""
        key = ("window", _width(hole), hole.bottom_m, hole.top_m)
        return self._once(key, lambda: _window(_width(hole), hole.bottom_m, hole.top_m, self._finish))

    def frame(self, hole: Opening) -> Item:
        """The door frame for a hole; in the frame of `_in_wall`."""
        key = ("frame", _width(hole), hole.kind)
        return self._once(key, lambda: _frame(_width(hole), hole.top_m, hole.kind == "entry", self._finish))

    def leaf(self, width_m: float, high_m: float, gap_m: float) -> Item:
        """A leaf: hinge at the origin, along +x."""
        key = ("leaf", width_m, high_m, gap_m)
        return self._once(key, lambda: _item("door", "leaf", _leaf_geoms(width_m, high_m, self._finish, gap_m)))

    def _once(self, key: tuple[object, ...], make: Callable[[], Item]) -> Item:
        if key not in self._made:
            self._made[key] = make()
        return self._made[key]


def _width(hole: Opening) -> float:
    return round(hole.span[1] - hole.span[0], 3)


def _window(width_m: float, z0: float, z1: float, finish: StructureLooks) -> Item:
    """Frame with a cross, a sill, and daylight behind it."""
    lo, hi = -0.5 * width_m, 0.5 * width_m
    bar, out = 0.05, OUTER_WALL_M - 0.02
    bars = [((lo, lo + bar), z0, z1), ((hi - bar, hi), z0, z1), ((lo, hi), z0, z0 + bar), ((lo, hi), z1 - bar, z1)]
    if width_m > 0.85:
        bars.append(((-0.025, 0.025), z0, z1))
    if z1 - z0 > 1.3:
        bars.append(((lo, hi), z0 + 0.66 * (z1 - z0), z0 + 0.66 * (z1 - z0) + 0.04))
    frame: list[Box3] = [(*span, out - 0.06, out, b, t) for span, b, t in bars]
    frame.append((lo - 0.04, hi + 0.04, -HALF_WALL_M - 0.03, out, z0 - 0.025, z0))
    pane = (lo, hi, out - 0.02, OUTER_WALL_M, z0, z1)
    return _item("window", "pane", [oriented_box(pane, finish.sky, "north"), *_seen_boxes(frame, finish.trim)])


def _door(hole: Opening, designs: _Designs) -> list[PlacedItem]:
    """Frame and, where it has one, leaf: two items, both labelled door."""
    placed = [_in_wall(designs.frame(hole), hole)]
    lo, hi = hole.clear_span()
    if hole.kind == "entry":
        leaf = designs.leaf(round(hi - lo, 4), hole.top_m - JAMB_M, 0.0)
        level = hole.side in ("north", "south")
        x, y = (lo, hole.line_m) if level else (hole.line_m, lo)  # where the floor ends: nothing is seen below it
        placed.append(PlacedItem(leaf, x, y, 0.0, 0.0 if level else math.pi / 2))
    elif hole.leaf is not None:
        leaf = designs.leaf(round(hi - lo - 0.004, 4), hole.top_m - JAMB_M - 0.006, 0.01)
        placed.append(_ajar(leaf, hole))
    return placed


def _frame(width_m: float, top: float, outside: bool, finish: StructureLooks) -> Item:
    """Jambs that are touched, and the boards around them on each face of an inner wall."""
    lo, hi = -0.5 * width_m, 0.5 * width_m
    inner, outer = -HALF_WALL_M - 0.004, OUTER_WALL_M if outside else HALF_WALL_M + 0.004
    jambs: list[Box3] = [(*span, inner, outer, 0.0, top) for span in ((lo, lo + JAMB_M), (hi - JAMB_M, hi))]
    boards: list[Box3] = [(lo + JAMB_M, hi - JAMB_M, inner, outer, top - JAMB_M, top)]
    wide, thick = CASING_M
    reveal = JAMB_M - 0.008
    for face in (-1.0,) if outside else (-1.0, 1.0):
        near, far = sorted((face * HALF_WALL_M, face * (HALF_WALL_M + thick)))
        for a, b in ((lo + JAMB_M - wide, lo + reveal), (hi - reveal, hi - JAMB_M + wide)):
            boards.append((a, b, near, far, 0.0, top - JAMB_M + wide))
        boards.append((lo + reveal, hi - reveal, near, far, top - reveal, top - JAMB_M + wide))
    geoms = [oriented_box(box, finish.door_frame) for box in jambs]
    return _item("door", "frame", [*geoms, *_seen_boxes(boards, finish.door_frame)])


def _leaf_geoms(width_m: float, high_m: float, finish: StructureLooks, gap_m: float = 0.01) -> list[Geom]:
    """A leaf in a frame of its own: hinge at the origin, leaf along +x, 4 cm thick, `gap_m` over the floor."""
    half = 0.02
    geoms = [oriented_box((0.0, width_m, -half, half, gap_m, high_m), finish.door, "north")]
    for z0, z1 in ((0.18, 0.88), (1.08, high_m - 0.16)):
        box = (0.13, width_m - 0.13, -half - 0.006, half + 0.006, z0, z1)
        geoms.append(oriented_box(box, finish.door, "north", solid=False))
    at = width_m - 0.06
    handle = [(at - 0.012, at + 0.012, -half - 0.05, half + 0.05, 1.01, 1.03)]
    handle += [(at - 0.11, at + 0.012, s - 0.009, s + 0.009, 1.008, 1.032) for s in (-half - 0.05, half + 0.05)]
    return [*geoms, *_seen_boxes(handle, finish.handle)]


def _ajar(leaf: Item, hole: Opening) -> PlacedItem:
    """The leaf of an inner door, turned about its hinge into the room it opens to."""
    assert hole.leaf is not None
    lo, hi = hole.clear_span()
    side = hole.side_of(hole.leaf.room)
    into = {"east": math.pi, "west": 0.0, "north": -math.pi / 2, "south": math.pi / 2}[side]
    along = math.pi / 2 if side in ("east", "west") else 0.0
    closed = along if hole.leaf.hinge_at_start else along + math.pi
    swing = 1.0 if math.sin(into - closed) > 0 else -1.0
    hinge = (lo + 0.002) if hole.leaf.hinge_at_start else (hi - 0.002)
    sign = 1.0 if side in ("east", "north") else -1.0
    at = hole.line_m - sign * (HALF_WALL_M + 0.004 + 0.02)
    x, y = (hinge, at) if side in ("north", "south") else (at, hinge)
    return PlacedItem(leaf, x, y, 0.0, closed + swing * hole.leaf.angle_rad)
