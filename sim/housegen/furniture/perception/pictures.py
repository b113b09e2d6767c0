"""Pictures of the pool `wide`."""

from __future__ import annotations

from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.item import Look
from sim.housegen.furniture.parts import BOTH_SIDES
from sim.housegen.furniture.workbench import Range, Workbench


def _equal_ranges(low: float, high: float, count: int, gap: float) -> list[Range]:
    """Returns `count` equal ranges between low and high with gaps between them."""
    each = (high - low - (count - 1) * gap) / count
    return [(low + i * (each + gap), low + i * (each + gap) + each) for i in range(count)]


def _sprig(w: Workbench, x: float, y: float, z: float, tall: float, look: Look) -> None:
    """Adds a flat leafy twig."""
    w.box((x - 0.002, x + 0.002), (y - 0.006 * tall, y + 0.006 * tall), (z, z + tall), look, solid=False)
    for k in range(w.whole(3, 6)):
        side, level = (-1 if k % 2 else 1), z + tall * (0.3 + 0.12 * k)
        a = (x, y, level)
        b = (x, y + side * 0.22 * tall, level + 0.12 * tall)
        w.bar(a, b, 0.004, 0.09 * tall, look, solid=False)


def painting(w: Workbench, x: float, y: Range, z: Range) -> None:
    """Adds a painting to a sheet: bands, a twig, blocks or a skyline."""
    wide, tall, kind = y[1] - y[0], z[1] - z[0], w.whole(0, 3)
    if kind == 0:
        cuts = sorted(w.length(0.1, 0.9) for _ in range(w.whole(1, 3)))
        for low, high in zip([0.0, *cuts], [*cuts, 1.0], strict=True):
            if high - low > 0.01:
                w.box((x - 0.004, x), y, (z[0] + low * tall, z[0] + high * tall), w.new_look("paint"), solid=False)
    elif kind == 1:
        size = min(0.7 * tall, 1.2 * wide)
        _sprig(w, x, 0.5 * (y[0] + y[1]), z[0] + 0.5 * (tall - size), size, w.new_look("foliage"))
    elif kind == 2:
        ink = w.look("char")
        for i in range(w.whole(2, 3)):
            level = z[0] + tall * (0.8 - 0.22 * i)
            end = y[0] + wide * w.length(0.4, 0.92)
            w.box((x - 0.004, x), (y[0] + 0.08 * wide, end), (level - 0.07 * tall, level), ink, solid=False)
    else:
        w.box((x - 0.004, x - 0.001), y, z, w.new_look("paint"), solid=False)
        tower = w.new_look("paint")
        for low, high in _equal_ranges(y[0] + 0.05 * wide, y[1] - 0.05 * wide, 4, 0.03 * wide):
            w.box((x - 0.004, x), (low, high), (z[0], z[0] + tall * w.length(0.2, 0.8)), tower, solid=False)


def poster_on_clips(w: Workbench) -> None:
    """Builds an unframed sheet of paper on clips, tape or pins."""
    wide = w.width(0.35, 0.90)
    high = w.height(0.45, 1.10)
    w.mount_height_m = 1.52 - 0.5 * high
    y, z = 0.5 * wide, high - 0.03
    w.box((0.0, 0.003), (-y, y), (0.0, z), w.look(w.choice(("paper", "linen", "paint"))), solid=False)
    margin = w.length(0.0, 0.08)
    low = w.length(0.05, 0.30)
    painting(w, 0.006, (-y + margin, y - margin), (low * z, z - margin - 0.02))
    metal, kind = w.look(w.choice(("dark", "chrome", "brass"))), w.whole(0, 2)
    for side in BOTH_SIDES:
        c = side * (y - w.choice((0.05, 0.25)) * wide)
        if kind == 0:
            w.box((0.0, 0.014), (c - 0.026, c + 0.026), (z - 0.028, z + 0.004), metal, solid=False)
            w.box((0.0, 0.004), (c - 0.010, c + 0.010), (z, z + 0.03), metal, solid=False)
        elif kind == 1:
            w.box(
                (0.0, 0.005), (c - 0.03, c + 0.03), (z - 0.015, z + 0.02), w.look("linen"), solid=False, roll=0.4 * side
            )
        else:
            w.ball((0.008, c, z - 0.015), 0.008, metal, solid=False)


def panorama(w: Workbench) -> None:
    """Builds a very wide, low picture in a deep box frame."""
    wide = w.width(0.90, 1.60)
    high, deep, border = w.height(0.28, 0.48), w.length(0.035, 0.07), w.length(0.012, 0.035)
    w.mount_height_m = 1.52 - 0.5 * high
    y, look = 0.5 * wide, w.look(w.choice(("wood", "dark", "lacquer", "metal")))
    for z in ((0.0, border), (high - border, high)):
        w.box((0.0, deep), (-y, y), z, look)
    for c in ((-y, -y + border), (y - border, y)):
        w.box((0.0, deep), c, (border, high - border), look)
    mat = w.length(0.0, 0.06)
    inner, z = y - border, (border, high - border)
    w.box((0.0, 0.010), (-inner, inner), z, w.look("paper"), solid=False)
    inner, z = inner - mat, (border + mat, high - border - mat)
    tall = z[1] - z[0]
    w.box((0.0, 0.012), (-inner, inner), z, w.new_look("paint"), solid=False)
    w.box((0.0, 0.014), (-inner, inner), (z[0], z[0] + tall * w.length(0.2, 0.5)), w.new_look("paint"), solid=False)
    if w.chance(0.6):
        for low, top in _equal_ranges(-0.9 * inner, 0.9 * inner, w.whole(5, 9), w.length(0.01, 0.08)):
            w.box((0.0, 0.016), (low, top), (z[0], z[0] + tall * w.length(0.25, 0.8)), w.look("dark"), solid=False)


def grid_of_frames(w: Workbench) -> None:
    """Builds three to nine equal small frames in a grid or a row."""
    columns, rows = w.choice(((3, 2), (2, 3), (4, 1), (3, 3), (1, 3), (5, 1)))
    wide = w.width(0.28 * columns, 0.36 * columns)
    high = w.height(0.28 * rows, 0.40 * rows)
    w.mount_height_m = 1.52 - 0.5 * high
    gap, border = w.length(0.03, 0.09), w.length(0.008, 0.02)
    look, thick = w.look(w.choice(("wood", "dark", "bright", "brass"))), w.length(0.015, 0.03)
    same, ink = w.chance(0.5), w.new_look("paint")
    for y in _equal_ranges(-0.5 * wide, 0.5 * wide, columns, gap):
        for z in _equal_ranges(0.0, high, rows, gap):
            w.box((0.0, thick), y, z, look)
            inner_y, inner_z = (y[0] + border, y[1] - border), (z[0] + border, z[1] - border)
            w.box((0.0, thick + 0.002), inner_y, inner_z, w.look("paper"), solid=False)
            pad_y, pad_z = 0.24 * (y[1] - y[0]), 0.24 * (z[1] - z[0])
            colour = ink if same else w.new_look("paint")
            picture = ((y[0] + pad_y, y[1] - pad_y), (z[0] + pad_z, z[1] - pad_z))
            w.box((0.0, thick + 0.004), *picture, colour, solid=False)


def picture_ledge(w: Workbench) -> None:
    """Builds a narrow ledge with framed pictures of different sizes that lean on the wall."""
    wide = w.width(0.80, 1.40)
    deep, top = w.length(0.08, 0.12), 0.04
    y, shelf = 0.5 * wide, w.look(w.choice(("wood", "lacquer", "dark")))
    w.box((0.0, deep), (-y, y), (0.0, 0.018), shelf)
    w.box((deep - 0.012, deep), (-y, y), (0.018, top), shelf)
    spans = _equal_ranges(-y + 0.03, y - 0.03, w.whole(2, 4), w.length(0.01, 0.05))
    highest = 0.0
    for low, high in spans:
        tall = min(w.length(0.9, 1.6) * (high - low), 0.7)
        look, border = w.new_look(w.choice(("wood", "dark", "brass"))), w.length(0.012, 0.035)
        x = w.choice((0.024, 0.034))
        z = (0.018, 0.018 + tall)
        highest = max(highest, z[1])
        w.box((0.0, x), (low, high), z, look)
        inner = ((low + border, high - border), (z[0] + border, z[1] - border))
        w.box((0.0, x + 0.003), *inner, w.look("paper"), solid=False)
        pad = w.length(0.0, 0.05)
        painting(w, x + 0.006, (inner[0][0] + pad, inner[0][1] - pad), (inner[1][0] + pad, inner[1][1] - pad))
    w.mount_height_m = 1.50 - 0.5 * highest


def glass_sandwich(w: Workbench) -> None:
    """Builds a pressed twig between panes in a thin metal rim that hangs on a cord."""
    wide = w.width(0.30, 0.60)
    high, rim = w.height(0.40, 0.80), w.length(0.006, 0.014)
    w.mount_height_m = 1.52 - 0.5 * high
    cord = 0.22 * high
    y, z, metal = 0.5 * wide, high - cord, w.look(w.choice(("brass", "dark", "chrome")))
    w.box((0.0, 0.008), (-y, y), (0.0, z), w.look(w.choice(("bright", "paper", "linen"))), solid=False)
    for c in ((0.0, rim), (z - rim, z)):
        w.box((0.0, 0.018), (-y, y), c, metal)
    for side in BOTH_SIDES:
        c = side * (y - 0.5 * rim)
        w.box((0.0, 0.018), (c - 0.5 * rim, c + 0.5 * rim), (0.0, z), metal)
        w.rod((0.006, 0.8 * side * y, z - 0.005), (0.006, 0.0, high - 0.012), 0.0025, metal, solid=False)
    w.rod((0.0, 0.0, high - 0.012), (0.022, 0.0, high - 0.012), 0.008, w.look("metal"), solid=False)
    green, count = w.look(w.choice(("foliage", "char", "wood"))), w.whole(1, 3)
    for low, top in _equal_ranges(-0.8 * y, 0.8 * y, count, 0.02):
        size = min(0.72 * z, 2.0 * (top - low)) * w.length(0.8, 1.0)
        _sprig(w, 0.010, 0.5 * (low + top), 0.5 * (z - size), size, green)


STYLES = (
    Style("picture", "poster_on_clips", "wide", poster_on_clips, (), "wall"),
    Style("picture", "panorama", "wide", panorama, (), "wall"),
    Style("picture", "grid_of_frames", "wide", grid_of_frames, (), "wall"),
    Style("picture", "picture_ledge", "wide", picture_ledge, (), "wall"),
    Style("picture", "glass_sandwich", "wide", glass_sandwich, (), "wall"),
)
