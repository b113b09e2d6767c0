"""Small houses for tests: a floor, four walls, and the objects that a test adds.

Every function returns a `House`; the `with_*` functions copy the one they are given and add one labelled object, so
scenes are built by nesting: `with_box(room(4, 3), "table_00", centre_m=(1, 0, 0.4), half_m=(0.3, 0.3, 0.4))`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from sim.gl import mujoco
from sim.houses.house import House

Vec3 = tuple[float, float, float]


def open_floor(*, friction: float = 1.0, name: str = "floor_00") -> House:
    """Returns an endless floor at z = 0 and nothing else."""
    spec = mujoco.MjSpec()
    spec.worldbody.add_light(pos=(0, 0, 3), dir=(0, 0, -1))
    spec.worldbody.add_geom(
        name=name, type=mujoco.mjtGeom.mjGEOM_PLANE, size=(0, 0, 1), friction=(friction, 0.005, 0.0001)
    )
    return House("open_floor", spec)


def room(width_m: float = 4.0, depth_m: float = 4.0, *, height_m: float = 2.5, box_floor: bool = False) -> House:
    """Returns a room around the origin: inner size `width_m` (x) times `depth_m` (y), site `room_living_00`."""
    spec = mujoco.MjSpec()
    world = spec.worldbody
    world.add_light(pos=(0, 0, height_m - 0.1), dir=(0, 0, -1))
    half_x, half_y, half_z, thick = 0.5 * width_m, 0.5 * depth_m, 0.5 * height_m, 0.05
    outer = (half_x + 2 * thick, half_y + 2 * thick)
    if box_floor:
        _box(world, "floor_00", (0, 0, -thick), (*outer, thick))
    else:
        world.add_geom(name="floor_00", type=mujoco.mjtGeom.mjGEOM_PLANE, size=(*outer, 1))
    _box(world, "wall_00", (half_x + thick, 0, half_z), (thick, outer[1], half_z))
    _box(world, "wall_01", (-half_x - thick, 0, half_z), (thick, outer[1], half_z))
    _box(world, "wall_02", (0, half_y + thick, half_z), (half_x, thick, half_z))
    _box(world, "wall_03", (0, -half_y - thick, half_z), (half_x, thick, half_z))
    world.add_site(
        name="room_living_00", type=mujoco.mjtGeom.mjGEOM_BOX, pos=(0, 0, half_z), size=(half_x, half_y, half_z)
    )
    return House("room", spec)


def sofa_room() -> House:
    """A room of 6 x 6 m with a sofa whose middle is at x = 2.5 m."""
    return with_box(room(6, 6), "sofa_00", centre_m=(2.5, 0, 0.4), half_m=(0.4, 0.8, 0.4))


def bed_behind_a_wall(wall_from_y_m: float = -0.1) -> House:
    """A room of 9 x 5 m, cut at x = 0.5 m by a wall from `wall_from_y_m` to y = 2.5 m; a bed at larger x."""
    house = with_box(room(9, 5), "bed_00", centre_m=(3.4, 1.2, 0.3), half_m=(0.9, 0.9, 0.3))
    middle_m, half_m = 0.5 * (wall_from_y_m + 2.5), 0.5 * (2.5 - wall_from_y_m)
    return with_box(house, "wall_10", centre_m=(0.5, middle_m, 1.25), half_m=(0.05, half_m, 1.25))


def two_storeys() -> House:
    """Returns two rooms of 6 x 4 m without stairs, with floors at 0 m (a bed) and 3 m (a sofa)."""
    house = with_box(room(6, 4), "bed_00", centre_m=(2.4, 0, 0.25), half_m=(0.5, 1.0, 0.25))
    house = with_box(house, "floor_01", centre_m=(0, 0, 2.95), half_m=(3.1, 2.1, 0.05))
    for number, (x, y) in enumerate(((3.05, 0.0), (-3.05, 0.0), (0.0, 2.05), (0.0, -2.05)), start=10):
        half = (0.05, 2.1, 1.25) if x else (3.0, 0.05, 1.25)
        house = with_box(house, f"wall_{number}", centre_m=(x, y, 4.25), half_m=half)
    house = with_box(house, "sofa_00", centre_m=(2.4, 0, 3.3), half_m=(0.4, 0.8, 0.3))
    house.spec.worldbody.add_site(
        name="room_bedroom_00", type=mujoco.mjtGeom.mjGEOM_BOX, pos=(0, 0, 4.25), size=(3, 2, 1.25)
    )
    return House("two_storeys", house.spec)


def ledge(drop_m: float) -> House:
    """Returns a floor that ends at x = 0 and behind it one that is lower by `drop_m`; a bed is on the upper one."""
    house = with_box(House("ledge", mujoco.MjSpec()), "floor_00", centre_m=(-2, 0, -0.05), half_m=(2, 2, 0.05))
    house = with_box(house, "floor_01", centre_m=(2, 0, -drop_m - 0.05), half_m=(2, 2, 0.05))
    house = with_box(house, "bed_00", centre_m=(-3.5, 1.0, 0.25), half_m=(0.5, 1.0, 0.25))
    return House("ledge", house.spec)


def with_box(
    house: House,
    name: str,
    *,
    centre_m: Vec3,
    half_m: Vec3,
    yaw_rad: float = 0.0,
    group: int = 0,
    rgba: tuple[float, ...] = (0.6, 0.5, 0.4, 1.0),
) -> House:
    """Returns the house with an additional static box."""
    spec = house.spec.copy()
    geom = _box(spec.worldbody, name, centre_m, half_m, yaw_rad)
    geom.group, geom.rgba = group, rgba
    return House(house.name, spec, house.rules)


def with_post(
    house: House, name: str, *, xy_m: tuple[float, float], radius_m: float = 0.01, height_m: float = 1.0
) -> House:
    """Returns the house with an additional static upright cylinder, such as a table's leg or a pole."""
    spec = house.spec.copy()
    spec.worldbody.add_geom(
        name=name, type=mujoco.mjtGeom.mjGEOM_CYLINDER, pos=(*xy_m, 0.5 * height_m), size=(radius_m, 0.5 * height_m, 0)
    )
    return House(house.name, spec, house.rules)


def with_movable(
    house: House,
    name: str,
    *,
    xy_m: tuple[float, float],
    size_m: Vec3 = (0.40, 0.40, 0.45),
    mass_kg: float = 3.0,
    friction: float = 0.3,
) -> House:
    """Returns the house with an additional free box on the floor; its `friction` overrides the floor's (priority 1)."""
    spec = house.spec.copy()
    half = tuple(0.5 * size for size in size_m)
    body = spec.worldbody.add_body(name=name, pos=(*xy_m, half[2]))
    body.add_freejoint()
    geom = body.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=half, mass=mass_kg)
    geom.friction, geom.priority = (friction, 0.005, 0.0001), 1
    return House(house.name, spec, house.rules)


def cluttered_room(boxes: int, *, width_m: float = 12.0, free_radius_m: float = 0.6) -> House:
    """Returns a square room with `boxes` small static boxes on a lattice, none within `free_radius_m` of the origin."""
    spec = room(width_m, width_m).spec.copy()
    for number, (x_m, y_m) in enumerate(_lattice(boxes, width_m - 1.0, free_radius_m)):
        body = spec.worldbody.add_body(name=f"cabinet_{number:03d}", pos=(x_m, y_m, 0.3))
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=(0.08, 0.08, 0.3))
    return House("cluttered_room", spec)


def random_obstacles(seed: int) -> House:
    """Returns an endless floor with 1 to 8 objects: boxes, poles of 2 cm, low slabs, table tops, legs of chairs.

    A disc of radius 0.18 m fits at the origin.
    """
    rng = np.random.default_rng(seed)
    house = open_floor()
    nearest_m = {"box": 0.62, "pole": 0.20, "slab": 0.41, "top": 0.55, "legs": 0.47}
    for number in range(int(rng.integers(1, 9))):
        kind = str(rng.choice(list(nearest_m)))
        distance_m, bearing, yaw = nearest_m[kind] + rng.uniform(0, 0.4), rng.uniform(0, math.tau), rng.uniform(0, 3)
        x, y = float(distance_m * math.cos(bearing)), float(distance_m * math.sin(bearing))
        if kind == "box":
            half = (float(rng.uniform(0.02, 0.3)), float(rng.uniform(0.02, 0.3)), 0.4)
            house = with_box(house, f"cabinet_{number}", centre_m=(x, y, 0.4), half_m=half, yaw_rad=yaw)
        elif kind == "pole":
            house = with_post(house, f"column_{number}", xy_m=(x, y))
        elif kind == "slab":
            half = (0.1, 0.2, 0.025)
            house = with_box(house, f"objects_{number}", centre_m=(x, y, 0.025), half_m=half, yaw_rad=yaw)
        elif kind == "top":
            half = (0.3, 0.2, 0.02)
            house = with_box(house, f"table_{number}", centre_m=(x, y, 0.7), half_m=half, yaw_rad=yaw)
        else:
            for leg, (dx, dy) in enumerate(((0.19, 0.19), (0.19, -0.19), (-0.19, 0.19), (-0.19, -0.19))):
                house = with_post(house, f"chair_{number}{leg}", xy_m=(x + dx, y + dy))
    return house


def with_facts(house: House, **facts: str) -> House:
    """Returns the house with texts about instances (`sim.houses.instance_facts`)."""
    spec = house.spec.copy()
    for name, text in facts.items():
        spec.add_text(name=name, data=text)
    return House(house.name, spec)


def furnished() -> House:
    """A room of 8 x 8 m with two red chairs, of which one is beside the table, a blue chair, a lamp on the table."""
    house = room(8, 8)
    for name, x, y, half in (
        ("chair_00", 3.0, 3.0, 0.2), ("chair_01", -3.0, 0.0, 0.2), ("chair_02", 3.0, -3.0, 0.3),
        ("table_00", -2.2, 0.0, 0.4),
    ):  # fmt: skip
        house = with_box(house, name, centre_m=(x, y, 0.4), half_m=(half, half, 0.4))
    house = with_box(house, "lighting_00", centre_m=(-2.2, 0.0, 1.0), half_m=(0.1, 0.1, 0.2))
    house = with_box(house, "lighting_01", centre_m=(0.0, 0.0, 2.3), half_m=(0.1, 0.1, 0.1))
    return with_facts(
        house,
        chair_00="name: armchair; colour: red; material: fabric",
        chair_01="name: armchair; colour: red; material: leather",
        chair_02="name: office chair; colour: blue",
        table_00="name: desk; material: wood",
        lighting_00="name: desk lamp",
        lighting_01="name: pendant lamp",
    )


def _lattice(count: int, width_m: float, free_radius_m: float) -> Iterable[tuple[float, float]]:
    """Returns `count` places on a square lattice that fills a square of `width_m`."""
    side = math.ceil(math.sqrt(count))
    while True:
        steps = [width_m * ((i + 0.5) / side - 0.5) for i in range(side)]
        places = [(x, y) for x in steps for y in steps if math.hypot(x, y) >= free_radius_m]
        if len(places) >= count:
            return places[:count]
        side += 1


def _box(parent: mujoco.MjsBody, name: str, centre_m: Vec3, half_m: Vec3, yaw_rad: float = 0.0) -> mujoco.MjsGeom:
    quat = (math.cos(0.5 * yaw_rad), 0.0, 0.0, math.sin(0.5 * yaw_rad))
    return parent.add_geom(name=name, type=mujoco.mjtGeom.mjGEOM_BOX, pos=centre_m, size=half_m, quat=quat)
