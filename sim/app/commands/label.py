"""Proposes category labels for a scene from another source, or shows the labels that a file of rules gives it.

    stubborn label --house kitchen.xml --out labels.json --picture labels.png
    stubborn label --house kitchen.xml --labels labels.json --picture labels.png

The first command writes rules for the names in the scene, from the words in them and from sizes
(`sim.houses.proposals`); names without a known word get `void`. Edit the categories in the file, then check it with the
second command. Both print a table of the instances: name, category, number of geoms, size, height above the floor, and
a note if the label is doubtful. The picture shows the scene from above, in its own colours and in those of the
categories.
"""

from __future__ import annotations

import functools
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.table import Table

from sim.app import cli
from sim.app.analysis import display
from sim.app.viewers.house_pictures import distinct_colours, draw_top
from sim.core.errors import ConfigError, HouseError
from sim.core.files import write_atomically, write_picture
from sim.core.interface import GOAL_CATEGORIES, MPCAT40
from sim.core.vocabulary import counted
from sim.gl import mujoco
from sim.houses.foreign import remove_unsupported
from sim.houses.geoms import data_at_rest
from sim.houses.house import House
from sim.houses.labels import VOID, Labels, read_labels
from sim.houses.load import load_house, read_rules, validate_house
from sim.houses.mjcf import read_spec, require_sizes
from sim.houses.proposals import box_around, propose, rules_of, size_doubt, void_objects
from sim.houses.references import require_root


@dataclass(frozen=True, kw_only=True)
class Args:
    """Propose label rules for a scene from elsewhere, or check a file of them."""

    house: Path
    """The MJCF file."""
    root: Path | None = None
    """A folder whose files the house may use in addition to its own folder."""
    labels: Path | None = None
    """Check these label rules; by default, new ones are proposed."""
    out: cli.OutFile | None = None
    """Write the proposed rules to this file; an existing one is never overwritten."""
    picture: cli.OutPicture | None = None
    """Draw the labelled scene from above into this PNG file."""


@dataclass(frozen=True)
class Row:
    """One instance, or the geoms of one name without a category."""

    name: str
    category: str
    geoms: tuple[int, ...]


def main(args: Args) -> int:
    """Prints the table, and writes the rules and the picture; returns the exit status.

    Raises:
        ConfigError: the options contradict each other, or --out exists.
        HouseError: the scene cannot be read, or with --labels it is refused.
    """
    _check(args)
    house, model = _read(args)
    rules = rules_of(propose(model)) if args.labels is None else read_rules(args.labels)
    house = House(house.name, house.spec, rules, house.path)
    labels = read_labels(model, rules=rules, ignore_prefix="")
    console = display.make_console()
    say = functools.partial(console.print, soft_wrap=True)
    say(table_of(model, rows_of(model, labels)))
    for sentence in summary(labels):
        say(sentence)
    if args.out is not None:
        write_atomically(args.out, rules_text(rules))
        wrote = f"Wrote {counted(len(rules), 'rule')} to {args.out}."
        say(f"{wrote} Edit the categories, then check them with --labels.")
    if args.picture is not None:
        plain, coloured = draw_top(house), draw_top(house, colours=distinct_colours(labels.categories()))
        write_picture(args.picture, np.hstack([plain, coloured]))
        say(f"Drew {args.picture}.")
    if args.labels is None:
        _warn(say, house, model)
    else:
        load_house(args.house, labels_path=args.labels, root=args.root)
        say(f"'{args.house.stem}' can be used with these labels.")
    return 0


def rows_of(model: mujoco.MjModel, labels: Labels) -> list[Row]:
    """Returns the instances in the order of the categories, then the visible geoms without a label by their name."""
    rows = [Row(instance.name, instance.category, instance.geom_ids) for instance in labels.instances]
    rows.sort(key=lambda row: (MPCAT40.index(row.category), row.name))
    return rows + [Row(name, VOID, tuple(geoms)) for name, geoms in void_objects(model, labels).items()]


def table_of(model: mujoco.MjModel, rows: Sequence[Row]) -> Table:
    """Returns the table of names, categories and sizes."""
    data = data_at_rest(model)
    table = Table("name", "category", box=None)
    table.columns[0].overflow = "fold"
    for title in ("geoms", "size x y z (m)", "bottom, top (m)"):
        table.add_column(title, justify="right")
    table.add_column("doubt")
    for row in rows:
        low, high = box_around(model, data, row.geoms)
        size = " ".join(f"{side:.2f}" for side in high - low)
        doubt = size_doubt(row.category, high - low) or ("no label" if row.category == VOID else "")
        table.add_row(row.name, row.category, str(len(row.geoms)), size, f"{low[2]:.2f}, {high[2]:.2f}", doubt)
    return table


def summary(labels: Labels) -> list[str]:
    """Returns sentences on the goals of a scene and on what has no label."""
    goals = [name for name in labels.categories() if name in GOAL_CATEGORIES]
    sentence = (
        f"Goals: {', '.join(goals)}." if goals else "There is no goal: label one of " + ", ".join(GOAL_CATEGORIES) + "."
    )
    void = "1 visible geom has" if labels.void_geoms == 1 else f"{labels.void_geoms} visible geoms have"
    return [sentence, *([f"{void} no category (void)."] if labels.void_geoms else [])]


def rules_text(rules: Mapping[str, str]) -> str:
    """Returns the JSON file of label rules, the unknown names last."""
    ordered = sorted(rules.items(), key=lambda rule: rule[1] == VOID)
    return json.dumps(dict(ordered), indent=2, ensure_ascii=False) + "\n"


def _warn(say: Callable[[str], None], house: House, model: mujoco.MjModel) -> None:
    """Prints a warning if a run would refuse the scene with the proposed rules."""
    try:
        validate_house(house, model)
    except HouseError as error:
        say(f"WARNING: a run would refuse '{house.name}' with these labels: {error}")


def _check(args: Args) -> None:
    if args.labels is not None and args.out is not None:
        raise ConfigError("--out is for proposed rules; with --labels there are rules already.")
    if args.out is not None and args.out.exists():
        raise ConfigError(f"--out '{args.out}' exists; check it with --labels, or give another name.")


def _read(args: Args) -> tuple[House, mujoco.MjModel]:
    """Returns a scene without the elements that a house may not contain, and its compiled model."""
    if not args.house.is_file():
        raise HouseError(f"House '{args.house}': there is no such file.")
    require_root(args.root)
    try:
        spec = read_spec(args.house, root=args.root)
        remove_unsupported(spec)
        model = spec.compile()
        require_sizes(model)
    except (HouseError, ValueError) as error:
        raise HouseError(f"House '{args.house}': {' '.join(str(error).split())}") from None
    return House(args.house.stem, spec, {}, args.house), model
