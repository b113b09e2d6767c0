"""Compares the published code of the Stubborn agent with this project's, with true masks, on the same episodes.

python -m tools.research.compare_published --checkout ../Stubborn --python ../env/bin/python --split val --episodes 50

CHECKOUT is a clone of https://github.com/Improbable-AI/Stubborn, PYTHON an environment with the packages that
docs/habitat.md lists. The published agent runs in that environment (`tools.research.published_stubborn`). The folder
OUT/MOTION gets a run of each agent and their comparison, and OUT/published_code.csv has all comparisons: differences
are this project's minus the published ones. Runs that were interrupted continue.
"""

from __future__ import annotations

import os
import pickle
import shlex
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from sim.app import cli
from sim.app.analysis.tables import CSV_COLUMNS
from sim.app.commands.agent_client import client_file
from sim.app.commands.reproduce.motion_tables import MOTIONS
from sim.core.files import csv_text, write_atomically
from sim.core.reading import read_csv

EXAMPLES = Path("Stubborn") / "obj_id_data.pickle"
"""Examples of targets from which the agent learns to verify; without any, it accepts each candidate."""

AGENTS = ("published", "stubborn")
"""Names of the two runs of a motion."""
COLUMNS = ("metric", "of", *CSV_COLUMNS[3:])

ENVIRONMENT = {
    "OMP_NUM_THREADS": "1",
    "MALLOC_MMAP_THRESHOLD_": "2000000000",
    "MALLOC_TRIM_THRESHOLD_": "8000000000",
}
"""The published agent allocates tens of megabytes a step; with these values glibc keeps them: 1.6 times as fast."""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Compares the published Stubborn agent with this project's."""

    checkout: Path
    """Folder of the published repository."""
    python: Path
    """Python of the environment of the published agent."""
    split: str = "val"
    """Split whose first episodes are run."""
    episodes: cli.Count = 50
    """Number of episodes."""
    motions: tuple[str, ...] = MOTIONS
    """Kinds of motion, as in `stubborn run --motion`."""
    workers: cli.Count = 1
    """Number of processes."""
    out: cli.OutFolder = Path("runs/published")
    """Folder of the runs."""


def main(args: Args) -> int:
    """Runs both agents with each motion and compares them."""
    checkout, out = args.checkout.resolve(), args.out.resolve()
    if not (checkout / EXAMPLES).exists():
        (checkout / EXAMPLES).write_bytes(pickle.dumps([]))
    write_atomically(out / "stubborn_client.py", client_file())
    words = [str(args.python.absolute()), str(out / "stubborn_client.py"), "published_stubborn:WithTrueMasks"]
    published = ["--agent", f"process:{shlex.join(words)}", "--config", "agent.interface=habitat"]
    published += ['sensors=["rgb", "depth", "semantic"]', "agent.start_timeout_s=1800", "--step-timeout", "600"]
    lines: list[list[str]] = []
    for motion in args.motions:
        common = ["--split", args.split, "--episodes", str(args.episodes), "--motion", motion]
        runs = [out / motion / name for name in AGENTS]
        for folder, options in zip(runs, (published, ["--semantics", "gt"]), strict=True):
            stubborn("run", *options, *common, "--workers", str(args.workers), "--out", str(folder), folder=checkout)
        stubborn("compare", *map(str, runs), "--out", str(out / motion), folder=checkout)
        lines += [[args.split, motion, *row] for row in rows_of(out / motion / "comparison.csv")]
    write_atomically(out / "published_code.csv", csv_text(["split", "motion", *COLUMNS], lines))
    return 0


def rows_of(file: Path) -> list[list[str]]:
    """Returns the rows of a comparison in the order of `COLUMNS`."""
    names = {"A": AGENTS[0], "B": AGENTS[1], "B - A": f"{AGENTS[1]} - {AGENTS[0]}"}
    return [
        [row["row"], names[row["column"]], *(row[name] for name in COLUMNS[2:])]
        for row in read_csv(file, what="Comparison")
    ]


def stubborn(*words: str, folder: Path) -> None:
    """Runs `stubborn WORDS` in the folder of the published repository; raises CalledProcessError if it fails."""
    root = Path(__file__).parents[2]
    paths = [root, Path(__file__).parent, folder / "Stubborn"]
    environment = {**os.environ, **ENVIRONMENT, "PYTHONPATH": os.pathsep.join(map(str, paths))}
    subprocess.run([sys.executable, "-m", "sim.app.commands.main", *words], cwd=folder, env=environment, check=True)


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
