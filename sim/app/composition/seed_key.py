"""Finds the key of a run, from which the seeds of its agents are computed (`sim.episodes.seeds`)."""

from __future__ import annotations

import fcntl
import os
import secrets
from pathlib import Path

from sim.app.evaluation.results import read_record
from sim.app.options import RunOptions
from sim.core.errors import ConfigError
from sim.core.files import open_to_grow
from sim.core.reading import read_bytes

KEY_FILE = "seed_key"
"""File with the key of all shards, in the folder of the whole run."""


def seed_key_of(options: RunOptions) -> str:
    """Returns the key of a run: that of `--seed-key`, else that of its folder or of its shards, else a new one.

    Raises:
        ConfigError: the key of the folder differs from that of `--seed-key`.
    """
    assert options.out is not None
    config = options.out / "config.json"
    recorded = read_record(config).get("seed_key") if config.exists() else None
    if options.seed_key is not None:
        if recorded not in (None, options.seed_key):
            raise ConfigError(
                f"--out '{options.out}' holds a run with --seed-key {recorded}, this run has {options.seed_key}; "
                "choose another folder."
            )
        return options.seed_key
    if recorded is not None:
        return recorded
    whole = options.out.parent if options.shard is not None else options.out
    return _shared_key(whole / KEY_FILE, make=options.shard is not None) or secrets.token_hex(8)


def _shared_key(file: Path, *, make: bool) -> str | None:
    """Returns the key in the file that all shards of a run share; None: the file does not exist.

    Args:
        file: the file with the key.
        make: whether to create the file with a new key if it does not exist.
    """
    if make:
        file.parent.mkdir(parents=True, exist_ok=True)
        with open_to_grow(file, "a+") as stream:
            fcntl.flock(stream, fcntl.LOCK_EX)  # shards may begin at the same time
            if stream.seek(0, os.SEEK_END) == 0:  # another shard may have written after the file was opened
                stream.write(secrets.token_hex(8))
    if not file.exists():
        return None
    return read_bytes(file, what="Key of the shards", most=10_000).decode(errors="replace").strip() or None
