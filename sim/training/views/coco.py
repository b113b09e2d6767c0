"""Objects of a view in the format of COCO: boxes and run-length encoded masks from an image of instances.

The format is that of `pycocotools` and of the libraries that read its files (https://cocodataset.org/#format-data).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import msgspec
import numpy as np
from numpy.typing import NDArray

from sim.core.interface import MPCAT40, MPCAT40_ID, ConfigError
from sim.core.pictures import MAX_PIXELS
from sim.core.reading import Count, convert
from sim.houses.labels import Instance

STUFF: tuple[str, ...] = ("void", "wall", "floor", "ceiling")
"""Categories that are surfaces and not objects: they have pixels in the image of instances, but no annotation."""
DESCRIBED_SHARE = 0.01
"""Share of the pixels from which an object is described."""
CATEGORIES: tuple[dict[str, object], ...] = tuple(
    {"id": i, "name": name} for i, name in enumerate(MPCAT40) if name not in STUFF
)
"""The categories of COCO files; their ids are those of mpcat40."""


class MaskRuns(msgspec.Struct):
    """The run-length encoded mask of an object."""

    size: tuple[Count, Count]
    counts: list[Count]


def annotate(
    instance_ids: NDArray[np.uint16],
    instances: Sequence[Instance],
    styles: Mapping[str, str] | None = None,
    names: Mapping[str, str] | None = None,
    describe: Callable[[str], str | None] | None = None,
) -> list[dict[str, object]]:
    """Returns an annotation for each visible object of a view, without the id of the image.

    Args:
        instance_ids: (h, w) number of the instance of each pixel, from 1; 0: none.
        instances: the instances of the house; number `n` is `instances[n - 1]`.
        styles: style of each instance by its name; None: they are not known.
        names: everyday name of each instance by its name, where the house file says it.
        describe: returns a text that fits only the instance with a name, or None; None: there are no texts.

    Returns:
        For each object `id` (its number), `name`, `category_id` (mpcat40), `bbox` (x, y, width and height in pixels),
        `area` (visible pixels), `iscrowd` 0 and `segmentation`, a run-length encoded mask. Where they are known, it has
        `style`, `everyday_name` and, with `DESCRIBED_SHARE` of the pixels, `description`.
    """
    annotations = []
    for number in np.unique(instance_ids[instance_ids > 0]).tolist():
        instance = instances[number - 1]
        if instance.category in STUFF:
            continue
        mask = instance_ids == number
        area = int(mask.sum())
        text = describe(instance.name) if describe and area >= DESCRIBED_SHARE * mask.size else None
        annotations.append(
            {
                "id": number,
                "name": instance.name,
                "category_id": MPCAT40_ID[instance.category],
                "bbox": bounding_box(mask),
                "area": area,
                "iscrowd": 0,
                "segmentation": encode_mask(mask),
            }
            | ({"style": styles[instance.name]} if styles and instance.name in styles else {})
            | ({"everyday_name": names[instance.name]} if names and instance.name in names else {})
            | ({} if text is None else {"description": text})
        )
    return annotations


def bounding_box(mask: NDArray[np.bool_]) -> list[int]:
    """Returns the column and row of the corner of a mask (h, w) that is not empty, its width and its height, pixels."""
    rows, cols = (np.flatnonzero(mask.any(axis=axis)) for axis in (1, 0))
    top, left = int(rows[0]), int(cols[0])
    return [left, top, int(cols[-1]) - left + 1, int(rows[-1]) - top + 1]


def encode_mask(mask: NDArray[np.bool_]) -> dict[str, list[int]]:
    """Returns a mask (h, w) as COCO's uncompressed runs: column by column, first the number of pixels outside."""
    flat = mask.ravel(order="F")
    ends = np.flatnonzero(flat[1:] != flat[:-1]) + 1
    counts = np.diff(np.concatenate(([0], ends, [flat.size]))).tolist()
    return {"size": [*mask.shape], "counts": [0, *counts] if flat[0] else counts}


def decode_mask(segmentation: Mapping[str, Sequence[int]]) -> NDArray[np.bool_]:
    """Returns the mask (h, w) from the run lengths that `encode_mask` returns.

    Raises:
        ConfigError: `size` or `counts` is missing, is not a list of whole numbers from 0 on, or they contradict.
    """
    runs = convert(dict(segmentation), MaskRuns, where="The mask of an object")
    (height, width), total = runs.size, sum(runs.counts)
    if total != height * width or total > MAX_PIXELS:
        raise ConfigError(
            f"The mask of an object has runs of {total} pixels for an image of {width} x {height}; at most "
            f"{MAX_PIXELS // 1_000_000} million pixels are allowed."
        )
    inside = np.arange(len(runs.counts)) % 2 == 1
    return np.repeat(inside, np.array(runs.counts, np.int64)).reshape((height, width), order="F")
