"""The catalogue of procedural textures; each one is drawn by a function of `texture_patterns` with its own seed.

Most are grey, so that a `Look` tints them; some, such as brick, terrazzo, rugs and views, have their own colours.
`tools.maintenance.make_textures` writes them as PNG files; houses refer to the files by name. Every texture
belongs to one pool: train houses never show a held-out one.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sim.homes.housegen.surfaces.texture_patterns import (
    Image,
    basket,
    brick,
    cane,
    carpet,
    checker,
    chevron,
    herringbone,
    leaves,
    marble,
    motif,
    palette,
    paper,
    planks,
    plaster,
    rubble,
    rug,
    speckle,
    spines,
    tiles,
    weave,
    wood,
)
from sim.homes.housegen.surfaces.texture_views import outside, reflection

if TYPE_CHECKING:  # the furniture package imports this module
    from sim.homes.housegen.furniture.item import Pool

SIZE_PX = 128
GREY_LEVELS = 48
"""Few levels compress better, and the difference is not visible."""


@dataclass(frozen=True)
class Texture:
    """A texture of the catalogue."""

    name: str
    pool: Pool
    tile_m: float
    """Edge length of the picture on a surface; 0: it is stretched over the whole face (rugs)."""
    draw: Callable[[np.random.Generator, int], Image]
    seed: int
    upright: bool = False
    """True: the picture's vertical is that of the wall (bricks); False: it follows the longest side (grain of wood)."""

    def pixels(self) -> NDArray[np.uint8]:
        """Returns the picture, (SIZE_PX, SIZE_PX, 3) RGB."""
        image = self.draw(np.random.default_rng(self.seed), SIZE_PX)
        levels = np.round(np.clip(image, 0.0, 1.0) * (GREY_LEVELS - 1)) * (255.0 / (GREY_LEVELS - 1))
        grey = np.round(levels).astype(np.uint8)
        return np.repeat(grey[:, :, None], 3, axis=2) if grey.ndim == 2 else grey


_RED, _CREAM, _NAVY, _TEAL = (0.60, 0.16, 0.14), (0.86, 0.80, 0.68), (0.15, 0.20, 0.36), (0.20, 0.45, 0.46)
_SAND, _CHARCOAL, _RUST = (0.78, 0.70, 0.58), (0.25, 0.25, 0.27), (0.72, 0.38, 0.20)
_PLUM, _ROSE, _SKY, _GOLD, _MINT = (
    (0.38, 0.18, 0.34),
    (0.80, 0.56, 0.56),
    (0.55, 0.68, 0.80),
    (0.80, 0.62, 0.26),
    (0.66, 0.80, 0.72),
)
_IVORY, _INK = (0.92, 0.90, 0.84), (0.12, 0.14, 0.18)


_SMALL_TRAIN = ("f3f2ee", "e6dcc6", "232427", "a9abae", "b98c58", "5c3d28", "557f3f", "a9c4c9", "c19a63", "6f4a30")
_SMALL_HELDOUT = ("f6efe4", "dfd3da", "1d2128", "b9b1a4", "a9743f", "43302b", "3f6f55", "bcd0df", "b08f6a", "7d3a2c")
"""Hexadecimal RGB of the columns of palettes that differ little: white, cream, dark, metal, wood, brown; leaves, glass,
cardboard, leather."""
_UPRIGHT = ("brick", "rubble", "tiles", "paper", "motif", "outside", "reflection")
"""Names of functions; the pictures that they draw are upright on walls."""


def _entry(name: str, pool: Pool, tile_m: float, draw: Callable[..., Image], seed: int, **options: object) -> Texture:
    """Returns a texture drawn with these options."""
    return Texture(name, pool, tile_m, functools.partial(draw, **options), seed, draw.__name__ in _UPRIGHT)


# fmt: off
_ALL = (
    # wood
    _entry("wood_fine", "train", 0.5, wood, 11, rings=5, waver=0.5, fibre=0.05),
    _entry("wood_bold", "train", 0.6, wood, 12, rings=4, waver=1.1, fibre=0.07),
    _entry("wood_straight", "heldout", 0.5, wood, 13, rings=9, waver=0.2, fibre=0.05),
    _entry("wood_cloud", "heldout", 0.7, wood, 14, rings=2, waver=1.7, fibre=0.08),
    _entry("planks_wide", "train", 1.4, planks, 21, across=7, lengths=1),
    _entry("planks_medium", "train", 1.2, planks, 22, across=10, lengths=2),
    _entry("planks_rustic", "heldout", 1.6, planks, 23, across=5, lengths=1),
    _entry("planks_narrow", "heldout", 1.0, planks, 24, across=14, lengths=2),
    _entry("parquet_basket", "train", 0.9, basket, 25, blocks=4, strips=5),
    _entry("parquet_herringbone", "heldout", 0.8, herringbone, 26, blocks=6),
    # tiles, stone, masonry
    _entry("tiles_square", "train", 1.2, tiles, 31, across=4, down=4, grout_px=1.4, shade=0.03),
    _entry("tiles_small", "train", 0.6, tiles, 32, across=6, down=6, grout_px=1.4, shade=0.04),
    _entry("tiles_subway", "train", 0.6, tiles, 33, across=3, down=6, grout_px=1.3, shade=0.02, offset=0.5),
    _entry("tiles_checker", "train", 0.8, checker, 34, dark=0.45),
    _entry("tiles_large", "heldout", 1.2, tiles, 35, across=2, down=2, grout_px=1.0, shade=0.02),
    _entry("tiles_mosaic", "heldout", 0.4, tiles, 36, across=10, down=10, grout_px=1.6, shade=0.09),
    _entry("tiles_plank", "heldout", 1.0, tiles, 37, across=2, down=8, grout_px=1.0, shade=0.05, offset=0.5),
    _entry("tiles_harlequin", "heldout", 0.6, checker, 38, dark=0.66),
    _entry("marble_vein", "train", 1.0, marble, 41, veins=0.3, cloud=0.04),
    _entry("marble_cloud", "heldout", 1.2, marble, 42, veins=0.12, cloud=0.1),
    _entry("terrazzo_fine", "train", 0.8, speckle, 43, size_px=2.0, share=0.05,
           chips=((0.35, 0.35, 0.38), (0.70, 0.50, 0.40), (0.98, 0.97, 0.95))),
    _entry("granite", "train", 0.5, speckle, 44, size_px=1.2, share=0.14,
           chips=((0.5, 0.5, 0.5), (0.3, 0.3, 0.3), (0.97, 0.97, 0.97))),
    _entry("terrazzo_coarse", "heldout", 1.0, speckle, 45, size_px=4.5, share=0.06,
           chips=((0.25, 0.42, 0.40), (0.85, 0.70, 0.45), (0.55, 0.25, 0.22))),
    _entry("quartz", "heldout", 0.5, speckle, 46, size_px=0.8, share=0.06, chips=((0.6, 0.62, 0.66), (1.0, 1.0, 1.0))),
    _entry("brick_red", "train", 0.9, brick, 51, clay=(0.66, 0.33, 0.25), mortar=0.78),
    _entry("brick_yellow", "heldout", 0.9, brick, 52, clay=(0.78, 0.66, 0.46), mortar=0.62),
    _entry("stone_rubble", "train", 1.0, rubble, 53, stones=22),
    _entry("stone_ashlar", "heldout", 1.2, tiles, 54, across=3, down=5, grout_px=1.8, shade=0.12, offset=0.37),
    # walls and cloth
    _entry("plaster_soft", "train", 2.0, plaster, 61, grain=0.014, cloud=0.010),
    _entry("plaster_grain", "train", 1.2, plaster, 62, grain=0.035, cloud=0.01),
    _entry("plaster_trowel", "heldout", 2.4, plaster, 63, grain=0.018, cloud=0.022),
    _entry("paper_stripe", "train", 0.8, paper, 64, stripes=8, contrast=0.07),
    _entry("paper_flower", "heldout", 0.8, motif, 65, across=6, contrast=0.10),
    _entry("carpet_loop", "train", 0.6, carpet, 71, tuft_px=1.4, contrast=0.10),
    _entry("carpet_fleck", "train", 0.8, carpet, 72, tuft_px=2.4, contrast=0.14),
    _entry("carpet_pile", "heldout", 0.8, carpet, 73, tuft_px=4.0, contrast=0.08),
    _entry("weave_plain", "train", 0.25, weave, 74, threads=24, contrast=0.10, twill=False),
    _entry("weave_twill", "train", 0.25, weave, 75, threads=16, contrast=0.08, twill=True),
    _entry("weave_linen", "heldout", 0.3, weave, 76, threads=32, contrast=0.14, twill=False),
    _entry("weave_chevron", "heldout", 0.4, chevron, 77, bands=8, contrast=0.06),
    _entry("cane_plain", "train", 0.3, cane, 78, strands=14),
    _entry("cane_broad", "heldout", 0.4, cane, 79, strands=8),
    _entry("foliage_small", "train", 0.4, leaves, 81, size_px=4.0),
    _entry("foliage_large", "heldout", 0.5, leaves, 82, size_px=8.0),
    _entry("books_classic", "train", 0.45, spines, 83, books=13,
           colours=((0.54, 0.18, 0.16), (0.18, 0.29, 0.44), (0.25, 0.42, 0.29), (0.79, 0.64, 0.29), (0.85, 0.82, 0.76),
                    (0.17, 0.16, 0.19))),
    _entry("books_paperback", "train", 0.35, spines, 84, books=15,
           colours=((0.90, 0.88, 0.82), (0.85, 0.45, 0.25), (0.28, 0.50, 0.62), (0.93, 0.78, 0.40), (0.55, 0.22, 0.30),
                    (0.30, 0.32, 0.34))),
    _entry("books_pastel", "heldout", 0.40, spines, 85, books=12,
           colours=((0.80, 0.70, 0.76), (0.58, 0.70, 0.68), (0.93, 0.89, 0.80), (0.48, 0.42, 0.60), (0.70, 0.62, 0.44),
                    (0.28, 0.24, 0.32))),
    # palettes of small objects (furniture/parts/palette_mesh.py): one colour a column
    *(_entry(f"small_{name}", "train", 0.0, palette, 101,
             colours=(*_SMALL_TRAIN[:6], *accents.split(), *_SMALL_TRAIN[6:]))
      for name, accents in (
          ("red", "8f2f2a 2f4a70 d9a441 3f6a4a e4dccb 5a3a55"), ("blue", "27527a c96f3f e6d9a0 6f8fa8 8a2f3a 33363c"),
          ("green", "4a7a4f d8c27a 2c3f5f b9603f 8fa98a 6a2f3f"),
          ("sand", "c9a878 7a3f2f 41706f e0cf4f 94566a 2f4a3f"))),
    *(_entry(f"small_{name}", "heldout", 0.0, palette, 102,
             colours=(*_SMALL_HELDOUT[:6], *accents.split(), *_SMALL_HELDOUT[6:]))
      for name, accents in (
          ("plum", "6a3f72 7fb0c0 cf7f97 b7bf5a f0dcc2 30424f"), ("teal", "1f6a6f e0a58a 5f4f8a a8c6b0 c2506f e8d38f"),
          ("rose", "c97a8a 46506f a9b04a 7f5f9f 2f7f80 efc6a0"),
          ("moss", "7f8f3f b5563a 8f9fc0 4a2f4f dcb05f 5f8f86"))),
    # rugs: one picture a rug
    _entry("rug_stripes", "train", 0.0, rug, 91, colours=(_CREAM, _NAVY, _TEAL, _CREAM), pattern="stripes"),
    _entry("rug_diamonds", "train", 0.0, rug, 92, colours=(_RED, _CREAM, _NAVY, _RED), pattern="diamonds"),
    _entry("rug_lattice", "train", 0.0, rug, 93, colours=(_SAND, _CHARCOAL, _SAND), pattern="lattice"),
    _entry("rug_kilim", "train", 0.0, rug, 94, colours=(_RUST, _CREAM, _CHARCOAL, _RUST), pattern="kilim"),
    _entry("rug_medallion", "heldout", 0.0, rug, 95, colours=(_PLUM, _GOLD, _ROSE, _PLUM), pattern="medallion"),
    _entry("rug_rings", "heldout", 0.0, rug, 96, colours=(_SKY, _IVORY, _MINT, _INK), pattern="rings"),
)

_SCENES: tuple[tuple[Pool, str, int], ...] = (
    ("train", "hills", 200), ("train", "street", 201), ("heldout", "roofs", 202), ("heldout", "garden", 203)
)
_VIEWS = tuple(
    _entry(f"view_{scene}_{time}", pool, 0.0, outside, seed, scene=scene, time=time)
    for pool, scene, seed in _SCENES
    for time in ("morning", "noon", "evening", "night")
)
_MIRRORS = (
    _entry("mirror_hall", "train", 0.0, reflection, 210, wall=(0.72, 0.74, 0.74), floor=(0.50, 0.42, 0.34)),
    _entry("mirror_room", "heldout", 0.0, reflection, 211, wall=(0.78, 0.74, 0.68), floor=(0.45, 0.45, 0.48)),
)
# fmt: on

TEXTURES: dict[str, Texture] = {texture.name: texture for texture in (*_ALL, *_VIEWS, *_MIRRORS)}
"""The textures by name; a `Look.texture` is one of these names."""


@functools.cache
def mean_colour(texture: str) -> tuple[float, float, float]:
    """Returns the mean RGB of a texture, in [0, 1]."""
    r, g, b = TEXTURES[texture].pixels().reshape(-1, 3).mean(axis=0) / 255.0
    return float(r), float(g), float(b)
