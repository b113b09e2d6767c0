"""Pictures of a house: from above without its ceilings, and what the robot sees in it."""

from __future__ import annotations

import colorsys
import itertools
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.app.viewers.palette import PALETTE
from sim.app.viewers.text import BOLD, text_width, write
from sim.core.geometry.pose import Pose
from sim.core.interface import GOAL_CATEGORIES, MPCAT40_ID, CameraModel
from sim.core.pictures import tiled
from sim.gl import mujoco
from sim.houses.geoms import data_at_rest
from sim.houses.house import House, Room, read_rooms
from sim.houses.labels import VOID, Instance, Labels, read_labels, rendered_geoms
from sim.houses.proposals import box_around, void_objects
from sim.renderer.camera import Camera
from sim.world.freespace import FreeSpace

Picture = NDArray[np.uint8]
ViewPose = tuple[float, float, float, float]
"""x, y, height of the floor (metres) and yaw (degrees)."""
VIEWS_CAMERA = CameraModel()
"""Camera of the views of a house: that of the robot."""
TITLE_PX = 44
"""Height of the strip with a title."""
TOP_PX = (1400, 1100)
TOP_FOVY_DEG = 12.0
"""Field of view from above: small, so that walls hide little of the furniture that stands at them."""
TOP_AMBIENT = 0.4
"""Least ambient light from above: the walls of a house without any are not black."""
NAME_SHARE = 0.02
"""Height of a line of names from above, as a share of the picture's height."""
MAX_MOVES = 12
"""Most lines by which a name is moved so that it covers no other name."""
EXTENT_M = 10.0
"""Unit of the near and far plane in a model."""
NEAR_FAR_M = (0.05, 200.0)
"""Near and far plane of the pictures at the height of the robot's camera."""
STOREY_GAP_M = 0.3
"""Height below an upper floor from which everything belongs to the upper storey: its slabs, the edges of its well."""
BACKDROP = (0.86, 0.90, 0.95)
"""Colour of the background."""
FAN_DEG = np.arange(0, 360, 10)
"""Directions of the rays that measure how far a view reaches."""
MAX_VIEWS = 9
"""Most views of a house without rooms."""
MAX_PLACES = 400
"""Free places; one of them is chosen for such a view."""
NEAREST_LOOK_M = 1.0
LOOK_SIZES = 1.2
"""The best distance from the middle of an object: this many times its size, and `NEAREST_LOOK_M` more."""
HIDDEN_GROUP = 3
QUADS = 28
"""Number of squares along an edge of a flat geom, at whose corners light is computed. If there are few, lamps
cause diamond shapes on floors."""
CEILING_M = 2.5
"""Height of a storey without rooms."""
_STRUCTURE = tuple(MPCAT40_ID[name] for name in ("void", "wall", "floor", "ceiling", "door", "window"))


class TopPicture(NamedTuple):
    """A house from above: +x is to the right, +y up."""

    picture: Picture
    middle_m: tuple[float, float]
    """The place of the ground storey's floor in the middle of the picture."""
    m_per_px: float
    """Metres of that floor per pixel."""


def draw_top(house: House, *, colours: NDArray[np.uint8] | None = None) -> Picture:
    """Renders a house from above, without ceilings and ceiling lamps, (h, w, 3) RGB.

    Args:
        house: it is not changed.
        colours: uint8 (41, 3), a colour for each mpcat40 id in place of the materials; the instances are then named.
    """
    return draw_top_to_scale(house, colours=colours).picture


def draw_top_to_scale(house: House, *, colours: NDArray[np.uint8] | None = None) -> TopPicture:
    """Returns the picture of `draw_top` with its scale."""
    open_top = house.spec.copy()
    floors_m = {room.floor_z_m for room in read_rooms(house.spec.compile())}
    add_backdrop(open_top)
    for body in list(open_top.worldbody.bodies) if house.rules is None else ():
        height_m = body.pos[2] - max((floor_m for floor_m in floors_m if floor_m <= body.pos[2]), default=0.0)
        if body.name.startswith("ceiling_") or (body.name.startswith("lighting_") and height_m > 1.8):
            open_top.delete(body)
    model = open_top.compile()
    labels = read_labels(model, rules=house.rules, ignore_prefix="")
    model.geom_group[labels.geom_category == MPCAT40_ID["ceiling"]] = HIDDEN_GROUP
    low, high = _extent(model, labels)
    width, height = TOP_PX
    camera = camera_at((low + high) / 2, azimuth_deg=90.0, elevation_deg=-89.9)
    reach = max((high[1] - low[1] + 1.0) / 2, (high[0] - low[0] + 1.0) / 2 * height / width)
    camera.distance = reach / math.tan(math.radians(TOP_FOVY_DEG / 2)) + (high[2] - low[2]) / 2
    view = {"fovy_deg": TOP_FOVY_DEG, "near_far_m": (0.5 * camera.distance, 2.0 * camera.distance)}
    above_m = camera.distance * math.sin(math.radians(89.9)) + float(camera.lookat[2])  # the eye above z = 0
    m_per_px = 2.0 * above_m * math.tan(math.radians(TOP_FOVY_DEG / 2)) / height
    middle_m = (float(camera.lookat[0]), float(camera.lookat[1]))
    light = model.vis.headlight
    if colours is None:
        light.ambient, light.specular = np.maximum(light.ambient, TOP_AMBIENT), np.zeros(3)
        return TopPicture(render(model, camera, TOP_PX, **view), middle_m, m_per_px)
    objects = void_objects(model, labels)
    model.geom_matid[:] = -1
    model.geom_rgba[:, :3] = colours[labels.geom_category] / 255.0
    model.geom_rgba[:, 3] = np.where(rendered_geoms(model), 1.0, 0.0)
    model.light_active[:] = False
    light.ambient, light.diffuse, light.specular = np.ones(3), np.zeros(3), np.zeros(3)  # unlit: plain colours
    picture = np.ascontiguousarray(render(model, camera, TOP_PX, **view))
    named = [
        (f"{instance.name}: {instance.category}", instance.geom_ids)
        for instance in labels.instances
        if MPCAT40_ID[instance.category] not in _STRUCTURE
    ]
    named += [(f"{name}: {VOID}", tuple(geoms)) for name, geoms in objects.items()]
    _write_names(picture, model, named, np.array(camera.lookat), float(camera.distance))
    return TopPicture(picture, middle_m, m_per_px)


def distinct_colours(categories: Sequence[str]) -> NDArray[np.uint8]:
    """Returns uint8 (41, 3): colours that are far from each other for these categories; structure is grey.

    `PALETTE` gives a category the same colour in every picture, so that some of its 41 colours are similar.
    """
    colours = PALETTE.copy()
    furniture = [name for name in categories if MPCAT40_ID[name] not in _STRUCTURE]
    for number, name in enumerate(furniture):
        saturation, value = ((0.65, 1.0), (0.9, 0.75))[number % 2]
        rgb = colorsys.hsv_to_rgb(number / len(furniture), saturation, value)
        colours[MPCAT40_ID[name]] = np.rint(255.0 * np.array(rgb))
    return colours


def _write_names(
    picture: Picture,
    model: mujoco.MjModel,
    named: Iterable[tuple[str, Sequence[int]]],
    lookat: NDArray[np.float64],
    distance_m: float,
) -> None:
    """Writes texts onto a picture from above: on their geoms, below small ones, lower where another text is already."""
    data = data_at_rest(model)
    height, width = picture.shape[:2]
    focal_px = 0.5 * height / math.tan(math.radians(TOP_FOVY_DEG / 2))
    line_px = max(8, round(NAME_SHARE * height))
    taken: list[tuple[int, int, int]] = []  # left, right, base line
    for text, geoms in named:
        low, high = box_around(model, data, geoms)
        x, y, z = (low + high) / 2
        scale = focal_px / (lookat[2] + distance_m - z)
        wide = text_width(text, line_px, BOLD)
        left = int(np.clip(round(width / 2 + (x - lookat[0]) * scale - wide / 2), 2, max(2, width - wide - 2)))
        half_px = round((high[1] - low[1]) / 2 * scale)
        below_px = line_px // 3 if half_px > line_px else half_px + line_px
        middle = round(height / 2 - (y - lookat[1]) * scale) + below_px
        free = (
            base
            for base in range(middle, middle + MAX_MOVES * line_px, line_px)
            if not _covers(taken, left, left + wide, base, line_px)
        )
        base = next(free, middle)
        taken.append((left, left + wide, base))
        _outlined(picture, text, (left, base), line_px)


def _covers(taken: Iterable[tuple[int, int, int]], left: int, right: int, base: int, line_px: int) -> bool:
    return any(left < other[1] and other[0] < right and abs(base - other[2]) < line_px for other in taken)


def _outlined(picture: Picture, text: str, left_base: tuple[int, int], line_px: int) -> None:
    """Writes dark text with a white outline: the same glyphs, moved by a part of their stroke."""
    wide = max(1, line_px // 11)
    white, dark = (255, 255, 255), (20, 20, 20)
    for dx, dy in itertools.product((-wide, 0, wide), repeat=2):
        write(picture, text, (left_base[0] + dx, left_base[1] + dy), picture.shape[1], line_px, white, BOLD)
    write(picture, text, left_base, picture.shape[1], line_px, dark, BOLD)


def storeys(house: House) -> list[House]:
    """Returns each storey of a house alone, the lowest first."""
    spec = house.spec
    model = spec.compile()
    data = data_at_rest(model)
    floors_m = sorted({round(room.floor_z_m, 2) for room in read_rooms(model)})
    if len(floors_m) < 2:
        return [house]
    cut = []
    limits_m = [-math.inf, *(floor_m - STOREY_GAP_M for floor_m in floors_m[1:]), math.inf]
    for low_m, high_m in itertools.pairwise(limits_m):
        storey = spec.copy()
        other = (data.geom_xpos[:, 2] <= low_m) | (data.geom_xpos[:, 2] > high_m)
        for compiled, body in zip(list(spec.worldbody.bodies), list(storey.worldbody.bodies), strict=True):
            geoms = np.flatnonzero(model.geom_bodyid == compiled.id)
            if geoms.size and other[geoms].all():
                storey.delete(body)
        for element in (*storey.worldbody.geoms, *storey.worldbody.sites):
            if not low_m < element.pos[2] <= high_m:
                storey.delete(element)
        cut.append(replace(house, source=storey, checksum=None))
    return cut


def draw_views(house: House, columns: int = 3, *, least: int = 0) -> Picture | None:
    """Renders what the robot sees, tiled, (h, w, 3) RGB; None if there is nothing to see.

    In each room it is where the view is longest. In a house without rooms it looks at an object of each category.

    Args:
        house: a house.
        columns: views in a row.
        least: in a house with fewer rooms, it also looks at objects of different categories until there are so many.
    """
    model = house.spec.compile()
    data = data_at_rest(model)
    rooms = read_rooms(model)
    labels = read_labels(model, rules=house.rules, ignore_prefix="")
    poses = list(_room_poses(model, data, labels, rooms) if rooms else _object_poses(model, data, labels))
    if rooms and len(poses) < least:
        poses += itertools.islice(_object_poses(model, data, labels), least - len(poses))
    mujoco.mj_camlight(model, data)
    camera, tiles = Camera(model, labels, camera=VIEWS_CAMERA, profile="good"), []
    for name, (x, y, floor_z_m, yaw_deg) in poses:
        tile = camera.render(data, Pose(x, y, math.radians(yaw_deg), floor_z_m), ("rgb",))["rgb"]
        _outlined(tile, name, (10, 26), 22)
        tiles.append(tile)
    camera.close()
    return tiled(tiles, min(columns, len(tiles))) if tiles else None


def _room_poses(
    model: mujoco.MjModel, data: mujoco.MjData, labels: Labels, rooms: tuple[Room, ...]
) -> Iterator[tuple[str, ViewPose]]:
    """Yields the pose of the longest view in each room where the robot fits, with the room's name."""
    spaces = {z: FreeSpace(model, data, labels, rooms=rooms, floor_z_m=z) for z in {room.floor_z_m for room in rooms}}
    for room in rooms:
        place = _viewpoint(model, data, spaces[room.floor_z_m], room)
        if place is not None:
            x, y, yaw_deg = place
            yield room.name, (x, y, room.floor_z_m, yaw_deg)


def _object_poses(model: mujoco.MjModel, data: mujoco.MjData, labels: Labels) -> Iterator[tuple[str, ViewPose]]:
    """Yields the name of the first instance of each category, goals first, and a pose from which it is visible."""
    space = FreeSpace(model, data, labels)
    places = np.random.default_rng(0).permutation(space.frame.to_metres(np.argwhere(space.largest_part())))[:MAX_PLACES]
    first = {
        instance.category: instance
        for instance in reversed(labels.instances)
        if MPCAT40_ID[instance.category] not in _STRUCTURE
    }
    ordered = sorted(first.values(), key=lambda instance: instance.category not in GOAL_CATEGORIES)
    poses = ((instance.name, _look_at(model, data, instance, places)) for instance in ordered)
    yield from itertools.islice(((name, pose) for name, pose in poses if pose is not None), MAX_VIEWS)


def _look_at(
    model: mujoco.MjModel, data: mujoco.MjData, instance: Instance, places_m: NDArray[np.float64]
) -> ViewPose | None:
    """Returns the pose at one of the places (n, 2) that shows an instance, from a distance that fits its size, or None.

    The ray from the camera to the instance, at the camera's height where the instance has that height, hits it first.
    """
    low, high = box_around(model, data, instance.geom_ids)
    middle, eye_m = (low + high) / 2, VIEWS_CAMERA.height_m
    aim = np.array([middle[0], middle[1], np.clip(eye_m, low[2] + 0.02, high[2] - 0.02)])
    away_m = np.hypot(*(places_m - aim[:2]).T)
    best_m = NEAREST_LOOK_M + LOOK_SIZES * float((high - low)[:2].max())
    hit = np.zeros(1, np.int32)
    for x, y in places_m[np.argsort(np.abs(away_m - best_m))].tolist():
        eye = np.array([x, y, eye_m])
        mujoco.mj_ray(model, data, eye, aim - eye, None, 1, -1, hit, None)
        if int(hit[0]) in instance.geom_ids:
            return x, y, 0.0, math.degrees(math.atan2(aim[1] - y, aim[0] - x))
    return None


def _viewpoint(
    model: mujoco.MjModel, data: mujoco.MjData, space: FreeSpace, room: Room
) -> tuple[float, float, float] | None:
    """Returns x, y (metres) and yaw (degrees) of the longest view among random free points, or None."""
    (cx, cy, _), (hx, hy, _) = room.boxes[0]
    points = space.frame.to_metres(np.argwhere(space.free))
    points = points[(np.abs(points[:, 0] - cx) < hx) & (np.abs(points[:, 1] - cy) < hy)]
    if len(points) == 0:
        return None
    rng = np.random.default_rng(0)
    best, pose = -1.0, None
    for x, y in points[rng.integers(len(points), size=40)]:
        inside = _view_lengths(model, data, room, float(x), float(y))
        for i in range(0, len(FAN_DEG), 3):  # nine rays across the field of view
            view = inside[np.arange(i - 4, i + 5) % len(FAN_DEG)]
            score = float(view.mean() + 1.5 * min(view.min(), 1.0))
            if score > best:
                best, pose = score, (float(x), float(y), float(FAN_DEG[i]))
    return pose


def _view_lengths(model: mujoco.MjModel, data: mujoco.MjData, room: Room, x: float, y: float) -> NDArray[np.float64]:
    """Returns the free length (len(FAN_DEG),) of level rays from (x, y), in metres, up to 0.3 m beyond the room."""
    (cx, cy, _), (hx, hy, _) = room.boxes[0]
    fan = np.radians(FAN_DEG)
    rays = np.column_stack([np.cos(fan), np.sin(fan), np.zeros_like(fan)])
    geom, far = np.zeros(len(fan), np.int32), np.zeros(len(fan))
    eye = np.array([x, y, room.floor_z_m + VIEWS_CAMERA.height_m])
    mujoco.mj_multiRay(model, data, eye, rays.ravel(), None, 1, -1, geom, far, None, len(fan), 10.0)
    with np.errstate(divide="ignore"):
        to_walls = (np.array([hx, hy]) - np.sign(rays[:, :2]) * np.array([x - cx, y - cy])) / np.abs(rays[:, :2])
    return np.minimum(np.where(far < 0, 10.0, far), to_walls.min(axis=1) + 0.3)


MARGIN_M = 1.0
"""Width of the floor that is shown around a scene without rooms."""


def _extent(model: mujoco.MjModel, labels: Labels) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Returns the lowest and highest corner (3,) of all rooms.

    Without rooms it is the part of the storey's grid of free space where something is visible, with a metre around it.
    Floors count only where nothing else is visible, because scenes from elsewhere often stand on a wide plane.
    """
    boxes = [box for room in read_rooms(model) for box in room.boxes]
    if boxes:
        centres, halves = np.array([box[0] for box in boxes]), np.array([box[1] for box in boxes])
        return (centres - halves).min(axis=0), (centres + halves).max(axis=0)
    data = data_at_rest(model)
    frame = FreeSpace(model, data, labels).frame
    low = np.array(frame.origin_xy_m)
    high = low + np.array(frame.shape)[::-1] * frame.cell_m
    visible = rendered_geoms(model)
    standing = visible & (labels.geom_category != MPCAT40_ID["floor"])
    shown = np.flatnonzero(standing if standing.any() else visible).tolist()
    if shown:
        lowest, highest = box_around(model, data, shown)
        low, high = np.maximum(low, lowest[:2] - MARGIN_M), np.minimum(high, highest[:2] + MARGIN_M)
    return np.array([*low, 0.0]), np.array([*high, CEILING_M])


def add_backdrop(spec: mujoco.MjSpec) -> None:
    """Adds a plain background in place of those of the file."""
    for texture in [texture for texture in spec.textures if texture.type == mujoco.mjtTexture.mjTEXTURE_SKYBOX]:
        spec.delete(texture)
    spec.add_texture(
        name="backdrop", type=mujoco.mjtTexture.mjTEXTURE_SKYBOX, builtin=mujoco.mjtBuiltin.mjBUILTIN_FLAT,
        width=32, height=192, rgb1=list(BACKDROP), rgb2=list(BACKDROP),
    )  # fmt: skip


def camera_at(lookat: NDArray[np.float64], *, azimuth_deg: float, elevation_deg: float) -> mujoco.MjvCamera:
    """Returns a camera at a point (3,) that looks along a direction; its `distance` moves it back."""
    camera = mujoco.MjvCamera()
    camera.type = mujoco.mjtCamera.mjCAMERA_FREE
    camera.lookat[:] = lookat
    camera.distance, camera.azimuth, camera.elevation = 1e-3, azimuth_deg, elevation_deg
    return camera


def render(
    model: mujoco.MjModel,
    camera: mujoco.MjvCamera,
    size_px: tuple[int, int],
    *,
    fovy_deg: float,
    near_far_m: tuple[float, float] = NEAR_FAR_M,
) -> Picture:
    """Renders (h, w, 3) RGB with four samples per pixel and without shadows; changes the model's visual settings."""
    width, height = size_px
    model.vis.global_.offwidth, model.vis.global_.offheight = width, height
    model.vis.global_.fovy = fovy_deg
    model.vis.quality.shadowsize = 0
    model.vis.quality.numquads = QUADS
    model.stat.extent = EXTENT_M
    model.vis.map.znear, model.vis.map.zfar = (plane_m / EXTENT_M for plane_m in near_far_m)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    renderer = mujoco.Renderer(model, height, width)
    option = mujoco.MjvOption()
    option.sitegroup[:] = 0
    try:
        renderer.update_scene(data, camera, option)
        renderer.scene.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = False
        renderer.scene.flags[mujoco.mjtRndFlag.mjRND_REFLECTION] = False
        return renderer.render().copy()
    finally:
        renderer.close()


def titled(picture: Picture, title: str) -> Picture:
    """Returns a picture (h, w, 3) with a strip above it that shows its title."""
    head = np.full((TITLE_PX, picture.shape[1], 3), 255, np.uint8)
    write(head, title, (12, round(0.7 * TITLE_PX)), picture.shape[1] - 24, round(0.55 * TITLE_PX), (20, 20, 20), BOLD)
    return np.vstack([head, picture])
