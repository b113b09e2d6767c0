"""The seeker of stubborn-plus in a world of boxes with an imperfect detector."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sim.core.geometry.pose import Pose
from sim.core.interface import (
    MAX_STEPS,
    MPCAT40_ID,
    Action,
    ConfigError,
    Observation,
    RobotModel,
    Scores,
    Segmenter,
    SegmenterSpec,
)
from sim.core.wishes import parse_wish
from stubborn import agents
from stubborn.agent import StubbornAgent
from stubborn.detection import track_seeker
from stubborn.detection.approach import Approach
from stubborn.detection.attributes import AT_LAST, Attributes
from stubborn.detection.context import OBJECTS, read_context
from stubborn.detection.fusion import Fusion
from stubborn.detection.goal_evidence import GoalEvidence
from stubborn.detection.look import LookConfig
from stubborn.detection.patience import Progress
from stubborn.detection.track_seeker import TrackSeeker, TrackSeekerConfig
from stubborn.detection.tracks import TrackConfig, Tracks
from stubborn.detection.viewpoints import LastResort
from stubborn.segmentation.ground_truth import GroundTruthSegmenter
from tests.helpers.gridworld import SMALL_CAMERA, Box, GridWorld, boxes_from_plan, run_episode

ROOM = boxes_from_plan(
    """
####################
#                  #
#                  #
#                  #
#         tt       #
#         tt       #
#                  #
#                  #
####################
""",
    0.3,
)
START = (1.2, 1.3, 0.0)
BED = parse_wish("the red bed").names


class Unsure:
    """A detector that gives tables a probability of the goal, a bed; there is no bed."""

    spec = SegmenterSpec(sensors=("semantic",))

    def __init__(self, probability: float) -> None:
        self.probability = probability

    def posteriors(self, observation: Observation) -> np.ndarray:
        posteriors = np.array(GroundTruthSegmenter().posteriors(observation))
        bed, table = (MPCAT40_ID[name] - 1 for name in ("bed", "table"))
        posteriors[bed] = self.probability * posteriors[table]
        posteriors[table] *= 1.0 - self.probability
        return posteriors

    def scores(self, observation: Observation, goal: str) -> Scores:
        posteriors = self.posteriors(observation)
        target = posteriors[MPCAT40_ID[goal] - 1]
        return Scores(target, posteriors.max(axis=0))


def agent_with(probability: float, look: LookConfig | None = None) -> tuple[StubbornAgent, TrackSeeker]:
    config = agents.SPECS["stubborn-plus"].config
    assert isinstance(config.seeker, TrackSeekerConfig)
    seeker = replace(config.seeker, tracks=TrackConfig(least_pixels_of_others=12), look=look or LookConfig())
    agent = agents.make(
        "stubborn-plus", camera=SMALL_CAMERA, robot=RobotModel(), segmenter=Unsure(probability), seeker=seeker
    )
    assert isinstance(agent, StubbornAgent)
    assert isinstance(agent.seeker, TrackSeeker)
    agent.seeker.evidence.fusion, agent.seeker.evidence.context = (
        Fusion(),
        None,
    )  # not the fitted ones, whose parameters change
    return agent, agent.seeker


@pytest.mark.costly
def test_a_doubtful_object_is_looked_at_from_two_sides_and_left():
    agent, seeker = agent_with(0.45)
    trace = run_episode(GridWorld(ROOM, START, camera=SMALL_CAMERA), agent, "bed", max_steps=90)
    assert not trace.stopped
    assert seeker.verdicts.rejected
    assert not seeker.verdicts.accepted
    assert (
        max(seeker.evidence.of_episode().evidence.near_sectors(track).sum() for track in seeker.verdicts.rejected) >= 2
    )


@pytest.mark.costly
def test_near_the_end_the_best_rejected_object_is_tried():
    agent, _ = agent_with(0.45, LookConfig(bar=((MAX_STEPS - 80, 0.3), (MAX_STEPS - 70, 0.9))))
    world = GridWorld(ROOM, START, camera=SMALL_CAMERA)
    trace = run_episode(world, agent, "bed", max_steps=130)
    assert trace.stopped
    assert len(trace.actions) > 70
    assert world.distance_to("table") < 1.0


@pytest.mark.parametrize("max_steps", [200, MAX_STEPS, 2000])
def test_a_last_resort_is_taken_so_many_steps_before_the_end_of_the_episode(
    monkeypatch: pytest.MonkeyPatch, max_steps: int
):
    agent, _ = agent_with(0.97)
    parts: dict[str, Any] = {"camera": SMALL_CAMERA, "robot": RobotModel(), "segmenter": Unsure(0.97)}
    other = agents.make("stubborn-plus", **parts, max_steps=max_steps)
    assert isinstance(other, StubbornAgent)
    seeker = other.seeker
    assert isinstance(seeker, TrackSeeker)
    resorts: list[LastResort] = []
    seeker._accepted = [1]
    monkeypatch.setattr(seeker, "_best_accepted", lambda pose: [1])
    monkeypatch.setattr(seeker, "_with_parts", lambda tracks: tracks)
    monkeypatch.setattr(seeker, "_drive_to", lambda *given: resorts.append(given[-1]) or Approach(None, 0.0, (0, 0)))
    window = agent.navmap.frame.window_at(0.0, 0.0, agent.config.window_cells)
    for step in (max_steps - 81, max_steps - 80):
        seeker.approach(agent.navmap, window, Pose(0.0, 0.0, 0.0), step)
    assert resorts == [LastResort.NONE, LastResort.STOP]


def test_a_sure_object_is_driven_to():
    agent, seeker = agent_with(0.97)
    world = GridWorld(ROOM, START, camera=SMALL_CAMERA)
    trace = run_episode(world, agent, "bed", max_steps=120)
    assert trace.stopped
    assert trace.actions[-1] == Action.STOP
    assert seeker.verdicts.accepted
    assert seeker.confidence in seeker.probability[list(seeker.verdicts.accepted)]
    assert world.distance_to("table") < 0.8
    assert seeker.accepted_cell is not None
    assert seeker.cells_of(agent.navmap, seeker.verdicts.accepted)[seeker.accepted_cell]
    seeker.reset("bed")
    assert seeker.accepted_cell is None


def test_before_a_stop_that_would_be_short_it_moves_one_step_nearer_when_the_path_is_free():
    agent, seeker = agent_with(0.97)
    here = Pose(0.0, 0.0, 0.0)

    def nearer(gap_m: float) -> bool:
        cell = agent.navmap.frame.cell(gap_m, 0.0)
        return seeker.one_more_forward(agent.navmap, Approach(None, 0.0, cell), here)

    assert not nearer(0.5)  # near enough
    agent.navmap.seen_obstacle[agent.navmap.frame.cell(0.35, 0.1)] = True
    assert not nearer(0.85)
    agent.navmap.seen_obstacle[:] = False
    assert nearer(0.85)
    assert not nearer(0.85)  # once


def test_an_object_that_is_pursued_on_one_spot_is_set_aside_and_driving_begins_the_count_again(
    monkeypatch: pytest.MonkeyPatch,
):
    agent, seeker = agent_with(0.97, LookConfig(patience_steps=10, patience_m=1.0))
    window = agent.navmap.frame.window_at(0.0, 0.0, agent.config.window_cells)
    aside: list[int] = []
    monkeypatch.setattr(seeker, "_pursue", lambda *_: None if aside else Approach(None, 0.0, (0, 0)))
    monkeypatch.setattr(seeker, "postpone", lambda navmap, step: aside.append(step))

    def pursues(x_m: float, step: int) -> bool:
        return seeker.approach(agent.navmap, window, Pose(x_m, 0.0, 0.0), step) is not None

    assert all(pursues(0.0, step) for step in range(100, 109))
    assert all(pursues(1.1, step) for step in range(109, 119))  # it made progress
    assert not pursues(1.1, 119)
    assert aside == [119]


def test_pursuit_that_begins_anew_in_every_second_step_ends_too(monkeypatch: pytest.MonkeyPatch):
    agent, seeker = agent_with(0.97, LookConfig(patience_steps=10, patience_m=1.0))
    window = agent.navmap.frame.window_at(0.0, 0.0, agent.config.window_cells)
    aside: list[int] = []
    turns = iter(range(100))
    monkeypatch.setattr(seeker, "_pursue", lambda *_: Approach(None, 0.0, (0, 0)) if next(turns) % 2 else None)
    monkeypatch.setattr(seeker, "postpone", lambda navmap, step: aside.append(step))
    for step in range(30):
        seeker.approach(agent.navmap, window, Pose(0.0, 0.0, 0.0), step)
    assert aside == [21]  # the eleventh step of pursuit


def test_around_a_place_where_pursuit_got_nowhere_doubtful_tracks_wait(monkeypatch: pytest.MonkeyPatch):
    agent, seeker, _, track = tracked()
    window = agent.navmap.frame.window_at(0.0, 0.0, agent.config.window_cells)
    seeker._accepted, seeker.verdicts.doubtful = [], [track]
    seeker._progress = Progress(LookConfig.patience_m, LookConfig.patience_steps, 2)
    seeker.config = replace(seeker.config, look=replace(seeker.config.look, look_steps=200))
    monkeypatch.setattr(seeker, "_look", lambda *_: Approach(None, 0.0, (0, 0)))
    monkeypatch.setattr(seeker, "_set_aside", lambda tracks: None)  # it comes back as another track
    found = []
    first_step = seeker.step
    for step in range(first_step, first_step + 80):
        seeker.step = step
        found.append(seeker.approach(agent.navmap, window, Pose(0.0, 0.0, 0.0), step) is not None)
    patience, wait = seeker.config.look.patience_steps, seeker.target.retry_after_steps
    assert found == [True] * patience + [False] * wait + [True] * (80 - patience - wait)


def test_looks_at_a_track_end_after_a_number_of_steps(monkeypatch: pytest.MonkeyPatch):
    agent, seeker, _, track = tracked()
    window = agent.navmap.frame.window_at(0.0, 0.0, agent.config.window_cells)
    seeker._accepted, seeker.verdicts.doubtful = [], [track]
    seeker._progress = Progress(LookConfig.patience_m, LookConfig.patience_steps, 2)
    monkeypatch.setattr(seeker, "_look", lambda *_: Approach(None, 0.0, (0, 0)))
    found = [seeker.approach(agent.navmap, window, Pose(2.0 * step, 0.0, 0.0), step) is not None for step in range(40)]
    assert found == [True] * seeker.config.look.look_steps + [False] * (40 - seeker.config.look.look_steps)
    assert track in seeker.verdicts.rejected


def tracked() -> tuple[StubbornAgent, TrackSeeker, Tracks, int]:
    """Returns an agent that has seen the table, its tracks, and the number of the most probable one."""
    agent, seeker = agent_with(0.97)
    run_episode(GridWorld(ROOM, START, camera=SMALL_CAMERA), agent, "bed", max_steps=30)
    return agent, seeker, seeker.evidence.of_episode(), int(np.argmax(seeker.probability))


def test_a_track_above_the_bar_that_cannot_be_looked_at_counts_as_looked_at(monkeypatch: pytest.MonkeyPatch):
    agent, seeker, tracks, track = tracked()
    window = agent.navmap.frame.window_at(0.0, 0.0, agent.config.window_cells)
    never = np.zeros(tracks.evidence.config.sectors, np.bool_)
    monkeypatch.setattr(tracks.evidence, "near_sectors", lambda _: never)
    monkeypatch.setattr(track_seeker, "look_at", lambda *_: None)
    monkeypatch.setattr(seeker, "_approach", lambda *_: None)
    seeker.verdicts.looks.clear()
    seeker.probability[track] = 0.5 * seeker.verdicts.bar
    assert seeker._look(agent.navmap, window, Pose(0.0, 0.0, 0.0), track) is None
    assert seeker.verdicts.looks == {}
    seeker.probability[track] = seeker.verdicts.bar
    assert seeker._look(agent.navmap, window, Pose(0.0, 0.0, 0.0), track) is None
    assert seeker.verdicts.looks == {track: 1}


@pytest.mark.parametrize(
    ("step", "nothing_new", "expected"),
    [(0, False, 0.24), (MAX_STEPS // 2, False, 0.24), (0, True, AT_LAST), (MAX_STEPS * 3 // 5, False, AT_LAST)],
)
def test_late_or_with_nothing_new_to_see_the_best_object_of_certain_names_passes_whatever_its_conditions_say(
    monkeypatch: pytest.MonkeyPatch, step: int, nothing_new: bool, expected: float
):
    _, seeker, tracks, track = tracked()
    attributes = seeker.evidence.attributes = Attributes(tracks.plan, tracks.config.most_tracks)
    seeker.evidence.exact, seeker.step = True, step
    monkeypatch.setattr(GoalEvidence, "_wish", parse_wish("the red bed"))
    if nothing_new:
        seeker.retry()
    monkeypatch.setattr(attributes, "name_shares", lambda _, of, names: np.full(len(of), 0.8 * (names == BED)))
    monkeypatch.setattr(attributes, "factors", lambda wish, _, of, *rest: np.full(len(of), 0.3, np.float32))
    monkeypatch.setattr(tracks, "probabilities", lambda *_: np.eye(tracks.count + 1, dtype=np.float32)[track])
    probability = seeker.evidence.probabilities("bed", late=seeker._is_late)
    assert probability[track] == pytest.approx(expected)
    assert probability.sum() == pytest.approx(expected)


def test_a_look_that_was_blocked_is_not_repeated_from_the_same_side(monkeypatch: pytest.MonkeyPatch):
    agent, seeker, tracks, track = tracked()
    x_m, y_m = tracks.middle_xy_m(track)
    seen = tracks.evidence.near_sectors(track)
    behind = int(np.flatnonzero(~seen)[0])
    bearing_rad = behind * math.tau / seen.size
    seeker._accepted = []
    seeker._pose = Pose(x_m + 2.0 * math.cos(bearing_rad), y_m + 2.0 * math.sin(bearing_rad), 0.0)
    seeker.pursued = track
    assert not seeker.judge(agent.navmap, (0, 0))
    looked_from: list[np.ndarray] = []
    monkeypatch.setattr(track_seeker, "look_at", lambda view, cells, middle, sides, *_: looked_from.append(sides))
    window = agent.navmap.frame.window_at(0.0, 0.0, agent.config.window_cells)
    seeker._look(agent.navmap, window, seeker._pose, track)
    assert set(np.flatnonzero(looked_from[0]).tolist()) == {*np.flatnonzero(seen).tolist(), behind}


def test_a_probable_track_is_first_looked_at_on_the_path_to_it(monkeypatch: pytest.MonkeyPatch):
    agent, seeker, _, track = tracked()
    window = agent.navmap.frame.window_at(0.0, 0.0, agent.config.window_cells)
    straight, around = Approach(None, 0.0, (0, 0)), Approach(None, 1.0, (0, 0))
    monkeypatch.setattr(seeker, "_approach", lambda *_: straight)
    monkeypatch.setattr(track_seeker, "look_at", lambda *_: around)
    seeker.verdicts.looks.clear()

    def bearing_rad(probability: float) -> float:
        seeker.probability[track] = probability
        found = seeker._look(agent.navmap, window, Pose(0.0, 0.0, 0.0), track)
        assert found is not None
        return found.bearing_rad

    least = seeker.config.look.straight
    assert [bearing_rad(least), bearing_rad(least - 0.1)] == [straight.bearing_rad, around.bearing_rad]
    seeker.verdicts.looked(track)
    assert bearing_rad(least) == around.bearing_rad


def test_a_look_does_not_lead_around_the_house(monkeypatch: pytest.MonkeyPatch):
    agent, seeker, tracks, track = tracked()
    window = agent.navmap.frame.window_at(0.0, 0.0, agent.config.window_cells)
    here = Pose(*tracks.middle_xy_m(track), 0.0)
    around, straight = Approach(None, 1.0, (0, 0)), Approach(None, 2.0, (0, 0))
    lengths_m = {1.0: 0.0, 2.0: 0.0}  # by bearing
    monkeypatch.setattr(Approach, "length_m", property(lambda each: lengths_m[each.bearing_rad]))
    monkeypatch.setattr(seeker, "_approach", lambda *given: straight if given[-1] is LastResort.VERIFY else None)
    monkeypatch.setattr(track_seeker, "look_at", lambda *_: around)
    seeker.verdicts.looks.clear()
    seeker.probability[track] = seeker.config.look.straight
    most_m = seeker.config.look.detour_m

    def bearing_rad() -> float | None:
        found = seeker._look(agent.navmap, window, here, track)
        return None if found is None else found.bearing_rad

    lengths_m[1.0] = most_m
    assert bearing_rad() == around.bearing_rad
    lengths_m[1.0] = most_m + 0.1
    assert bearing_rad() == straight.bearing_rad
    lengths_m[2.0] = most_m + 0.1
    assert bearing_rad() is None
    assert not seeker._aside.is_due(track, seeker.step)  # it is tried again later


def test_a_look_ends_where_another_track_is_worth_it_far_more(monkeypatch: pytest.MonkeyPatch):
    _, seeker, _, one = tracked()
    two, here = one + 1, Pose(0.0, 0.0, 0.0)
    seeker.pursued = one
    for gain, best in ((0.1, one), (0.3, two)):
        monkeypatch.setattr(seeker, "_worth", lambda tracks, pose, gain=gain: np.array([0.4, 0.4 + gain]))
        assert seeker._best_doubtful([one, two], here) == best


def test_the_nearest_of_equally_good_tracks_is_approached_and_a_much_better_one_before_it():
    agent, seeker, tracks, one = tracked()
    assert agent.pose is not None
    two = tracks._begin()
    tracks._low[two], tracks._high[two] = tracks._low[one], tracks._high[one]
    seeker._accepted = [one, two]
    seeker.probability = np.append(seeker.probability, np.float32(0.0))
    seeker.probability[[one, two]] = 0.9, 0.85
    assert seeker._best_accepted(agent.pose) == [one, two]
    seeker.probability[two] = 0.5
    assert seeker._best_accepted(agent.pose) == [one]


def test_tracks_next_to_an_accepted_one_that_may_be_parts_of_it_are_approached_too():
    _, seeker, tracks, number = tracked()
    part, far = tracks._begin(), tracks._begin()
    tracks._low[part] = tracks._high[part] = tracks._high[number] + (2, 0, 0)
    tracks._low[far] = tracks._high[far] = tracks._high[number] + (3, 0, 0)
    seeker.probability = np.append(seeker.probability, np.array([0.7, 0.7], np.float32))
    seeker.probability[number] = 0.9
    assert part in seeker._with_parts([number])
    assert far not in seeker._with_parts([number])
    seeker.probability[part] = 0.4
    assert part not in seeker._with_parts([number])


def test_a_stop_at_a_part_judges_the_track_that_is_approached_and_not_a_better_one_elsewhere():
    agent, seeker, tracks, near = tracked()
    elsewhere = tracks._begin()
    tracks._low[elsewhere] = tracks._high[elsewhere] = tracks._low[near] + (60, 0, 0)
    seeker.probability = np.append(seeker.probability, np.float32(0.99))
    seeker.probability[near], seeker.verdicts.bar = 0.65, 0.8
    seeker.verdicts.rated = seeker.probability
    seeker._accepted, seeker._targets = [near, elsewhere], [near]
    owned = seeker.cells_of(agent.navmap, [near, elsewhere])
    of_part = tuple(int(each[0]) for each in np.nonzero(~owned))
    assert not seeker.judge(agent.navmap, of_part)  # type: ignore[arg-type]
    assert seeker.verdicts.rejected >= {near}
    assert seeker._accepted == [elsewhere]
    seeker.probability[near], seeker._accepted, seeker._targets = 0.75, [near, elsewhere], [near]
    assert seeker.judge(agent.navmap, of_part)  # type: ignore[arg-type]
    assert seeker.confidence == pytest.approx(0.75)


def test_context_counts_for_imperfect_detectors_and_with_a_share():
    def seeker_of(segmenter: Segmenter, **options: object) -> TrackSeeker:
        config = TrackSeekerConfig(**options)  # type: ignore[arg-type]
        agent = agents.make(
            "stubborn-plus", camera=SMALL_CAMERA, robot=RobotModel(), segmenter=segmenter, seeker=config
        )
        assert isinstance(agent, StubbornAgent)
        assert isinstance(agent.seeker, TrackSeeker)
        return agent.seeker

    assert seeker_of(Unsure(0.5)).evidence.context is not None
    assert seeker_of(Unsure(0.5), context_share=0.0).evidence.context is None
    assert seeker_of(GroundTruthSegmenter()).evidence.context is None
    with pytest.raises(ConfigError, match="Context file"):
        seeker_of(Unsure(0.5), context=Path("nowhere.json"))


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
def test_a_seeker_decides_by_the_probabilities_that_the_context_leaves(share: float):
    agent, seeker = agent_with(0.5)
    seeker.evidence.context_share = share
    seeker.evidence.context = read_context()
    seeker.evidence.context.constant[OBJECTS.index("bed")] = -2.0
    run_episode(GridWorld(ROOM, START, camera=SMALL_CAMERA), agent, "bed", max_steps=3)
    least = seeker.config.tracks.least_voxels
    expected = seeker.evidence.of_episode().probabilities("bed", least, seeker.evidence.context, share)
    np.testing.assert_array_equal(seeker.probability, expected)
    plain = seeker.evidence.of_episode().probabilities("bed", least)
    assert plain.max() > 0.3
    assert (seeker.probability.max() < plain.max() - 0.1) == (share > 0.0)


@pytest.mark.parametrize(
    "wrong",
    [{"context_share": 1.5}, {"as_good": -0.1}, {"core_share": 1.5}, {"part_share": -1.0}, {"near_best_m": 0.0}],
)
def test_wrong_settings_are_refused(wrong: dict):
    with pytest.raises(ConfigError, match="TrackSeekerConfig"):
        TrackSeekerConfig(**wrong)


def test_the_robot_drives_to_the_core_of_a_track_that_holds_a_part_of_another_object():
    agent, seeker, tracks, track = tracked()
    index, mask = tracks.footprint(track)
    rows, cols = (int(each[0]) for each in np.nonzero(mask))
    other = index[0].start + rows, index[1].start + cols
    agent.navmap.score_sum[index], agent.navmap.frames_in_view[index] = 9.0, 10
    assert seeker.cells_of(agent.navmap, [track])[other]
    agent.navmap.score_sum[other] = 2.0
    assert not seeker.cells_of(agent.navmap, [track])[other]
    assert seeker.cells_of(agent.navmap, [track]).sum() == mask.sum() - 1


def test_the_robot_drives_to_the_cells_around_the_best_one_where_there_is_a_path(monkeypatch: pytest.MonkeyPatch):
    agent, seeker, tracks, track = tracked()
    seeker._targets = [track]
    window = agent.navmap.frame.window_at(0.0, 0.0, agent.config.window_cells)
    given: list[np.ndarray] = []
    monkeypatch.setattr(seeker, "_approach", lambda navmap, window, pose, cells, resort: given.append(cells))
    index, mask = tracks.footprint(track)
    agent.navmap.score_sum[index], agent.navmap.frames_in_view[index] = 9.0, 10
    rows, cols = np.nonzero(mask)
    agent.navmap.score_sum[index[0].start + rows[-1], index[1].start + cols[-1]] = 9.5  # the best cell is at an end
    seeker._drive_to(agent.navmap, window, Pose(0.0, 0.0, 0.0), [track], LastResort.NONE)
    near_best, whole = given[0], given[1]
    assert near_best.any()
    assert (near_best <= whole).all()
    best = seeker._best_cell(agent.navmap, track)
    rows, cols = np.nonzero(near_best)
    assert 0.05 * np.hypot(rows - best[0], cols - best[1]).max() <= seeker.config.near_best_m + 1e-6
    assert near_best.sum() < whole.sum()
    assert not seeker._to_best


GLASS_M = 0.96
"""How near the table the robot's centre gets where glass keeps it away: beyond all viewpoints, and a STOP counts."""


def behind_glass() -> GridWorld:
    table = [box for box in ROOM if box.category == "table"]
    gap_m = GLASS_M - RobotModel().radius_m
    x, y = (
        (min(lo for lo, _ in spans) - gap_m, max(hi for _, hi in spans) + gap_m)
        for spans in ([box.x for box in table], [box.y for box in table])
    )
    return GridWorld([*ROOM, Box(x, y, (0.0, 0.4), "objects", seen=False)], START, camera=SMALL_CAMERA)


@pytest.mark.costly
def test_a_robot_that_can_reach_no_viewpoint_stops_within_the_success_distance():
    agent, _ = agent_with(0.97)
    world = behind_glass()
    trace = run_episode(world, agent, "bed", max_steps=200)
    assert trace.stopped
    assert GLASS_M - 0.02 < world.distance_to("table") < 1.0
    assert trace.collisions <= 10  # it tries all around first
