"""Generates the views that a segmentation network is trained on and selected by, in one folder for each part.

stubborn import furniture --source /usr/share/sweethome3d/furniture --out runs/models
stubborn views mix --furniture runs/models --views 100000 --out runs/views
stubborn train segmentation --views runs/views/{reshaped,models,train,aimed} --val-views runs/views/selection \
    --out runs/rednet

| folder | share | houses |
|---|--:|---|
| reshaped | 40 % | new houses whose items have other proportions than those of their styles |
| models | 40 % | the same with imported models; without --furniture these views are of `reshaped` as well |
| train | 5 % | new houses with the styles of the split train |
| aimed | 15 % | as `models`, cameras aimed at rare goals from 1 to 3.5 m |
| selection | | `--selection` views of houses that prefer the withheld styles and models; no other part shows these |

All but those of `train` and `selection` have other light, and a body that leans in some views (`views --vary`).
Parts grow in turns, so that a stopped run has views in these proportions and training can begin. The same command
continues: complete shards are kept, and a shard has the same bytes in every run.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from sim.app import cli
from sim.app.commands.views import generate
from sim.core.interface import ConfigError

VIEWS_PER_HOUSE = 40
"""Views of one house in the parts of the training: more houses teach more than more views of them."""
SELECTION_PER_HOUSE = 20
"""Views of one house of the selection."""
SHARES = {"reshaped": 8, "models": 8, "train": 1, "aimed": 3}
"""Houses of each part in a turn."""
PER_TURN = VIEWS_PER_HOUSE * sum(SHARES.values())
SELECTION = "selection"


@dataclass(frozen=True, kw_only=True)
class Args:
    """Generate the views that a segmentation network is trained on and selected by."""

    out: cli.OutFolder
    """Folder of the folders of views; complete shards in it are kept."""
    furniture: Path | None = None
    """Folder of imported models (`stubborn import furniture`); None: houses have our own furniture only."""
    views: cli.Count = 100_000
    """Views for training, rounded up to whole turns of 800."""
    selection: cli.Count = 2000
    """Views for selecting a network, rounded up to whole houses of 20."""
    workers: cli.Count = 1
    """Number of processes."""
    seed: cli.Seed = 0
    """Seed of houses and poses."""


def main(args: Args) -> int:
    """Generates what is missing, the selection first; returns the exit status."""
    _require_models(args.furniture)
    generate.main(selection(args))
    turns = -(-args.views // PER_TURN)
    for turn in range(1, turns + 1):
        print(f"turn {turn} of {turns}", flush=True)
        for part in parts(args, turn):
            generate.main(part)
    return 0


def folders(out: Path, furniture: Path | None) -> tuple[Path, ...]:
    """Returns the folders of the views for training."""
    return tuple(out / name for name in SHARES if furniture is not None or name != "models")


def parts(args: Args, turns: int) -> Iterator[generate.Args]:
    """Yields the options of each part of the views for training after a number of turns."""
    houses = dict(SHARES)
    if args.furniture is None:
        houses["reshaped"] += houses.pop("models")
    for name, count in houses.items():
        train = _options(args, name, views=VIEWS_PER_HOUSE * count * turns, per_house=VIEWS_PER_HOUSE)
        furniture, aim = args.furniture if name in ("models", "aimed") else None, "rare" if name == "aimed" else None
        own = name != "train"
        yield replace(train, withheld="without", reshape=own, vary=own, furniture=furniture, aim=aim)


def selection(args: Args) -> generate.Args:
    """Returns the options of the views for selecting a network."""
    views = SELECTION_PER_HOUSE * -(-args.selection // SELECTION_PER_HOUSE)
    options = _options(args, SELECTION, views=views, per_house=SELECTION_PER_HOUSE)
    return replace(options, withheld="only", reshape=True, furniture=args.furniture)


def _options(args: Args, name: str, *, views: int, per_house: int) -> generate.Args:
    """Returns the options of one part: rendered as agents see, reduced to 320 x 240; the seeds of parts differ."""
    number = [*SHARES, SELECTION].index(name)
    return generate.Args(
        out=args.out / name, views=views, views_per_shard=per_house, workers=args.workers, pool="train",
        seed=(len(SHARES) + 1) * args.seed + number, profile="fast", shrink=2, extras=("instances",),
    )  # fmt: skip


def _require_models(furniture: Path | None) -> None:
    """Raises ConfigError if the folder of imported models does not exist."""
    if furniture is not None and not furniture.is_dir():
        raise ConfigError(f"--furniture '{furniture}' is not a folder; `stubborn import furniture` makes one.")
