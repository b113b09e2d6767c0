"""A wrong option gives one line on stderr and exit status 2."""

from __future__ import annotations

import os
import signal
import time
from dataclasses import dataclass
from pathlib import Path

import pytest
import tyro

from sim.app import cli
from sim.core.errors import PhysicsError, debug
from sim.core.interface import ConfigError


@dataclass(frozen=True)
class Args:
    """Arguments for the tests."""

    episodes: int = 5
    """How many."""


def test_parsed_arguments_reach_main() -> None:
    seen: list[Args] = []
    assert cli.run(Args, lambda args: len(seen.append(args) or seen) - 1, ["--episodes", "7"]) == 0
    assert seen == [Args(episodes=7)]


@dataclass(frozen=True, kw_only=True)
class Optional:
    """Options that need not be given, and folders."""

    runs: tyro.conf.Positional[tuple[Path, ...]]
    """Folders of runs."""

    weights: Path | None = None
    """A file; by default the shipped one."""
    only: tuple[str, ...] = ()
    """Some names; all if not given."""
    seed: int = 3
    """A number."""


@dataclass(frozen=True, kw_only=True)
class Numbers:
    """Options that are numbers."""

    whole: int = 5
    """A whole number."""
    share: float = 0.5
    """A number."""
    limit: float | None = None
    """A number, or none."""
    most: int | None = None
    """A whole number, or none."""


def test_the_help_of_an_option_shows_no_empty_default(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        cli.parse(Optional, ["--help"])
    shown = " ".join(capsys.readouterr().out.replace("│", " ").split())
    assert "by default the shipped one. --only" in shown
    assert "None)" not in shown
    assert "(default: )" not in shown
    assert "A number. (default: 3)" in shown
    parsed = cli.parse(Optional, ["here", "--only", "a", "b"])
    assert parsed == Optional(runs=(Path("here"),), only=("a", "b"))


@pytest.mark.parametrize(
    "words",
    [
        ["--only", "a", "--only", "b", "c"], ["--only=a", "--seed", "3", "--only=b", "c"],
        ["--only", "a", "b", "--seed=3", "--only", "c"],
    ],
)  # fmt: skip
def test_a_repeated_option_of_several_values_has_all_of_them(words: list[str]) -> None:
    assert cli.parse(Optional, ["here", *words]) == Optional(runs=(Path("here"),), only=("a", "b", "c"))


@pytest.mark.parametrize(
    ("argv", "named"),
    [(["--episodes", "many"], "many"), (["--epsodes", "3"], "--epsodes"), (["--episodes"], "--episodes")],
)
def test_a_command_line_that_cannot_be_read_is_one_line(
    argv: list[str], named: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.run(Args, lambda args: 0, argv) == 2
    message = capsys.readouterr().err
    assert message.startswith("error: ")
    assert message.count("\n") == 1
    assert named in message
    assert "│" not in message


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--whole", "five"], "--whole must be a whole number, got 'five'."),
        (["--share", "half"], "--share must be a number, got 'half'."),
        (["--limit", "soon"], "--limit must be a number, got 'soon'."),
        (["--most", "all"], "--most must be a whole number, got 'all'."),
    ],
)
def test_a_text_in_place_of_a_number_is_named(
    words: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.run(Numbers, lambda args: 0, words) == 2
    assert capsys.readouterr().err == f"error: {message}\n"


def test_an_unknown_option_is_answered_with_the_similar_one_alone(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A long path of the program wraps the lines of help around the message, which must not become part of it."""
    monkeypatch.setattr(cli.invocation, "program", lambda: f"/home/{'folder/' * 9}python -m sim.app.commands.main run")
    assert cli.run(Args, lambda args: 0, ["--epsodes", "3"]) == 2
    assert capsys.readouterr().err == "error: Unrecognized options: --epsodes, 3. Did you mean --episodes?\n"
    assert cli.run(Args, lambda args: 0, ["--episodes", "3", "4"]) == 2
    assert capsys.readouterr().err == "error: Unrecognized options: 4\n"


@dataclass(frozen=True)
class Ranges:
    """Arguments with ranges."""

    out: cli.OutFolder | None = None
    """Folder."""
    page: cli.OutFile | None = None
    """File."""
    seed: cli.Seed = 0
    """Seed."""
    counts: tuple[cli.Count, ...] = ()
    """Counts."""
    share: cli.Share | None = None
    """Share."""
    rate: cli.Positive = 1.0
    """Rate."""
    plain: float = 0.0
    """Any number."""


@pytest.mark.parametrize(
    ("argv", "expected"),
    [
        (["--seed", "-1"], "--seed must be at least 0, got -1."),
        (["--counts", "1", "0"], "--counts must be at least 1, got 0."),
        (["--share", "1.5"], "--share must be at most 1, got 1.5."),
        (["--share", "nan"], "--share must be a finite number, got nan."),
        (["--rate", "0"], "--rate must be more than 0, got 0.0."),
        (["--rate", "1e308"], "--rate must be at most 1e+09, got 1e+308."),
        (["--plain", "inf"], "--plain must be a finite number, got inf."),
        (["--out", "/dev/null/x"], "--out '/dev/null/x' cannot be written"),
        (["--page", "/dev"], "--page '/dev' is a folder; give the path of a file."),
        (["--out", "n" * 300], "too long"),
        (["--out", "a\x1b[31m"], "'a\\x1b[31m' holds a control character"),
        (["--out", "a\udcff"], "'a\\udcff' holds a control character or a byte that is not UTF-8"),
    ],
)
def test_an_option_out_of_its_range_is_named_before_the_command_begins(
    argv: list[str], expected: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.run(Ranges, lambda args: pytest.fail("it began"), argv) == 2
    message = capsys.readouterr().err
    assert message.startswith("error: ")
    assert message.count("\n") == 1
    assert expected in message


@pytest.mark.parametrize(
    ("error", "expected"),
    [
        (OSError(28, "No space left on device"), "A file cannot be read or written: No space left on device."),
        (OSError(28, "No space left on device", "a.mp4"), "'a.mp4' cannot be read or written: No space"),
        (IsADirectoryError(21, "Is a directory", "a", None, "b"), "'a' and 'b' cannot be read or written"),
        (MemoryError(), "not enough memory"),
        (ConfigError("no\nway"), "error: no way\n"),
        (PhysicsError("it\x1b[31m flew"), "it\\x1b[31m flew"),
    ],
)
def test_a_full_disk_and_the_like_are_one_line_and_with_debug_a_traceback_too(
    error: Exception, expected: str, capsys: pytest.CaptureFixture[str]
) -> None:
    def main(args: Args) -> int:
        raise error

    assert cli.run(Args, main, []) == 2
    message = capsys.readouterr().err
    assert expected in message
    assert message.count("\n") == 1
    assert cli.run(Args, main, ["--debug"]) == 2
    assert "Traceback" in capsys.readouterr().err
    assert not debug()


@pytest.mark.parametrize(("number", "status"), [(signal.SIGTERM, 143), (signal.SIGINT, 130)])
def test_a_signal_ends_a_command_in_order(number: int, status: int, capsys: pytest.CaptureFixture[str]) -> None:
    ended = []

    def main(args: Args) -> int:
        try:
            os.kill(os.getpid(), number)
            time.sleep(5)
        finally:
            ended.append(True)
        return 0

    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background commands ignore it
    try:
        assert cli.run(Args, main, [], stopped="Resume it.") == status
    finally:
        signal.signal(signal.SIGINT, before)
    assert ended == [True]
    assert capsys.readouterr().err == "\nResume it.\n"
    assert signal.getsignal(signal.SIGTERM) == signal.SIG_DFL


def test_names_of_an_option_come_in_their_order_and_unknown_ones_are_refused() -> None:
    assert cli.chosen("d, a", "abcd", option="--parts") == ["a", "d"]
    for text in ("z", "", "a,z"):
        with pytest.raises(ConfigError, match="--parts"):
            cli.chosen(text, "abcd", option="--parts")
