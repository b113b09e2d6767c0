"""Rugs: flat items on which other furniture may stand; usual retail dimensions: 0.9-2.4 m."""

from __future__ import annotations

from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.parts import around, centred, on_side
from sim.homes.housegen.furniture.workbench import Workbench


def rug(w: Workbench) -> None:
    """Builds a patterned rug."""
    width, depth = w.width(1.4, 2.4), w.depth(0.9, 1.7)
    w.box(centred(depth), centred(width), (0.0, 0.008), w.look("rug"), solid=False)


def round_rug(w: Workbench) -> None:
    """Builds a round rug with rings."""
    r = 0.5 * w.width(1.2, 2.0)
    for i, share in enumerate((1.0, 0.86, 0.5)):
        w.cylinder((0.0, 0.0), (0.0, 0.006 + 0.002 * i), share * r, w.new_look("fabric"), solid=False)


def runner(w: Workbench) -> None:
    """Builds a long narrow striped rug for halls."""
    width, depth = w.width(1.8, 2.8), w.depth(0.65, 0.85)
    w.box(centred(depth), centred(width), (0.0, 0.007), w.look("fabric"), solid=False)
    band = w.look("bright")
    for c in centred(depth, 0.10):
        w.box(around(c, 0.03), centred(width, 0.08), (0.0, 0.010), band, solid=False)


def bordered_rug(w: Workbench) -> None:
    """Builds a thick plain rug with a border."""
    width, depth = w.width(1.5, 2.4), w.depth(1.0, 1.7)
    w.box(centred(depth), centred(width), (0.0, 0.008), w.new_look("fabric"), solid=False)
    w.box(centred(depth, 0.09), centred(width, 0.09), (0.0, 0.012), w.new_look("fabric"), solid=False)


def fringed_rug(w: Workbench) -> None:
    """Builds a patterned rug with fringes at both ends."""
    width, depth = w.width(1.5, 2.4), w.depth(1.0, 1.7)
    w.box(centred(depth), centred(width, 0.06), (0.0, 0.009), w.look("rug"), solid=False)
    for side in (-1, 1):
        fringe = on_side(side, 0.5 * width - 0.065, 0.5 * width)
        w.box(centred(depth), fringe, (0.0, 0.004), w.look("linen"), solid=False)


STYLES = (
    Style("floor", "rug_rectangle", "train", rug, ("rug",), walk_over=True),
    Style("floor", "rug_round", "heldout", round_rug, ("rug",), walk_over=True),
    Style("floor", "rug_runner", "train", runner, ("rug",), walk_over=True),
    Style("floor", "rug_bordered", "train", bordered_rug, ("rug",), walk_over=True),
    Style("floor", "rug_fringed", "heldout", fringed_rug, ("rug",), walk_over=True),
)
