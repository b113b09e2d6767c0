"""Descriptions: each fits exactly one object, and says nothing that is nearly true of another one."""

from __future__ import annotations

import numpy as np
import pytest

from sim.core.interface import CameraModel
from sim.core.wishes import parse_wish
from sim.episodes.descriptions import Description, Descriptions
from sim.episodes.splits import load_split
from sim.task.objectnav import Task
from sim.world.world import World
from tests.helpers.worlds import room, with_box, with_facts, with_post

SMALL = CameraModel(width_px=160, height_px=120)


def written(house) -> tuple[Task, list[Description]]:
    task = Task(World(house))
    task.world.restore()
    descriptions = Descriptions(task, SMALL, "fast")
    try:
        rng = np.random.default_rng(0)
        return task, [one for item in task.truth.meaning.objects if item.is_goal for one in descriptions.of(item, rng)]
    finally:
        descriptions.close()


def chairs(*sizes: float):
    house, facts = room(8, 8), {}
    for i, half in enumerate(sizes):
        house = with_box(house, f"chair_0{i}", centre_m=(-3.0 + 2.0 * i, 2.0, half), half_m=(half, half, half))
        facts[f"chair_0{i}"] = "name: armchair"
    return with_facts(house, **facts)


def test_each_description_fits_one_object_and_names_it():
    house = with_box(chairs(0.3, 0.3), "table_00", centre_m=(-3.0, 1.25, 0.4), half_m=(0.3, 0.3, 0.4))
    task, texts = written(with_facts(house, table_00="name: desk"))
    assert any(one.text.endswith("the desk") for one in texts)
    for one in texts:
        assert [instance.name for instance in task.truth.instances(one.text)] == [one.instance], one


def test_equal_objects_have_no_description():
    assert written(chairs(0.3, 0.3))[1] == []


@pytest.mark.parametrize(
    ("sizes", "told"), [((0.3, 0.32, 0.34), False), ((0.3, 0.42), False), ((0.2, 0.3, 0.42), True)]
)
def test_sizes_must_differ_clearly(sizes, told):
    texts = [one.text for one in written(chairs(*sizes))[1]]
    assert any("largest" in text or "biggest" in text for text in texts) == told
    assert any("smallest" in text for text in texts) == told


def test_a_gap_near_the_limit_proves_nothing():
    house = with_box(chairs(0.3, 0.3), "table_00", centre_m=(-1.95, 2.0, 0.4), half_m=(0.3, 0.3, 0.4))
    task, texts = written(with_facts(house, table_00="name: desk"))  # gaps of 0.45 and 0.35 m
    assert len(task.truth.instances("armchair next to the desk")) == 2
    assert not any("desk" in one.text for one in texts if one.instance.startswith("chair"))


def test_a_colour_that_is_not_seen_is_not_said():
    grey = chairs(0.3, 0.3)
    lying = with_facts(grey)
    spec = lying.spec.copy()
    for text in spec.texts:
        if text.name == "chair_00":
            text.data = "name: armchair; colour: red"
    texts = written(type(grey)(grey.name, spec))[1]
    assert parse_wish("red armchair").colour == "red"
    assert not any("red" in one.text.split() for one in texts)


def test_round_and_on_the_rug_are_said_where_they_are_clear():
    house = room(10, 6)
    for name, x_m in {"table_00": -3.0, "table_01": 0.0, "table_02": 3.0}.items():
        half_m = (0.5, 0.5, 0.2)
        house = with_box(house, name, centre_m=(x_m, 0.0, 0.2), half_m=half_m) if name != "table_00" else house
    house = with_post(house, "table_00", xy_m=(-3.0, 0.0), radius_m=0.5, height_m=0.4)
    house = with_box(house, "floor_01", centre_m=(3.0, 0.0, 0.004), half_m=(0.9, 0.9, 0.004))
    facts = dict.fromkeys(("table_00", "table_01", "table_02"), "name: coffee table") | {"floor_01": "name: rug"}
    task, texts = written(with_facts(house, **facts))
    told = {one.instance: one.text for one in texts if one.level == 1}
    assert told["table_00"].endswith("the round coffee table")
    assert told["table_02"].endswith("the coffee table on the rug")
    assert "table_01" not in told  # square, as the third one
    assert [instance.name for instance in task.truth.instances("round coffee table")] == ["table_00"]
    assert [instance.name for instance in task.truth.instances("the table on the rug")] == ["table_02"]


def test_an_object_with_its_edge_on_the_rug_is_not_said_to_be_on_it():
    house = with_box(chairs(0.3, 0.3), "floor_01", centre_m=(-2.4, 2.0, 0.004), half_m=(0.5, 0.5, 0.004))
    assert not any("rug" in one.text for one in written(with_facts(house, floor_01="name: rug"))[1])


@pytest.mark.costly
@pytest.mark.parametrize(
    ("home", "house", "names"),
    [
        ("val", "val_03", ("words-seen", "words-synonyms", "words-unseen", "descriptions")),
        ("val", "val_17", ("words-seen", "words-synonyms", "words-unseen", "descriptions")),
        ("test", "test_05", ("words-seen-test", "words-synonyms-test", "words-unseen-test")),
    ],
)
def test_the_episodes_of_shipped_splits_mean_what_they_meant_when_they_were_made(home, house, names):
    task = Task(World(load_split(home).load_house(house)))
    of_house = [(name, episode) for name in names for episode in load_split(name).episodes if episode.house == house]
    assert len(of_house) == 5 * len(names)
    for name, episode in of_house:
        assert task.distance_from(episode.goal, episode.start) == pytest.approx(episode.shortest_path_m, abs=1e-3), (
            episode
        )
        assert name != "descriptions" or len(task.truth.instances(episode.goal)) == 1
