"""The options of commands that can read one house file in place of a split."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from sim.core.errors import ConfigError
from sim.episodes.splits import labels_of
from sim.houses.house import House
from sim.houses.load import load_house


@dataclass(frozen=True, kw_only=True)
class HouseFile:
    """The options of one house file."""

    house: Path | None = None
    """One MJCF file, in place of a split or of other houses."""
    labels: Path | None = None
    """With --house: a JSON file {"regex over names": "category"} for a house that has other names."""
    root: Path | None = None
    """With --house: a folder whose files the house may use in addition to its own folder."""

    def check_house(self) -> None:
        """Raises ConfigError if --labels or --root is given without --house."""
        if self.house is None and (self.labels is not None or self.root is not None):
            raise ConfigError("--labels and --root need --house.")

    def load(self) -> House:
        """Returns the house of --house."""
        assert self.house is not None
        return load_house(self.house, labels_path=self.labels or labels_of(self.house.parent), root=self.root)
