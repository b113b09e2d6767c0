"""Write the README of the shipped houses: format, counts, and a row a house.

python tools/describe_houses.py --out assets/mjcf_houses/README.md
"""

from __future__ import annotations

import collections
import hashlib
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from sim import cli
from sim.episodes import Split, load_split
from sim.houses.house import read_rooms
from sim.houses.labels import Labels, read_labels, rendered_geoms
from sim.interface import GOAL_CATEGORIES

SPLITS = ("val", "test")
HEAD = """# Apartments

Made by `tools/generate_houses.py` and `tools/make_episodes.py`; this page by `tools/describe_houses.py`. MIT licence,
like the rest of the repository: no scan, no model and no texture of anybody else is in here.

## A house file

- One standalone MJCF file without robot, camera and actuators; the ground storey's floor is at z = 0.
- A label is a name `<category>_<number>` (`chair_03`), its category from mpcat40. A geom's label is the first such name
  among the geom's, its body's and its body's ancestors'. A visible geom without one is refused.
- Geoms of group 3 and above are not rendered; alone they are invisible obstacles. Geoms with `contype` and
  `conaffinity` 0 are seen and not touched. Detailed furniture is drawn by such geoms and touched by a few blocks in
  group 3.
- A body with a free joint can be pushed: light chairs, stools, plants and gym things in every third house.
- Rooms are world sites of type box, `room_<kind>_<number>`. Textures lie in `textures/`, shared by all splits.
- Everything labelled floor carries wheels, with its own friction.

## Splits

Val and test houses draw styles, colours and textures from a pool that train houses (`pool="train"`) never show.
Episodes lie beside the houses in Habitat's ObjectNav layout (`val/val.json.gz`, `val/content/<house>.json.gz`; y up and
xyzw in the files only). Their order goes round the houses, then the goals, so that any first N are balanced.

A split carries a version, and every run names it with a hash over houses and episodes. It is raised whenever a house
or an episode changes: the last number when what an agent can do stays the same, the middle one when results can no
longer be compared. `traps` holds scenes of their own kind: see `docs/traps.md`.
"""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Where the page goes."""

    out: Path = Path("assets/mjcf_houses/README.md")
    """Markdown file, replaced."""


@dataclass(frozen=True)
class HouseFacts:
    """One row of the tables."""

    name: str
    area_m2: float
    rooms: int
    geoms: int
    drawn: int
    movable: int
    kilobytes: float
    sha256: str
    instances: collections.Counter[str]


def main(args: Args) -> int:
    """Write the page."""
    parts = [HEAD]
    for name in SPLITS:
        split = load_split(name)
        facts = [describe(split, house) for house in split.houses]
        parts += [f"## {name}\n", *_split_lines(split), _house_table(facts), _category_table(facts)]
    args.out.write_text("\n".join(parts), encoding="utf-8")
    print(f"{args.out}: {', '.join(SPLITS)}")
    return 0


def describe(split: Split, name: str) -> HouseFacts:
    """Load and count one house."""
    path = split.house_paths[name]
    model = split.load_house(name).spec.copy().compile()
    labels: Labels = read_labels(model)
    rooms = read_rooms(model)
    content = path.read_bytes()
    return HouseFacts(
        name=name,
        area_m2=sum(room.area_m2 for room in rooms),
        rooms=len(rooms),
        geoms=model.ngeom,
        drawn=int(rendered_geoms(model).sum()),
        movable=model.njnt,
        kilobytes=len(content) / 1000,
        sha256=hashlib.sha256(content).hexdigest()[:12],
        instances=collections.Counter(instance.category for instance in labels.instances),
    )


def _split_lines(split: Split) -> Iterator[str]:
    goals = collections.Counter(episode.goal for episode in split.episodes)
    yield f"Version {split.version}, {len(split.houses)} houses, {len(split.episodes)} episodes.\n"
    yield f"Episodes by goal: {', '.join(f'{goal} {goals[goal]}' for goal in GOAL_CATEGORIES)}.\n"


def _house_table(facts: Sequence[HouseFacts]) -> str:
    rows = ["| house | floor m2 | rooms | geoms | drawn | movable | KB | sha256 |", "|---|--:|--:|--:|--:|--:|--:|---|"]
    for f in facts:
        counts = f"{f.area_m2:.0f} | {f.rooms} | {f.geoms} | {f.drawn} | {f.movable} | {f.kilobytes:.0f}"
        rows.append(f"| {f.name} | {counts} | `{f.sha256}` |")
    return "\n".join(rows) + "\n"


def _category_table(facts: Sequence[HouseFacts]) -> str:
    """Instances of each goal category by house."""
    rows = [
        f"| | {' | '.join(f.name.rsplit('_', 1)[1] for f in facts)} | houses |",
        "|---|" + "--:|" * (len(facts) + 1),
    ]
    for category in GOAL_CATEGORIES:
        counts = [f.instances[category] for f in facts]
        cells = " | ".join(str(count) if count else "" for count in counts)
        rows.append(f"| {category} | {cells} | {sum(count > 0 for count in counts)} |")
    return "\n".join(rows) + "\n"


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
