"""All families of traps by name, in the order of the episodes of the splits `contact-*`."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import NamedTuple

from sim.homes.housegen.traps.families.family import DIFFICULTIES, Difficulty, Parameters
from sim.homes.housegen.traps.families.glass import DeadEnds, PaneComb, PaneGap, TwoPanes
from sim.homes.housegen.traps.families.ground import Ledge, WetFloor
from sim.homes.housegen.traps.families.low import Channels, LegForest, Sills, StoolRing
from sim.homes.housegen.traps.families.objects import Jam, ScanDoors

FAMILIES: Mapping[str, type[Parameters]] = MappingProxyType(
    {
        family.family: family
        for family in (
            PaneGap, PaneComb, Sills, LegForest, Channels, DeadEnds, ScanDoors, WetFloor, Jam, Ledge,
            TwoPanes, StoolRing,
        )
    }
)  # fmt: skip
"""The last two are held out: no agent may be developed or tuned on them."""
HELD_OUT = tuple(name for name, family in FAMILIES.items() if family.held_out)
"""Names of the families that are held out."""
VAL_SEEDS, TEST_SEEDS = range(5), range(5, 10)
"""Seeds of each family and difficulty. Seeds from 10 on are in no split: agents may be trained on their traps."""
_OPEN = tuple(name for name in FAMILIES if name not in HELD_OUT)


class TrapKey(NamedTuple):
    """The values from which a trap of a family is drawn."""

    family: str
    difficulty: Difficulty
    seed: int


def in_turns(families: Sequence[str], difficulties: Sequence[Difficulty], seeds: Iterable[int]) -> Iterator[TrapKey]:
    """Yields all combinations such that families and difficulties are balanced in the first N for any N."""
    for seed in seeds:
        for turn in range(len(difficulties)):
            for number, family in enumerate(families):
                yield TrapKey(family, difficulties[(turn + number) % len(difficulties)], seed)


CONTACT_SPLITS: Mapping[str, tuple[TrapKey, ...]] = MappingProxyType(
    {
        "contact-val": tuple(in_turns(_OPEN, DIFFICULTIES, VAL_SEEDS)),
        "contact-test": tuple(in_turns(_OPEN, DIFFICULTIES, TEST_SEEDS)),
        "contact-heldout": tuple(in_turns(HELD_OUT, DIFFICULTIES, (*VAL_SEEDS, *TEST_SEEDS))),
    }
)
"""The traps of each split. The families of `contact-heldout` must not be used for development or tuning."""
