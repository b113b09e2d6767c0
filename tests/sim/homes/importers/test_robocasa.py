"""A kitchen by RoboCasa's rules gets its labels from the names of its fixtures; the robot in it is removed."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.app.commands.importing import robocasa as command
from sim.core.errors import ConfigError, HouseError
from sim.episodes.splits import labels_of
from sim.gl import mujoco
from sim.homes.importers.robocasa import category_of_fixture, find_scenes, import_kitchen
from sim.houses.house import read_rooms
from sim.houses.labels import read_labels, rendered_geoms
from sim.houses.load import load_house
from sim.world.check import check_own_house
from tests.helpers import wording
from tests.helpers.messages import require_result_or_one_line
from tests.helpers.robocasa import FIXTURES, LARGE_PX, fixture, write_kitchen


@pytest.fixture(scope="module")
def split(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("robocasa")
    write_kitchen(folder)
    args = command.Args(path=folder / "scenes", root=folder, out=folder / "out", pictures=0, texture_px=100)
    assert command.main(args) == 0
    return folder / "out"


def load(split: Path) -> tuple[Any, mujoco.MjModel]:
    house = load_house(split / "kitchen.xml", labels_path=labels_of(split))
    return house, house.spec.copy().compile()


def test_fixtures_have_the_categories_of_their_names(split: Path) -> None:
    house, model = load(split)
    labels = read_labels(model, rules=house.rules, ignore_prefix="")
    found = {each.name: each.category for each in labels.instances}
    assert found == {
        "wall_room_main": "wall", "wall_left_room_main": "wall", "floor_room_main": "floor",
        "counter_main_main_group_main": "counter", "stack_1_main_group_1_main": "cabinet",
        "cab_1_main_group_main": "cabinet", "fridge_main_group_main": "appliances", "distr_counter_main": "objects",
        "wall_added_0": "wall", "wall_added_1": "wall",
    }  # fmt: skip
    cabinet = next(each for each in labels.instances if each.name == "cab_1_main_group_main")
    assert "cab_1_main_group_door" in [model.geom(geom).name for geom in cabinet.geom_ids]
    assert labels.void_geoms == 1  # the gadget


def test_the_robot_and_invisible_specks_are_gone_and_the_report_names_them(split: Path) -> None:
    _, model = load(split)
    names = [model.body(body).name for body in range(model.nbody)]
    assert not any("robot" in name or "gripper" in name for name in names)
    assert model.nexclude == 0
    assert model.geom("counter_main_main_group_main_g0").id in np.flatnonzero(~rendered_geoms(model))
    changes = json.loads((split / "import.json").read_text())["kitchen"]["changes"]
    assert changes["The robot 'robot0_base' was removed (3 bodies)."] == 1
    assert changes["An invisible box of 2 cm or less was removed."] == 1
    assert changes["A visible geom has no category; it is an obstacle."] == 1


def test_the_room_ends_at_the_walls_and_open_sides_get_walls(split: Path) -> None:
    _, model = load(split)
    (room,) = read_rooms(model)
    (x, y, _), (half_x, half_y, _) = room.boxes[0]
    assert (x - half_x, x + half_x) == pytest.approx((0.0, 4.04))
    assert (y - half_y, y + half_y) == pytest.approx((-4.02, 0.0))
    report = json.loads((split / "import.json").read_text())["kitchen"]
    assert report["area_m2"] == pytest.approx(4.04 * 4.02, abs=0.01)
    sides = [side for side in ("west", "east", "south", "north") if f"its {side} side" in " ".join(report["changes"])]
    assert sides == ["east", "south"]
    east, south = (model.geom(f"wall_added_{number}") for number in range(2))
    assert (east.pos[0], south.pos[1]) == pytest.approx((4.04 + 0.05, -4.02 - 0.05))
    assert (east.size[1], south.size[0]) == pytest.approx((2.02 + 0.1, 2.04 + 0.1))
    assert (east.pos[2] + east.size[2], south.pos[2] - south.size[2]) == pytest.approx((3.0, 0.0))


def test_a_side_where_another_floor_goes_on_gets_no_wall(tmp_path: Path) -> None:
    next_door = fixture("floor_2_room_main", "1 2.02 .02", "5.04 -2 -.02")
    scene = import_kitchen(write_kitchen(tmp_path, fixtures=FIXTURES + next_door), root=tmp_path)
    added = [line for line in scene.report["changes"] if "a plain wall was added" in line]
    assert [line.split(" side")[0].split()[-1] for line in added] == ["south", "east", "north"]


def test_a_wall_beyond_the_corner_leaves_a_closed_side_closed(tmp_path: Path) -> None:
    beyond = fixture("wall_far_room_main", "1 .02 1.5", "6 .02 1.5")
    scene = import_kitchen(write_kitchen(tmp_path, fixtures=FIXTURES + beyond), root=tmp_path)
    assert not any("its north side" in line for line in scene.report["changes"])


def test_textures_are_reduced_and_unused_ones_are_left_out(split: Path) -> None:
    (file,) = (split / "files").iterdir()
    picture = cv2.imread(str(file))
    assert picture is not None
    assert picture.shape[:2] == (100, 50)
    assert load(split)[1].ntex == 1


def test_the_robot_reaches_the_room_and_the_goals(split: Path) -> None:
    assert check_own_house(load(split)[0])[0] == []


def test_files_that_do_not_change_are_links_unless_they_are_packed(tmp_path: Path) -> None:
    file = write_kitchen(tmp_path)
    for pack in (False, True):
        args = command.Args(path=file, root=tmp_path, out=tmp_path / f"out{pack}", pictures=0, pack=pack)
        assert command.main(args) == 0
        (texture,) = (args.out / "files").iterdir()
        assert os.path.samefile(texture, tmp_path / "assets" / "wood.png") is not pack
        assert texture.read_bytes() == (tmp_path / "assets" / "wood.png").read_bytes()
    assert command.Args(path=file, out=tmp_path).texture_px > LARGE_PX


@pytest.mark.parametrize(
    ("body", "category"),
    [
        ("microwave_housing_right_group_main", "cabinet"),
        ("hingecabinet_2_top_group_1_main", "cabinet"),
        ("wallaccessory_2_room_main", "objects"),
        ("corner_counter_right_group_main", "counter"),
        ("window_group_1_left_group_main", "window"),
        ("stovetop_main_group_main", "appliances"),
        ("bottom_right_group_main", "cabinet"),
        ("stool_1_stool_group_1_main", "stool"),
        ("robot0_base", None),
    ],
)
def test_names_of_newer_layouts_say_their_categories(body: str, category: str | None) -> None:
    assert category_of_fixture(body) == category


def test_broken_kitchens_are_one_line_with_their_file(tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    with pytest.raises(ConfigError, match="has no MJCF file"):
        find_scenes(tmp_path / "empty")
    file = write_kitchen(tmp_path)
    for broken, message in (
        (file.read_text().replace("wood.png", "none.png"), "none.png"),
        (file.read_text().replace("../assets", "../../assets"), "outside of its folder"),
        (file.read_text().replace('pos="2 -2 3"', 'pos="nan 0 0"'), "is not finite"),
        (file.read_text().replace("</worldbody>", ""), "not an MJCF file"),
    ):
        other = file.with_name("other.xml")
        other.write_text(broken)
        with pytest.raises(HouseError, match=message) as caught:
            import_kitchen(other, root=tmp_path)
        assert str(caught.value).startswith(f"Kitchen '{other}'")
        assert "\n" not in str(caught.value)
    with pytest.raises(HouseError, match=wording.DOES_NOT_EXIST):
        import_kitchen(file.with_name("none.xml"))


NAMES = st.sampled_from(["cab_1_main_group_main", "robot0_base", "obj", "wall_room_main", "", "a" * 50, "floor"])


@settings(max_examples=10)
@given(st.lists(st.tuples(NAMES, st.sampled_from([".1 .1 .1", "1 1", "0 0 0", "x", "-1 1 1", "1e9 1 1"])), max_size=3))
def test_any_fixtures_give_a_kitchen_or_one_line(
    tmp_path_factory: pytest.TempPathFactory, bodies: list[tuple[str, str]]
) -> None:
    more = "".join(
        fixture(f"{name}_{number}" if number else name, size, "1 -1 1") for number, (name, size) in enumerate(bodies)
    )
    folder = tmp_path_factory.mktemp("any")
    file = write_kitchen(folder, fixtures=FIXTURES + more, robot="")
    require_result_or_one_line(lambda: import_kitchen(file, root=folder, texture_px=20), "kitchen.xml")


def placeholder(half_m: float, *, thin: bool = False) -> str:
    """Returns a stove of 0.8 x 0.6 x 0.9 m, whose mesh is a cube with this half side, and its knob."""
    knob = (
        '<body name="stove_main_group_knob"><geom name="knob" type="box" size=".02 .02 .02" pos="0 -.32 .4" group="1" '
        'contype="0" conaffinity="0"/><geom name="knob_main" type="box" size=".02 .02 .02" pos="0 -.32 .4" group="3"/>'
        "</body>"
    )
    size = ".4 .04 .45" if thin else ".4 .3 .45"
    return (
        f'<body name="stove_main_group_main" pos="2.6 -1.5 .45"><geom name="block" type="box" size="{size}" group="3" '
        f'rgba=".5 0 0 .5"/><geom name="mesh" type="box" size="{half_m} {half_m} {half_m}" group="1" contype="0" '
        f'conaffinity="0"/>{knob}</body>'
    )


@pytest.mark.parametrize(
    ("stove", "shown"), [(placeholder(0.18), True), (placeholder(0.45), False), (placeholder(0.03, thin=True), False)]
)
def test_a_fixture_whose_mesh_is_a_placeholder_shows_the_boxes_that_the_robot_touches(
    stove: str, shown: bool, tmp_path: Path
) -> None:
    file = write_kitchen(tmp_path, fixtures=FIXTURES + stove)
    assert command.main(command.Args(path=file, root=tmp_path, out=tmp_path / "out", pictures=0)) == 0
    house, model = load(tmp_path / "out")
    visible = rendered_geoms(model)
    assert {name: bool(visible[model.geom(name).id]) for name in ("block", "mesh", "knob", "knob_main")} == {
        "block": shown, "mesh": True, "knob": True, "knob_main": False
    }  # fmt: skip
    assert (model.geom("block").rgba[3] == 1.0) == shown
    of_stove = [each for each in read_labels(model, rules=house.rules).instances if "stove" in each.name]
    assert [each.category for each in of_stove] == ["appliances"]
    assert (
        "visible geoms fill little of 'stove_main_group_main'" in (tmp_path / "out" / "import.json").read_text()
    ) == shown
