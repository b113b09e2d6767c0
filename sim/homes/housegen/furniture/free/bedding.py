"""Mattresses, quilts and pillows."""

from __future__ import annotations

import numpy as np

from sim.homes.housegen.furniture import parts
from sim.homes.housegen.furniture.item import MeshShape
from sim.homes.housegen.furniture.shapes import chamfered_box, frustum, named_mesh, pillow
from sim.homes.housegen.furniture.workbench import Workbench


def mattress_size(w: Workbench, widest: float = 1.80) -> tuple[float, float]:
    """Returns (length, width) of a mattress; hint `width_m` selects the largest width that is not above it."""
    hinted = w.hints.get("width_m")
    widths = [v for v in (0.80, 0.90, 1.00, 1.20, 1.40, 1.60, 1.80) if v <= widest + 1e-6]
    if hinted is not None:
        width = max((v for v in widths if v <= float(hinted) + 1e-6), default=0.80)
    else:
        width = w.choice(widths[1:])
    return w.choice((1.90, 1.95, 2.00, 2.05, 2.10)), width


def _unmade_quilt(w: Workbench, length: float, width: float, thick: float, hang: float) -> MeshShape:
    """Returns the mesh of an unmade quilt, from a skewed head edge to x = `length`, hanging down at its sides."""
    n, m = 7, 7
    xs, ys = np.linspace(0.0, 1.0, n), np.linspace(-0.5, 0.5, m)
    skew, bumps = w.rng.uniform(-0.35, 0.35), w.rng.uniform(0.4, 1.6, (n, m))
    start = 0.5 * abs(skew) * width + skew * ys * width + w.rng.uniform(0.0, 0.08, m)
    top, bottom = [], []
    for i in range(n):
        for j in range(m):
            edge = j in (0, m - 1)
            x, y = start[j] + (length - start[j]) * xs[i], ys[j] * width * (1.02 if edge else 1.0)
            z = 0.35 * thick if edge or i in (0, n - 1) else thick * bumps[i, j]
            top.append((x, y, z))
            bottom.append((x, y, -hang * (w.rng.uniform(0.6, 1.0) if edge or i == n - 1 else 0.1)))
    faces: list[tuple[int, int, int]] = []
    k = n * m
    for i in range(n - 1):
        for j in range(m - 1):
            a, b, c, d = i * m + j, (i + 1) * m + j, (i + 1) * m + j + 1, i * m + j + 1
            faces += [(a, b, c), (a, c, d), (k + a, k + c, k + b), (k + a, k + d, k + c)]
    rim = [*range(m - 1), *(i * m + m - 1 for i in range(n - 1))]
    rim += [*((n - 1) * m + j for j in range(m - 1, 0, -1)), *(i * m for i in range(n - 1, 0, -1))]
    for a, b in zip(rim, [*rim[1:], rim[0]], strict=True):
        faces += [(a, b, k + b), (a, k + b, k + a)]
    return named_mesh("quilt", top + bottom, faces)


def _pillows(w: Workbench, x: float, width: float, top: float) -> None:
    """Adds one or two layers of pillows, lying or leaning on the headboard, and sometimes a small cushion."""
    places = 2 if width > 1.1 else 1
    each = min(w.length(0.5, 0.8), width / places - 0.04)
    standing = w.chance(0.35)
    for layer in range(w.choice((1, 1, 2))):
        look = w.new_look("linen") if w.chance(0.5) else w.new_look("bedding")
        for i in range(places):
            y = (i - 0.5 * (places - 1)) * width / places + w.rng.uniform(-0.03, 0.03)
            if standing:
                w.mesh(pillow((0.44, each, 0.15), 4.0), (x + 0.17 + 0.12 * layer, y, top + 0.20), look, tilt=1.15)
            else:
                shape = pillow((w.length(0.38, 0.5), each, w.length(0.1, 0.17)), 4.0)
                w.mesh(shape, (x + 0.27 + 0.12 * layer, y, top + 0.045 + 0.08 * layer), look, tilt=-0.1)
    if w.chance(0.25):
        w.mesh(pillow((0.40, 0.42, 0.14), 4.0), (x + 0.55, 0.0, top + 0.15), w.new_look("fabric"), tilt=0.9)


def bedding(w: Workbench, x0: float, length: float, width: float, top: float, thick: float, hang: float) -> None:
    """Adds a mattress from x0 towards the foot with tucked, crumpled, folded or spread bedding, and pillows."""
    linen, duvet, x1 = w.look("linen"), w.look("bedding"), x0 + length
    w.mesh(
        chamfered_box((length, width, thick), min(0.05, 0.3 * thick)), (0.5 * (x0 + x1), 0.0, top - 0.5 * thick), linen
    )
    kind = w.choice(("tucked", "rumpled", "rumpled", "folded", "spread"))
    cover = length
    if kind == "tucked":
        cover = w.length(0.62, 0.85) * length
        size = (cover, width + 0.02, thick - 0.02)
        w.mesh(chamfered_box(size, 0.03), (x1 - 0.5 * cover + 0.01, 0.0, top - 0.5 * size[2] + 0.018), duvet)
        w.box(
            (x1 - cover - 0.01, x1 - cover + w.length(0.15, 0.35)),
            parts.centred(0.0, width + 0.03),
            (top - 0.5 * thick, top + 0.025),
            w.new_look("linen"),
        )
    elif kind == "rumpled":
        cover = w.length(0.5, 0.8) * length
        shape = _unmade_quilt(w, cover, width + 0.06, w.length(0.05, 0.11), min(hang, thick + 0.05))
        w.mesh(shape, (x1 - cover + 0.02, 0.0, top), duvet)
    elif kind == "folded":
        cover = w.length(0.35, 0.6)
        size = (cover, width * w.length(0.6, 0.98), w.length(0.12, 0.2))
        w.mesh(chamfered_box(size, 0.05), (x1 - 0.5 * cover - 0.06, 0.0, top + 0.5 * size[2] - 0.01), duvet)
        w.box((x0 + 0.05, x1 - 0.02), parts.centred(0.0, width + 0.006), (top - 0.06, top + 0.004), w.new_look("linen"))
    else:
        cover = length - w.length(0.0, 0.5)
        flare = hang * 0.15
        spread = frustum((cover + 0.06, width + 0.06 + flare), (cover, width + 0.03), hang + 0.03)
        w.mesh(spread, (x1 - 0.5 * cover + 0.03, 0.0, top - hang), duvet, solid=False)
        if w.chance(0.5):
            strip = w.length(0.4, 0.6)
            z = (top - 0.3 * hang, top + 0.04)
            w.box(
                parts.centred(x1 - 0.35, strip), parts.centred(0.0, width + 0.05), z, w.new_look("fabric"), solid=False
            )
    _pillows(w, x0, width, top + (0.03 if kind == "spread" and cover > length - 0.2 else 0.0))
    w.top((x1 - 0.9, x1 - 0.2), (-0.5 * width + 0.15, 0.5 * width - 0.15), top + 0.05, "seat")
