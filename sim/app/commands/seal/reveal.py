"""Checks a revealed split against its seal; from a secret, the split is made again first.

    stubborn seal reveal sealed2027.sealed.json --secret-file secret.txt --out sealed2027 --workers 4
    stubborn seal reveal homes.sealed.json --split homes
    stubborn seal reveal mine.sealed.json --announced mine.announced.json --out mine --repository .

The organiser publishes the secret after the deadline. Everybody can then make the split, see that it is the one that
was sealed, and verify the submissions on it: `stubborn verify FILE --split sealed2027`. A split that was announced
needs no secret; --repository also checks the order of the commits: agent, announcement, beacon, seal.
"""

from __future__ import annotations

import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from sim.app import cli
from sim.app.commands.seal.make import make_split, require_empty
from sim.app.submissions.announcement import faults_of_order, secret_of
from sim.app.submissions.sealing import Seal, digest_of, other_versions, read_seal, read_secret, require_sealed
from sim.core.errors import ConfigError
from sim.core.reading import sha256_of
from sim.core.vocabulary import counted
from sim.episodes.splits import Split, load_split


@dataclass(frozen=True, kw_only=True)
class Args:
    """Check a revealed split against its seal."""

    seal: Annotated[tyro.conf.Positional[Path], tyro.conf.arg(metavar="SEAL")]
    """The published file, NAME.sealed.json."""
    split: Path | None = None
    """Folder of the revealed split."""
    secret_file: Path | None = None
    """In its place: file with the revealed secret, from which the split is made."""
    announced: Path | None = None
    """In its place: the announcement from which, with the beacon in the seal, the split is made."""
    repository: Path | None = None
    """With --announced: repository whose commits must have the announced order."""
    out: cli.OutFolder | None = None
    """With --secret-file or --announced: folder of the split, which has the name in the seal."""
    workers: cli.Count = 1
    """Number of processes."""


def main(args: Args) -> int:
    """Checks the split and prints the outcome; returns the exit status."""
    seal = read_seal(args.seal)
    if sum(given is not None for given in (args.split, args.secret_file, args.announced)) != 1:
        raise ConfigError("Give one of --split FOLDER, --secret-file FILE and --announced FILE.")
    if args.split is not None:
        cli.require_unset(args, ("out",), "needs --secret-file or --announced, from which the split is made.")
    if args.announced is None:
        cli.require_unset(args, ("repository",), "needs --announced.")
    elif args.repository is not None:
        _require_order(args.announced, args.seal, seal, args.repository)
    if args.split is None:
        split = _made(args, seal)
    else:
        split = load_split(args.split)
        require_sealed(split, seal)
    print(f"'{split.name}' is the sealed split: {counted(seal.houses, 'house')}, {counted(seal.episodes, 'episode')}.")
    if args.split is not None and seal.secret_sha256 is not None:
        print("Only the secret (--secret-file, --announced) shows that its houses were drawn from it.")
    if seal.beacon_by == "authors":
        print("The authors could choose the beacon: no third party drew this split.")
    return 0


def _require_order(announced: Path, file: Path, seal: Seal, repository: Path) -> None:
    """Raises ConfigError where the commits of a repository do not show the announced order."""
    faults = faults_of_order(announced, file, seal.beacon or "", repository)
    if faults:
        raise ConfigError(f"The order of '{file}' is not the announced one: {'; '.join(faults)}.")
    print("Committed in the announced order: the agent, the announcement, the seal.")


def _made(args: Args, seal: Seal) -> Split:
    """Returns the split of the secret; the files of one that is not the sealed one are removed."""
    if seal.secret_sha256 is None:
        raise ConfigError(f"'{args.seal}' is the seal of houses without a secret: give their folder, --split FOLDER.")
    if args.out is None or args.out.resolve().name != seal.name:
        raise ConfigError(f"Give --out with a folder named '{seal.name}', as the seal says.")
    secret = _secret(args, seal)
    require_empty(args.out)
    for other in other_versions(seal):
        print(f"Made with another version: {other}. The houses may differ.", flush=True)
    existed = args.out.is_dir()
    try:
        split = make_split(args.out, secret, houses=seal.houses, episode_count=seal.episodes, workers=args.workers)
        require_sealed(split, seal)
    except BaseException:  # Ctrl-C too
        shutil.rmtree(args.out, ignore_errors=True)
        if existed:
            args.out.mkdir(exist_ok=True)
        raise
    return split


def _secret(args: Args, seal: Seal) -> str:
    """Returns the sealed secret, from its file or from announcement and beacon."""
    if args.announced is not None:
        if sha256_of(args.announced, what="Announcement") != seal.announcement_sha256 or seal.beacon is None:
            raise ConfigError(f"'{args.announced}' is not the announcement of '{args.seal}'.")
        secret = secret_of(sha256_of(args.announced, what="Announcement"), seal.beacon)
    else:
        assert args.secret_file is not None
        secret = read_secret(args.secret_file)
    if digest_of(secret) != seal.secret_sha256:
        raise ConfigError(f"The secret of '{args.secret_file or args.announced}' is not the sealed one.")
    return secret
