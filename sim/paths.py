"""Where the shipped houses lie, in the repository or in the installed wheel; and which code this is."""

from __future__ import annotations

import functools
import hashlib
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


@functools.cache
def code_hash(*, parameters: bool = True) -> str:
    """12 hex digits over the modules and parameters of `sim` and `stubborn`: the same code, the same digits.

    Args:
        parameters: False takes the modules only, for who does not use what was fitted.
    """
    return hash_of_packages(_PACKAGE, _PACKAGE.parent / "stubborn", parameters=parameters)


def hash_of_packages(*packages: Path, parameters: bool = True) -> str:
    """12 hex digits over the `.py` and `.json` files of some folders.

    Their folder `assets` does not count: the shipped houses lie there in a wheel and elsewhere in a checkout, and a
    split has a checksum of its own.
    """
    digest = hashlib.sha256()
    for package in packages:
        suffixes = ("py", "json") if parameters else ("py",)
        for file in sorted(file for suffix in suffixes for file in package.rglob(f"*.{suffix}")):
            name = file.relative_to(package)
            if name.parts[0] != "assets":
                digest.update(f"{package.name}/{name}".encode() + file.read_bytes())
    return digest.hexdigest()[:12]
