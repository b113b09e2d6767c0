"""Reads names of agents in a process of their own, `process:COMMAND`: the words and files of the command."""

from __future__ import annotations

import itertools
import os
import re
import shlex
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, get_args

from sim.app.options import PROCESS
from sim.core.errors import ConfigError
from sim.core.geometry.numbers import require_numbers

Interface = Literal["stubborn", "habitat"]


@dataclass(frozen=True, kw_only=True)
class BridgeConfig:
    """Base class of the options of agents whose code cannot declare sensors: `--config sensors=[...]` declares them."""


@dataclass(frozen=True, kw_only=True)
class ProcessConfig(BridgeConfig):
    """The options of an agent in a process of its own. `--step-timeout` limits each of its calls."""

    start_timeout_s: float = 120.0
    """Longest time from the start of the command to its first answer."""
    interface: Interface = "stubborn"
    """The agent's interface: `stubborn` (`reset(goal, seed)`), or `habitat` (`reset()`, observations and actions as
    Habitat has them)."""
    categories: str = "mp3d"
    """With `habitat`: the data set that numbers the goals, `mp3d` or `hm3d`."""
    normalize_depth: bool = True
    """With `habitat`: depth is scaled to [0, 1]; False: metres."""

    def __post_init__(self) -> None:
        require_numbers(self)
        if self.interface not in get_args(Interface):
            raise ConfigError(
                f"ProcessConfig.interface must be one of {', '.join(get_args(Interface))}, got '{self.interface}'."
            )
        ours = ProcessConfig.categories, ProcessConfig.normalize_depth
        if self.interface != "habitat" and (self.categories, self.normalize_depth) != ours:
            raise ConfigError("agent.categories and agent.normalize_depth need agent.interface=habitat.")
        if self.start_timeout_s <= 0.0:
            raise ConfigError(f"ProcessConfig.start_timeout_s must be > 0 s, got {self.start_timeout_s}.")


def command_of(name: str) -> list[str]:
    """Returns the words of the command in a name `process:COMMAND`, split as a shell does.

    Raises:
        ConfigError: the command is empty or cannot be split.
    """
    text = name.removeprefix(PROCESS)
    try:
        words = shlex.split(text)
    except ValueError as fault:
        raise ConfigError(f"--agent '{name}': the command cannot be split into words: {fault}.") from None
    if not words or not words[0]:
        raise ConfigError(f"--agent '{name}': a command must follow, for example {PROCESS}'python my_agent.py'.")
    return words


def files_of(name: str) -> list[Path]:
    """Returns the plain files that the command of an agent names, and those of modules: `-m MODULE`, `MODULE:CLASS`.

    Modules are looked up in the current folder and in the folders of `PYTHONPATH`.
    """
    words = command_of(name)
    modules = [word for before, word in itertools.pairwise(words) if before == "-m"]
    modules += [word.partition(":")[0] for word in words if re.fullmatch(r"[A-Za-z_][\w.]*:[A-Za-z_]\w*", word)]
    folders = [Path(folder) for folder in ("", *os.environ.get("PYTHONPATH", "").split(os.pathsep))]
    files = [f"{module.replace('.', '/')}{end}" for module in modules for end in (".py", "/__main__.py")]
    paths = [Path(word) for word in words] + [folder / file for file in files for folder in folders]
    return list(dict.fromkeys(path for path in paths if is_file(path)))


def is_file(path: Path) -> bool:
    """Returns whether a path is a file; False for text that can be no path, such as a long sentence."""
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False
