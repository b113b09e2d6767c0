"""Furniture must stand as dwelling design wants it; each rule on a room that follows it and on one that does not."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import pytest

from sim.gl import mujoco
from sim.homes.housegen.generator import generate
from sim.houses.geoms import data_at_rest
from sim.houses.house import read_rooms
from sim.houses.labels import read_labels
from sim.world.arrangement import arrangement_faults
from sim.world.standing import read_standing
from tests.helpers.worlds import room

NORTH, SOUTH, WEST = math.pi / 2, -math.pi / 2, math.pi


@dataclass(frozen=True)
class Piece:
    """A box with a name that stands in the room, its front along its own x axis."""

    label: str
    name: str
    x_m: float
    y_m: float
    size_m: tuple[float, float, float]
    """Depth, width and height."""
    yaw_rad: float = 0.0
    z_m: float = 0.0


def faults(kind: str, *pieces: Piece) -> list[str]:
    """Returns the faults of a room of 6 x 4 m around the origin with these pieces."""
    spec = room(6, 4).spec
    spec.site("room_living_00").name = f"room_{kind}_00"
    for piece in pieces:
        half = [0.5 * size for size in piece.size_m]
        body = spec.worldbody.add_body(
            name=piece.label,
            pos=(piece.x_m, piece.y_m, piece.z_m + half[2]),
            quat=(math.cos(piece.yaw_rad / 2), 0.0, 0.0, math.sin(piece.yaw_rad / 2)),
        )
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=half)
        if piece.name:
            spec.add_text(name=piece.label, data=f"name: {piece.name}")
    model = spec.compile()
    data = data_at_rest(model)
    return faults_of(model, data)


# A run along the south wall: fridge, worktop with a sink, cooker, worktop.
FRIDGE = Piece("appliances_00", "fridge", -2.0, -1.67, (0.62, 0.6, 1.8), NORTH)
SINK_TOP = Piece("counter_00", "kitchen counter", -0.9, -1.67, (0.62, 1.58, 0.9), NORTH)
SINK = Piece("sink_00", "kitchen sink", -0.9, -1.67, (0.4, 0.5, 0.2), NORTH, 0.72)
COOKER = Piece("appliances_01", "cooker", 0.2, -1.67, (0.62, 0.6, 0.9), NORTH)
END_TOP = Piece("counter_01", "kitchen counter", 0.9, -1.67, (0.62, 0.78, 0.9), NORTH)
KITCHEN = (FRIDGE, SINK_TOP, SINK, COOKER, END_TOP)


def moved(piece: Piece, dx_m: float, dy_m: float) -> Piece:
    return replace(piece, x_m=piece.x_m + dx_m, y_m=piece.y_m + dy_m)


SOFA = Piece("sofa_00", "sofa", -2.4, 0.0, (0.9, 2.0, 0.8))
BED = Piece("bed_00", "bed", -1.9, 0.0, (2.0, 1.4, 0.5))
DOUBLE_BED = replace(BED, size_m=(2.0, 1.6, 0.5))
SCREEN = Piece("tv_monitor_00", "television", 2.8, 0.0, (0.1, 1.2, 0.7), WEST, 0.9)
TOILET = Piece("toilet_00", "toilet", -2.6, 0.0, (0.7, 0.38, 0.8))
CABINET = Piece("cabinet_00", "wall cabinet", -0.9, -1.83, (0.34, 1.5, 0.7), NORTH, 1.45)
ARMCHAIRS = [Piece(f"chair_0{n}", "armchair", n - 1.0, 0.0, (0.8, 0.8, 0.9)) for n in range(2)]
ARMCHAIR = moved(ARMCHAIRS[0], -1.5, 0.0)
BASIN = Piece("sink_00", "washbasin", -1.4, 0.0, (0.4, 0.5, 0.85), WEST)
BASIN_AT_WALL = Piece("sink_00", "washbasin", -2.7, 1.0, (0.5, 0.5, 0.85))
MIRROR = Piece("mirror_00", "mirror", -2.98, 1.1, (0.03, 0.5, 0.8), 0.0, 1.1)
SHOWER = Piece("shower_00", "shower", -2.53, 1.52, (0.9, 0.9, 2.0))
STOVE = Piece("fireplace_00", "tiled stove", -2.6, 0.0, (0.7, 0.9, 2.0))
SHELF = Piece("shelving_00", "bookcase", -2.8, 1.4, (0.3, 0.8, 1.8))
WIDE_SHELF = Piece("shelving_00", "bookcase", -1.0, -1.35, (2.8, 0.8, 1.8))
COFFEE_TABLE = Piece("table_00", "coffee table", -1.3, 0.0, (0.6, 1.0, 0.4))
PLANT = Piece("plant_00", "potted plant", 1.0, 1.8, (0.4, 0.4, 1.4))
LOW_PLANT = Piece("plant_00", "potted plant", 2.0, 1.5, (0.3, 0.3, 0.7))
BIN = Piece("objects_00", "bin", 2.0, 1.5, (0.3, 0.3, 0.5))
BALL = Piece("gym_equipment_00", "exercise ball", 2.0, 1.5, (0.6, 0.6, 0.6))
LONG_TABLE = Piece("table_00", "dining table", 0.0, 0.0, (0.8, 1.3, 0.75))
DINERS = [Piece(f"chair_0{n}", "dining chair", 0.7, y, (0.5, 0.45, 0.9)) for n, y in enumerate((-0.3, 0.3))]
RULES = {
    "worktop between sink and cooker": (
        "kitchen", KITCHEN, (FRIDGE, SINK_TOP, moved(SINK, 0.4, 0.0), COOKER, END_TOP),
        "has 0.15 m of worktop between sink_00 and appliances_01, which must be 0.3 m",
    ),
    "no cabinet above the hob": (
        "kitchen", (*KITCHEN, CABINET), (*KITCHEN, moved(CABINET, 1.1, 0.0)), "has cabinet_00 above its hob"
    ),
    "both sides of a double bed": (
        "bedroom", (DOUBLE_BED,), (moved(DOUBLE_BED, 0.0, -1.1),),
        "has bed_00 without 0.6 m of free floor along both long sides",
    ),
    "a bed faces the screen": (
        "bedroom", (BED, moved(SCREEN, 0.0, 1.2)), (BED, replace(SCREEN, x_m=-1.0, y_m=1.9, yaw_rad=SOUTH)),
        "has tv_monitor_00, a screen that no bed faces",
    ),
    "one television": (
        "gym", (SCREEN,), (SCREEN, replace(SCREEN, label="tv_monitor_01", y_m=1.4)), "has 2 televisions"
    ),
    "a sofa or two armchairs": ("living_room", ARMCHAIRS, ARMCHAIRS[:1], "has no sofa and no two armchairs"),
    "floor in front of a toilet": (
        "bathroom", (TOILET, BASIN), (TOILET, moved(BASIN, -0.3, 0.0)),
        "has less than 0.6 m of free floor in front of toilet_00",
    ),
    "a mirror over a basin": (
        "bathroom", (TOILET, BASIN_AT_WALL, MIRROR), (TOILET, BASIN_AT_WALL, moved(MIRROR, 0.0, 0.2)),
        "has mirror_00, a mirror that hangs over no basin",
    ),
    "a mirror on the wall of the basin": (
        "bathroom", (TOILET, BASIN_AT_WALL, MIRROR), (TOILET, BASIN_AT_WALL, moved(MIRROR, 5.96, 0.0)),
        "has mirror_00, a mirror that hangs over no basin",
    ),
    "a shower in a corner": (
        "bathroom", (TOILET, SHOWER), (TOILET, moved(SHOWER, 0.0, -0.27)),
        "has shower_00, a shower that stands in no corner",
    ),
    "no tall plant in a bathroom": (
        "bathroom", (TOILET, LOW_PLANT), (TOILET, replace(LOW_PLANT, size_m=(0.3, 0.3, 1.2))),
        "has plant_00, a plant 1.2 m high instead of at most 0.8 m",
    ),
    "away from a fire": (
        "office", (STOVE, SHELF), (STOVE, moved(SHELF, 0.0, -0.3)),
        "has shelving_00 0.25 m from fireplace_00, which must be 0.5 m",
    ),
    "a bookcase at a wall": (
        "office", (SHELF,), (moved(SHELF, 2.0, -1.4),), "has shelving_00, a bookcase that stands at no wall"
    ),
    "a coffee table next to a seat": (
        "office", (ARMCHAIR, COFFEE_TABLE), (ARMCHAIR, moved(COFFEE_TABLE, 1.0, 0.0)),
        "has table_00, a coffee table without a seat next to it",
    ),
    "a path in a hallway": (
        "hallway", (PLANT, WIDE_SHELF), (replace(PLANT, y_m=0.0, size_m=(0.4, 2.4, 1.4)),),
        "has 0.80 m of free width beside plant_00, which must be 0.9 m",
    ),
    "one bin in a kitchen": (
        "kitchen", (*KITCHEN, BIN), (*KITCHEN, BIN, replace(BIN, label="objects_01", x_m=2.5)), "has 2 bins"
    ),
    "no gym in a kitchen": (
        "kitchen", KITCHEN, (*KITCHEN, BALL), "has gym_equipment_00, which does not belong in a kitchen"
    ),
    "chairs on both sides of a long table": (
        "dining_room", (LONG_TABLE, DINERS[0], moved(DINERS[1], -1.4, 0.0)), (LONG_TABLE, *DINERS),
        "has table_00, a dining table whose chairs stand on one side",
    ),
}  # fmt: skip
"""Kind of room, pieces that follow the rule, pieces that break it, and the fault."""


@pytest.mark.parametrize(("kind", "good", "bad", "fault"), RULES.values(), ids=RULES)
def test_a_rule_is_kept_or_its_fault_is_reported(
    kind: str, good: Sequence[Piece], bad: Sequence[Piece], fault: str
) -> None:
    assert faults(kind, *good) == []
    assert faults(kind, *bad) == [f"room_{kind}_00 {fault}"]


@pytest.mark.parametrize(
    ("apart", "fault"),
    [
        (moved(FRIDGE, -0.5, 0.0), "has no worktop next to the fridge"),
        (moved(COOKER, 0.0, 0.75), "has no worktop next to the cooker or hob"),
    ],
)
def test_a_unit_that_stands_apart_is_reported(apart: Piece, fault: str) -> None:
    units = [apart if unit.label == apart.label else unit for unit in KITCHEN]
    assert f"room_kitchen_00 {fault}" in faults("kitchen", *units)


def test_a_fridge_joined_by_a_dishwasher_counts_as_part_of_the_run() -> None:
    dishwasher = Piece("appliances_02", "dishwasher", -2.0, -1.67, (0.62, 0.6, 0.85), NORTH)
    assert faults("kitchen", *KITCHEN[1:], dishwasher, moved(FRIDGE, -0.62, 0.0)) == []


def test_a_work_triangle_outside_its_range_is_reported() -> None:
    far = (moved(FRIDGE, 4.6, 3.3), moved(END_TOP, 1.0, 3.3), *KITCHEN[1:4])
    assert any("has a work triangle of" in fault for fault in faults("kitchen", *far))


def test_an_island_needs_an_aisle() -> None:
    island = Piece("counter_02", "kitchen island", -0.5, 0.2, (0.9, 1.6, 0.9), NORTH)
    assert faults("kitchen", *KITCHEN, island) == []
    assert any("has an aisle of 0.81 m" in fault for fault in faults("kitchen", *KITCHEN, moved(island, 0.0, -0.3)))


def test_a_sofa_faces_something() -> None:
    assert faults("living_room", SOFA, SCREEN) == []
    (fault,) = faults("living_room", SOFA, moved(SCREEN, -5.75, 0.0))
    assert "which faces neither" in fault


def test_each_dining_table_has_two_chairs_and_each_desk_one() -> None:
    table = Piece("table_00", "dining table", 0.0, 0.0, (0.8, 1.2, 0.75))
    chairs = [Piece(f"chair_0{n}", "dining chair", x, 0.0, (0.5, 0.45, 0.9)) for n, x in enumerate((-0.7, 0.7))]
    assert faults("dining_room", table, *chairs) == []
    assert len(faults("dining_room", table, chairs[0])) == 1
    desk = Piece("table_00", "desk", 0.0, 0.0, (0.6, 1.2, 0.75))
    assert faults("office", desk, chairs[0]) == []
    assert faults("office", desk) == ["room_office_00 has table_00, a desk without a chair"]


def test_a_bed_has_free_floor_along_a_long_side() -> None:
    bed = Piece("bed_00", "bed", -1.9, -1.2, (2.0, 1.4, 0.5))
    chest = Piece("chest_of_drawers_00", "chest of drawers", -1.8, -0.25, (0.4, 0.4, 0.9))
    stand = Piece("table_00", "nightstand", -2.7, -0.3, (0.4, 0.35, 0.5))
    assert faults("bedroom", bed, stand) == []
    assert faults("bedroom", bed, moved(stand, 0.0, 1.0)) == [
        "room_bedroom_00 has table_00, a nightstand that is next to no bed and no seat"
    ]
    assert len(faults("bedroom", bed, chest)) == 1


def test_nothing_tall_and_no_fireplace_stands_before_a_window() -> None:
    window = Piece("window_00", "window", 0.0, 2.05, (0.1, 1.2, 1.1), NORTH, 0.95)
    wardrobe = Piece("cabinet_00", "wardrobe", 0.0, 1.65, (0.6, 1.5, 2.0), SOUTH)
    low = Piece("cabinet_00", "sideboard", 0.0, 1.75, (0.4, 1.5, 0.8), SOUTH)
    hearth = Piece("fireplace_00", "fireplace", 0.0, 1.75, (0.4, 1.2, 0.9), SOUTH)
    assert faults("dining_room", window, low) == []
    for piece in (wardrobe, hearth):
        assert faults("dining_room", window, piece) == [f"{piece.label} stands in front of window_00"]
        assert faults("dining_room", window, moved(piece, 1.9, 0.0)) == []


def faults_of(model: mujoco.MjModel, data: mujoco.MjData) -> list[str]:
    labels = read_labels(model, ignore_prefix="")
    return arrangement_faults(model, data, labels, read_rooms(model), read_standing(model, data, labels))


def swing(*pieces: Piece) -> list[str]:
    """Returns the faults of a room with a door in the west wall, its leaf open by 80 degrees into the room."""
    spec = room(6, 4).spec
    frame = spec.worldbody.add_body(name="door_00", pos=(-3.0, 0.45, 0.0), quat=(0.5**0.5, 0, 0, 0.5**0.5))
    for x_m in (-0.45, 0.45):
        frame.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, pos=(x_m, 0.0, 1.0), size=(0.02, 0.06, 1.0))
    yaw = NORTH - math.radians(80)
    leaf = spec.worldbody.add_body(
        name="door_01", pos=(-2.95, 0.0, 0.0), quat=(math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2))
    )
    leaf.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, pos=(0.42, 0.0, 1.0), size=(0.42, 0.02, 1.0))
    limits = mujoco.mjtLimited.mjLIMITED_TRUE
    leaf.add_joint(type=mujoco.mjtJoint.mjJNT_HINGE, axis=(0.0, 0.0, -1.0), limited=limits, range=(-80.0, 0.0))
    for piece in pieces:
        half = [0.5 * size for size in piece.size_m]
        body = spec.worldbody.add_body(name=piece.label, pos=(piece.x_m, piece.y_m, half[2]))
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=half)
    model = spec.compile()
    data = data_at_rest(model)
    return faults_of(model, data)


def test_nothing_stands_where_a_leaf_swings() -> None:
    plant = Piece("plant_00", "potted plant", -2.5, 0.5, (0.3, 0.3, 1.0))
    assert swing(plant) == ["plant_00 stands where door_01 swings"]
    assert swing(moved(plant, 1.0, 0.0)) == []
    assert swing(moved(plant, 0.0, -1.0)) == []  # behind the hinge


@pytest.mark.parametrize(
    ("label", "name"), [("sink_00", "washbasin"), ("shower_00", "shower"), ("cabinet_00", "vanity cabinet")]
)
def test_a_toilet_stands_apart_from_other_fixtures(label: str, name: str) -> None:
    toilet = moved(TOILET, 0.0, 0.86)
    fixture = Piece(label, name, -2.72, 1.72, (0.5, 0.5, 0.85))
    assert faults("bathroom", moved(toilet, 0.0, -0.1), fixture) == []
    assert faults("bathroom", moved(toilet, 0.0, 0.32), fixture) == [
        f"room_bathroom_00 has 0.10 m between toilet_00 and {label}, which must be 0.2 m"
    ]


@pytest.mark.parametrize("kind", ["bedroom", "living_room", "office"])
def test_no_seat_stands_below_or_right_before_a_screen(kind: str) -> None:
    chair = Piece("chair_00", "armchair", 2.0, 0.0, (0.8, 0.8, 0.9))
    found = [fault for fault in faults(kind, SOFA, SCREEN, chair) if "chair_00" in fault]
    assert found == [f"room_{kind}_00 has chair_00 in front of tv_monitor_00"]
    for clear in (moved(chair, -0.6, 0.0), moved(chair, 0.0, 1.2)):
        assert not any("chair_00" in fault for fault in faults(kind, SOFA, SCREEN, clear))


def test_only_a_coffee_table_stands_between_sofa_and_screen() -> None:
    table = Piece("table_00", "coffee table", -0.8, 0.3, (0.6, 1.0, 0.4))
    assert faults("living_room", SOFA, SCREEN, table) == []
    desk = replace(table, name="console table")
    assert faults("living_room", SOFA, SCREEN, desk) == [
        "room_living_room_00 has table_00 between sofa_00 and tv_monitor_00"
    ]
    assert faults("living_room", SOFA, SCREEN, moved(desk, 0.0, 1.0)) == []


def test_two_dining_tables_stand_far_apart() -> None:
    tables = [Piece(f"table_0{n}", "dining table", x, 0.0, (0.8, 0.8, 0.75)) for n, x in enumerate((-2.1, 2.0))]
    chairs = [
        Piece(f"chair_0{2 * n + m}", "dining chair", table.x_m, y, (0.5, 0.45, 0.9), NORTH)
        for n, table in enumerate(tables)
        for m, y in enumerate((-0.7, 0.7))
    ]
    assert faults("dining_room", *tables, *chairs) == []
    near = [*tables[:1], *chairs[:2], *(moved(piece, -0.6, 0.0) for piece in (tables[1], *chairs[2:]))]
    assert faults("dining_room", *near) == ["table_00 and table_01 are dining tables 3.5 m apart, which must be 4 m"]


def test_a_fixture_stands_apart_from_a_leaf_that_is_wide_open() -> None:
    toilet = Piece("toilet_00", "", -2.1, -0.3, (0.38, 0.5, 0.8))
    assert swing(moved(toilet, 0.0, -0.1)) == []
    assert swing(toilet) == ["toilet_00 stands where door_01 swings"]
    assert swing(replace(toilet, label="chest_of_drawers_00")) == []


def floors(kind: str, texture: str) -> list[str]:
    """Returns the faults of a room with this floor next to a living room with a floor of stone."""
    spec = mujoco.MjSpec()
    for name in {texture, "stone"}:
        spec.add_texture(
            name=name, type=mujoco.mjtTexture.mjTEXTURE_2D, builtin=mujoco.mjtBuiltin.mjBUILTIN_FLAT, width=8, height=8
        )
        spec.add_material(name=name).textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = name
    box = mujoco.mjtGeom.mjGEOM_BOX
    for n, (room_kind, floor) in enumerate(((kind, texture), ("living_room", "stone"))):
        body = spec.worldbody.add_body(name=f"floor_0{n}", pos=(4.1 * n, 0.0, -0.05))
        body.add_geom(type=box, size=(2.0, 2.0, 0.05), material=floor)
        spec.worldbody.add_site(name=f"room_{room_kind}_00", type=box, pos=(4.1 * n, 0, 1.25), size=(2.0, 2.0, 1.25))
    model = spec.compile()
    data = data_at_rest(model)
    found = faults_of(model, data)
    return [fault for fault in found if "sofa" not in fault]


def test_the_floor_of_a_kitchen_is_hard_and_not_that_of_the_living_room() -> None:
    assert floors("kitchen", "tiles_square") == []
    assert floors("kitchen", "stone") == ["room_kitchen_00 has the floor of room_living_room_00"]
    assert floors("dining_room", "stone") == []
    for kind in ("kitchen", "studio"):
        assert floors(kind, "carpet_loop") == [f"room_{kind}_00 has carpet on its whole floor"]


@pytest.mark.costly
@pytest.mark.parametrize("seed", [4, 8])
def test_a_generated_house_follows_all_rules_until_a_chair_is_taken_away(seed: int) -> None:
    spec = generate(seed, kind="flat")
    for kept in (True, False):
        if not kept:
            for body in [body for body in spec.worldbody.bodies if body.name.startswith("chair_")]:
                spec.delete(body)
        model = spec.compile()
        data = data_at_rest(model)
        found = faults_of(model, data)
        assert (found == []) == kept
