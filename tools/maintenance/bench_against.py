"""Compares the speed of this checkout with that of another commit, in turns in one run.

python -m tools.maintenance.bench_against --against v0.1.0                    # all parts, some minutes
python -m tools.maintenance.bench_against --against HEAD~10 --parts step --rounds 60

Each version runs in a process of its own and gets a round of each part in turn, so that other work on the machine slows
both. What is compared is processor time; see docs/performance.md.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import subprocess
import sys
import tarfile
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.table import Table

from sim.app import cli
from sim.app.analysis import display
from sim.core.files import write_atomically
from sim.core.interface import ConfigError
from tools.maintenance.turns import PARTS

ROOT = Path(__file__).resolve().parents[2]
WORKER = Path(__file__).resolve().with_name("turns.py")


@dataclass(frozen=True, kw_only=True)
class Args:
    """Measure this checkout and another commit in turns, and print the ratios."""

    against: str
    """The other version: a tag, a branch or a commit."""
    parts: str = ",".join(PARTS)
    """Names with commas between: step, images, views, house, start."""
    rounds: cli.Count = 30
    """Rounds of each part and version."""
    out: cli.OutFile | None = None
    """A JSON file for the seconds of each round."""


@dataclass(frozen=True)
class Compared:
    """One piece of work in both versions."""

    what: str
    here_s: list[float]
    """Processor time of each round in this checkout."""
    there_s: list[float]
    """The same of the other version."""

    @property
    def ratio(self) -> float:
        """Factor by which this checkout is faster: the median over the rounds."""
        return float(np.median(np.array(self.there_s) / np.array(self.here_s)))

    @property
    def spread(self) -> tuple[float, float]:
        """The ratios between which the middle half of the rounds lies."""
        low, high = np.percentile(np.array(self.there_s) / np.array(self.here_s), (25, 75)).tolist()
        return low, high


def main(args: Args) -> int:
    """Measures and prints the table; returns 0, since a slower version is no error."""
    parts = cli.chosen(args.parts, PARTS, option="--parts")
    commit = commit_of(args.against)
    with tempfile.TemporaryDirectory() as folder:
        unpack(commit, Path(folder))
        with worker(ROOT, parts) as here, worker(Path(folder), parts) as there:
            found = [each for part in parts for each in in_turns(part, here, there, args.rounds, args.against)]
    console = display.make_console()
    console.print(_table(found, args.against, commit), soft_wrap=True)
    if args.out is not None:
        rows = [{"what": each.what, "here_s": each.here_s, "there_s": each.there_s} for each in found]
        content = {
            "against": args.against,
            "commit": commit,
            "ratios": {e.what: e.ratio for e in found},
            "rounds": rows,
        }
        write_atomically(args.out, (json.dumps(content, indent=1) + "\n").encode())
    return 0


def commit_of(ref: str) -> str:
    """Returns the hash of a tag, a branch or a commit of this repository.

    Raises:
        ConfigError: there is none of that name, or this is no git checkout.
    """
    found = _git("rev-parse", "--verify", "--quiet", "--end-of-options", f"{ref}^{{commit}}")
    if found.returncode:
        raise ConfigError(f"--against '{ref}' names no commit, tag or branch of the git repository '{ROOT}'.")
    return found.stdout.decode().strip()


def unpack(commit: str, folder: Path) -> None:
    """Writes the files of a commit to a folder; the repository itself stays as it is.

    Raises:
        ConfigError: git failed.
    """
    packed = _git("archive", "--format=tar", commit)
    if packed.returncode:
        raise ConfigError(f"git archive of {commit} failed: {packed.stderr.decode(errors='replace').strip()}")
    with tarfile.open(fileobj=io.BytesIO(packed.stdout)) as archive:
        archive.extractall(folder, filter="data")


class Worker:
    """A process that runs rounds of one version."""

    def __init__(self, folder: Path, parts: Sequence[str]) -> None:
        command = [sys.executable, str(WORKER), str(folder), ",".join(parts)]
        self._errors = tempfile.TemporaryFile("w+")  # noqa: SIM115 - closed in close()
        self._process = subprocess.Popen(
            command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._errors,  # a file: a full pipe would block the process
            cwd=folder,
            env={**os.environ, "PYTHONPATH": str(folder)},  # in place of the version that is installed
            text=True,
        )

    def round(self, part: str) -> dict[str, float] | None:
        """Returns the seconds of processor time of one round; None: the version cannot run this part."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        with contextlib.suppress(BrokenPipeError):
            print(part, file=self._process.stdin, flush=True)
        line = self._process.stdout.readline()
        return json.loads(line) if line else None

    def last_words(self) -> str:
        """Returns the last line that the ended process wrote to stderr."""
        self._process.wait()
        self._errors.seek(0)
        return (self._errors.read().strip().splitlines() or ["no message"])[-1]

    def close(self) -> None:
        """Ends the process."""
        self._process.kill()
        self._process.communicate()
        self._errors.close()


@contextlib.contextmanager
def worker(folder: Path, parts: Sequence[str]) -> Iterator[Worker]:
    """A context with a process that runs the version in a folder."""
    made = Worker(folder, parts)
    try:
        yield made
    finally:
        made.close()


def in_turns(part: str, here: Worker, there: Worker, rounds: int, ref: str) -> list[Compared]:
    """Returns what a part measures in both versions, which change their order after each round; the first is left out.

    Raises:
        ConfigError: a version cannot run this part.
    """
    seconds: dict[str, dict[str, list[float]]] = {}
    for number in range(rounds + 1):
        turn = [("here", here), ("there", there)]
        for name, each in turn if number % 2 else turn[::-1]:
            taken = each.round(part)
            if taken is None:
                whose = "this checkout" if name == "here" else f"'{ref}'"
                raise ConfigError(f"Part {part} does not run in {whose}: {each.last_words()}")
            for what, value in taken.items() if number else ():
                seconds.setdefault(what, {"here": [], "there": []})[name].append(value)
    return [Compared(what, both["here"], both["there"]) for what, both in seconds.items() if all(both.values())]


def _table(found: Sequence[Compared], ref: str, commit: str) -> Table:
    table = Table(title=f"This checkout against {ref} ({commit[:12]}), processor time", title_justify="left")
    for name, justify in (("work", "left"), ("here", "right"), (ref, "right"), ("times faster", "right"), ("", "left")):
        table.add_column(name, justify="right" if justify == "right" else "left")
    for each in found:
        here_s, there_s = float(np.median(each.here_s)), float(np.median(each.there_s))
        low, high = each.spread
        cells = (each.what, f"{1e3 * here_s:.1f} ms", f"{1e3 * there_s:.1f} ms", f"{each.ratio:.2f}")
        table.add_row(*cells, f"{low:.2f} to {high:.2f} in half of the rounds")
    return table


def _git(*words: str) -> subprocess.CompletedProcess[bytes]:
    try:
        return subprocess.run(["git", "-C", str(ROOT), *words], capture_output=True, check=False)
    except FileNotFoundError:
        raise ConfigError("tools.maintenance.bench_against needs git, which is not installed.") from None


def entry(argv: Sequence[str] | None = None) -> int:
    """Runs the command line; returns its exit status."""
    return cli.run(Args, main, argv)


if __name__ == "__main__":
    sys.exit(entry())
