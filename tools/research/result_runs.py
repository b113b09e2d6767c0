"""Runs the episodes that the tables of results need, on the splits as they are now, and archives their result lines.

    python -m tools.research.result_runs --minutes 120 --workers 2

The folder of the runs, --out, receives the runs of the archive first, so that another machine continues where one
stopped; rows take turns. The archive then holds all runs of --out that are of its version of the splits.
`tools.research.result_tables` makes the tables from it.
"""

from __future__ import annotations

import gzip
import io
import math
import shlex
import shutil
import subprocess
import sys
import tarfile
import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from sim.app import cli
from sim.app.analysis import display
from sim.app.analysis.comparison import read_run
from sim.core.errors import ConfigError
from sim.core.files import write_atomically
from sim.core.reading import read_bytes
from sim.episodes.splits import load_split
from tools.research.result_archive import ARCHIVE, RUN_FILES, VERSION, RunKey, key_of, read_archive
from tools.research.result_definitions import comparisons, page_tables

CHUNK = 50
"""Episodes of a row before the next row's turn."""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Run the missing episodes of the tables of results, and archive their lines."""

    splits: tuple[str, ...] = ("val", "hazards", "large", "test", "contact-val", "contact-heldout")
    """Splits whose rows are run; runs of another one, such as a folder, are archived too if --out has them."""
    minutes: cli.NotNegative | None = None
    """Time limit: no chunk begins after it. 0 only archives the runs of --out."""
    workers: cli.Count = 1
    """Number of processes."""
    out: cli.OutFolder = Path("runs/results")
    """Folder of the runs; that of `stubborn reproduce` will do."""
    archive: Path = ARCHIVE
    """The archive, which is read and written."""


def main(args: Args) -> int:
    """Runs episodes and writes the archive; returns the exit status."""
    if args.archive.is_file():
        unpack(args.archive, args.out)
    wanted, folders = needed(args.splits), runs_in(args.out)
    end_s = time.monotonic() + (math.inf if args.minutes is None else 60.0 * args.minutes)
    for turn in range(math.ceil(max(wanted.values(), default=0) / CHUNK)):
        for key, most in wanted.items():
            if time.monotonic() < end_s:
                run(key, folders.setdefault(key, args.out / name_of(key)), min((turn + 1) * CHUNK, most), args)
    folders = runs_in(args.out)
    write_atomically(args.archive, pack(folders))
    console = display.make_console()
    for key, most in wanted.items():
        there = len(read_run(folders[key]).lines) if key in folders else 0
        if there < most:
            console.print(f"{key.split}: {key.name}, {key.semantics}: {there} of {most} episodes", highlight=False)
    console.print(f"{len(folders)} runs in {args.archive}", highlight=False)
    return 0


def needed(splits: Sequence[str]) -> dict[RunKey, int]:
    """Returns the runs of some splits that the tables need, with their number of episodes, in the order of the tables.

    Raises:
        ConfigError: a split has another version now than the tables.
    """
    for split in splits:
        if (now := load_split(split).version) != VERSION:
            raise ConfigError(f"'{split}' has version {now}, the tables {VERSION} (tools/research/result_archive.py).")
    rows = [(row.run, row.episodes) for table in page_tables() for row in table.needed()]
    rows += [(key, pair.episodes) for pair in comparisons() for key in (pair.first, pair.second)]
    found: dict[RunKey, int] = {}
    for key, episodes in rows:
        if key.split in splits:
            found[key] = max(episodes, found.get(key, 0))
    return found


def name_of(key: RunKey) -> str:
    """Returns the name of the folder of a row that has none yet."""
    return "_".join((key.agent, key.semantics, key.split, *(each.lstrip("-") for each in shlex.split(key.options))))


def run(key: RunKey, folder: Path, episodes: int, args: Args) -> None:
    """Runs the first episodes of a row that its folder lacks; raises CalledProcessError if `stubborn run` fails."""
    if (folder / RUN_FILES[1]).is_file() and len(read_run(folder).lines) >= episodes:
        return
    words = [*shlex.split(key.options), "--semantics", key.semantics, "--split", key.split, "--episodes", str(episodes)]
    words += ["--workers", str(args.workers), "--out", str(folder), "--keep-results"]
    subprocess.run([sys.executable, "-m", "sim.run", "--agent", key.agent, *words], check=True)


def runs_in(out: Path) -> dict[RunKey, Path]:
    """Returns the folders of runs in a folder that are of the tables' version of the splits.

    Raises:
        ConfigError: two folders hold runs of the same row, or a run cannot be read.
    """
    found: dict[RunKey, Path] = {}
    for file in sorted(out.glob(f"*/{RUN_FILES[1]}")):
        key = key_of(read_run(file.parent))
        if key.version == VERSION and found.setdefault(key, file.parent) != file.parent:
            raise ConfigError(f"'{found[key]}' and '{file.parent}' are runs of the same row.")
    return found


def unpack(archive: Path, out: Path) -> None:
    """Copies the runs of an archive to a folder that has fewer episodes of them."""
    present = runs_in(out)
    with tempfile.TemporaryDirectory() as folder:
        for key, run in read_archive(archive, Path(folder), lambda text: None).items():
            target = present.get(key, out / run.folder)
            if not target.exists() or len(read_run(target).lines) < len(run.run.lines):
                shutil.copytree(run.run.path, target, dirs_exist_ok=True)


def pack(folders: Mapping[RunKey, Path]) -> bytes:
    """Returns a tar.gz file with the files of runs; the same runs give the same bytes."""
    plain = io.BytesIO()
    with tarfile.open(fileobj=plain, mode="w") as archive:
        for folder in sorted(folders.values()):
            for name in RUN_FILES:
                content = read_bytes(folder / name, what="Run")
                member = tarfile.TarInfo(f"{folder.name}/{name}")
                member.size = len(content)
                archive.addfile(member, io.BytesIO(content))
    return gzip.compress(plain.getvalue(), mtime=0)


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
