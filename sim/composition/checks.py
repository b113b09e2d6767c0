"""Checks of a run's options that need no house."""

from __future__ import annotations

from sim.composition.agents import find_agent, find_explorer
from sim.composition.options import RunOptions
from sim.composition.segmenters import KINDS, check_semantics
from sim.errors import ConfigError
from sim.evaluation.parallel import Shard
from sim.sensors.noise import get_noise
from sim.sensors.profiles import get_profile
from sim.viewers import selection
from stubborn.detection.verification import verifier_for


def check_options(options: RunOptions) -> None:
    """Raises ConfigError where options contradict each other or name something that does not exist."""
    for name, smallest in (("episodes", 1), ("workers", 1), ("seed", 0)):
        value = getattr(options, name)
        if value < smallest:
            raise ConfigError(f"--{name} must be at least {smallest}, got {value}.")
    if options.house is None and any(each is not None for each in (options.labels, options.root, options.start_deg)):
        raise ConfigError("--labels, --root and --start-deg need --house.")
    if options.only and options.house is not None:
        raise ConfigError("--only names episodes of a split; with --house, episodes are drawn.")
    if options.retry_errors and options.out is None:
        raise ConfigError("--retry-errors needs --out: the folder of the run.")
    selection.check(options)
    if options.shard is not None:
        Shard.parse(options.shard)
        if options.out is None:
            raise ConfigError(f"--shard {options.shard} needs --out: one folder for all shards.")
    get_profile(options.profile)
    get_noise(options.noise)
    check_semantics(options.semantics, options.weights)
    verifier_for(options.semantics, KINDS[options.semantics].spec, options.verifier, options.verification)
    find_agent(options.agent)
    if options.explorer is not None:
        find_explorer(options.explorer)
