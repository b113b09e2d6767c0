"""Reads names of agents in a process of their own, `process:COMMAND`: the words and files of the command."""

from __future__ import annotations

import functools
import itertools
import os
import re
import shlex
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, get_args

from sim.app.evaluation.own_code import one_line
from sim.app.options import PROCESS
from sim.core.errors import ConfigError
from sim.core.geometry.numbers import require_numbers

BOUNDARY = Path(__file__).with_name("process_boundary.py")
Interface = Literal["stubborn", "habitat"]
Boundary = Literal["none", "auto", "namespace"]


@dataclass(frozen=True, kw_only=True)
class BridgeConfig:
    """Base class of the options of agents whose code cannot declare sensors: `--config sensors=[...]` declares them."""

    looks: bool = False
    """True: the agent may also return LOOK_UP and LOOK_DOWN, Habitat's actions 4 and 5."""


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
    boundary: Boundary = "none"
    """`namespace`: the process has no network and sees neither the houses, nor the results, nor other processes (Linux
    where users may make namespaces); `auto`: the same where it is possible; `none`: it runs as the same user."""
    hidden: tuple[Path, ...] = ()
    """Further files and folders that a process in namespaces does not see."""

    def __post_init__(self) -> None:
        require_numbers(self)
        if self.boundary not in get_args(Boundary):
            raise ConfigError(
                f"ProcessConfig.boundary must be one of {', '.join(get_args(Boundary))}, got '{self.boundary}'."
            )
        if self.hidden and self.boundary == "none":
            raise ConfigError("agent.hidden needs agent.boundary=namespace or auto.")
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


@functools.cache
def fault_of_namespaces() -> str:
    """Returns the reason why this machine does not allow the namespaces of `process_boundary`; "": it allows them."""
    if sys.platform != "linux":
        return f"they need Linux, this is {sys.platform}"
    words = [sys.executable, "-I", "-S", str(BOUNDARY)]
    try:
        tried = subprocess.run(words, capture_output=True, text=True, timeout=20.0, check=False)
    except (OSError, subprocess.TimeoutExpired) as error:
        return one_line(str(error))
    return "" if tried.returncode == 0 else one_line(tried.stderr) or f"status {tried.returncode}"


def is_bounded(config: object) -> bool:
    """Returns whether the agent with this configuration runs in namespaces.

    Raises:
        ConfigError: it must, and this machine does not allow them.
    """
    if not isinstance(config, ProcessConfig) or config.boundary == "none":
        return False
    fault = fault_of_namespaces()
    if fault and config.boundary == "namespace":
        raise ConfigError(f"agent.boundary=namespace is not possible on this machine: {fault}.")
    return not fault


def takes_words(config: object) -> bool:
    """Returns whether the agent with this configuration gets the goal itself; Habitat's agents get its number only."""
    return not isinstance(config, ProcessConfig) or config.interface == "stubborn"


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
