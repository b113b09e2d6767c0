"""Runs an evaluation script that is written for Habitat, unchanged, in the houses of this project.

    stubborn habitat "evaluate.py --agent-class RandomAgent" --split val --episodes 10

`import habitat` gives the script the names of `sim.app.bridges.habitat`: `habitat.Env`, `habitat.Benchmark`,
`habitat.Challenge`, `habitat.get_config`. The options of this command have priority over the configuration that the
script reads. docs/habitat.md lists the names and the metrics.
"""

from __future__ import annotations

import runpy
import shlex
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from sim.app import cli
from sim.app.evaluation.own_code import place_of, text_of
from sim.core.errors import ConfigError, ObjectNavError


@dataclass(frozen=True, kw_only=True)
class Args:
    """Run an evaluation script that is written for Habitat."""

    script: Annotated[tyro.conf.Positional[str], tyro.conf.arg(metavar='"SCRIPT ARGUMENTS"')]
    """The script and its arguments, together in quotation marks."""
    split: str | None = None
    """A shipped split, or a folder laid out like one; by default that of the script's configuration, or val."""
    house: Path | None = None
    """One MJCF file in place of a split."""
    episodes: cli.Count | None = None
    """Number of episodes, the first of the split; by default all."""
    seed: cli.Seed = 0
    """Seed of sensor noise and, with --house, of starts and goals."""
    categories: str = "mp3d"
    """Numbering of objectgoal: mp3d (21 categories) or hm3d (6); only episodes with these goals are run."""
    profile: str = "fast"
    """Rendering quality: fast or good."""
    noise: str = "none"
    """Noise of sensors and drive: none, realsense or harsh."""


def main(args: Args) -> int:
    """Runs the script; returns its exit status."""
    from sim.app.bridges.habitat import env, stand_in  # these import MuJoCo

    try:
        words = shlex.split(args.script)
    except ValueError as error:
        raise ConfigError(f"The script '{args.script}' cannot be read: {error}.") from None
    if not words or not Path(words[0]).is_file():
        raise ConfigError(f"There is no script '{words[0] if words else ''}'.")
    if args.house is not None and args.split is not None:
        raise ConfigError("--split and --house exclude each other.")
    if stand_in.install():
        print(stand_in.NOTE, file=sys.stderr)
    options = {name: value for name, value in vars(args).items() if name != "script" and value is not None}
    with env.default_options(**options):
        return _run(words)


def _run(words: list[str]) -> int:
    """Runs a script with its arguments as Python does; returns its exit status.

    Raises:
        ConfigError: it raised an error; the message has its file and line.
    """
    from sim.app.bridges.habitat import stand_in

    before, path = sys.argv, list(sys.path)
    sys.argv, sys.path[0:0] = words, [str(Path(words[0]).resolve().parent)]
    try:
        runpy.run_path(words[0], run_name="__main__")
        return 0
    except SystemExit as stop:
        if stop.code is None or isinstance(stop.code, int):
            return stop.code or 0
        print(stop.code, file=sys.stderr)  # as Python does
        return 1
    except (ObjectNavError, KeyboardInterrupt):
        raise
    except BaseException as error:
        reason = stand_in.lacking(error) or f"{type(error).__name__}: {text_of(error)}"
        raise ConfigError(f"'{words[0]}': {reason}{place_of(error, below=__file__)}") from error
    finally:
        sys.argv, sys.path[:] = before, path
