"""Confusions of categories by a segmentation network: the table of `--semantics noisy`.

A row is a true category; its entries are the wrong categories with their shares of the errors. A row that sums to less
than 1 reduces the error rate of its category by that factor; a category without a row has no errors. The groups are
those that indoor networks confuse: seats, fronts of furniture, flat objects on a wall, cloth, ceramics. The shares are
an assumption, not a measurement of a network.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

CONFUSIONS: Mapping[str, Mapping[str, float]] = MappingProxyType(
    {
        # seats and beds
        "chair": {"seating": 0.35, "stool": 0.35, "sofa": 0.3},
        "stool": {"chair": 0.45, "table": 0.3, "seating": 0.25},
        "sofa": {"seating": 0.4, "bed": 0.35, "chair": 0.25},
        "seating": {"sofa": 0.45, "chair": 0.35, "stool": 0.2},
        "bed": {"sofa": 0.6, "seating": 0.2},
        "cushion": {"clothes": 0.3, "seating": 0.2, "objects": 0.3},
        # tops and fronts
        "table": {"counter": 0.45, "chest_of_drawers": 0.25, "stool": 0.15, "cabinet": 0.15},
        "counter": {"table": 0.45, "cabinet": 0.35, "chest_of_drawers": 0.2},
        "cabinet": {"chest_of_drawers": 0.45, "counter": 0.25, "shelving": 0.3},
        "chest_of_drawers": {"cabinet": 0.5, "table": 0.25, "counter": 0.25},
        "shelving": {"cabinet": 0.6, "chest_of_drawers": 0.3},
        "appliances": {"cabinet": 0.4, "counter": 0.3, "fireplace": 0.2},
        "furniture": {"chest_of_drawers": 0.35, "table": 0.35, "seating": 0.3},
        "fireplace": {"cabinet": 0.3, "appliances": 0.2, "shelving": 0.2},
        "door": {"cabinet": 0.3},
        # flat on a wall
        "picture": {"tv_monitor": 0.35, "mirror": 0.25, "window": 0.3},
        "tv_monitor": {"picture": 0.5, "mirror": 0.2, "window": 0.2},
        "mirror": {"picture": 0.4, "tv_monitor": 0.3, "window": 0.3},
        "window": {"picture": 0.3, "mirror": 0.2, "tv_monitor": 0.1},
        "board_panel": {"picture": 0.6, "tv_monitor": 0.3},
        # cloth
        "towel": {"clothes": 0.5, "curtain": 0.4},
        "clothes": {"towel": 0.45, "curtain": 0.35, "cushion": 0.2},
        "curtain": {"clothes": 0.35, "towel": 0.35, "shower": 0.3},
        "blinds": {"curtain": 0.5, "window": 0.5},
        # bathroom
        "sink": {"counter": 0.4, "toilet": 0.2, "bathtub": 0.1},
        "toilet": {"sink": 0.35, "stool": 0.15},
        "shower": {"bathtub": 0.5, "door": 0.2, "curtain": 0.2},
        "bathtub": {"shower": 0.5, "sink": 0.25, "counter": 0.25},
        # the rest
        "plant": {"objects": 0.4, "clothes": 0.1},
        "gym_equipment": {"chair": 0.25, "stool": 0.2, "objects": 0.4},
        "lighting": {"plant": 0.3, "objects": 0.3},
        "objects": {"plant": 0.25, "cushion": 0.25, "towel": 0.15, "sink": 0.1, "gym_equipment": 0.1},
    }
)
"""Shares of the wrong categories for each true category; see the module."""
