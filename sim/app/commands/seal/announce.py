"""Announces a sealed split that needs no organiser: its seed will come from a hash that does not exist yet.

    stubborn seal announce --out challenge/mine --agent-commit $(git rev-parse HEAD) \\
        --beacon "the first commit on master of https://github.com/torvalds/linux after 2026-12-24 00:00 UTC"

It writes `challenge/mine.announced.json`; commit and publish it. When the hash exists, `stubborn seal make --out
challenge/mine --announced challenge/mine.announced.json --beacon HASH` makes split and seal; commit the seal.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Literal

from sim.app import cli
from sim.app.submissions.announcement import FORMAT, Announcement, write_published
from sim.core.errors import ConfigError
from sim.core.reading import convert


@dataclass(frozen=True, kw_only=True)
class Args:
    """Announce a sealed split before its seed exists."""

    out: cli.OutFolder
    """Folder of the later split; the announcement is written next to it."""
    agent_commit: str
    """Hash of the commit that holds the frozen agent: 40 hexadecimal digits."""
    beacon: str
    """Rule that says which later hash is taken."""
    beacon_by: Literal["others", "authors"] = "others"
    """Who makes that hash; `authors` if the commit will be your own."""
    houses: cli.Count = 20
    """Number of houses."""
    episodes: cli.Count = 400
    """Number of episodes."""


def main(args: Args) -> int:
    """Writes the announcement; returns the exit status."""
    if re.fullmatch(r"[0-9a-f]{40}", args.agent_commit) is None:
        raise ConfigError(f"--agent-commit must be 40 hexadecimal digits, got '{args.agent_commit}'.")
    folder = args.out.resolve()
    file = folder.with_name(f"{folder.name}.announced.json")
    announcement = convert(
        {
            "format": FORMAT, "name": folder.name, "agent_commit": args.agent_commit, "beacon": args.beacon,
            "beacon_by": args.beacon_by, "houses": args.houses, "episodes": args.episodes,
        },
        Announcement,
        where="The announcement",
    )  # fmt: skip
    write_published(file, announcement, "an announcement")
    print(f"{file}: commit and publish it now, before the beacon exists.")
    return 0
