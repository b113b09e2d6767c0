"""Renders a top view of each storey without ceilings and room views of houses, and sheets of all furniture styles.

python tools/gallery.py --houses assets/mjcf_houses/val/val_00.xml --out runs/gallery
python tools/gallery.py --sheet --pool heldout --categories chair sofa --out runs/gallery
python tools/gallery.py --sheet --furniture runs/models --categories chair --out runs/gallery
"""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from sim import cli
from sim.files import write_picture
from sim.gl import mujoco
from sim.housegen.furniture import CATALOGUE
from sim.housegen.furniture.catalogue import Catalogue, Style
from sim.housegen.furniture.item import Geom, Item, Look, Pool
from sim.housegen.imported.catalogue import style_of
from sim.housegen.imported.library import read_index
from sim.housegen.mjcf import HouseBuilder, Lamp, PlacedItem
from sim.houses.house import Room, read_rooms
from sim.houses.labels import read_labels
from sim.houses.load import load_house
from sim.interface import CameraModel, ConfigError
from sim.paths import assets_dir
from sim.world.freespace import FreeSpace

Picture = NDArray[np.uint8]
VIEW_PX = (640, 480)
TOP_PX = (1400, 1100)
TILE_PX = (320, 320)
STOREY_GAP_M = 0.3
"""Height below an upper floor from which everything belongs to the upper storey: its slabs, the edges of its well."""
BACKDROP = (0.86, 0.90, 0.95)
"""Colour of the background."""
FAN_DEG = np.arange(0, 360, 10)
"""Directions of the rays that measure how far a view reaches."""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Options of the gallery."""

    out: cli.OutFolder
    """Folder for the PNG files; created if missing."""
    houses: tuple[Path, ...] = ()
    """House files; each gives a top view of each storey and a sheet of room views."""
    sheet: bool = False
    """Render every furniture style, one sheet per category."""
    categories: tuple[str, ...] = ()
    """With --sheet: the categories; all if not given."""
    pool: Pool = "train"
    """With --sheet: the pool of the styles."""
    furniture: Path | None = None
    """With --sheet: the models of a folder that tools/import_furniture.py made, instead of the shipped styles."""
    seed: cli.Seed = 0
    """With --sheet: seed of sizes and colours."""


def main(args: Args) -> int:
    """Writes the pictures and prints their paths; returns the exit status."""
    if not (assets_dir() / "textures").is_dir():
        raise ConfigError(f"'{assets_dir() / 'textures'}' is missing; tools/make_textures.py makes it.")
    if not args.houses and not args.sheet:
        raise ConfigError("gallery needs --houses FILE ... or --sheet.")
    catalogue = CATALOGUE if args.furniture is None else _imported(args.furniture, args.pool)
    sheets = {category: catalogue.styles(category) for category in args.categories or catalogue.categories}
    for path in args.houses:
        spec = load_house(path).spec
        for number, storey in enumerate(_storeys(spec)):
            _save(args.out / f"{path.stem}_top{f'_{number}' if number else ''}.png", draw_top(storey))
        _save(args.out / f"{path.stem}_views.png", draw_views(spec))
    if args.sheet:
        for category, styles in sheets.items():
            of_pool = [style for style in styles if style.pool == args.pool]
            if of_pool:
                copies, name = (2, args.pool) if args.furniture is None else (1, "imported")
                sheet = draw_sheet(of_pool, np.random.default_rng(args.seed), copies, catalogue)
                _save(args.out / f"sheet_{name}_{category}.png", sheet)
    return 0


def _imported(folder: Path, pool: Pool) -> Catalogue:
    """Returns a catalogue of imported models only, ordered by what they are used for."""
    models = sorted(read_index(folder), key=lambda model: (model.uses, model.name))
    return Catalogue(style_of(folder, model, pool) for model in models)


def draw_top(spec: mujoco.MjSpec) -> Picture:
    """Renders the house from above, without ceilings and ceiling lamps, (h, w, 3) RGB."""
    open_top = spec.copy()
    floors_m = {room.floor_z_m for room in read_rooms(spec.compile())}
    _add_backdrop(open_top)
    for body in list(open_top.worldbody.bodies):
        height_m = body.pos[2] - max((floor_m for floor_m in floors_m if floor_m <= body.pos[2]), default=0.0)
        if body.name.startswith("ceiling_") or (body.name.startswith("lighting_") and height_m > 1.8):
            open_top.delete(body)
    model = open_top.compile()
    low, high = _extent(read_rooms(model))
    width, height = TOP_PX
    camera = _camera((low + high) / 2, azimuth_deg=90.0, elevation_deg=-89.9)
    reach = max((high[1] - low[1] + 1.0) / 2, (high[0] - low[0] + 1.0) / 2 * height / width)
    camera.distance = reach / math.tan(math.radians(15.0)) + 1.5
    return _render(model, camera, TOP_PX, fovy_deg=30.0)


def _storeys(spec: mujoco.MjSpec) -> list[mujoco.MjSpec]:
    """Returns the house from the ground up to each of its storeys, the lowest first."""
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    floors_m = sorted({round(room.floor_z_m, 2) for room in read_rooms(model)})
    cut = []
    for above_m in floors_m[1:]:
        storey = spec.copy()
        above = data.geom_xpos[:, 2] > above_m - STOREY_GAP_M
        for body in list(storey.worldbody.bodies):
            geoms = np.flatnonzero(model.geom_bodyid == model.body(body.name).id)
            if geoms.size and above[geoms].all():
                storey.delete(body)
        for geom in list(storey.worldbody.geoms):
            if geom.pos[2] > above_m - STOREY_GAP_M:
                storey.delete(geom)
        for site in list(storey.worldbody.sites):
            if site.pos[2] > above_m:
                storey.delete(site)
        cut.append(storey)
    return [*cut, spec]


def draw_views(spec: mujoco.MjSpec, columns: int = 3) -> Picture:
    """Renders what the robot sees in each room from the viewpoint with the longest view, tiled, (h, w, 3) RGB."""
    seen = spec.copy()
    _add_backdrop(seen)
    model = seen.compile()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    rooms = read_rooms(model)
    labels = read_labels(model)
    spaces = {z: FreeSpace(model, data, labels, rooms=rooms, floor_z_m=z) for z in {room.floor_z_m for room in rooms}}
    eye_m, fovy = CameraModel().height_m, math.degrees(CameraModel().vfov_rad)
    tiles = []
    for room in rooms:
        place = _viewpoint(model, data, spaces[room.floor_z_m], room)
        if place is None:
            continue
        x, y, yaw_deg = place
        camera = _camera(np.array([x, y, room.floor_z_m + eye_m]), azimuth_deg=yaw_deg, elevation_deg=0.0)
        tile = np.ascontiguousarray(_render(model, camera, VIEW_PX, fovy_deg=fovy))
        cv2.putText(tile, room.name, (8, 20), cv2.FONT_HERSHEY_SIMPLEX, 0.5, (200, 30, 30), 1, cv2.LINE_AA)
        tiles.append(tile)
    return _tiled(tiles, columns)


def draw_sheet(
    styles: Sequence[Style], rng: np.random.Generator, copies: int = 2, catalogue: Catalogue = CATALOGUE
) -> Picture:
    """Renders `copies` items of each of these styles, tiled, (h, w, 3) RGB."""
    tiles = []
    for style in styles:
        for _ in range(copies):
            item = catalogue.make_item(style.category, rng, pool=style.pool, style=style.name)
            tile = np.ascontiguousarray(_portrait(item))
            text = f"{style.name} {item.size_m[0]:.2f}x{item.size_m[1]:.2f}x{item.size_m[2]:.2f}"
            cv2.putText(tile, text, (6, 16), cv2.FONT_HERSHEY_SIMPLEX, 0.42, (60, 60, 60), 1, cv2.LINE_AA)
            tiles.append(tile)
    return _tiled(tiles, 6)


def _portrait(item: Item) -> Picture:
    """Renders one item on a plain ground, from its front and a little above."""
    builder = HouseBuilder("portrait")
    z = {"floor": 0.0, "top": 0.0, "wall": 0.05, "ceiling": item.size_m[2]}[item.mount]
    slab = Geom("box", (3.0, 3.0, 0.01), (0.0, 0.0, -0.011), Look((0.8, 0.8, 0.78, 1.0)))
    builder.add(PlacedItem(item, 0.0, 0.0, z))
    builder.add(PlacedItem(Item("floor", "ground", (6.0, 6.0, 0.0), (slab,))))
    builder.add_lamp(Lamp((2.0, 1.0, 3.0), (0.55, 0.55, 0.53), (-0.6, -0.35, -0.9)))
    builder.add_lamp(Lamp((2.0, -1.0, 2.0), (0.2, 0.2, 0.22), (-0.5, 0.8, -0.3)))
    _add_backdrop(builder.spec)
    size = np.array(item.size_m)
    centre = np.array([0.0 if item.mount != "wall" else size[0] / 2, 0.0, z + size[2] / 2])
    if item.mount == "ceiling":
        centre[2] = size[2] / 2
    camera = _camera(centre, azimuth_deg=205.0, elevation_deg=-18.0)
    camera.distance = 1.75 * float(np.linalg.norm(size)) + 0.1
    return _render(builder.spec.compile(), camera, TILE_PX, fovy_deg=38.0)


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
    best, found = -1.0, None
    for x, y in points[rng.integers(len(points), size=40)]:
        inside = _view_lengths(model, data, room, float(x), float(y))
        for i in range(0, len(FAN_DEG), 3):  # nine rays across the field of view
            view = inside[np.arange(i - 4, i + 5) % len(FAN_DEG)]
            score = float(view.mean() + 1.5 * min(view.min(), 1.0))
            if score > best:
                best, found = score, (float(x), float(y), float(FAN_DEG[i]))
    return found


def _view_lengths(model: mujoco.MjModel, data: mujoco.MjData, room: Room, x: float, y: float) -> NDArray[np.float64]:
    """Returns the free length (len(FAN_DEG),) of level rays from (x, y), in metres, up to 0.3 m beyond the room."""
    (cx, cy, _), (hx, hy, _) = room.boxes[0]
    fan = np.radians(FAN_DEG)
    rays = np.column_stack([np.cos(fan), np.sin(fan), np.zeros_like(fan)])
    geom, far = np.zeros(len(fan), np.int32), np.zeros(len(fan))
    eye = np.array([x, y, room.floor_z_m + CameraModel().height_m])
    mujoco.mj_multiRay(model, data, eye, rays.ravel(), None, 1, -1, geom, far, None, len(fan), 10.0)
    with np.errstate(divide="ignore"):
        to_walls = (np.array([hx, hy]) - np.sign(rays[:, :2]) * np.array([x - cx, y - cy])) / np.abs(rays[:, :2])
    return np.minimum(np.where(far < 0, 10.0, far), to_walls.min(axis=1) + 0.3)


def _extent(rooms: tuple[Room, ...]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Returns the lowest and highest corner (3,) of all rooms."""
    boxes = [box for room in rooms for box in room.boxes]
    centres, halves = np.array([box[0] for box in boxes]), np.array([box[1] for box in boxes])
    return (centres - halves).min(axis=0), (centres + halves).max(axis=0)


def _add_backdrop(spec: mujoco.MjSpec) -> None:
    spec.add_texture(
        name="backdrop", type=mujoco.mjtTexture.mjTEXTURE_SKYBOX, builtin=mujoco.mjtBuiltin.mjBUILTIN_FLAT,
        width=32, height=192, rgb1=list(BACKDROP), rgb2=list(BACKDROP),
    )  # fmt: skip


def _camera(lookat: NDArray[np.float64], *, azimuth_deg: float, elevation_deg: float) -> mujoco.MjvCamera:
    camera = mujoco.MjvCamera()
    camera.type = mujoco.mjtCamera.mjCAMERA_FREE
    camera.lookat[:] = lookat
    camera.distance, camera.azimuth, camera.elevation = 1e-3, azimuth_deg, elevation_deg
    return camera


def _render(model: mujoco.MjModel, camera: mujoco.MjvCamera, size_px: tuple[int, int], *, fovy_deg: float) -> Picture:
    """Renders (h, w, 3) RGB with four samples per pixel and without shadows."""
    width, height = size_px
    model.vis.global_.offwidth, model.vis.global_.offheight = width, height
    model.vis.global_.fovy = fovy_deg
    model.stat.extent = 10.0
    model.vis.map.znear, model.vis.map.zfar = 0.005, 20.0
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    renderer = mujoco.Renderer(model, height, width)
    option = mujoco.MjvOption()
    option.sitegroup[:] = 0
    renderer.update_scene(data, camera, option)
    renderer.scene.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = False
    renderer.scene.flags[mujoco.mjtRndFlag.mjRND_REFLECTION] = False
    picture = renderer.render().copy()
    renderer.close()
    return picture


def _tiled(tiles: list[Picture], columns: int) -> Picture:
    blank = np.full_like(tiles[0], 255)
    tiles = tiles + [blank] * (-len(tiles) % columns)
    return np.vstack([np.hstack(tiles[i : i + columns]) for i in range(0, len(tiles), columns)])


def _save(path: Path, picture: Picture) -> None:
    write_picture(path, picture)
    print(path)


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
