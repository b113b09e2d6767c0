"""Paired differences against known numbers, runs that are read back, and fields in which runs differ."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import pytest
from msgspec.structs import replace as changed

from sim.app.analysis.comparison import code_of, compare, differences_table, read_run, require_same_episodes
from sim.app.analysis.metrics import replicate_note
from sim.app.analysis.tables import ONE_HOUSE_NOTE, Cell, ResultTable, to_csv, to_markdown, to_rich, with_corrections
from sim.app.commands.compare import verdict
from sim.app.evaluation.config_fields import ABSENT, differing_fields, run_differences
from sim.app.evaluation.intervals import MIN_PAIRS, Estimate, paired_difference
from sim.core.interface import ConfigError
from tests.helpers import wording
from tests.helpers.results import a_goal, write_lines


def houses(count: int) -> list[str]:
    """Returns one house for each episode, so that intervals over houses equal intervals over episodes."""
    return [f"house_{i:03d}" for i in range(count)]


def test_two_pairs_that_differ_by_nothing_and_by_one() -> None:
    half = 12.7062 * 0.5  # Student's t of 1, standard error of (0, 1)
    difference = paired_difference([1.0, 0.0], [1.0, 1.0], houses(2))
    assert (difference.mean, difference.low, difference.high) == pytest.approx((0.5, 0.5 - half, 0.5 + half), abs=1e-4)


def test_a_pair_without_one_of_its_values_does_not_count() -> None:
    assert paired_difference([1.0, None, 3.0], [2.0, 5.0, None], houses(3)) == Estimate(1.0, None, None, 1, 1)
    assert paired_difference([None], [1.0], houses(1)) == Estimate(None, None, None, 0, 0)
    with pytest.raises(ValueError, match="shorter"):
        paired_difference([1.0, 2.0], [1.0], houses(2))


@pytest.mark.parametrize(
    ("low", "high", "pairs", "significant"),
    [
        (0.1, 0.3, MIN_PAIRS, True),
        (-0.3, -0.1, MIN_PAIRS, True),
        (-0.1, 0.3, MIN_PAIRS, False),
        (0.0, 0.3, MIN_PAIRS, False),
        (-0.3, 0.0, MIN_PAIRS, False),
        (0.1, 0.3, MIN_PAIRS - 1, False),
        (None, None, 0, False),
    ],
)
def test_an_interval_that_holds_zero_or_has_few_pairs_is_not_significant(
    low: float | None, high: float | None, pairs: int, significant: bool
) -> None:
    cell = Cell(Estimate(None if low is None else 0.2, low, high, pairs, pairs), difference=True)
    assert cell.estimate.significant == significant
    assert ("not significant" in cell.text()) == (not significant and low is not None)


def test_differences_of_a_table_are_corrected_for_their_number_and_means_and_ratios_are_not() -> None:
    weak, strong = (Cell(Estimate(0.2, 0.1, 0.3, 40, 40, p=p), difference=True) for p in (0.02, 0.001))
    ratio = Cell(Estimate(0.5, 0.4, 0.6, 40, 40, neutral=1.0), difference=True)
    mean = Cell(Estimate(0.2, 0.1, 0.3, 40, 40))
    table = with_corrections(
        ResultTable("t", "T", ("agent", "a", "b"), [("x", [weak, strong, ratio, mean, "text"]), ("y", [weak])])
    )
    (_, (first, second, third, *rest)), (_, (last,)) = table.rows
    assert [cell.verdict for cell in (weak, strong)] == ["higher", "higher"]
    corrected = [cell.p_holm for cell in (first, second, last) if isinstance(cell, Cell)]
    assert corrected == pytest.approx([0.04, 0.003, 0.04])
    assert [*rest, third] == [mean, "text", ratio]
    many = with_corrections(ResultTable("t", "T", ("agent", "a"), [("x", [weak])] * 3 + [("y", [strong])]))
    verdicts = [cell.verdict for _, (cell,) in many.rows if isinstance(cell, Cell)]
    assert verdicts == ["not significant"] * 3 + ["higher"]


def run_folder(folder: Path, ids: str, *, split: str = "val", **of_lines: object) -> Path:
    folder.mkdir()
    config = {"split_identity": {"name": split, "version": "1", "sha256": "abc"}, "versions": {"code": "c0de"}}
    (folder / "config.json").write_text(json.dumps(config))
    write_lines(folder, *({"house": "house_0", "shortest_path": 4.2} | of_lines | {"episode_id": i} for i in ids))
    return folder


def test_only_episodes_that_both_runs_have_are_compared(tmp_path: Path) -> None:
    first, second = (read_run(run_folder(tmp_path / name, ids)) for name, ids in (("a", "abc"), ("b", "dcb")))
    assert require_same_episodes(first, second) == ["b", "c"]
    assert code_of(first, "a") == "c0de"


def test_runs_with_another_success_rule_are_compared_although_their_shortest_paths_differ(tmp_path: Path) -> None:
    folders = [run_folder(tmp_path / name, "ab", shortest_path=path_m) for name, path_m in (("a", 4.2), ("b", 3.9))]
    with pytest.raises(ConfigError, match="shortest_path"):
        require_same_episodes(*map(read_run, folders))
    for folder, distance_m in zip(folders, (1.0, 0.5), strict=True):
        with pytest.raises(ConfigError, match="shortest_path"):  # at least one of them has no configuration tree
            require_same_episodes(*map(read_run, folders))
        config = json.loads((folder / "config.json").read_text())
        config["config"] = {"task": {"success": {"distance_m": distance_m}}}
        (folder / "config.json").write_text(json.dumps(config))
    assert require_same_episodes(*map(read_run, folders)) == ["a", "b"]


def test_runs_that_cannot_be_compared_are_named(tmp_path: Path) -> None:
    first, other, foreign = (
        read_run(run_folder(tmp_path / name, ids, split=split))
        for name, ids, split in (("a", "ab", "val"), ("b", "cd", "val"), ("c", "ab", "test"))
    )
    with pytest.raises(ConfigError, match=wording.NO_EPISODE_IN_COMMON):
        require_same_episodes(first, other)
    with pytest.raises(ConfigError, match=r"val 1 \(abc\) and test 1 \(abc\)"):
        require_same_episodes(first, foreign)


@pytest.mark.parametrize(
    ("other", "message"),
    [
        ({"house": "house_1"}, 'house "house_0" and "house_1"'),
        ({"goal": "sofa"}, 'goal "bed" and "sofa"'),
        ({"shortest_path": 4.4}, "shortest_path 4.2 and 4.4"),
        ({"shortest_path": None}, "shortest_path 4.2 and null"),
    ],
)
def test_episodes_that_only_have_their_id_in_common_are_not_compared(other: dict, message: str, tmp_path: Path) -> None:
    first, second = read_run(run_folder(tmp_path / "a", "ab")), read_run(run_folder(tmp_path / "b", "bc", **other))
    with pytest.raises(ConfigError, match=f"same episodes: 'b' has {re.escape(message)}"):
        require_same_episodes(first, second)


def test_an_episode_that_broke_or_whose_path_was_measured_again_is_still_the_same(tmp_path: Path) -> None:
    first = read_run(run_folder(tmp_path / "a", "ab"))
    rounded = read_run(run_folder(tmp_path / "b", "ab", shortest_path=4.21))
    broken = read_run(run_folder(tmp_path / "c", "ab", shortest_path=None, end_reason="error"))
    nowhere = read_run(run_folder(tmp_path / "d", "ab", shortest_path=None))
    assert require_same_episodes(first, rounded) == require_same_episodes(first, broken) == ["a", "b"]
    assert require_same_episodes(nowhere, nowhere) == ["a", "b"]


def test_chains_are_the_same_although_the_robot_was_elsewhere_when_a_goal_began(tmp_path: Path) -> None:
    runs = []
    for name, path_m, success in (("a", 33.2, 0.5), ("b", 32.9, 0.75)):
        run = read_run(run_folder(tmp_path / name, "ab", shortest_path=path_m, success=success))
        runs.append(replace(run, results={i: changed(line, goals=(a_goal(),)) for i, line in run.results.items()}))
    assert require_same_episodes(*runs) == ["a", "b"]
    notes = compare(*runs).notes
    assert "A reaches more goals in no episode." in notes
    assert "B reaches more goals in 2 episodes: a b." in notes


def test_a_folder_that_is_not_a_run_is_reported(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"config\.json"):
        read_run(tmp_path)
    (tmp_path / "config.json").write_text("{}")
    with pytest.raises(ConfigError, match=r"results\.jsonl"):
        read_run(tmp_path)
    (tmp_path / "results.jsonl").write_text("[]\n")
    with pytest.raises(ConfigError, match=wording.IS_NOT_A_RUN):
        read_run(tmp_path)


def test_reading_a_run_that_is_being_written_leaves_its_last_line_alone(tmp_path: Path) -> None:
    folder = run_folder(tmp_path / "a", "ab")
    with (folder / "results.jsonl").open("a") as stream:
        stream.write('{"episode_id": "c", "succ')
    before = (folder / "results.jsonl").read_bytes()
    assert list(read_run(folder).results) == ["a", "b"]
    assert (folder / "results.jsonl").read_bytes() == before


def test_a_cell_is_shown_in_percent_and_written_as_a_share(tmp_path: Path) -> None:
    mean = Cell(Estimate(0.5, 0.25, 0.75, 40, 8), percent=True)
    difference = Cell(Estimate(-0.125, -0.25, 0.0, 40, 8), percent=True, difference=True)
    table = ResultTable(
        "t", "A title", ("who", "a|b", "gain"), [("stubborn", [mean, difference]), ("none", ["-", "-"])]
    )
    assert "| who | a\\|b | gain |\n| --- | ---: | ---: |\n" in to_markdown([table])
    assert "| stubborn | 50.0 [25.0, 75.0] | -12.5 [-25.0, +0.0] not significant |" in to_markdown([table])
    assert to_csv([table]).splitlines() == [
        "table,row,column,value,low95,high95,episodes,houses,verdict",
        "t,stubborn,a|b,0.5,0.25,0.75,40,8,",
        "t,stubborn,gain,-0.125,-0.25,0.0,40,8,not significant",
    ]


def test_an_interval_over_one_house_has_an_asterisk_and_a_note() -> None:
    one = Cell(Estimate(0.5, 0.25, 0.75, 40, 1), percent=True)
    page = to_markdown([ResultTable("t", "A title", ("who", "success"), [("a", [one])], ["A note."])])
    assert "50.0 [25.0, 75.0]*" in page
    assert f"\n{ONE_HOUSE_NOTE}\n" in page
    two = Cell(Estimate(0.5, 0.25, 0.75, 40, 2), percent=True)
    assert "*" not in to_markdown([ResultTable("t", "title", ("who", "success"), [("a", [two])])]).replace("**", "")


def test_differing_fields_name_nested_fields_by_dotted_paths() -> None:
    a = {"seed": 0, "config": {"camera": {"width_px": 640, "height_px": 480}, "agent": None, "noise": {"gain": [1, 2]}}}
    b = {"seed": 0, "config": {"camera": {"width_px": 320, "height_px": 480}, "agent": {"x": 1}, "task": {"steps": 9}}}
    assert differing_fields(a, b) == [
        ("config.agent", None, {"x": 1}),
        ("config.camera.width_px", 640, 320),
        ("config.noise.gain", [1, 2], ABSENT),
        ("config.task.steps", ABSENT, 9),
    ]
    assert differing_fields(a, a) == []
    assert differing_fields({"a": {}}, {}) == [("a", {}, ABSENT)]
    assert differing_fields({"a": True}, {"a": 1}) == [("a", True, 1)]


def test_options_that_change_no_result_are_no_difference_between_runs(tmp_path: Path) -> None:
    first, second = run_folder(tmp_path / "a", "ab"), run_folder(tmp_path / "b", "ab")
    config = json.loads((second / "config.json").read_text())
    changes = {"workers": 8, "out": "elsewhere", "video": True, "config": {"robot": {"radius_m": 0.2}}}
    (second / "config.json").write_text(json.dumps(config | changes))
    runs = read_run(first), read_run(second)
    assert run_differences(runs[0].config, runs[1].config) == [("config.robot.radius_m", ABSENT, 0.2)]
    assert differences_table(*runs).rows == [("config.robot.radius_m", ["(absent)", "0.2"])]
    assert differences_table(runs[0], runs[0]).notes == ("The configurations are equal.",)
    to_rich(differences_table(*runs))


def test_a_comparison_names_errors_and_metrics_without_a_value(tmp_path: Path) -> None:
    first = read_run(run_folder(tmp_path / "first", "abc", gt_explored=True, collisions=3))
    broken = {"success": 0.0, "gt_explored": None, "end_reason": "error"}
    a, b, c = first.results.values()
    results = {"a": changed(a, **broken), "b": changed(b, distance_to_goal=None), "c": c}
    notes = compare(first, replace(first, results=results)).notes
    assert any("0 of A, 1 of B" in note for note in notes)
    (fewer,) = (note for note in notes if note.startswith("Differences of fewer"))
    assert "distance to goal, m 1" in fewer
    assert "success" not in fewer


def test_an_object_in_place_of_a_value_is_shown_by_its_number_of_fields(tmp_path: Path) -> None:
    first, second = (read_run(run_folder(tmp_path / name, "ab")) for name in "ab")
    first = replace(first, config={**first.config, "own": None})
    second = replace(second, config={**second.config, "own": {"deep": {"x": 1}, "wide": 2}, "kind": "x"})
    shown = dict(differences_table(first, second).rows)
    assert shown == {"kind": ["(absent)", '"x"'], "own": ["null", "2 fields"]}


def test_many_fields_of_a_part_that_one_run_lacks_are_one_row(tmp_path: Path) -> None:
    first, second = (read_run(run_folder(tmp_path / name, "ab")) for name in "ab")
    both = {"robot": {"radius_m": 0.1}, "agent": {"cell_m": 0.05}}
    of_second = {name: 1 for name in "abcdef"} | {"cell_m": 0.1}
    first = replace(first, config={**first.config, "config": both})
    second = replace(second, config={**second.config, "config": {**both, "agent": of_second}, "few": dict(p=1, q=2)})
    assert dict(differences_table(first, second).rows) == {
        "config.agent: fields of some runs only": ["0 fields", "6 fields"],
        "config.agent.cell_m": ["0.05", "0.1"],
        "few.p": ["(absent)", "1"],
        "few.q": ["(absent)", "2"],
    }


@pytest.mark.parametrize(
    ("gained", "episodes", "words"),
    [
        (0, 40, "success %: no significant difference, "),
        (40, 40, "success %: B is higher, +100.0 "),
        (2, 2, f"success %: no significant difference (fewer than {MIN_PAIRS} pairs), "),
    ],
)
def test_the_verdict_names_success_and_spl_and_whether_they_differ(
    gained: int, episodes: int, words: str, tmp_path: Path
) -> None:
    ids = [chr(ord("A") + i) for i in range(episodes)]
    first, second = (read_run(run_folder(tmp_path / name, "".join(ids), success=0.0, spl=0.0)) for name in "ab")
    changes: dict[str, dict[str, object]] = {
        name: {"house": f"h{i}", "success": float(i < gained), "spl": 0.5 * (i < gained)} for i, name in enumerate(ids)
    }
    of_first = {name: changed(first.results[name], house=of["house"]) for name, of in changes.items()}
    of_second = {name: changed(second.results[name], **of) for name, of in changes.items()}
    first, second = replace(first, results=of_first), replace(second, results=of_second)
    said = verdict(first, second)
    assert said.startswith(f"Verdict over {episodes} episodes. {words}")
    assert "SPL: " in said


def test_the_verdict_over_one_episode_says_so_in_the_singular(tmp_path: Path) -> None:
    first, second = (read_run(run_folder(tmp_path / name, "A")) for name in "ab")
    assert verdict(first, second).startswith("Verdict over 1 episode. ")


def test_replicates_of_an_episode_count_once_in_a_comparison_which_states_their_spread(tmp_path: Path) -> None:
    folders = [run_folder(tmp_path / name, "abcd", spl=0.5) for name in "ab"]
    for folder, outcomes in zip(folders, ("1100", "1011"), strict=True):
        lines = [json.loads(line) for line in (folder / "results.jsonl").read_text().splitlines()]
        own = [line | {"house": f"h_{line['episode_id']}"} for line in lines]
        again = [
            line | {"episode_id": f"{line['episode_id']}~1", "success": float(outcome)}
            for line, outcome in zip(own, outcomes, strict=True)
        ]
        (folder / "results.jsonl").write_text("".join(json.dumps(line) + "\n" for line in own + again))
    first, second = map(read_run, folders)
    table = compare(first, second)
    assert "4 episodes of both runs." in table.notes[0]
    (note,) = (note for note in table.notes if "Chance alone" in note)
    # differences of the replicates: a 0, 0; b 0, -1; c 0, 1; d 0, 1; variances 0, 1/2, 1/2, 1/2, mean 3/8
    assert note == (
        "8 replicates of 4 episodes; each episode counts once. Chance alone gives the difference over one replicate "
        f"of each a standard deviation of {100 * (3 / 8 / 4) ** 0.5:.1f} points of success and 0.000 of SPL."
    )
    assert replicate_note([result for i, result in first.results.items() if "~" not in i]) == ""
    assert f" {100 * (1 / 2 / 4 / 4) ** 0.5:.1f} points of success" in replicate_note(list(second.results.values()))
    cells = dict(table.rows)["success %"]
    assert [cell.estimate.count for cell in cells if isinstance(cell, Cell)] == [4, 4, 4]
    assert verdict(first, second).startswith("Verdict over 4 episodes.")
