"""Conformance test of every shipped house and of newly generated ones of both pools; each commit tests a sample.

Of the train houses in the list every tenth is tested: the checksums show that the others passed the generator's check.
"""

from __future__ import annotations

import gzip
import json
import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from sim.core.geometry.pose import Pose
from sim.core.interface import CameraModel
from sim.core.paths import assets_dir
from sim.env.scene import Scene
from sim.episodes import habitat
from sim.episodes.drawing import sample_episode
from sim.episodes.episode import Episode
from sim.episodes.reachable_goals import find_reachable_goals
from sim.episodes.recipes import DEFAULT_RECIPE, EPISODE_RECIPES, EpisodeRecipe
from sim.episodes.splits import Split, load_split, one_house, shipped_splits
from sim.gl import mujoco
from sim.homes.housegen.furniture.item import Pool
from sim.homes.housegen.generator import HouseConfig, generate_house
from sim.homes.housegen.splits.recipes import SPLIT_VERSION
from sim.houses.labels import collidable_geoms, geoms_of, rendered_geoms
from sim.houses.writing import house_text
from sim.robot.config import RobotConfig
from sim.world.check import check_house
from sim.world.freespace import connected_to
from tests.helpers.sampling import sample

FIRST_FRESH_SEED = 900_000
"""No split has such a seed."""
FRESH: list[tuple[Pool, int]] = [(pool, FIRST_FRESH_SEED + n) for n in range(15) for pool in ("train", "heldout")]
SPLITS = ("val", "test", "large", "large-test", "hazards", "hazards-test")
SHIPPED = [(split, house) for split in SPLITS for house in load_split(split).houses]
LISTED = [("train", house) for house in load_split("train").houses[::10]] if "train" in shipped_splits() else []
CASES = [*sample([*SHIPPED, *LISTED], 1), *sample(FRESH, 1)]
SMALL = CameraModel(width_px=320, height_px=240)
VIEWS = 40
EPISODES, GOALS = 12, 5
AT_REST_S = 0.5
ROLL_M = 0.02
"""Motors that hold a speed of zero creep under a force: on the edge of a rug a wheel rolls up to 13 mm in this time."""
KIND_OF_FRESH = ("studio", "flat", "corridor", "lshape", "openplan", "large")


@dataclass(frozen=True)
class Case:
    """A house with its scene and its episodes."""

    scene: Scene
    episodes: list[Episode]
    goals: dict[str, list[habitat.Goal]]
    """Goals of each category with their view points."""
    recipe: EpisodeRecipe = DEFAULT_RECIPE
    version: str = SPLIT_VERSION
    """Houses of older splits do not follow the rules of today's for furniture and floor plans."""

    @property
    def floors_m(self) -> list[float]:
        """Returns the floor height of each storey that has rooms."""
        heights = sorted(room.floor_z_m for room in self.scene.world.rooms)
        return [z for n, z in enumerate(heights) if n == 0 or z - heights[n - 1] > 1.0]


@pytest.fixture(scope="module", params=CASES, ids=lambda case: f"{case[0]}-{case[1]}")
def case(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Case]:
    split_name, house = request.param
    fresh = isinstance(house, int)
    split = one_house(written(tmp_path_factory.mktemp("fresh"), split_name, house)) if fresh else load_split(split_name)
    name = split.houses[0] if fresh else house
    scene = Scene(split.load_house(name), robot=RobotConfig(), camera=SMALL, profile="fast")
    if fresh:
        rng = np.random.default_rng(0)
        episodes = [sample_episode(scene.task, name, rng) for _ in range(3)]
        yield Case(scene, episodes, dict(find_reachable_goals(scene.task).listed))
    else:
        episodes = [episode for episode in split.episodes if episode.house == name]
        yield Case(scene, episodes, goals_in_file(split, name), EPISODE_RECIPES[split_name], split.version)
    scene.close()


def written(folder: Path, pool: Pool, seed: int) -> Path:
    """Generates a house and returns its file."""
    kind = KIND_OF_FRESH[seed // 2 % len(KIND_OF_FRESH)]
    house = generate_house(seed, HouseConfig(pool=pool, kind=kind, movable=seed % 3 == 1))
    path = folder / f"{pool}_{seed}.xml"
    path.write_text(house_text(house.spec, str(assets_dir() / "textures")))
    return path


def goals_in_file(split: Split, house: str) -> dict[str, list[habitat.Goal]]:
    content = json.loads(gzip.decompress((assets_dir() / split.name / "content" / f"{house}.json.gz").read_bytes()))
    return {key.removeprefix(f"{house}.xml_"): goals for key, goals in content["goals_by_category"].items()}


def pushing(model: mujoco.MjModel, data: mujoco.MjData) -> list[int]:
    """Returns the indices of the contacts that transmit a force."""
    wrench, found = np.zeros(6), []
    for number in range(data.ncon):
        mujoco.mj_contactForce(model, data, number, wrench)
        if wrench[0] > 1e-6:
            found.append(number)
    return found


@pytest.mark.costly
def test_the_check_finds_no_fault(case: Case) -> None:
    assert check_house(case.scene.world.house.spec, furnished=case.version == SPLIT_VERSION) == []


def test_all_visual_geoms_are_labelled(case: Case) -> None:
    world = case.scene.world
    seen = rendered_geoms(world.model) & ~geoms_of(world.model, "stubborn_robot/")
    assert seen.any()
    assert (world.labels.geom_category[seen] != 0).all()
    assert (world.labels.geom_instance[seen] >= 0).all()


def test_movable_objects_overlap_others_by_less_than_a_centimetre(case: Case) -> None:
    model = case.scene.world.model
    at_rest = mujoco.MjData(model)
    mujoco.mj_forward(model, at_rest)
    objects = collidable_geoms(model) & ~geoms_of(model, "stubborn_robot/")
    between_objects = objects[at_rest.contact.geom].all(axis=1)
    assert (at_rest.contact.dist[between_objects] > -0.01).all()


@pytest.mark.costly
def test_the_free_space_is_connected_and_reaches_every_room(case: Case) -> None:
    for floor_m in case.floors_m:
        space = case.scene.task.truth.space(floor_m)
        part = connected_to(space.free, space.largest_part())  # with the rooms behind leaves that are ajar
        assert part.sum() > 0.97 * space.free.sum()
        places = space.frame.to_metres(np.argwhere(part)[::7])
        for room in case.scene.world.rooms:
            if abs(room.floor_z_m - floor_m) < 1.0:
                inside = sum(room.contains(x, y) for x, y in places.tolist())
                assert inside * 7 * space.frame.cell_m**2 > 0.1, room.name


@pytest.mark.costly
def test_every_goal_instance_can_be_reached_from_its_view_points(case: Case) -> None:
    assert {episode.goal for episode in case.episodes} <= set(case.goals)
    for goal in sample(sorted(case.goals), GOALS):
        for entry in case.goals[goal]:
            places = [habitat.from_position(view["agent_state"]["position"]) for view in entry["view_points"]]
            assert len(places) >= 1
            floor_m = min(case.floors_m, key=lambda z: abs(z - places[0][2]))
            space = case.scene.task.truth.space(floor_m)
            region = case.scene.task.truth.target(goal, floor_m).region
            footprints = {footprint.instance.name: footprint for footprint in region.footprints}
            cells = space.frame.to_cells([place[:2] for place in places])  # files round to the millimetre
            assert space.frame.inside(cells).all()
            assert space.largest_part()[tuple(cells.T)].all()
            assert region.reaches(footprints[entry["object_name"]], space.frame.to_metres(cells)).all()


@pytest.mark.costly
def test_the_distance_from_start_to_goal_is_the_recorded_one_and_within_the_limits(case: Case) -> None:
    for episode in sample(case.episodes, EPISODES):
        distance_m = case.scene.task.distance_from(episode.goal, episode.start)
        assert distance_m is not None, episode
        assert distance_m == pytest.approx(episode.shortest_path_m, abs=0.01)
        nearest_m = min(case.recipe.min_distance_m, case.recipe.only_instance_min_distance_m or math.inf)
        assert nearest_m - 0.01 <= distance_m <= case.recipe.max_distance_m + 0.01


def test_after_half_a_second_at_rest_a_start_touches_only_the_floor_and_only_with_wheels(case: Case) -> None:
    world = case.scene.world
    robot = geoms_of(world.model, "stubborn_robot/")
    rolling = np.array([world.model.geom(i).name.endswith(("_tyre", "_caster")) for i in range(world.model.ngeom)])
    assert rolling.sum() >= 3
    for episode in sample(case.episodes, EPISODES):
        world.reset(episode.start)
        mujoco.mj_step(world.model, world.data, nstep=round(AT_REST_S / world.model.opt.timestep))
        assert world.pose.distance_to(episode.start) < ROLL_M
        pairs = world.data.contact.geom[pushing(world.model, world.data)]
        touching = pairs[robot[pairs].any(axis=1)]
        assert len(touching) >= 2
        assert rolling[touching[robot[touching]]].all(), episode


def test_no_robot_view_shows_void(case: Case) -> None:
    scene, rng = case.scene, np.random.default_rng(0)
    for floor_m in case.floors_m:
        space = scene.task.truth.space(floor_m)
        cells = np.argwhere(space.free)
        for _ in range(VIEWS // len(case.floors_m)):
            x_m, y_m = space.frame.to_metres(cells[rng.integers(len(cells))])
            pose = Pose(float(x_m), float(y_m), float(rng.uniform(-np.pi, np.pi)), floor_m)
            semantic = scene.camera.render(scene.world.data, pose, ("semantic",))["semantic"]
            assert (semantic == 0).sum() == 0, pose
