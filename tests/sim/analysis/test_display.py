"""Text in a terminal is text: brackets are no markup, and escapes of ids and paths do not reach it."""

from __future__ import annotations

import io

import pytest
from rich.table import Table

from sim.analysis.display import PlainConsole, with_progress


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
    assert list(with_progress(console, [line], total=1)) == [line]
    assert "a[/b]: bed found" in stream.getvalue()
