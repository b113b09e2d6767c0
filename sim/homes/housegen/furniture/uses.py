"""The uses by which rooms ask for furniture, and the check of the uses that a style declares.

Rooms ask for an item by category and use (`source.make("chair", "dining")`). A style with another use, or without a use
where rooms ask by use, would not appear in any house.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

USES: Mapping[str, tuple[str, ...]] = MappingProxyType({
    "chair": ("dining", "office", "arm"),
    "stool": ("bar", "low"),
    "seating": ("bench", "plain", "ottoman"),
    "sofa": ("corner",),
    "cushion": ("throw", "floor"),
    "table": ("dining", "coffee", "desk", "side", "nightstand", "console"),
    "bed": (),
    "cabinet": ("wardrobe", "sideboard", "display", "media", "kitchen_wall", "vanity"),
    "chest_of_drawers": ("dresser", "nightstand"),
    "shelving": ("bookcase", "laundry", "linen", "wall"),
    "counter": ("run", "island"),
    "sink": ("standing", "vessel", "inset"),
    "toilet": (),
    "shower": (),
    "bathtub": (),
    "towel": ("rail", "floor", "top"),
    "clothes": ("rack", "drying", "hooks", "floor", "top"),
    "tv_monitor": ("tv", "tv_wall", "monitor", "tv_floor"),
    "mirror": ("wall", "standing"),
    "picture": (),
    "board_panel": (),
    "curtain": (),
    "blinds": (),
    "plant": ("floor", "top"),
    "lighting": ("ceiling", "floor", "table", "wall"),
    "fireplace": (),
    "appliances": (
        "fridge", "stove", "washing_machine", "dishwasher", "microwave", "small", "hood", "hob",
    ),
    "gym_equipment": ("machine", "weights", "small"),
    "objects": (
        "top", "shelf", "office", "bedside", "low", "media", "dresser", "entry", "table", "kitchen", "bath", "floor",
        "bin", "box", "shoes", "bag", "toy", "cable", "flat", "toilet_paper", "bath_wall",
    ),
    "furniture": ("piano", "screen"),
    "floor": ("rug",),
    "column": (),
    "railing": (),
})  # fmt: skip
"""The uses by which rooms ask for an item of each category; the table of `Catalogue.make_item` explains them."""
USE_OPTIONAL: frozenset[str] = frozenset({"sofa"})
"""Categories with uses for which rooms also ask without a use."""


def fault_of_uses(category: str, uses: tuple[str, ...]) -> str:
    """Returns a sentence on a fault in the uses of a style, or "" if they are valid.

    The uses of a category that is not in `USES` are free: no room of the shipped generator asks for it.
    """
    if isinstance(uses, str):
        return f"`uses` must be a tuple of strings, such as ('{uses}',), got the string '{uses}'."
    allowed = USES.get(category)
    if allowed is None:
        return ""
    unknown = [use for use in uses if use not in allowed]
    if unknown and not allowed:
        return f"category '{category}' has no uses, but `uses` has '{unknown[0]}'. Leave it empty."
    if unknown:
        return f"category '{category}' has no use '{unknown[0]}'. Available: {', '.join(allowed)}."
    if allowed and not uses and category not in USE_OPTIONAL:
        return f"`uses` is empty, but rooms ask for a '{category}' by its use. Available: {', '.join(allowed)}."
    return ""
