"""Procedural textures: seamless pictures made from noise and arithmetic, each by a seed of its own.

Most are grey, near white, so that a `Look` tints them; brick, terrazzo and rugs carry colours of their own. The
image's vertical is the grain of wood. `tools/make_textures.py` writes them once as PNG files; houses refer to the
files by name. Every texture belongs to one pool: train houses never show a held-out one.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:  # the furniture package imports this module
    from sim.housegen.furniture.item import Pool

Image = NDArray[np.float64]
"""(px, px) grey or (px, px, 3) RGB, both in [0, 1]."""

SIZE_PX = 128
GREY_LEVELS = 48
"""Fewer levels compress better and nobody sees it."""


@dataclass(frozen=True)
class Texture:
    """One entry of the catalogue."""

    name: str
    pool: Pool
    tile_m: float
    """What the picture's edge measures on a surface; 0: it is stretched over the whole face (rugs)."""
    draw: Callable[[np.random.Generator, int], Image]
    seed: int
    upright: bool = False
    """True: the picture's vertical is the wall's (courses of bricks); else it follows the longest side (grain)."""

    def pixels(self) -> NDArray[np.uint8]:
        """(SIZE_PX, SIZE_PX, 3) RGB."""
        image = self.draw(np.random.default_rng(self.seed), SIZE_PX)
        levels = np.round(np.clip(image, 0.0, 1.0) * (GREY_LEVELS - 1)) * (255.0 / (GREY_LEVELS - 1))
        grey = np.round(levels).astype(np.uint8)
        return np.repeat(grey[:, :, None], 3, axis=2) if grey.ndim == 2 else grey


def noise(rng: np.random.Generator, px: int, rows_px: float, cols_px: float) -> Image:
    """Seamless smooth noise in about [-1, 1]; features span about this many pixels down and across."""
    spectrum = np.fft.rfft2(rng.standard_normal((px, px)))
    fy, fx = np.fft.fftfreq(px)[:, None], np.fft.rfftfreq(px)[None, :]
    spectrum *= np.exp(-0.5 * ((2.0 * fy * rows_px) ** 2 + (2.0 * fx * cols_px) ** 2))
    field = np.fft.irfft2(spectrum, s=(px, px))
    return field / (2.5 * field.std() + 1e-12)


def _grid(px: int) -> tuple[Image, Image]:
    """Row and column of each pixel's centre in [0, 1)."""
    edge = (np.arange(px) + 0.5) / px
    return np.meshgrid(edge, edge, indexing="ij")


# ---- wood ------------------------------------------------------------------------------------------------------


def wood(rng: np.random.Generator, px: int, *, rings: int, waver: float, fibre: float) -> Image:
    """Long grain: `rings` dark bands wavering across the board, and fine fibre."""
    _, x = _grid(px)
    bands = np.sin(math.tau * (rings * x + waver * noise(rng, px, 50, 16)))
    return 0.86 + 0.07 * bands + fibre * noise(rng, px, 24, 0.8) + 0.03 * noise(rng, px, 60, 4)


def planks(rng: np.random.Generator, px: int, *, across: int, lengths: int) -> Image:
    """Floorboards along the vertical with dark joints, each of another shade."""
    y, x = _grid(px)
    board = np.floor(x * across).astype(int)
    offsets = rng.random(across)
    piece = np.floor((y + offsets[board]) * lengths).astype(int) % lengths
    shade = rng.uniform(-0.09, 0.07, (across, lengths))[board, piece]
    joint = (np.mod(x * across, 1.0) * px / across < 1.0) | (
        np.mod((y + offsets[board]) * lengths, 1.0) * px / lengths < 1.0
    )
    grain = 0.05 * noise(rng, px, 20, 1.0) + 0.03 * noise(rng, px, 40, 3)
    return np.where(joint, 0.52, 0.88 + shade + grain)


def basket(rng: np.random.Generator, px: int, *, blocks: int, strips: int) -> Image:
    """Parquet: squares of parallel strips, every other square turned."""
    y, x = _grid(px)
    row, col = np.floor(y * blocks).astype(int), np.floor(x * blocks).astype(int)
    turned = (row + col) % 2 == 1
    along = np.where(turned, np.mod(y * blocks, 1.0), np.mod(x * blocks, 1.0))
    strip = np.floor(along * strips).astype(int)
    shade = rng.uniform(-0.1, 0.08, (blocks, blocks, strips))[row, col, strip]
    joint = np.mod(along * strips, 1.0) * px / (blocks * strips) < 1.0
    across, down = 0.05 * noise(rng, px, 12, 1.0), 0.05 * noise(rng, px, 1.0, 12)
    return np.where(joint, 0.6, 0.87 + shade + np.where(turned, down, across))


def herringbone(rng: np.random.Generator, px: int, *, blocks: int) -> Image:
    """Parquet in zigzag columns."""
    y, x = _grid(px)
    column = np.floor(x * blocks).astype(int)
    inside = np.mod(x * blocks, 1.0)
    rising = column % 2 == 0
    slant = y * blocks * 2 + np.where(rising, inside, 1.0 - inside)
    strip = np.floor(slant).astype(int) % (2 * blocks)
    shade = rng.uniform(-0.1, 0.08, (blocks, 2 * blocks))[column, strip]
    joint = (np.mod(slant, 1.0) < 0.1) | (inside * px / blocks < 1.0)
    return np.where(joint, 0.6, 0.87 + shade + 0.03 * noise(rng, px, 3, 3))


# ---- tiles, stone, masonry --------------------------------------------------------------------------------------


def tiles(
    rng: np.random.Generator, px: int, *, across: int, down: int, grout_px: float, shade: float, offset: float = 0.0
) -> Image:
    """Rectangular tiles with grout; odd rows moved by `offset` of a tile."""
    y, x = _grid(px)
    row = np.floor(y * down).astype(int)
    shifted = x * across + offset * (row % 2)
    col = np.floor(shifted).astype(int) % across
    tone = rng.uniform(-shade, shade, (down, across))[row, col]
    joint = (np.mod(shifted, 1.0) * px / across < grout_px) | (np.mod(y * down, 1.0) * px / down < grout_px)
    return np.where(joint, 0.68, 0.92 + tone + 0.015 * noise(rng, px, 6, 6))


def checker(rng: np.random.Generator, px: int, *, dark: float) -> Image:
    """Two by two tiles, light and dark in turn."""
    y, x = _grid(px)
    odd = (np.floor(2 * y) + np.floor(2 * x)) % 2 == 1
    joint = (np.mod(2 * x, 1.0) * px / 2 < 1.2) | (np.mod(2 * y, 1.0) * px / 2 < 1.2)
    return np.where(joint, 0.6, np.where(odd, dark, 0.95) + 0.02 * noise(rng, px, 8, 8))


def marble(rng: np.random.Generator, px: int, *, veins: float, cloud: float) -> Image:
    """Thin dark veins in soft clouds."""
    ridge = np.abs(noise(rng, px, 22, 14) + 0.35 * noise(rng, px, 5, 5))
    return 0.93 - veins * np.exp(-((ridge / 0.06) ** 2)) + cloud * noise(rng, px, 20, 20)


def speckle(
    rng: np.random.Generator, px: int, *, size_px: float, share: float, chips: tuple[tuple[float, float, float], ...]
) -> Image:
    """Terrazzo or granite: coloured chips in a light ground."""
    image = np.full((px, px, 3), 0.86) + 0.02 * noise(rng, px, 2, 2)[:, :, None]
    for chip in chips:
        field = noise(rng, px, size_px, size_px)
        image[field > np.quantile(field, 1.0 - share)] = chip
    return image


def brick(rng: np.random.Generator, px: int, *, clay: tuple[float, float, float], mortar: float) -> Image:
    """Running bond: eight courses of four bricks."""
    y, x = _grid(px)
    row = np.floor(y * 8).astype(int)
    shifted = x * 4 + 0.5 * (row % 2)
    tone = rng.uniform(0.82, 1.1, (8, 4))[row, np.floor(shifted).astype(int) % 4] + 0.08 * noise(rng, px, 2, 2)
    joint = (np.mod(shifted, 1.0) < 0.05) | (np.mod(y * 8, 1.0) < 0.1)
    return np.where(joint[:, :, None], mortar, tone[:, :, None] * np.array(clay))


def rubble(rng: np.random.Generator, px: int, *, stones: int) -> Image:
    """Natural stone wall: cells round random points, seams between."""
    points = rng.random((stones, 2))
    y, x = _grid(px)
    gaps = np.abs(np.stack([y, x], -1)[:, :, None, :] - points)
    distance = np.sqrt((np.minimum(gaps, 1.0 - gaps) ** 2 * (2.2, 1.0)).sum(-1))
    near = np.sort(distance, axis=-1)[:, :, :2]
    tone = rng.uniform(-0.14, 0.08, stones)[np.argmin(distance, axis=-1)]
    return np.where(near[:, :, 1] - near[:, :, 0] < 0.018, 0.58, 0.85 + tone + 0.05 * noise(rng, px, 3, 3))


# ---- plaster, paper, cloth --------------------------------------------------------------------------------------


def plaster(rng: np.random.Generator, px: int, *, grain: float, cloud: float) -> Image:
    """Painted wall: soft clouds and fine grain."""
    return 0.93 + grain * noise(rng, px, 1.2, 1.2) + cloud * noise(rng, px, 18, 18)


def paper(rng: np.random.Generator, px: int, *, stripes: int, contrast: float) -> Image:
    """Striped wallpaper."""
    _, x = _grid(px)
    return np.where(np.mod(x * stripes, 1.0) < 0.5, 0.96, 0.96 - contrast) + 0.01 * noise(rng, px, 1, 1)


def motif(rng: np.random.Generator, px: int, *, across: int, contrast: float) -> Image:
    """Wallpaper of staggered small flowers."""
    y, x = _grid(px)
    row = np.floor(y * across)
    u, v = np.mod(x * across + 0.5 * (row % 2), 1.0) - 0.5, np.mod(y * across, 1.0) - 0.5
    radius, angle = np.hypot(u, v), np.arctan2(v, u)
    flower = (radius < 0.3 + 0.1 * np.cos(5 * angle)) & (radius > 0.08)
    return np.where(flower, 0.95 - contrast, 0.95) + 0.01 * noise(rng, px, 1, 1)


def carpet(rng: np.random.Generator, px: int, *, tuft_px: float, contrast: float) -> Image:
    """Tufts."""
    return 0.82 + contrast * noise(rng, px, tuft_px, tuft_px) + 0.04 * noise(rng, px, 14, 14)


def weave(rng: np.random.Generator, px: int, *, threads: int, contrast: float, twill: bool) -> Image:
    """Cloth: threads over and under, or diagonal twill."""
    y, x = _grid(px)
    if twill:
        pattern = np.sin(math.tau * threads * (x + y))
    else:
        pattern = np.sin(math.tau * threads * x) * np.sin(math.tau * threads * y)
    return 0.88 + contrast * pattern + 0.04 * noise(rng, px, 1, 1)


def chevron(rng: np.random.Generator, px: int, *, bands: int, contrast: float) -> Image:
    """Herringbone cloth."""
    y, x = _grid(px)
    zigzag = np.abs(np.mod(x * bands, 1.0) - 0.5) * 2.0 / bands
    return 0.86 + contrast * np.sign(np.sin(math.tau * bands * 2 * (y + zigzag))) + 0.03 * noise(rng, px, 1, 1)


def cane(rng: np.random.Generator, px: int, *, strands: int) -> Image:
    """Wicker: interlaced strands with dark gaps."""
    y, x = _grid(px)
    over = (np.floor(x * strands) + np.floor(y * strands)) % 2 == 0
    along = np.where(over, np.mod(y * strands, 1.0), np.mod(x * strands, 1.0))
    return 0.55 + 0.4 * np.sin(math.pi * along) + 0.04 * noise(rng, px, 2, 2)


def spines(rng: np.random.Generator, px: int, *, books: int, colours: tuple[tuple[float, float, float], ...]) -> Image:
    """A row of books: their backs follow each other down the picture, titles as lighter bands."""
    y, x = _grid(px)
    edges = np.cumsum(rng.uniform(0.6, 1.4, books))
    book = np.searchsorted(edges / edges[-1], y, side="right").clip(0, books - 1)
    tone = rng.uniform(0.75, 1.15, books)[:, None] * np.array(colours)[rng.integers(len(colours), size=books)]
    image = tone[book]
    label = (np.abs(x - rng.uniform(0.55, 0.8, books)[book]) < 0.05) & (rng.random(books) < 0.6)[book]
    image = np.where(label[:, :, None], 0.5 * image + 0.42, image)
    gap = np.abs(np.concatenate([np.diff(book, axis=0), np.ones((1, px))])) > 0
    return np.where(gap[:, :, None], 0.12, image)


def leaves(rng: np.random.Generator, px: int, *, size_px: float) -> Image:
    """Foliage from afar: blotches of light and shade."""
    return 0.72 + 0.2 * noise(rng, px, size_px, 0.6 * size_px) + 0.1 * noise(rng, px, 1, 1)


# ---- rugs --------------------------------------------------------------------------------------------------------


def rug(rng: np.random.Generator, px: int, *, colours: tuple[tuple[float, float, float], ...], pattern: str) -> Image:
    """A rug's whole picture: border bands and a field of stripes, diamonds, a medallion or a lattice."""
    y, x = _grid(px)
    u, v = 2.0 * x - 1.0, 2.0 * y - 1.0
    edge = np.maximum(np.abs(u), np.abs(v))
    fields = {
        "stripes": np.floor(y * 14) % 3,
        "diamonds": np.floor(3.0 * (np.abs(np.mod(3 * x, 1.0) - 0.5) + np.abs(np.mod(3 * y, 1.0) - 0.5))) % 3,
        "medallion": np.floor(4.0 * np.hypot(u, v) + 0.4 * np.cos(8 * np.arctan2(v, u))) % 3,
        "lattice": ((np.mod(5 * (x + y), 1.0) < 0.15) | (np.mod(5 * (x - y), 1.0) < 0.15)).astype(float),
        "kilim": np.floor(6 * y + 2 * np.abs(np.mod(6 * x, 1.0) - 0.5)) % 3,
        "rings": (np.floor(3.5 * np.hypot(u + 0.3, v - 0.2)) + np.floor(2.5 * np.hypot(u - 0.7, v + 0.6))) % 3,
    }
    index = fields[pattern].astype(int)
    index = np.where(edge > 0.9, len(colours) - 1, np.where((edge > 0.8) & (edge < 0.85), 0, index))
    shade = 1.0 + 0.12 * noise(rng, px, 1, 1)
    return np.array(colours)[index] * shade[:, :, None]


_RED, _CREAM, _NAVY, _TEAL = (0.60, 0.16, 0.14), (0.86, 0.80, 0.68), (0.15, 0.20, 0.36), (0.20, 0.45, 0.46)
_SAND, _CHARCOAL, _RUST, _OLIVE = (0.78, 0.70, 0.58), (0.25, 0.25, 0.27), (0.72, 0.38, 0.20), (0.42, 0.45, 0.28)
_PLUM, _ROSE, _SKY, _GOLD, _MINT = (
    (0.38, 0.18, 0.34),
    (0.80, 0.56, 0.56),
    (0.55, 0.68, 0.80),
    (0.80, 0.62, 0.26),
    (0.66, 0.80, 0.72),
)
_IVORY, _INK = (0.92, 0.90, 0.84), (0.12, 0.14, 0.18)


_UPRIGHT = ("brick", "rubble", "tiles", "paper", "motif")
"""Names of the functions whose pictures stand on walls."""


def _entry(name: str, pool: Pool, tile_m: float, draw: Callable[..., Image], seed: int, **options: object) -> Texture:
    return Texture(name, pool, tile_m, partial(draw, **options), seed, draw.__name__ in _UPRIGHT)


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
    # rugs: one picture a rug
    _entry("rug_stripes", "train", 0.0, rug, 91, colours=(_CREAM, _NAVY, _TEAL, _CREAM), pattern="stripes"),
    _entry("rug_diamonds", "train", 0.0, rug, 92, colours=(_RED, _CREAM, _NAVY, _RED), pattern="diamonds"),
    _entry("rug_lattice", "train", 0.0, rug, 93, colours=(_SAND, _CHARCOAL, _SAND), pattern="lattice"),
    _entry("rug_kilim", "train", 0.0, rug, 94, colours=(_RUST, _CREAM, _CHARCOAL, _RUST), pattern="kilim"),
    _entry("rug_medallion", "heldout", 0.0, rug, 95, colours=(_PLUM, _GOLD, _ROSE, _PLUM), pattern="medallion"),
    _entry("rug_rings", "heldout", 0.0, rug, 96, colours=(_SKY, _IVORY, _MINT, _INK), pattern="rings"),
)
# fmt: on

TEXTURES: dict[str, Texture] = {texture.name: texture for texture in _ALL}
"""The catalogue: every name that a `Look.texture` may hold."""
