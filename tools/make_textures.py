"""Writes the texture catalogue as PNG files.

python tools/make_textures.py --out assets/mjcf_houses/textures
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import cv2
import tyro

from sim.housegen.materials import texture_file
from sim.housegen.textures import TEXTURES


@dataclass(frozen=True)
class Args:
    """Options of the command."""

    out: Path = Path("assets/mjcf_houses/textures")
    """Folder for the PNG files, one for each texture."""


def main(args: Args) -> None:
    """Writes every texture and prints their number and total size."""
    args.out.mkdir(parents=True, exist_ok=True)
    total = 0
    for texture in TEXTURES.values():
        path = args.out / texture_file(texture.name)
        cv2.imwrite(str(path), texture.pixels()[:, :, ::-1], [cv2.IMWRITE_PNG_COMPRESSION, 9])
        total += path.stat().st_size
    print(f"{len(TEXTURES)} textures in {args.out}, {total / 1000:.0f} kB")


if __name__ == "__main__":
    main(tyro.cli(Args))
