"""Labels are proposed from the words in names and from sizes, and the proposed rules give these labels."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sim.app.commands.label import Args, _read
from sim.core.interface import MPCAT40_ID
from sim.houses.geoms import data_at_rest
from sim.houses.labels import read_labels
from sim.houses.proposals import category_by_size, category_of_name, geom_box, propose, rules_of, size_doubt
from tests.helpers.foreign import write_scene

NAMES = {
    "Couch.001": "sofa",
    "wall_leftcorner_visual": "wall",
    "hingecabinet": "cabinet",
    "backwall": "wall",
    "KitchenCounterTop": "counter",
    "chest_of_drawers_3": "chest_of_drawers",
    "TVMonitor": "tv_monitor",
    "DiningChairs": "chair",
    "office_desk_lamp": "lighting",
    "microwave": "appliances",
    "BathtubBasin": "bathtub",
    "Wall_Clock": "objects",
    "Vase": "objects",
    "ShelvingUnit|3": "shelving",
    "TVStand_206_1": "cabinet",
    "WashingMachine": "appliances",
    "ClothesDryer": "appliances",
    "Doorframe_Double_5": "door",
    "dining_table_lamp": "lighting",
    "ceiling_light.002": "lighting",
    "bath_mat": "floor",
    "Bedside_Table": "chest_of_drawers",
    "toilet_seat": "toilet",
    "sofa_seat_left": "sofa",
    "car_seat": "chair",
    "//unnamed_geom_3": None,
    "panda0_link0": None,
    "cannon": None,
}


@pytest.mark.parametrize(("name", "category"), NAMES.items())
def test_the_last_known_word_of_a_name_is_its_category(name: str, category: str | None) -> None:
    assert category_of_name(name) == category


@pytest.mark.parametrize(
    ("low", "high", "category"),
    [
        ((-3, -3, -0.1), (3, 3, 0.0), "floor"),
        ((-3, -3, 0.7), (3, 3, 0.8), None),
        ((-3, -3, 2.5), (3, 3, 2.6), "ceiling"),
        ((0, -2, 0), (0.1, 2, 2.5), "wall"),
        ((0, -2, 0), (0.1, 2, 0.5), None),
        ((0, 0, 0), (0.5, 0.5, 2.0), None),
    ],
)
def test_large_flat_boxes_are_floor_wall_or_ceiling(low, high, category) -> None:
    assert category_by_size(np.array(low), np.array(high)) == category
    assert category_by_size(np.array(low), np.array(high), movable=True) is None


def test_sizes_that_a_category_does_not_have_are_doubtful() -> None:
    assert size_doubt("chair", np.array([0.5, 0.5, 1.0])) == ""
    assert size_doubt("chair", np.array([0.5, 5.0, 1.0])) == "too large"
    assert size_doubt("chair", np.array([0.05, 0.05, 0.05])) == "too small"
    assert size_doubt("wall", np.array([50.0, 0.1, 3.0])) == ""


def test_the_proposed_rules_give_the_proposed_labels(tmp_path: Path) -> None:
    house, _ = write_scene(tmp_path / "s")
    _, model = _read(Args(house=house))
    labels = read_labels(model, rules=rules_of(propose(model)))
    found = {each.name: each.category for each in labels.instances}
    expected = {"Ground": "floor", "Shell.N": "wall", "Couch.001": "sofa", "Pillow.A": "cushion", "Ball_3": "objects"}
    expected |= {"Sideboard": "cabinet", "Sideboard_door": "door", "Stool_7": "stool"}
    assert expected.items() <= found.items()
    assert labels.void_geoms == 2  # Gadget.box, Widget


def test_names_that_differ_only_in_their_numbers_share_a_rule_unless_their_categories_differ() -> None:
    model = _model(
        *(f'<body name="crate_{i}" pos="{i} 0 1"><geom size="0.2"/></body>' for i in (1, 2, 30)),
        '<body name="thing.1" pos="5 0 1"><geom size="0.2"/></body>',
    )
    rules = rules_of(propose(model))
    assert rules == {"^g$": "floor", r"^crate_\d+$": "objects", r"^thing\.1$": "void"}


def test_a_named_part_with_the_category_of_its_body_is_no_instance_of_its_own() -> None:
    model = _model(
        '<body name="table"><geom name="table_leg" size="0.1"/><geom name="tabletop" size="0.2"/>'
        '<body name="vase_on_table"><geom name="vase" size="0.1"/></body></body>'
    )
    labels = read_labels(model, rules=rules_of(propose(model)))
    assert {each.name: len(each.geom_ids) for each in labels.instances} == {"g": 1, "table": 2, "vase": 1}


def test_a_seat_of_a_sofa_is_no_chair() -> None:
    model = _model('<body name="sofa"><geom name="seat" size="0.4"/><geom name="sofa_back" size="0.4"/></body>')
    labels = read_labels(model, rules=rules_of(propose(model)))
    assert {each.name: each.category for each in labels.instances} == {"g": "floor", "sofa": "sofa"}


def test_a_geom_without_any_name_has_its_number_as_a_name() -> None:
    model = _model('<geom type="box" size="0.1 2 1.2" pos="2 0 1.2"/>', '<body><geom size="0.3"/></body>')
    rules = rules_of(propose(model))
    assert rules == {"^g$": "floor", "^#1$": "wall", "^#2$": "void"}
    labels = read_labels(model, rules={**rules, "^#2$": "plant"})
    assert labels.geom_category.tolist() == [MPCAT40_ID[name] for name in ("floor", "wall", "plant")]


def test_the_box_around_a_turned_mesh_is_that_of_its_vertices() -> None:
    mesh = '<mesh name="wedge" vertex="0 0 0  1 0 0  0 1 0  0 0 1"/>'
    model = _model('<geom name="w" type="mesh" mesh="wedge" pos="3 0 0" euler="0 0 45"/>', assets=mesh)
    low, high = geom_box(model, data_at_rest(model), model.geom("w").id)
    half = np.sqrt(0.5)
    np.testing.assert_allclose((low, high), [(3.0 - half, 0.0, 0.0), (3.0 + half, half, 1.0)], atol=1e-6)


def _model(*world: str, assets: str = ""):
    from sim.gl import mujoco

    floor = '<geom name="g" type="plane" size="5 5 1"/>'
    return mujoco.MjModel.from_xml_string(
        f"<mujoco><asset>{assets}</asset><worldbody>{floor}{''.join(world)}</worldbody></mujoco>"
    )
