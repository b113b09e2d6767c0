"""Measures how well a detector that others trained on photographs recognises the furniture of rendered views.

    npm install --prefix runs/eye @vladmandic/human@3.3.6 @tensorflow/tfjs@4.22.0 @tensorflow/tfjs-backend-wasm@4.22.0
    python -m tools.research.external_eye --detector runs/eye --split val --views 600 --out runs/eye_val
    python -m tools.research.external_eye --detector runs/eye --split val --made --like runs/eye_val --out runs/eye_new

The detector is the CenterNet of `@vladmandic/human` (80 classes of COCO), which runs in Node.js. Objects count if their
visible box covers 1 % of the picture and at least half of their silhouette is visible. The table has precision and
recall with 95 % intervals from a bootstrap over houses. `--like` renders the poses of an earlier run again, for example
after a change of the furniture, and adds the paired difference of recall. `--aim` looks at objects of the eight
categories from 1 to 3.5 m, which gives more of the rare ones. `sheets/` holds pictures of the objects that were missed
and of the detections that are false.
"""

from __future__ import annotations

import collections
import itertools
import json
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from rich.table import Table

from sim.app import cli
from sim.app.analysis import display
from sim.app.services.words import COCO as CLASSES
from sim.core.errors import ConfigError
from sim.core.files import write_atomically, write_picture
from sim.core.geometry.pose import Pose
from sim.core.interface import CameraModel
from sim.core.pictures import tiled
from sim.core.reading import read_json
from sim.env.scene import Scene
from sim.episodes.splits import load_split
from sim.homes.housegen.splits.recipes import SPLITS, train_recipe
from sim.houses.house import House
from sim.houses.labels import rendered_geoms
from sim.robot.config import RobotConfig
from sim.training.views.aimed import aimed_poses
from sim.training.views.coco import bounding_box
from sim.training.views.poses import mixed_poses
from sim.training.views.views import is_bare, start_world
from tools.research.external_eye_scores import (
    Box,
    Detection,
    Truth,
    match,
    paired_difference,
    share_with_interval,
    whole_px,
)

COCO: Mapping[int, str] = MappingProxyType(
    {56: "chair", 57: "couch", 58: "potted plant", 59: "bed", 60: "dining table", 61: "toilet", 62: "tv", 71: "sink"}
)
"""Names of the classes by their number, from 0."""
ALIASES: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {"chair": ("stool", "seating"), "couch": ("seating",), "dining table": ("counter",)}
)
"""Our categories that a class of the detector may name too: COCO has no class of their own for them."""
SCORES = (0.25, 0.15)
MIN_BOX_SHARE = 0.01
"""Share of the picture that the visible box of an object that counts must cover."""
MIN_VISIBLE = 0.5
"""Share of the silhouette of an object that counts which must be visible."""
FRAME_PX = 512
"""Side of the detector's square frames."""
FILES = ("node_modules/@vladmandic/human/models/centernet.json", "node_modules/@tensorflow/tfjs/package.json",
         "node_modules/@tensorflow/tfjs-backend-wasm/package.json")  # fmt: skip
TILES, TILE_PX = (6, 4), 240
"""Columns and rows of a sheet, and the side of a tile."""
Tile = NDArray[np.uint8]
VIEWS_FILE = "views.json"
_TRIES = 40


@dataclass(frozen=True, kw_only=True)
class Args:
    """Measure how well a detector that was trained on photographs recognises our furniture."""

    detector: Path
    """Folder in which npm installed `@vladmandic/human` and the two packages of tfjs."""
    out: cli.OutFolder
    """Folder of views.json, table.json (by class and by style) and the sheets."""
    split: str = "val"
    """Houses of a shipped split, or of a folder with the same layout."""
    made: bool = False
    """Generate the houses of the split's recipes with the present code, in place of the shipped files."""
    houses: cli.Count = 30
    """Number of houses: the first ones of the split."""
    views: cli.Count = 600
    """Number of views of all houses."""
    seed: cli.Seed = 0
    """Seed of the poses."""
    aim: bool = False
    """Aim the camera at objects of the detector's categories, all categories equally often."""
    like: Path | None = None
    """Folder of an earlier run: its poses are rendered again, and its results are compared."""
    profile: str = "good"
    """Rendering quality: good or fast."""


@dataclass(frozen=True)
class SeenView:
    """One view with its objects and the detections."""

    house: str
    pose: Pose
    truths: tuple[Truth, ...]
    detections: tuple[Detection, ...]


def main(args: Args) -> int:
    """Renders the views, runs the detector, writes the results and prints the table; returns the exit status."""
    earlier = None if args.like is None else read_views(args.like)
    views, tiles = [], collections.defaultdict[str, list[Tile]](list)
    known = None if earlier is None else {view.house for view in earlier}
    with Detector(args.detector) as detector:
        for house, scene, styles in _scenes(args, known):
            for pose, image, truths in _labelled(args, scene, house, styles, earlier):
                view = SeenView(house, pose, truths, tuple(detector.detect(image)))
                views.append(view)
                for truth in missed(view):
                    text = f"{truth.style or truth.name} {truth.visible_share:.2f}"
                    tiles[f"missed_{truth.category}"].append(_tile(image, truth.box, text))
                for found in false_detections(view):
                    text = f"{found.category} {found.score:.2f}"
                    tiles[f"false_{found.category}"].append(_tile(image, found.box, text))
            print(f"{house}: {len(views)} views", file=sys.stderr, flush=True)
    args.out.mkdir(parents=True, exist_ok=True)
    write_atomically(args.out / VIEWS_FILE, json.dumps([asdict(view) for view in views]).encode())
    rows = [row for score in SCORES for row in scores(views, score)]
    if earlier is not None:
        rows = [row | difference(earlier, views, row["category"], row["score"]) for row in rows]
    tables = {"classes": rows, "styles": [row for score in SCORES for row in by_style(views, score)]}
    write_atomically(args.out / "table.json", (json.dumps(tables, indent=1) + "\n").encode())
    write_sheets(args.out / "sheets", tiles)
    _print(rows)
    return 0


class Detector:
    """The detector in a process of Node.js, as a context manager."""

    def __init__(self, folder: Path) -> None:
        node = shutil.which("node")
        if node is None:
            raise ConfigError("The detector needs Node.js 18 or newer: there is no program 'node' on the PATH.")
        missing = [name for name in FILES if not (folder / name).is_file()]
        if missing:
            raise ConfigError(
                f"--detector '{folder}' has no '{missing[0]}'. Install the packages with: npm install --prefix "
                f"'{folder}' @vladmandic/human@3.3.6 @tensorflow/tfjs@4.22.0 @tensorflow/tfjs-backend-wasm@4.22.0"
            )
        script = Path(__file__).with_suffix(".js")
        self._said = tempfile.TemporaryFile()  # noqa: SIM115 - an unread pipe would block the process
        self._process = subprocess.Popen(
            [node, str(script), str(folder)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self._said
        )

    def __enter__(self) -> Detector:
        return self

    def __exit__(self, *_: object) -> None:
        self._process.kill()
        self._process.communicate()
        self._said.close()

    def detect(self, image: NDArray[np.uint8]) -> list[Detection]:
        """Returns the boxes in an image (h, w, 3) whose class is one of ours, in its pixels.

        Raises:
            ConfigError: the process ended.
        """
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        frame = cv2.resize(image, (FRAME_PX, FRAME_PX), interpolation=cv2.INTER_LINEAR)
        line = b""
        try:
            self._process.stdin.write(frame.tobytes())
            self._process.stdin.flush()
            line = self._process.stdout.readline()
        except BrokenPipeError:
            pass
        if not line:
            self._said.seek(0)
            words = self._said.read().decode(errors="replace").strip().splitlines()
            raise ConfigError(f"The detector ended without a reply: {words[-1] if words else 'it said nothing'}.")
        scale = np.array([image.shape[1], image.shape[0]] * 2) / FRAME_PX
        rows = [(np.array(row[:4]) * scale, row[4], int(row[5])) for row in json.loads(line)]
        return [
            Detection(COCO[number], tuple(box.round(1).tolist()), round(score, 3))
            for box, score, number in rows
            if number in COCO
        ]


def _scenes(args: Args, known: Collection[str] | None) -> Iterator[tuple[str, Scene, Mapping[str, str]]]:
    """Yields the houses with their scenes, and the styles of their instances where they are generated here.

    With `known`, houses of other names are left out.
    """
    for name, house, styles in _houses(args, known):
        scene = Scene(house, robot=RobotConfig(), camera=CameraModel(), profile=args.profile)
        try:
            yield name, scene, styles
        finally:
            scene.close()


def _houses(args: Args, known: Collection[str] | None) -> Iterator[tuple[str, House, Mapping[str, str]]]:
    if not args.made:
        split = load_split(args.split)
        for name in split.houses[: args.houses]:
            if known is not None and name not in known:
                continue
            yield name, split.load_house(name), {}
        return
    if args.split != "train" and args.split not in SPLITS:
        raise ConfigError(f"--made needs one of the splits train, {', '.join(SPLITS)}, got '{args.split}'.")
    recipes = [train_recipe(seed) for seed in range(args.houses)] if args.split == "train" else SPLITS[args.split]
    for recipe in recipes[: args.houses]:
        if known is not None and recipe.name not in known:
            continue
        made = recipe.make()
        yield recipe.name, House(recipe.name, made.spec), made.styles


def _labelled(
    args: Args, scene: Scene, house: str, styles: Mapping[str, str], earlier: Sequence[SeenView] | None
) -> Iterator[tuple[Pose, NDArray[np.uint8], tuple[Truth, ...]]]:
    """Yields the views of a house: pose, colour (h, w, 3) and objects."""
    space = scene.task.truth.space(0.0)
    cells = np.argwhere(space.largest_part())
    rng = np.random.default_rng([args.seed, *house.encode()])
    start_world(scene, space, cells, rng)
    if earlier is not None:
        poses = iter([view.pose for view in earlier if view.house == house])
    else:
        weights = dict.fromkeys(CLASSES, 1.0)
        drawn = aimed_poses(scene.world, space, cells, rng, weights) if args.aim else mixed_poses(space, cells, rng)
        poses = (pose for pose, _ in itertools.islice(drawn, _TRIES * args.views))
    wanted = -(-args.views // args.houses)
    taken = 0
    for pose in poses:
        images = scene.camera.render(scene.world.data, pose, ("rgb", "depth", "semantic", "geom"))
        if earlier is None and is_bare(images["semantic"], images["depth"]):
            continue
        yield pose, images["rgb"], _truths(scene, pose, images["geom"], styles)
        taken += 1
        if earlier is None and taken == wanted:
            return


def _truths(scene: Scene, pose: Pose, geom: NDArray[np.int32], styles: Mapping[str, str]) -> tuple[Truth, ...]:
    """Returns the visible objects of a view whose category is one of `CLASSES` or `ALIASES`."""
    model, labels, camera = scene.world.model, scene.world.labels, scene.camera.camera
    owner = np.append(labels.geom_instance, -1)[geom]  # geom -1 takes the last
    rendered = rendered_geoms(model)
    others = {name for names in ALIASES.values() for name in names}
    truths = []
    for number in np.unique(owner[owner >= 0]).tolist():
        instance = labels.instances[number]
        if instance.category not in CLASSES and instance.category not in others:
            continue
        mask = owner == number
        x, y, wide, high = bounding_box(mask)
        large = wide * high > MIN_BOX_SHARE * mask.size
        share = 0.0
        if large and instance.category in CLASSES:
            geoms = [geom for geom in instance.geom_ids if rendered[geom]]
            share = float(mask.sum()) / max(whole_px(model, scene.world.data, geoms, pose, camera), 1.0)
        category = CLASSES.get(instance.category, instance.category)
        box = (float(x), float(y), float(x + wide), float(y + high))
        style = styles.get(instance.name, "")
        truths.append(Truth(instance.name, category, box, share >= MIN_VISIBLE, round(share, 3), style))
    return tuple(truths)


def scores(views: Sequence[SeenView], score: float) -> list[dict[str, Any]]:
    """Returns a row for each class: objects, found, false detections, precision and recall with intervals."""
    names = (*CLASSES.values(), "all")
    count: dict[str, dict[str, collections.Counter[str]]] = {
        name: {kind: collections.Counter() for kind in ("objects", "found", "right", "detections")} for name in names
    }
    for view in views:
        detections = [detection for detection in view.detections if detection.score >= score]
        found, right = match(view.truths, detections, ALIASES)
        for truth, hit in zip(view.truths, found, strict=True):
            for name in (truth.category, "all") if truth.counted else ():
                count[name]["objects"][view.house] += 1
                count[name]["found"][view.house] += hit
        for detection, correct in zip(detections, right, strict=True):
            for name in () if correct is None else (detection.category, "all"):
                count[name]["detections"][view.house] += 1
                count[name]["right"][view.house] += bool(correct)
    return [
        {
            "category": name,
            "score": score,
            **{kind: sum(by_house.values()) for kind, by_house in count[name].items()},
            "recall": share_with_interval(count[name]["found"], count[name]["objects"]),
            "precision": share_with_interval(count[name]["right"], count[name]["detections"]),
        }
        for name in names
    ]


def by_style(views: Sequence[SeenView], score: float) -> list[dict[str, Any]]:
    """Returns a row for each style of each class: objects that count, and how many are found."""
    objects, hits = collections.Counter[tuple[str, str]](), collections.Counter[tuple[str, str]]()
    for view in views:
        found, _ = match(view.truths, [each for each in view.detections if each.score >= score], ALIASES)
        for truth, hit in zip(view.truths, found, strict=True):
            if truth.counted:
                objects[truth.category, truth.style] += 1
                hits[truth.category, truth.style] += hit
    return [
        {"category": category, "style": style, "score": score, "objects": count, "found": hits[category, style]}
        for (category, style), count in sorted(objects.items())
    ]


def difference(before: Sequence[SeenView], after: Sequence[SeenView], category: str, score: float) -> dict[str, Any]:
    """Returns the paired difference of recall for the objects that count in the same view of both runs."""
    old, new = (_found_by_object(views, category, score) for views in (before, after))
    both = old.keys() & new.keys()
    of, was, now = (collections.Counter[str]() for _ in range(3))
    for key in both:
        of[key[0]] += 1
        was[key[0]] += old[key]
        now[key[0]] += new[key]
    return {
        "paired_objects": len(both),
        "found_before": sum(was.values()),
        "found_after": sum(now.values()),
        "recall_difference": paired_difference(was, now, of),
    }


def _found_by_object(views: Sequence[SeenView], category: str, score: float) -> dict[tuple[str, str, str], bool]:
    """Returns whether each object that counts is found, by house, pose and name."""
    by_object = {}
    for view in views:
        found, _ = match(view.truths, [each for each in view.detections if each.score >= score], ALIASES)
        for truth, hit in zip(view.truths, found, strict=True):
            if truth.counted and category in (truth.category, "all"):
                by_object[view.house, str(view.pose), truth.name] = hit
    return by_object


def missed(view: SeenView) -> list[Truth]:
    """Returns the objects of a view that count and are not found at the lower score."""
    found, _ = match(view.truths, [each for each in view.detections if each.score >= min(SCORES)], ALIASES)
    return [truth for truth, hit in zip(view.truths, found, strict=True) if truth.counted and not hit]


def false_detections(view: SeenView) -> list[Detection]:
    """Returns the detections of a view that are false at the higher score."""
    detections = [found for found in view.detections if found.score >= max(SCORES)]
    _, right = match(view.truths, detections, ALIASES)
    return [found for found, correct in zip(detections, right, strict=True) if correct is False]


def read_views(folder: Path) -> list[SeenView]:
    """Returns the views of an earlier run.

    Raises:
        ConfigError: the folder has no such file, or it is not one of this tool.
    """
    return read_json(folder / VIEWS_FILE, list[SeenView], what="Views of an earlier run")


def write_sheets(folder: Path, tiles: Mapping[str, Sequence[Tile]]) -> None:
    """Writes a sheet NAME.png for each name, of tiles that are spread over all views."""
    folder.mkdir(parents=True, exist_ok=True)
    columns, rows = TILES
    for name, of_name in tiles.items():
        spread = np.linspace(0, len(of_name) - 1, min(columns * rows, len(of_name))).round().astype(int)
        write_picture(folder / f"{name.replace(' ', '_')}.png", tiled([of_name[i] for i in spread], columns))


def _tile(image: NDArray[np.uint8], box: Box, text: str) -> Tile:
    """Returns a square part of a view around a box, with the box and a text."""
    height, width = image.shape[:2]
    x0, y0, x1, y1 = box
    side = int(min(max(1.5 * max(x1 - x0, y1 - y0), 120), height))
    left = int(np.clip(0.5 * (x0 + x1 - side), 0, width - side))
    top = int(np.clip(0.5 * (y0 + y1 - side), 0, height - side))
    tile = cv2.resize(image[top : top + side, left : left + side], (TILE_PX, TILE_PX), interpolation=cv2.INTER_AREA)
    scale = TILE_PX / side
    low = int((x0 - left) * scale), int((y0 - top) * scale)
    high = int((x1 - left) * scale) - 1, int((y1 - top) * scale) - 1
    cv2.rectangle(tile, low, high, (255, 0, 0), 1)
    cv2.putText(tile, text, (3, TILE_PX - 5), cv2.FONT_HERSHEY_SIMPLEX, 0.42, (255, 255, 0), 1, cv2.LINE_AA)
    return np.asarray(tile, np.uint8)


def _print(rows: Sequence[Mapping[str, Any]]) -> None:
    paired = ("recall, paired",) if "paired_objects" in rows[0] else ()
    table = Table("class", "score", "found", "recall", "false", "precision", *paired)
    for row in rows:
        cells = [
            row["category"], f"{row['score']}", f"{row['found']} of {row['objects']}", _interval(row["recall"]),
            str(row["detections"] - row["right"]), _interval(row["precision"]),
        ]  # fmt: skip
        if paired:
            change = f"{row['found_before']} -> {row['found_after']} of {row['paired_objects']}"
            cells.append(f"{change}: {_interval(row['recall_difference'])}")
        table.add_row(*cells)
    display.make_console().print(table)


def _interval(values: Sequence[float]) -> str:
    return "{:.2f} ({:.2f} to {:.2f})".format(*values)


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
