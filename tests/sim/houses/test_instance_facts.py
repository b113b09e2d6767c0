"""Names, colours and materials of instances in a house file."""

from __future__ import annotations

import pytest

from sim.core.colours import COLOUR_NAMES, clear_colour_name, colour_numbers
from sim.core.errors import HouseError
from sim.gl import mujoco
from sim.houses.instance_facts import InstanceFacts, parse_facts, read_instance_facts
from sim.houses.labels import read_labels

HOUSE = """<mujoco><custom>
  <text name="chair_00" data="name: dining chair; colour: red; material: wood"/>
  <text name="floor_00" data="{floor}"/>
  <text name="author" data="somebody: else"/>
</custom><worldbody>
  <geom name="floor_00" type="plane" size="2 2 .1"/>
  <body name="chair_00" pos="0 0 .5"><geom type="box" size=".2 .2 .5"/></body>
  <body name="chair_01" pos="1 0 .5"><geom type="box" size=".2 .2 .5"/></body>
</worldbody></mujoco>"""


def compiled(floor: str = "name: floor") -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_string(HOUSE.format(floor=floor))


def test_texts_with_the_name_of_an_instance_are_its_facts() -> None:
    model = compiled()
    facts = read_instance_facts(model, read_labels(model))
    assert facts == {"chair_00": InstanceFacts("dining chair", "red", "wood"), "floor_00": InstanceFacts("floor")}


@pytest.mark.parametrize(
    "facts", [InstanceFacts("fridge", "white", "metal"), InstanceFacts("desk"), InstanceFacts(colour="blue")]
)
def test_facts_are_read_back_from_their_text(facts: InstanceFacts) -> None:
    assert parse_facts(facts.text(), "x_00") == facts


@pytest.mark.parametrize(
    ("text", "part"),
    [("colour: mauve", "mauve"), ("material: cheese", "cheese"), ("a chair", "a chair"), ("size: 3", "size: 3"),
     ("name: a; name: b", "name: a; name: b")],
)  # fmt: skip
def test_a_text_of_another_form_is_refused_with_the_instance(text: str, part: str) -> None:
    model = compiled(text)
    with pytest.raises(HouseError) as refused:
        read_instance_facts(model, read_labels(model))
    assert "floor_00" in str(refused.value)
    assert part in str(refused.value)


@pytest.mark.parametrize(
    ("rgb", "name"),
    [((1, 0, 0), "red"), ((0, 0, 1), "blue"), ((0.1, 0.6, 0.1), "green"), ((1, 1, 1), "white"), ((0, 0, 0), "black"),
     ((0.5, 0.5, 0.5), "grey"), ((0.45, 0.28, 0.15), "brown"), ((0.86, 0.78, 0.65), "beige"), ((1, 0.55, 0), "orange"),
     ((0.95, 0.85, 0.1), "yellow"), ((0.5, 0.1, 0.5), "purple"), ((0.95, 0.6, 0.7), "pink")],
)  # fmt: skip
def test_typical_colours_have_their_names(rgb: tuple[float, float, float], name: str) -> None:
    assert COLOUR_NAMES[int(colour_numbers(rgb))] == name


def test_a_colour_between_two_names_is_not_clear() -> None:
    names = [clear_colour_name((1.0, green / 100, 0.0)) for green in range(0, 100)]
    assert {"red", "orange", "yellow", None} <= set(names)
    assert colour_numbers([[(1, 0, 0)], [(0, 0, 1)]]).tolist() == [
        [COLOUR_NAMES.index("red")], [COLOUR_NAMES.index("blue")]
    ]  # fmt: skip
