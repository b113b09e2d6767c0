"""Trains several networks for the same time on the same views and writes a table of their mIoU.

    python -m tools.training.compare_networks --views runs/views_train runs/views_wide --val-views runs/views_val \\
        --hours 1 --seeds 0 1 --out runs/networks

Each network and seed is a run of `stubborn train segmentation` in `<out>/<network>_<seed>`; `lite0-imagenet` is `lite0`
from ImageNet weights with a tenth of the learning rate for its encoder. The runs take turns, a part of the time each,
so that a stopped comparison is still at equal times; the same command resumes. --hours 0 only writes the table.
"""

from __future__ import annotations

import csv
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import msgspec
import numpy as np

from sim.app import cli
from sim.app.commands.train import segmentation
from sim.core.files import write_atomically
from sim.core.interface import ConfigError
from sim.core.reading import Count as ReadCount
from sim.core.reading import Number, convert, read_bytes
from stubborn.segmentation.networks import NETWORKS, build_network

PRETRAINED = "lite0-imagenet"
CHOICES = ("compact", "compact-geometry", "unet", "lite0", PRETRAINED)


@dataclass(frozen=True, kw_only=True)
class Args:
    """Compare networks at equal training time."""

    views: tuple[Path, ...]
    """Folders of training shards."""
    val_views: tuple[Path, ...]
    """Folders of shards to evaluate on."""
    out: cli.OutFolder
    """Folder of the runs and of the table `networks.md`."""
    networks: tuple[str, ...] = CHOICES
    """Networks to compare."""
    seeds: tuple[cli.Seed, ...] = (0, 1)
    """Seeds of initial weights, order and augmentation."""
    hours: cli.NotNegative = 1.0
    """Training time of each run."""
    turn_hours: cli.Positive = 0.25
    """Time of a turn."""
    batch: cli.Count = 16
    """Views per step."""
    block_px: cli.Count = 4
    """See `stubborn train segmentation`."""
    val_count: cli.Amount = 600
    """Number of views of an evaluation."""
    evaluate_every: cli.Count = 500
    """Steps between evaluations; their time counts, except for that of the last one."""
    threads: cli.Count | None = None
    """Number of threads of PyTorch; None does not change it."""


def main(args: Args) -> int:
    """Trains what is missing and writes the table; returns the exit status."""
    _check(args)
    turns = int(np.ceil(args.hours / args.turn_hours))
    for turn in range(1, turns + 1):
        for name in args.networks:
            for seed in args.seeds:
                limit = min(args.hours, turn * args.turn_hours)
                if trained_hours(_folder(args, name, seed)) < 0.99 * limit:
                    segmentation.Trainer(training(args, name, seed, limit)).run()
    text = table(args)
    print(text)
    write_atomically(args.out / "networks.md", text)
    return 0


def training(args: Args, name: str, seed: int, limit_hours: float) -> segmentation.Args:
    """Returns the options of one run up to a time; the learning rate follows the whole time."""
    return segmentation.Args(
        views=args.views,
        val_views=args.val_views,
        out=_folder(args, name, seed),
        size="lite0" if name == PRETRAINED else name,
        hours=args.hours,
        stop_after_hours=limit_hours,
        seed=seed,
        batch=args.batch,
        block_px=args.block_px,
        val_count=args.val_count,
        evaluate_every=args.evaluate_every,
        threads=args.threads,
        imagenet=name == PRETRAINED,
    )


def table(args: Args) -> str:
    """Returns the table of all runs so far, Markdown."""
    heading = ("network", "parameters (million)", "seeds", "steps", "hours", "mIoU, last", "accuracy")
    lines = [f"| {' | '.join(heading)} |", "|---|" + "--:|" * (len(heading) - 1)]
    for name in args.networks:
        rows = [row for seed in args.seeds if (row := last_row(_folder(args, name, seed)))]
        if rows:
            lines.append(_line(name, rows))
    return "\n".join(lines) + "\n"


class Evaluation(msgspec.Struct):
    """The fields of a line of `val.csv` that the table shows."""

    step: ReadCount
    hours: Number
    miou_goals: Number
    accuracy: Number


def last_row(folder: Path) -> Evaluation | None:
    """Returns the last evaluation of a run; None before the first one."""
    file = folder / "val.csv"
    if not file.is_file():
        return None
    rows = list(csv.DictReader(read_bytes(file, what="Evaluations").decode(errors="replace").splitlines()))
    return convert(rows[-1], Evaluation, where=f"Evaluations '{file}', last line", strict=False) if rows else None


def trained_hours(folder: Path) -> float:
    """Returns how long a run was trained until its last evaluation."""
    row = last_row(folder)
    return row.hours if row else 0.0


def _line(name: str, rows: Sequence[Evaluation]) -> str:
    config = NETWORKS["lite0" if name == PRETRAINED else name]
    parameters = sum(p.numel() for p in build_network(config).parameters()) / 1e6
    mious = [row.miou_goals for row in rows]
    miou = f"{np.mean(mious):.3f} ({', '.join(f'{value:.3f}' for value in mious)})"
    steps, hours, accuracy = (np.mean([getattr(row, key) for row in rows]) for key in ("step", "hours", "accuracy"))
    return f"| {name} | {parameters:.1f} | {len(rows)} | {steps:.0f} | {hours:.2f} | {miou} | {accuracy:.3f} |"


def _folder(args: Args, name: str, seed: int) -> Path:
    return args.out / f"{name}_{seed}"


def _check(args: Args) -> None:
    """Raises ConfigError for arguments that are not allowed."""
    unknown = [name for name in args.networks if name not in (*NETWORKS, PRETRAINED)]
    if unknown:
        raise ConfigError(f"No network '{unknown[0]}'. Available: {', '.join((*NETWORKS, PRETRAINED))}.")
    if args.hours < 0 or args.turn_hours <= 0:
        raise ConfigError(f"--hours must be at least 0 and --turn-hours > 0, got {args.hours} and {args.turn_hours}.")


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
