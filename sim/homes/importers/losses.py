"""Counts by kind, for the report, of everything that an import read, changed and lost."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any


@dataclass
class Losses:
    """Counts of one house, which its import fills."""

    furniture: Counter[str] = field(default_factory=Counter)
    """Objects with a category that became a piece of our furniture, or kept their own geometry, by type."""
    boxes: Counter[str] = field(default_factory=Counter)
    """Objects that became a labelled box, ball or cylinder, by type."""
    left_out: Counter[str] = field(default_factory=Counter)
    """Objects that were left out, by "type: reason"."""
    changes: Counter[str] = field(default_factory=Counter)
    """Other differences from the source, each a sentence."""
    moved_m: float = 0.0
    """Largest distance in plan by which an object was moved, out of a wall or onto a surface."""

    def as_json(self) -> dict[str, object]:
        """Returns the counts for a JSON file, the most frequent first."""
        return {
            "furniture": dict(self.furniture.most_common()),
            "boxes": dict(self.boxes.most_common()),
            "left_out": dict(self.left_out.most_common()),
            "changes": dict(self.changes.most_common()),
            "moved_m": round(self.moved_m, 3),
        }


def added(reports: Iterable[Mapping[str, Any]]) -> Losses:
    """Returns the counts of several houses together."""
    total = Losses()
    for report in reports:
        for name in ("furniture", "boxes", "left_out", "changes"):
            getattr(total, name).update(report[name])
        total.moved_m = max(total.moved_m, report["moved_m"])
    return total
