"""Functions that draw seamless pictures from noise: wood, tiles, stone, plaster, cloth, books, leaves, rugs.

Each returns `px` x `px` pixels in [0, 1], grey near white (so that a `Look` tints them) or RGB. The grain of wood is
vertical.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

Image = NDArray[np.float64]
"""(px, px) grey or (px, px, 3) RGB, both in [0, 1]."""
Colour = tuple[float, float, float]


def noise(rng: np.random.Generator, px: int, rows_px: float, cols_px: float) -> Image:
    """Returns seamless smooth noise in about [-1, 1]; its features span about this many pixels down and across."""
    spectrum = np.fft.rfft2(rng.standard_normal((px, px)))
    fy, fx = np.fft.fftfreq(px)[:, None], np.fft.rfftfreq(px)[None, :]
    spectrum *= np.exp(-0.5 * ((2.0 * fy * rows_px) ** 2 + (2.0 * fx * cols_px) ** 2))
    field = np.fft.irfft2(spectrum, s=(px, px))
    return field / (2.5 * field.std() + 1e-12)


def grid(px: int) -> tuple[Image, Image]:
    """Returns row and column of each pixel's centre in [0, 1)."""
    edge = (np.arange(px) + 0.5) / px
    return np.meshgrid(edge, edge, indexing="ij")


# ---- wood ------------------------------------------------------------------------------------------------------


def wood(rng: np.random.Generator, px: int, *, rings: int, waver: float, fibre: float) -> Image:
    """Returns the long grain of wood: `rings` wavy dark bands and fine fibre."""
    _, x = grid(px)
    bands = np.sin(math.tau * (rings * x + waver * noise(rng, px, 50, 16)))
    return 0.86 + 0.07 * bands + fibre * noise(rng, px, 24, 0.8) + 0.03 * noise(rng, px, 60, 4)


def planks(rng: np.random.Generator, px: int, *, across: int, lengths: int) -> Image:
    """Returns floorboards along the vertical in different shades, with dark joints."""
    y, x = grid(px)
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
    """Returns parquet of squares of parallel strips, every other square turned."""
    y, x = grid(px)
    row, col = np.floor(y * blocks).astype(int), np.floor(x * blocks).astype(int)
    turned = (row + col) % 2 == 1
    along = np.where(turned, np.mod(y * blocks, 1.0), np.mod(x * blocks, 1.0))
    strip = np.floor(along * strips).astype(int)
    shade = rng.uniform(-0.1, 0.08, (blocks, blocks, strips))[row, col, strip]
    joint = np.mod(along * strips, 1.0) * px / (blocks * strips) < 1.0
    across, down = 0.05 * noise(rng, px, 12, 1.0), 0.05 * noise(rng, px, 1.0, 12)
    return np.where(joint, 0.6, 0.87 + shade + np.where(turned, down, across))


def herringbone(rng: np.random.Generator, px: int, *, blocks: int) -> Image:
    """Returns parquet in zigzag columns."""
    y, x = grid(px)
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
    """Returns rectangular tiles with grout, odd rows shifted by `offset` of a tile."""
    y, x = grid(px)
    row = np.floor(y * down).astype(int)
    shifted = x * across + offset * (row % 2)
    col = np.floor(shifted).astype(int) % across
    tone = rng.uniform(-shade, shade, (down, across))[row, col]
    joint = (np.mod(shifted, 1.0) * px / across < grout_px) | (np.mod(y * down, 1.0) * px / down < grout_px)
    return np.where(joint, 0.68, 0.92 + tone + 0.015 * noise(rng, px, 6, 6))


def checker(rng: np.random.Generator, px: int, *, dark: float) -> Image:
    """Returns two by two tiles, alternately light and dark."""
    y, x = grid(px)
    odd = (np.floor(2 * y) + np.floor(2 * x)) % 2 == 1
    joint = (np.mod(2 * x, 1.0) * px / 2 < 1.2) | (np.mod(2 * y, 1.0) * px / 2 < 1.2)
    return np.where(joint, 0.6, np.where(odd, dark, 0.95) + 0.02 * noise(rng, px, 8, 8))


def marble(rng: np.random.Generator, px: int, *, veins: float, cloud: float) -> Image:
    """Returns marble: thin dark veins in soft clouds."""
    ridge = np.abs(noise(rng, px, 22, 14) + 0.35 * noise(rng, px, 5, 5))
    return 0.93 - veins * np.exp(-((ridge / 0.06) ** 2)) + cloud * noise(rng, px, 20, 20)


def speckle(rng: np.random.Generator, px: int, *, size_px: float, share: float, chips: tuple[Colour, ...]) -> Image:
    """Returns terrazzo or granite: coloured chips on a light ground."""
    image = np.full((px, px, 3), 0.86) + 0.02 * noise(rng, px, 2, 2)[:, :, None]
    for chip in chips:
        field = noise(rng, px, size_px, size_px)
        image[field > np.quantile(field, 1.0 - share)] = chip
    return image


def brick(rng: np.random.Generator, px: int, *, clay: Colour, mortar: float) -> Image:
    """Returns eight courses of four bricks in running bond."""
    y, x = grid(px)
    row = np.floor(y * 8).astype(int)
    shifted = x * 4 + 0.5 * (row % 2)
    tone = rng.uniform(0.82, 1.1, (8, 4))[row, np.floor(shifted).astype(int) % 4] + 0.08 * noise(rng, px, 2, 2)
    joint = (np.mod(shifted, 1.0) < 0.05) | (np.mod(y * 8, 1.0) < 0.1)
    return np.where(joint[:, :, None], mortar, tone[:, :, None] * np.array(clay))


def rubble(rng: np.random.Generator, px: int, *, stones: int) -> Image:
    """Returns a wall of natural stone: cells around random points, with seams."""
    points = rng.random((stones, 2))
    y, x = grid(px)
    gaps = np.abs(np.stack([y, x], -1)[:, :, None, :] - points)
    distance = np.sqrt((np.minimum(gaps, 1.0 - gaps) ** 2 * (2.2, 1.0)).sum(-1))
    near = np.sort(distance, axis=-1)[:, :, :2]
    tone = rng.uniform(-0.14, 0.08, stones)[np.argmin(distance, axis=-1)]
    return np.where(near[:, :, 1] - near[:, :, 0] < 0.018, 0.58, 0.85 + tone + 0.05 * noise(rng, px, 3, 3))


# ---- plaster, paper, cloth --------------------------------------------------------------------------------------


def plaster(rng: np.random.Generator, px: int, *, grain: float, cloud: float) -> Image:
    """Returns a painted wall: soft clouds and fine grain."""
    return 0.93 + grain * noise(rng, px, 1.2, 1.2) + cloud * noise(rng, px, 18, 18)


def paper(rng: np.random.Generator, px: int, *, stripes: int, contrast: float) -> Image:
    """Returns striped wallpaper."""
    _, x = grid(px)
    return np.where(np.mod(x * stripes, 1.0) < 0.5, 0.96, 0.96 - contrast) + 0.01 * noise(rng, px, 1, 1)


def palette(rng: np.random.Generator, px: int, *, colours: tuple[str, ...]) -> Image:
    """Returns upright stripes of equal width, one of each hexadecimal colour."""
    rgb = np.array([[int(colour[i : i + 2], 16) / 255 for i in (0, 2, 4)] for colour in colours])
    return np.broadcast_to(np.repeat(rgb, px // len(colours), axis=0), (px, px, 3))


def motif(rng: np.random.Generator, px: int, *, across: int, contrast: float) -> Image:
    """Returns wallpaper with staggered small flowers."""
    y, x = grid(px)
    row = np.floor(y * across)
    u, v = np.mod(x * across + 0.5 * (row % 2), 1.0) - 0.5, np.mod(y * across, 1.0) - 0.5
    radius, angle = np.hypot(u, v), np.arctan2(v, u)
    flower = (radius < 0.3 + 0.1 * np.cos(5 * angle)) & (radius > 0.08)
    return np.where(flower, 0.95 - contrast, 0.95) + 0.01 * noise(rng, px, 1, 1)


def carpet(rng: np.random.Generator, px: int, *, tuft_px: float, contrast: float) -> Image:
    """Returns carpet tufts."""
    return 0.82 + contrast * noise(rng, px, tuft_px, tuft_px) + 0.04 * noise(rng, px, 14, 14)


def weave(rng: np.random.Generator, px: int, *, threads: int, contrast: float, twill: bool) -> Image:
    """Returns cloth in plain weave or diagonal twill."""
    y, x = grid(px)
    if twill:
        pattern = np.sin(math.tau * threads * (x + y))
    else:
        pattern = np.sin(math.tau * threads * x) * np.sin(math.tau * threads * y)
    return 0.88 + contrast * pattern + 0.04 * noise(rng, px, 1, 1)


def chevron(rng: np.random.Generator, px: int, *, bands: int, contrast: float) -> Image:
    """Returns herringbone cloth."""
    y, x = grid(px)
    zigzag = np.abs(np.mod(x * bands, 1.0) - 0.5) * 2.0 / bands
    return 0.86 + contrast * np.sign(np.sin(math.tau * bands * 2 * (y + zigzag))) + 0.03 * noise(rng, px, 1, 1)


def cane(rng: np.random.Generator, px: int, *, strands: int) -> Image:
    """Returns wicker: interlaced strands with dark gaps."""
    y, x = grid(px)
    over = (np.floor(x * strands) + np.floor(y * strands)) % 2 == 0
    along = np.where(over, np.mod(y * strands, 1.0), np.mod(x * strands, 1.0))
    return 0.55 + 0.4 * np.sin(math.pi * along) + 0.04 * noise(rng, px, 2, 2)


def spines(rng: np.random.Generator, px: int, *, books: int, colours: tuple[Colour, ...]) -> Image:
    """Returns a row of book spines, one below the other, with titles as lighter bands."""
    y, x = grid(px)
    edges = np.cumsum(rng.uniform(0.6, 1.4, books))
    book = np.searchsorted(edges / edges[-1], y, side="right").clip(0, books - 1)
    tone = rng.uniform(0.75, 1.15, books)[:, None] * np.array(colours)[rng.integers(len(colours), size=books)]
    image = tone[book]
    label = (np.abs(x - rng.uniform(0.55, 0.8, books)[book]) < 0.05) & (rng.random(books) < 0.6)[book]
    image = np.where(label[:, :, None], 0.5 * image + 0.42, image)
    gap = np.abs(np.concatenate([np.diff(book, axis=0), np.ones((1, px))])) > 0
    return np.where(gap[:, :, None], 0.12, image)


def leaves(rng: np.random.Generator, px: int, *, size_px: float) -> Image:
    """Returns foliage seen from a distance: patches of light and shade."""
    return 0.72 + 0.2 * noise(rng, px, size_px, 0.6 * size_px) + 0.1 * noise(rng, px, 1, 1)


# ---- rugs --------------------------------------------------------------------------------------------------------


def rug(rng: np.random.Generator, px: int, *, colours: tuple[Colour, ...], pattern: str) -> Image:
    """Returns the picture of a whole rug: border bands around a field with a pattern."""
    y, x = grid(px)
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
