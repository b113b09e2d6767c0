import http.server
import math
import threading
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sim.app.bridges.habitat_sim.agent import AgentState
from sim.app.bridges.habitat_sim.maths import Deg, Quaternion, Rad, Vector3, quat_from_coeffs, quat_rotate_vector
from sim.app.bridges.habitat_sim.options import configure
from sim.app.bridges.habitat_sim.pathfinder import MARGIN_M, GreedyFollowerError, MultiGoalShortestPath, ShortestPath
from sim.app.bridges.habitat_sim.scenes import find_house
from sim.app.bridges.habitat_sim.semantics import semantic_scene
from sim.app.bridges.habitat_sim.settings import (
    ActionSpec,
    ActuationSpec,
    AgentConfiguration,
    CameraSensorSpec,
    Configuration,
    SensorType,
    SimulatorConfiguration,
)
from sim.app.bridges.habitat_sim.simulator import Simulator, _cameras
from sim.app.commands.habitat.dataset import require_format
from sim.app.services.frames import Frame
from sim.core.errors import ConfigError, EpisodeError, HouseError
from sim.episodes.splits import load_split
from sim.houses.house import House
from sim.houses.writing import house_text
from sim.world.world import World
from tests.helpers.worlds import bed_behind_a_wall, room, with_box

AHEAD = quat_from_coeffs([0.0, 0.0, 0.0, 1.0])
"""Looks along -z, which is +y in the frame of the house."""


def camera(uuid: str, kind: SensorType, **others: Any) -> CameraSensorSpec:
    return CameraSensorSpec(uuid, kind, resolution=[48, 64], position=[0.0, 0.88, 0.0], hfov=79.0, **others)


def simulator(tmp_path: Path, house: House, *, turn_deg: float = 30.0, **cameras: Any) -> Simulator:
    file = tmp_path / "house.xml"
    file.write_text(house_text(house.spec))
    specs = [
        camera("rgb", SensorType.COLOR),
        camera("depth", SensorType.DEPTH, **cameras),
        camera("semantic", SensorType.SEMANTIC),
    ]
    actions = {
        0: ActionSpec("stop"),
        1: ActionSpec("move_forward", ActuationSpec(0.25)),
        2: ActionSpec("turn_left", ActuationSpec(turn_deg)),
        3: ActionSpec("turn_right", ActuationSpec(turn_deg)),
        4: ActionSpec("look_up", ActuationSpec(30.0)),
    }
    agent = AgentConfiguration(sensor_specifications=specs, action_space=actions)
    return Simulator(Configuration(SimulatorConfiguration(scene_id=str(file)), [agent]))


def put(sim: Simulator, x: float, z: float, rotation: Any = AHEAD, *, initial: bool = False) -> None:
    sim.agents[0].set_state(AgentState(np.array([x, 0.0, z]), rotation), is_initial=initial)


@pytest.fixture
def empty(tmp_path: Path) -> Iterator[Simulator]:
    with simulator(tmp_path, room(4, 4)) as sim:
        put(sim, 0.0, 0.0, initial=True)
        yield sim


def test_an_action_moves_the_agent_in_habitats_frame(empty: Simulator) -> None:
    empty.step(1)
    state = empty.agents[0].state
    assert state.position == pytest.approx([0.0, 0.0, -0.25], abs=0.01)
    assert empty.step(2)["collided"] is False
    turned = quat_rotate_vector(empty.agents[0].state.rotation, [0.0, 0.0, -1.0])
    assert turned == pytest.approx([-0.5, 0.0, -math.cos(math.radians(30.0))], abs=0.01)


def test_the_angle_of_turns_is_that_of_the_action(tmp_path: Path) -> None:
    with simulator(tmp_path, room(4, 4), turn_deg=10.0) as sim:
        put(sim, 0.0, 0.0)
        sim.step(3)
        turned = quat_rotate_vector(sim.agents[0].state.rotation, [0.0, 0.0, -1.0])
        assert turned[0] == pytest.approx(math.sin(math.radians(10.0)), abs=0.01)


def test_a_wall_ends_the_action_by_contact(empty: Simulator) -> None:
    put(empty, 0.0, -1.75)
    assert empty.step(1)["collided"] is True
    assert empty.previous_step_collided
    assert empty.agents[0].state.position[2] == pytest.approx(-1.82, abs=0.01)


def test_a_robot_that_was_put_into_a_wall_stands_beside_it(empty: Simulator) -> None:
    put(empty, 0.0, -1.835)
    assert empty.step(2)["collided"] is False
    assert math.dist(empty.agents[0].state.position, (0.0, 0.0, -1.835)) <= 0.051
    put(empty, 0.0, -1.95)
    with pytest.raises(EpisodeError, match="cm inside 'wall"):
        empty.step(2)


def test_cameras_look_from_where_they_are_mounted(tmp_path: Path) -> None:
    for position, orientation, depth_m in (
        ([0.0, 0.88, 0.0], [0.0, 0.0, 0.0], 2.0),
        ([0.0, 0.88, -0.1], [0.0, 0.0, 0.0], 1.9),
        ([0.5, 0.88, 0.0], [0.0, math.pi / 2, 0.0], 2.5),
        ([0.0, 1.0, 0.0], [-math.pi / 2, 0.0, 0.0], 1.0),
        ([0.0, 1.0, 0.0], [-math.pi / 4, math.pi / 2, 0.0], math.sqrt(2.0)),  # to the left, and down from there
    ):
        with simulator(tmp_path, room(4, 4)) as sim:
            sim.add_sensor(
                CameraSensorSpec(
                    "own", SensorType.DEPTH, resolution=[31, 31], position=position, orientation=orientation, hfov=60.0
                )
            )
            put(sim, 0.0, 0.0)
            assert sim.get_sensor_observations()["own"][15, 15] == pytest.approx(depth_m, abs=0.01)


def test_looking_up_tilts_all_cameras_until_the_next_reset(empty: Simulator) -> None:
    level = empty.get_sensor_observations()["depth"][24, 32]
    assert empty.step(4)["depth"][24, 32] == pytest.approx(level / math.cos(math.radians(30.0)), abs=0.03)
    assert empty.agents[0].state.sensor_states["depth"].rotation.x == pytest.approx(math.sin(math.radians(15.0)))
    assert empty.reset()["depth"][24, 32] == pytest.approx(level, abs=0.01)


def test_a_field_of_view_may_be_given_in_radians() -> None:
    specs = [replace(camera("depth", SensorType.DEPTH), hfov=hfov) for hfov in (90.0, Deg(90.0), Rad(math.pi / 2))]
    assert [model.hfov_rad for model in _cameras(specs)] == [pytest.approx(math.pi / 2)]


def test_a_constraint_limits_the_tilt(empty: Simulator) -> None:
    actuation = empty.agents[0].agent_config.action_space[4].actuation
    assert actuation is not None
    actuation.constraint = 40.0
    for tilt_deg in (30.0, 40.0, 40.0):
        empty.step(4)
        tilt = empty.agents[0].state.sensor_states["depth"].rotation.x
        assert tilt == pytest.approx(math.sin(math.radians(tilt_deg / 2)))


def test_a_list_of_agents_gives_the_observations_of_each(empty: Simulator) -> None:
    assert empty.step({0: 1})[0]["collided"] is False
    assert empty.get_sensor_observations([0])[0].keys() == empty.get_sensor_observations(0).keys()


def test_a_reset_brings_the_agent_back_to_its_initial_state(empty: Simulator) -> None:
    put(empty, 1.0, 0.5, initial=True)
    put(empty, -1.0, 0.5)
    empty.step(1)
    empty.reset()
    assert empty.agents[0].state.position == pytest.approx([1.0, 0.0, 0.5], abs=1e-6)
    empty.step(1)
    assert empty.agents[0].state.position == pytest.approx([1.0, 0.0, 0.25], abs=0.01)


def test_a_pose_that_is_set_and_set_back_leaves_physics_untouched(empty: Simulator) -> None:
    empty.step(1)
    before, here = empty.world.data.qpos.copy(), empty.agents[0].state
    put(empty, 1.0, 1.0)
    seen = empty.get_sensor_observations()["depth"][24, 32]
    empty.agents[0].set_state(here)
    empty.settle()
    assert seen == pytest.approx(3.0, abs=0.02)
    assert (empty.world.data.qpos == before).all()
    put(empty, 1.0, 1.0)
    empty.step(1)
    assert empty.agents[0].state.position == pytest.approx([1.0, 0.0, 0.75], abs=0.01)


def test_semantic_images_hold_indices_of_the_semantic_scene(tmp_path: Path) -> None:
    house = with_box(room(6, 6), "sofa_00", centre_m=(0, 2.5, 0.4), half_m=(0.8, 0.4, 0.4))
    with simulator(tmp_path, house) as sim:
        put(sim, 0.0, 0.0)
        scene = sim.semantic_scene
        sofa = next(item for item in scene.objects if item.category.name() == "sofa")
        assert sofa.semantic_id == scene.objects.index(sofa) == int(sofa.id.split("_")[-1])
        assert sofa.semantic_id in sim.get_sensor_observations()["semantic"]
        assert sofa.aabb.center() == pytest.approx([0.0, 0.4, -2.5])
        assert sofa.aabb.sizes == pytest.approx([1.6, 0.8, 0.8])
        assert sofa.region is not None
        assert sofa.region.category.name() == "living"
        assert scene.get_regions_for_point(np.array([0.0, 1.0, 0.0])) == [0]


def test_a_plane_has_the_box_of_the_rectangle_that_is_rendered() -> None:
    scene = semantic_scene(World(room(6, 4)))
    floor = next(item for item in scene.objects if item.category.name() == "floor")
    assert floor.aabb.sizes == pytest.approx([6.2, 0.0, 4.2], abs=0.01)
    assert scene.aabb.sizes == pytest.approx([6.2, 2.5, 4.2], abs=0.2)


@pytest.mark.parametrize(
    ("split", "name", "message"),
    [("words-seen", "v1", "give --format ovon or goat"), ("chains-val", "ovon", "give --format goat"),
     ("pictures", "v2", "give --format goat"), ("pictures", "goat", ""), ("words-seen", "ovon", ""), ("val", "v1", "")],
)  # fmt: skip
def test_a_dataset_has_a_format_that_holds_its_goals(split: str, name: str, message: str) -> None:
    if message:
        with pytest.raises(ConfigError, match=message):
            require_format(name, load_split(split))
    else:
        require_format(name, load_split(split))


def test_paths_lead_around_walls(tmp_path: Path) -> None:
    with simulator(tmp_path, bed_behind_a_wall()) as sim:
        path = ShortestPath()
        path.requested_start, path.requested_end = [-1.0, 0.0, -1.0], [2.0, 0.0, -1.0]
        assert sim.pathfinder.find_path(path)
        corner = math.dist((-1.0, 1.0), (0.27, -0.2)) + math.dist((0.73, -0.2), (2.0, 1.0)) + 0.5
        assert path.geodesic_distance == pytest.approx(corner, abs=0.15)
        points = np.array(path.points)
        assert np.linalg.norm(np.diff(points, axis=0), axis=1).sum() == pytest.approx(path.geodesic_distance, abs=0.1)
        assert 3 <= len(points) <= 6
        several = MultiGoalShortestPath()
        several.requested_start = [-1.0, 0.0, -1.0]
        several.requested_ends = [[2.0, 0.0, -1.0], [-2.0, 0.0, -1.0]]
        assert sim.pathfinder.find_path(several)
        assert several.geodesic_distance == pytest.approx(1.0, abs=0.03)
        assert several.closest_end_point_index == 1
        path.requested_start = [0.0, 5.0, 0.0]
        assert not sim.pathfinder.find_path(path)
        assert math.isinf(path.geodesic_distance)
        assert path.points == []


def test_the_follower_drives_to_a_place_and_stops_there(tmp_path: Path) -> None:
    with simulator(tmp_path, bed_behind_a_wall()) as sim:
        put(sim, -1.0, -1.0)
        follower = sim.make_greedy_follower(0, 0.2, stop_key=0, forward_key=1, left_key=2, right_key=3)
        action = None
        for _ in range(60):
            action = follower.next_action_along([2.0, 0.0, -1.0])
            if action == 0:
                break
            sim.step(action)
        assert action == 0
        assert sim.agents[0].state.position == pytest.approx([2.0, 0.0, -1.0], abs=0.3)
        with pytest.raises(GreedyFollowerError):
            follower.next_action_along([30.0, 0.0, 0.0])


def test_the_pathfinder_knows_where_the_robot_fits(empty: Simulator) -> None:
    finder, reach_m = empty.pathfinder, 2.0 - empty.world.robot.radius_m
    low, high = finder.get_bounds()
    box_m = reach_m + MARGIN_M  # a robot that a contact ended is a little outside of the free cells
    assert (low.x, low.z, high.x, high.z) == pytest.approx((-box_m, -box_m, box_m, box_m), abs=0.03)
    assert finder.is_navigable([1.7, 0.0, 0.0])
    assert not finder.is_navigable([1.9, 0.0, 0.0])
    assert not finder.is_navigable([0.0, 1.0, 0.0])
    assert finder.snap_point([1.95, 0.3, 0.0]) == pytest.approx([reach_m, 0.0, 0.0], abs=0.03)
    assert np.isnan(finder.snap_point([9.0, 0.0, 0.0])).all()
    assert finder.distance_to_closest_obstacle([1.0, 0.0, 0.0]) == pytest.approx(reach_m - 1.0, abs=0.03)
    view = finder.get_topdown_view(0.1, 0.0)
    assert view.shape == pytest.approx((39, 39), abs=1)
    assert view[2:-2, 2:-2].all()
    assert not view[0].any()
    assert finder.island_radius([0.0, 0.0, 0.0]) == pytest.approx(reach_m * math.sqrt(2.0), abs=0.05)
    finder.seed(7)
    assert all(finder.is_navigable(finder.get_random_navigable_point()) for _ in range(5))
    near = finder.get_random_navigable_point_near([1.0, 0.0, 1.0], 0.3)
    assert math.dist(near, (1.0, 0.0, 1.0)) <= 0.3


def test_obstacles_are_looked_for_within_a_circle_and_inside_the_house(tmp_path: Path) -> None:
    house = with_box(room(6, 4), "cabinet_00", centre_m=(0.0, 0.0, 0.5), half_m=(0.2, 0.2, 0.5))
    with simulator(tmp_path, house) as sim:
        finder = sim.pathfinder
        beyond_corner = 0.2 + (sim.world.robot.radius_m + 0.35) / math.sqrt(2.0)
        point = [beyond_corner, 0.0, -beyond_corner]
        assert finder.distance_to_closest_obstacle(point) == pytest.approx(0.35, abs=0.04)
        assert finder.distance_to_closest_obstacle(point, 0.3) == 0.3
        assert math.isinf(finder.distance_to_closest_obstacle([100.0, 0.0, 100.0]))
        assert math.isinf(finder.distance_to_closest_obstacle([math.nan, 0.0, 0.0]))
        for start, end in (([math.nan, 0.0, 0.0], point), (point, [math.nan, 0.0, 0.0])):
            np.testing.assert_allclose(finder.try_step(start, end), start, rtol=1e-6)


@pytest.mark.parametrize("scene", ["", "/"])
def test_a_scene_without_a_name_is_no_house(scene: str) -> None:
    with pytest.raises(HouseError, match="There is no house"):
        find_house(scene)


def test_points_on_an_island_are_on_that_island(tmp_path: Path) -> None:
    house = with_box(room(6, 4), "cabinet_00", centre_m=(1.0, 0.0, 0.5), half_m=(0.2, 2.0, 0.5))
    with simulator(tmp_path, house) as sim:
        finder = sim.pathfinder
        left, right = finder.get_island([-1.0, 0.0, 0.0]), finder.get_island([2.0, 0.0, 0.0])
        assert {left, right} == {0, 1}
        assert finder.island_area(left) > finder.island_area(right) > 0.0
        assert all(finder.get_random_navigable_point(island_index=right)[0] > 1.2 for _ in range(10))
        assert finder.get_random_navigable_point_near([0.5, 0.0, 0.0], 1.5, island_index=right)[0] > 1.2
        assert finder.snap_point([0.5, 0.0, 0.0], right) == pytest.approx([1.39, 0.0, 0.0], abs=0.03)
        with pytest.raises(ConfigError, match="There is no island 2: the free space has 2"):
            finder.snap_point([0.5, 0.0, 0.0], 2)


def test_steps_without_physics_stop_or_slide(empty: Simulator) -> None:
    finder, reach_m = empty.pathfinder, 2.0 - empty.world.robot.radius_m
    start, end = [1.7, 0.0, 0.0], [1.95, 0.0, -0.25]
    stopped, slid = finder.try_step_no_sliding(start, end), finder.try_step(start, end)
    assert stopped == pytest.approx([reach_m, 0.0, -(reach_m - 1.7)], abs=0.03)
    assert slid == pytest.approx([reach_m, 0.0, -0.25], abs=0.03)


def test_options_apply_to_simulators_that_are_made_later(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sim.app.bridges.habitat_sim.options._chosen", {})
    monkeypatch.setenv("STUBBORN_HABITAT", "motion=no-sliding")
    with simulator(tmp_path, room(4, 4)) as sim:
        put(sim, 0.0, -1.75)
        assert sim.step(1)["collided"]
        assert sim.world.config.motion == "no-sliding"
    configure(motion="contacts", noise="realsense")
    with simulator(tmp_path, room(4, 4)) as sim:
        put(sim, 0.0, 0.0)
        first, second = (sim.get_sensor_observations()["depth"] for _ in range(2))
        assert (first != second).any()
        mount = CameraSensorSpec("high", SensorType.DEPTH, resolution=[48, 64], position=[0.0, 0.88, 0.1], hfov=79.0)
        sim.add_sensor(mount)
        sim.reset()
        seen = sim.get_sensor_observations()
        assert seen["high"].std() > 0.0  # a camera somewhere else has noise of its own
        assert seen["rgb"].shape == (48, 64, 4)
    with pytest.raises(ConfigError, match="motion must be"):
        configure(motion="hovering")
    with pytest.raises(ConfigError, match="profile 'bad'"):
        configure(profile="bad")
    with pytest.raises(ConfigError, match="'speed'"):
        configure(speed="high")


def test_each_picture_is_registered_with_its_truth_at_a_server(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    got: list[Frame] = []

    class Handler(http.server.BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            got.append(Frame.from_bytes(self.rfile.read(int(self.headers["content-length"]))))
            self.send_response(204)
            self.end_headers()

        def log_message(self, format: str, *args: object) -> None:
            pass

    monkeypatch.setattr("sim.app.bridges.habitat_sim.options._chosen", {})
    with http.server.HTTPServer(("127.0.0.1", 0), Handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        monkeypatch.setenv("STUBBORN_HABITAT", f"detectors=http://127.0.0.1:{server.server_port}")
        with simulator(tmp_path, bed_behind_a_wall()) as sim:
            put(sim, 0.0, 0.0)
            sim.get_sensor_observations()
            seen = sim.step(2)
            server.shutdown()
            first, second = got
            np.testing.assert_array_equal(second.rgb, seen["rgb"][..., :3])
            assert (first.rgb != second.rgb).any()
            assert second.number == first.number + 1
            assert "bed" in second.categories
            shown = {second.names[index] for index in np.unique(second.objects) if index >= 0}
            named = [sim.semantic_scene.objects[number].category.name() for number in np.unique(seen["semantic"])]
            assert {name.rsplit("_", 1)[0] for name in shown} == set(named) - {"void"}
            server.server_close()
            with pytest.raises(ConfigError, match="serve detectors"):
                sim.step(2)


def test_what_is_not_here_is_refused(tmp_path: Path) -> None:
    with pytest.raises(HouseError, match="no house"):
        Simulator(Configuration(SimulatorConfiguration(scene_id="mp3d/17DRP/17DRP.glb"), [AgentConfiguration()]))
    with pytest.raises(ConfigError, match="noise model 'Redwood"):
        simulator(tmp_path, room(4, 4), noise_model="RedwoodDepthNoiseModel")
    with simulator(tmp_path, room(4, 4)) as sim, pytest.raises(ConfigError, match="Unknown action 9"):
        sim.step(9)


def test_a_vector_is_a_list_of_python_floats_and_an_array() -> None:
    vector = Vector3(1.0, 2.0, 3.0)
    assert [type(value) for value in vector] == [float] * 3  # JSON and OmegaConf take no others
    difference = vector - np.ones(3)
    assert isinstance(difference, Vector3)
    assert difference.dot() == pytest.approx(5.0)


def test_quaternions_of_both_kinds_agree() -> None:
    turn = Quaternion.rotation(Deg(90.0), Vector3.y_axis())
    assert turn.transform_vector([0.0, 0.0, -1.0]) == pytest.approx([-1.0, 0.0, 0.0], abs=1e-6)
    both = turn * Quaternion.rotation(Deg(90.0), Vector3.x_axis())
    assert both.transform_vector([0.0, 0.0, -1.0]) == pytest.approx([0.0, 1.0, 0.0], abs=1e-6)
