"""A new style of furniture: a stool made from a crate, and an apartment in which all stools are such crates.

python examples/my_furniture.py my_house.xml
"""

import os
import sys
from pathlib import Path

from sim import CATALOGUE, Style, Workbench, generate, house_text
from sim.core.paths import assets_dir


def crate(w: Workbench) -> None:
    """An open crate on its end: two sides, a bottom, a seat and a slatted back."""
    w.mass_kg = 4.0  # light enough to be movable
    high, wide, deep = w.height(0.42, 0.46), w.width(0.34, 0.40), w.depth(0.30, 0.34)
    wood, board, slats = w.look("wood"), 0.02, 4
    x, y = (-deep / 2, deep / 2), (-wide / 2, wide / 2)
    for side in (y[0], y[1] - board):
        w.box(x, (side, side + board), (0.0, high), wood)
    for bottom in (0.0, high - board):
        w.box(x, (y[0] + board, y[1] - board), (bottom, bottom + board), wood)
    step = (high - 2 * board) / slats
    for i in range(slats):
        low = board + i * step
        w.box((x[0], x[0] + 0.012), (y[0] + board, y[1] - board), (low, low + 0.7 * step), wood)
    w.top(x, y, high, kind="seat")


CRATE = Style("stool", "crate", "train", crate, uses=("low",))


def main(file: Path, seed: int = 4) -> None:
    """Writes the apartment of this seed; all its stools are crates."""
    house = generate(seed, pool="train", kind="studio", catalogue=CATALOGUE.replacing("stool", CRATE))
    # A house file names its textures relative to itself.
    textures = os.path.relpath(assets_dir() / "textures", file.resolve().parent)
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(house_text(house, textures))
    stools = sum(body.name.startswith("stool_") for body in house.bodies)
    print(f"{file}: {stools} stools, all of them crates")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "my_house.xml"))
