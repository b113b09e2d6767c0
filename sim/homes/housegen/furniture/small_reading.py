"""Small objects of desks and shelves: books in rows and piles, magazines, computers, papers; one palette mesh each.

Usual sizes: books 0.11-0.17 m by 0.17-0.26 m and 1.5-4.5 cm thick, A4 sheets, laptops of 13 and 15 inches.
"""

from __future__ import annotations

from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.parts import around, centred
from sim.homes.housegen.furniture.parts.palette_mesh import (
    ACCENTS,
    CREAM,
    DARK,
    METAL,
    TINT,
    WHITE,
    WOOD,
    PaletteMesh,
    in_one_mesh,
)
from sim.homes.housegen.furniture.workbench import Workbench


def _upright_books(w: Workbench, m: PaletteMesh, count: int, *, graded: bool) -> float:
    """Adds upright books along y from 0 on; returns where the row ends."""
    y = 0.0
    heights = [w.length(0.17, 0.26) for _ in range(count)]
    for high in sorted(heights, reverse=True) if graded else heights:
        thick, deep = w.length(0.02, 0.045), 0.7 * high
        m.box(centred(deep), (y, y + thick - 0.001), (0.0, high), w.choice((*ACCENTS, CREAM, DARK)))
        y += thick
    return y


def book_row(w: Workbench, m: PaletteMesh) -> None:
    """Builds a row of upright books of different heights; the last one leans on the others."""
    end = _upright_books(w, m, w.whole(4, 6), graded=False)
    m.box((-0.07, 0.07), (end + 0.032, end + 0.062), (0.004, 0.206), w.choice(ACCENTS), roll=0.28)


def book_ends(w: Workbench, m: PaletteMesh) -> None:
    """Builds a row of books, the tallest first, between two metal book ends."""
    end = _upright_books(w, m, w.whole(5, 7), graded=True)
    for y, foot in ((-0.004, 0.09), (end, -0.09)):
        m.box((-0.05, 0.05), (y, y + 0.004), (0.0, 0.16), METAL)
        m.box((-0.05, 0.05), tuple(sorted((y, y + foot))), (0.0, 0.003), METAL)  # type: ignore[arg-type]


def book_tower(w: Workbench, m: PaletteMesh) -> None:
    """Builds a pile of books, each turned against the one below, with a cup on top."""
    z = 0.0
    for n in range(w.whole(3, 5)):
        thick, long = w.length(0.018, 0.04), w.length(0.18, 0.25) - 0.012 * n
        colour, turn = w.choice(ACCENTS), w.length(-0.35, 0.35)
        m.box((-0.36 * long, 0.36 * long), centred(long), (z, z + thick), colour, turn=turn)
        m.box(
            (-0.37 * long, 0.30 * long), (-0.51 * long, 0.51 * long), (z + 0.004, z + thick - 0.004), WHITE, turn=turn
        )
        z += thick
    m.cup((0.0, 0.0), (z, z + 0.09), 0.04, w.choice(ACCENTS))


def open_book(w: Workbench, m: PaletteMesh) -> None:
    """Builds an open book with a closed one and a pencil next to it."""
    cover = w.choice(ACCENTS)
    m.box((-0.11, 0.11), (-0.15, 0.15), (0.0, 0.006), cover)
    for side in (-1, 1):
        m.box((-0.105, 0.105), around(side * 0.072, 0.07), (0.004, 0.026), WHITE, roll=side * -0.08)
    m.box((-0.10, 0.08), (0.20, 0.33), (0.0, 0.03), w.choice(ACCENTS), turn=0.3)
    m.box((-0.08, 0.08), (-0.19, -0.183), (0.0, 0.007), WOOD, turn=0.2)


def book_and_glasses(w: Workbench, m: PaletteMesh) -> None:
    """Builds a thick book with a marker, and a pair of spectacles on it."""
    m.box((-0.11, 0.11), (-0.08, 0.08), (0.0, 0.045), w.choice(ACCENTS))
    m.box((-0.10, 0.114), (-0.075, 0.085), (0.006, 0.039), CREAM)
    m.box((-0.03, 0.18), (-0.01, 0.005), (0.0, 0.003), w.choice(ACCENTS))
    for y in (-0.04, 0.04):
        m.round((0.02, y), [(0.045, 0.026), (0.050, 0.026)], TINT, sides=6)
        m.box((-0.09, 0.02), around(1.5 * y, 0.002), (0.045, 0.052), DARK)
    m.box((0.035, 0.04), (-0.06, 0.06), (0.046, 0.052), DARK)


def magazine_fan(w: Workbench, m: PaletteMesh) -> None:
    """Builds four magazines that lie like a fan."""
    for n in range(4):
        y = 0.06 * n
        m.box((-0.14, 0.14), around(y, 0.10), (0.005 * n, 0.005 * n + 0.005), w.choice(ACCENTS), turn=0.25 * n - 0.4)
        m.box((0.05, 0.10), around(y, 0.07), (0.005 * n, 0.005 * n + 0.006), WHITE, turn=0.25 * n - 0.4)


def newspapers(w: Workbench, m: PaletteMesh) -> None:
    """Builds a pile of folded newspapers under a mug."""
    for n in range(3):
        m.box((-0.15, 0.15), (-0.19, 0.19), (0.011 * n, 0.011 * n + 0.011), (WHITE, CREAM)[n % 2], turn=0.1 * n - 0.1)
    m.box((-0.09, -0.02), (-0.15, 0.04), (0.03, 0.034), DARK, turn=0.1)
    m.cup((0.07, 0.09), (0.033, 0.125), 0.042, w.choice(ACCENTS))


def laptop(w: Workbench, m: PaletteMesh) -> None:
    """Builds an open laptop, with a mouse next to it."""
    body = w.choice((METAL, DARK))
    m.box((-0.12, 0.12), (-0.17, 0.17), (0.0, 0.016), body)
    m.box((-0.09, 0.02), (-0.15, 0.15), (0.015, 0.0175), DARK)
    m.box((-0.146, -0.138), (-0.17, 0.17), (0.01, 0.235), body, tilt=-0.3)
    m.box((-0.1395, -0.135), (-0.16, 0.16), (0.02, 0.225), w.choice((TINT, ACCENTS[1])), tilt=-0.3)
    m.box((-0.03, 0.07), (0.22, 0.28), (0.0, 0.03), DARK)


def tablet_keyboard(w: Workbench, m: PaletteMesh) -> None:
    """Builds a tablet on a stand behind a keyboard, with a mug."""
    m.box((0.03, 0.15), (-0.20, 0.20), (0.0, 0.015), w.choice((WHITE, METAL)))
    m.box((0.04, 0.14), (-0.18, 0.18), (0.012, 0.019), DARK)
    m.box((-0.11, 0.0), (-0.05, 0.05), (0.0, 0.012), METAL)
    m.box((-0.06, -0.05), (-0.13, 0.13), (0.01, 0.20), DARK, tilt=-0.25)
    m.box((-0.0535, -0.045), (-0.12, 0.12), (0.02, 0.19), TINT, tilt=-0.25)
    m.cup((-0.02, 0.20), (0.0, 0.10), 0.042, w.choice(ACCENTS))


def papers(w: Workbench, m: PaletteMesh) -> None:
    """Builds sheets of paper that lie askew, and a pen holder."""
    for n, turn in enumerate((-0.12, 0.05, 0.3)):
        m.box((-0.148, 0.148), (-0.105, 0.105), (0.003 * n, 0.003 * n + 0.003), (WHITE, CREAM, WHITE)[n], turn=turn)
    m.box((-0.05, 0.08), (0.0, 0.008), (0.009, 0.016), w.choice(ACCENTS), turn=0.6)
    m.cup((-0.05, 0.20), (0.0, 0.10), 0.042, w.choice(ACCENTS), sides=6)
    for n in range(3):
        m.box(
            (-0.056 + 0.008 * n, -0.048 + 0.008 * n),
            (0.185, 0.193),
            (0.02, 0.15),
            w.choice(ACCENTS),
            roll=0.15 * n - 0.1,
        )


def folders(w: Workbench, m: PaletteMesh) -> None:
    """Builds three upright folders and a tray of papers."""
    for n in range(w.whole(2, 4)):
        m.box((-0.14, 0.14), (0.062 * n, 0.062 * n + 0.06), (0.0, 0.31), w.choice((*ACCENTS, DARK)))
        m.box((0.138, 0.1415), (0.062 * n + 0.012, 0.062 * n + 0.048), (0.16, 0.26), WHITE)
    m.box((-0.14, 0.14), (-0.26, -0.03), (0.0, 0.012), METAL)
    m.box((-0.13, 0.14), (-0.25, -0.04), (0.01, 0.04), WHITE, turn=0.04)


STYLES = (
    Style("objects", "book_row", "train", in_one_mesh(book_row), ("top", "office", "shelf"), "top"),
    Style("objects", "open_book", "train", in_one_mesh(open_book), ("top", "office", "bedside"), "top"),
    Style("objects", "magazine_fan", "train", in_one_mesh(magazine_fan), ("top", "low"), "top"),
    Style("objects", "laptop", "train", in_one_mesh(laptop), ("office",), "top"),
    Style("objects", "papers", "train", in_one_mesh(papers), ("office",), "top"),
    Style("objects", "book_ends", "heldout", in_one_mesh(book_ends), ("top", "office", "shelf"), "top"),
    Style("objects", "book_tower", "heldout", in_one_mesh(book_tower), ("top", "low", "shelf"), "top"),
    Style("objects", "book_and_glasses", "heldout", in_one_mesh(book_and_glasses), ("bedside", "top"), "top"),
    Style("objects", "newspapers", "heldout", in_one_mesh(newspapers), ("low",), "top"),
    Style("objects", "tablet_keyboard", "heldout", in_one_mesh(tablet_keyboard), ("office",), "top"),
    Style("objects", "folders", "heldout", in_one_mesh(folders), ("office",), "top"),
)
