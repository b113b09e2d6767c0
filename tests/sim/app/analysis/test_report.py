"""The report: its page agrees with the files, draws the recorded paths, and works in a real browser."""

from __future__ import annotations

import base64
import itertools
import json
import re
import shutil
from collections.abc import Iterator
from dataclasses import replace
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from msgspec.structs import replace as changed

from sim.app.analysis.comparison import Run, read_run
from sim.app.analysis.report.drawings import ground_truth_of, path_on, split_of
from sim.app.analysis.report.facts import command_of, facts_of
from sim.app.analysis.report.plans import PX_M, Sheet, draw_plan, sheet_around
from sim.app.commands import run
from sim.app.commands.report import Args, main
from sim.app.evaluation.last_view import picture_file
from sim.app.viewers.video import VideoWriter, video_file
from sim.core.interface import ConfigError
from sim.core.pictures import image_size_px
from sim.task.explanations import explain, marks
from sim.task.ground_truth import GroundTruth
from sim.task.result import METRICS, EpisodeResult, StopTarget
from sim.task.trajectory import Trajectory, read_trajectory, trajectory_file, write_trajectory
from sim.world.world import World
from tests.helpers import wording
from tests.helpers.browser import ENTER, Browser, missing
from tests.helpers.results import a_result
from tests.helpers.worlds import room, two_storeys, with_box

MINUS = "\N{MINUS SIGN}"
HOSTILE = "</script><img src=x onerror=alert(1)> & \"' {{ 7*7 }}"


@pytest.fixture(scope="module")
def recorded_run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Returns a folder with the recorded run `found`: four episodes in which the oracle finds a sofa behind a wall."""
    folder = tmp_path_factory.mktemp("recorded_run")
    house = with_box(room(6, 4), "sofa_00", centre_m=(2.5, 0, 0.4), half_m=(0.4, 0.8, 0.4))
    house = with_box(house, "wall_10", centre_m=(0.5, 0.6, 1.25), half_m=(0.05, 1.4, 1.25))
    (folder / "lounge.xml").write_text(house.spec.to_xml())
    options = ["--agent", "oracle", "--house", str(folder / "lounge.xml"), "--start-deg", "-2 1 90", "--record"]
    options += ["--noise", "realsense"]  # without noise one start and goal are one episode
    assert run.entry([*options, "--episodes", "4", "--out", str(folder / "found")]) == 0
    return folder


@pytest.fixture
def pair(recorded_run: Path, tmp_path: Path) -> tuple[Path, Path]:
    """Returns two runs of the same episodes; in the second run the first episode failed and the second one broke."""
    shutil.copytree(recorded_run / "found", tmp_path / "found")
    shutil.copytree(recorded_run / "found", tmp_path / "worse")
    failed = {"success": 0.0, "spl": 0.0, "soft_spl": 0.0, "failure": "explore", "end_reason": "max_steps"}
    broken = {"success": 0.0, "spl": 0.0, "failure": "misc", "end_reason": "error", "error": HOSTILE}
    lines = [line | changed for line, changed in zip(_lines(tmp_path / "worse"), (failed, broken, {}, {}), strict=True)]
    _write_lines(tmp_path / "worse", lines)
    first, second = (line["episode_id"] for line in lines[:2])
    _rewrite(trajectory_file(tmp_path / "worse", first), success=False, end_reason="max_steps")
    trajectory_file(tmp_path / "worse", second).unlink()
    return tmp_path / "found", tmp_path / "worse"


def _lines(folder: Path) -> list[dict[str, Any]]:
    return [json.loads(line) for line in (folder / "results.jsonl").read_text().splitlines()]


def _write_lines(folder: Path, lines: list[dict[str, Any]]) -> None:
    (folder / "results.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines))


def _rewrite(file: Path, **changed: Any) -> None:
    before = read_trajectory(file)
    write_trajectory(file, Trajectory(**{**vars(before), **changed}), before.about)


def _page(*folders: Path) -> str:
    out = folders[-1] / "page.html"
    assert main(Args(runs=folders, out=out)) == 0
    return out.read_text()


def _data(page: str) -> dict[str, Any]:
    match = re.search(r'<script type="application/json" id="data">(.*?)</script>', page, re.DOTALL)
    assert match is not None
    return json.loads(match[1])


def _first(folder: Path) -> EpisodeResult:
    return next(iter(read_run(folder).results.values()))


def _points(numbers: list[int]) -> np.ndarray:
    return np.array(numbers).reshape(-1, 2)


def test_a_path_on_the_page_is_the_recorded_one(recorded_run: Path) -> None:
    run_read = read_run(recorded_run / "found")
    data = _data(_page(recorded_run / "found"))
    sheet = Sheet(GroundTruth(World(split_of(run_read).load_house("lounge"))).space().frame)
    for episode in data["episodes"]:
        recorded = read_trajectory(trajectory_file(recorded_run / "found", episode["id"]))
        drawn = episode["paths"][0]
        places_m = np.cumsum([drawn["x"], drawn["y"]], axis=1).T / PX_M * (1, -1)
        places_m += (sheet.frame.origin_xy_m[0], sheet.frame.origin_xy_m[1] + sheet.size_px[1] / PX_M)
        np.testing.assert_allclose(places_m, recorded.positions_m, atol=0.006)
        assert np.cumsum(drawn["a"])[0] == -90  # the page's y points down
        assert len(drawn["actions"]) == len(drawn["d"]) - 1 == recorded.num_steps


def test_the_shortest_path_has_the_measured_length_and_goes_round_the_wall(recorded_run: Path) -> None:
    run_read = read_run(recorded_run / "found")
    truth = GroundTruth(World(split_of(run_read).load_house("lounge")))
    corners = truth.space().path(truth.target("sofa").distance_m, -2.0, 1.0)
    assert corners is not None
    length_m = float(np.hypot(*np.diff(corners, axis=0).T).sum())
    assert length_m == pytest.approx(next(iter(run_read.results.values())).shortest_path, rel=0.02)
    samples = np.concatenate([np.linspace(a, b, 200) for a, b in itertools.pairwise(corners)])
    assert truth.space().free[tuple(truth.space().frame.to_cells(samples).T)].all()


def test_the_plan_shows_objects_at_their_positions_and_leaves_doorways_open() -> None:
    house = with_box(room(6, 4), "sofa_00", centre_m=(2.5, 0, 0.4), half_m=(0.4, 0.8, 0.4))
    house = with_box(house, "wall_10", centre_m=(0, 1.0, 1.25), half_m=(0.05, 1.0, 1.25))
    house = with_box(house, "wall_11", centre_m=(0, -1.0, 2.3), half_m=(0.05, 1.0, 0.2))  # a lintel
    house = with_box(house, "lighting_00", centre_m=(-1, 0, 2.4), half_m=(0.2, 0.2, 0.1))
    plan = draw_plan(GroundTruth(World(house)), 0.0)
    sheet = Sheet(GroundTruth(World(house)).space().frame)
    shapes = {name: path for _, name, path in plan["shapes"]}
    assert set(shapes) == {"sofa_00", "wall"}
    start = np.array(re.match(r"M(\d+) (\d+)l", shapes["sofa_00"]).groups(), int)  # type: ignore[union-attr]
    steps = _points([int(n) for n in re.findall(r"-?\d+", shapes["sofa_00"].split("l", 1)[1])])
    corners = np.vstack([start, start + np.cumsum(steps, axis=0)])
    expected = sheet.place([(2.1, -0.8), (2.9, 0.8)])
    np.testing.assert_allclose(np.sort(corners.min(axis=0)), np.sort(expected.min(axis=0)), atol=1)
    np.testing.assert_allclose(np.sort(corners.max(axis=0)), np.sort(expected.max(axis=0)), atol=1)
    assert _covers(shapes["wall"], sheet.place([(0.0, 1.0)])[0])
    assert not _covers(shapes["wall"], sheet.place([(0.0, -1.0)])[0])
    assert plan["rooms"][0][0] == "living"


def test_a_plan_shows_one_storey() -> None:
    truth = GroundTruth(World(two_storeys()))
    for floor_z_m, category_of_storey in ((0.0, "bed"), (3.0, "sofa")):
        plan = draw_plan(truth, floor_z_m)
        assert {category for category, _, _ in plan["shapes"]} == {category_of_storey, "wall"}
        assert [name for name, *_ in plan["rooms"]] == ["living" if floor_z_m == 0.0 else "bedroom"]


def _covers(path: str, place: np.ndarray) -> bool:
    """Applies the even-odd rule to the closed parts of a path of relative lines."""
    inside = False
    for part in path.split("z")[:-1]:
        numbers = [int(n) for n in re.findall(r"-?\d+", part)]
        corners = np.cumsum(_points(numbers), axis=0)
        for (x0, y0), (x1, y1) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            if (y0 > place[1]) != (y1 > place[1]) and place[0] < x0 + (place[1] - y0) * (x1 - x0) / (y1 - y0):
                inside = not inside
    return inside


def test_a_house_is_drawn_once_for_all_its_episodes(recorded_run: Path) -> None:
    data = _data(_page(recorded_run / "found"))
    assert len(data["episodes"]) == 4
    assert list(data["plans"]) == ["lounge@0"]
    assert list(data["areas"]) == ["lounge@0/sofa"]


def test_a_hundred_long_episodes_fit_into_five_megabytes() -> None:
    rng = np.random.default_rng(0)
    walk = np.cumsum(rng.uniform(-0.3, 0.3, (501, 2)), axis=0).astype(np.float32)
    poses = np.column_stack([walk, rng.uniform(-3, 3, 501), np.zeros(501)]).astype(np.float32)
    no, steps = np.zeros(500, np.bool_), np.arange(500)
    contacts = np.column_stack([steps, walk[:-1]]).astype(np.float32)  # a collision in every step
    trajectory = Trajectory(
        poses=poses,
        actions=np.ones(500, np.uint8),
        ended=np.zeros(500, np.uint8),
        collided=~no,
        touched=~no,
        goal_share=rng.uniform(0, 0.016, 501).astype(np.float32),
        distance_m=rng.uniform(0, 20, 501).astype(np.float32),
        duration_s=np.ones(500, np.float32),
        contacts=contacts,
        goal_on_storey=True,
        nearest_instance_m=2.0,
        success=False,
        end_reason="max_steps",
    )
    drawn = json.dumps(path_on(sheet_around(walk), trajectory, radius_m=0.18), separators=(",", ":"))
    assert 100 * len(drawn) < 4_000_000  # 20 houses take 0.3 MB


def test_text_from_files_stays_text(pair: tuple[Path, Path]) -> None:
    _, folder = pair
    lines = [line | {"episode_id": f"{HOSTILE}{i}", "house": HOSTILE} for i, line in enumerate(_lines(folder))]
    _write_lines(folder, lines)
    page = _page(folder)
    assert "<img" not in page
    assert page.count("</script>") == 2
    assert "{{" in page  # not run as a template
    assert _data(page)["episodes"][0]["id"].startswith(HOSTILE)


def test_a_page_names_no_other_address(recorded_run: Path) -> None:
    page = _page(recorded_run / "found")
    assert not re.search(r'(src|href)="(?!#|data:)|url\(|@import|https?://(?!www\.w3\.org/)', page)


def test_only_existing_videos_are_linked_and_relative_to_the_page(recorded_run: Path, tmp_path: Path) -> None:
    shutil.copytree(recorded_run / "found", tmp_path / "a run")
    episode_id = _lines(tmp_path / "a run")[1]["episode_id"]
    (tmp_path / "a run" / "videos").mkdir()
    (tmp_path / "a run" / "videos" / f"{episode_id}.mp4").touch()
    (tmp_path / "pages").mkdir()
    out = tmp_path / "pages" / "p.html"
    main(Args(runs=(tmp_path / "a run",), out=out))
    videos = {episode["id"]: episode["videos"][0] for episode in _data(out.read_text())["episodes"]}
    assert videos.pop(episode_id) == f"../a%20run/videos/{episode_id}.mp4"
    assert set(videos.values()) == {None}


def test_the_last_picture_is_linked_and_its_thumbnail_is_part_of_the_page(recorded_run: Path, tmp_path: Path) -> None:
    shutil.copytree(recorded_run / "found", tmp_path / "run")
    first, second, *_ = [line["episode_id"] for line in _lines(tmp_path / "run")]
    picture_file(tmp_path / "run", first).write_bytes(b"rubbish")
    picture_file(tmp_path / "run", second).unlink()
    page = _page(tmp_path / "run")
    episodes = _data(page)["episodes"]
    assert [episode["thumbs"][0] is None for episode in episodes] == [True, True, False, False]
    assert episodes[2]["pictures"] == [f"pictures/{episodes[2]['id']}.jpg"]
    jpeg = base64.b64decode(episodes[2]["thumbs"][0])
    assert image_size_px(jpeg) == (128, 96)
    assert len(jpeg) < 6_000  # 200 of them are less than 1.6 MB in the page
    assert "has an unsupported format" in page
    assert "1 of 4 episodes have no pictures of the end (they were run without --record)." in page


def test_a_run_without_trajectories_has_a_report_that_says_how_to_get_pictures(
    recorded_run: Path, tmp_path: Path
) -> None:
    shutil.copytree(recorded_run / "found", tmp_path / "run")
    shutil.rmtree(tmp_path / "run" / "trajectories")
    page = _page(tmp_path / "run")
    assert "There are no trajectories (plans with paths) and no videos." in page
    assert "--start-deg &#39;-2 1 90&#39;" in page
    assert "--record" in page
    assert _data(page)["plans"] == {}
    assert _data(page)["episodes"][0]["words"] == ["Found."]


def test_a_house_that_has_changed_is_not_drawn_but_the_paths_are(recorded_run: Path, tmp_path: Path) -> None:
    shutil.copytree(recorded_run / "found", tmp_path / "run")
    config = json.loads((tmp_path / "run/config.json").read_text())
    config["split_identity"]["sha256"] = "0" * 64
    (tmp_path / "run/config.json").write_text(json.dumps(config))
    page = _page(tmp_path / "run")
    assert "was run in another version of &#39;lounge&#39;" in page
    assert _data(page)["plans"] == {}
    assert len(_data(page)["episodes"][0]["paths"][0]["x"]) > 5


def test_an_unfinished_run_and_broken_episodes_are_reported(pair: tuple[Path, Path]) -> None:
    _, folder = pair
    _write_lines(folder, _lines(folder)[:3])
    page = _page(folder)
    assert "Not finished: 3 of 4 episodes have ended." in page
    assert "1 of 3 episodes ended with an error" in page
    assert "Episodes that ended with an error" in page


def test_a_complete_shard_is_finished_and_an_incomplete_one_names_the_folder_of_the_run(
    pair: tuple[Path, Path],
) -> None:
    _, folder = pair
    shard = folder.parent / "whole" / "shard_1_of_2"
    shutil.copytree(folder, shard)
    config = json.loads((shard / "config.json").read_text()) | {"shard": "1/2", "episodes": 8}
    (shard / "config.json").write_text(json.dumps(config))
    assert "Not finished" not in _page(shard)
    (shard / "config.json").write_text(json.dumps(config | {"episodes": 9}))
    page = _page(shard)
    assert "Not finished: 4 of 5 episodes have ended." in page
    assert f"The command with --out {shard.parent} runs the rest." in page


@pytest.mark.parametrize("missing", [{}, {"split_identity": None}])
def test_a_run_without_the_identity_of_its_split_is_shown_without_houses(
    recorded_run: Path, tmp_path: Path, missing: dict[str, None]
) -> None:
    shutil.copytree(recorded_run / "found", tmp_path / "run")
    config = json.loads((tmp_path / "run/config.json").read_text())
    del config["split_identity"]
    (tmp_path / "run/config.json").write_text(json.dumps(config | missing))
    assert "has no field &#39;split_identity&#39;" in _page(tmp_path / "run")


@pytest.mark.parametrize(
    ("broken", "sentence"),
    [
        (lambda folder: shutil.rmtree(folder), "config.json"),
        (lambda folder: (folder / "results.jsonl").write_text(""), wording.HAS_NO_RESULT_YET),
        (lambda folder: (folder / "results.jsonl").write_text('{"a": 1}\n{}\n'), wording.IS_NOT_A_RUN),
    ],
)
def test_a_folder_that_is_not_a_run_gives_one_sentence(
    recorded_run: Path, tmp_path: Path, broken: Any, sentence: str
) -> None:
    shutil.copytree(recorded_run / "found", tmp_path / "run")
    broken(tmp_path / "run")
    with pytest.raises(ConfigError, match=sentence):
        main(Args(runs=(tmp_path / "run",)))
    assert not (tmp_path / "run" / "report.html").exists()


def test_an_unreadable_trajectory_is_reported_and_the_others_are_drawn(recorded_run: Path, tmp_path: Path) -> None:
    shutil.copytree(recorded_run / "found", tmp_path / "run")
    first = _lines(tmp_path / "run")[0]["episode_id"]
    trajectory_file(tmp_path / "run", first).write_bytes(b"PK rubbish")
    page = _page(tmp_path / "run")
    assert "is not a trajectory" in page
    drawn = ["paths" in episode for episode in _data(page)["episodes"]]
    assert drawn == [False, True, True, True]


def test_two_runs_are_shown_side_by_side_with_paired_differences(pair: tuple[Path, Path]) -> None:
    page = _page(*pair)
    data = _data(page)
    assert data["runs"] == ["A", "B"]
    assert [path is None for path in data["episodes"][0]["paths"]] == [False, False]
    assert [path is None for path in data["episodes"][1]["paths"]] == [False, True]
    assert '-50.0</span> <span class="ci">[-100.0, +41.9]*</span>' in page.replace("\n", "")
    assert page.count('data-outcome="only-a') == 2


def test_the_page_of_two_runs_lists_the_fields_in_which_they_differ(pair: tuple[Path, Path]) -> None:
    assert "The configurations are equal." in _page(*pair)
    file = pair[1] / "config.json"
    file.write_text(json.dumps(json.loads(file.read_text()) | {"workers": 7, "seed": 3}))
    page = _page(*pair)
    assert re.search(r"<code>seed</code></th><td data-label=\"A\">0</td><td data-label=\"B\">3</td>", page)
    assert "<code>workers</code>" not in page
    assert "Fields in which the runs differ" not in _page(pair[0])


def test_several_runs_are_columns_with_differences_from_the_first_and_a_trend(pair: tuple[Path, Path]) -> None:
    page = _page(pair[0], pair[1], pair[0])
    data = _data(page)
    assert data["runs"] == ["A", "B", "C"]
    shown = sum(not metric.chains for metric in METRICS.values())
    assert page.count(f"B {MINUS} A") == page.count(f"C {MINUS} A") == shown + 6  # rows of groups
    assert "Trend of the runs in their order" in page
    assert "Trend of the runs in their order" not in _page(*pair)
    assert page.count('data-outcome="some ') == 2
    assert page.count('data-outcome="all"') == 2
    with pytest.raises(ConfigError, match="1 to 12"):
        main(Args(runs=(pair[0],) * 13))


def test_the_page_states_over_what_its_intervals_are(pair: tuple[Path, Path]) -> None:
    assert "There is one house: they (*) are over its episodes" in _page(pair[0])
    _write_lines(pair[0], [line | {"house": f"h{i}"} for i, line in enumerate(_lines(pair[0]))])
    assert "95 % intervals over houses" in _page(pair[0])


def test_runs_of_other_episodes_are_refused(recorded_run: Path, pair: tuple[Path, Path]) -> None:
    _, folder = pair
    _write_lines(folder, [line | {"shortest_path": 99.0} for line in _lines(folder)[2:]])
    with pytest.raises(ConfigError, match=wording.NOT_RUN_ON_THE_SAME_EPISODES):
        main(Args(runs=(recorded_run / "found", folder)))


def test_the_words_give_the_rule_with_its_numbers(pair: tuple[Path, Path]) -> None:
    _, folder = pair
    result = _first(folder)
    trajectory = read_trajectory(trajectory_file(folder, result.episode_id))
    unseen = Trajectory(**{**vars(trajectory), "goal_share": np.full_like(trajectory.goal_share, np.nan)})
    words = explain(result, unseen)
    assert f"never covered 0.8 % of a frame in {unseen.num_steps} steps" in words
    assert [mark.kind for mark in marks(result, unseen)][-1] == "end"
    other = explain(changed(result, failure="loop"), unseen)
    assert "By the rules of the code that wrote this report the cause is explore." in other


def test_a_wrong_stop_is_reported_with_the_place_for_which_the_agent_stopped(pair: tuple[Path, Path]) -> None:
    _, folder = pair
    result = changed(_first(folder), failure="false_detection", stop_target_to_goal_m=None)
    whole = read_trajectory(trajectory_file(folder, result.episode_id))
    wrong = replace(whole, success=False, end_reason="stop", nearest_instance_m=0.9)
    begin = f"Called STOP at step {whole.num_steps}"
    assert explain(result, wrong).startswith(f"{begin}: the nearest sofa is 0.9 m away. The sofa was in view")
    aimed = changed(result, stop_target_xy_m=(1.0, 2.0), stop_target_to_goal_m=1.84)
    assert explain(aimed, wrong).startswith(f"{begin} for something 1.8 m from the nearest sofa. The sofa was in view")
    named = explain(changed(aimed, stop_target_category="chest_of_drawers"), wrong)
    assert named.startswith(f"{begin} at a chest of drawers, 1.8 m from the nearest sofa. The sofa was in view")
    stop = StopTarget(stop_target_xy_m=(1.0, 2.0), stop_target_to_goal_m=0.1, stop_target_category="sofa")
    words = explain(changed(result, failure="stopped_short"), replace(wrong, stop=stop, nearest_instance_m=1.7))
    assert words.startswith(f"{begin} short of the goal: the nearest sofa is 1.7 m away.")


def test_a_missed_goal_was_in_view_before(pair: tuple[Path, Path]) -> None:
    _, folder = pair
    result = changed(_first(folder), failure="missed_detection")
    trajectory = read_trajectory(trajectory_file(folder, result.episode_id))
    share, distance_m = np.zeros_like(trajectory.goal_share), np.full_like(trajectory.distance_m, 2.0)
    share[5:7], distance_m[[2, 8]] = 0.1, 0.0
    missed = Trajectory(**{**vars(trajectory), "goal_share": share, "distance_m": distance_m})
    assert "in view from step 5 on, in 2 frames. At step 8 a STOP would have succeeded" in explain(result, missed)
    assert [mark.step for mark in marks(result, missed)] == [5, 8, missed.num_steps]


def test_one_frame_and_a_plural_goal_are_worded_with_their_number(pair: tuple[Path, Path]) -> None:
    _, folder = pair
    result = changed(_first(folder), failure="missed_detection", goal="clothes")
    trajectory = read_trajectory(trajectory_file(folder, result.episode_id))
    share = np.zeros_like(trajectory.goal_share)
    share[5] = 0.1
    once = Trajectory(**{**vars(trajectory), "goal_share": share})
    assert explain(result, once).startswith("The clothes were in view from step 5 on, in 1 frame.")
    assert marks(result, once)[0].words == "clothes first in view (1 frame in all)"


def test_a_single_pair_has_no_interval(pair: tuple[Path, Path]) -> None:
    for folder in pair:
        _write_lines(folder, _lines(folder)[:1])
    page = _page(*pair)
    assert "-100.0" in page
    assert "[-100.0" not in page
    assert "a single pair has no interval" in page


def test_each_table_with_marked_differences_explains_the_mark(pair: tuple[Path, Path]) -> None:
    page = _page(*pair)
    for title in ("goal", "house", "distance", "size"):
        section = page.split(f'aria-labelledby="by-{title}"')[1].split("</section>")[0]
        table, note = section.split("</table>")
        assert "]*" in table
        assert "(*)" in note


def test_the_command_of_a_run_makes_the_same_run(recorded_run: Path) -> None:
    words = command_of(read_run(recorded_run / "found").config)
    assert words.startswith("stubborn run --agent oracle --semantics rednet --house")
    assert "--split" not in words


@pytest.mark.parametrize("agent", ["human", "human+agent", "ros", "random"])
def test_a_command_is_shown_only_where_it_can_run_the_agent(agent: str, tmp_path: Path) -> None:
    run = Run(tmp_path, {"agent": agent, "semantics": "gt", "episodes": 2}, {"e0": a_result(episode_id="e0")})
    facts = facts_of(run, "", {"e0": [None]}, 0)
    assert bool(facts.command) == bool(facts.hint) == ("The command" in facts.notes[0]) == (agent == "random")


@pytest.mark.parametrize("scheme", [0, 1], ids=["light", "dark"])
def test_text_has_the_contrast_ratio_of_wcag(scheme: int) -> None:
    css = (files("sim.app.analysis.report") / "page" / "report.css").read_text()
    blocks = re.findall(r":root \{(.*?)\}", css, re.DOTALL)
    colours = dict(re.findall(r"--([\w-]+): (#[0-9a-f]{6});", blocks[scheme]))
    pairs = [(text, ground) for text in ("ink", "quiet", "accent") for ground in ("card", "ground")]
    pairs += [("warn-ink", "warn"), ("ink", "good-soft"), ("ink", "bad-soft"), ("quiet", "floor")]
    for text, ground in pairs:
        darker, lighter = sorted(_luminance(colours[name]) for name in (text, ground))
        assert (lighter + 0.05) / (darker + 0.05) >= 4.5, (text, ground)


def _luminance(colour: str) -> float:
    """Returns the relative luminance as defined by WCAG 2."""
    shares = [int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    linear = [share / 12.92 if share <= 0.04045 else ((share + 0.055) / 1.055) ** 2.4 for share in shares]
    return float(np.dot([0.2126, 0.7152, 0.0722], linear))


# ---- in a real browser


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    reason = missing()
    if reason:
        pytest.skip(reason)
    opened = Browser(tmp_path_factory.mktemp("profile"))
    yield opened
    opened.close()


SHOWN = "return [...document.querySelectorAll('tr[data-index]')].filter(r => !r.hidden).map(r => r.cells[0].innerText)"


def _open(browser: Browser, *folders: Path, fragment: str = "") -> None:
    _page(*folders)
    browser.resize(1280, 900)
    browser.open(folders[-1] / "page.html", fragment)


def test_the_page_opens_from_disk_without_requests_or_console_errors(browser: Browser, pair: tuple[Path, Path]) -> None:
    for folders in ((pair[0],), pair):
        browser.requests()  # forgets those of other pages
        browser.console_errors()
        _open(browser, *folders)
        assert len(browser.run(SHOWN)) == 4
        own = ("data:image/jpeg;base64,", (folders[-1] / "page.html").as_uri())
        assert [address for address in browser.requests() if not address.startswith(own)] == []
        assert browser.console_errors() == []


def test_the_table_sorts_both_ways_and_says_so(browser: Browser, pair: tuple[Path, Path]) -> None:
    lines = _lines(pair[0])
    for line, steps in zip(lines, (30, 9, 200, 100), strict=True):
        line["num_steps"] = steps
    lines[3]["distance_to_goal"] = None
    _write_lines(pair[0], lines)
    ids = [line["episode_id"] for line in lines]
    _open(browser, pair[0])
    column = "thead button[data-column='5']"
    browser.click(column)
    assert browser.run(SHOWN) == [ids[i] for i in (1, 0, 3, 2)]
    assert browser.run(f'return document.querySelector("{column}").parentNode.ariaSort') == "ascending"
    browser.keys(column, ENTER)
    assert browser.run(SHOWN) == [ids[i] for i in (2, 3, 0, 1)]
    for _ in range(2):  # rows without a value are last in both directions
        browser.click("thead button[data-column='7']")
        assert browser.run(SHOWN)[-1] == ids[3]
    assert browser.console_errors() == []


def test_the_table_filters_by_words_by_outcome_and_from_the_causes(browser: Browser, pair: tuple[Path, Path]) -> None:
    ids = [line["episode_id"] for line in _lines(pair[1])]
    _open(browser, pair[1])
    browser.keys("input[name=text]", ids[2])
    assert browser.run(SHOWN) == [ids[2]]
    assert browser.run("return document.getElementById('count').textContent") == "1 of 4 episodes"
    browser.click("button[type=reset]")
    browser.click("[data-filter=outcome][data-value=explore]")
    settled = "return new Promise(done => setTimeout(() => done(null), 50))"
    browser.run(settled)
    assert browser.run(SHOWN) == [ids[0]]
    browser.click("button[type=reset]")
    browser.run(settled)
    assert browser.run(SHOWN) == ids
    browser.keys("input[name=text]", "nothing like it")
    assert browser.run("return document.getElementById('none').hidden") is False
    assert browser.console_errors() == []


def test_a_row_opens_its_picture_by_key_and_the_slider_moves_the_robot(
    browser: Browser, pair: tuple[Path, Path]
) -> None:
    _open(browser, *pair)
    browser.keys(".open", ENTER)
    assert browser.run("return document.querySelector('.open').ariaExpanded") == "true"
    for part in ("wall", "goal", "area", "shortest", "trail", "robot", "start", "mark"):
        assert browser.run("return document.querySelectorAll('.plan .' + arguments[0]).length", part) >= 2, part
    robot = "return document.querySelector('.plan .robot').getAttribute('transform')"
    before = browser.run(robot)
    browser.keys(".scrub input", "\ue012\ue012\ue012\ue012\ue012")  # left arrows
    assert browser.run(robot) != before
    assert "to go" in browser.run("return document.querySelector('.scrub output').textContent")
    browser.keys(".open", ENTER)
    assert browser.run("return document.querySelectorAll('.plan').length") == 0
    assert browser.console_errors() == []


def test_an_address_with_an_episode_opens_it(browser: Browser, pair: tuple[Path, Path]) -> None:
    _open(browser, pair[1], fragment=f"#episode={_lines(pair[1])[2]['episode_id']}")
    assert browser.run("return document.querySelectorAll('.detail').length") == 1
    assert browser.console_errors() == []


def test_nothing_runs_out_of_a_narrow_window(browser: Browser, pair: tuple[Path, Path]) -> None:
    _open(browser, *pair)
    browser.click(".open")
    for width in (1280, 900, 400):
        browser.resize(width, 800)
        assert browser.run("return document.documentElement.scrollWidth") <= width
        edges = "return [...document.querySelectorAll('.detail .plan')].map(p => p.getBoundingClientRect().right)"
        assert max(browser.run(edges)) <= width


def test_no_cause_of_a_failure_is_clipped_on_a_phone(browser: Browser, pair: tuple[Path, Path]) -> None:
    failed = [line | {"success": 0.0, "failure": "missed_detection"} for line in _lines(pair[1])]
    _write_lines(pair[1], failed)
    _open(browser, pair[1])
    browser.resize(390, 800)
    clipped = "return [...document.querySelectorAll('.scroll')].filter(box => box.scrollWidth > box.clientWidth).length"
    assert browser.run(clipped) == 0


OVERFLOW = """
return [...document.querySelectorAll('.scroll')].filter(box => box.scrollWidth > box.clientWidth).length
  + (document.documentElement.scrollWidth > innerWidth)"""


@pytest.mark.costly
@pytest.mark.parametrize("runs", [1, 2, 6])
def test_no_column_is_clipped_at_1400_and_800_pixels(browser: Browser, pair: tuple[Path, Path], runs: int) -> None:
    houses = [line | {"house": f"a_house_{i}", "goal": "chest_of_drawers"} for i, line in enumerate(_lines(pair[0]))]
    for folder in pair:
        _write_lines(folder, houses)
    folders = [pair[1 - i % 2] for i in range(runs)]
    _open(browser, *folders)
    browser.click(".open")
    for width in (1400, 800):
        browser.resize(width, 900)
        assert browser.run(OVERFLOW) == 0


def test_pictures_and_videos_show_where_the_page_was_moved_with_its_run(
    browser: Browser, recorded_run: Path, tmp_path: Path
) -> None:
    shutil.copytree(recorded_run / "found", tmp_path / "first")
    episode_id = _lines(tmp_path / "first")[0]["episode_id"]
    writer = VideoWriter(video_file(tmp_path / "first", episode_id), size_px=(128, 96))
    writer.write(np.zeros((96, 128, 3), np.uint8))
    writer.finish()
    _page(tmp_path / "first")
    (tmp_path / "first").rename(tmp_path / "moved")
    browser.open(tmp_path / "moved" / "page.html")
    browser.click(".open")
    assert browser.run("return document.querySelectorAll('.thumb').length") == 4
    loaded = """return new Promise(done => {
      const [image, video] = [document.querySelector('figure img'), document.querySelector('video')];
      video.addEventListener('loadeddata', () => image.decode().then(
        () => done([image.naturalWidth, video.videoWidth, video.poster])
      ));
      video.load(); video.play();
    })"""
    assert browser.run(loaded) == [640, 128, ""]  # the picture of the end is above it
    assert browser.console_errors() == []
    shutil.copy(tmp_path / "moved" / "page.html", tmp_path / "page.html")
    browser.open(tmp_path / "page.html")
    browser.click(".open")
    waited = "return new Promise(done => setTimeout(() => done(document.querySelector('.detail').innerText), 300))"
    assert "The large picture does not exist: keep the page next to the folder of its run." in browser.run(waited)


def test_text_from_files_runs_nothing_in_the_browser(browser: Browser, pair: tuple[Path, Path]) -> None:
    lines = [line | {"episode_id": f"{i}{HOSTILE}", "house": HOSTILE} for i, line in enumerate(_lines(pair[1]))]
    _write_lines(pair[1], lines)
    _open(browser, pair[1])
    browser.run("document.querySelectorAll('.open').forEach(button => button.click())")
    assert browser.run("return document.querySelectorAll('img').length") == 0
    assert browser.console_errors() == []


def test_the_ground_truth_of_a_page_follows_the_success_rule_of_the_run() -> None:
    house = with_box(room(6, 4), "sofa_00", centre_m=(2.5, 0, 0.4), half_m=(0.4, 0.8, 0.4))
    areas = []
    for distance_m in (1.0, 0.5):
        run = Run(Path("runs/x"), {"config": {"task": {"success": {"distance_m": distance_m}}}}, {})
        areas.append(int(ground_truth_of(run, house).target("sofa").reached.sum()))
    assert areas[1] < 0.7 * areas[0]


def test_the_ground_truth_of_a_page_has_the_robot_of_the_run() -> None:
    run = Run(Path("runs/x"), {"config": {"robot": {"body": {"radius_m": 0.22}, "file": None}}}, {})
    assert ground_truth_of(run, room(6, 4)).world.robot.radius_m == 0.22
