"""The archive of result lines that the tables of results are made from.

It holds one folder for each run, with the `config.json` and `results.jsonl` that `stubborn run` wrote.
"""

from __future__ import annotations

import gzip
import io
import shlex
import shutil
import tarfile
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from sim.app.analysis.comparison import Run, read_run
from sim.app.commands.reproduce.runs import RunKey, folder_name, runs_in
from sim.app.composition.agents import find_agent
from sim.core.errors import ConfigError
from sim.core.reading import read_bytes
from sim.episodes.replicates import episode_of
from sim.task.result import EpisodeResult

ROOT = Path(__file__).resolve().parents[2]
TABLES = ROOT / "docs" / "tables"
VERSION = "4.0.0"
"""Version of the splits of the tables. Results of different ones are of different houses or physics."""
SEALED = "sealed4"
"""The sealed split, whose version is "sealed"."""
VERSIONS = (VERSION, "sealed")
ARCHIVE = TABLES / f"splits-{VERSION}.tar.gz"
RUN_FILES = ("config.json", "results.jsonl")
GROUND_TRUTH_KINDS = ("gt", "noisy")
"""Kinds of segmentation that are made from ground truth."""
CHECKSUM_DIGITS = 8
_IMPORTED = {
    "rooms": ("procthor rooms_val.jsonl.gz", 100),
    "house": ("procthor house_train_1.json", 50),
    "kitchen": ("robocasa kitchen/scenes/kitchen.xml --root kitchen", 50),
}
"""What `stubborn import` reads, and the number of episodes."""
PREPARED = {
    "transfer": (
        "stubborn import furniture --source /usr/share/sweethome3d/furniture --out runs/models",
        "stubborn houses generate --furniture runs/models --transfer-test --out runs/transfer",
        "stubborn episodes --split runs/transfer --recipe val",
    ),
    SEALED: (
        "stubborn seal reveal leaderboard/sealed4.sealed.json --announced leaderboard/sealed4.announced.json "
        "--repository . --out runs/sealed4",
    ),
    **{
        name: (
            f"stubborn import {source} --out runs/{name}",
            f"stubborn episodes --split runs/{name} --recipe val --episodes {episodes}",
        )
        for name, (source, episodes) in _IMPORTED.items()
    },
}
"""Commands that make the splits that do not ship (docs/furniture.md, leaderboard.md, worlds.md)."""


@dataclass(frozen=True)
class ArchivedRun:
    """One run of the archive."""

    key: RunKey
    run: Run

    def first_results(self, count: int | None = None) -> list[EpisodeResult]:
        """Returns the results of the first episodes of the split, with their replicates.

        The ids of episodes are numbered in the order of the split.

        Raises:
            ConfigError: the run has fewer episodes.
        """
        if count is not None and count > self.episodes:
            raise ConfigError(f"'{self.run.path.name}' has {self.episodes} episodes; a table needs {count}.")
        chosen = set(sorted({episode_of(number) for number in self.run.results})[:count])
        return [self.run.results[number] for number in sorted(self.run.results) if episode_of(number) in chosen]

    @property
    def episodes(self) -> int:
        """The number of episodes; replicates are not counted."""
        return len({episode_of(number) for number in self.run.results})

    @property
    def uses_ground_truth(self) -> bool:
        """True where the agent declares it, or reads segmentation that is made from ground truth."""
        spec = find_agent(self.key.setup.agent)
        return spec.uses_ground_truth or (spec.uses_segmentation and self.key.setup.semantics in GROUND_TRUTH_KINDS)

    @property
    def codes(self) -> str:
        """The hashes of the code that ran the episodes, as config.json records them."""
        versions = self.run.config.get("versions", {})
        return " ".join(self.run.config.get("codes") or [str(versions.get("code", "unknown"))])

    @property
    def network(self) -> str:
        """The first digits of the SHA-256 of the network's weights; "" without a network."""
        return str(self.run.config.get("files_sha256", {}).get("weights", ""))[:CHECKSUM_DIGITS]

    def command(self, episodes: int) -> str:
        """Returns the commands, with semicolons between, that run the same episodes with the same random numbers.

        A run with a network that did not average with the mirror image says so, because others are the default on some
        processors.
        """
        setup, split = self.key.setup, self.key.split
        options = shlex.split(setup.options)
        detector = self.run.config.get("config", {}).get("detector") or {}
        if detector.get("mirrored") is False:
            options += [*([] if "--config" in options else ["--config"]), "detector.mirrored=false"]
        source = f"runs/{split}" if split in PREPARED else self.run.recorded("split")
        words = ["stubborn", "run", "--agent", setup.agent, *options, "--semantics", setup.semantics]
        words += ["--split", source, "--episodes", str(episodes)]
        if (seed_key := self.run.config.get("seed_key")) is not None:
            words += ["--seed-key", seed_key]
        run = shlex.join(words)
        return "; ".join([*PREPARED.get(split, ()), run])


def read_archive(archive: Path, folder: Path) -> dict[RunKey, ArchivedRun]:
    """Returns the runs of an archive.

    Args:
        archive: a tar.gz file that `pack` made.
        folder: an empty folder, which receives the files of the runs.

    Raises:
        ConfigError: the archive cannot be read, or holds two runs of the same row.
    """
    try:
        with tarfile.open(archive) as opened:
            opened.extractall(folder, filter="data")
    except (OSError, tarfile.TarError, EOFError) as error:
        raise ConfigError(f"Archive '{archive}' cannot be read: {error}.") from None
    return {key: ArchivedRun(key, read_run(path)) for key, path in runs_in(folder, *VERSIONS).items()}


def unpack(archive: Path, out: Path) -> None:
    """Copies the runs of an archive to a folder that has fewer episodes of them."""
    present = runs_in(out, *VERSIONS)
    with tempfile.TemporaryDirectory() as folder:
        for key, run in read_archive(archive, Path(folder)).items():
            target = present.get(key, out / run.run.path.name)
            if not target.exists() or len(read_run(target).results) < len(run.run.results):
                shutil.copytree(run.run.path, target, dirs_exist_ok=True)


def pack(folders: Mapping[RunKey, Path]) -> bytes:
    """Returns a tar.gz file with the files of runs, in folders named as by `stubborn reproduce`.

    The same runs give the same bytes.
    """
    plain = io.BytesIO()
    with tarfile.open(fileobj=plain, mode="w") as archive:
        for target, folder in sorted((folder_name(key.setup, key.split), folder) for key, folder in folders.items()):
            for name in RUN_FILES:
                content = read_bytes(folder / name, what="Run")
                member = tarfile.TarInfo(f"{target}/{name}")
                member.size = len(content)
                archive.addfile(member, io.BytesIO(content))
    return gzip.compress(plain.getvalue(), mtime=0)
