"""The rules that assign geoms to labelled instances."""

from __future__ import annotations

import pytest

from sim.core.errors import HouseError
from sim.core.interface import MPCAT40, MPCAT40_ID
from sim.gl import mujoco
from sim.houses.labels import geoms_of, parse_label, read_labels, rendered_geoms


def compiled(worldbody: str, assets: str = ""):
    return mujoco.MjModel.from_xml_string(f"<mujoco><asset>{assets}</asset><worldbody>{worldbody}</worldbody></mujoco>")


def owners(worldbody: str, **options) -> list[str | None]:
    """Returns the name of each geom's instance."""
    labels = read_labels(compiled(worldbody), **options)
    return [labels.instances[i].name if i >= 0 else None for i in labels.geom_instance.tolist()]


SPHERE = '<geom size=".1"/>'


@pytest.mark.parametrize("category", MPCAT40[1:])
def test_every_category_but_void_makes_a_label(category):
    assert parse_label(f"{category}_07") == category


@pytest.mark.parametrize(
    "name", ["void_00", "chair", "chair_", "chair_a", "chair_03_leg", "my_chair_03", "Chair_03", ""]
)
def test_other_names_are_not_labels(name):
    assert parse_label(name) is None


def test_the_name_of_a_geom_comes_before_its_body_and_its_ancestors():
    world = f"""
      <body name="sofa_00">{SPHERE}<geom name="cushion_00" size=".1"/>
        <body>{SPHERE}<body name="frame">{SPHERE}</body></body>
        <body name="cushion_01">{SPHERE}<body name="button">{SPHERE}</body></body>
      </body>
      <geom name="wall_00" size=".1"/>"""
    assert owners(world) == ["wall_00", "sofa_00", "cushion_00", "sofa_00", "sofa_00", "cushion_01", "cushion_01"]


def test_an_instance_holds_all_its_geoms_and_each_geom_its_category():
    labels = read_labels(compiled(f'<body name="bed_00">{SPHERE}{SPHERE}</body><body name="bed_01">{SPHERE}</body>'))
    assert [(i.name, i.category, i.geom_ids) for i in labels.instances] == [
        ("bed_00", "bed", (0, 1)),
        ("bed_01", "bed", (2,)),
    ]
    assert labels.geom_category.tolist() == [MPCAT40_ID["bed"]] * 3
    assert [i.name for i in labels.of_category("bed")] == ["bed_00", "bed_01"]
    assert labels.of_category("sofa") == ()
    assert labels.categories() == ("bed",)
    assert labels.void_geoms == 0


def test_a_visible_geom_without_a_label_and_name_is_refused_by_its_place_and_body():
    with pytest.raises(HouseError, match=r"0.*\(1\.00.*2\.00.*0\.00\).*'thing'"):
        read_labels(compiled('<body name="thing"><geom size=".1" pos="1 2 0"/></body>'))


@pytest.mark.parametrize("hidden", ['group="3"', 'group="5"', 'rgba="1 1 1 0"', 'material="clear"'])
def test_a_geom_that_is_not_rendered_needs_no_label(hidden):
    model = compiled(f'<geom size=".1" {hidden}/>', '<material name="clear" rgba="1 1 1 0"/>')
    assert not rendered_geoms(model).any()
    assert read_labels(model).void_geoms == 0


def test_the_colour_of_a_geom_overrides_its_material():
    model = compiled(
        '<geom size=".1" material="clear" rgba="1 0 0 1"/><geom size=".1" group="2"/>',
        '<material name="clear" rgba="1 1 1 0"/>',
    )
    assert rendered_geoms(model).all()


def test_rules_label_geoms_that_the_pattern_does_not_and_the_rest_becomes_void():
    world = '<geom name="Chair.003" size=".1"/><geom name="sofa_00" size=".1"/><geom name="lump" size=".1"/>'
    labels = read_labels(compiled(world), rules={"^chair": "table", "[Cc]hair": "chair"})
    assert [i.category for i in labels.instances] == ["chair", "sofa"]
    assert labels.instances[0].name == "Chair.003"
    assert labels.void_geoms == 1
    assert labels.geom_category[2] == 0


def test_rules_are_tried_in_order_and_before_the_pattern():
    world = '<geom name="bedside_table" size=".1"/><geom name="sofa_00" size=".1"/>'
    rules = {"bedside": "cabinet", "bed": "bed", "sofa_00": "seating"}
    assert [i.category for i in read_labels(compiled(world), rules=rules).instances] == ["cabinet", "seating"]


def test_the_geoms_of_the_robot_belong_to_no_instance():
    robot = '<body name="stubborn_robot/base"><geom name="stubborn_robot/shell" size=".1"/><geom size=".1"/></body>'
    world = robot + '<geom name="wall_00" size=".1"/>'
    model = compiled(world)
    assert owners(world) == ["wall_00", None, None]
    assert geoms_of(model, "stubborn_robot/").tolist() == [False, True, True]
    assert read_labels(model).void_geoms == 0
