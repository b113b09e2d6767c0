"""The floor plans of generated homes must keep the rules for rooms, sizes and doors."""

from __future__ import annotations

from collections.abc import Mapping

import pytest

from sim.gl import mujoco
from sim.homes.housegen.generator import HouseConfig, generate_house
from sim.houses.geoms import data_at_rest
from sim.houses.house import Room, read_rooms
from sim.houses.labels import read_labels
from sim.world.check import check_house
from sim.world.plan_requirements import HALLWAY_M, ROOM_SIZES, USUAL_M2, Doorway, measured, plan_faults
from tests.helpers.worlds import room, with_box

Rect = tuple[float, float, float, float]
HOME: dict[str, Rect] = {
    "hallway_00": (0.0, 0.0, 8.0, 1.2),
    "bedroom_00": (0.0, 1.3, 3.5, 5.3),
    "bathroom_00": (3.6, 1.3, 5.6, 3.6),
    "bedroom_01": (5.7, 1.3, 8.0, 5.3),
    "living_room_00": (0.0, -4.1, 5.0, -0.1),
    "kitchen_00": (5.1, -4.1, 8.0, -0.1),
}
"""Smallest and largest x and y between the walls; walls are 10 cm thick."""
DOORS = {
    "bedroom_00": Doorway((1.0, 1.25), 0.9, along_x=True),
    "bathroom_00": Doorway((4.5, 1.25), 0.9, along_x=True),
    "bedroom_01": Doorway((7.0, 1.25), 0.9, along_x=True),
    "living_room_00": Doorway((1.0, -0.05), 0.9, along_x=True),
    "kitchen_00": Doorway((6.0, -0.05), 0.9, along_x=True),
}


WINDOWS = {
    "bedroom_00": Doorway((1.5, 5.35), 1.2, along_x=True),
    "bedroom_01": Doorway((7.0, 5.35), 1.2, along_x=True),
    "living_room_00": Doorway((2.0, -4.15), 1.2, along_x=True),
}


def rooms_of(home: dict[str, Rect]) -> list[Room]:
    rooms = []
    for name, (x0, y0, x1, y1) in home.items():
        box = ((0.5 * (x0 + x1), 0.5 * (y0 + y1), 1.2), (0.5 * (x1 - x0), 0.5 * (y1 - y0), 1.2))
        rooms.append(Room(f"room_{name}", name.rsplit("_", 1)[0], (box,)))
    return rooms


def faults(
    rooms: Mapping[str, Rect | None] | None = None, doors: Mapping[str, Doorway | None] | None = None
) -> list[str]:
    """Returns the faults of `HOME` with other rooms and doors; None removes one."""
    home = {name: rect for name, rect in {**HOME, **(rooms or {})}.items() if rect is not None}
    found = plan_faults(
        rooms_of(home), [door for door in {**DOORS, **(doors or {})}.values() if door is not None], WINDOWS.values()
    )
    new = set(home) - set(HOME)  # rooms that a test adds have no windows
    return [fault for fault in found if fault not in {f"room_{name} has no window" for name in new}]


def test_a_usual_home_has_no_fault() -> None:
    assert faults() == []


@pytest.mark.parametrize("kind", ["bathroom", "kitchen", "living_room"])
def test_a_missing_kind_of_room_is_reported(kind: str) -> None:
    assert f"the home has no {kind.replace('_', ' ')}" in faults({f"{kind}_00": None}, {f"{kind}_00": None})


def test_a_studio_needs_only_a_bathroom() -> None:
    studio = rooms_of({"studio_00": (0.0, 0.0, 6.0, 5.0), "bathroom_00": (6.1, 0.0, 8.2, 2.5)})
    door, window = Doorway((6.05, 1.0), 0.9, along_x=False), Doorway((3.0, -0.1), 1.2, along_x=True)
    assert plan_faults(studio, [door], [window]) == []
    assert plan_faults(studio[:1], [], [window]) == ["the home has no bathroom"]
    assert plan_faults(studio, [door], []) == ["room_studio_00 has no window"]


def test_more_bathrooms_than_bedrooms_and_one_for_guests_are_reported() -> None:
    further: dict[str, Rect | None] = {f"bathroom_0{n}": (10.0 + 3 * n, 0.0, 12.0 + 3 * n, 2.5) for n in (1, 2)}
    assert faults(further) == []
    (fault,) = faults(further | {"bathroom_03": (20.0, 0.0, 22.0, 2.5)})
    assert "4 rooms of the kind bathroom for 2 bedrooms" in fault


def test_a_second_laundry_and_too_few_bedrooms_are_reported() -> None:
    laundries: dict[str, Rect | None] = {f"laundry_0{n}": (10.0 + 3 * n, 0.0, 12.0 + 3 * n, 2.5) for n in (1, 2)}
    (fault,) = faults(laundries)
    assert "2 rooms of the kind laundry instead of at most 1" in fault
    large: dict[str, Rect | None] = {"dining_room_00": (10.0, 0.0, 15.0, 5.0), "bedroom_01": None}
    (fault,) = faults(large | {"living_room_01": (10.0, 6.0, 17.0, 12.0)}, {"bedroom_01": None})
    assert "has 1 bedroom instead of at least 2" in fault


@pytest.mark.parametrize(
    ("kind", "rect", "clause"),
    [
        ("bathroom", (10.0, 0.0, 13.75, 4.0), "has 15.0 m2 instead of 2.5 to 9 m2"),
        ("bedroom", (10.0, 0.0, 14.0, 2.0), "is only 2.00 m wide instead of 2.15 m"),
        ("living_room", (10.0, 0.0, 17.0, 3.0), "is 2.3 times as long as wide instead of 2.2 times"),
        ("hallway", (10.0, 0.0, 15.0, 0.8), "is only 0.80 m wide instead of 0.9 m"),
        ("hallway", (10.0, 0.0, 26.0, 1.0), "is 16.0 m long instead of at most 15.0 m"),
    ],
)
def test_sizes_out_of_range_are_reported(kind: str, rect: Rect, clause: str) -> None:
    assert f"room_{kind}_09 {clause}" in faults({f"{kind}_09": rect})


def test_hallways_that_take_a_large_share_are_reported() -> None:
    assert "hallways take 24 of 83 m2" in faults({"hallway_01": (10.0, 0.0, 20.0, 1.4)})


def test_a_long_hallway_suits_a_large_home_only() -> None:
    hallway: dict[str, Rect | None] = {"hallway_01": (0.0, 50.0, HALLWAY_M[1] + 1.0, 51.0)}
    assert any("instead of at most" in fault for fault in faults(hallway))
    wings: dict[str, Rect | None] = {f"dining_room_0{n}": (20.0 + 6 * n, 0.0, 25.0 + 6 * n, 5.0) for n in range(12)}
    assert sum(25.0 for _ in wings) >= USUAL_M2
    assert not any("m long" in fault for fault in faults(hallway | wings))


def test_hallways_in_one_line_count_as_one() -> None:
    line: dict[str, Rect | None] = {"hallway_01": (0.0, 50.0, 9.0, 51.0), "hallway_02": (9.1, 50.0, 17.0, 51.0)}
    fault = "room_hallway_01 and room_hallway_02 are 17.0 m long instead of at most 15.0 m"
    assert fault in faults(line)
    assert not any("m long" in fault for fault in faults(line | {"hallway_02": (9.1, 51.0, 17.0, 52.0)}))


def test_a_bedroom_has_one_bathroom_of_its_own() -> None:
    doors: dict[str, Doorway] = {"first": Doorway((3.55, 2.8), 0.9, along_x=False)}
    further: dict[str, Rect | None] = {"bathroom_01": (0.0, 5.4, 2.2, 7.5)}
    assert faults(further, doors) == []
    second = {"second": Doorway((1.0, 5.35), 0.9, along_x=True)}
    assert faults(further, doors | second) == ["room_bedroom_00 has doors to 2 bathrooms"]


def test_many_doors_in_one_wall_are_reported() -> None:
    doors = {f"south_{n}": Doorway((0.5 + n * 1.2, -0.05), 0.9, along_x=True) for n in range(6)}
    (fault, *_) = [fault for fault in faults(doors=doors) if "hallway" in fault]
    assert fault == "room_hallway_00 has 8 doors in a wall of 8.0 m"


def test_doors_that_open_onto_each_other_are_reported() -> None:
    corner = Doorway((3.55, 1.8), 0.9, along_x=False)  # from the bedroom, next to its own door
    doors = {"corner": corner, "bedroom_00": Doorway((3.0, 1.25), 0.9, along_x=True)}
    apart = {"bathroom_00": Doorway((5.1, 1.25), 0.9, along_x=True)}
    assert faults(doors=doors | apart) == ["two doors of room_bedroom_00 open onto each other"]


def test_a_bathroom_off_the_kitchen_and_a_captive_bedroom_are_reported() -> None:
    behind: dict[str, Rect | None] = {"bathroom_01": (8.1, -4.1, 10.2, -2.0), "bedroom_02": (0.0, 5.4, 3.5, 9.4)}
    doors: dict[str, Doorway | None] = {
        "bathroom_01": Doorway((8.05, -3.0), 0.9, along_x=False), "bedroom_02": Doorway((1.0, 5.35), 0.9, along_x=True)
    }  # fmt: skip
    assert faults(behind, doors) == [
        "room_bathroom_01 opens off a kitchen",
        "room_bedroom_02 is entered only through a bedroom",
    ]


def test_one_bathroom_must_open_off_a_hallway() -> None:
    ensuite = Doorway((3.55, 2.8), 0.9, along_x=False)
    assert faults(doors={"bathroom_00": ensuite}) == ["no bathroom has a door to a hallway"]


def doors_of(spec: mujoco.MjSpec) -> list[Doorway]:
    model = spec.compile()
    data = data_at_rest(model)
    return measured("door", model, data, read_labels(model), read_rooms(model))


@pytest.mark.costly
@pytest.mark.parametrize("seed", [2, 3])
def test_the_doors_of_a_compiled_house_are_those_that_were_drawn(seed: int) -> None:
    house = generate_house(seed, HouseConfig(kind="flat", area_m2=90.0, clutter=0.0))
    rooms, doors = read_rooms(house.spec.compile()), doors_of(house.spec)
    names = [room.name for room in house.plan.rooms]
    drawn = {frozenset((names[join.a], names[join.b])): join.kind for join in house.plan.joins}
    beside = []
    for door in doors:
        assert 0.8 < door.width_m < 1.1
        sides = [place.name for place in rooms for sign in (-1.0, 1.0) if place.contains(*door.side_point(sign))]
        beside.append(frozenset(sides))
    assert sum(len(sides) == 1 for sides in beside) == 1, "one front door"
    assert len(set(beside)) == len(beside)
    assert {sides for sides in beside if len(sides) == 2} <= set(drawn)
    assert {sides for sides, kind in drawn.items() if kind == "door"} <= set(beside)


def test_a_glass_door_that_is_a_hazard_is_no_door_of_the_plan() -> None:
    box = mujoco.mjtGeom.mjGEOM_BOX
    spec = with_box(room(4, 4), "door_00", centre_m=(2.05, 0.0, 1.0), half_m=(0.02, 0.4, 1.0)).spec
    (door,) = doors_of(spec)
    assert door.centre_m == pytest.approx((2.05, 0.0))
    assert not door.along_x
    spec.worldbody.add_site(name="hazard_glass_00", type=box, pos=(2.05, 0.0, 1.0), size=(0.02, 0.4, 1.0))
    assert doors_of(spec) == []


def test_the_check_measures_the_sites_of_a_house() -> None:
    spec = generate_house(3, HouseConfig(kind="studio", area_m2=55.0, clutter=0.0)).spec
    assert check_house(spec, furnished=True) == []
    next(site for site in spec.sites if site.name == "room_bathroom_00").size[:2] = (2.5, 2.0)
    low, high = ROOM_SIZES["bathroom"].area_m2
    assert f"room_bathroom_00 has 20.0 m2 instead of {low:g} to {high:g} m2" in check_house(spec, furnished=True)
