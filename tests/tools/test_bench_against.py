"""The comparison with another commit refuses versions that it cannot compare, and alternates between the two."""

from __future__ import annotations

from pathlib import Path

import pytest

from sim.core.interface import ConfigError
from tools.maintenance import bench_against
from tools.maintenance.bench_against import Worker, commit_of, in_turns, unpack

pytestmark = pytest.mark.skipif(not (bench_against.ROOT / ".git").exists(), reason="needs a git checkout")


def test_a_wrong_ref_is_refused_in_one_sentence(capsys: pytest.CaptureFixture[str]) -> None:
    assert bench_against.entry(["--against", "no-such-release"]) == 2
    message = capsys.readouterr().err
    assert message.startswith("error: --against 'no-such-release' names no commit, tag or branch")
    assert message.count("\n") == 1


@pytest.mark.parametrize("ref", ["", "--all", "HEAD:README.md"])
def test_a_reference_without_a_commit_is_refused(ref: str) -> None:
    with pytest.raises(ConfigError, match="names no commit"):
        commit_of(ref)


def test_a_commit_is_unpacked_as_it_was(tmp_path: Path) -> None:
    unpack(commit_of("HEAD"), tmp_path)
    assert (tmp_path / "sim" / "run.py").is_file()
    assert not (tmp_path / ".git").exists()


class Scripted(Worker):
    """A version whose rounds take the given seconds; after the last one its process has ended."""

    def __init__(self, name: str, seconds: list[float], order: list[str]) -> None:
        self.name, self.seconds, self.order = name, seconds, order

    def round(self, part: str) -> dict[str, float] | None:
        self.order.append(self.name)
        return {f"a {part}": self.seconds.pop(0)} if self.seconds else None

    def last_words(self) -> str:
        return "ImportError: no such part"


def test_versions_take_turns_and_the_first_round_does_not_count() -> None:
    order: list[str] = []
    here, there = Scripted("here", [9.0, 1.0, 2.0, 1.0], order), Scripted("there", [9.0, 3.0, 3.0, 2.0], order)
    (found,) = in_turns("step", here, there, 3, "v1")
    assert order == ["there", "here", "here", "there", "there", "here", "here", "there"]
    assert found.what == "a step"
    assert (found.here_s, found.there_s) == ([1.0, 2.0, 1.0], [3.0, 3.0, 2.0])
    assert found.ratio == 2.0  # the median of 3, 1.5 and 2


def test_a_version_that_cannot_run_a_part_is_named() -> None:
    order: list[str] = []
    with pytest.raises(ConfigError, match="Part step does not run in 'v1': ImportError: no such part"):
        in_turns("step", Scripted("here", [1.0], order), Scripted("there", [], order), 1, "v1")
