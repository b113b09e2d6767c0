"""Text in a terminal is text (no markup, no escapes of ids and paths), and a run is never silent for long."""

from __future__ import annotations

import io
import re
import shlex
import sys
from pathlib import Path

import pytest
from rich.table import Table

from sim.app.analysis.display import PlainConsole, describe, file_size, print_results, print_where_to_look
from sim.app.evaluation.summary import summarise
from tests.helpers.results import a_result


def printed(*objects: object, terminal: bool = False) -> str:
    stream = io.StringIO()
    console = PlainConsole(file=stream, width=100, force_terminal=terminal, color_system=None)
    for item in objects:
        console.print(item, highlight=False)
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


@pytest.mark.parametrize(
    ("size_bytes", "shown"),
    [
        (0, "0 bytes"), (1, "1 byte"), (999, "999 bytes"), (1000, "1 kB"), (42_600, "43 kB"), (999_499, "999 kB"),
        (999_500, "1.0 MB"), (1_240_000, "1.2 MB"),
    ],
)  # fmt: skip
def test_the_size_of_a_file_has_the_unit_that_fits_it(size_bytes: int, shown: str) -> None:
    assert file_size(size_bytes) == shown


BROKEN = a_result(
    episode_id="e0", goal="chest_of_drawers", success=0.0, num_steps=1, shortest_path=None, distance_to_goal=None,
    wall_time_s=0.4, failure="misc", end_reason="error", error="Agent 'mine:make', step 1: KeyError",
)  # fmt: skip
"""The result of an episode that an error of the agent has ended."""


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
    print_where_to_look(PlainConsole(width=120), tmp_path, video=False, failed="val_0001~2", sharded=True)
    assert "with --only val_0001 --video --out ANOTHER_FOLDER, without --shard." in capsys.readouterr().out
