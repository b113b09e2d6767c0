"""Makes a sealed split: houses like those of `test`, their episodes, and the seal to be published.

    stubborn seal make --out challenge/sealed2027 --secret-file secret.txt --houses 20 --episodes 400 --workers 4

It writes the split to --out, a new secret to --secret-file (readable for its owner only), and the seal next to the
split: `challenge/sealed2027.sealed.json`. Publish the seal; keep split and secret until the deadline. With an existing
secret, give --from-secret. Without an organiser, the secret comes from an announcement and a later hash:

    stubborn seal make --out challenge/mine --announced challenge/mine.announced.json --beacon HASH
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from pathlib import Path

from sim.app import cli
from sim.app.commands import episodes
from sim.app.evaluation.parallel import ordered_map
from sim.app.submissions.announcement import Commit, Episodes, Houses, read_announcement, secret_of, write_published
from sim.app.submissions.sealing import LIKE, VERSION, new_secret, number_of, read_secret, recipes, seal_file, seal_of
from sim.core.errors import ConfigError, HouseError
from sim.core.files import write_atomically
from sim.core.reading import convert, sha256_of
from sim.core.vocabulary import counted
from sim.episodes.house_list import copy_textures
from sim.episodes.splits import Split, load_split
from sim.houses.references import SHARED_TEXTURES
from sim.houses.writing import house_text


@dataclass(frozen=True, kw_only=True)
class Args:
    """Make a sealed split from a secret, or from an announcement and a later hash."""

    out: cli.OutFolder
    """Folder of the split; its name is the split's, and part of the names of its episodes."""
    secret_file: Path | None = None
    """File to which the new secret is written; it must not exist."""
    from_secret: bool = False
    """Take the secret that --secret-file holds already."""
    announced: Path | None = None
    """In place of a secret: announcement that `stubborn seal announce` wrote."""
    beacon: str | None = None
    """With --announced: the hash that the announcement promised, 40 hexadecimal digits."""
    houses: cli.Count = 20
    """Number of houses; not with --announced."""
    episodes: cli.Count = 400
    """Number of episodes; not with --announced."""
    workers: cli.Count = 1
    """Number of processes."""


def main(args: Args) -> int:
    """Writes split, secret and seal; returns the exit status."""
    require_empty(args.out)
    if seal_file(args.out).exists():
        raise ConfigError(f"'{seal_file(args.out)}' exists; give a new folder.")
    if args.announced is not None:
        return _make_announced(args, args.announced)
    if args.beacon is not None or args.secret_file is None:
        raise ConfigError("Give --secret-file FILE, or --announced FILE together with --beacon HASH.")
    convert(args.houses, Houses, where="--houses")
    convert(args.episodes, Episodes, where="--episodes")
    secret = read_secret(args.secret_file) if args.from_secret else new_secret(args.secret_file)
    args.out.mkdir(mode=0o700, parents=True, exist_ok=True)
    args.out.chmod(0o700)  # the houses are secret until the deadline
    split = make_split(args.out, secret, houses=args.houses, episode_count=args.episodes, workers=args.workers)
    write_published(seal_file(args.out), seal_of(split, secret), "a seal")
    print(f"{args.out}: {counted(args.houses, 'house')}, {counted(args.episodes, 'episode')}, sha256 {split.sha256}.")
    print(f"Publish {seal_file(args.out)}; keep {args.out} and {args.secret_file} until the deadline.")
    return 0


def _make_announced(args: Args, file: Path) -> int:
    """Makes the split of an announcement; returns the exit status."""
    if args.secret_file is not None or args.beacon is None:
        raise ConfigError("--announced needs --beacon HASH and no --secret-file: the secret is derived from both.")
    cli.require_unset(args, ("from_secret", "houses", "episodes"), "has no effect with --announced, which states it.")
    announcement = read_announcement(file)
    if args.out.resolve().name != announcement.name:
        raise ConfigError(f"--out must be a folder named '{announcement.name}', as '{file}' announces.")
    secret = secret_of(sha256_of(file, what="Announcement"), convert(args.beacon, Commit, where="--beacon"))
    houses, episode_count = announcement.houses, announcement.episodes
    split = make_split(args.out, secret, houses=houses, episode_count=episode_count, workers=args.workers)
    write_published(seal_file(args.out), seal_of(split, secret, (file, args.beacon)), "a seal")
    size = f"{counted(houses, 'house')}, {counted(episode_count, 'episode')}"
    print(f"{args.out}: {size}, sha256 {split.sha256}.")
    print(f"Commit {seal_file(args.out)}, then run the agent that was frozen.")
    return 0


def require_empty(folder: Path) -> None:
    """Raises ConfigError where a folder holds files already."""
    if folder.is_dir() and any(folder.iterdir()):
        raise ConfigError(f"--out '{folder}' is not empty; give a new folder.")


def make_split(folder: Path, secret: str, *, houses: int, episode_count: int, workers: int) -> Split:
    """Writes the houses and episodes of a sealed split, and returns it.

    Raises:
        HouseError: no seed of a house gives a house.
    """
    name = folder.resolve().name
    copy_textures(folder / SHARED_TEXTURES)
    made = ordered_map(functools.partial(_house, secret, name), range(houses), workers=workers)
    for number, text in enumerate(made, start=1):
        write_atomically(folder / f"{name}_{number - 1:02d}.xml", text)
        print(f"house {number} of {houses}", flush=True)
    options = episodes.Args(
        split=folder,
        episodes=episode_count,
        recipe=LIKE,
        seed=number_of(secret, "episodes", 2**63),
        version=VERSION,
        workers=workers,
        pictures=False,
    )
    episodes.main(options)
    return load_split(folder)


def _house(secret: str, name: str, number: int) -> str:
    """Returns the text of a house."""
    reason = ""
    for recipe in recipes(secret, name, number):
        try:
            return house_text(recipe.make().spec, SHARED_TEXTURES)
        except HouseError as error:
            reason = str(error)
    raise HouseError(f"No seed gives house {number} of the sealed split: {reason}")
