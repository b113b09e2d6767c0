"""Imports artist-made models of furniture that you have installed, for use in generated houses.

stubborn import furniture --source /usr/share/sweethome3d/furniture --out runs/models
stubborn houses generate --furniture runs/models --houses 4 --out runs/houses

A source is a folder with catalogues of Sweet Home 3D (.sh3f), or with OBJ, glTF or other models and a table
models.csv or models.toml (docs/furniture.md); several sources become one folder of models. `stubborn import furniture
infinigen` makes a source. This command needs the extra `models`. No model is part of this repository. You are
responsible for following the licences; they are written into models.json and into the houses, with the authors.
"""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from sim.app import cli
from sim.core.interface import GOAL_CATEGORIES, ConfigError
from sim.homes.housegen.imported.library import Model, import_entries, transfer_list, with_splits, write_index
from sim.homes.housegen.imported.meshes import check_installed
from sim.homes.housegen.imported.sources import Entry, read_source

REPORT_EVERY = 50


@dataclass(frozen=True, kw_only=True)
class Args:
    """Import models of furniture that you have installed, for use in generated houses."""

    source: tuple[Path, ...]
    """Folders with .sh3f files, or with models and a models.csv or models.toml (columns: docs/furniture.md)."""
    out: cli.OutFolder
    """Folder for models.json and the meshes; created if missing."""
    verbose: bool = False
    """Print every model that is left out, with the reason; models.json lists them too."""


def main(args: Args) -> int:
    """Imports all models; returns 1 if none could be imported."""
    check_installed()
    if args.out.exists() and not args.out.is_dir():
        raise ConfigError(f"--out '{args.out}' is a file, not a folder.")
    entries = [entry for source in args.source for entry in read_source(source)]
    by_ident = {entry.ident: entry for entry in entries if isinstance(entry, Entry)}
    left_out = [entry for entry in entries if not isinstance(entry, Entry)]
    models: list[Model] = []
    for n, made in enumerate(import_entries(list(by_ident.values()), args.out), start=1):
        if isinstance(made, Model):
            models.append(made)
        else:
            left_out.append(made)
            print(f"{made[0]}: left out, {made[1]}", file=sys.stderr)
        if n % REPORT_EVERY == 0:
            print(f"{n} of {len(by_ident)} models read.", flush=True)
    models = with_splits(models)
    write_index(args.out, models, left_out)
    _print_result(models, left_out, verbose=args.verbose)
    return int(not models)


def _print_result(models: Sequence[Model], left_out: Sequence[tuple[str, str]], *, verbose: bool) -> None:
    """Prints the models of each category, and what was left out."""
    if verbose:
        for name, reason in sorted(left_out):
            print(f"left out: {name}: {reason}")
    counts = Counter((model.category, model.split) for model in models)
    for category in sorted({model.category for model in models}, key=lambda name: (name not in GOAL_CATEGORIES, name)):
        print(f"{category}: {counts[category, 'train']} train, {counts[category, 'transfer']} transfer")
    for reason, count in Counter(_kind(reason) for _, reason in left_out).most_common():
        print(f"left out: {count} ({reason})")
    listed = transfer_list()
    changed = [m.name for m in models if m.ident in listed and listed[m.ident] != m.sha256]
    if changed:
        print(f"Other files than in the list of the transfer test: {', '.join(changed)}.")
    triangles = sum(model.triangles for model in models) / max(1, len(models))
    print(f"{len(models)} models of {triangles:.0f} triangles on average, {len(left_out)} left out.")


def _kind(reason: str) -> str:
    """Returns a reason without the parts that differ from model to model."""
    return reason.partition(" (")[0].partition("'")[0].strip() or reason
