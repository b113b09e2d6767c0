"""Tests of agents in traps: some escape, and collision marks agree with contacts."""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from sim.app.commands.traps.report import Args, main, make_agent
from sim.app.commands.traps.trial import Trial, run_trial
from sim.core.errors import AgentError
from sim.core.geometry.pose import Pose
from sim.core.interface import FORWARD_M, Action, ConfigError
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.recipes import START_TURNS_RAD
from sim.episodes.splits import load_split
from sim.robot.config import PHYSICS_VERSION
from stubborn.agent import StubbornAgent
from stubborn.agents import ABLATION
from stubborn.mapping.navmap import NavMap
from tests.helpers.agents import Looker
from tests.helpers.sampling import sample

HEADINGS = range(len(START_TURNS_RAD))
TRAPS = load_split("traps").houses
CASES = list(itertools.product(TRAPS, HEADINGS))
AGENT_CASES = [(*case, agent) for case in CASES for agent in ABLATION]
BLIND = ("glass_pane", "scan_artifact", "hanging_shelf", "dead_end_corridor", "wedged_spawn", "chair_in_doorway")
"""Traps with one obstacle across the straight path."""
FAILED_M = 0.20
"""The agent marks a forward action that moved less than this."""
MARK_REACH_M = 0.05 + 0.0354
"""Largest distance from a contact to the centre of the nearest marked cell: one cell, and half a cell's diagonal."""
AHEAD_RAD = math.radians(40.0)
"""The marks, squares in front of the robot, cover its hull up to this bearing; the paper has none for its sides ..."""
FLANK_REACH_M = 0.20
"""... so that a contact at the side, at 90 deg in the worst case, is up to this far from a mark."""


@pytest.fixture(scope="module")
def truth_env() -> Iterator[ObjectNavEnv]:
    env = ObjectNavEnv(split="traps", sensors=())
    yield env
    env.close()


@pytest.fixture(scope="module")
def agent_env() -> Iterator[ObjectNavEnv]:
    env = ObjectNavEnv(split="traps", sensors=("depth", "semantic"))
    yield env
    env.close()


@pytest.fixture(scope="module")
def short_env() -> Iterator[ObjectNavEnv]:
    env = ObjectNavEnv(split="traps", sensors=("depth", "semantic"), max_steps=200)
    yield env
    env.close()


def run_in_trap(env: ObjectNavEnv, trap: str, heading: int, name: str) -> tuple[Trial, StubbornAgent]:
    agent = make_agent(name, env)
    assert isinstance(agent, StubbornAgent)
    return run_trial(env, agent, name, env.split.episode(f"{trap}_{heading}")), agent


def test_the_report_takes_an_agent_of_the_user(tmp_path: Path) -> None:
    agent = "tests.helpers.runners:make_quitter"
    args = Args(out=tmp_path, agents=(agent,), traps=("glass_pane",), headings=1, pictures=False)
    assert main(args) == 0
    assert f"glass_pane,glass_pane_0,{agent},False" in (tmp_path / "traps.csv").read_text()


def test_an_agent_of_the_user_may_tilt_its_camera_and_is_freed(tmp_path: Path) -> None:
    agent = "tests.helpers.agents:LOOKER"
    args = Args(out=tmp_path, agents=(agent,), traps=("glass_pane",), headings=1, pictures=False)
    assert main(args) == 0
    assert Looker.freed


def test_an_agent_of_the_user_that_fails_ends_the_report_with_one_sentence(tmp_path: Path) -> None:
    args = Args(out=tmp_path, agents=("tests.helpers.runners:make_unable",), traps=("glass_pane",), headings=1)
    with pytest.raises(AgentError, match=r"Agent 'tests.*make_unable' in house 'glass_pane': act\(\) returned 'left'"):
        main(args)


def test_a_report_has_results_of_one_split_and_physics_and_of_the_wanted_episodes_only(tmp_path: Path) -> None:
    args = Args(
        out=tmp_path, agents=("tests.helpers.runners:make_quitter",), traps=("glass_pane",), headings=1, pictures=False
    )
    assert main(args) == 0
    assert main(replace(args, traps=("scan_artifact",))) == 0
    assert len((tmp_path / "results.jsonl").read_text().splitlines()) == 2
    assert "glass_pane" not in (tmp_path / "traps.csv").read_text() + (tmp_path / "traps.md").read_text()
    with pytest.raises(ConfigError, match=r"max_steps.*500.*9"):
        main(replace(args, max_steps=9))
    with pytest.raises(ConfigError, match=r'split_identity\.name.*"traps".*"contact-val"'):
        main(replace(args, split="contact-val", traps=()))
    file = tmp_path / "config.json"
    file.write_text(json.dumps(json.loads(file.read_text()) | {"physics": 1}))
    with pytest.raises(ConfigError, match=f"holds results with physics = 1, this command has {PHYSICS_VERSION}"):
        main(args)
    file.unlink()
    with pytest.raises(ConfigError, match=r"max_steps.*\(absent\)"):
        main(args)


@pytest.mark.costly
@pytest.mark.parametrize(("trap", "heading"), sample(CASES, 3))
def test_the_oracle_escapes_from_every_trap_without_contact(truth_env, trap, heading):
    episode = truth_env.split.episode(f"{trap}_{heading}")
    trial = run_trial(truth_env, make_agent("oracle", truth_env), "oracle", episode)
    assert trial.escaped
    assert trial.result().collisions == 0
    assert trial.result().spl > 0.8


@pytest.mark.costly
@pytest.mark.parametrize(("trap", "heading", "name"), sample(AGENT_CASES, 1))
def test_penetration_is_small_and_no_forward_action_is_too_long(short_env, trap, heading, name):
    trial, _ = run_in_trap(short_env, trap, heading, name)  # a fall or a tumble raises PhysicsError
    assert trial.deepest_m < 0.003
    assert trial.result().collisions == sum(motion.collided for motion in trial.motions)
    if trap != "slippery_floor":  # a robot on wet tiles glides on
        assert max(trial.forwards_m) <= FORWARD_M + 0.006
        for motion in trial.motions:
            if motion.action == Action.MOVE_FORWARD:
                assert motion.collided or motion.displacement_m > FAILED_M, "a short move that nothing stopped"


@pytest.mark.costly
@pytest.mark.parametrize("trap", sample(BLIND, 1))
def test_the_full_agent_escapes_where_the_one_without_collision_avoidance_does_not(short_env, trap):
    full, _ = run_in_trap(short_env, trap, 0, "stubborn-v")
    bare, _ = run_in_trap(short_env, trap, 0, "stubborn-i")
    assert full.escaped
    assert not bare.escaped
    assert bare.result().collisions > 5 * full.result().collisions
    assert bare.steps_in_trap > full.steps_in_trap
    assert np.mean(bare.forwards_m) < 0.5 * np.mean(full.forwards_m)


@pytest.mark.costly
@pytest.mark.parametrize(("trap", "heading"), sample([case for case in CASES if case[0] != "slippery_floor"], 1))
def test_each_mark_has_a_contact_within_reach(short_env, trap, heading):
    trial, agent = run_in_trap(short_env, trap, heading, "stubborn-v")
    marks_m = marked_places(agent.navmap)
    for i in failed_forwards(trial):
        gaps_m = mark_gaps(trial, i, short_env.split.episode(trial.episode_id).start, marks_m)
        assert gaps_m, f"step {i}: the map has a mark where nothing was touched"
        bearing_rad, gap_m = min(gaps_m, key=lambda pair: pair[1])
        reach_m = MARK_REACH_M if bearing_rad <= AHEAD_RAD else FLANK_REACH_M
        assert gap_m <= reach_m, f"step {i}: {gap_m:.3f} m from mark to contact at {math.degrees(bearing_rad):.0f} deg"


@pytest.mark.costly
def test_on_wet_tiles_forward_actions_are_short_without_contact(agent_env):
    trial, _ = run_in_trap(agent_env, "slippery_floor", 0, "stubborn-v")
    slips = [m for m in trial.motions if m.action == Action.MOVE_FORWARD and m.displacement_m < FAILED_M]
    assert sum(not motion.contacts for motion in slips) > 5


@pytest.mark.slow
def test_the_full_agent_escapes_from_most_traps_and_from_more_than_the_bare_one(agent_env):
    out = {
        name: sum(run_in_trap(agent_env, trap, heading, name)[0].escaped for trap, heading in CASES)
        for name in ("stubborn-v", "stubborn-i")
    }
    assert out["stubborn-v"] >= 0.8 * len(CASES)
    assert out["stubborn-v"] > out["stubborn-i"]


def failed_forwards(trial: Trial) -> list[int]:
    """Returns the steps of forward actions that the agent took for collisions; the last action is not observed."""
    motions = trial.motions[:-1]
    return [i for i, m in enumerate(motions) if m.action == Action.MOVE_FORWARD and m.displacement_m < FAILED_M]


def mark_gaps(trial: Trial, step: int, start: Pose, marks_m: NDArray[np.float64]) -> list[tuple[float, float]]:
    """Returns for each contact of a step its bearing in radians and its distance from the nearest mark in metres."""
    robot = Pose(*trial.positions_m[step + 1], trial.yaws_rad[step + 1])
    gaps = []
    for contact in trial.motions[step].contacts:
        place = Pose(*contact.position_m[:2], 0.0)
        seen, mapped = place.relative_to(robot), place.relative_to(start)
        gap_m = float(np.hypot(*(marks_m - (mapped.x_m, mapped.y_m)).T).min())
        gaps.append((abs(math.atan2(seen.y_m, seen.x_m)), gap_m))
    return gaps


def marked_places(navmap: NavMap) -> NDArray[np.float64]:
    """Returns (n, 2) centres of the cells with a collision mark, in the agent's frame."""
    x_m, y_m = navmap.frame.centres(*np.nonzero(navmap.pessimistic_marks)[:2])
    return np.stack([x_m, y_m], axis=1)
