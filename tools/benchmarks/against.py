"""Compares the speed of this checkout with that of another commit, in turns in one run.

    python -m tools.benchmarks.against --against v0.1.0                    # all parts, some minutes
    python -m tools.benchmarks.against --against HEAD~10 --parts steps --rounds 60

Each version runs in a process of its own and gets a round of each part in turn, so that other work on the machine slows
both. Processor time is compared (`tools.benchmarks.rounds`).
"""

from __future__ import annotations

import contextlib
import io
import os
import subprocess
import sys
import tarfile
import tempfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sim.app import cli
from sim.core.interface import ConfigError
from tools.benchmarks.rounds import PARTS

ROOT = Path(__file__).resolve().parents[2]
WORKER = Path(__file__).resolve().with_name("rounds.py")
Round = Callable[[str], float]
"""Runs a round of a part; returns its seconds."""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Measure this checkout and another commit in turns, and print the ratios."""

    against: str
    """The other version: a tag, a branch or a commit."""
    parts: str = ",".join(PARTS)
    """Names with commas between: steps, images, houses, starts."""
    rounds: cli.Count = 30
    """Rounds of each part and version."""


def main(args: Args) -> int:
    """Measures and prints a line for each part; returns 0, also if the version is slower."""
    parts = cli.chosen(args.parts, PARTS, option="--parts")
    commit = _git("rev-parse", "--verify", "--quiet", "--end-of-options", f"{args.against}^{{commit}}")
    if commit.returncode:
        raise ConfigError(f"--against '{args.against}' names no commit, tag or branch of the git repository '{ROOT}'.")
    packed = _git("archive", "--format=tar", commit.stdout.decode().strip())
    with tempfile.TemporaryDirectory() as folder, tarfile.open(fileobj=io.BytesIO(packed.stdout)) as archive:
        archive.extractall(folder, filter="data")
        with worker(ROOT, parts) as here, worker(Path(folder), parts) as other:
            for part in parts:
                print(line(part, in_turns(part, here, other, args.rounds), args.against), flush=True)
    return 0


def in_turns(part: str, here: Round, other: Round, rounds: int) -> list[tuple[float, float]]:
    """Returns the seconds of both versions in each round but the first one; their order alternates."""
    seconds = []
    for number in range(rounds + 1):
        other_s = other(part) if number % 2 == 0 else None
        here_s = here(part)
        seconds.append((here_s, other(part) if other_s is None else other_s))
    return seconds[1:]


def line(part: str, seconds: Sequence[tuple[float, float]], ref: str) -> str:
    """Returns the medians of a part and their ratio, with the ratios between which half of the rounds lies."""
    here_s, other_s = np.array(seconds).T
    low, middle, high = np.percentile(other_s / here_s, (25, 50, 75)).tolist()
    return (
        f"{part}: {1e3 * np.median(here_s):.1f} ms, {ref} {1e3 * np.median(other_s):.1f} ms: {middle:.2f} times faster "
        f"({low:.2f} to {high:.2f} in half of the rounds)"
    )


@contextlib.contextmanager
def worker(folder: Path, parts: Sequence[str]) -> Iterator[Round]:
    """A context with a process of the version in a folder; a round raises ConfigError if it cannot run its part."""
    with tempfile.TemporaryFile("w+") as errors:  # a file: a full pipe would block the process
        process = subprocess.Popen(
            [sys.executable, str(WORKER), *parts], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=errors,
            cwd=folder, env={**os.environ, "PYTHONPATH": str(folder)}, text=True,
        )  # fmt: skip

        def run(part: str) -> float:
            assert process.stdin is not None
            assert process.stdout is not None
            with contextlib.suppress(BrokenPipeError):
                print(part, file=process.stdin, flush=True)
            answer = process.stdout.readline()
            if not answer:
                process.wait()
                errors.seek(0)
                message = (errors.read().strip().splitlines() or ["no message"])[-1]
                raise ConfigError(f"Part {part} does not run in '{folder}': {message}")
            return float(answer)

        try:
            yield run
        finally:
            process.kill()
            process.communicate()


def _git(*words: str) -> subprocess.CompletedProcess[bytes]:
    return subprocess.run(["git", "-C", str(ROOT), *words], capture_output=True, check=False)


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
