"""Where the shipped houses lie: in the repository, or in the installed wheel."""

from __future__ import annotations

from pathlib import Path

from sim.errors import HouseError

_PACKAGE = Path(__file__).resolve().parent


def assets_dir() -> Path:
    """The folder of shipped houses, a folder a split: `assets/mjcf_houses` of a checkout, else the wheel's.

    Raises:
        HouseError: neither is there.
    """
    places = (_PACKAGE.parent / "assets" / "mjcf_houses", _PACKAGE / "assets" / "mjcf_houses")
    for place in places:
        if place.is_dir():
            return place
    raise HouseError(f"The shipped houses are missing: neither {places[0]} nor {places[1]} is there.")
