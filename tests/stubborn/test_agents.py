"""Properties of every agent that `stubborn.agents.make` knows, of the example, and of an agent in another process."""

import dataclasses
import subprocess
import sys
from typing import Any

import numpy as np
import pytest

from examples import map_agent, my_agent
from sim.app.bridges.habitat.agents import HabitatAgent
from sim.app.bridges.habitat.conversions import Conversion
from sim.app.bridges.process import ProcessAgent
from sim.app.bridges.process_command import ProcessConfig
from sim.core.interface import (
    MPCAT40_ID,
    Action,
    Agent,
    ConfigError,
    Observation,
    RobotModel,
    Scores,
    SegmenterSpec,
    SuccessRule,
)
from stubborn import agents
from stubborn.agent import AgentConfig, StubbornAgent
from stubborn.detection.classifiers import Features
from stubborn.detection.fusion import Fusion
from stubborn.detection.look import LookConfig
from stubborn.detection.seeker import TargetSeeker
from stubborn.detection.track_seeker import TrackSeeker, TrackSeekerConfig
from stubborn.detection.verification import AcceptAll
from stubborn.exploration.corners import CornerConfig, CornerExplorer
from stubborn.mapping.mapper import Sighting
from stubborn.mapping.object_layers import AllFrames, LatestFrame
from stubborn.planning.untrap import UntrapConfig
from stubborn.segmentation.ground_truth import GroundTruthSegmenter
from tests.helpers.gridworld import SMALL_CAMERA, Box, GridWorld, boxes_from_plan, run_episode
from tests.helpers.habitat_agents import Wanderer
from tests.helpers.sampling import sample

PLAN = """
####################
#        #         #
#  bb             u#
#  bb    #         #
#        #    tt   #
####  ########  ####
#        #         #
#    g       p     #
#        #         #
####################
"""
BOXES = boxes_from_plan(PLAN, 0.3)
STEPS = 40


def build(name: str, **options: Any) -> Agent:
    if name == "example":
        return my_agent.make(
            camera=SMALL_CAMERA,
            robot=RobotModel(),
            success=SuccessRule(),
            segmenter=GroundTruthSegmenter(),
            verifier=AcceptAll(),
            config=None,
        )
    if name == "habitat":
        return HabitatAgent(Wanderer(), Conversion(camera=SMALL_CAMERA))
    if name == "process":
        client = [sys.executable, "tests/helpers/client_agent.py"]
        parts: dict[str, Any] = {"camera": SMALL_CAMERA, "robot": RobotModel(), "success": SuccessRule()}
        return ProcessAgent(client, **parts, config=ProcessConfig(), max_steps=500)
    return agents.make(name, camera=SMALL_CAMERA, robot=RobotModel(), segmenter=GroundTruthSegmenter(), **options)


def world() -> GridWorld:
    return GridWorld(BOXES, (0.75, 0.75, 0.7), camera=SMALL_CAMERA)


AGENTS = [*agents.NAMES, "example", "habitat", "process"]
every_agent = pytest.mark.parametrize("name", AGENTS)
some_agents = pytest.mark.parametrize("name", sample(AGENTS, 6))


@pytest.mark.costly
@some_agents
def test_actions_are_valid_and_the_same_seed_gives_the_same_episode(name: str):
    first, second = (run_episode(world(), build(name), "plant", seed=7, max_steps=STEPS) for _ in range(2))
    assert all(isinstance(action, Action) for action in first.actions)
    assert first.actions == second.actions


@pytest.mark.costly
@pytest.mark.parametrize("name", sample(AGENTS, 4))
def test_two_episodes_in_a_row_are_those_of_two_fresh_agents(name: str):
    one, runs = build(name), (("cushion", 3), ("bed", 5))
    in_a_row = [run_episode(world(), one, goal, seed=seed, max_steps=STEPS).actions for goal, seed in runs]
    fresh = [run_episode(world(), build(name), goal, seed=seed, max_steps=STEPS).actions for goal, seed in runs]
    assert in_a_row == fresh


@every_agent
def test_observations_are_not_changed(name: str):
    agent, ground = build(name), world()
    agent.reset("bed", 0)
    for _ in range(6):
        observation = ground.observe("bed")
        before = {key: value.copy() for key, value in observation.items()}
        for value in observation.values():
            value.setflags(write=False)
        ground.step(agent.act(observation))
        for key, value in before.items():
            np.testing.assert_array_equal(observation[key], value)


class Fickle:
    """An imperfect detector that takes a table for a bed in every third frame."""

    spec = SegmenterSpec(sensors=("semantic",))

    def __init__(self) -> None:
        self.frames = 0

    def scores(self, observation: Observation, goal: str) -> Scores:
        self.frames += 1
        looks_like = "table" if goal == "bed" and self.frames % 3 == 0 else goal
        return GroundTruthSegmenter().scores(observation, looks_like)

    def posteriors(self, observation: Observation) -> np.ndarray:
        posteriors = np.array(GroundTruthSegmenter().posteriors(observation))
        if self.frames % 3 == 0:
            bed, table = (MPCAT40_ID[name] - 1 for name in ("bed", "table"))
            posteriors[[bed, table]] = posteriors[[table, bed]]
        return posteriors


class SeenOften:
    """A verifier that requires the target in more than half of the frames and in at least a few of them."""

    may_refuse = True

    def accepts(self, goal: str, features: Features) -> bool:
        return features.total_view >= 4 and features.cumulative > 0.5 * features.total_view

    would_accept = accepts


def unsure(name: str) -> Agent:
    parts: dict[str, Any] = {"camera": SMALL_CAMERA, "robot": RobotModel(), "segmenter": Fickle()}
    return agents.make(name, verifier=SeenOften(), **parts)


def test_with_an_imperfect_segmenter_the_agent_goes_nearer():
    exact = agents.make("stubborn", camera=SMALL_CAMERA, robot=RobotModel(), segmenter=GroundTruthSegmenter())
    sighting = Sighting(np.array([720]), np.array([736]), np.array([0.8], np.float32))
    for agent, near_enough in ((exact, True), (unsure("stubborn"), False)):
        assert isinstance(agent, StubbornAgent)
        agent.navmap.score_max[719:722, 735:738] = 1.0
        agent.navmap.grow_known(slice(719, 722), slice(735, 738))
        assert (agent.seeker.in_reach(agent.navmap, sighting) is not None) == near_enough


TWO_ROOMS = boxes_from_plan(
    """
####################
#        #         #
#  bb    #     tt  #
#  bb    #     tt  #
#                  #
#                  #
#                  #
#        #         #
####################
""",
    0.3,
)


def ends(name: str, start: tuple[float, float, float]) -> tuple[bool, float, float]:
    """Returns whether the agent stopped, and its distances from the bed and the table."""
    ground = GridWorld(TWO_ROOMS, start, camera=SMALL_CAMERA)
    trace = run_episode(ground, unsure(name), "bed", max_steps=150)
    return trace.stopped, ground.distance_to("bed"), ground.distance_to("table")


def test_verification_keeps_the_agent_from_a_lookalike_at_which_one_frame_stops():
    start = (3.6, 0.6, 0.5)  # in the room of the table; the bed is next door
    assert ends("single-frame", start)[0]
    assert ends("single-frame", start)[2] < 1.0
    stopped, bed_m, _ = ends("stubborn", start)
    assert stopped
    assert bed_m < 1.0


def test_single_frame_is_stubborn_without_verification_and_latest_frame_has_no_memory():
    layers = []
    for name in ("single-frame", "latest-frame"):
        agent = unsure(name)
        assert isinstance(agent, StubbornAgent)
        assert isinstance(agent.seeker, TargetSeeker)
        assert isinstance(agent.seeker.verifier, AcceptAll)
        layers.append(type(agent.mapper.layers))
    assert layers == [AllFrames, LatestFrame]
    parts: dict[str, Any] = {"camera": SMALL_CAMERA, "robot": RobotModel()}
    without = agents.make("stubborn", segmenter=Fickle(), verifier=AcceptAll(), **parts)
    runs = [run_episode(world(), agent, "bed", seed=2, max_steps=60) for agent in (without, unsure("single-frame"))]
    assert runs[0].actions == runs[1].actions


def test_stubborn_plus_goes_past_the_lookalike_too():
    agent = agents.make(
        "stubborn-plus",
        camera=SMALL_CAMERA,
        robot=RobotModel(),
        segmenter=Fickle(),
        seeker=TrackSeekerConfig(look=LookConfig(bar=((0, 0.55),))),
    )
    assert isinstance(agent, StubbornAgent)
    assert isinstance(agent.seeker, TrackSeeker)
    agent.seeker.evidence.fusion = Fusion()  # the errors of this detector differ from those of the network
    ground = GridWorld(TWO_ROOMS, (3.6, 0.6, 0.5), camera=SMALL_CAMERA)
    assert run_episode(ground, agent, "bed", max_steps=150).stopped
    assert ground.distance_to("bed") < 1.0


@pytest.mark.costly
@pytest.mark.parametrize("name", ["stubborn", "stubborn-plus", "single-frame", "latest-frame", "frontier-avoid"])
def test_with_an_unsure_detector_the_same_seed_still_gives_the_same_episode(name: str):
    runs = [run_episode(world(), unsure(name), "bed", seed=2, max_steps=60).actions for _ in range(2)]
    assert runs[0] == runs[1]


@pytest.mark.costly
def test_the_agent_never_stops_without_a_target():
    trace = run_episode(world(), build("stubborn"), "sofa", max_steps=150)
    assert not trace.stopped


def test_reset_leaves_nothing_of_the_last_episode():
    agent = build("stubborn")
    assert isinstance(agent, StubbornAgent)
    run_episode(world(), agent, "cushion", max_steps=30)
    agent.reset("bed", 0)
    layers = {name: value for name, value in vars(agent.navmap).items() if name not in ("frame", "known")}
    assert not any(np.any(layer) for layer in layers.values())
    assert agent.navmap.known is None
    assert (agent.step, agent.pose, agent.last_action, agent.route, agent.approach) == (0, None, None, None, None)
    assert isinstance(agent.explorer, CornerExplorer)
    assert agent.explorer.corner == CornerConfig().first_corner
    assert not agent.untrap.active


def test_the_ablation_rows_switch_on_one_measure_after_the_other():
    def switches(name: str) -> tuple[bool, ...]:
        agent = build(name)
        assert isinstance(agent, StubbornAgent)
        avoidance = agent.config.avoidance
        assert avoidance.optimistic_fallback == avoidance.visited_is_free
        return avoidance.untrap, avoidance.collision_layers, avoidance.averse_exploration, avoidance.visited_is_free

    rows = [switches(f"stubborn-{row}") for row in ("i", "ii", "iii", "iv", "v")]
    assert rows == [tuple(i < n for i in range(4)) for n in range(5)]
    assert switches("stubborn") == rows[-1]
    assert "without the optimistic map" in agents.SPECS["stubborn-iv"].description


def test_options_are_fields_of_the_config():
    agent = build("stubborn-iv", window_cells=200, untrap=UntrapConfig(failed_forwards=3))
    assert isinstance(agent, StubbornAgent)
    assert agent.config.window_cells == 200
    assert agent.config.untrap.failed_forwards == 3
    assert not agent.config.avoidance.visited_is_free


@pytest.mark.parametrize("name", agents.EXPLORERS)
def test_an_explorer_is_chosen_by_name_or_config(name: str):
    config = agents.EXPLORERS[name]
    for explorer in (name, config):
        agent = build("stubborn", explorer=explorer)
        assert isinstance(agent, StubbornAgent)
        assert agent.config.explorer == config
        assert type(agent.explorer) is type(config.make(SMALL_CAMERA))


@pytest.mark.parametrize("name", agents.NAMES)
def test_a_specification_describes_its_agent(name: str):
    spec = agents.SPECS[name]
    assert spec.description
    assert plain(spec.config)
    assert "semantic" not in spec.sensors
    agent = build(name)
    assert getattr(agent, "config") == spec.config  # noqa: B009 - no attribute of the protocol
    assert (spec.painter is not None) == isinstance(agent, StubbornAgent)
    if spec.painter is not None:
        assert spec.painter(agent).paint(120).shape == (120, 120, 3)


def plain(value: Any) -> bool:
    """Returns whether a value consists of JSON types and frozen dataclasses."""
    if dataclasses.is_dataclass(value):
        assert getattr(value, "__dataclass_params__").frozen  # noqa: B009 - not in typeshed
        return all(plain(getattr(value, field.name)) for field in dataclasses.fields(value))
    if isinstance(value, tuple):
        return all(plain(item) for item in value)
    return value is None or isinstance(value, (bool, int, float, str))


def test_a_larger_success_distance_lets_the_agent_stop_farther_away():
    ends_m = []
    for distance_m in (1.0, 2.0):
        agent = build("stubborn", success=SuccessRule(distance_m=distance_m))
        ground = GridWorld([Box((4.0, 5.0), (-1.0, 1.0), (0.0, 0.6), "bed")], (0.0, 0.0, 0.0), camera=SMALL_CAMERA)
        trace = run_episode(ground, agent, "bed", max_steps=50)
        assert trace.stopped
        assert trace.goal_distance_m < distance_m
        ends_m.append(trace.goal_distance_m)
    assert ends_m[1] > ends_m[0] + 0.5


def test_an_unknown_name_or_option_is_refused_with_the_names_that_exist():
    with pytest.raises(ConfigError, match=r"No agent 'stuborn'\. Did you mean 'stubborn'\? Available: stubborn, "):
        build("stuborn")
    with pytest.raises(ConfigError, match=r"no option 'speed'\. It has: cell_m, "):
        build("stubborn", speed=2)
    with pytest.raises(ConfigError, match=r"No explorer 'fronteer'\. Did you mean 'frontier'\?"):
        build("stubborn", explorer="fronteer")
    with pytest.raises(ConfigError, match="window_cells <= map_cells, got 20 and 10"):
        AgentConfig(window_cells=20, map_cells=10)


def test_importing_the_agents_imports_neither_mujoco_nor_the_rest_of_sim():
    code = (
        "import sys, stubborn.agents, stubborn.drawing.map_painter, stubborn.segmentation.ground_truth\n"
        "import stubborn.detection.verification, stubborn.exploration.frontier, stubborn.baselines.cloned\n"
        "bad = [m for m in sys.modules if m.split('.')[0] in ('mujoco', 'gymnasium', 'OpenGL', 'sklearn')]\n"
        "allowed = ('sim.core',)\n"
        "ours = [m for m in sys.modules if m.startswith('sim.') and not m.startswith(allowed)]\n"
        "print(bad + ours)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


@pytest.mark.parametrize("name", agents.NAMES)
def test_agents_with_a_last_resort_know_the_limit_of_steps(name: str) -> None:
    agent = build(name, max_steps=300)
    if isinstance(agent, StubbornAgent):
        assert isinstance(agent.seeker, (TargetSeeker, TrackSeeker))
        assert agent.seeker._last_resort_step == 220


def test_the_map_agent_of_the_tutorial_does_not_wait_where_its_stop_is_too_far() -> None:
    agent = map_agent.MapAgent(SMALL_CAMERA, GroundTruthSegmenter())
    agent.reset("chair", 0)
    goal = np.array(map_agent.cell(np.array([0.65, 0.65])))
    agent.found[goal[1], goal[0]] = 1
    assert agent._next(np.zeros(2)) is not None
    assert agent.aim is not None
    assert np.hypot(*(np.array(agent.aim) - goal)) * map_agent.CELL_M < 0.8
