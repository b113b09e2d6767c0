"""The folders of shipped houses and of the user's cache, the hash of the code, and the processor's name."""

from __future__ import annotations

import functools
import hashlib
import os
import platform
from pathlib import Path

from sim.core.errors import ConfigError, HouseError

CACHE_VARIABLE = "STUBBORN_CACHE_DIR"
_PACKAGE = Path(__file__).resolve().parents[1]


def cache_dir() -> Path:
    """Returns the folder of the cache of this user; it may be deleted at any time.

    It is `$STUBBORN_CACHE_DIR`, else `stubborn-objectnav` in `$XDG_CACHE_HOME`, else in `~/.cache` (XDG Base Directory
    Specification 0.8).

    Raises:
        ConfigError: the user has no home folder, as in some containers, and no variable names another one.
    """
    chosen, base = os.environ.get(CACHE_VARIABLE), os.environ.get("XDG_CACHE_HOME", "")
    try:
        if chosen:
            return Path(chosen).expanduser()
        return (Path(base) if os.path.isabs(base) else Path.home() / ".cache") / "stubborn-objectnav"
    except RuntimeError as error:
        raise ConfigError(f"There is no folder for the cache: {error} Set {CACHE_VARIABLE} to one.") from None


def assets_dir() -> Path:
    """Returns the folder with one folder per shipped split: `assets/mjcf_houses` of a checkout, else of the wheel.

    Raises:
        HouseError: neither exists.
    """
    folders = (_PACKAGE.parent / "assets" / "mjcf_houses", _PACKAGE / "assets" / "mjcf_houses")
    for folder in folders:
        if folder.is_dir():
            return folder
    raise HouseError(f"The shipped houses are missing: neither {folders[0]} nor {folders[1]} exists.")


@functools.cache
def code_hash(*, parameters: bool = True) -> str:
    """Returns 12 hex digits that identify the code: a hash of the modules and parameters of `sim` and `stubborn`.

    Args:
        parameters: whether the fitted parameters (JSON files) count, or the modules only.
    """
    return hash_of_packages(_PACKAGE, _PACKAGE.parent / "stubborn", parameters=parameters)


def hash_of_packages(*packages: Path, parameters: bool = True) -> str:
    """Returns 12 hex digits, a hash of the `.py` and `.json` files of some folders.

    Their folder `assets` does not count: it holds the shipped houses in a wheel but not in a checkout, and each split
    has its own checksum.
    """
    digest = hashlib.sha256()
    for package in packages:
        suffixes = ("py", "json") if parameters else ("py",)
        for file in sorted(file for suffix in suffixes for file in package.rglob(f"*.{suffix}")):
            name = file.relative_to(package)
            if name.parts[0] != "assets":
                digest.update(f"{package.name}/{name}".encode() + file.read_bytes())
    return digest.hexdigest()[:12]


@functools.cache
def processor() -> str:
    """Returns the processor's name as Linux knows it, elsewhere as Python does."""
    file = Path("/proc/cpuinfo")
    for line in file.read_text(errors="replace").splitlines() if file.is_file() else ():
        if line.startswith("model name"):
            return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()
