"""The cloned policy: its input, its memory, the streams of its training, and the agent."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from sim.core.geometry.pose import Pose
from sim.core.interface import GOAL_CATEGORIES, MOVES, MPCAT40_ID, Action, CameraModel, ConfigError, RobotModel
from sim.training.cloned.trainer import LabelledSteps, Streams
from stubborn.agents import make
from stubborn.baselines.cloned import SHIPPED, ClonedAgent, ClonedConfig
from stubborn.baselines.cloned_input import MOTION, NO_ACTION, Steps, motion_of, motions, small_categories, small_depth
from stubborn.baselines.cloned_net import FILES, ClonedNet, NetConfig
from stubborn.segmentation.ground_truth import GroundTruthSegmenter

SMALL = NetConfig(categories=3, width=4, goal=4, hidden=16)
BED = GOAL_CATEGORIES.index("bed")


def shown(n: int, *, seed: int = 0) -> LabelledSteps:
    """Returns a demonstration of n random steps."""
    rng = np.random.default_rng(seed)
    actions = rng.integers(1, 4, n).astype(np.uint8)
    actions[-1] = Action.STOP
    poses = rng.normal(size=(n, 3)).astype(np.float32)
    before = np.concatenate(([NO_ACTION], actions[:-1])).astype(np.uint8)
    images = rng.integers(0, 256, (n, 48, 64)).astype(np.uint8), rng.integers(0, 41, (n, 48, 64)).astype(np.uint8)
    return LabelledSteps(Steps(*images, motions(poses), before, BED), actions)


def logits_of(net: ClonedNet, steps: Steps, parts: int = 1) -> np.ndarray:
    """Returns the logits of one demonstration that is given in several consecutive parts."""
    state, found = None, []
    arrays = (steps.depth, steps.categories, steps.motion, steps.before)
    for pieces in zip(*(np.array_split(array, parts) for array in arrays), strict=True):
        with torch.inference_mode():
            given = [torch.from_numpy(np.ascontiguousarray(piece))[:, None] for piece in pieces]
            logits, state = net(*given, torch.tensor([steps.goal]), state)
        found.append(logits[:, 0].numpy())
    return np.concatenate(found)


@pytest.fixture(scope="module")
def net() -> ClonedNet:
    torch.manual_seed(0)
    return ClonedNet(SMALL).eval()


def test_the_small_image_shows_the_middles_of_its_blocks():
    depth_m = np.zeros((480, 640), np.float32)
    depth_m[240:, :] = 2.5
    depth_m[:, 320:] = 5.0
    levels = small_depth(depth_m)
    assert levels.shape == (48, 64)
    assert set(np.unique(levels)) == {0, 128, 255}
    assert (levels[:24, :32] == 0).all()
    assert (levels[24:, :32] == 128).all()
    posteriors = np.zeros((40, 120, 160), np.float32)
    posteriors[MPCAT40_ID["bed"] - 1, :60] = 0.4
    posteriors[MPCAT40_ID["sofa"] - 1, :30] = 0.6
    ids = small_categories(posteriors)
    assert [ids[row, 0] for row in (0, 20, 40)] == [MPCAT40_ID["sofa"], MPCAT40_ID["bed"], 0]


def test_motion_is_measured_in_commanded_motions():
    start = Pose(1.0, 0.0, math.radians(90.0))
    moved = motion_of(Pose(1.0, 0.125, math.radians(120.0)), start, 50)
    inputs = dict(zip(MOTION, moved.tolist(), strict=True))
    assert inputs["moved ahead"] == pytest.approx(0.5)
    assert inputs["moved left"] == pytest.approx(0.0, abs=1e-6)
    assert inputs["turned"] == pytest.approx(1.0)
    assert (inputs["ahead"], inputs["left"], inputs["steps done"]) == pytest.approx((0.1, 0.0125, 0.1))
    np.testing.assert_allclose(motion_of(Pose(0.0, 0.0, 0.0), None, 0), [0, 0, 1, 0, 0, 0, 0, 0])


def test_a_mirrored_demonstration_is_that_of_the_mirrored_house():
    one = shown(6)
    two = one.mirrored()
    np.testing.assert_array_equal(two.steps.depth, one.steps.depth[:, :, ::-1])
    swapped = {Action.TURN_LEFT: Action.TURN_RIGHT, Action.TURN_RIGHT: Action.TURN_LEFT}
    assert two.actions.tolist() == [swapped.get(Action(a), a) for a in one.actions.tolist()]
    poses = np.random.default_rng(0).normal(size=(4, 3)).astype(np.float32)
    there = LabelledSteps(replace(one.steps, motion=motions(poses)), one.actions).mirrored().steps.motion
    np.testing.assert_allclose(there, motions(poses * np.array([1, -1, -1], np.float32)), atol=1e-5)
    np.testing.assert_array_equal(two.mirrored().steps.categories, one.steps.categories)
    np.testing.assert_array_equal(two.mirrored().actions, one.actions)


def test_the_memory_carries_an_episode_from_piece_to_piece(net: ClonedNet):
    one = shown(12)
    whole, parts = logits_of(net, one.steps), logits_of(net, one.steps, parts=4)
    np.testing.assert_allclose(parts, whole, atol=1e-5)
    steps = one.steps
    later = logits_of(net, Steps(steps.depth[6:], steps.categories[6:], steps.motion[6:], steps.before[6:], BED))
    assert np.abs(later - whole[6:]).max() > 1e-4  # without the first half it decides differently


def test_the_network_uses_each_part_of_its_input(net: ClonedNet):
    steps = shown(3).steps
    plain = logits_of(net, steps)
    for name in ("depth", "categories", "motion", "before"):
        array = getattr(steps, name)
        changed = replace(steps, **{name: np.roll(array, 1, axis=0)})
        assert np.abs(logits_of(net, changed) - plain).max() > 1e-6, name
    assert np.abs(logits_of(net, replace(steps, goal=BED + 1)) - plain).max() > 1e-6


def test_streams_show_each_demonstration_whole_and_in_order():
    demonstrations = [shown(n, seed=n) for n in (5, 8, 21)]
    streams = Streams(demonstrations, width=3, length=8, seed=1)
    both = [one for each in demonstrations for one in (each, each.mirrored())]
    known = {(one.actions.tobytes(), one.steps.motion.tobytes()) for one in both}
    episodes: list[list] = [[], [], []]
    complete = 0
    for _ in range(40):
        piece = streams.next_piece()
        for number in range(3):
            if piece.begins[number]:
                episodes[number] = []
            count = int(np.count_nonzero(piece.weight[:, number]))
            episodes[number].append((piece.actions[:count, number], piece.motion[:count, number]))
            if count and piece.actions[count - 1, number] == Action.STOP and piece.begins.any():
                actions, motion = (np.concatenate(parts) for parts in zip(*episodes[number], strict=True))
                if motion[0, MOTION.index("moved ahead")] == 0.0:  # from its first step
                    assert (actions.tobytes(), motion.tobytes()) in known
                    complete += 1
    assert complete > 20
    changes = sum(int(each.changes.sum()) for each in demonstrations)
    assert streams.inflection == pytest.approx(34 / changes)


def observation(x_m: float = 0.0) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(int(100 * x_m))
    return {
        "depth": rng.uniform(0.5, 5.0, (48, 64)).astype(np.float32),
        "semantic": rng.integers(0, 41, (48, 64)).astype(np.uint8),
        "gps": np.array([x_m, 0.0], np.float32),
        "compass": np.zeros(1, np.float32),
        "objectgoal": np.array([BED]),
    }


def agent_with(net: ClonedNet, tmp_path: Path, **options) -> ClonedAgent:
    FILES.save(tmp_path / "net.safetensors", net)
    return ClonedAgent(ClonedConfig(weights=str(tmp_path / "net.safetensors"), **options), GroundTruthSegmenter())


def actions_of(agent: ClonedAgent, seed: int, count: int = 30) -> list[Action]:
    agent.reset("bed", seed)
    return [agent.act(observation(0.1 * step)) for step in range(count)]


def test_the_agent_repeats_itself_with_the_same_seed_and_forgets_between_episodes(net: ClonedNet, tmp_path: Path):
    agent = agent_with(net, tmp_path)
    first, second = actions_of(agent, 1), actions_of(agent, 2)
    assert first != second
    assert actions_of(agent, 1) == first
    assert set(first) == set(MOVES)  # the untrained policy samples all actions


def test_a_stop_can_require_a_probability(net: ClonedNet, tmp_path: Path):
    assert Action.STOP not in actions_of(agent_with(net, tmp_path, stop_above=0.99), 0)
    assert set(actions_of(agent_with(net, tmp_path, stop_above=0.01), 0)) == {Action.STOP}
    with pytest.raises(ConfigError, match="stop_above"):
        ClonedConfig(stop_above=1.0)


def test_the_most_probable_action_needs_no_seed(net: ClonedNet, tmp_path: Path):
    agent = agent_with(net, tmp_path, sampled=False)
    assert actions_of(agent, 1) == actions_of(agent, 2)


def test_weights_of_another_network_are_refused(net: ClonedNet, tmp_path: Path):
    FILES.save(tmp_path / "net.safetensors", net)
    loaded, _ = FILES.load(tmp_path / "net.safetensors")
    assert loaded.config == SMALL
    with pytest.raises(ConfigError, match="'cloned_config'"):
        FILES.load(Path(__file__).parents[3] / "stubborn/exploration/weights/poni.safetensors")
    with pytest.raises(ConfigError, match="No weights at"):
        agent_with(net, tmp_path).__class__(ClonedConfig(weights="nowhere"), GroundTruthSegmenter())


def test_the_shipped_weights_are_small_and_turn_towards_the_goal():
    """A bed on the left makes a turn to the left more probable than one on the right does."""
    assert SHIPPED.stat().st_size < 5_000_000
    agent = make("cloned", camera=CameraModel(), robot=RobotModel(), segmenter=GroundTruthSegmenter())
    assert isinstance(agent, ClonedAgent)
    net, _ = FILES.load(SHIPPED)
    depth, motion = np.full((1, 48, 64), 128, np.uint8), motions(np.zeros((1, 3), np.float32))
    shares = []
    for columns in (slice(2, 22), slice(42, 62)):
        categories = np.full((1, 48, 64), MPCAT40_ID["wall"], np.uint8)
        categories[:, 24:44, columns] = MPCAT40_ID["bed"]
        logits = logits_of(net, Steps(depth, categories, motion, np.array([NO_ACTION], np.uint8), BED))[0]
        shares.append(logits[Action.TURN_LEFT] - logits[Action.TURN_RIGHT])
    assert shares[0] > shares[1] + 0.5
