"""The check reports each fault of a house, and nothing for a house without faults."""

from __future__ import annotations

import pytest

from sim.gl import mujoco
from sim.houses.house import House
from sim.world.check import check_house, check_own_house
from tests.helpers.worlds import room, with_box, with_facts


def table(house: House, *, x_m: float = 0.0, z_m: float = 0.4, name: str = "table_00") -> House:
    return with_box(house, name, centre_m=(x_m, 0.0, z_m), half_m=(0.3, 0.3, 0.4))


def plant_behind_a_bed(width_m: float) -> House:
    """Returns a room in which a plant (from x = 2.7 m) is 0.2 m behind a bed of a width."""
    bed_m = 0.5 * width_m
    house = with_box(room(6, 4), "bed_00", centre_m=(2.5 - bed_m, 0.0, 0.5), half_m=(bed_m, 2.0, 0.5))
    return with_box(house, "plant_00", centre_m=(2.8, 0.0, 0.2), half_m=(0.1, 0.1, 0.2))


def room_with_a_passage(width_m: float) -> House:
    """Returns a room of 6 x 4 m divided by two beds with a passage between them."""
    house, half_m = room(6, 4), 0.25 * (4.0 - width_m)
    for number, side in enumerate((1.0, -1.0)):
        centre_m = (-0.8, side * (0.5 * width_m + half_m), 0.5)
        house = with_box(house, f"bed_{number:02d}", centre_m=centre_m, half_m=(0.3, half_m, 0.5))
    return house


DIVIDED = with_box(room(6, 4), "bed_00", centre_m=(-0.8, 0.0, 0.5), half_m=(0.3, 2.0, 0.5))


@pytest.mark.parametrize(
    ("house", "faults"),
    [
        (table(room(5, 4)), []),
        (table(table(room(5, 4)), x_m=0.6, name="bed_00"), []),  # they only touch
        (table(table(room(5, 4)), x_m=0.55, name="bed_00"), ["table_00 and bed_00 overlap by 5.0 cm"]),
    ],
    ids=["stands", "touches", "overlaps"],
)
def test_objects_may_touch_and_not_overlap(house: House, faults: list[str]) -> None:
    assert check_house(house.spec) == faults


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("colour: brown", None),
        ("color: brown", "must look like 'name: dining chair; colour: red; material: wood', got 'color: brown'"),
        ("colour: braun", "has colour 'braun'. Available: white, grey"),
    ],
)
def test_a_users_house_with_a_wrong_text_about_an_object_has_a_fault(text: str, fault: str | None) -> None:
    faults, _ = check_own_house(with_facts(table(room(5, 4)), table_00=text))
    if fault is None:
        assert faults == []
    else:
        assert f"the text of instance 'table_00' {fault}" in faults[0]


@pytest.mark.parametrize(
    ("name", "hint"),
    [
        ("side table", None), ("refrigerator", "; a known name is 'fridge'"), ("samovar", "; a known name is 'pot'"),
        ("gizmo", ""),
    ],
)  # fmt: skip
def test_a_name_that_no_goal_can_ask_for_is_remarked(name: str, hint: str | None) -> None:
    faults, remarks = check_own_house(with_facts(table(room(5, 4)), table_00=f"name: {name}"))
    known = f"the name '{name}' of 'table_00' is no everyday name that goals in words know{hint}"
    assert (faults, remarks) == ([], [] if hint is None else [known])


@pytest.mark.parametrize(
    ("name", "remark"),
    [
        ("room_office_01", None),
        ("room_store_01", None),  # a kind that no word of a goal means is allowed
        ("room_bedrom_01", "the kind of 'room_bedrom_01' may be misspelt: goals in words know 'bedroom'"),
        ("Room_office_01", "site 'Room_office_01' is no room: a room is a box site of the world body"),
        ("room_office", "site 'room_office' is no room"),
    ],
)
def test_a_room_of_a_users_house_with_a_doubtful_name_is_remarked(name: str, remark: str | None) -> None:
    house = table(room(5, 4))
    house.spec.worldbody.add_site(name=name, type=mujoco.mjtGeom.mjGEOM_BOX, size=[2.5, 2.0, 1.3], pos=[0.0, 0.0, 1.3])
    faults, remarks = check_own_house(house)
    assert faults == []
    assert [text.startswith(remark or "?") for text in remarks] == ([] if remark is None else [True])


@pytest.mark.parametrize(
    ("house", "fault", "reported"),
    [
        (table(room(5, 4), z_m=1.2), "table_00 has no support", True),
        (table(room(5, 4), x_m=2.2, z_m=1.2), "table_00 has no support", False),  # it hangs on the wall
        (DIVIDED, "the robot cannot reach a part of room_living_00", True),
    ],
    ids=["in the air", "hangs", "divided"],
)
def test_objects_without_support_and_divided_rooms_are_reported(house: House, fault: str, reported: bool) -> None:
    assert (fault in check_house(house.spec)) == reported


def test_furniture_in_a_wall_is_reported() -> None:
    (fault,) = check_house(table(room(5, 4), x_m=2.3).spec)
    assert "wall" in fault
    assert "table_00" in fault


def test_a_goal_category_without_access_is_reported() -> None:
    house = room(6, 4)
    for n, (x, y, hx, hy) in enumerate([(2.0, 0.0, 0.1, 2.0), (0.9, 0.0, 0.1, 2.0)]):
        house = with_box(house, f"bed_{n:02d}", centre_m=(x, y, 0.5), half_m=(hx, hy, 0.5))
    house = with_box(house, "plant_00", centre_m=(2.8, 0.0, 0.2), half_m=(0.1, 0.1, 0.2))
    assert "the robot cannot come near any plant" in check_house(house.spec)


def test_access_to_a_goal_depends_on_what_stands_before_it() -> None:
    assert check_house(plant_behind_a_bed(0.4).spec) == []
    assert check_house(plant_behind_a_bed(0.8).spec) == ["the robot cannot come near any plant"]


def test_access_to_a_room_depends_on_the_width_of_its_passage() -> None:
    assert check_house(room_with_a_passage(0.45).spec) == []
    assert check_house(room_with_a_passage(0.3).spec) == ["the robot cannot reach a part of room_living_00"]


def test_a_house_without_room_sites_is_reported() -> None:
    spec = room(4, 4).spec.copy()
    for site in list(spec.sites):
        spec.delete(site)
    assert check_house(spec) == ["it has no room sites"]
