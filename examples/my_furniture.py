"""Furniture of your own: a stool made of a crate, and an apartment with such stools.

python examples/my_furniture.py my_house.xml
"""

import os
import sys
from pathlib import Path

from sim.housegen import generate
from sim.housegen.furniture import CATALOGUE
from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.workbench import Workbench
from sim.houses.writing import house_text
from sim.paths import assets_dir


def crate(w: Workbench) -> None:
    """An open crate stood on its end: two sides, bottom and seat, a slatted back."""
    w.mass_kg = 4.0  # light: it may be made movable
    high, wide, deep = w.height(0.42, 0.46), w.width(0.34, 0.40), w.depth(0.30, 0.34)
    wood, board, slats = w.look("wood"), 0.02, 4
    x, y = (-deep / 2, deep / 2), (-wide / 2, wide / 2)
    for side in (y[0], y[1] - board):
        w.box(x, (side, side + board), (0.0, high), wood)
    for bottom in (0.0, high - board):
        w.box(x, (y[0] + board, y[1] - board), (bottom, bottom + board), wood)
    step = (high - 2 * board) / slats
    for i in range(slats):  # depth sees through the gaps
        low = board + i * step
        w.box((x[0], x[0] + 0.012), (y[0] + board, y[1] - board), (low, low + 0.7 * step), wood)
    w.top(x, y, high, kind="seat")


CRATE = Style("stool", "crate", "train", crate, uses=("low",))


def main(file: Path, seed: int = 3) -> None:
    """Write the apartment of this seed, with a crate for each stool."""
    shipped, CATALOGUE["stool"] = CATALOGUE["stool"], {CRATE.name: CRATE}
    try:
        house = generate(seed, pool="train", kind="studio")
    finally:
        CATALOGUE["stool"] = shipped  # other styles would give other houses
    # A house file names its textures relative to itself.
    textures = os.path.relpath(assets_dir() / "textures", file.resolve().parent)
    file.write_text(house_text(house, textures))
    stools = sum(body.name.startswith("stool_") for body in house.bodies)
    print(f"{file}: {stools} crates stand where stools would")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "my_house.xml"))
