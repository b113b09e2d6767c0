"""Runs a script that is written for Habitat, unchanged, with habitat-lab on the houses of this project.

    stubborn habitat "evaluate.py --agent-class RandomAgent" --split val --episodes 10

The script runs in this Python if habitat-lab is installed in it, else in the one that `stubborn habitat setup` made. It
may also use names of older versions of habitat-lab (`sim.app.bridges.habitat_sim.legacy`). docs/habitat.md describes
what runs.
"""

from __future__ import annotations

import importlib.util
import runpy
import shlex
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import tyro

from sim.app import cli
from sim.app.evaluation.own_code import described
from sim.core.errors import ConfigError, ObjectNavError, debug
from sim.core.invocation import command
from sim.robot.config import MotionKind

FOLDER = Path(".venv-habitat")
"""Folder of the environment that `stubborn habitat setup` makes."""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Run a script that is written for Habitat."""

    script: Annotated[tyro.conf.Positional[str], tyro.conf.arg(metavar='"SCRIPT ARGUMENTS"')]
    """The script and its arguments, together in quotation marks."""
    split: str | None = None
    """A shipped split, or a folder laid out like one; by default that of the script's configuration, or val."""
    episodes: cli.Count | None = None
    """Number of episodes of `habitat.Env`, the first of the split; by default all."""
    seed: cli.Seed | None = None
    """Seed of the configuration."""
    categories: Literal["mp3d", "hm3d"] | None = None
    """Numbering of objectgoal: mp3d (21 categories) or hm3d (6); only episodes with these goals are run."""
    motion: MotionKind | None = None
    """contacts (physics), or Habitat's kinematic motion: no-sliding or sliding."""
    profile: str | None = None
    """Rendering quality: fast or good."""
    noise: str | None = None
    """Noise of cameras and drive: none, realsense or harsh."""
    environment: Path = FOLDER
    """Folder of the environment with habitat-lab, if this Python has none."""


def main(args: Args) -> int:
    """Runs the script; returns its exit status."""
    try:
        words = shlex.split(args.script)
    except ValueError as error:
        raise ConfigError(f"The script '{args.script}' cannot be read: {error}.") from None
    if not words or not Path(words[0]).is_file():
        raise ConfigError(f"There is no script '{words[0] if words else ''}'.")
    if not has_lab():
        return _run_elsewhere(args)
    import stubborn_habitat

    stubborn_habitat.configure(
        **{name: value for name in ("motion", "profile", "noise") if (value := getattr(args, name)) is not None}
    )
    from sim.app.bridges.habitat_sim import legacy

    legacy.install(split=args.split, episodes=args.episodes, seed=args.seed, categories=args.categories)
    return _run(words)


def has_lab() -> bool:
    """Returns whether habitat-lab can be imported in this Python; a folder of this name does not count."""
    spec = importlib.util.find_spec("habitat")
    return spec is not None and spec.origin is not None


def _run_elsewhere(args: Args) -> int:
    """Runs the same command in the environment that has habitat-lab; returns its exit status."""
    python = args.environment / "bin" / "python"
    if not python.is_file():
        raise ConfigError(
            f"This Python has no habitat-lab, and there is no {python}: `{command('habitat', 'setup')}` makes an "
            "environment that has it."
        )
    options = [
        word
        for name, value in vars(args).items()
        if name not in ("script", "environment") and value is not None
        for word in (f"--{name}", str(value))
    ]
    options += ["--debug"] if debug() else []
    return subprocess.call([str(python), "-m", "sim.app.commands.main", "habitat", args.script, *options])


def _run(words: list[str]) -> int:
    """Runs a script with its arguments as Python does; returns its exit status.

    Raises:
        ConfigError: it raised an error; the message has its file and line.
    """
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
        raise ConfigError(f"'{words[0]}': {described(error, below=__file__)}") from error
    finally:
        sys.argv, sys.path[:] = before, path
