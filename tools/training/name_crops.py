"""Asks a person for the categories of framed objects in labelled views, and compares the answers with a network's.

    python -m tools.training.name_crops --views runs/views_val --out runs/crops
    python -m tools.training.name_crops --views runs/views_val --out runs/crops --answers runs/crops/answers.txt

The first command writes sheets of numbered crops, `sheet_0.png` and on, with the same number of objects of each goal
category, without their names. The answers are a text file of one goal category for each crop, in the order of their
numbers. The second command reads them, and counts an answer of the network as right if its most frequent category in
the object's pixels is the true one.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import torch
from jaxtyping import Bool, UInt8

from sim.app import cli
from sim.app.commands.evaluate.segmentation import loader
from sim.app.composition.segmenters import weights_file
from sim.core.files import write_picture
from sim.core.interface import GOAL_CATEGORIES, MPCAT40, ConfigError
from sim.core.reading import read_bytes
from sim.training.segmentation.dataset import GOAL_IDS, LabelledView, list_shards, read_shard, stored_block_px, tile
from stubborn.segmentation.calibration import Calibration
from stubborn.segmentation.checkpoints import load_network
from stubborn.segmentation.preprocess import padding, shrink

CROP_PX, COLUMNS, ON_SHEET = 250, 6, 24
FRAME, NUMBER = (255, 0, 200), (255, 255, 0)
MIN_PX = 32
"""Smallest object: the square root of its area in pixels of the 640 x 480 image."""
MARGIN = 1.6
"""Side of a crop relative to the longer side of the object."""
MIN_SHARE = 1 / 6
"""Smallest side of a crop relative to the width of the image."""
MAX_BYTES = 1 << 20


@dataclass(frozen=True, kw_only=True)
class Args:
    """Show crops of objects to a person, or compare the person's answers with a network's."""

    views: Path
    """Folder of shards (`stubborn views`)."""
    out: cli.OutFolder
    """Folder of the sheets."""
    answers: Path | None = None
    """Text file of the answers."""
    weights: Path | None = None
    """Weights of the network; None: the shipped ones."""
    each: cli.Count = 6
    """Number of objects of each goal category."""
    seed: cli.Seed = 0
    """Seed of the choice."""


@dataclass(frozen=True)
class Crop:
    """An object that is shown."""

    category: str
    view: LabelledView
    inside: Bool[np.ndarray, "h w"]
    """Its pixels in the view as it is stored."""


def main(args: Args) -> int:
    """Writes the sheets, or prints the shares of right answers."""
    crops = choose(list_shards(args.views), args.each, args.seed)
    if args.answers is None:
        pictures = [draw(crop, number) for number, crop in enumerate(crops)]
        for first in range(0, len(pictures), ON_SHEET):
            file = args.out / f"sheet_{first // ON_SHEET}.png"
            write_picture(file, tile(pictures[first : first + ON_SHEET], COLUMNS))
        print(f"{len(crops)} crops in {args.out}. Categories: {' '.join(GOAL_CATEGORIES)}")
        return 0
    answers = read_answers(args.answers, len(crops))
    of_network = predict(crops, args)
    for number, (crop, answer, predicted) in enumerate(zip(crops, answers, of_network, strict=True)):
        if not crop.category == answer == predicted:
            print(f"{number}: {crop.category}, answer {answer}, network {predicted}")
    for name, names in (("answers", answers), ("network", of_network)):
        right = sum(crop.category == answered for crop, answered in zip(crops, names, strict=True))
        print(f"{name}: {right} of {len(crops)} right ({100 * right / len(crops):.0f} %)")
    return 0


def choose(shards: Sequence[Path], per_category: int, seed: int) -> list[Crop]:
    """Returns the same number of objects of each goal category, drawn at random, in a random order.

    Raises:
        ConfigError: no view shows an object of a goal category that is large enough.
    """
    rng, block_px = np.random.default_rng(seed), stored_block_px(shards)
    of_category: dict[str, list[tuple[float, Crop]]] = {name: [] for name in GOAL_CATEGORIES}
    for shard in shards:
        for view in read_shard(shard):
            for name, category in zip(GOAL_CATEGORIES, GOAL_IDS, strict=True):
                count, regions, stats, _ = cv2.connectedComponentsWithStats(
                    (view.semantic == category).astype(np.uint8)
                )
                for number in range(1, count):
                    if block_px * stats[number, cv2.CC_STAT_AREA] ** 0.5 >= MIN_PX:
                        drawn = float(rng.random()), Crop(name, view, regions == number)
                        of_category[name] = sorted([*of_category[name], drawn], key=lambda pair: pair[0])[:per_category]
    crops = [crop for name in GOAL_CATEGORIES for _, crop in of_category[name]]
    if not crops:
        raise ConfigError("No view shows an object of a goal category that is large enough.")
    return [crops[i] for i in rng.permutation(len(crops)).tolist()]


def draw(crop: Crop, number: int) -> UInt8[np.ndarray, "h w 3"]:
    """Returns the object with what is around it, framed and numbered."""
    left, top, width, height = cv2.boundingRect(crop.inside.astype(np.uint8))
    image = crop.view.rgb
    scale = image.shape[1] / crop.inside.shape[1]
    box = np.array([left, top, left + width, top + height]) * scale
    middle, longer = 0.5 * (box[:2] + box[2:]), float(np.max(box[2:] - box[:2]))
    side = min(max(round(MARGIN * longer), round(MIN_SHARE * image.shape[1])), image.shape[0])
    x, y = (int(np.clip(m - side / 2, 0, most - side)) for m, most in zip(middle, image.shape[1::-1], strict=True))
    picture = cv2.resize(image[y : y + side, x : x + side], (CROP_PX, CROP_PX), interpolation=cv2.INTER_CUBIC)
    x0, y0, x1, y1 = np.rint((box - [x, y, x, y]) * CROP_PX / side).astype(int).tolist()
    cv2.rectangle(picture, (x0, y0), (x1, y1), FRAME, 1)
    cv2.putText(picture, str(number), (4, 18), cv2.FONT_HERSHEY_SIMPLEX, 0.6, NUMBER, 2, cv2.LINE_AA)
    return picture.astype(np.uint8)


def read_answers(file: Path, count: int) -> list[str]:
    """Returns the words of a text file.

    Raises:
        ConfigError: there are more or fewer words than crops, or a word does not name a goal category.
    """
    words = read_bytes(file, what="Answers", most=MAX_BYTES).decode(errors="replace").split()
    if len(words) != count:
        raise ConfigError(f"'{file}' has {len(words)} answers for {count} crops.")
    for word in words:
        if word not in GOAL_CATEGORIES:
            raise ConfigError(f"'{file}': '{word}' is not a goal category.")
    return words


def predict(crops: Sequence[Crop], args: Args) -> list[str]:
    """Returns the most frequent category that a network, calibrated as agents use it, sees in each object's pixels.

    It is void for an object so thin that no pixel of the network's grid shows it.
    """
    torch.set_num_threads(1)
    model, metadata = load_network(weights_file(args.weights))
    calibration, block_px = Calibration.from_metadata(metadata), int(metadata.get("block_px", 1))
    stored_px = stored_block_px(list_shards(args.views))
    model.eval()
    categories: list[str] = []
    with torch.inference_mode():
        for rgb, second, _ in loader(model, [crop.view for crop in crops], block_px, stored_px):
            for channels in calibration.applied(model(rgb, second)).argmax(dim=1).numpy():
                inside = shrink(crops[len(categories)].inside.astype(np.uint8), block_px // stored_px).astype(bool)
                rows, cols = padding(*inside.shape).inner
                categories.append(
                    MPCAT40[int(np.bincount(channels[rows, cols][inside] + 1, minlength=len(MPCAT40)).argmax())]
                )
    return categories


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
