"""Types of options: each states the range of its values, or that it is a path which the command writes."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Annotated

from msgspec import Meta

from sim.core.reading import Seed as Seed


@dataclasses.dataclass(frozen=True)
class Written:
    """Marks an option as the path that the command writes."""

    folder: bool


Count = Annotated[int, Meta(ge=1, le=10_000_000)]
"""A count, at least 1."""
Amount = Annotated[int, Meta(ge=0, le=10_000_000)]
"""A count, at least 0."""
Share = Annotated[float, Meta(ge=0.0, le=1.0)]
Positive = Annotated[float, Meta(gt=0.0, le=1e9)]
NotNegative = Annotated[float, Meta(ge=0.0, le=1e9)]
OutFile = Annotated[Path, Written(folder=False)]
OutFolder = Annotated[Path, Written(folder=True)]
