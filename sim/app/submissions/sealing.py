"""Sealed splits: houses and episodes that are secret before a deadline and that everybody can check after it.

An organiser makes a split from a secret, publishes the hash of both, and reveals the secret after the deadline. The
same secret and version of the generator give the same split, whose hash must be the published one.
"""

from __future__ import annotations

import hashlib
import hmac
import os
import secrets
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Literal

import msgspec

from sim.app.submissions.announcement import Commit, Episodes, Houses, read_announcement
from sim.core.errors import ConfigError
from sim.core.reading import Name, read_json, read_text, sha256_of
from sim.episodes.house_list import house_maker
from sim.episodes.splits import Split
from sim.homes.housegen.splits.recipes import SPLITS, Recipe

FORMAT: Literal["stubborn-sealed-1"] = "stubborn-sealed-1"
VERSION = "sealed"
"""Version of the episodes of a sealed split; its hash identifies it."""
LIKE = "test"
"""The split whose kinds and sizes of houses a sealed one has."""
FIRST_SEED, SEEDS = 10**9, 2**40
"""Seeds of sealed houses: above those of all shipped splits, and too many to try them all."""
MIN_DIGITS = 8
"""Different digits of a secret; a random one has fewer in less than one of 10^18 cases."""
TRIES = 20
"""Seeds of one house that are tried until one gives a house."""

Origin = Literal["public", "private", "organiser", "beacon", "authors"]
"""How a split was made: it ships; it is not sealed; an organiser sealed it; a later hash of others drew it; a later
hash drew it that the authors could choose."""
Digest = Annotated[str, msgspec.Meta(pattern=r"^[0-9a-f]{64}\Z")]


class Seal(msgspec.Struct, forbid_unknown_fields=True):
    """The file that an organiser publishes before the deadline."""

    format: Literal["stubborn-sealed-1"]
    name: Name
    """Name of the split's folder, with which its episodes are named."""
    split_sha256: Digest
    secret_sha256: Digest | None
    """None: the houses come from elsewhere, and the split itself is revealed."""
    houses: Houses
    episodes: Episodes
    made_with: Annotated[dict[Name, Name], msgspec.Meta(max_length=50)]
    """Versions of the generator and of the packages on which the houses depend."""
    announcement_sha256: Digest | None = None
    """Hash of the announcement from which, with the beacon, the secret is derived; None: an organiser has it."""
    beacon: Commit | None = None
    beacon_by: Literal["others", "authors"] | None = None
    """Who makes the beacon; `authors` could choose it."""

    @property
    def origin(self) -> Origin:
        """Who drew the houses and episodes."""
        if self.announcement_sha256 is None:
            return "organiser"
        return "beacon" if self.beacon_by == "others" else "authors"


def seal_of(split: Split, secret: str | None, announced: tuple[Path, str] | None = None) -> Seal:
    """Returns the seal of a split.

    Args:
        split: the split.
        secret: from which it was made; None: its houses come from elsewhere.
        announced: the file of the announcement and the beacon, where the secret was derived from them.

    Raises:
        ConfigError: it has no episodes.
    """
    if not split.episodes:
        raise ConfigError(f"Split '{split.name}' has no episodes; `stubborn episodes` makes them.")
    seal = Seal(
        format=FORMAT,
        name=split.name,
        split_sha256=split.sha256,
        secret_sha256=None if secret is None else digest_of(secret),
        houses=len(split.houses),
        episodes=len(split.episodes),
        made_with=house_maker().versions(),
    )
    if announced is not None:
        file, seal.beacon = announced
        seal.announcement_sha256 = sha256_of(file, what="Announcement")
        seal.beacon_by = read_announcement(file).beacon_by
    return seal


def origin_of(split: Split, folder: Path | None) -> Origin:
    """Returns who drew the houses of a split.

    Args:
        split: the split.
        folder: of a split that does not ship; its seal lies next to it.

    Raises:
        ConfigError: the seal is of another split.
    """
    if folder is None:
        return "public"
    file = seal_file(folder)
    if not file.is_file():
        return "private"
    seal = read_seal(file)
    require_sealed(split, seal)
    return seal.origin


def seal_file(folder: Path) -> Path:
    """Returns the file of the seal next to the folder of a split."""
    folder = folder.resolve()  # "." has no name, and a link may lie elsewhere
    return folder.with_name(f"{folder.name}.sealed.json")


def read_seal(file: Path) -> Seal:
    """Returns the seal in a file.

    Raises:
        ConfigError: it cannot be read, or has another form.
    """
    return read_json(file, Seal, what="Seal")


def require_sealed(split: Split, seal: Seal) -> None:
    """Raises ConfigError where a split is not the one that was sealed."""
    counts = len(split.houses), len(split.episodes)
    if counts != (seal.houses, seal.episodes):
        raise ConfigError(
            f"'{split.name}' is not the sealed split: it has {counts[0]} houses and {counts[1]} episodes, "
            f"the seal says {seal.houses} and {seal.episodes}."
        )
    if split.sha256 == seal.split_sha256:
        return
    other = other_versions(seal)
    raise ConfigError(
        f"'{split.name}' is not the sealed split: its sha256 is {split.sha256[:16]}, the seal says "
        f"{seal.split_sha256[:16]}. {'Other versions: ' + '; '.join(other) if other else 'The versions are the same'}."
    )


def other_versions(seal: Seal) -> list[str]:
    """Returns a phrase for each version of the seal that is not the one here."""
    here = house_maker().versions()
    return [
        f"{name} {sealed} there and {here.get(name)} here"
        for name, sealed in seal.made_with.items()
        if here.get(name) != sealed
    ]


def new_secret(file: Path) -> str:
    """Returns a new secret and writes it to a file that only its owner can read.

    Raises:
        ConfigError: the file exists.
        OSError: the folder cannot be made, or the file cannot be written.
    """
    secret = secrets.token_hex(32)
    file.parent.mkdir(parents=True, exist_ok=True)
    try:
        handle = os.open(file, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
    except FileExistsError:
        raise ConfigError(f"'{file}' exists: it may be the secret of another split; name another file.") from None
    with os.fdopen(handle, "w") as stream:
        stream.write(secret + "\n")
    return secret


def read_secret(file: Path) -> str:
    """Returns the secret in a file.

    Raises:
        ConfigError: the file cannot be read, or holds no secret of 64 hexadecimal digits.
    """
    secret = read_text(file, what="Secret", most=1000).strip()
    if len(secret) != 64 or not set(secret) <= set("0123456789abcdef"):
        raise ConfigError(f"'{file}' holds no secret: 64 hexadecimal digits, as `stubborn seal make` writes them.")
    if len(set(secret)) < MIN_DIGITS:
        raise ConfigError(f"'{file}' holds no secret: with {len(set(secret))} different digits, it can be guessed.")
    return secret


def digest_of(secret: str) -> str:
    """Returns the hash of a secret that is published; the secret cannot be found from it."""
    return hashlib.sha256(f"stubborn sealed split {secret}".encode()).hexdigest()


def number_of(secret: str, what: str, most: int) -> int:
    """Returns a number in [0, most) that depends on the secret and on what it is for."""
    return int.from_bytes(hmac.digest(secret.encode(), what.encode(), "sha256"), "big") % most


def recipes(secret: str, name: str, house: int) -> Iterator[Recipe]:
    """Yields recipes of a house of a sealed split; the first that gives a house is taken."""
    shape = SPLITS[LIKE][number_of(secret, f"shape {house}", len(SPLITS[LIKE]))]
    for attempt in range(TRIES):
        seed = FIRST_SEED + number_of(secret, f"house {house} {attempt}", SEEDS)
        yield replace(shape, name=f"{name}_{house:02d}", seed=seed)
