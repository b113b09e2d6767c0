"""The houses that explorers and policies are trained on, and those held back for comparing them."""

from __future__ import annotations

import zlib
from collections.abc import Iterable
from pathlib import Path

from sim.core.interface import ConfigError
from sim.core.invocation import command
from sim.homes.plans.plan import house_of

HELD_BACK = 10
"""One house in this number is held back from training, by a hash of its name."""


def is_held_back(house: str, one_in: int = HELD_BACK) -> bool:
    """Returns whether a house of this name is held back; one of `one_in` is."""
    return zlib.crc32(house.encode()) % one_in == 0


def split_plans(folders: Iterable[Path]) -> tuple[list[Path], list[Path]]:
    """Returns the plans of some folders to train on, and those held back; the storeys of a house stay together.

    Raises:
        ConfigError: a folder has no plan.
    """
    trained: list[Path] = []
    held_back: list[Path] = []
    for folder in folders:
        files = sorted(folder.glob("*.npz"))
        if not files:
            raise ConfigError(f"No plan in '{folder}': `{command('houses', 'plans')}` writes them.")
        for file in files:
            (held_back if is_held_back(house_of(file.stem)) else trained).append(file)
    return trained, held_back
