"""Places the objects of a ProcTHOR house: our furniture in the sizes of its assets, with the small objects on its tops.

Assets have their front along Unity's z. A rotation about y is clockwise seen from above, and Unity's z is our y: a
front at angle t is at the heading 90 degrees - t.

Walls have no thickness in the source and 12 cm here. An object that reaches into a wall is moved out of it, at right
angles.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from sim.core.errors import HouseError
from sim.homes.housegen.floor_plan.rectangles import SIDES, Rect, Side, footprint, outward
from sim.homes.housegen.furniture.item import Item, Surface
from sim.homes.housegen.furniture.reshape import fitted
from sim.homes.housegen.furniture.transforms import geom_bounds, matrix_from_euler
from sim.homes.housegen.mjcf.placed import PlacedItem
from sim.homes.housegen.structure.openings import HALF_WALL_M
from sim.homes.importers.fitting import Fitted, Fitter, Place
from sim.homes.importers.losses import Losses
from sim.homes.importers.procthor_files import Asset, SceneObject
from sim.homes.importers.procthor_plan import Layout
from sim.houses.proposals import category_of_name
from sim.houses.taxonomies import Entry, entries

ON_WALL_FROM_M = 0.3
"""Objects hang on a wall if their lower edge is higher above the floor and they are not in another object."""
WALL_REACH_M = 0.35
"""Largest distance from the back of such an object to its wall."""
MAX_INTO_WALL_M = 0.2
"""An object that reaches further into a wall is not moved out of it."""
SURFACE_REACH_M = 0.45
"""Largest difference in height from the place of an object in the source to a top of our furniture."""
GEOM_COST_M, MIN_REST = 0.03, 0.5
"""An object may also rest on a part of our furniture, at the place that it has in the source: one that is at least half
as large in plan. A top that is meant for objects is preferred unless it differs by at least `GEOM_COST_M` more."""
ARM_M = 0.61
"""Depth of the arms of L- and C-shaped counters: two feet, as the names of the assets say."""
CLOSED = frozenset(("Fridge", "Microwave", "Safe", "Cabinet", "Drawer", "GarbageCan", "Box"))
"""Types that hide their content."""
MAX_DEPTH = 20
"""Deepest nesting of objects in objects."""


@dataclass(frozen=True)
class Standing:
    """An object of the source as one of our items."""

    kind: str
    placed: PlacedItem
    footprint: Rect
    is_loose: bool
    """Whether the source lets it move, and it stands on the floor and holds nothing."""


@dataclass
class ObjectPlacer:
    """Places the objects of one house.

    Args:
        layout: rooms and openings.
        assets: types and sizes of assets.
        fitter: makes the items.
        losses: counts the objects that could not be shown.
        where: file and line, for messages.
    """

    layout: Layout
    assets: Mapping[str, Asset]
    fitter: Fitter
    losses: Losses
    where: str
    standing: list[Standing] = field(default_factory=list)

    def place(self, objects: Sequence[SceneObject]) -> None:
        """Places objects that stand on the floor or hang on walls, and the objects on them.

        Raises:
            HouseError: objects are nested too deeply.
        """
        for entity in objects:
            measured_m = self._size(entity)
            if measured_m is None:
                self._leave_out(entity.children, "what it is on was left out")
                continue
            kind, entry, size_m, yaw = measured_m
            if entry.category in ("door", "window"):
                self._count_left_out(kind, "part of a wall")
                continue
            bottom_m = max(entity.position.y - size_m[2] / 2, 0.0)
            hangs = bottom_m > ON_WALL_FROM_M
            parts = list(self._parts(entity, kind, entry, size_m, yaw, "wall" if hangs else "floor", bottom_m))
            loose = not (entity.kinematic or entity.children or hangs) and parts[0].item.mass_kg is not None
            self.standing += [Standing(kind, part, _footprint(part), loose) for part in parts]
            self._place_on(entity.children, kind, parts, depth=1)

    def _parts(
        self, entity: SceneObject, kind: str, entry: Entry, size_m: tuple[float, float, float], yaw: float,
        place: Place, bottom_m: float,
    ) -> Iterator[PlacedItem]:  # fmt: skip
        """Yields the items of an object that is not inside another one: one item, or several for counters with arms."""
        x, y = entity.position.x, entity.position.z
        arms = _arms(entity.assetId, size_m, lambda side: self._wall_gap(x, y, size_m, yaw, side))
        first = self.fitter.fit(entity.assetId, entry, arms[0][0], place)
        for number, (part_m, (along, across), turn) in enumerate(arms):
            fit = self.fitter.fit(entity.assetId, entry, part_m, place)
            if number and first.is_furniture:
                fit = Fitted(fitted(first.item, part_m), is_furniture=True)  # the arms look the same
            at = PlacedItem(fit.item, x, y, bottom_m, yaw)
            px, py = at.to_world(along, across)
            if fit.item.mount == "wall":
                part = self._on_wall(replace(at, x_m=px, y_m=py), part_m[0])
            else:
                part = self._out_of_walls(PlacedItem(fit.item, px, py, bottom_m, yaw + turn))
            self.losses.moved_m = max(self.losses.moved_m, math.hypot(part.x_m - px, part.y_m - py))
            if number == 0:
                (self.losses.furniture if fit.is_furniture else self.losses.boxes)[kind] += 1
            yield part

    def _place_on(
        self, objects: Sequence[SceneObject] | None, below: str, parents: Sequence[PlacedItem], depth: int
    ) -> None:
        """Places objects on the tops of the items of another object."""
        if depth > MAX_DEPTH:
            raise HouseError(f"{self.where}: objects are nested more than {MAX_DEPTH} deep.")
        if below in CLOSED and objects:
            self._leave_out(objects, f"inside {below}")
            return
        taken: list[tuple[float, Rect]] = []
        for entity in objects or ():
            measured_m = self._size(entity)
            if measured_m is None:
                self._leave_out(entity.children, "what it is on was left out")
                continue
            kind, entry, size_m, yaw = measured_m
            fit = self.fitter.fit(entity.assetId, entry, size_m, "top")
            at = PlacedItem(fit.item, entity.position.x, entity.position.z, entity.position.y - size_m[2] / 2, yaw)
            placed = _on_top(at, parents, taken)
            if placed is None:
                self._leave_out([entity], f"our {below} has no free top near its place")
                continue
            (self.losses.furniture if fit.is_furniture else self.losses.boxes)[kind] += 1
            self.losses.moved_m = max(self.losses.moved_m, math.hypot(placed.x_m - at.x_m, placed.y_m - at.y_m))
            taken.append((placed.z_m, _footprint(placed)))
            self.standing.append(Standing(kind, placed, _footprint(placed), is_loose=False))
            self._place_on(entity.children, kind, [placed], depth + 1)

    def _size(self, entity: SceneObject) -> tuple[str, Entry, tuple[float, float, float], float] | None:
        """Returns type, entry, size (depth, width, height) and heading of an object; None if its size is unknown."""
        asset = self.assets.get(entity.assetId)
        named = entity.id.partition("|")[0]
        kind = asset.kind if asset is not None else named if named in entries("ai2thor") else entity.assetId or named
        if asset is None:
            self._count_left_out(kind, "its asset is not in the database")
            return None
        entry = entries("ai2thor").get(kind)
        if entry is None:
            category = category_of_name(kind) or "objects"
            entry = Entry(category, "box", "ours")
            self.losses.changes[f"The type {kind} is not in the table; it became {category}."] += 1
        width, height, depth = asset.size_m
        turn = entity.rotation
        if max(_from_level(turn.x), _from_level(turn.z)) < 5.0:
            return kind, entry, (depth, width, height), math.radians(90.0 - turn.y)
        # An object that lies on its side gets the box around it, parallel to the axes.
        width, height, depth = np.abs(_rotation(turn.x, turn.y, turn.z)) @ np.array(asset.size_m)
        return kind, entry, (float(depth), float(width), float(height)), math.pi / 2

    def _leave_out(self, objects: Sequence[SceneObject] | None, reason: str) -> None:
        """Counts objects, and the objects on them, as left out."""
        todo = list(objects or ())
        while todo:
            entity = todo.pop()
            asset = self.assets.get(entity.assetId)
            self._count_left_out(asset.kind if asset else entity.id.partition("|")[0], reason)
            todo += entity.children or ()

    def _count_left_out(self, kind: str, reason: str) -> None:
        self.losses.left_out[f"{kind}: {reason}"] += 1

    def _wall_gap(self, x: float, y: float, size_m: tuple[float, float, float], yaw: float, side: float) -> float:
        """Returns the distance from the right (`side` = -1) or left side of a box to the next wall there."""
        c, s = -side * math.sin(yaw), side * math.cos(yaw)
        gaps = [_ray(rect, wall, x, y, c, s) for rect, wall in self._walls()]
        return min(gaps, default=math.inf) - size_m[1] / 2

    def _walls(self) -> Iterator[tuple[Rect, Side]]:
        """Yields each rectangle of the plan with each of its sides."""
        for room in self.layout.plan.rooms:
            for side in SIDES:
                yield room.rect, side

    def _on_wall(self, placed: PlacedItem, depth_m: float) -> PlacedItem:
        """Returns an item that is in the middle of its object, with its back on the surface of the wall behind it."""
        c, s = math.cos(placed.yaw_rad), math.sin(placed.yaw_rad)
        gap = min((_ray(rect, side, placed.x_m, placed.y_m, -c, -s) for rect, side in self._walls()), default=math.inf)
        if gap - depth_m / 2 > WALL_REACH_M:
            self.losses.changes["An object hangs on no wall; it hangs where the source has it."] += 1
            gap = depth_m / 2 + HALF_WALL_M
        reach = gap - HALF_WALL_M
        return replace(placed, x_m=placed.x_m - c * reach, y_m=placed.y_m - s * reach)

    def _out_of_walls(self, placed: PlacedItem) -> PlacedItem:
        """Returns an item that stands in no wall of the room in which its middle is."""
        for number, room in enumerate(self.layout.plan.rooms):
            if room.rect.distance_to(placed.x_m, placed.y_m) > 0.0:
                continue
            for side in SIDES:
                box = _footprint(placed)
                sign = outward(side)
                into_m = sign * (box.line(side) - room.rect.line(side)) + HALF_WALL_M
                if 0.0 < into_m <= MAX_INTO_WALL_M and not self._is_open(number, side, box):
                    dx, dy = (-sign * into_m, 0.0) if side in ("east", "west") else (0.0, -sign * into_m)
                    placed = replace(placed, x_m=placed.x_m + dx, y_m=placed.y_m + dy)
            break
        return placed

    def _is_open(self, room: int, side: Side, box: Rect) -> bool:
        """Returns whether a side of a rectangle has no wall where a box is."""
        lo, hi = box.span(side)
        return any(
            opening.kind == "open" and room in (opening.a, opening.b) and opening.side_of(room) == side
            and opening.span[0] <= lo + HALF_WALL_M and hi - HALF_WALL_M <= opening.span[1]
            for opening in self.layout.openings
        )  # fmt: skip


def _arms(
    asset: str, size_m: tuple[float, float, float], gap_m: Callable[[float], float]
) -> list[tuple[tuple[float, float, float], tuple[float, float], float]]:
    """Returns the parts of an object: size, offset of its middle (forward, left) and turn of its front.

    All but counters have one. An L has an arm along its back and one on the side that is nearer to a wall; a C has one
    on both sides.
    """
    depth, width, height = size_m
    kind = next((kind for kind in ("L", "C") if f"ountertop_{kind}_" in asset), "")
    if not kind or min(depth, width) < 1.5 * ARM_M:
        return [(size_m, (0.0, 0.0), 0.0)]
    back = ((ARM_M, width, height), ((ARM_M - depth) / 2, 0.0), 0.0)
    left, right = (gap_m(side) for side in (1.0, -1.0))
    sides = (1.0, -1.0) if kind == "C" else (1.0,) if left < right else (-1.0,)
    long_m = depth - ARM_M
    return [back] + [
        ((ARM_M, long_m, height), (ARM_M / 2, side * (width - ARM_M) / 2), -side * math.pi / 2) for side in sides
    ]


def _on_top(at: PlacedItem, parents: Sequence[PlacedItem], taken: Sequence[tuple[float, Rect]]) -> PlacedItem | None:
    """Returns an item on the top of one of the parents that is nearest to its place and has room; None without one."""
    options: list[tuple[float, PlacedItem]] = []
    for parent in parents:
        for surface, (ox, oy, oz), turn in _surfaces(parent.item):
            height = parent.z_m + oz + surface.centre_m[2]
            if abs(height - at.z_m) > SURFACE_REACH_M:
                continue
            moved = _clamped(at, parent, surface, (ox, oy), turn)
            cost = abs(height - at.z_m) + 2.0 * math.hypot(moved.x_m - at.x_m, moved.y_m - at.y_m)
            options.append((cost, replace(moved, z_m=height + 0.001)))
        for height in _heights_below(parent, at):
            if abs(height - at.z_m) <= SURFACE_REACH_M:
                options.append((abs(height - at.z_m) + GEOM_COST_M, replace(at, z_m=height + 0.001)))
    for cost, placed in sorted(options, key=lambda option: option[0]):
        box = _footprint(placed)
        free = not any(abs(z - placed.z_m) < 0.05 and other.overlaps(box, 0.01) for z, other in taken)
        if free and cost < 2.0 * SURFACE_REACH_M:
            return placed
    return None


def _heights_below(parent: PlacedItem, at: PlacedItem) -> Iterator[float]:
    """Yields the heights of the parts of an item on which another one could rest without being moved in plan."""
    c, s = math.cos(parent.yaw_rad), math.sin(parent.yaw_rad)
    dx, dy = at.x_m - parent.x_m, at.y_m - parent.y_m
    x, y = c * dx + s * dy, -s * dx + c * dy
    least_m2 = MIN_REST * at.item.size_m[0] * at.item.size_m[1]
    for geom in parent.item.geoms:
        (x0, y0, _), (x1, y1, z) = (corner.tolist() for corner in geom_bounds(geom))
        if x0 <= x <= x1 and y0 <= y <= y1 and (x1 - x0) * (y1 - y0) >= least_m2:
            yield parent.z_m + z


def _surfaces(item: Item) -> Iterator[tuple[Surface, tuple[float, float, float], float]]:
    """Yields the tops of an item and of its children, with the offset and the turn of each child."""
    for surface in item.surfaces:
        if surface.kind != "floor":
            yield surface, (0.0, 0.0, 0.0), 0.0
    for child in item.children:
        for surface in child.item.surfaces:
            yield surface, child.pos_m, child.yaw_rad


def _clamped(
    at: PlacedItem, parent: PlacedItem, surface: Surface, offset_m: tuple[float, float], turn: float
) -> PlacedItem:
    """Returns an item moved by as little as possible so that its middle is over a surface, with its edge if it fits."""
    c, s = math.cos(turn), math.sin(turn)
    cx, cy, _ = surface.centre_m
    middle = offset_m[0] + c * cx - s * cy, offset_m[1] + s * cx + c * cy
    x0, y0 = parent.to_world(*middle)
    yaw = parent.yaw_rad + turn
    box = footprint(0.0, 0.0, at.item.size_m[0], at.item.size_m[1], at.yaw_rad - yaw)
    c, s = math.cos(yaw), math.sin(yaw)
    dx, dy = at.x_m - x0, at.y_m - y0
    spare = [
        max(half - side / 2, 0.0) for half, side in zip(surface.half_size_m, (box.width_m, box.depth_m), strict=True)
    ]
    u = float(np.clip(c * dx + s * dy, -spare[0], spare[0]))
    v = float(np.clip(-s * dx + c * dy, -spare[1], spare[1]))
    return replace(at, x_m=x0 + c * u - s * v, y_m=y0 + s * u + c * v)


def _footprint(placed: PlacedItem) -> Rect:
    """Returns the rectangle around an item in plan."""
    depth, width, _ = placed.item.size_m
    x, y = placed.to_world(depth / 2, 0.0) if placed.item.mount == "wall" else (placed.x_m, placed.y_m)
    return footprint(x, y, depth, width, placed.yaw_rad)


def _ray(rect: Rect, side: Side, x: float, y: float, dx: float, dy: float) -> float:
    """Returns the distance from a point in a rectangle along a unit vector to the line of a side, else infinity."""
    if rect.distance_to(x, y) > 0.0:
        return math.inf
    towards = {"east": dx, "west": -dx, "north": dy, "south": -dy}[side]
    if towards < 0.7:
        return math.inf
    return abs(rect.line(side) - (x if side in ("east", "west") else y)) / towards


def _from_level(angle_deg: float) -> float:
    """Returns how far an angle is from a whole turn, in degrees."""
    return abs((angle_deg + 180.0) % 360.0 - 180.0)


def _rotation(x_deg: float, y_deg: float, z_deg: float) -> NDArray[np.float64]:
    """Returns Unity's rotation (3, 3): about z, then x, then y."""
    x, y, z = (math.radians(angle) for angle in (x_deg, y_deg, z_deg))
    return matrix_from_euler(0.0, y, 0.0) @ matrix_from_euler(x, 0.0, 0.0) @ matrix_from_euler(0.0, 0.0, z)
