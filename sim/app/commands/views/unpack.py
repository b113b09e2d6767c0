"""Unpacks shards of views into folders of PNG files, for training code that reads those.

stubborn views unpack --views runs/views --out runs/views_png

Writes `rgb/<key>.png`, `depth/<key>.png` (uint16 millimetres), `semantic/<key>.png` (uint8 mpcat40 id; 0 is void) and
`record/<key>.json`; if the views have them also `instances/<key>.png` (uint16), `normals/<key>.png` and one file
`coco.json` with the boxes and masks of all views. Existing views are kept, so that the same command continues a
stopped run.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.app import cli
from sim.core.files import inside, write_atomically
from sim.core.vocabulary import counted
from sim.training.segmentation.dataset import LabelledView, list_shards, read_shard
from sim.training.views.coco import CATEGORIES
from sim.training.views.normals import encode_normals


@dataclass(frozen=True, kw_only=True)
class Args:
    """Unpack shards of views into PNG files."""

    views: Path
    """Folder of shards."""
    out: cli.OutFolder
    """Folder for the PNG files; it is created."""


def main(args: Args) -> int:
    """Unpacks every shard and prints the number of views."""
    count = 0
    images: list[dict[str, object]] = []
    objects: list[dict[str, object]] = []
    for shard in list_shards(args.views):
        for view in read_shard(shard):
            _unpack(args.out, view)
            count += 1
            if view.annotations is not None:
                images.append(_coco_image(view, count))
                objects += [
                    {**annotation, "id": len(objects) + i, "image_id": count, "instance_id": annotation.get("id")}
                    for i, annotation in enumerate(view.annotations, start=1)
                ]
    if images:
        coco = {"images": images, "annotations": objects, "categories": CATEGORIES}
        write_atomically(args.out / "coco.json", json.dumps(coco))
        print(f"{counted(len(objects), 'object')} in {args.out / 'coco.json'}")
    print(f"{counted(count, 'view')} in {args.out}")
    return 0


def _coco_image(view: LabelledView, number: int) -> dict[str, object]:
    height, width = view.semantic.shape
    return {"id": number, "file_name": f"rgb/{view.key}.png", "width": width, "height": height}


def _unpack(out: Path, view: LabelledView) -> None:
    images: dict[str, NDArray] = {
        "rgb": cv2.cvtColor(view.rgb, cv2.COLOR_RGB2BGR),
        "depth": np.rint(view.depth_m * 1000.0).astype(np.uint16),
        "semantic": view.semantic,
    }
    if view.instances is not None:
        images["instances"] = view.instances
    if view.normals is not None:
        levels = encode_normals(view.normals)
        images["normals"] = cv2.cvtColor(levels, cv2.COLOR_RGB2BGR)
    record = inside(out / "record", f"{view.key}.json", what="key of a view")
    if record.is_file():  # written last
        return
    for folder, image in images.items():
        file = inside(out / folder, f"{view.key}.png", what="key of a view")
        write_atomically(file, cv2.imencode(".png", image)[1].tobytes())
    write_atomically(record, json.dumps(view.record, sort_keys=True))
