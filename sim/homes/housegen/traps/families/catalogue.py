"""All families of traps by name, in the order of the episodes of the splits `contact-*`."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from sim.homes.housegen.traps.families.family import Parameters
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
