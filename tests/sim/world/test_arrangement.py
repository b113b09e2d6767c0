"""Furniture must stand as dwelling design wants it; each rule on a room that follows it and on one that does not."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import pytest

from sim.gl import mujoco
from sim.homes.housegen.generator import generate
from sim.houses.house import read_rooms
from sim.houses.labels import read_labels
from sim.world.arrangement import arrangement_faults
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
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    return arrangement_faults(model, data, read_labels(model, ignore_prefix=""), read_rooms(model))


# A run along the south wall: fridge, worktop with a sink, cooker, worktop.
FRIDGE = Piece("appliances_00", "fridge", -2.0, -1.67, (0.62, 0.6, 1.8), NORTH)
SINK_TOP = Piece("counter_00", "kitchen counter", -0.9, -1.67, (0.62, 1.58, 0.9), NORTH)
SINK = Piece("sink_00", "kitchen sink", -0.9, -1.67, (0.4, 0.5, 0.2), NORTH, 0.72)
COOKER = Piece("appliances_01", "cooker", 0.2, -1.67, (0.62, 0.6, 0.9), NORTH)
END_TOP = Piece("counter_01", "kitchen counter", 0.9, -1.67, (0.62, 0.78, 0.9), NORTH)
KITCHEN = (FRIDGE, SINK_TOP, SINK, COOKER, END_TOP)


def moved(piece: Piece, dx_m: float, dy_m: float) -> Piece:
    return replace(piece, x_m=piece.x_m + dx_m, y_m=piece.y_m + dy_m)


def test_a_run_with_worktop_between_has_no_fault() -> None:
    assert faults("kitchen", *KITCHEN) == []


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


def test_no_wall_cabinet_hangs_above_the_hob() -> None:
    cabinet = Piece("cabinet_00", "wall cabinet", -0.9, -1.83, (0.34, 1.5, 0.7), NORTH, 1.45)
    assert faults("kitchen", *KITCHEN, cabinet) == []
    assert faults("kitchen", *KITCHEN, moved(cabinet, 1.1, 0.0)) == ["room_kitchen_00 has cabinet_00 above its hob"]


SOFA = Piece("sofa_00", "sofa", -2.4, 0.0, (0.9, 2.0, 0.8))
SCREEN = Piece("tv_monitor_00", "television", 2.8, 0.0, (0.1, 1.2, 0.7), WEST, 0.9)


def test_a_sofa_faces_something() -> None:
    assert faults("living_room", SOFA, SCREEN) == []
    (fault,) = faults("living_room", SOFA, moved(SCREEN, -5.5, 0.0))
    assert "which faces neither" in fault


def test_a_living_room_has_a_sofa_or_two_armchairs() -> None:
    chairs = [Piece(f"chair_0{n}", "armchair", n - 1.0, 0.0, (0.8, 0.8, 0.9)) for n in range(2)]
    assert faults("living_room", *chairs) == []
    assert faults("living_room", chairs[0]) == ["room_living_room_00 has no sofa and no two armchairs"]


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


def test_a_toilet_has_free_floor_in_front() -> None:
    toilet = Piece("toilet_00", "toilet", -2.6, 0.0, (0.7, 0.38, 0.8))
    basin = Piece("sink_00", "washbasin", -1.7, 0.0, (0.4, 0.5, 0.85), WEST)
    assert faults("bathroom", toilet, moved(basin, 0.3, 0.0)) == []
    assert faults("bathroom", toilet, basin) == [
        "room_bathroom_00 has less than 0.6 m of free floor in front of toilet_00"
    ]


def test_nothing_tall_and_no_fireplace_stands_before_a_window() -> None:
    window = Piece("window_00", "window", 0.0, 2.05, (0.1, 1.2, 1.1), NORTH, 0.95)
    wardrobe = Piece("cabinet_00", "wardrobe", 0.0, 1.65, (0.6, 1.5, 2.0), SOUTH)
    low = Piece("cabinet_00", "sideboard", 0.0, 1.75, (0.4, 1.5, 0.8), SOUTH)
    hearth = Piece("fireplace_00", "fireplace", 0.0, 1.75, (0.4, 1.2, 0.9), SOUTH)
    assert faults("dining_room", window, low) == []
    for piece in (wardrobe, hearth):
        assert faults("dining_room", window, piece) == [f"{piece.label} stands in front of window_00"]
        assert faults("dining_room", window, moved(piece, 1.9, 0.0)) == []


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
    for piece in pieces:
        half = [0.5 * size for size in piece.size_m]
        body = spec.worldbody.add_body(name=piece.label, pos=(piece.x_m, piece.y_m, half[2]))
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=half)
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    return arrangement_faults(model, data, read_labels(model, ignore_prefix=""), read_rooms(model))


def test_nothing_stands_where_a_leaf_swings() -> None:
    plant = Piece("plant_00", "potted plant", -2.5, 0.5, (0.3, 0.3, 1.0))
    assert swing(plant) == ["plant_00 stands where door_01 swings"]
    assert swing(moved(plant, 1.0, 0.0)) == []
    assert swing(moved(plant, 0.0, -1.0)) == []  # behind the hinge


@pytest.mark.parametrize("seed", [3, 20])
def test_a_generated_house_follows_all_rules_until_a_chair_is_taken_away(seed: int) -> None:
    spec = generate(seed, kind="flat")
    for kept in (True, False):
        if not kept:
            for body in [body for body in spec.worldbody.bodies if body.name.startswith("chair_")]:
                spec.delete(body)
        model = spec.compile()
        data = mujoco.MjData(model)
        mujoco.mj_kinematics(model, data)
        found = arrangement_faults(model, data, read_labels(model, ignore_prefix=""), read_rooms(model))
        assert (found == []) == kept
