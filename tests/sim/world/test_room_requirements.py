"""Rooms must have the furniture of their kind."""

from __future__ import annotations

from collections.abc import Mapping

import pytest

from sim.houses.house import House
from sim.world.check import check_house
from sim.world.room_requirements import GUEST_TOILET_M2, Piece, missing_pieces
from tests.helpers.worlds import room, with_box


def kitchen(pieces: Mapping[str, tuple[float, float]], *, storey_m: float = 0.0) -> House:
    """Returns a kitchen of 6 x 4 m at height `storey_m` with these boxes (name: x and longest side)."""
    house = room(6, 4)
    site = house.spec.site("room_living_00")
    site.name, site.pos = "room_kitchen_00", (0.0, 0.0, storey_m + 1.25)
    for name, (x_m, longest_m) in pieces.items():
        half_m = (0.5 * longest_m, 0.1, 0.1)
        house = with_box(house, name, centre_m=(x_m, -1.9, 0.1), half_m=half_m)
    return house


WHOLE = {"counter_00": (-2.0, 1.5), "sink_00": (-1.08, 0.3), "appliances_00": (0.0, 0.6), "appliances_01": (1.0, 0.6)}


def faults(house: House) -> list[str]:
    return [fault for fault in check_house(house.spec, furnished=True) if not fault.startswith("the home ")]


def test_a_kitchen_with_all_its_pieces_has_no_fault() -> None:
    assert faults(kitchen(WHOLE)) == []


@pytest.mark.parametrize(("piece", "fault"), [("sink_00", "has no sink"), ("counter_00", "has no counter")])
def test_a_missing_piece_is_reported(piece: str, fault: str) -> None:
    rest = {name: where for name, where in WHOLE.items() if name != piece}
    assert faults(kitchen(rest)) == [f"room_kitchen_00 {fault}"]


def test_a_toaster_is_not_a_large_appliance() -> None:
    (fault,) = faults(kitchen(WHOLE | {"appliances_01": (1.0, 0.25)}))
    assert "has 1 of 2 large appliances" in fault


def test_furniture_of_another_storey_does_not_count() -> None:
    assert len(faults(kitchen(WHOLE, storey_m=3.0))) >= 3


def test_a_house_from_elsewhere_is_not_refused_for_its_furniture() -> None:
    assert check_house(kitchen({}).spec) == []


def test_a_small_bathroom_needs_no_shower() -> None:
    pieces = [Piece("toilet", 0.7), Piece("sink", 0.5)]
    assert missing_pieces("bathroom", GUEST_TOILET_M2 - 0.1, pieces) == []
    assert missing_pieces("bathroom", GUEST_TOILET_M2 + 0.1, pieces) == ["has no shower or bathtub"]


def test_a_kind_of_room_without_requirements_needs_nothing() -> None:
    assert missing_pieces("attic", 20.0, []) == []


def test_a_bedroom_with_a_chest_still_needs_a_wardrobe_or_a_rack() -> None:
    pieces = [Piece("bed", 2.0, "bed"), Piece("chest_of_drawers", 1.0, "chest of drawers")]
    for hanger in (Piece("cabinet", 1.2, "wardrobe"), Piece("clothes", 1.5, "clothes rack")):
        assert missing_pieces("bedroom", 12.0, [*pieces, hanger]) == []
    for other in (Piece("cabinet", 1.2, "sideboard"), Piece("clothes", 1.5, "coat stand")):
        assert missing_pieces("bedroom", 12.0, [*pieces, other]) == ["has no wardrobe or clothes rack"]


def test_a_hallway_of_5_m2_has_a_useful_piece() -> None:
    assert missing_pieces("hallway", 4.9, []) == []
    assert len(missing_pieces("hallway", 5.1, [Piece("plant", 1.0), Piece("picture", 0.8)])) == 1
    assert missing_pieces("hallway", 5.1, [Piece("mirror", 0.8)]) == []
