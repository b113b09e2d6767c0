"""Tables from one command: runs are shared between tables, run in turns, and resumed."""

from __future__ import annotations

import json
import re
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from sim.app.analysis.comparison import read_run
from sim.app.commands import compare as compare_runs
from sim.app.commands import run
from sim.app.commands.reproduce import reproduce
from sim.app.commands.reproduce import runs as table_runs
from sim.app.commands.reproduce.paper_figures import FIGURES, beside_paper
from sim.app.commands.reproduce.paper_tables import PAPER_TABLES, TABLES, table_named
from sim.app.commands.reproduce.runs import AgentSetup
from sim.core.geometry.pose import Pose
from sim.core.interface import ConfigError
from sim.episodes.episode import Episode
from sim.episodes.splits import write_split
from sim.task.result import EpisodeResult
from sim.task.trajectory import FOLDER
from tests.helpers import wording
from tests.helpers.worlds import room, with_box

AGENTS = ("oracle", "examples.my_agent:make")
MINE = "examples.my_agent_make_gt_none_tiny"
ORACLE = "oracle_gt_none_tiny"


@pytest.fixture(scope="module")
def split(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Returns arguments for four episodes in a room with a sofa and a bed."""
    folder = tmp_path_factory.mktemp("splits") / "tiny"
    folder.mkdir()
    house = with_box(room(6, 6), "sofa_00", centre_m=(2.5, 0, 0.4), half_m=(0.4, 0.8, 0.4))
    house = with_box(house, "bed_00", centre_m=(-2.4, 0, 0.25), half_m=(0.5, 1.0, 0.25))
    (folder / "room.xml").write_text(house.spec.to_xml())
    episodes = [Episode(f"e{i}", "room", ("sofa", "bed")[i % 2], Pose(0.2 * i - 0.3, 1.9, 0.0)) for i in range(4)]
    write_split(folder, episodes, {"room": {}}, version="1")
    return folder


def args_for(split: Path, out: Path) -> reproduce.Args:
    """Returns the arguments of a table of two agents in two episodes."""
    return reproduce.Args(
        table="categories",
        split=str(split),
        episodes=2,
        agents=AGENTS,
        semantics="gt",
        out=out,
        chunk=1,
        step_timeout=0.0,  # the user's agent runs in this process, which is quicker
    )


@pytest.fixture
def args(split: Path, tmp_path: Path) -> reproduce.Args:
    """Arguments with an empty folder."""
    return args_for(split, tmp_path)


@pytest.fixture(scope="module")
def finished(split: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a finished table."""
    out = tmp_path_factory.mktemp("finished")
    assert reproduce.main(args_for(split, out)) == 0
    return out


@pytest.fixture
def ran(finished: Path, split: Path, tmp_path: Path) -> reproduce.Args:
    """Arguments with a copy of the folder of a finished table."""
    shutil.copytree(finished, tmp_path / "ran")
    return args_for(split, tmp_path / "ran")


def stem(args: reproduce.Args) -> str:
    """Returns the stem of the file names of the requested table."""
    return reproduce.stem_of(args, args.table)


def test_the_agents_of_a_table_run_once_and_the_table_is_written(
    args: reproduce.Args, capsys: pytest.CaptureFixture[str]
) -> None:
    assert reproduce.main(args) == 0
    output = capsys.readouterr().out
    # The agents take turns.
    assert [part.split(" ")[0] for part in output.split("] e")[1:]] == ["0:", "0:", "1:", "1:"]
    page = (args.out / "tables" / f"{stem(args)}.md").read_text()
    assert "| goal (episodes) | oracle | examples.my_agent:make | oracle - examples.my_agent:make |" in page
    assert "| all (2) | 100.0" in page
    assert "2 episodes in 1 house of tiny 1" in page
    assert (args.out / "tables" / f"{stem(args)}.csv").is_file()
    assert len(list((args.out / ORACLE / FOLDER).glob("*.npz"))) == 2
    before = (args.out / MINE / "results.jsonl").read_bytes()
    assert reproduce.main(args) == 0
    assert (args.out / MINE / "results.jsonl").read_bytes() == before
    assert "] e" not in capsys.readouterr().out


def test_another_table_reuses_existing_episodes_and_runs_the_rest(
    ran: reproduce.Args, capsys: pytest.CaptureFixture[str]
) -> None:
    assert reproduce.main(replace(ran, table="overall", episodes=3)) == 0
    assert capsys.readouterr().out.count("] e2:") == 2
    assert list(read_run(ran.out / ORACLE).results) == ["e0", "e1", "e2"]
    assert json.loads((ran.out / ORACLE / "config.json").read_text())["episodes"] == 3


@pytest.mark.costly
def test_a_run_of_sim_run_and_a_run_for_a_table_have_the_same_lines(ran: reproduce.Args, split: Path) -> None:
    alone = ran.out / "alone"
    options = ["--agent", AGENTS[1], "--semantics", "gt", "--split", str(split), "--episodes", "2", "--out", str(alone)]
    options += ["--step-timeout", "0", "--seed-key", read_run(ran.out / MINE).recorded("seed_key")]
    assert run.entry(options) == 0
    first, second = (
        [result.without_times() for result in read_run(folder).results.values()] for folder in (ran.out / MINE, alone)
    )
    assert first == second


@pytest.mark.costly
def test_after_the_time_limit_the_table_has_the_episodes_that_all_agents_ran(
    args: reproduce.Args, capsys: pytest.CaptureFixture[str]
) -> None:
    assert reproduce.main(replace(args, minutes=0.0)) == 1
    assert "no episode that oracle, examples.my_agent:make (gt) have all run" in capsys.readouterr().out
    assert reproduce.main(replace(args, minutes=1e-3)) == 0  # the first chunk is always run
    assert list(read_run(args.out / MINE).results) == ["e0"]
    run.main(reproduce._run_args(args, AgentSetup.named("oracle", "gt")))  # the oracle is one ahead
    capsys.readouterr()
    assert reproduce.main(replace(args, minutes=0.0)) == 0
    assert "all (1)" in capsys.readouterr().out


def test_causes_come_from_the_trajectories_and_not_from_old_lines(args: reproduce.Args) -> None:
    failing = replace(args, table="failures", agents=("tests.helpers.runners:make_quitter", "oracle"), episodes=1)
    reproduce.main(failing)
    results = next(args.out.glob("tests.helpers*")) / "results.jsonl"
    line = json.loads(results.read_text())
    assert line["failure"] == "false_detection"
    results.write_text(json.dumps(line | {"failure": None}) + "\n")
    reproduce.main(replace(failing, minutes=0.0))
    assert "| false_detection | 100.0 |" in (args.out / "tables" / f"{stem(failing)}.md").read_text()


@pytest.mark.parametrize(
    ("key", "value", "text"),
    [
        ("seed", 1, "of examples.my_agent:make --seed 1 "),
        ("noise", "harsh", "of examples.my_agent:make --noise harsh "),
        ("semantics", "noisy", "of examples.my_agent:make --semantics noisy "),
        ("agent", "random", "of random "),
        ("weights", "/their/mine.safetensors", "of examples.my_agent:make --weights mine.safetensors "),
        ("profile", "good", "with profile = "),
        ("split_identity", {"name": "tiny", "version": "1", "sha256": "0"}, r"of .* on tiny 1 \(0\)"),
    ],
)
def test_a_run_with_other_options_gets_into_no_table(ran: reproduce.Args, key: str, value: object, text: str) -> None:
    reproduce.main(replace(ran, episodes=1))
    file = ran.out / MINE / "config.json"
    file.write_text(json.dumps(json.loads(file.read_text()) | {key: value}))
    before = (ran.out / "tables" / f"{stem(ran)}.md").read_bytes()
    with pytest.raises(ConfigError, match=rf"{MINE}' holds a run {text}"):
        reproduce.main(replace(ran, episodes=1, minutes=0.0))
    assert (ran.out / "tables" / f"{stem(ran)}.md").read_bytes() == before


@pytest.mark.parametrize(("settings", "refused"), [({}, True), ({"detector.weights": "mine"}, False)])
def test_two_versions_of_the_shipped_network_get_into_no_table(
    ran: reproduce.Args, settings: dict[str, str], refused: bool
) -> None:
    runs = [read_run(ran.out / name) for name in (ORACLE, MINE)]
    runs = [
        replace(run, config={**run.config, "files_sha256": {"weights": checksum}, "settings": settings})
        for run, checksum in zip(runs, ("a", "b"), strict=True)
    ]
    if not refused:
        reproduce.require_same_conditions(runs)
        return
    without = replace(runs[0], config={**runs[0].config, "files_sha256": {}})
    with pytest.raises(ConfigError, match=wording.TWO_VERSIONS_OF_THE_SHIPPED_NETWORK):
        reproduce.require_same_conditions([without, *runs])


def test_tables_are_made_again_from_the_folders_without_running_anything(
    ran: reproduce.Args, monkeypatch: pytest.MonkeyPatch
) -> None:
    page = ran.out / "tables" / f"{stem(ran)}.md"
    before = page.read_bytes()
    for folder in (MINE, ORACLE):  # as older code wrote it
        file = ran.out / folder / "config.json"
        config = json.loads(file.read_text())
        kept = ("agent", "semantics", "seed", "noise", "episodes", "split_identity", "versions")
        file.write_text(json.dumps({key: config[key] for key in kept}))
    page.unlink()
    monkeypatch.setattr(table_runs, "run_missing", lambda *_: pytest.fail("an episode was run"))
    assert reproduce.main(replace(ran, minutes=0.0)) == 0
    assert page.read_bytes() == before


@pytest.mark.slow
def test_runs_of_one_agent_with_other_options_have_folders_of_their_own(args: reproduce.Args) -> None:
    bold = "examples.my_agent:AGENT --config agent.keep_m=0.8"
    agents = replace(args, agents=("oracle", "examples.my_agent:AGENT", bold))
    assert reproduce.main(agents) == 0
    written = args.out / "examples.my_agent_AGENT_gt_none_tiny_config-agent.keep_m=0.8"
    assert read_run(written).config["settings"] == {"agent.keep_m": 0.8}
    page = (args.out / "tables" / f"{stem(agents)}.md").read_text()
    assert f"| {bold} |" in page
    (args.out / "examples.my_agent_AGENT_gt_none_tiny").rename(args.out / "other")
    written.rename(args.out / "examples.my_agent_AGENT_gt_none_tiny")
    (args.out / "other").rename(written)
    with pytest.raises(ConfigError, match=wording.HOLDS_A_RUN_OF):
        reproduce.main(replace(agents, minutes=0.0))


def test_many_options_get_a_checksum_in_the_name_of_the_folder(
    args: reproduce.Args, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(table_runs, "MAX_NAME", 10)
    options = "examples.my_agent:AGENT --config agent.keep_m=0.8"
    assert reproduce.main(replace(args, episodes=1, agents=("oracle", options))) == 0
    assert list(args.out.glob("examples.my_agent_AGENT_gt_none_tiny_options-????????/results.jsonl"))


def test_the_notes_agree_with_the_runs(ran: reproduce.Args) -> None:
    setup, other = AgentSetup.named("oracle", "gt"), replace(ran, seed=7, noise="harsh")
    note = reproduce.notes_of(other, "overall", {setup: read_run(ran.out / ORACLE)}, ["e0"])[0]
    assert "sensor noise none, seed 0," in note


def test_the_notes_of_a_run_of_older_code_have_its_defaults(ran: reproduce.Args) -> None:
    run = read_run(ran.out / ORACLE)
    older: Any = {name: value for name, value in run.config.items() if name not in ("noise", "seed", "versions")}
    note = reproduce.notes_of(ran, "overall", {AgentSetup.named("oracle", "gt"): replace(run, config=older)}, ["e0"])[0]
    assert note.endswith("sensor noise none, seed 0, mujoco unknown.")


def test_each_option_that_makes_another_table_has_its_place_in_the_name(split: Path, tmp_path: Path) -> None:
    plain = reproduce.Args(table="overall", out=tmp_path)
    others = [
        replace(plain, **change)
        for change in (
            {"table": "failures"},
            {"semantics": "gt"},
            {"agents": AGENTS},
            {"agents": AGENTS[:1]},
            {"noise": "harsh"},
            {"split": "test"},
            {"split": str(split)},
            {"seed": 1},
            {"semantics": "gt", "agents": AGENTS, "noise": "harsh", "split": "test", "seed": 1},
        )
    ]
    assert stem(plain) == "overall"
    assert stem(others[-1]) == "overall_gt_oracle+examples.my_agent_make_harsh_test_seed1"
    assert len({stem(args) for args in (plain, *others)}) == 1 + len(others)
    assert all("/" not in stem(args) for args in others)
    for args in (replace(plain, episodes=7), replace(plain, workers=2), replace(plain, minutes=0.0)):
        assert stem(args) == "overall"  # the same table, of more or fewer episodes


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"table": "everything"}, "'everything'"),
        ({"agents": ("stuborn",)}, "stuborn"),
        ({"semantics": "psychic", "agents": ("stubborn",)}, "psychic"),
        ({"episodes": 5}, "has 4 episodes"),
    ],
)
def test_options_that_cannot_run_are_refused_before_the_first_episode(
    args: reproduce.Args, change: dict, message: str
) -> None:
    with pytest.raises(ConfigError, match=message):
        reproduce.main(replace(args, **change))
    assert not list(args.out.iterdir())


def test_two_folders_of_runs_are_compared_pair_by_pair(ran: reproduce.Args, capsys: pytest.CaptureFixture[str]) -> None:
    folders = compare_runs.Args(first=ran.out / MINE, second=ran.out / ORACLE, out=ran.out / "compared")
    assert compare_runs.main(folders) == 0
    output = capsys.readouterr().out
    assert "B - A, paired over 2 episodes" in output
    assert "Fields in which the runs differ" in output
    assert output.strip().splitlines()[-1].startswith("Verdict over 2 episodes.")
    page = (ran.out / "compared" / "comparison.md").read_text()
    assert "| success % |" in page
    assert f'| agent | "{AGENTS[1]}" | "oracle" |' in page


@pytest.mark.slow
def test_several_splits_take_turns_and_share_a_page(
    args: reproduce.Args, split: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    other = tmp_path / "small"
    shutil.copytree(split, other)
    (other / "tiny.json.gz").rename(other / "small.json.gz")
    both = replace(args, table="splits", splits=(str(split), str(other)))
    assert reproduce.main(both) == 0
    output = capsys.readouterr().out
    order = re.findall(r"(oracle|make_agent|my_agent:make)[^\n]* episodes? of (tiny|small)", output)
    assert order == [(agent, of) for _ in range(2) for of in ("tiny", "small") for agent in ("oracle", "my_agent:make")]
    names = {file.name for file in (args.out / "tables").glob("splits_*.md")}
    agents = "gt_oracle+examples.my_agent_make"
    assert names == {f"splits_{agents}_{of}.md" for of in ("tiny", "small", "tiny+small")}
    page = (args.out / "tables" / f"splits_{agents}_tiny+small.md").read_text()
    assert page.index("## tiny") < page.index("## small")
    assert page.count("| steps to first sight | never seen % | area per metre, m2/m |") == 4
    assert "| examples.my_agent:make (gt) - oracle |" in page
    before = [file.read_bytes() for file in sorted(args.out.glob("*/results.jsonl"))]
    assert reproduce.main(both) == 0
    assert [file.read_bytes() for file in sorted(args.out.glob("*/results.jsonl"))] == before


@pytest.fixture(scope="module")
def lines(split: Path, tmp_path_factory: pytest.TempPathFactory) -> list[EpisodeResult]:
    """Returns the result lines of an agent, the goals in turns a sofa and a bed."""
    args = reproduce.Args(
        table="overall", split=str(split), agents=("oracle",), episodes=4, out=tmp_path_factory.mktemp("p")
    )
    reproduce.main(args)
    return list(read_run(args.out / ORACLE).results.values())


@pytest.mark.parametrize("name", [*PAPER_TABLES, "splits"])
def test_the_papers_figures_stand_beside_the_rows_of_the_same_name(name: str, lines: list[EpisodeResult]) -> None:
    table = table_named(name)
    setups = table.setups()
    first = table.build(dict.fromkeys(setups, lines), setups)[0]
    beside = beside_paper(name, first)
    columns = FIGURES.get(name, {})
    assert beside.header == (*first.header, *(f"paper: {title}" for title in columns))
    assert all(len(cells) == len(beside.header) - 1 for _, cells in beside.rows)
    shown = {label: dict(zip(beside.header[1:], cells, strict=True)) for label, cells in beside.rows}
    for title, column in columns.items():
        for row, text in column.items():
            matching = [
                cells
                for label, cells in shown.items()
                if re.fullmatch(rf"{re.escape(row)}( \(.*\)| stubborn.*)?", label)
            ]
            expected = 0 if name in ("categories", "exploration") and row not in ("sofa", "bed", "all") else 1
            assert [cells[f"paper: {title}"] for cells in matching] == [text] * expected, (title, row)


def test_all_tables_of_the_paper_get_a_page(
    args: reproduce.Args, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(reproduce, "PAPER_TABLES", ("overall", "categories"))
    everything = replace(args, table="all", episodes=1)
    assert reproduce.main(everything) == 0
    page = (args.out / "tables" / f"{stem(everything)}.md").read_text()
    assert page.index("**All agents**") < page.index("**Success, %, gt segmentation**")
    assert "2 tables on" in capsys.readouterr().out


def test_the_paper_is_beside_its_own_agents_only(
    ran: reproduce.Args, monkeypatch: pytest.MonkeyPatch, lines: list[EpisodeResult]
) -> None:
    monkeypatch.setitem(TABLES, "categories", replace(TABLES["categories"], agents=AGENTS[:1]))
    reproduce.main(replace(ran, agents=()))
    page = (ran.out / "tables" / "categories_gt_tiny.md").read_text()
    assert "| goal (episodes) | oracle | paper: Stubborn | paper: Single-Frame |" in page
    assert re.search(r"\| bed \(1\) \| [^|]* \| 51 \| 44 \|", page)
    reproduce.main(ran)
    assert "paper" not in (ran.out / "tables" / f"{stem(ran)}.md").read_text()


def test_an_agent_of_a_table_can_have_a_segmentation_of_its_own() -> None:
    setup = AgentSetup.named("cloned --semantics gt", "rednet")
    assert (setup.semantics, setup.label) == ("gt", "cloned (gt)")
    assert AgentSetup.named("cloned", "rednet").label == "cloned (rednet)"
    assert [setup.semantics for setup in table_named("failures").setups()] == ["rednet"] * 3 + ["gt"]


def test_all_tables_are_those_of_the_paper(tmp_path: Path) -> None:
    assert reproduce._table_names(reproduce.Args(table="all", out=tmp_path)) == list(PAPER_TABLES)
    assert "splits" not in PAPER_TABLES
    assert [setup.agent for setup in table_named("splits").setups()] == [
        "stubborn", "frontier-avoid", "frontier", "stubborn-i", "stubborn-ii", "stubborn-iii", "stubborn-iv", "oracle",
    ]  # fmt: skip
