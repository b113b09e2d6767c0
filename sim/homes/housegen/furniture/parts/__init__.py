"""Parts that several families of furniture share: fronts, cases, plumbing and looks."""

from sim.homes.housegen.furniture.parts.cases import case, open_case, round_top, slab
from sim.homes.housegen.furniture.parts.fronts import (
    FRONT_M,
    GAP_M,
    SHADOW_M,
    PlainHandleKind,
    plain_doors,
    plain_drawers,
)
from sim.homes.housegen.furniture.parts.looks import darker, tinted_glass, wood_look
from sim.homes.housegen.furniture.parts.plumbing import basin, mixer_tap
from sim.homes.housegen.furniture.parts.spans import BOTH_SIDES, around, centred, footprint, inset, on_side, polar

__all__ = [
    "BOTH_SIDES", "FRONT_M", "GAP_M", "SHADOW_M", "PlainHandleKind", "around", "basin", "case", "centred", "darker",
    "footprint", "inset", "mixer_tap", "on_side", "open_case", "plain_doors", "plain_drawers", "polar",
    "round_top", "slab", "tinted_glass", "wood_look",
]  # fmt: skip
