"""Goals in words: which objects of a house satisfy them, and when a STOP for them succeeds."""

from __future__ import annotations

import numpy as np
import pytest

from sim.core.errors import EpisodeError, HouseError
from sim.core.geometry.pose import Pose
from sim.core.interface import Action
from sim.task.objectnav import Task
from sim.world.world import World
from tests.helpers.worlds import furnished, room, with_box, with_facts


@pytest.fixture(scope="module")
def task() -> Task:
    return Task(World(furnished()))


def found(task: Task, goal: str) -> list[str]:
    return [instance.name for instance in task.truth.instances(goal)]


@pytest.mark.parametrize(
    ("goal", "expected"),
    [
        ("chair", ["chair_00", "chair_01", "chair_02"]), ("a chair", ["chair_00", "chair_01", "chair_02"]),
        ("chair_01", ["chair_01"]), ("armchair", ["chair_00", "chair_01"]), ("the blue chair", ["chair_02"]),
        ("leather armchair", ["chair_01"]), ("red chair next to the desk", ["chair_01"]),
        ("the largest chair", ["chair_02"]), ("lamp on the desk", ["lighting_00"]), ("lamp", ["lighting_00"]),
        ("something to sit on", ["chair_00", "chair_01", "chair_02"]), ("wooden writing desk", ["table_00"]),
    ],
)  # fmt: skip
def test_objects_that_satisfy_a_goal(task, goal, expected):
    assert found(task, goal) == expected


@pytest.mark.parametrize(
    ("goal", "words"),
    [
        ("kettle", "has no 'kettle'. It has: armchair, desk, desk lamp, office chair."),
        (
            "green chair",
            "It has: blue office chair (living), red fabric armchair (living), red leather armchair (living)",
        ),
        ("the smaller of the two chairs", "has 3 objects for 'smaller of the two chairs', not 2"),
        ("pendant lamp", "has no 'pendant lamp'"),
        ("chair_77", "has no 'chair_77'. It has: chair_00, chair_01, chair_02."),
        ("bed_00", "has no 'bed_00'. It has: chair, table."),
    ],
)
def test_what_a_house_cannot_satisfy_is_told_with_what_there_is(task, goal, words):
    with pytest.raises(EpisodeError) as refused:
        task.truth.instances(goal)
    assert words in str(refused.value)


def test_a_wrong_text_about_an_object_names_the_house():
    house = with_box(room(5, 4), "chair_00", centre_m=(1.0, 0.0, 0.4), half_m=(0.2, 0.2, 0.4))
    with pytest.raises(HouseError, match="House 'room': the text of instance 'chair_00' must look like"):
        Task(World(with_facts(house, chair_00="color: red"))).truth.instances("red chair")


def test_only_the_object_that_was_asked_for_counts():
    task = Task(World(furnished()))
    task.world.reset(Pose(2.2, 3.0, 0.0))
    task.begin("the red chair next to the desk", task.world.pose)
    assert task.distance_from("chair", task.start) == 0.0
    assert (task.metrics().distance_to_goal or 0.0) > 3.0
    assert task.images == ("semantic", "geom")
    geom = np.array(
        [[task.truth.instances("chair_01")[0].geom_ids[0], task.truth.instances("chair_00")[0].geom_ids[0]]]
    )
    images = {"semantic": np.full((1, 2), 3, np.uint8), "geom": geom}
    assert task.goal_mask(images).tolist() == [[True, False]]
    task.look(images)
    task.observe(Action.STOP, task.world.move(Action.STOP), images)
    assert not task.success


def test_a_stop_at_the_object_that_was_asked_for_succeeds():
    task = Task(World(furnished()))
    task.world.reset(Pose(-3.0, 1.0, 0.0))
    task.begin("the red chair next to the desk", task.world.pose)
    task.observe(Action.STOP, task.world.move(Action.STOP))
    assert task.success
