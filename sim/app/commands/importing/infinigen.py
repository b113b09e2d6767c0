"""Makes new shapes of furniture with the generators of an installed Infinigen, as a source of imported models.

stubborn import furniture infinigen --python ~/infinigen/bin/python --out runs/infinigen
stubborn import furniture --source runs/infinigen /usr/share/sweethome3d/furniture --out runs/models

The Python is one of version 3.11 with `infinigen` (BSD-3-Clause, parts GPL) and `bpy` (GPL-3.0), which are not part of
this repository; `--help` shows how to install them.

Assets have a plain colour for each material. An asset that fails or takes too long is left out and reported. The same
command resumes; a larger `--count` adds assets.
"""

from __future__ import annotations

import sys
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from sim.app import cli
from sim.core.interface import ConfigError
from sim.homes.housegen.imported.infinigen import GENERATORS, Asset, Generator, make_assets


@dataclass(frozen=True, kw_only=True)
class Args:
    """Make furniture with the generators of an installed Infinigen, for `stubborn import furniture`."""

    python: Path
    """Python 3.11 of an environment of its own, after `pip install --no-deps infinigen==1.15.5 bpy==4.2.0` and
    `pip install "numpy<2" "scipy<1.12" "scikit-image<0.23" "scikit-learn<1.4" "trimesh<3.23" "shapely<=2.0.5"
    "opencv-python-headless<4.9" "imageio<2.32" gin-config matplotlib networkx pandas psutil tqdm rtree python-fcl
    geomdl OpenEXR coacd submitit`."""
    out: cli.OutFolder
    """Folder for the models and models.csv; assets in it are kept."""
    count: cli.Count = 8
    """Assets of each generator."""
    categories: tuple[str, ...] = ()
    """Only generators of these categories; empty: all."""
    seed: cli.Seed = 0
    """The first seed; the others follow it."""
    limit_s: cli.Positive = 300.0
    """Longest time for one asset, in seconds."""


def main(args: Args) -> int:
    """Makes what is missing; returns 1 if the folder has no asset of these generators."""
    generators = chosen(args.categories)
    assets: list[Asset] = []
    total = len(generators) * args.count
    for asset in make_assets(
        args.out, args.python, generators, range(args.seed, args.seed + args.count), limit_s=args.limit_s
    ):
        assets.append(asset)
        name = f"{asset.generator} {asset.seed}"
        if asset.error:
            print(f"{name}: left out, {asset.error}", file=sys.stderr, flush=True)
        else:
            print(f"{name}: {asset.seconds:g} s, {len(assets)} of {total}.", flush=True)
    _print_result(generators, assets)
    return int(all(asset.error for asset in assets))


def chosen(categories: Sequence[str]) -> list[Generator]:
    """Returns the generators of some categories, or all; raises ConfigError for a category without one."""
    known = list(dict.fromkeys(generator.category for generator in GENERATORS))
    for category in categories:
        if category not in known:
            raise ConfigError(f"Infinigen has no generator for '{category}'. Available: {', '.join(known)}.")
    return [generator for generator in GENERATORS if not categories or generator.category in categories]


def _print_result(generators: Sequence[Generator], assets: Sequence[Asset]) -> None:
    """Prints the number of assets of each category, and the seconds that one takes."""
    of_generator: Mapping[str, list[Asset]] = defaultdict(list)
    for asset in assets:
        of_generator[asset.generator].append(asset)
    for generator in generators:
        made = [asset for asset in of_generator[generator.name] if not asset.error]
        failed = len(of_generator[generator.name]) - len(made)
        mean_s = sum(asset.seconds for asset in made) / max(1, len(made))
        print(f"{generator.category}: {generator.name} {len(made)} made in {mean_s:.1f} s each, {failed} left out.")
