"""Reads labelled views with `webdataset`, as they were stored: depth stays uint16 millimetres.

python examples/read_views.py views/views-000000.tar

`.decode("rgb8")` of webdataset takes every PNG file for a colour image, so that depth becomes 8 bits in three channels;
`decode_member` is the decoder for our members.
"""

import sys
from collections.abc import Iterator
from typing import Any

import webdataset

from sim.training.segmentation.dataset import decode_member


def read_with_webdataset(shards: str) -> Iterator[dict[str, Any]]:
    """Yields the views of shards, for example of `views/views-{000000..000399}.tar`, as dicts of arrays by member."""
    files = webdataset.WebDataset(shards, shardshuffle=False)  # pyright: ignore[reportAttributeAccessIssue] - no stub
    yield from files.decode(decode_member)


if __name__ == "__main__":
    for view in read_with_webdataset(sys.argv[1]):
        depth_m = view["depth.png"] / 1000.0
        print(f"{view['__key__']}: {view['json']['house']}, nearest {depth_m[depth_m > 0].min():.2f} m")
