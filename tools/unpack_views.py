"""Unpacks shards of views into folders of PNG files, for training code that reads those.

python tools/unpack_views.py --views runs/views --out runs/views_png

Writes `rgb/<key>.png`, `depth/<key>.png` (uint16 millimetres), `semantic/<key>.png` (uint8 mpcat40 id; 0 is void) and
`record/<key>.json`. Existing views are kept, so that the same command continues a stopped run.
"""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from sim import cli
from sim.files import inside, write_atomically
from stubborn.segmentation.dataset import LabelledView, list_shards, read_shard


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
    for shard in list_shards(args.views):
        for view in read_shard(shard):
            _unpack(args.out, view)
            count += 1
    print(f"{count} views in {args.out}")
    return 0


def _unpack(out: Path, view: LabelledView) -> None:
    images = {
        "rgb": cv2.cvtColor(view.rgb, cv2.COLOR_RGB2BGR),
        "depth": np.rint(view.depth_m * 1000.0).astype(np.uint16),
        "semantic": view.semantic,
    }
    record = inside(out / "record", f"{view.key}.json", what="key of a view")
    if record.is_file():  # written last
        return
    for folder, image in images.items():
        file = inside(out / folder, f"{view.key}.png", what="key of a view")
        write_atomically(file, cv2.imencode(".png", image)[1].tobytes())
    write_atomically(record, json.dumps(view.record, sort_keys=True))


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
