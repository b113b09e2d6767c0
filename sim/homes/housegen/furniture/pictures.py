"""Pictures.

Usual retail dimensions: 0.30-1.40 m wide, the middle hangs at 1.45-1.60 m.
"""

from __future__ import annotations

from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.item import Look
from sim.homes.housegen.furniture.parts import around, centred, inset
from sim.homes.housegen.furniture.parts.flat_pictures import Page, photograph
from sim.homes.housegen.furniture.parts.palette_mesh import PaletteMesh
from sim.homes.housegen.furniture.shapes import named_mesh
from sim.homes.housegen.furniture.workbench import Workbench


def frame(w: Workbench, width: float, height: float, border: float, thick: float, look: Look) -> None:
    """Adds four mouldings around a rectangle on the wall; its lower edge is at z = 0."""
    y = 0.5 * width
    w.box((0.0, thick), (-y, y), (0.0, border), look)
    w.box((0.0, thick), (-y, y), (height - border, height), look)
    for c in inset((-y, y), 0.5 * border):
        w.box((0.0, thick), around(c, 0.5 * border), (border, height - border), look)


def _distinct_paints(w: Workbench, count: int) -> list[Look]:
    """Draws looks of paint that differ from each other as long as there are enough of them."""
    looks = [w.new_look("paint")]
    while len(looks) < count:
        drawn = [w.new_look("paint") for _ in range(8)]
        looks.append(next((look for look in drawn if look not in looks), drawn[0]))
    return looks


def framed_abstract(w: Workbench) -> None:
    """Builds a framed sheet with a mat and three to five coloured shapes."""
    width, height = w.width(0.40, 1.00), w.height(0.40, 0.90)
    w.mount_height_m = 1.52 - 0.5 * height
    border = w.length(0.02, 0.045)
    frame(w, width, height, border, 0.03, w.look("wood") if w.chance(0.6) else w.look("dark"))
    w.box((0.0, 0.012), centred(width, border), (border, height - border), w.look("paper"), solid=False)
    inner_y, inner_z = 0.5 * width - border - 0.04, 0.5 * height - border - 0.04
    for i in range(w.whole(3, 5)):
        dy, dz = w.length(0.2, 0.6) * inner_y, w.length(0.2, 0.6) * inner_z
        y = w.length(-1.0, 1.0) * (inner_y - dy)
        z = 0.5 * height + w.length(-1.0, 1.0) * (inner_z - dz)
        x = 0.013 + 0.002 * i
        if w.chance(0.5):
            w.box((0.010, x), around(y, dy), around(z, dz), w.new_look("paint"), solid=False)
        else:
            w.rod_x((y, z), (0.010, x), min(dy, dz), w.new_look("paint"), solid=False)


def canvas_landscape(w: Workbench) -> None:
    """Builds an unframed canvas with a sky, a sun and bands of hills."""
    width, height = w.width(0.60, 1.20), w.height(0.45, 0.80)
    w.mount_height_m = 1.52 - 0.5 * height
    sky, sun, *hills = _distinct_paints(w, 5)
    w.box((0.0, 0.032), centred(width), (0.0, height), sky)
    x = 0.034
    w.rod_x((0.22 * width, 0.70 * height), (0.03, x), 0.12 * height, sun, solid=False)
    for i, look in enumerate(hills):
        x += 0.002
        low, peak, at = 0.16 * height * (2 - i), (0.62 - 0.17 * i) * height, w.length(-0.3, 0.3)
        ridge = [(at - 0.2, peak - 0.06), (at, peak), (at + 0.2, peak - 0.05)]
        outline = [(-0.5, 0.0), (-0.5, low), *((min(max(y, -0.5), 0.5), z) for y, z in ridge), (0.5, low), (0.5, 0.0)]
        hill = named_mesh("hill", [(dx, y * width, z) for dx in (0.03, x) for y, z in outline])
        w.mesh(hill, (0.0, 0.0, 0.0), look, solid=False)


def triptych(w: Workbench) -> None:
    """Builds three unframed canvases side by side that share one composition of bands."""
    width, height = w.width(0.80, 1.40), w.height(0.45, 0.75)
    w.mount_height_m = 1.52 - 0.5 * height
    pitch, gap = (width - 0.08) / 3, 0.04
    ground, *bands = _distinct_paints(w, 3)
    for i in range(3):
        y0 = -0.5 * width + i * (pitch + gap)
        w.box((0.0, 0.030), (y0, y0 + pitch), (0.0, height), ground)
        level = height * (0.62 - 0.12 * i)
        w.box((0.025, 0.033), (y0, y0 + pitch), (0.0, level), bands[0], solid=False)
        w.box((0.025, 0.036), (y0, y0 + pitch), (0.0, 0.45 * level), bands[1], solid=False)
    w.rod_x((0.30 * width, 0.75 * height), (0.025, 0.033), 0.09 * height + 0.02, bands[1], solid=False)


def portrait(w: Workbench) -> None:
    """Builds a portrait with head and shoulders in a broad gilt frame."""
    width, height = w.width(0.40, 0.65), w.height(0.55, 0.85)
    w.mount_height_m = 1.52 - 0.5 * height
    border = 0.065
    inner = 0.5 * width - border
    frame(w, width, height, border, 0.045, w.look("brass"))
    w.box((0.0, 0.012), (-inner, inner), (border, height - border), w.new_look("paint"), solid=False)
    coat = [
        (x, y, z)
        for x in (0.0, 0.004)
        for y, z in ((-0.9, 0.0), (0.9, 0.0), (-0.75, 0.16), (0.75, 0.16), (-0.3, 0.27), (0.3, 0.27))
    ]
    scaled = [(x, y * inner, z * height) for x, y, z in coat]
    w.mesh(named_mesh("coat", scaled), (0.012, 0.0, border), w.new_look("book"), solid=False)
    w.ellipsoid((0.014, 0.0, 0.61 * height), (0.006, 0.42 * inner, 0.15 * height), w.new_look("paint"), solid=False)
    w.ellipsoid((0.018, 0.0, 0.57 * height), (0.006, 0.32 * inner, 0.13 * height), w.look("skin"), solid=False)


def photo_group(w: Workbench) -> None:
    """Builds a group of four to six small frames."""
    columns, rows = w.whole(2, 3), 2
    width, height = w.width(0.70, 1.10), w.height(0.60, 0.80)
    w.mount_height_m = 1.52 - 0.5 * height
    frame, paper = w.look("dark") if w.chance(0.5) else w.look("wood"), w.look("paper")
    cell_y, cell_z, photos = width / columns, height / rows, PaletteMesh()
    for i in range(columns):
        for j in range(rows):
            y0, z0 = -0.5 * width + i * cell_y, j * cell_z
            pad_y, pad_z = (0.0 if i == 0 else 0.02), (0.0 if j == 0 else 0.02)
            y, z = (
                (y0 + pad_y, y0 + cell_y - (0.0 if i == columns - 1 else 0.02)),
                (z0 + pad_z, z0 + cell_z - (0.0 if j == rows - 1 else 0.02)),
            )
            w.box((0.0, 0.022), y, z, frame)
            w.box((0.018, 0.024), inset(y, 0.018), inset(z, 0.018), paper, solid=False)
            inner = inset(y, 0.055), inset(z, 0.055)
            photograph(w, Page(0.024, *inner, mesh=photos))
    photos.put(w)


def still_life(w: Workbench) -> None:
    """Builds a framed still life with the edge of a table, a vase and fruit."""
    width, height = w.width(0.50, 0.90), w.height(0.45, 0.75)
    w.mount_height_m = 1.52 - 0.5 * height
    border = 0.04
    frame(w, width, height, border, 0.03, w.look("wood"))
    y, z = centred(width, border), (border, height - border)
    w.box((0.0, 0.012), y, z, w.look("linen"), solid=False)
    table = border + 0.28 * height
    w.box((0.0, 0.014), y, (border, table), w.new_look("book"), solid=False)
    w.ellipsoid(
        (0.014, -0.16 * width, table + 0.13 * height),
        (0.005, 0.09 * width, 0.17 * height),
        w.new_look("paint"),
        solid=False,
    )
    w.box(
        (0.0, 0.017),
        (-0.19 * width, -0.13 * width),
        (table + 0.26 * height, table + 0.36 * height),
        w.new_look("paint"),
        solid=False,
    )
    for i, c in enumerate((0.06, 0.18, 0.30)):
        w.rod_x(
            (c * width, table + 0.05 * height),
            (0.0, 0.016 + 0.002 * i),
            0.07 * height,
            w.new_look("paint"),
            solid=False,
        )


def scroll(w: Workbench) -> None:
    """Builds a hanging scroll: cloth between two rods with a sun over mountains."""
    width, height = w.width(0.40, 0.70), w.height(0.90, 1.30)
    w.mount_height_m = 1.45 - 0.5 * height
    wood, y = w.look("wood"), 0.5 * width
    for z in (0.02, height - 0.02):
        w.rod_y((0.02, z), (-y, y), 0.018, wood)
    w.box((0.0, 0.02), (-y + 0.03, y - 0.03), (0.02, height - 0.02), w.look("paper"))
    w.box((0.018, 0.024), (-y + 0.07, y - 0.07), (0.18 * height, 0.86 * height), w.look("linen"), solid=False)
    w.rod_x((0.2 * width, 0.72 * height), (0.018, 0.028), 0.11 * width, w.new_look("paint"), solid=False)
    for i, (c, high) in enumerate(((-0.12, 0.34), (0.14, 0.24))):
        hill = named_mesh(
            "hill",
            [
                (dx, dy, dz)
                for dx in (0.0, 0.004)
                for dy, dz in ((-0.24 * width, 0.0), (0.24 * width, 0.0), (0.0, high * height))
            ],
        )
        w.mesh(hill, (0.022 + 0.003 * i, c * width, 0.18 * height), w.new_look("paint"), solid=False)


def tondo(w: Workbench) -> None:
    """Builds a round picture of nested circles in a thick ring."""
    r = 0.5 * w.width(0.50, 0.90)
    w.mount_height_m = 1.52 - r
    w.rod_x((0.0, r), (0.0, 0.030), r, w.look("wood"))
    w.rod_x((0.0, r), (0.0, 0.033), 0.88 * r, w.new_look("paint"), solid=False)
    w.rod_x((0.2 * r, 1.1 * r), (0.0, 0.036), 0.55 * r, w.new_look("paint"), solid=False)
    w.rod_x((-0.25 * r, 0.8 * r), (0.0, 0.039), 0.32 * r, w.new_look("paint"), solid=False)


STYLES = (
    Style("picture", "framed_abstract", "train", framed_abstract, (), "wall"),
    Style("picture", "canvas_landscape", "heldout", canvas_landscape, (), "wall"),
    Style("picture", "triptych", "train", triptych, (), "wall"),
    Style("picture", "portrait", "train", portrait, (), "wall"),
    Style("picture", "photo_group", "train", photo_group, (), "wall"),
    Style("picture", "still_life", "train", still_life, (), "wall"),
    Style("picture", "scroll", "heldout", scroll, (), "wall"),
    Style("picture", "tondo", "heldout", tondo, (), "wall"),
)
