"""Write the README of the shipped houses: format, counts, tables of houses and of categories, checksums.

    python tools/describe_houses.py --out assets/mjcf_houses/README.md
    LP_NUM_THREADS=1 python tools/describe_houses.py --measure 24

The second command adds what a frame of each val and test house costs; such columns differ from machine to machine, all
else is the same each time.
"""

from __future__ import annotations

import collections
import functools
import hashlib
import os
import platform
import statistics
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from sim import cli
from sim.env.scene import Scene
from sim.episodes.splits import UNREACHABLE_FILE, Split, load_split, read_unreachable
from sim.evaluation.parallel import ordered_map
from sim.geometry.pose import Pose
from sim.housegen.house_list import CACHE_VARIABLE
from sim.houses.house import read_rooms
from sim.houses.labels import Labels, read_labels, rendered_geoms
from sim.interface import GOAL_CATEGORIES, SENSORS, CameraModel, ConfigError
from sim.paths import assets_dir
from sim.robot.config import RobotConfig
from sim.sensors.opengl import describe_gl

SPLITS = ("val", "test", "train")
PROFILES = ("fast", "good")
WARM_UP = 2
"""Frames before the clock starts: the first ones upload textures."""
HEAD = f"""# Apartments

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
xyzw in the files only). Their order goes round the houses, then the goals, so that any first N are balanced. A start is
2 m to 30 m (geodesic) from its goal.

Train houses are not shipped as files: `train/houses.json` lists how each is made and the sha256 of its file. A house is
made when it is first needed (a second), compared with its checksum and kept under `~/.cache/stubborn-objectnav`, or
where `XDG_CACHE_HOME` or `{CACHE_VARIABLE}` say.

A goal instance that no place of the robot's free space reaches is no goal; `<split>/{UNREACHABLE_FILE}` names them, and
so does this page.

A split carries a version, and every run names it with a hash over houses and episodes. It is raised whenever a house
or an episode changes: the last number when what an agent can do stays the same, the middle one when results can no
longer be compared, the first when older code cannot read the files. `traps` holds scenes of their own kind: see
`docs/traps.md`.

```sh
python tools/generate_houses.py --split val --out assets/mjcf_houses/val --workers 2
python tools/make_episodes.py --split assets/mjcf_houses/val --episodes 1000 --workers 2
python tools/generate_houses.py --split test --out assets/mjcf_houses/test --workers 2
python tools/make_episodes.py --split assets/mjcf_houses/test --episodes 1000 --workers 2
python tools/generate_houses.py --split train --out assets/mjcf_houses/train --workers 2
python tools/make_episodes.py --split assets/mjcf_houses/train --episodes 2000 --view-points 2 --workers 2
```
"""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Describe the shipped houses on one page."""

    out: Path = Path("assets/mjcf_houses/README.md")
    """Markdown file, replaced."""
    root: Path | None = None
    """Folder that holds the folders of the splits; the shipped ones when not given."""
    measure: int = 0
    """Frames to time in each val and test house and profile; 0: none."""
    workers: int = 1
    """Processes that read houses; what is timed is timed in this one."""


@dataclass(frozen=True)
class Cost:
    """What the robot's views of one house take, and whether they show nothing somewhere."""

    ms: Mapping[str, float]
    """Median milliseconds a frame of all three sensors, by profile."""
    void: float
    """Share of pixels that are void."""


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
    cost: Cost | None = None


def main(args: Args) -> int:
    """Write the page."""
    if args.measure < 0 or args.workers < 1:
        raise ConfigError("--measure must be at least 0, --workers at least 1.")
    if args.measure:
        os.environ["LP_NUM_THREADS"] = "1"  # before the first context: llvmpipe reads it then
    root = args.root or assets_dir()
    names = [name for name in SPLITS if (root / name / f"{name}.json.gz").is_file()]
    splits = {name: _load(root / name) for name in names}
    facts = {name: describe_all(root / name, args) for name in names}
    parts = [HEAD, _summary_table(splits, facts), _category_houses_table(splits, facts)]
    if args.measure:
        parts.append(_measured_how(args.measure))
    for name in names:
        parts += [f"## {name}\n", *_split_lines(splits[name], read_unreachable(root / name))]
        if splits[name].house_list is None:
            parts += [_house_table(facts[name]), _category_table(facts[name])]
    args.out.write_text("\n".join(parts), encoding="utf-8")
    print(f"{args.out}: {', '.join(names)}")
    return 0


def describe_all(folder: Path, args: Args) -> list[HouseFacts]:
    """Every house of a split; those that are files are measured, when that is asked for."""
    split = _load(folder)
    described = list(ordered_map(functools.partial(_describe_in, folder), split.houses, workers=args.workers))
    if not args.measure or split.house_list is not None:
        return described
    return [replace(facts, cost=measure(split, facts.name, args.measure)) for facts in described]


def _describe_in(folder: Path, house: str) -> HouseFacts:
    return describe(_load(folder), house)


@functools.cache
def _load(folder: Path) -> Split:
    return load_split(folder)


def describe(split: Split, name: str) -> HouseFacts:
    """Load and count one house."""
    model = split.load_house(name).spec.copy().compile()
    labels: Labels = read_labels(model)
    rooms = read_rooms(model)
    content = split.house_file(name).read_bytes()
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


def measure(split: Split, name: str, frames: int) -> Cost:
    """Render all three sensors from random places of the free space, in each profile from the same ones."""
    ms: dict[str, float] = {}
    void = pixels = 0
    house = split.load_house(name)
    for profile in PROFILES:
        scene = Scene(house, robot=RobotConfig(), camera=CameraModel(), profile=profile)
        scene.world.reset(next(episode.start for episode in split.episodes if episode.house == name))
        space, rng = scene.task.truth.space(0.0), np.random.default_rng(0)
        cells, seconds = np.argwhere(space.free), []
        for _ in range(WARM_UP + frames):
            x_m, y_m = space.frame.to_metres(cells[rng.integers(len(cells))])
            pose = Pose(float(x_m), float(y_m), float(rng.uniform(-np.pi, np.pi)))
            began_s = time.perf_counter()
            images = scene.camera.render(scene.world.data, pose, SENSORS)
            seconds.append(time.perf_counter() - began_s)
            void += int((images["semantic"] == 0).sum())
            pixels += images["semantic"].size
        ms[profile] = 1000.0 * statistics.median(seconds[WARM_UP:])
        scene.close()
    return Cost(ms, void / pixels)


def _measured_how(frames: int) -> str:
    cpu = next(
        (line.split(":", 1)[1].strip() for line in _lines_of(Path("/proc/cpuinfo")) if line.startswith("model name")),
        platform.processor() or platform.machine(),
    )
    return (
        f"`fast` and `good` are milliseconds a frame in these rendering profiles (640 x 480; RGB, depth and "
        f"segmentation): the median of {frames} views from random places of the free space, one thread, on {cpu} with "
        f"{describe_gl()}, by `LP_NUM_THREADS=1 python tools/describe_houses.py --measure {frames}`. `void` is the "
        f"share of their pixels that show nothing labelled.\n"
    )


def _lines_of(file: Path) -> list[str]:
    return file.read_text(encoding="utf-8").splitlines() if file.is_file() else []


def _split_lines(split: Split, unreachable: Mapping[str, Sequence[str]]) -> Iterator[str]:
    goals = collections.Counter(episode.goal for episode in split.episodes)
    yield f"Version {split.version}, {len(split.houses)} houses, {len(split.episodes)} episodes.\n"
    yield f"Hash over houses and episodes, which runs name: `{split.sha256}`.\n"
    yield f"Episodes by goal: {', '.join(f'{goal} {goals[goal]}' for goal in GOAL_CATEGORIES)}.\n"
    listed = "; ".join(f"{house}: {', '.join(names)}" for house, names in unreachable.items())
    yield f"Out of the robot's reach, and so no goals: {listed or 'none'}.\n"
    if split.house_list is not None:
        made = ", ".join(f"{part} {there}" for part, there in split.house_list.made_with.items())
        yield f"Checksums of the houses are in `{split.name}/houses.json`; they were made with {made}.\n"


def _summary_table(splits: Mapping[str, Split], facts: Mapping[str, Sequence[HouseFacts]]) -> str:
    """A row a split: medians with the range."""
    rows = [
        "| split | houses | episodes | floor m2 | above 250 m2 | rooms | geoms | KB | with movables |",
        "|---|--:|--:|--:|--:|--:|--:|--:|--:|",
    ]
    for name, houses in facts.items():
        columns = [
            f"{len(houses)}",
            f"{len(splits[name].episodes)}",
            _spread([f.area_m2 for f in houses]),
            f"{sum(f.area_m2 > 250 for f in houses)}",
            _spread([f.rooms for f in houses]),
            _spread([f.geoms for f in houses]),
            _spread([f.kilobytes for f in houses]),
            f"{sum(f.movable > 0 for f in houses)}",
        ]
        rows.append(f"| {name} | {' | '.join(columns)} |")
    return "\n".join(["Median (smallest to largest); areas are those inside the walls:\n", *rows]) + "\n"


def _spread(values: Sequence[float]) -> str:
    return f"{statistics.median(values):.0f} ({min(values):.0f}-{max(values):.0f})"


def _category_houses_table(splits: Mapping[str, Split], facts: Mapping[str, Sequence[HouseFacts]]) -> str:
    """In how many houses each goal category stands, and in how many an episode asks for it."""
    names = list(facts)
    rows = [
        "Houses with each goal category, and houses in which an episode asks for it:\n",
        f"| category | {' | '.join(f'{name} | asked' for name in names)} |",
        "|---|" + "--:|" * (2 * len(names)),
    ]
    asked = {name: {(episode.house, episode.goal) for episode in splits[name].episodes} for name in names}
    for category in GOAL_CATEGORIES:
        cells = [
            f"{sum(f.instances[category] > 0 for f in facts[name])} | "
            f"{sum(goal == category for _, goal in asked[name])}"
            for name in names
        ]
        rows.append(f"| {category} | {' | '.join(cells)} |")
    return "\n".join(rows) + "\n"


def _house_table(facts: Sequence[HouseFacts]) -> str:
    measured = facts[0].cost is not None
    more, dashes = (" fast ms | good ms | void |", "--:|--:|--:|") if measured else ("", "")
    rows = [
        f"| house | floor m2 | rooms | geoms | drawn | movable | KB | sha256 |{more}",
        f"|---|--:|--:|--:|--:|--:|--:|---|{dashes}",
    ]
    for f in facts:
        counts = f"{f.area_m2:.0f} | {f.rooms} | {f.geoms} | {f.drawn} | {f.movable} | {f.kilobytes:.0f}"
        cost = f" {f.cost.ms['fast']:.1f} | {f.cost.ms['good']:.1f} | {f.cost.void:.2g} |" if f.cost else ""
        rows.append(f"| {f.name} | {counts} | `{f.sha256}` |{cost}")
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
