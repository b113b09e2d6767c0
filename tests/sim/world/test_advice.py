"""Advice on the design of a home: each rule on a home that needs no change, and on one that does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sim.houses.house import Room
from sim.world.advice import MAX_ALIKE, advice
from sim.world.check import advise_house, check_house
from sim.world.standing import Standing
from tests.helpers.worlds import room

EAST, NORTH, SOUTH, WEST = (1.0, 0.0), (0.0, 1.0), (0.0, -1.0), (-1.0, 0.0)


def piece(
    label: str,
    name: str,
    middle_m: tuple[float, float],
    size_m: tuple[float, float, float],
    front: tuple[float, float] = SOUTH,
    z_m: float = 0.0,
) -> Standing:
    """Returns an item with a middle in plan and a size along x, y and z; its category is that of its label."""
    middle, half = np.array(middle_m), 0.5 * np.array(size_m)
    low = np.array([*(middle - half[:2]), z_m])
    return Standing(label, name, label[:-3], low, low + size_m, np.array(front))


def moved(item: Standing, dx_m: float, dy_m: float) -> Standing:
    step = np.array([dx_m, dy_m, 0.0])
    return replace(item, low=item.low + step, high=item.high + step)


def told(kind: str, *pieces: Standing) -> list[str]:
    """Returns the advice on a room of 6 x 4 m around the origin with these pieces."""
    return advice([Room(f"room_{kind}_00", kind, (((0.0, 0.0, 1.25), (3.0, 2.0, 1.25)),))], pieces)


TABLE = piece("table_00", "dining table", (0.0, 0.0), (1.2, 0.8, 0.75))
CHAIRS = (
    piece("chair_00", "dining chair", (-0.3, 0.6), (0.45, 0.5, 0.9), SOUTH),
    piece("chair_01", "dining chair", (0.3, 0.6), (0.45, 0.5, 0.9), SOUTH),
    piece("chair_02", "dining chair", (0.0, -0.6), (0.45, 0.5, 0.9), NORTH),
)


def home(*pieces: Standing, bedrooms: int) -> list[str]:
    """Returns the advice on a home with this number of empty bedrooms, and pieces outside of them."""
    boxes = [((100.0 + 9.0 * n, 0.0, 1.25), (3.0, 2.0, 1.25)) for n in range(bedrooms)]
    return advice([Room(f"room_bedroom_0{n}", "bedroom", (box,)) for n, box in enumerate(boxes)], pieces)


def test_a_home_has_one_seat_more_than_bedrooms_at_a_table() -> None:
    assert home(TABLE, *CHAIRS, bedrooms=2) == []
    assert home(TABLE, *CHAIRS, bedrooms=3) == [
        "the home has 3 seats at its largest dining table instead of at least 4"
    ]
    assert home(bedrooms=1) == ["the home has 0 seats at its largest dining table instead of at least 2"]


def test_five_people_have_two_toilets() -> None:
    beds = [piece(f"bed_0{n}", "bed", (3.0 * n, 9.0), (1.6, 2.0, 0.5), NORTH) for n in range(3)]
    toilets = [piece(f"toilet_0{n}", "toilet", (9.0, 9.0 + n), (0.4, 0.7, 0.8)) for n in range(2)]
    assert home(TABLE, *CHAIRS, *beds, *toilets, bedrooms=1) == []
    assert home(TABLE, *CHAIRS, *beds[:2], *toilets[:1], bedrooms=1) == []
    assert home(TABLE, *CHAIRS, *beds, *toilets[:1], bedrooms=1) == ["the home has one toilet for 6 sleeping places"]


# A run along the south wall: fridge, worktop with a sink, cooker.
KITCHEN = (
    piece("appliances_00", "fridge", (-2.0, -1.67), (0.6, 0.62, 1.8), NORTH),
    piece("counter_00", "kitchen counter", (-0.9, -1.67), (1.58, 0.62, 0.9), NORTH),
    piece("sink_00", "kitchen sink", (-0.9, -1.67), (0.5, 0.4, 0.2), NORTH, 0.72),
    piece("appliances_01", "cooker", (0.2, -1.67), (0.6, 0.62, 0.9), NORTH),
)


def test_the_legs_of_the_work_triangle_are_short() -> None:
    assert told("kitchen", *KITCHEN) == []
    assert told("kitchen", *KITCHEN[:3], moved(KITCHEN[3], 0.7, 0.0)) == [
        "room_kitchen_00 has 2.9 m between fridge and cooker or hob, which must be at most 2.7 m"
    ]


def test_worktop_lies_next_to_a_sink() -> None:
    short = piece("counter_00", "kitchen counter", (-0.9, -1.67), (1.1, 0.62, 0.9), NORTH)
    beside = piece("counter_01", "kitchen counter", (-0.1, -1.67), (0.5, 0.62, 0.9), NORTH)
    fridge, _, sink, cooker = KITCHEN
    assert told("kitchen", fridge, short, sink, cooker) == [
        "room_kitchen_00 has 0.30 m of worktop on the longer side of sink_00, which must be 0.45 m"
    ]
    assert told("kitchen", fridge, short, sink, beside, moved(cooker, 0.3, 0.0)) == []
    assert len(told("kitchen", fridge, short, sink, moved(beside, 0.3, 0.0), moved(cooker, 0.3, 0.0))) == 1


def test_a_diner_has_room_behind_the_chair() -> None:
    chest = piece("chest_of_drawers_00", "chest of drawers", (0.0, 1.4), (1.0, 0.4, 0.9))
    assert told("dining_room", TABLE, *CHAIRS, chest) == []
    assert told("dining_room", TABLE, *CHAIRS, moved(chest, 0.0, -0.25)) == [
        "room_dining_room_00 has 0.55 m from table_00 to what is behind chair_00, which must be 0.65 m"
    ]
    assert told("dining_room", moved(TABLE, 0.0, 1.1), moved(CHAIRS[0], 0.0, 1.1), moved(CHAIRS[1], 0.0, 1.1)) == [
        "room_dining_room_00 has 0.50 m from table_00 to what is behind chair_00, which must be 0.65 m"
    ]


def test_a_wardrobe_can_be_opened() -> None:
    wardrobe = piece("cabinet_00", "wardrobe", (0.0, 1.7), (1.2, 0.6, 2.0), SOUTH)
    chest = piece("chest_of_drawers_00", "chest of drawers", (0.0, 0.5), (0.8, 0.5, 0.9), EAST)
    assert told("bedroom", wardrobe, chest)[1:] == []
    (fault,) = told("bedroom", wardrobe, moved(chest, 0.0, 0.2))[1:]
    assert fault == "room_bedroom_00 has 0.45 m of free floor before cabinet_00, which must be 0.55 m"
    assert told("bedroom", wardrobe, moved(chest, 0.9, 0.2))[1:] == []  # before a small part of its width


def test_few_small_objects_of_a_room_are_alike() -> None:
    racks = [piece(f"objects_0{n}", "spice rack", (0.4 * n, 0.0), (0.2, 0.2, 0.1)) for n in range(MAX_ALIKE + 1)]
    assert told("kitchen", *racks[1:]) == []
    assert told("kitchen", *racks) == ["room_kitchen_00 has 5 objects of the kind spice rack"]


def test_a_bench_in_the_middle_of_a_room_has_company() -> None:
    bench = piece("seating_00", "bench", (0.0, 0.0), (1.0, 0.4, 0.45))
    expected = ["room_living_room_00 has seating_00, which stands alone in the middle of the room"]
    assert told("living_room", bench) == expected
    assert told("living_room", moved(bench, 0.0, 1.6)) == []
    for table in (TABLE, piece("counter_00", "kitchen island", (0.0, 0.0), (1.6, 0.9, 0.9))):
        assert told("living_room", bench, moved(table, 0.0, 1.5)) == []


def test_a_rack_of_dumbbells_stands_at_a_wall() -> None:
    rack = piece("gym_equipment_00", "dumbbell rack", (0.0, 0.0), (1.2, 0.5, 0.8))
    assert told("gym", moved(rack, 0.0, 1.7)) == []
    assert told("gym", rack) == ["room_gym_00 has gym_equipment_00, which stands alone in the middle of the room"]


@pytest.mark.parametrize("label", ["picture_00", "mirror_00"])
def test_furniture_hides_nothing_on_a_wall(label: str) -> None:
    hung = piece(label, label[:-3], (0.0, 1.98), (0.6, 0.04, 0.8), SOUTH, 1.1)
    wardrobe = piece("cabinet_00", "wardrobe", (0.5, 1.6), (1.2, 0.6, 2.0), WEST)
    assert told("office", hung, moved(wardrobe, 0.45, 0.0)) == []
    assert told("office", hung, wardrobe) == [f"{label} hangs behind cabinet_00"]
    assert told("office", hung, moved(wardrobe, 0.0, 0.73)) == []  # on the other side of the wall
    assert told("office", hung, moved(wardrobe, 0.0, -0.4)) == []


RUG = piece("floor_01", "rug", (0.0, 0.0), (2.0, 1.4, 0.01))
ROUND = piece("floor_01", "rug", (0.0, 0.0), (2.0, 2.0, 0.01))


def test_no_rug_lies_at_a_fire() -> None:
    stove = piece("fireplace_00", "wood stove", (1.6, 0.0), (0.8, 0.8, 1.2))
    assert told("gym", RUG, stove) == []
    assert told("gym", RUG, moved(stove, -0.18, 0.0)) == ["the rug floor_01 lies 0.02 m from fireplace_00"]
    corner = moved(stove, -0.35, 1.25)
    assert told("gym", ROUND, corner) == []  # the corner of its box is not a part of a round rug
    assert told("gym", replace(ROUND, high=ROUND.high + np.array([0.1, 0.0, 0.0])), corner) != []


def test_furniture_stands_level_beside_or_on_a_rug() -> None:
    chest = piece("chest_of_drawers_00", "chest of drawers", (0.0, 0.95), (1.0, 0.4, 0.9))
    expected = ["chest_of_drawers_00 stands only partly on the rug floor_01"]
    assert told("gym", RUG, chest) == []
    assert told("gym", RUG, moved(chest, 0.0, -0.2)) == expected
    assert told("gym", RUG, moved(chest, 0.0, -0.6)) == []
    assert told("gym", ROUND, moved(chest, 1.25, 0.0)) == []
    assert told("gym", RUG, moved(replace(chest, name="nightstand"), 0.0, -0.2)) == []


def test_a_house_has_no_fault_for_what_is_only_advice() -> None:
    """A bedroom alone: the home has no table to eat at, and its file no other fault."""
    spec = room(6, 4).spec
    spec.site("room_living_00").name = "room_bedroom_00"
    assert check_house(spec) == []
    assert advise_house(spec) == ["the home has 0 seats at its largest dining table instead of at least 2"]
