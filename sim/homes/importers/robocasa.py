"""Reads kitchens of RoboCasa (https://github.com/robocasa/robocasa), and other kitchens in MJCF.

A kitchen is one MJCF file, as the environment saves it: often with a robot in it, and with absolute paths. Each fixture
is a body `<fixture>_<group>_main` (`cab_1_main_group_main`, `wall_room_main`) that holds all its parts. The name of the
fixture gives the category by the table of `sim.houses.taxonomies`; other names by their words, as `stubborn label`
does. Visible geoms are in group 1 and have no contact; those that collide are in group 0 or 3. Many kitchens have walls
on two sides: where a floor ends without one, a plain wall is added, so that no robot drives over the edge.
"""

from __future__ import annotations

import functools
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sim.core.errors import ConfigError, HouseError
from sim.core.interface import MPCAT40_ID
from sim.gl import mujoco
from sim.homes.housegen.floor_plan.rectangles import OPPOSITE, Rect, Side, outward, subtract
from sim.homes.importers.scenes import Scene, add_room, box_of
from sim.houses.foreign import remove_unsupported
from sim.houses.geoms import data_at_rest
from sim.houses.labels import (
    RENDERED_GROUPS,
    VOID,
    Labels,
    collidable_geoms,
    names_of_geom,
    opacity,
    read_labels,
    rendered_geoms,
)
from sim.houses.load import compiled
from sim.houses.mjcf import read_spec, require_sizes
from sim.houses.packing import gather_files, text_of
from sim.houses.proposals import category_of_name, propose, rules_of
from sim.houses.taxonomies import entries

MAX_HOUSES = 10_000
ROBOT = re.compile(r"(?:robot|gripper|mobilebase|fixed_mount|mount|leg)\d+_.*|panda\d*_link0")
"""Names of the outermost bodies of robosuite's robots and of the Franka robot."""
PLACED = ("obj", "distr_")
"""Beginnings of the names of the objects that a task of RoboCasa places: `distr_counter` is on a counter."""
SPECK_M = 0.011
"""Half sides of the invisible boxes, high above the kitchen, in place of parts that a fixture does not have."""
ROOM_M2 = 1.0
"""Smaller floors do not count as rooms."""
NEAR_EDGE_M = 0.5
"""A wall closes the side of a floor if it is at most this far inside of it."""
CLOSED_SHARE = 0.5
"""Share of a side that its wall covers at least; the room ends at this wall."""
GAP_M = 0.1
"""A side gets a wall if its walls leave more than this open."""
SEEN_SHARE = 0.5
"""Least share of the box around the collision geoms of a body that the box around its visible geoms fills."""
UNSEEN_M = 0.1
"""Collision geoms whose box is thinner stay invisible."""
UNSEEN_RGBA = (0.62, 0.62, 0.64, 1.0)
"""Colour of collision geoms that are shown."""
ADDED_WALL_M = 0.1
"""Thickness of walls that are added."""
ADDED = "wall_added_"
"""Beginning of their names."""
WALL_RGBA = (0.86, 0.85, 0.82, 1.0)
WALL_M = 3.0
"""Height of rooms without walls."""
_SIDES: tuple[Side, ...] = ("west", "east", "south", "north")
"""The order in which walls are added."""
_GROUP = re.compile(r"_[a-z]+_group(?:_\w+)?$|_room$")
_POSITIONS = ("bottom", "middle", "top")
"""Names of the parts of a stack of cabinets, which are words of other names."""


@dataclass(frozen=True)
class _Room:
    """A floor up to its walls, and the sides of the whole floor that no wall closes."""

    rect: Rect
    floor: Rect
    open_sides: tuple[Side, ...]


def find_scenes(path: Path) -> list[Path]:
    """Returns the MJCF files of a folder, or the one file that is given, sorted.

    Raises:
        ConfigError: the folder has no houses.
    """
    files = [path] if path.suffix == ".xml" else sorted(path.glob("*.xml"))[:MAX_HOUSES]
    if not files:
        raise ConfigError(f"'{path}' has no MJCF file (.xml).")
    return files


def import_kitchen(file: Path, *, root: Path | None = None, texture_px: int | None = None) -> Scene:
    """Returns a kitchen for a split, its label rules and its report.

    Args:
        file: the MJCF file.
        root: another folder that the house may use.
        texture_px: longest side of the textures; larger ones are reduced.

    Raises:
        HouseError: the kitchen is missing or broken; the message names the file.
    """
    changes = Counter[str]()
    try:
        if not file.is_file():
            raise HouseError("the file does not exist.")
        spec = read_spec(file, root=root, texture_px=texture_px)
        _remove_robots(spec, changes)
        changes.update(remove_unsupported(spec))
        _remove_unused_textures(spec, changes)
        files = gather_files(spec, file.resolve().parent, texture_px=texture_px)
        reduced = sum(entry.source is None for entry in files.values())
        if reduced:
            changes[f"A texture was reduced to {texture_px} pixels."] += reduced
        _hide_collision_geoms(spec, compiled(spec), changes)
        _show_unseen_bodies(spec, compiled(spec), changes)
        model = compiled(spec)
        require_sizes(model)
        rules = _rules(model)
        labels = read_labels(model, rules=rules, ignore_prefix="")
        if labels.void_geoms:
            changes["A visible geom has no category; it is an obstacle."] += labels.void_geoms
        rooms, height_m = _add_rooms(spec, model, labels)
        for side in _close(spec, rooms, height_m):
            changes[f"The floor had an edge without a wall on its {side} side; a plain wall was added."] += 1
            rules[f"^{ADDED}"] = "wall"
        text = text_of(spec)
    except HouseError as error:
        raise HouseError(f"Kitchen '{file}': {error}") from None
    counts = Counter(instance.category for instance in labels.instances)
    report = {
        "house": file.stem, "source": str(file), "rooms": len(rooms),
        "area_m2": round(sum(room.rect.area_m2 for room in rooms), 2), "geoms": model.ngeom,
        "texture_mb": round(model.ntexdata / 1e6, 1), "furniture": dict(counts.most_common()), "boxes": {},
        "left_out": {}, "changes": dict(changes), "moved_m": 0.0,
    }  # fmt: skip
    return Scene(file.stem, text, files, rules, report)


@functools.cache
def category_of_fixture(body: str) -> str | None:
    """Returns the category that the name of a fixture's body says, or None.

    RoboCasa's names end with the kind of the fixture or begin with it (`hingecabinet_2`, `cab_micro`); at the end, it
    counts first (`microwave_housing` is a cabinet). Other names count by their words.
    """
    name = _GROUP.sub("", body.lower().removesuffix("_main"))
    bare = re.sub(r"[^a-z]", "", name)
    table = {re.sub(r"[^a-z]", "", kind): entry.category for kind, entry in entries("robocasa").items()}
    if bare in table:
        return table[bare]
    kinds = sorted((kind for kind in table if kind not in _POSITIONS), key=len, reverse=True)
    ends = next((kind for kind in kinds if bare.endswith(kind)), None)
    begins = next((kind for kind in kinds if bare.startswith(kind)), None)
    kind = ends or begins
    return category_of_name(name) if kind is None else table[kind]


def _remove_robots(spec: mujoco.MjSpec, changes: Counter[str]) -> None:
    """Removes robots: bodies with actuators, or with the names of robots, and all that moves with them."""
    driven = {actuator.target for actuator in spec.actuators if actuator.trntype == mujoco.mjtTrn.mjTRN_JOINT}
    moved = [joint.parent for joint in spec.joints if joint.name in driven]
    named = [body for body in spec.bodies if ROBOT.fullmatch(body.name)]
    roots = {root.name: root for root in (_outermost(body) for body in (*named, *moved)) if root is not None}
    for name in sorted(roots):
        body = spec.body(name)
        if body is None:
            continue  # it was in another one
        parts = 1 + len(body.find_all("body"))
        spec.delete(body)
        changes[f"The robot '{name}' was removed ({parts} bodies)."] += 1
    existing = {body.name for body in spec.bodies}
    for light in spec.lights:
        if light.targetbody and light.targetbody not in existing:
            light.targetbody, light.mode = "", mujoco.mjtCamLight.mjCAMLIGHT_FIXED


def _outermost(body: mujoco.MjsBody) -> mujoco.MjsBody | None:
    """Returns the outermost body around a part of a robot that holds no fixture; None for a fixture with a motor."""
    if not ROBOT.fullmatch(body.name) and category_of_fixture(body.name) is not None:
        return None
    while body.parent is not None and body.parent.name != "world":
        others = [body_inside for body_inside in body.parent.find_all("body") if not ROBOT.fullmatch(body_inside.name)]
        if any(category_of_fixture(fixture.name) is not None for fixture in (body.parent, *others)):
            break
        body = body.parent
    return body


def _remove_unused_textures(spec: mujoco.MjSpec, changes: Counter[str]) -> None:
    """Removes textures and meshes that no geom shows."""
    shown = {element.material for element in (*spec.geoms, *spec.sites)}
    for material in list(spec.materials):
        if material.name not in shown:
            spec.delete(material)
    used = {name for material in spec.materials for name in material.textures}
    meshes = {geom.meshname for geom in spec.geoms}
    unused = [asset for asset in spec.textures if asset.name not in used]
    unused += [asset for asset in spec.meshes if asset.name not in meshes]
    for asset in unused:
        spec.delete(asset)
    if unused:
        changes["A texture or mesh that nothing uses was removed."] += len(unused)


def _hide_collision_geoms(spec: mujoco.MjSpec, model: mujoco.MjModel, changes: Counter[str]) -> None:
    """Moves collision geoms of group 0 to group 3 where their body has visible geoms; removes invisible specks."""
    collides, visible = collidable_geoms(model), rendered_geoms(model)
    shown = {int(model.geom_bodyid[geom]) for geom in np.flatnonzero(visible & ~collides).tolist()}
    clear, specks = opacity(model) == 0.0, []
    for geom in spec.geoms:
        index = geom.id
        plane = model.geom_type[index] == mujoco.mjtGeom.mjGEOM_PLANE
        if clear[index] and not plane and model.geom_size[index].max() <= SPECK_M:
            specks.append(geom)
        elif model.geom_group[index] == 0 and collides[index] and int(model.geom_bodyid[index]) in shown:
            geom.group = RENDERED_GROUPS
    for geom in specks:
        spec.delete(geom)
    if specks:
        changes["An invisible box of 2 cm or less was removed."] += len(specks)


def _show_unseen_bodies(spec: mujoco.MjSpec, model: mujoco.MjModel, changes: Counter[str]) -> None:
    """Shows the collision geoms of bodies whose visible geoms fill only a small part of them.

    A file may hold a placeholder for a mesh: of a stove remain its window and its knobs, which float in the air.
    """
    data = data_at_rest(model)
    collides, visible = collidable_geoms(model), rendered_geoms(model)
    all_geoms = list(spec.geoms)  # each access to `spec.geoms` goes through all of them
    unseen_geoms, ends = collides & ~visible, _subtree_ends(model.body_parentid.tolist())
    for body in range(1, model.nbody):
        unseen = _geoms_of(model, unseen_geoms, body, body + 1)
        seen = _geoms_of(model, visible, body, ends[body])
        if not (unseen.size and seen.size):
            continue
        (low, high), (seen_low, seen_high) = (_bounds(model, data, body, geoms) for geoms in (unseen, seen))
        common = np.maximum(np.minimum(high, seen_high) - np.maximum(low, seen_low), 0.0)
        if common.prod() < SEEN_SHARE * (high - low).prod() and (high - low).min() > UNSEEN_M:
            for geom in (all_geoms[index] for index in unseen.tolist()):
                geom.group, geom.material, geom.rgba = 0, "", UNSEEN_RGBA
            changes[f"The visible geoms fill little of '{model.body(body).name}'; its collision geoms are shown."] += 1


def _geoms_of(model: mujoco.MjModel, shown: NDArray[np.bool_], begin: int, end: int) -> NDArray[np.intp]:
    """Returns the numbers of the geoms of bodies begin to end - 1 that a mask (ngeom,) shows."""
    first, last = np.searchsorted(model.geom_bodyid, (begin, end))  # geoms are in the order of their bodies
    return first + np.flatnonzero(shown[first:last])


def _subtree_ends(parents: Sequence[int]) -> list[int]:
    """Returns for each body the number after that of the last body inside of it.

    MuJoCo numbers bodies depth first, so that the bodies inside of a body follow it without a gap.

    Args:
        parents: number of the body around each body; body 0 is the world.
    """
    ends = list(range(1, len(parents) + 1))
    for body in range(len(parents) - 1, 0, -1):
        ends[parents[body]] = max(ends[parents[body]], ends[body])
    return ends


def _bounds(
    model: mujoco.MjModel, data: mujoco.MjData, body: int, geoms: NDArray[np.intp]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Returns the lowest and the highest corner (3,) of geoms, in metres in the frame of a body."""
    turn = data.geom_xmat[geoms].reshape(-1, 3, 3)
    centres = data.geom_xpos[geoms] + np.einsum("gij,gj->gi", turn, model.geom_aabb[geoms, :3])
    of_body = data.xmat[body].reshape(3, 3)
    centres = (centres - data.xpos[body]) @ of_body
    halves = np.einsum("gij,gj->gi", np.abs(of_body.T @ turn), model.geom_aabb[geoms, 3:])
    return (centres - halves).min(axis=0), (centres + halves).max(axis=0)


def _rules(model: mujoco.MjModel) -> dict[str, str]:
    """Returns label rules: one for each fixture, then those of other visible objects by their words or sizes."""
    fixtures: dict[str, str] = {}
    filled = _filled_bodies(model)
    for body in range(1, model.nbody):
        name = model.body(body).name
        around = _names_around(model, body)
        if not name or any(name_around in fixtures for name_around in around):
            continue
        movable = model.body_dofnum[body] == 6 and int(model.body_parentid[body]) == 0
        category = category_of_fixture(name) if body in filled else None
        if movable and (category is None or name.startswith(PLACED)):
            category = "objects"
        if category is not None and not _holds_fixtures(model, body, category):
            fixtures[name] = category
    rules = {_any_number(name): category for name, category in fixtures.items()}
    labels = read_labels(model, rules=rules, ignore_prefix="")
    free = np.flatnonzero(rendered_geoms(model) & (labels.geom_category == 0)).tolist()
    names = {name for geom in free for name in names_of_geom(model, geom)}
    others = tuple(proposal for proposal in propose(model) if proposal.name in names and proposal.category != VOID)
    return {**rules, **{rule: category for rule, category in rules_of(others).items() if rule not in rules}}


def _names_around(model: mujoco.MjModel, body: int) -> Iterator[str]:
    """Yields the names of the bodies that a body is in."""
    while (body := int(model.body_parentid[body])) != 0:
        yield model.body(body).name


def _filled_bodies(model: mujoco.MjModel) -> set[int]:
    """Returns the bodies that have a geom, in themselves or in a body inside of them."""
    filled = set(model.geom_bodyid.tolist())
    for body in range(model.nbody - 1, 0, -1):  # a body has a higher number than the one around it
        if body in filled:
            filled.add(int(model.body_parentid[body]))
    return filled


def _holds_fixtures(model: mujoco.MjModel, body: int, category: str) -> bool:
    """Returns whether a body without geoms holds fixtures of another category, as that of a whole kitchen does."""
    if (model.geom_bodyid == body).any():
        return False
    inner = (child for child in range(body + 1, model.nbody) if model.body_parentid[child] == body)
    return any(
        category_of_fixture(model.body(child).name) not in (None, category, "door", "shelving") for child in inner
    )


def _any_number(name: str) -> str:
    """Returns a regular expression for a name with any numbers in it."""
    return "^" + r"\d+".join(re.escape(part) for part in re.split(r"\d+", name)) + "$"


def _add_rooms(spec: mujoco.MjSpec, model: mujoco.MjModel, labels: Labels) -> tuple[list[_Room], float]:
    """Adds a site for each floor, up to its walls; returns the rooms and their height in metres."""
    data = data_at_rest(model)
    solid = collidable_geoms(model)
    floors = [int(geom) for geom in np.flatnonzero((labels.geom_category == MPCAT40_ID["floor"]) & solid)]
    walls = [int(geom) for geom in np.flatnonzero((labels.geom_category == MPCAT40_ID["wall"]) & solid)]
    boxes = [box_of(model, data, geom) for geom in walls]
    top_m = max(1.0, max((float(data.geom_xpos[geom, 2]) * 2.0 for geom in walls), default=WALL_M))
    rooms: list[_Room] = []
    for geom in floors:
        if abs(data.geom_xpos[geom, 2]) > 1.0:
            continue
        room = _room(box_of(model, data, geom), boxes)
        if room.rect.area_m2 >= ROOM_M2 and not any(room.rect.overlaps(other.rect) for other in rooms):
            add_room(spec, f"room_kitchen_{len(rooms):02d}", room.rect, top_m)
            rooms.append(room)
    return rooms, top_m


def _close(spec: mujoco.MjSpec, rooms: list[_Room], height_m: float) -> list[str]:
    """Adds walls outside of open sides, except where another floor goes on; returns the sides."""
    sides = []
    for room in rooms:
        for side in room.open_sides:
            wall = room.floor.strip(side, room.floor.grown(ADDED_WALL_M).span(side), 0.0, ADDED_WALL_M)
            if any(wall.overlaps(other.floor) for other in rooms if other is not room):
                continue
            spec.worldbody.add_geom(
                name=f"{ADDED}{len(sides)}", type=mujoco.mjtGeom.mjGEOM_BOX, rgba=WALL_RGBA,
                pos=[*wall.centre, height_m / 2], size=[wall.width_m / 2, wall.depth_m / 2, height_m / 2],
            )  # fmt: skip
            sides.append(side)
    return sides


def _room(floor: Rect, walls: list[Rect]) -> _Room:
    """Returns a floor; each side is moved to the inner face of a wall that covers most of it."""
    closed: dict[Side, float] = {}
    open_sides: list[Side] = []
    for side in _SIDES:
        lo, hi = floor.span(side)
        faces, spans = [], []
        for wall in walls:
            (a, b), face = wall.span(side), wall.line(OPPOSITE[side])
            beside = min(b, hi) > max(a, lo)
            if beside and abs(face - floor.line(side)) < NEAR_EDGE_M and b - a > wall.short_m:
                faces.append(face)
                spans.append((max(a, lo), min(b, hi)))
        if faces and max(b - a for a, b in spans) >= CLOSED_SHARE * (hi - lo):
            closed[side] = (min if outward(side) > 0 else max)(faces)
        if subtract((lo, hi), spans, GAP_M):
            open_sides.append(side)
    west, east = max(floor.x0, closed.get("west", floor.x0)), min(floor.x1, closed.get("east", floor.x1))
    south, north = max(floor.y0, closed.get("south", floor.y0)), min(floor.y1, closed.get("north", floor.y1))
    inner = floor if west >= east or south >= north else Rect(west, south, east, north)
    return _Room(inner, floor, tuple(open_sides))
