"""Writes the texture catalogue as PNG files.

python -m tools.maintenance.make_textures --out assets/mjcf_houses/textures
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

import cv2

from sim.app import cli
from sim.core.files import write_atomically
from sim.homes.housegen.surfaces.materials import texture_file
from sim.homes.housegen.surfaces.textures import TEXTURES


@dataclass(frozen=True)
class Args:
    """Options of the command."""

    out: cli.OutFolder = Path("assets/mjcf_houses/textures")
    """Folder for the PNG files, one for each texture."""


def main(args: Args) -> int:
    """Writes every texture and prints their number and total size; returns the exit status."""
    total = 0
    for texture in TEXTURES.values():
        path = args.out / texture_file(texture.name)
        png = cv2.imencode(".png", texture.pixels()[:, :, ::-1], [cv2.IMWRITE_PNG_COMPRESSION, 9])[1]
        write_atomically(path, png.tobytes())
        total += path.stat().st_size
    print(f"{len(TEXTURES)} textures in {args.out}, {total / 1000:.0f} kB")
    return 0


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
