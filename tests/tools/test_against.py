"""The comparison with another commit refuses versions that it cannot compare, and alternates between the two."""

from __future__ import annotations

from pathlib import Path

import pytest

from sim.core.interface import ConfigError
from tests.helpers import wording
from tools.benchmarks import against
from tools.benchmarks.against import Args, in_turns, line, main, worker


@pytest.mark.skipif(not (against.ROOT / ".git").exists(), reason="needs a git checkout")
@pytest.mark.parametrize("ref", ["", "--all", "HEAD:README.md", "no-such-release"])
def test_a_reference_without_a_commit_is_refused(ref: str) -> None:
    with pytest.raises(ConfigError, match=wording.NAMES_NO_COMMIT):
        main(Args(against=ref))


def test_versions_take_turns_and_the_first_round_does_not_count() -> None:
    order: list[str] = []
    here_s, other_s = [9.0, 1.0, 2.0, 1.0], [9.0, 3.0, 3.0, 2.0]

    def here(part: str) -> float:
        order.append("here")
        return here_s.pop(0)

    def other(part: str) -> float:
        order.append("other")
        return other_s.pop(0)

    seconds = in_turns("steps", here, other, 3)
    assert order == ["other", "here", "here", "other", "other", "here", "here", "other"]
    assert seconds == [(1.0, 3.0), (2.0, 3.0), (1.0, 2.0)]
    assert line("steps", seconds, "v1") == (
        "steps: 1000.0 ms, v1 3000.0 ms: 2.00 times faster (1.75 to 2.50 in half of the rounds)"
    )


def test_a_version_that_cannot_run_a_part_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    script = tmp_path / "rounds.py"
    script.write_text(
        "import sys\nassert sys.argv[1:] == ['steps']\nprint(0.5, flush=True)\nsys.exit('no such part')\n"
    )
    monkeypatch.setattr(against, "WORKER", script)
    with worker(tmp_path, ["steps"]) as run:
        assert run("steps") == 0.5
        with pytest.raises(ConfigError, match=f"Part steps does not run in '{tmp_path}': no such part"):
            run("steps")
