"""A house file that breaks a rule of the house format is refused in one sentence."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from sim.core.errors import HouseError
from sim.gl import mujoco
from sim.houses.house import Room, read_rooms
from sim.houses.load import load_house
from sim.houses.writing import house_text
from tests.helpers import wording

FLOOR = '<geom name="floor_00" type="plane" size="5 5 1"/>'


def house_file(folder: Path, worldbody: str = FLOOR, rest: str = "") -> Path:
    path = folder / "flat.xml"
    path.write_text(f"<mujoco>{rest}<worldbody>{worldbody}</worldbody></mujoco>")
    return path


@pytest.mark.parametrize(
    "floor",
    [
        FLOOR,
        '<geom name="floor_00" type="box" size="2 2 .05" pos="0 0 -.05"/>',
        '<body name="floor_00"><geom type="box" size="2 2 .05" pos="0 0 -.05"/></body>',
    ],
)
def test_a_floor_is_enough_for_a_house(tmp_path, floor):
    house = load_house(house_file(tmp_path, floor))
    assert house.name == "flat"
    assert house.path == tmp_path / "flat.xml"
    assert house.spec.copy().compile().ngeom == 1


def test_textures_next_to_the_file_are_found(tmp_path, monkeypatch):
    import cv2

    (tmp_path / "textures").mkdir()
    cv2.imwrite(str(tmp_path / "textures" / "wood.png"), np.full((4, 4, 3), 120, np.uint8))
    asset = '<asset><texture name="w" type="2d" file="textures/wood.png"/><material name="w" texture="w"/></asset>'
    path = house_file(tmp_path, FLOOR.replace("/>", ' material="w"/>'), asset)
    monkeypatch.chdir("/")
    assert load_house(path).spec.copy().compile().ntex == 1


BAD = {
    "no floor": ('<geom name="wall_00" size=".1"/>', "", "has no floor"),
    "a floor that is only seen": (FLOOR.replace("/>", ' contype="0" conaffinity="0"/>'), "", "has no floor"),
    "a floor that is too high": (FLOOR.replace("/>", ' pos="0 0 .3"/>'), "", r"'floor_00'.*z = 0\.300 m"),
    "a floor of another shape": ('<geom name="floor_00" size="1"/>', "", "neither a plane nor a box"),
    "no label": (FLOOR + '<geom name="lump" size=".1"/>', "", "geom 'lump' is visible and has no label"),
    "no category": (FLOOR + '<geom name="chiar_00" size=".1"/>', "", "Did you mean 'chair'"),
    "a camera": (FLOOR + '<camera name="eye"/>', "", "must not have cameras.*'eye'"),
    "an actuator": (
        FLOOR + '<body name="door_00"><joint name="j"/><geom size=".1"/></body>',
        '<actuator><motor name="push" joint="j"/></actuator>',
        "must not have actuators.*'push'",
    ),
    "a tendon": (
        FLOOR + '<geom name="wall_00" size=".1" pos="1 0 1"/><site name="a"/><site name="b" pos="1 0 0"/>',
        '<tendon><spatial name="rope"><site site="a"/><site site="b"/></spatial></tendon>',
        "must not have tendons.*'rope'",
    ),
    "an upper floor without an end": (
        FLOOR + '<geom name="floor_01" type="plane" size="2 2 1" pos="0 0 2.7"/>',
        "",
        r"'floor_01' is a plane at z = 2\.70 m that faces up.*use a box",
    ),
    "a height field": (
        FLOOR + '<geom name="floor_01" type="hfield" hfield="h"/>',
        '<asset><hfield name="h" nrow="2" ncol="2" size="1 1 1 1"/></asset>',
        "'floor_01' is a height field",
    ),
    "a missing texture": (FLOOR, '<asset><texture name="t" type="2d" file="no.png"/></asset>', r"no\.png"),
    "an unknown attribute": ('<geom colour="red"/>', "", "unrecognized attribute: 'colour'"),
}


@pytest.mark.parametrize(("worldbody", "rest", "message"), BAD.values(), ids=BAD)
def test_a_file_that_breaks_a_rule_is_refused_in_one_line_that_names_it(tmp_path, worldbody, rest, message):
    with pytest.raises(HouseError, match=message) as refused:
        load_house(house_file(tmp_path, worldbody, rest))
    assert "flat.xml" in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("content", [b"hello", b"", b"<mujoco>", b"\x00\xff\xfe", b"{}"])
def test_a_file_that_is_not_mjcf_is_refused_in_one_line(tmp_path, content):
    path = tmp_path / "notes.xml"
    path.write_bytes(content)
    with pytest.raises(HouseError, match=r"notes\.xml") as refused:
        load_house(path)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("name", ["val_02", "val_02.xml"])
def test_the_name_of_a_shipped_house_is_answered_with_its_file(name):
    with pytest.raises(HouseError, match=r"there is no such file\. The shipped house is '.*val/val_02\.xml'"):
        load_house(Path(name))


def test_a_missing_file_is_reported(tmp_path):
    with pytest.raises(HouseError, match=r"nowhere\.xml.*no"):
        load_house(tmp_path / "nowhere.xml")
    with pytest.raises(HouseError, match=wording.NO_SUCH_FILE):
        load_house(tmp_path)


def test_a_third_party_scene_is_labelled_by_its_rules(tmp_path):
    path = house_file(tmp_path, '<geom name="Ground" type="plane" size="5 5 1"/><geom name="what" size=".1"/>')
    rules = tmp_path / "map.json"
    rules.write_text(json.dumps({"^Ground$": "floor"}))
    assert load_house(path, labels_path=rules).rules == {"^Ground$": "floor"}
    with pytest.raises(HouseError, match="Ground"):
        load_house(path)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("{", "not JSON"),
        ("[1]", "one JSON object"),
        ('{"a": 1}', "one JSON object"),
        ('{"a": "chairs"}', "'chair'"),
        ('{"a": "qq"}', "mpcat40"),
    ],
)
def test_wrong_rules_are_refused_by_name(tmp_path, content, message):
    rules = tmp_path / "map.json"
    rules.write_text(content)
    with pytest.raises(HouseError, match=message):
        load_house(house_file(tmp_path), labels_path=rules)
    with pytest.raises(HouseError, match=r"nomap\.json.*no"):
        load_house(house_file(tmp_path), labels_path=tmp_path / "nomap.json")


def test_rooms_are_read_from_box_sites_of_the_world():
    model = mujoco.MjModel.from_xml_string("""<mujoco><worldbody>
      <site name="room_living_room_00" type="box" pos="1 1 1.25" size="1 1 1.25"/>
      <site name="room_hallway_00" type="box" pos="4 0 1.25" size="2 1 1.25"/>
      <site name="room_hallway_00_1" type="box" pos="6 0 1.25" size="1 2 1.25"/>
      <site name="lamp_spot" type="box" size="1 1 1"/>
      <body><geom size=".1"/><site name="room_bath_00" type="box" size="1 1 1"/></body>
    </worldbody></mujoco>""")
    living, hallway = read_rooms(model)
    assert (living.name, living.kind, len(living.boxes)) == ("room_living_room_00", "living_room", 1)
    assert (hallway.name, hallway.kind, len(hallway.boxes)) == ("room_hallway_00", "hallway", 2)
    assert living.area_m2 == pytest.approx(4.0)
    assert hallway.area_m2 == pytest.approx(8.0 + 8.0 - 2.0)
    assert hallway.contains(6.5, 1.5)
    assert not hallway.contains(2.5, 1.5)
    assert living.floor_z_m == 0.0


def test_a_room_turned_a_quarter_covers_its_turned_box():
    model = mujoco.MjModel.from_xml_string("""<mujoco><worldbody><geom size=".1"/>
      <site name="room_bath_00" type="box" pos="0 0 4.25" size="2 1 1.25" quat="0.70710678 0 0 0.70710678"/>
    </worldbody></mujoco>""")
    (room,) = read_rooms(model)
    assert isinstance(room, Room)
    assert room.contains(0.9, 1.9)
    assert not room.contains(1.9, 0.9)
    assert room.floor_z_m == pytest.approx(3.0)


def test_the_folder_of_the_textures_may_have_any_name():
    spec = mujoco.MjSpec.from_string(
        f"<mujoco><compiler texturedir='a &amp; b'/><worldbody>{FLOOR}</worldbody></mujoco>"
    )
    spec.compile()
    for folder in ("../textures", '/home/R&D\'s <"house">'):
        assert mujoco.MjSpec.from_string(house_text(spec, folder)).texturedir == folder
