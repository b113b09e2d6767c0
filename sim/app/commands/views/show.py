"""Draws a sheet of random views from shards: colour, depth and labels side by side.

stubborn views show --views runs/views --out runs/views.png

Views that hold them (`--extras` of `stubborn views`) have two more pictures: objects with their masks and boxes,
and surface normals as colours (right red, down green, away from the camera blue).
"""

from __future__ import annotations

import colorsys
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.app import cli
from sim.app.viewers.palette import with_legend
from sim.app.viewers.text import write
from sim.core.files import write_picture
from sim.core.pictures import tiled
from sim.core.vocabulary import counted
from sim.training.segmentation.dataset import LabelledView, list_shards, read_shard
from sim.training.views.coco import decode_mask
from sim.training.views.normals import encode_normals

WIDTH_PX = 400
NO_RETURN_RGB = (150, 40, 40)
"""Colour of depth 0: no return, or nearer than the sensor measures."""
NAME_PX = 12


@dataclass(frozen=True, kw_only=True)
class Args:
    """Draw a sheet of random views."""

    views: Path
    """Folder of shards."""
    out: cli.OutPicture
    """The picture, a .png or .jpg file."""
    count: cli.Count = 12
    """Number of views."""
    seed: cli.Seed = 0
    """Seed of the choice of views."""


def main(args: Args) -> int:
    """Draws the sheet and prints its path."""
    rng = np.random.default_rng(args.seed)
    shards = list_shards(args.views)
    picked = [shards[i] for i in rng.permutation(len(shards))[: args.count]]
    views: list[LabelledView] = []
    for number, shard in enumerate(picked):
        in_shard = list(read_shard(shard))
        share = -(-(args.count - len(views)) // (len(picked) - number))
        views += [in_shard[i] for i in rng.permutation(len(in_shard))[:share]]
    rows = [draw(view) for view in views]
    write_picture(args.out, tiled(rows, columns=2 if rows and rows[0].shape[1] <= 3 * WIDTH_PX else 1))
    print(f"{counted(len(views), 'view')} in {args.out}")
    return 0


def draw(view: LabelledView) -> NDArray[np.uint8]:
    """Returns an image of colour, depth (near is bright, no return is red) and labels, objects and normals."""
    near = 255.0 - 230.0 * view.depth_m / max(float(view.depth_m.max()), 0.1)
    grey = cv2.cvtColor(near.astype(np.uint8), cv2.COLOR_GRAY2RGB)
    grey[view.depth_m == 0.0] = NO_RETURN_RGB
    size_px = WIDTH_PX, round(WIDTH_PX * view.rgb.shape[0] / view.rgb.shape[1])
    labels = cv2.resize(view.semantic, size_px, interpolation=cv2.INTER_NEAREST)
    panels = [cv2.resize(panel, size_px, interpolation=cv2.INTER_AREA) for panel in (view.rgb, grey)]
    panels.append(with_legend(labels.astype(np.uint8)))
    if view.annotations is not None:
        panels.append(_objects(view, panels[0]))
    if view.normals is not None:
        levels = encode_normals(view.normals)
        panels.append(cv2.resize(levels, size_px, interpolation=cv2.INTER_NEAREST))
    return np.hstack(panels, dtype=np.uint8)


def _objects(view: LabelledView, colour: NDArray) -> NDArray[np.uint8]:
    """Returns the colour image (h, w, 3) with the masks and boxes of the view's objects; large ones are named."""
    scale, picture = colour.shape[1] / view.rgb.shape[1], colour.copy()
    for number, annotation in enumerate(sorted(view.annotations or [], key=lambda annotation: -annotation["area"])):
        tint = np.rint(255.0 * np.array(colorsys.hsv_to_rgb(0.618 * number % 1.0, 0.8, 1.0)))
        mask = decode_mask(annotation["segmentation"]).astype(np.uint8)
        inside = cv2.resize(mask, colour.shape[1::-1], interpolation=cv2.INTER_NEAREST) > 0
        picture[inside] = (0.5 * picture[inside] + 0.5 * tint).astype(np.uint8)
        left, top, width, height = (round(scale * value) for value in annotation["bbox"])
        cv2.rectangle(picture, (left, top), (left + width - 1, top + height - 1), tint.tolist(), 1)
        if width >= 30:
            base = (left + 2, max(top + NAME_PX, NAME_PX))
            write(picture, annotation["name"], base, width_px=width, size_px=NAME_PX, colour=(255, 255, 255))
    return np.asarray(picture, np.uint8)
