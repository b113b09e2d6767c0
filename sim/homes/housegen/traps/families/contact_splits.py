"""The splits of traps by family: which families, difficulties and seeds each has, in the order of its episodes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import NamedTuple

from sim.homes.housegen.traps.families.catalogue import FAMILIES, HELD_OUT
from sim.homes.housegen.traps.families.family import DIFFICULTIES, Difficulty

VAL_SEEDS, TEST_SEEDS = range(5), range(5, 10)
"""Seeds of each family and difficulty. Seeds from 10 on are in no split: agents may be trained on their traps."""


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


_OPEN = tuple(name for name in FAMILIES if name not in HELD_OUT)
CONTACT_SPLITS: Mapping[str, tuple[TrapKey, ...]] = MappingProxyType(
    {
        "contact-val": tuple(in_turns(_OPEN, DIFFICULTIES, VAL_SEEDS)),
        "contact-test": tuple(in_turns(_OPEN, DIFFICULTIES, TEST_SEEDS)),
        "contact-heldout": tuple(in_turns(HELD_OUT, DIFFICULTIES, (*VAL_SEEDS, *TEST_SEEDS))),
    }
)
"""The traps of each split. The families of `contact-heldout` must not be used for development or tuning."""
