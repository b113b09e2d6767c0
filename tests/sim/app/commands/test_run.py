"""`python -m sim.run` as a user runs it: results, resuming, workers, one clear line for an invalid option."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import cv2
import numpy as np
import pytest

from sim.app.commands.run import entry, first_failure
from sim.app.evaluation.last_view import picture_file
from sim.core.geometry.pose import Pose
from sim.core.paths import code_hash
from sim.core.reading import sha256_of
from sim.episodes.episode import Episode
from sim.episodes.splits import write_split
from sim.task.failures import cause_of_failure
from sim.task.metrics import EXPLORED_SHARE
from sim.task.result import METRICS
from sim.task.trajectory import read_trajectory, trajectory_file
from stubborn.segmentation.shipped import SHIPPED_REDNET
from tests.helpers.results import a_result, lines_of
from tests.helpers.worlds import two_storeys

SMALL = ("camera.width_px=160", "camera.height_px=120")


def words_of(*options: object) -> list[str]:
    """Uses ground truth and small images unless the options say otherwise: a network would take most of the time."""
    semantics = () if "--semantics" in options else ("--semantics", "gt")
    words = list(map(str, (*options, *semantics)))
    if "--config" in words:
        words[words.index("--config") + 1 : words.index("--config") + 1] = SMALL
    else:
        words += ["--config", *SMALL]
    return words


def run(*options: object) -> int:
    """Runs the command in this process and returns its exit status."""
    return entry(words_of(*options))


@pytest.mark.costly
def test_results_are_the_same_in_one_process_and_in_two_workers(
    house: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name, workers in (("once", 1), ("shared", 2)):
        options = ("--house", house, "--episodes", 3, "--workers", workers, "--config", "task.max_steps=40")
        assert run(*options, "--out", tmp_path / name) == 0
        assert "95 % interval" in capsys.readouterr().out
    assert len(lines_of(tmp_path / "once")) == 3
    assert lines_of(tmp_path / "once") == lines_of(tmp_path / "shared")


@pytest.mark.slow
def test_another_seed_draws_other_starts(house: Path, tmp_path: Path) -> None:
    for seed in (0, 1):
        run("--agent", "oracle", "--house", house, "--episodes", 2, "--seed", seed, "--out", tmp_path / str(seed))
    assert [line["shortest_path"] for line in lines_of(tmp_path / "0")] != [
        line["shortest_path"] for line in lines_of(tmp_path / "1")
    ]


@pytest.mark.costly
def test_a_line_and_the_summary_have_the_fields_of_the_contract(house: Path, tmp_path: Path) -> None:
    run("--agent", "oracle", "--house", house, "--episodes", 2, "--out", tmp_path)
    (line, _), summary = lines_of(tmp_path), json.loads((tmp_path / "summary.json").read_text())
    names = (
        "episode_id house goal agent semantics seed success spl soft_spl distance_to_goal num_steps path_length "
        "shortest_path collisions gt_explored first_seen_step steps_to_first_sight area_seen_m2 area_per_metre trapped "
        "failure end_reason"
    )
    assert set(names.split()) <= set(line)
    assert summary["episodes"] == 2
    for metric in (key for key, metric in METRICS.items() if metric.in_summary and not metric.chains):
        low, high = summary[metric]["ci95"]
        assert low is None or low <= summary[metric]["mean"] <= high
    config = json.loads((tmp_path / "config.json").read_text())
    assert config["agent"] == "oracle"
    assert {"mujoco", "numpy", "gl_renderer"} <= set(config["versions"])


@pytest.mark.costly
def test_a_killed_run_resumes_without_lost_or_doubled_lines(house: Path, tmp_path: Path) -> None:
    options = ("--agent", "oracle", "--house", house, "--episodes", 6)
    results = tmp_path / "killed" / "results.jsonl"
    process = subprocess.Popen(
        [sys.executable, "-m", "sim.run", *words_of(*options, "--out", tmp_path / "killed")], stdout=subprocess.DEVNULL
    )
    deadline_s = time.monotonic() + 60
    while not (results.exists() and results.read_text().count("\n") >= 1):
        assert time.monotonic() < deadline_s, "no result in a minute"
        assert process.poll() is None, "it ended before it could be killed"
        time.sleep(0.02)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    before = results.read_text().count("\n")
    assert before < 6
    assert run(*options, "--out", tmp_path / "killed") == 0
    assert run(*options, "--out", tmp_path / "whole") == 0
    assert lines_of(tmp_path / "killed") == lines_of(tmp_path / "whole")


@pytest.mark.costly
def test_recorded_episodes_leave_their_trajectory_and_the_same_lines(house: Path, tmp_path: Path) -> None:
    options = ("--agent", "random", "--house", house, "--seed-key", "k", "--config", "task.max_steps=60")
    run(*options, "--episodes", 2, "--out", tmp_path / "plain")
    assert not any((tmp_path / "plain" / name).exists() for name in ("trajectories", "pictures"))
    run(*options, "--episodes", 1, "--out", tmp_path / "recorded", "--record")
    assert run(*options, "--episodes", 2, "--workers", 2, "--out", tmp_path / "recorded", "--record") == 0
    assert lines_of(tmp_path / "plain") == lines_of(tmp_path / "recorded")
    for line in lines_of(tmp_path / "plain"):
        trajectory = read_trajectory(trajectory_file(tmp_path / "recorded", line["episode_id"]))
        assert trajectory.about is not None
        assert trajectory.about.scores.as_json() == line
        picture = cv2.imread(str(picture_file(tmp_path / "recorded", line["episode_id"])))
        assert picture is not None
        assert picture.shape == (120, 160, 3)
        assert trajectory.num_steps == line["num_steps"]
        assert trajectory.moved_m.sum() == pytest.approx(line["path_length"], abs=1e-4)
        assert int(trajectory.collided.sum()) == line["collisions"]
        assert bool((trajectory.goal_share >= EXPLORED_SHARE).any()) == line["gt_explored"]
        seen = np.flatnonzero(trajectory.goal_share >= EXPLORED_SHARE).tolist()
        assert (seen or [None])[0] == line["first_seen_step"]
        assert cause_of_failure(trajectory) == line["failure"]
        assert (line["failure"] is None) == (line["success"] == 1.0)


@pytest.mark.costly
def test_an_episode_whose_goal_is_upstairs_runs_and_fails_by_stairs(tmp_path: Path) -> None:
    folder = tmp_path / "tiny"
    folder.mkdir()
    (folder / "duplex.xml").write_text(two_storeys().spec.to_xml())
    below, above = Pose(-2.0, 0.5, 1.0), Pose(-2.0, 0.5, 1.0, floor_z_m=3.0)
    asked = [("bed", below), ("sofa", below), ("bed", above), ("sofa", above)]
    episodes = [Episode(f"e{i}", "duplex", goal, start) for i, (goal, start) in enumerate(asked)]
    write_split(folder, episodes, {"duplex": {}}, version="1")
    assert run("--agent", "oracle", "--split", folder, "--episodes", 4, "--out", tmp_path / "out") == 0
    lines = lines_of(tmp_path / "out")
    assert [line["failure"] for line in lines] == [None, "stairs", "stairs", None]
    assert [line["success"] for line in lines] == [1.0, 0.0, 0.0, 1.0]
    assert [line["shortest_path"] is None for line in lines] == [False, True, True, False]
    assert [line["gt_explored"] for line in lines] == [True, False, False, True]


@pytest.mark.costly
def test_the_shipped_network_is_used_unless_another_segmentation_is_requested(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert entry(["--goal", "bed", "--episodes", "1", "--out", str(tmp_path)]) == 0
    named = f"rednet, shipped weights ({sha256_of(SHIPPED_REDNET, what='Weights')[:8]})"
    printed = " ".join(capsys.readouterr().out.split())
    assert f"segmentation: {named}; results in" in printed
    assert f"Segmentation: {named}. Intervals are over" in printed
    assert json.loads((tmp_path / "summary.json").read_text())["segmentation"] == named
    (line,) = lines_of(tmp_path)
    assert (line["agent"], line["semantics"]) == ("stubborn", "rednet")
    assert "weights" in json.loads((tmp_path / "config.json").read_text())["files_sha256"]


BROKEN_HOUSES = {
    "not_xml.xml": "not a house",
    "no_floor.xml": '<mujoco><worldbody><geom name="wall_00" type="box" size="1 1 1"/></worldbody></mujoco>',
    "unlabelled.xml": (
        '<mujoco><worldbody><geom name="floor_00" type="plane" size="3 3 1"/>'
        '<geom name="thing" type="box" size="1 1 1"/></worldbody></mujoco>'
    ),
}


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--agent", "stuborn"), "stuborn"),
        (("--agent", "nowhere.at_all:make"), "nowhere"),
        (("--split", "vall"), "vall"),
        (("--goal", "spaceship"), "spaceship"),
        (("--semantics", "psychic"), "psychic"),
        (("--profile", "best"), "best"),
        (("--noise", "loud"), "realsense"),
        (("--house", "HOUSE", "--goal", "toilet"), "toilet"),
        (("--house", "HOUSE", "--start-deg", "2.9 2.9 0"), "wall"),
        (("--house", "HOUSE", "--start-deg", "here"), "here"),
        (("--labels", "rules.json"), "--labels needs --house"),
        (("--house", "nowhere.xml"), "nowhere.xml"),
        (("--house", "not_xml.xml"), "not_xml.xml"),
        (("--house", "no_floor.xml"), "floor"),
        (("--house", "unlabelled.xml"), "thing"),
        (("--house", "HOUSE", "--out", "/proc/nowhere"), "--out"),
    ],
)
def test_a_wrong_option_is_one_line_and_status_2(
    options: tuple[str, ...],
    message: str,
    house: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    for name, content in BROKEN_HOUSES.items():
        (tmp_path / name).write_text(content)
    monkeypatch.chdir(tmp_path)
    assert entry([str(house) if option == "HOUSE" else option for option in options]) == 2
    printed = capsys.readouterr().err
    assert printed.startswith("error: ")
    assert printed.count("\n") == 1
    assert message in printed


@pytest.mark.costly
def test_a_run_resumed_by_other_code_says_so_and_names_both(
    house: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def run_quitter(episodes: int) -> tuple[str, list[str]]:
        options = ["--agent", "tests.helpers.runners:make_quitter", "--house", str(house), "--out", str(tmp_path)]
        options += ["--step-timeout", "0"]
        assert entry([*options, "--episodes", str(episodes)]) == 0
        return capsys.readouterr().out, json.loads((tmp_path / "config.json").read_text())["codes"]

    out, (code,) = run_quitter(1)
    assert "by other code" not in out
    assert re.fullmatch(rf"{code_hash()}\+[0-9a-f]{{12}}", code)  # "+" and the user's own
    config = json.loads((tmp_path / "config.json").read_text())
    (tmp_path / "config.json").write_text(json.dumps(config | {"codes": ["0lder"]}))
    out, codes = run_quitter(1)
    assert "by other code" not in out  # no episode was run
    assert codes == ["0lder"]
    out, codes = run_quitter(2)
    assert [line for line in out.splitlines() if "0lder" in line] == [
        f"The existing episodes were run by other code (0lder) than these ({code})."
    ]
    assert codes == ["0lder", code]


@pytest.mark.costly
def test_after_an_edit_of_the_agent_no_old_result_is_shown_unless_the_user_keeps_it(
    house: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.syspath_prepend(tmp_path)
    mine = tmp_path / "edited_agent.py"
    mine.write_text("from tests.helpers.runners import make_quitter as make\n")
    options = ["--agent", "edited_agent:make", "--house", str(house), "--out", str(tmp_path / "run")]
    options += ["--step-timeout", "0"]
    assert entry([*options, "--episodes", "1"]) == 0
    mine.write_text(mine.read_text() + "GAIN = 2\n")
    capsys.readouterr()
    assert entry([*options, "--episodes", "1"]) == 2  # also where no episode is left
    printed = capsys.readouterr()
    assert "Episodes" not in printed.out
    assert re.search(r"\(edited_agent:make\) has changed .*give another --out; .*--keep-results", printed.err)
    assert entry([*options, "--episodes", "2", "--keep-results"]) == 0
    (notice,) = re.findall(r"run by other code \((\S+)\) than these \((\S+)\)", capsys.readouterr().out)
    assert notice[0] != notice[1]


@pytest.mark.costly
def test_a_key_repeats_a_run_and_a_resumed_run_and_its_shards_keep_theirs(house: Path, tmp_path: Path) -> None:
    options = ["--agent", "random", "--house", str(house), "--config", "task.max_steps=12", "--episodes", "2"]

    def run_with(out: str, *more: str) -> tuple[str, list[dict]]:
        assert entry([*options, "--out", str(tmp_path / out), *more]) == 0
        folder = next((tmp_path / out).rglob("config.json")).parent
        return json.loads((folder / "config.json").read_text())["seed_key"], lines_of(folder)

    key, lines = run_with("drawn")
    other_key, other_lines = run_with("other", "--episodes", "1")
    assert key != other_key
    assert run_with("given", "--seed-key", key) == (key, lines)
    assert run_with("other", "--episodes", "2")[0] == other_key
    assert run_with("other", "--episodes", "2")[1][0] == other_lines[0]
    assert entry([*options, "--out", str(tmp_path / "other"), "--seed-key", key]) == 2
    shards = [run_with("whole", "--shard", f"{i}/2")[0] for i in (1, 2)]
    assert shards[0] == shards[1] == (tmp_path / "whole" / "seed_key").read_text()
    assert (tmp_path / "whole" / "shard_2_of_2" / "results.jsonl").exists()


def test_shards_that_are_numbered_from_0_are_not_mixed_with_others(
    house: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "shard_0_of_2").mkdir()
    options = ["--agent", "random", "--house", str(house), "--episodes", "2", "--out", str(tmp_path)]
    assert entry([*options, "--shard", "1/2"]) == 2
    assert "shards of version 0.1" in capsys.readouterr().err


def test_a_relative_folder_stays_where_it_was_when_the_agent_changes_the_current_one(
    house: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "away_agent.py").write_text(
        "import os\nfrom tests.helpers.runners import Quitter\nos.chdir('/')\n\n"
        "class Away(Quitter):\n    def reset(self, goal, seed):\n        os.chdir('/')\n\n"
        "def make(**options):\n    os.chdir('/')\n    return Away()\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.chdir(tmp_path)
    options = ["--agent", "away_agent:make", "--house", os.path.relpath(house), "--out", "run", "--record"]
    assert entry([*options, "--episodes", "1", "--step-timeout", "0"]) == 0
    assert {file.name for file in (tmp_path / "run").iterdir()} >= {"summary.json", "trajectories", "pictures"}


def test_a_house_that_is_replaced_while_a_run_is_planned_is_noticed(
    house: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "room.xml"
    file.write_text(house.read_text())
    (tmp_path / "replacing_agent.py").write_text(
        "from pathlib import Path\nfrom tests.helpers.runners import make_quitter\n\n"
        f"def make(**options):\n    file = Path({str(file)!r})\n"
        "    file.write_text(file.read_text().replace('</mujoco>', '<!-- --></mujoco>'))\n"
        "    return make_quitter()\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    options = ["--agent", "replacing_agent:make", "--house", str(file), "--out", str(tmp_path / "run")]
    assert entry([*options, "--episodes", "1", "--step-timeout", "0"]) == 1
    assert "its files have changed since this run was planned" in capsys.readouterr().out


@pytest.mark.costly
def test_an_agent_that_kills_its_process_costs_no_line_and_is_not_run_again_without_a_request(
    house: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    marker = tmp_path / "died"
    (tmp_path / "dying_agent.py").write_text(
        "import os\nfrom tests.helpers.runners import Quitter\n\n"
        f"class Dying(Quitter):\n    def act(self, observation):\n        open({str(marker)!r}, 'a').write('x')\n"
        "        os._exit(0)\n\ndef make(**options):\n    return Dying()\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path), prepend=os.pathsep)
    options = ["--agent", "dying_agent:make", "--house", str(house), "--out", str(tmp_path / "run"), "--episodes", "1"]
    assert entry(options) == 1
    (line,) = lines_of(tmp_path / "run")
    assert line["end_reason"] == "error"
    assert "dying_agent:make', step 1: its process ended with status 0" in line["error"]
    assert entry(options) == 1
    assert marker.read_text() == "xx"  # two tries, once


def test_the_split_for_last_measurements_is_announced_in_one_line_on_stderr(capsys: pytest.CaptureFixture[str]) -> None:
    for split, lines in (("test", 2), ("val", 1)):
        assert entry(["--split", split, "--episodes", "100000"]) == 2
        captured = capsys.readouterr()
        assert ("last measurement" in captured.err) == (split == "test")
        assert len(captured.err.strip().splitlines()) == lines
        assert captured.out == ""


def test_a_list_of_the_agents_brings_neither_mujoco_nor_pytorch_nor_numba_nor_video() -> None:
    """They take more than half of the time of a start."""
    code = "import sys; from sim.app.commands.run import entry; entry(['--list-agents']); print(sorted(sys.modules))"
    output = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert {"stubborn", "stubborn-i", "stubborn-v", "stubborn-plus", "oracle", "random"} <= set(output.split())
    assert "sim.app.composition.agents" in output
    for package in ("'mujoco'", "'torch'", "'numba'", "'av'", "'OpenGL'"):
        assert package not in output


def test_only_the_named_episodes_of_a_split_are_run_and_others_can_follow(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    options = ["--split", "traps", "--agent", "random", "--config", "task.max_steps=2", "--out", str(tmp_path / "run")]
    assert entry([*options, "--only", "narrow_gap_1", "chair_legs_2"]) == 0
    assert [line["episode_id"] for line in lines_of(tmp_path / "run")] == ["chair_legs_2", "narrow_gap_1"]
    assert "the same command with --only chair_legs_2 --video" in capsys.readouterr().out
    assert entry([*options, "--only", "narrow_gap_1", "low_slab_0"]) == 0
    assert len(lines_of(tmp_path / "run")) == 3
    assert entry([*options, "--only", "narow_gap_1"]) == 2
    message = "error: --only 'narow_gap_1': split 'traps' has no such episode. Did you mean 'narrow_gap_1'?"
    assert capsys.readouterr().err.strip() == message
    assert entry(["--house", "examples/my_house.xml", "--only", "narrow_gap_1"]) == 2
    assert "--only names episodes of a split" in capsys.readouterr().err


def test_a_goal_that_the_split_does_not_have_is_answered_with_those_it_has(capsys: pytest.CaptureFixture[str]) -> None:
    assert entry(["--goal", "toilett"]) == 2
    message = capsys.readouterr().err
    assert "--goal 'toilett'" in message
    assert "Did you mean 'toilet'? It has: chair, table," in message
    assert "--episodes" not in message
    assert entry(["--goal", "couch"]) == 2
    assert "Did you mean 'sofa'?" in capsys.readouterr().err
    assert entry(["--goal", "toilet", "--episodes", "9999"]) == 2
    message = capsys.readouterr().err
    assert re.search(r"Split 'val' has \d+ episodes with goal 'toilet', and 9999 were asked for", message)


def test_a_shard_without_episodes_says_so_and_leaves_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    options = ["--agent", "random", "--split", "traps", "--episodes", "2", "--shard", "3/3", "--out", str(tmp_path)]
    assert entry(options) == 0
    assert "Shard 3/3 holds none of the 2 episodes." in capsys.readouterr().out
    assert list(tmp_path.iterdir()) == []


def test_errors_are_run_again_in_the_folder_of_their_run(capsys: pytest.CaptureFixture[str]) -> None:
    assert entry(["--retry-errors"]) == 2
    assert "--retry-errors needs --out" in capsys.readouterr().err


def test_the_failure_to_film_is_not_an_episode_that_an_error_ended() -> None:
    found = a_result(episode_id="a")
    broken = a_result(episode_id="b", success=0.0, end_reason="error", error="KeyError")
    missed = a_result(episode_id="c", success=0.0, end_reason="max_steps")
    assert first_failure([found, broken, missed]) == "c"
    assert first_failure([found, broken]) is None
