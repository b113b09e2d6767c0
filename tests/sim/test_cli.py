"""A wrong option gives one line on stderr and exit status 2."""

from __future__ import annotations

from dataclasses import dataclass

import pytest

from sim import cli
from sim.errors import HouseError
from sim.interface import ConfigError


@dataclass(frozen=True)
class Args:
    """Arguments of a test."""

    episodes: int = 5
    """How many."""


def test_parsed_arguments_reach_main() -> None:
    seen: list[Args] = []
    assert cli.run(Args, lambda args: len(seen.append(args) or seen) - 1, ["--episodes", "7"]) == 0
    assert seen == [Args(episodes=7)]


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


@pytest.mark.parametrize("error", [ConfigError("no\nway"), HouseError("no\nway")])
def test_a_usage_error_is_one_line(error: Exception, capsys: pytest.CaptureFixture[str]) -> None:
    def main(args: Args) -> int:
        raise error

    assert cli.run(Args, main, []) == 2
    assert capsys.readouterr().err == "error: no way\n"
