"""Recorded runs and their submissions, made once for all tests of a process."""

from __future__ import annotations

from pathlib import Path

import pytest

from sim.app.commands import submit
from tests.helpers.submissions import RUNS, recorded, tiny_split


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a split, and a recorded run and a submission of each of `RUNS`; the last two have noise."""
    folder = tmp_path_factory.mktemp("submissions")
    split = tiny_split(folder)
    for name, (agent, noise) in RUNS.items():
        recorded(split, folder / name, agent, "--noise", noise, "--seed-key", "key")
        words = submit.Args(run=folder / name, name=f"The {name}", authors=("A. Author",), links=("https://x.org/a",))
        assert submit.main(words) == 0
    return folder
