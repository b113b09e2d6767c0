"""Writes the seal of an existing split, for example of imported houses of other authors, to be published.

    stubborn seal publish challenge/homes

After the deadline, the split itself is published: `stubborn seal reveal challenge/homes.sealed.json --split homes`.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from sim.app import cli
from sim.app.submissions.announcement import write_published
from sim.app.submissions.sealing import seal_file, seal_of
from sim.core.vocabulary import counted
from sim.episodes.splits import load_split


@dataclass(frozen=True, kw_only=True)
class Args:
    """Write the seal of a split."""

    split: Annotated[tyro.conf.Positional[Path], tyro.conf.arg(metavar="SPLIT")]
    """Folder of a split with houses and episodes."""
    out: cli.OutFile | None = None
    """File of the seal; by default SPLIT.sealed.json next to the folder."""


def main(args: Args) -> int:
    """Writes the seal; returns the exit status."""
    split = load_split(args.split)
    seal, out = seal_of(split, None), args.out or seal_file(args.split)
    write_published(out, seal, "a seal")
    print(f"{out}: {counted(seal.houses, 'house')}, {counted(seal.episodes, 'episode')}, sha256 {seal.split_sha256}.")
    return 0
