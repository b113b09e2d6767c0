"""A ProcTHOR house keeps its geometry: sides, areas, doors, places and fronts of objects; broken ones are one line."""

from __future__ import annotations

import copy
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.app.commands.importing import procthor as command
from sim.core.errors import ConfigError, HouseError
from sim.homes.importers.losses import Losses
from sim.homes.importers.procthor import Imported, ProcthorConfig, import_house
from sim.homes.importers.procthor_files import Asset, Source, find_assets, parse_house, read_assets, read_houses
from sim.homes.importers.procthor_plan import lay_out
from sim.homes.importers.rectilinear import Stretch, rectangles
from sim.houses.geoms import data_at_rest, world_boxes
from sim.houses.house import House, read_rooms
from sim.houses.labels import read_labels
from sim.world.check import check_own_house
from tests.helpers import wording
from tests.helpers.messages import require_result_or_one_line
from tests.helpers.procthor import ASSETS, entity, small_house, write_small_house

SAMPLES = next(
    (each for folder in Path(__file__).parents if (each := folder / "shared/worlds/procthor").is_dir()), None
)
"""Houses of ProcTHOR on the maintainer's machine, which are not part of the project."""


def source_of(house: Any) -> Source:
    return Source("small", "House file 'small.json'", json.dumps(house).encode())


@pytest.fixture(scope="module")
def imported(tmp_path_factory: pytest.TempPathFactory) -> Imported:
    return import_house(source_of(small_house()), database(tmp_path_factory.mktemp("assets")), ProcthorConfig())


def database(folder: Path) -> Any:
    (folder / "asset-database.json").write_text(json.dumps(ASSETS))
    return read_assets(folder / "asset-database.json")


def body_of(made: Imported, category: str) -> tuple[np.ndarray, float]:
    """Returns position and heading (degrees) of the one body of a category."""
    (body,) = [each for each in made.spec.worldbody.bodies if each.name.startswith(f"{category}_")]
    return np.array(body.pos), math.degrees(2.0 * math.atan2(body.quat[3], body.quat[0]))


def test_the_house_is_not_mirrored(imported: Imported) -> None:
    rooms = {room.name: room for room in read_rooms(imported.spec.compile())}
    living, bedroom = rooms["room_living_room_00"], rooms["room_bedroom_00"]
    assert living.contains(1.0, 5.0)
    assert not living.contains(4.0, 5.0)
    assert bedroom.contains(7.0, 1.0)
    position, heading = body_of(imported, "sofa")
    assert position[:2] == pytest.approx([0.51, 2.5], abs=0.01)  # 3 cm further from the wall, which has a thickness
    assert heading == pytest.approx(0.0, abs=0.1)
    position, heading = body_of(imported, "bed")
    assert position[:2] == pytest.approx([7.89, 3.19], abs=0.01)
    assert heading % 360.0 == pytest.approx(180.0, abs=0.1)
    position, heading = body_of(imported, "picture")
    assert position[:2] == pytest.approx([7.0, 0.06], abs=0.001)
    assert heading == pytest.approx(90.0, abs=0.1)


def test_items_have_the_sizes_of_their_assets(imported: Imported) -> None:
    model = imported.spec.compile()
    data = data_at_rest(model)
    labels = read_labels(model, ignore_prefix="")
    for category, size in (("sofa", (0.9, 2.0, 0.8)), ("bed", (2.1, 1.5, 0.9)), ("picture", (0.8, 0.03, 0.5))):
        (instance,) = labels.of_category(category)
        geoms = [geom for geom in instance.geom_ids if model.geom_group[geom] < 3]
        low, high = world_boxes(model, data, geoms)
        found = high.max(axis=0) - low.min(axis=0)
        assert found == pytest.approx(size, abs=0.06), category


def test_areas_openings_and_counts_are_those_of_the_source(imported: Imported) -> None:
    assert imported.report["area_m2"] == pytest.approx(42.0)
    assert [imported.report[name] for name in ("rooms", "inner_doors", "outer_doors", "windows")] == [2, 1, 1, 1]
    assert imported.report["left_out"] == {"Apple: inside Fridge": 1}
    assert imported.report["boxes"] == {"Gizmo": 1}
    assert imported.report["changes"] == {
        "A door that was not fully open was opened.": 1,
        "The type Gizmo is not in the table; it became objects.": 1,
    }
    layout = lay_out(parse_house(source_of(small_house())), "here", Losses())
    door, front = layout.doors
    assert (door.opening.line_m, *door.opening.span) == (5.0, 2.5, 3.5)
    assert (front.opening.kind, front.opening.side, *front.opening.span) == ("entry", "south", 1.0, 2.0)
    window = next(opening for opening in layout.openings if opening.kind == "window")
    assert (window.line_m, *window.span, window.bottom_m, window.top_m) == (9.0, 1.0, 2.0, 0.9, 1.9)


def test_the_robot_reaches_both_rooms_unless_the_door_stays_closed(imported: Imported, tmp_path: Path) -> None:
    assert check_own_house(House("small", imported.spec))[0] == []
    closed = import_house(source_of(small_house()), database(tmp_path), ProcthorConfig(doors="as-is"))
    assert any("cannot enter" in fault for fault in check_own_house(House("small", closed.spec))[0])


def test_a_child_stands_on_the_top_of_our_furniture(imported: Imported) -> None:
    stand, screen = body_of(imported, "cabinet")[0], body_of(imported, "tv_monitor")[0]
    assert screen[:2] == pytest.approx([2.0, 5.75], abs=0.1)
    assert 0.3 < screen[2] - stand[2] < 0.55


def test_a_counter_with_two_arms_leaves_its_corner_free(tmp_path: Path) -> None:
    house = {**small_house(), "objects": [entity("Countertop_L_6x6", "CounterTop|1", (7.9, 0.47, 1.0), 270.0)]}
    made = import_house(source_of(house), database(tmp_path), ProcthorConfig())
    arms = [each for each in made.spec.worldbody.bodies if each.name.startswith("counter_")]
    places = sorted(tuple(np.round(arm.pos[:2], 1)) for arm in arms)
    assert places == [(7.6, 0.4), (8.5, 1.0)]  # along the south wall, which is nearer than the north one, and the east


def test_an_l_is_cut_where_it_divides_no_opening() -> None:
    polygon = [(0.0, 0.0), (0.0, 6.0), (3.0, 6.0), (3.0, 4.0), (5.0, 4.0), (5.0, 0.0)]
    south = rectangles(polygon, [Stretch("x", 0.0, (2.5, 3.5))])
    assert [(rect.x0, rect.y0, rect.x1, rect.y1) for rect in south] == [(0.0, 0.0, 5.0, 4.0), (0.0, 4.0, 3.0, 6.0)]
    west = rectangles(polygon, [Stretch("y", 0.0, (3.5, 4.5))])
    assert [(rect.x0, rect.y0, rect.x1, rect.y1) for rect in west] == [(0.0, 0.0, 3.0, 6.0), (3.0, 0.0, 5.0, 4.0)]


def broken(path: tuple[Any, ...], value: Any) -> dict[str, Any]:
    """Returns the small house with another value at a path."""
    house = copy.deepcopy(small_house())
    place: Any = house
    for key in path[:-1]:
        place = place[key]
    place[path[-1]] = value
    return house


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        (("rooms",), [], "field 'rooms'"),
        (("rooms", 0, "floorPolygon", 0, "x"), 1e9, r"field 'rooms\[0\].floorPolygon"),
        (("rooms", 0, "floorPolygon", 1, "x"), 0.5, "'A'"),
        (("rooms", 1, "floorPolygon"), small_house()["rooms"][0]["floorPolygon"], "rooms 'A' and 'B' overlap"),
        (("doors", 0, "wall0"), "wall|9", r"'door\|A\|B'.*'wall\|9'"),
        (("objects", 0, "position"), None, "field 'objects"),
    ],
)
def test_a_broken_house_is_one_line_with_file_and_place(
    path: tuple[Any, ...], value: Any, message: str, tmp_path: Path
) -> None:
    with pytest.raises(HouseError, match=message) as caught:
        import_house(source_of(broken(path, value)), database(tmp_path), ProcthorConfig())
    assert str(caught.value).startswith("House file 'small.json'")
    assert "\n" not in str(caught.value)


def test_objects_in_objects_without_end_are_one_line_or_left_out(tmp_path: Path) -> None:
    tower = flat = None
    for level in range(60, 0, -1):
        tower = [entity("Gizmo_1", "Gizmo|0", (6.0, 0.3 * level - 0.15, 0.5), children=tower)]
        flat = [entity("Gizmo_1", "Gizmo|0", (6.0, 0.15, 0.5), children=flat)]
    with pytest.raises(HouseError, match=wording.OBJECTS_ARE_NESTED_MORE_THAN_20_DEEP):
        import_house(source_of({**small_house(), "objects": tower}), database(tmp_path), ProcthorConfig())
    made = import_house(source_of({**small_house(), "objects": flat}), database(tmp_path), ProcthorConfig())
    assert sum(made.report["left_out"].values()) + sum(made.report["boxes"].values()) == 60
    deep = b'{"more": ' + b"[" * 100_000
    with pytest.raises(HouseError, match=wording.NESTED_TOO_DEEPLY):
        parse_house(Source("small", "House file 'small.json'", deep))


def test_a_house_file_of_another_ending_and_a_missing_database_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=wording.UNSUPPORTED_SUFFIX):
        list(read_houses(tmp_path / "a.txt"))
    with pytest.raises(ConfigError, match="--assets"):
        find_assets(tmp_path / "a.json", None)


VALUES = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-400, 400),
    st.floats(-400.0, 400.0),
    st.text(max_size=3),
    st.just([]),
    st.just({}),
)
PLACES = """rooms.0.floorPolygon.2.z rooms.1.floorPolygon.0.x rooms.0.roomType walls.4.empty walls.3.polygon.1.y
walls.4.polygon.0.z doors.0.holePolygon.0.x doors.1.room0 doors.0.assetId doors.0.openness windows.0.holePolygon.1.y
objects.5.position.x objects.5.position.y objects.5.rotation.z objects.5.assetId objects.5.id objects.5.children"""
PATHS = st.sampled_from([
    tuple(int(key) if key.isdigit() else key for key in place.split(".")) for place in PLACES.split()
])  # fmt: skip


GIZMO = {"Gizmo_1": Asset("Gizmo", (0.3, 0.3, 0.3))}


@settings(max_examples=12)
@given(st.lists(st.tuples(PATHS, VALUES), min_size=1, max_size=2))
def test_any_change_of_a_house_gives_a_house_or_one_line(changes: list[tuple[tuple[Any, ...], Any]]) -> None:
    house = small_house()
    house["objects"] = [house["objects"][5]] * 6
    for path, value in changes:
        house = copy.deepcopy(house)
        place: Any = house
        for key in path[:-1]:
            place = place[key]
        place[path[-1]] = value
    require_result_or_one_line(lambda: import_house(source_of(house), GIZMO, ProcthorConfig()), "small.json")


def test_the_command_makes_a_folder_of_houses_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    args = command.Args(path=write_small_house(tmp_path / "source"), out=tmp_path / "out", pictures=0)
    assert command.main(args) == 0
    assert "2 houses with 4 rooms, 84 m2" in capsys.readouterr().out
    houses = sorted((tmp_path / "out").glob("*.xml"))
    assert [file.name for file in houses] == ["houses_0001.xml", "houses_0003.xml"]
    before = [file.stat().st_mtime_ns for file in houses]
    assert command.main(args) == 0
    assert [file.stat().st_mtime_ns for file in houses] == before


@pytest.mark.slow
@pytest.mark.skipif(SAMPLES is None, reason="the samples are not here")
def test_all_samples_are_imported(tmp_path: Path) -> None:
    assert SAMPLES is not None
    for name in ("rooms_val.jsonl.gz", "house_train_1.json"):
        assert command.main(command.Args(path=SAMPLES / name, out=tmp_path, pictures=0)) == 0


def older(house: dict[str, Any]) -> dict[str, Any]:
    """Returns a house in the layout of ProcTHOR's schema 0.0.1."""
    house = copy.deepcopy(house)
    for hole in house["doors"] + house["windows"]:
        low, high = hole.pop("holePolygon")
        hole |= {"boundingBox": {"min": low, "max": high}, "assetOffset": {"x": 0.0, "y": 0.0, "z": 0.0}}
    for part in house["rooms"]:
        part["floorMaterial"] = "WoodGrain"
    for part in house["walls"]:
        part["material"] = "PureWhite"
    return house


def test_the_older_layout_of_procthor_gives_the_same_house(imported: Imported, tmp_path: Path) -> None:
    made = import_house(source_of(older(small_house())), database(tmp_path), ProcthorConfig())
    first, second = imported.spec.compile(), made.spec.compile()
    assert np.array_equal(first.geom_pos, second.geom_pos)
    assert np.array_equal(first.geom_size, second.geom_size)
    assert {**made.report, "key": ""} == {**imported.report, "key": ""}


def test_a_door_without_corners_is_named_with_both_layouts() -> None:
    house = small_house()
    del house["doors"][0]["holePolygon"]
    with pytest.raises(HouseError, match=r"doors\[0\].*holePolygon.*boundingBox.*0\.0\.1"):
        parse_house(source_of(house))
