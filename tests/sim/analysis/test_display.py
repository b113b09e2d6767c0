"""Text in a terminal is text (no markup, no escapes of ids and paths), and a run is never silent for long."""

from __future__ import annotations

import io
import re
import shlex
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from rich.table import Table

from sim.analysis.display import PlainConsole, ProgressReport, describe, print_results, print_where_to_look
from sim.episodes.splits import Episode
from sim.evaluation.results import summarise
from sim.geometry.pose import Pose


def printed(*objects: object, terminal: bool = False) -> str:
    stream = io.StringIO()
    console = PlainConsole(file=stream, width=100, force_terminal=terminal, color_system=None)
    for each in objects:
        console.print(each, highlight=False)
    return stream.getvalue()


@pytest.mark.parametrize("text", ["runs/[bold]a[/bold]", "[/red]", "a :smile: b", "[link=file:///etc]x[/link]"])
def test_brackets_and_names_of_emoji_are_printed_as_they_are(text: str) -> None:
    table = Table("name", title=text)
    table.add_row(text)
    assert printed(text).strip() == text
    assert printed(table).count(text) == 2


def test_control_characters_are_printed_as_escapes() -> None:
    table = Table("name")
    table.add_row("b\x1b]0;title\x07")
    shown = printed("a\x1b[31m\u009bK\udcff", table, terminal=True)
    assert "a\\x1b[31m\\x9bK\\udcff" in shown
    assert "b\\x1b]0;title\\x07" in shown
    assert not {"\x1b", "\x07", "\u009b"} & set(shown)


def test_the_progress_of_an_episode_with_brackets_in_its_id_is_shown(capsys: pytest.CaptureFixture[str]) -> None:
    line = {"episode_id": "a[/b]", "goal": "bed", "success": 1.0, "num_steps": 3, "wall_time_s": 1.0}
    stream = io.StringIO()
    console = PlainConsole(file=stream, width=100, force_terminal=True)
    progress = ProgressReport(console, total=1)
    assert list(progress.over([line])) == [line]
    assert "a[/b]: bed found" in stream.getvalue()


def test_a_pipe_gets_a_line_when_an_episode_begins_while_it_runs_and_when_it_ends() -> None:
    stream = io.StringIO()
    progress = ProgressReport(PlainConsole(file=stream, width=100), total=1, quiet_s=0.05)
    episode = Episode("e0", "val_00", "tv_monitor", Pose(0.0, 0.0, 0.0))
    line = {"episode_id": "e0", "goal": "tv_monitor", "success": 1.0, "num_steps": 3, "wall_time_s": 1.0}

    def lines() -> Iterator[dict[str, Any]]:
        progress.started(episode)
        time.sleep(0.4)
        yield line

    assert list(progress.over(lines())) == [line]
    first, *running, last = stream.getvalue().splitlines()
    assert first == "e0 begins: looking for tv monitor in house val_00"
    assert running
    assert all(re.fullmatch(r"\[0/1\] running: e0 for \d+ s", each) for each in running)
    assert last == "[1/1] e0: tv monitor found after 3 steps, 1 s"
    assert "progress" not in {thread.name for thread in threading.enumerate()}


BROKEN = {
    "episode_id": "e0", "house": "h", "goal": "chest_of_drawers", "success": 0.0, "spl": 0.0, "num_steps": 1,
    "path_length": 0.0, "shortest_path": None, "distance_to_goal": None, "collisions": 0, "steps_per_s": 1.0,
    "wall_time_s": 0.4, "failure": "misc", "end_reason": "error", "error": "Agent 'mine:make', step 1: KeyError",
}  # fmt: skip
"""The line of an episode that an error of the agent has ended."""


def test_an_error_is_called_one_and_the_option_that_shows_where_is_named() -> None:
    stream = io.StringIO()
    print_results(PlainConsole(file=stream, width=120), [BROKEN], summarise([BROKEN]))
    shown = stream.getvalue()
    assert "misc" not in shown
    assert "no: error" in shown
    assert "Failed by error: 1" in shown
    assert "1 episode in 1 house" in shown
    assert "--debug shows the traceback" in shown
    assert describe(BROKEN) == "e0: chest of drawers ended with an error after 1 step, 0 s"


def test_the_printed_commands_start_as_they_are_printed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    script = Path(sys.executable).with_name("stubborn")
    monkeypatch.setattr(sys, "argv", [str(script)])
    monkeypatch.setenv("PATH", "/nowhere")  # outside the virtual environment
    print_where_to_look(PlainConsole(width=120), tmp_path / "a run", video=False)
    report, web = re.findall(r": (\S*stubborn .*)", capsys.readouterr().out)
    assert shlex.split(report) == [str(script), "report", str(tmp_path / "a run")]
    assert shlex.split(web) == [str(script), "web"]
    print_where_to_look(PlainConsole(width=120), tmp_path, video=False, failed="val_0001", sharded=True)
    assert "with --only val_0001 --video --out ANOTHER_FOLDER, without --shard." in capsys.readouterr().out
