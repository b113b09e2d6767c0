"""Checks of a run's options against each other, before any name is looked up."""

from __future__ import annotations

from sim.app.evaluation.parallel import Shard
from sim.app.options import RunOptions
from sim.app.viewers import selection
from sim.core.errors import ConfigError

MOST_KEY_LETTERS = 200
"""Largest length of `--seed-key`."""


def check_options(options: RunOptions) -> None:
    """Raises ConfigError if options contradict each other or are out of range."""
    for name, smallest in (("episodes", 1), ("workers", 1), ("seed", 0)):
        value = getattr(options, name)
        if value < smallest:
            raise ConfigError(f"--{name} must be at least {smallest}, got {value}.")
    if options.house is None and any(each is not None for each in (options.labels, options.root, options.start_deg)):
        raise ConfigError("--labels, --root and --start-deg need --house.")
    if options.only and options.house is not None:
        raise ConfigError("--only names episodes of a split; with --house, episodes are sampled.")
    if options.retry_errors and options.out is None:
        raise ConfigError("--retry-errors needs --out: the folder of the run.")
    if options.seed_key is not None and not 1 <= len(options.seed_key) <= MOST_KEY_LETTERS:
        raise ConfigError(f"--seed-key must have 1 to {MOST_KEY_LETTERS} letters, got {len(options.seed_key)}.")
    selection.check(options)
    if options.shard is not None:
        Shard.parse(options.shard)
        if options.out is None:
            raise ConfigError(f"--shard {options.shard} needs --out: one folder for all shards.")
