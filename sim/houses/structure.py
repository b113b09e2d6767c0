"""Walls, floors, ceilings, doors and windows of a floor plan, as labelled items in world coordinates.

Each room builds its own half of a wall, so that it can have its own paint; a hole is cut out of both halves at the
same place. Outer walls reach `OUTER_WALL_M` further out. Wheels run on one invisible slab under the whole home, so
that they never cross a seam; the floors of the rooms are only seen.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sim.houses.floorplan import FloorPlan
from sim.houses.furniture.item import Geom, Item, Look
from sim.houses.geometry import EPS_M, SIDES, Interval, Rect, Side, subtract
from sim.houses.openings import HALF_WALL_M, JAMB_M, OUTER_WALL_M, Opening, outer_spans

BASEBOARD_M = (0.012, 0.08)
"""Thickness and height."""
CASING_M = (0.07, 0.014)
"""Width and thickness of the boards around a door."""
SLAB_M = 0.1
"""Thickness of floors."""
Box3 = tuple[float, float, float, float, float, float]
"""x0, x1, y0, y1, z0, z1."""


@dataclass(frozen=True)
class Finish:
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


def build_structure(plan: FloorPlan, openings: Sequence[Opening], ceiling_m: float, finish: Finish) -> list[Item]:
    """Everything that is part of the building; positions are the world's."""
    items = []
    rects = [room.rect for room in plan.rooms]
    for i, room in enumerate(plan.rooms):
        here = [opening for opening in openings if i in (opening.a, opening.b)]
        items += [_floor(room.rect, finish.floors[room.name]), _ceiling(room.rect, ceiling_m, finish.ceiling)]
        items += _room_walls(rects, i, here, ceiling_m, finish.walls[room.name], finish.trim)
    for opening in openings:
        if opening.kind == "window":
            items.append(_window(opening, finish))
        elif opening.kind in ("door", "entry"):
            items += _door(opening, finish)
    return items


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
        boards += _baseboards(rect, side, holes)
    if walls:
        walls[0] = _item("wall", "side", [*walls[0].geoms, *_seen_boxes(boards, trim)])
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
    """Boxes of one stretch of wall around its holes."""
    holes = [hole for hole in holes if hole.span[1] > span[0] + EPS_M and hole.span[0] < span[1] - EPS_M]
    boxes = [(piece, 0.0, ceiling_m) for piece in subtract(span, [hole.span for hole in holes])]
    for hole in holes:
        inside = max(hole.span[0], span[0]), min(hole.span[1], span[1])
        if hole.bottom_m > 0.0:
            boxes.append((inside, 0.0, hole.bottom_m))
        if hole.top_m < ceiling_m:
            boxes.append((inside, hole.top_m, ceiling_m))
    geoms = []
    for piece, z0, z1 in boxes:
        strip = rect.strip(side, piece, HALF_WALL_M, outward_m)
        geoms.append(oriented_box((strip.x0, strip.x1, strip.y0, strip.y1, z0, z1), paint, side))
    return geoms


def _baseboards(rect: Rect, side: Side, holes: Sequence[Opening]) -> list[Box3]:
    """Boards along a side, between the door frames."""
    thick, high = BASEBOARD_M
    lo, hi = rect.span(side)
    inner = rect.grown(-HALF_WALL_M)
    gaps = []
    for hole in holes:
        if hole.bottom_m == 0.0:
            margin = CASING_M[0] - JAMB_M if hole.kind in ("door", "entry") else 0.0
            gaps.append((hole.span[0] - margin, hole.span[1] + margin))
    boxes = []
    for piece in subtract((lo + HALF_WALL_M, hi - HALF_WALL_M), gaps, 0.03):
        strip = inner.strip(side, piece, thick)
        boxes.append((strip.x0, strip.x1, strip.y0, strip.y1, 0.0, high))
    return boxes


def _across(side: Side, line: float, along: Interval, out_from: float, out_to: float, z0: float, z1: float) -> Box3:
    """A box in a wall: `along` it, from `out_from` to `out_to` metres outward of its middle, between two heights."""
    sign = 1.0 if side in ("east", "north") else -1.0
    a, b = sorted((line + sign * out_from, line + sign * out_to))
    return (a, b, *along, z0, z1) if side in ("east", "west") else (*along, a, b, z0, z1)


def _window(hole: Opening, finish: Finish) -> Item:
    """Frame with a cross, a sill, and daylight behind it."""
    (lo, hi), z0, z1, side, line = hole.span, hole.bottom_m, hole.top_m, hole.side, hole.line_m
    bar, out = 0.05, OUTER_WALL_M - 0.02
    middle = 0.5 * (lo + hi)
    bars = [((lo, lo + bar), z0, z1), ((hi - bar, hi), z0, z1), ((lo, hi), z0, z0 + bar), ((lo, hi), z1 - bar, z1)]
    if hi - lo > 0.85:
        bars.append(((middle - 0.025, middle + 0.025), z0, z1))
    if z1 - z0 > 1.3:
        bars.append(((lo, hi), z0 + 0.66 * (z1 - z0), z0 + 0.66 * (z1 - z0) + 0.04))
    frame = [_across(side, line, span, out - 0.06, out, b, t) for span, b, t in bars]
    frame.append(_across(side, line, (lo - 0.04, hi + 0.04), -HALF_WALL_M - 0.03, out, z0 - 0.025, z0))
    pane = _across(side, line, (lo, hi), out - 0.02, OUTER_WALL_M, z0, z1)
    return _item("window", "pane", [oriented_box(pane, finish.sky, side), *_seen_boxes(frame, finish.trim)])


def _door(hole: Opening, finish: Finish) -> list[Item]:
    """Frame and, where it has one, leaf: two items, both labelled door."""
    (lo, hi), top, side, line = hole.span, hole.top_m, hole.side, hole.line_m
    inner, outer = -HALF_WALL_M - 0.004, HALF_WALL_M + 0.004 if hole.kind == "door" else OUTER_WALL_M
    jambs = [_across(side, line, span, inner, outer, 0.0, top) for span in ((lo, lo + JAMB_M), (hi - JAMB_M, hi))]
    boards = [_across(side, line, (lo + JAMB_M, hi - JAMB_M), inner, outer, top - JAMB_M, top)]
    wide, thick = CASING_M
    for face in (-1.0, 1.0) if hole.kind == "door" else (-1.0,):
        near, far = sorted((face * HALF_WALL_M, face * (HALF_WALL_M + thick)))
        for a, b in ((lo + JAMB_M - wide, lo + JAMB_M - 0.008), (hi - JAMB_M + 0.008, hi - JAMB_M + wide)):
            boards.append(_across(side, line, (a, b), near, far, 0.0, top - JAMB_M + wide))
        boards.append(
            _across(
                side,
                line,
                (lo + JAMB_M - 0.008, hi - JAMB_M + 0.008),
                near,
                far,
                top - JAMB_M + 0.008,
                top - JAMB_M + wide,
            )
        )
    geoms = [oriented_box(box, finish.door_frame) for box in jambs]
    items = [_item("door", "frame", [*geoms, *_seen_boxes(boards, finish.door_frame)])]
    if hole.kind == "entry":
        items.append(_closed_leaf(hole, finish))
    elif hole.leaf is not None:
        items.append(_ajar_leaf(hole, finish))
    return items


def _leaf_geoms(width_m: float, high_m: float, finish: Finish, gap_m: float = 0.01) -> list[Geom]:
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


def _closed_leaf(hole: Opening, finish: Finish) -> Item:
    lo, hi = hole.clear_span()
    leaf = _item("door", "leaf", _leaf_geoms(hi - lo, hole.top_m - JAMB_M, finish, 0.0))
    yaw = 0.0 if hole.side in ("north", "south") else math.pi / 2
    at = hole.line_m  # where the floor ends: nothing is seen below it
    x, y = (lo, at) if hole.side in ("north", "south") else (at, lo)
    return turned_item(leaf, x, y, yaw)


def _ajar_leaf(hole: Opening, finish: Finish) -> Item:
    """The leaf of an inner door, turned about its hinge into the room it opens to."""
    assert hole.leaf is not None
    lo, hi = hole.clear_span()
    leaf = _item("door", "leaf", _leaf_geoms(hi - lo - 0.004, hole.top_m - JAMB_M - 0.006, finish))
    side = hole.side_of(hole.leaf.room)
    into = {"east": math.pi, "west": 0.0, "north": -math.pi / 2, "south": math.pi / 2}[side]
    along = math.pi / 2 if side in ("east", "west") else 0.0
    closed = along if hole.leaf.hinge_at_start else along + math.pi
    swing = 1.0 if math.sin(into - closed) > 0 else -1.0
    hinge = (lo + 0.002) if hole.leaf.hinge_at_start else (hi - 0.002)
    sign = 1.0 if side in ("east", "north") else -1.0
    at = hole.line_m - sign * (HALF_WALL_M + 0.004 + 0.02)
    x, y = (hinge, at) if side in ("north", "south") else (at, hinge)
    return turned_item(leaf, x, y, closed + swing * hole.leaf.angle_rad)


def turned_item(item: Item, x_m: float, y_m: float, yaw_rad: float) -> Item:
    """The item with its geoms turned about z and moved; only for geoms without a pitch of their own."""
    c, s = math.cos(yaw_rad), math.sin(yaw_rad)
    geoms = []
    for geom in item.geoms:
        px, py, pz = geom.pos_m
        at = (round(x_m + c * px - s * py, 4), round(y_m + s * px + c * py, 4), pz)
        geoms.append(
            Geom(geom.shape, geom.size_m, at, geom.look, _turned_euler(geom.euler_rad, yaw_rad), geom.solid, geom.mesh)
        )
    return Item(item.category, item.style, item.size_m, tuple(geoms))


def _turned_euler(euler_rad: tuple[float, float, float], yaw_rad: float) -> tuple[float, float, float]:
    """Intrinsic x-y-z angles after a turn about the world's z.

    After a quarter turn about x the local y axis is the world's z, so the turn is about y.
    """
    if euler_rad == (0.0, 0.0, 0.0):
        return 0.0, 0.0, yaw_rad
    if abs(euler_rad[0] - math.pi / 2) < EPS_M:
        return euler_rad[0], euler_rad[1] + yaw_rad, euler_rad[2]
    raise ValueError(f"Only level geoms and quarter turns about x can be turned, got {euler_rad} rad.")
