"""The check finds what is wrong, and nothing where nothing is."""

from __future__ import annotations

from sim.houses.house import House
from sim.world.check import check_house
from tests.helpers.worlds import room, with_box


def table(house: House, *, x_m: float = 0.0, z_m: float = 0.4, name: str = "table_00") -> House:
    return with_box(house, name, centre_m=(x_m, 0.0, z_m), half_m=(0.3, 0.3, 0.4))


def test_a_room_with_a_table_is_without_fault() -> None:
    assert check_house(table(room(5, 4)).spec) == []


def test_two_things_in_one_place_are_found() -> None:
    both = table(table(room(5, 4)), x_m=0.55, name="bed_00")
    assert check_house(both.spec) == ["table_00 and bed_00 run into each other by 5.0 cm"]


def test_things_that_just_meet_are_let_pass() -> None:
    assert check_house(table(table(room(5, 4)), x_m=0.6, name="bed_00").spec) == []


def test_furniture_in_a_wall_is_found() -> None:
    (fault,) = check_house(table(room(5, 4), x_m=2.3).spec)
    assert "wall" in fault
    assert "table_00" in fault


def test_a_thing_in_the_air_is_found() -> None:
    assert "table_00 touches nothing" in check_house(table(room(5, 4), z_m=1.2).spec)


def test_a_room_cut_in_two_is_found() -> None:
    house = with_box(room(6, 4), "bed_00", centre_m=(-0.8, 0.0, 0.5), half_m=(0.3, 2.0, 0.5))
    assert "part of room_living_00 is cut off" in check_house(house.spec)


def test_a_goal_that_cannot_be_approached_is_found() -> None:
    house = room(6, 4)
    for n, (x, y, hx, hy) in enumerate([(2.0, 0.0, 0.1, 2.0), (0.9, 0.0, 0.1, 2.0)]):
        house = with_box(house, f"bed_{n:02d}", centre_m=(x, y, 0.5), half_m=(hx, hy, 0.5))
    house = with_box(house, "plant_00", centre_m=(2.8, 0.0, 0.2), half_m=(0.1, 0.1, 0.2))
    assert "the robot gets near no plant" in check_house(house.spec)


def test_a_house_without_room_sites_is_found() -> None:
    spec = room(4, 4).spec.copy()
    for site in list(spec.sites):
        spec.delete(site)
    assert check_house(spec) == ["it has no room sites"]
