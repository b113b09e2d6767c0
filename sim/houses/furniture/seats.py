"""Seating that is neither chair nor sofa nor stool: benches, ottomans, poufs, bean bags.

Ranges after Panero & Zelnik, Human Dimension and Interior Space (benches 0.42-0.47 m high, 0.35-0.45 m deep,
0.90-1.50 m wide) and usual retail dimensions of poufs (0.40-0.60 m across).
"""

from __future__ import annotations

from sim.houses.furniture.catalogue import Style
from sim.houses.furniture.shapes import (
    Ring,
    chamfered_box,
    loft,
)
from sim.houses.furniture.workbench import Workbench

_BOTH = (-1, 1)


def bench_wood(w: Workbench) -> None:
    """Wooden hall bench with a thin pad."""
    width, depth, seat, wood = w.width(0.90, 1.40), w.depth(0.34, 0.42), w.length(0.42, 0.46), w.look("wood")
    x, y = (-0.5 * depth, 0.5 * depth), (-0.5 * width, 0.5 * width)
    w.box(x, y, (seat - 0.04, seat), wood)
    w.mesh(chamfered_box((depth - 0.03, width - 0.06, 0.05), 0.015), (0.0, 0.0, seat + 0.02), w.look("fabric"))
    w.legs((x[0] + 0.02, x[1] - 0.02), (y[0] + 0.05, y[1] - 0.05), (0.0, seat - 0.04), 0.05, wood)
    w.box((-0.02, 0.02), (y[0] + 0.08, y[1] - 0.08), (0.16, 0.20), wood)
    for side in _BOTH:
        edge = side * (0.5 * width - 0.075)
        w.box((x[0] + 0.04, x[1] - 0.04), (edge - 0.015, edge + 0.015), (0.16, 0.20), wood)
    w.top(x, (y[0] + 0.1, y[1] - 0.1), seat + 0.045, "seat")


def ottoman(w: Workbench) -> None:
    """Upholstered block with a lid seam on short legs."""
    width, depth, height, cloth = w.width(0.55, 1.20), w.depth(0.45, 0.60), w.length(0.40, 0.46), w.look("fabric")
    w.box(
        (-0.5 * depth + 0.01, 0.5 * depth - 0.01),
        (-0.5 * width + 0.01, 0.5 * width - 0.01),
        (0.08, height - 0.12),
        cloth,
    )
    w.mesh(chamfered_box((depth, width, 0.13), 0.03), (0.0, 0.0, height - 0.065), cloth)
    w.legs(
        (-0.5 * depth + 0.03, 0.5 * depth - 0.03),
        (-0.5 * width + 0.03, 0.5 * width - 0.03),
        (0.0, 0.085),
        0.045,
        w.look("wood"),
    )
    w.top((-0.4 * depth, 0.4 * depth), (-0.4 * width, 0.4 * width), height, "seat")


def pouf(w: Workbench) -> None:
    """Round knitted pouf."""
    w.mass_kg = 4.0
    r, height = 0.5 * w.length(0.45, 0.60), w.length(0.34, 0.42)
    w.mesh(
        loft(
            [
                Ring(0.0, 0.75 * r, 0.75 * r),
                Ring(0.25 * height, r, r),
                Ring(0.75 * height, r, r),
                Ring(height, 0.7 * r, 0.7 * r),
            ],
            16,
            hull=True,
        ),
        (0.0, 0.0, 0.0),
        w.look("bright"),
    )
    w.cylinder((0.0, 0.0), (height, height + 0.008), 0.03, w.look("dark"), solid=False)


STYLES = (
    Style("seating", "bench_wood", "train", bench_wood, ("bench",)),
    Style("seating", "ottoman", "train", ottoman, ("ottoman", "bench")),
    Style("seating", "pouf", "heldout", pouf, ("ottoman", "bench")),
)
