"""Sealed splits without an organiser: the seed is derived from a hash that did not exist before.

The authors freeze their agent, announce where the seed will come from, and commit both. The seed is then derived from
the announcement and from a beacon, a hash that did not exist at that time: that of a later commit of a repository that
the announcement names. Everybody can make the split again from both files. Where the authors alone can choose the
beacon, since the commit is their own, they could try many; the announcement and the row say so.
"""

from __future__ import annotations

import hashlib
import itertools
import subprocess
from pathlib import Path
from typing import Annotated, Literal

import msgspec

from sim.core.errors import ConfigError
from sim.core.files import write_atomically
from sim.core.reading import Name, read_json

FORMAT: Literal["stubborn-announcement-1"] = "stubborn-announcement-1"
Commit = Annotated[str, msgspec.Meta(pattern=r"^[0-9a-f]{40}\Z")]
"""The hash of a commit, or another number of 40 hexadecimal digits."""
MAX_HOUSES, MAX_EPISODES = 10_000, 20_000
Houses = Annotated[int, msgspec.Meta(ge=1, le=MAX_HOUSES)]
Episodes = Annotated[int, msgspec.Meta(ge=1, le=MAX_EPISODES)]
"""Sizes of sealed splits: everybody who reveals one makes it again, at minutes a house."""
Statement = Annotated[str, msgspec.Meta(min_length=10, max_length=500, pattern=r"^[^\x00-\x1f\x7f-\x9f]*\Z")]


class Announcement(msgspec.Struct, forbid_unknown_fields=True):
    """The file that the authors commit together with their agent, before the beacon exists."""

    format: Literal["stubborn-announcement-1"]
    name: Name
    """Name of the split's folder."""
    agent_commit: Commit
    """The commit that holds the agent, frozen, with all that it needs."""
    beacon: Statement
    """The rule that says which hash will be taken, such as: the first commit on the branch master of
    https://github.com/torvalds/linux after 2026-12-24 00:00 UTC."""
    beacon_by: Literal["others", "authors"]
    """Who makes the beacon: `authors` means that they could choose it."""
    houses: Houses
    episodes: Episodes


def write_published(file: Path, content: msgspec.Struct, what: str) -> None:
    """Writes what will be published, such as "an announcement", to a new file.

    Raises:
        ConfigError: the file exists.
    """
    if file.exists():
        raise ConfigError(f"'{file}' exists: it may be {what} that was published; remove it, or name another file.")
    write_atomically(file, msgspec.json.format(msgspec.json.encode(content), indent=2) + b"\n")


def read_announcement(file: Path) -> Announcement:
    """Returns the announcement in a file.

    Raises:
        ConfigError: it cannot be read, or has another form.
    """
    return read_json(file, Announcement, what="Announcement")


def secret_of(announcement_sha256: str, beacon: str) -> str:
    """Returns the secret of the split, 64 hexadecimal digits, from the announcement and the beacon."""
    return hashlib.sha256(f"stubborn announced split {announcement_sha256} {beacon}".encode()).hexdigest()


def faults_of_order(announcement: Path, seal: Path, beacon: str, repository: Path) -> list[str]:
    """Returns a sentence for each step that a repository does not show in the announced order.

    The order is: the agent's commit, the commit that adds the announcement, the beacon if it is a commit of this
    repository, and the commit that adds the seal.

    Args:
        announcement: its file in the repository.
        seal: its file in the repository.
        beacon: the hash that was taken.
        repository: a folder of the repository.

    Raises:
        ConfigError: the folder is not in a git repository, or a file is not committed.
    """
    announced, sealed = (_commit_that_added(file, repository) for file in (announcement, seal))
    agent = read_announcement(announcement).agent_commit
    steps = [("the agent", agent), ("the announcement", announced), ("the seal", sealed)]
    if _is_commit(beacon, repository):
        steps.insert(2, ("the beacon", beacon))
    faults = []
    for (first, before), (second, after) in itertools.pairwise(steps):
        later = first != "the agent" and before == after
        if later or not _is_commit(before, repository) or not _is_ancestor(before, after, repository):
            faults.append(f"{second} ({after[:12]}) was not committed after {first} ({before[:12]})")
    return faults


def _commit_that_added(file: Path, repository: Path) -> str:
    """Returns the commit that added a file and after which it has not changed."""
    history = _git(repository, "log", "--format=%H", "--", str(file.resolve())).split()
    if not history:
        raise ConfigError(f"'{file}' is not committed in the repository '{repository}'.")
    if len(history) > 1:
        raise ConfigError(f"'{file}' was changed after it was committed ({history[0][:12]}).")
    return history[0]


def _is_commit(name: str, repository: Path) -> bool:
    return _run(repository, "cat-file", "-e", f"{name}^{{commit}}").returncode == 0


def _is_ancestor(before: str, after: str, repository: Path) -> bool:
    return _run(repository, "merge-base", "--is-ancestor", before, after).returncode == 0


def _git(repository: Path, *words: str) -> str:
    done = _run(repository, *words)
    if done.returncode != 0:
        said = done.stderr.strip().splitlines() or ["it said nothing"]
        raise ConfigError(f"git {words[0]} fails in '{repository}': {said[-1]}.")
    return done.stdout


def _run(repository: Path, *words: str) -> subprocess.CompletedProcess[str]:
    try:
        return subprocess.run(["git", "-C", str(repository), *words], capture_output=True, text=True, check=False)
    except FileNotFoundError:
        raise ConfigError("The order of commits is read with git, which is not installed here.") from None
