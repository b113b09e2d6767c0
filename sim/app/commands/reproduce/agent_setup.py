"""Describes what a run of a table evaluates: an agent with its options, as on the command line of `stubborn run`."""

from __future__ import annotations

import shlex
from dataclasses import dataclass
from typing import Any

from sim.app.composition.agents import find_agent
from sim.app.composition.options import RunOptions
from sim.core.configuration import as_json, parse_assignments
from sim.core.errors import ConfigError

GROUND_TRUTH = "gt"
"""The segmentation of agents that do not use one: they are run once, under this name."""
FORM = "AGENT [--semantics SOURCE] [--explorer NAME] [--verification METHOD] [--config FIELD=VALUE ...]"
"""The text that `AgentSetup.named` takes."""


def uses_segmentation(agent: str) -> bool:
    """Returns False for an agent whose results do not depend on `--semantics`."""
    return find_agent(agent).uses_segmentation


@dataclass(frozen=True)
class AgentSetup:
    """An agent with its options and a source of segmentation."""

    agent: str
    semantics: str
    verification: str = RunOptions.verification
    explorer: str | None = None
    config: tuple[str, ...] = ()
    """Assignments to fields of the configuration, as `--config` takes them."""

    @classmethod
    def named(cls, name: str, semantics: str) -> AgentSetup:
        """Returns the setup of a text such as "stubborn --explorer tour", with a source of segmentation, which the text
        can replace.

        Raises:
            ConfigError: the text has another form than `FORM`.
        """
        options = _options(name)
        agent = options["agent"][0]
        chosen = (options.get("semantics") or [semantics])[0]
        semantics = chosen if uses_segmentation(agent) else GROUND_TRUTH
        return cls(
            agent,
            semantics,
            (options.get("verification") or [RunOptions.verification])[0],
            (options.get("explorer") or [None])[0],
            tuple(options.get("config", ())),
        )

    @property
    def name(self) -> str:
        """The text that `named` takes, without the segmentation."""
        return shlex.join((self.agent, *(word for words in self._changes().values() for word in words)))

    @property
    def label(self) -> str:
        """Name in a table with several kinds of segmentation."""
        return f"{self.name} ({self.semantics})" if uses_segmentation(self.agent) else self.name

    @property
    def variant(self) -> str:
        """The options in which it differs from the agent, for the name of a folder; empty if it does not differ."""
        words = (" ".join(words).removeprefix("--") for words in self._changes().values())
        return "_".join(file_name(each).replace(" ", "-") for each in words)

    def expected(self) -> dict[str, Any]:
        """Returns the entries of a run's `config.json` that say that it is of this setup."""
        return {
            "agent": self.agent,
            "semantics": self.semantics,
            "explorer": self.explorer,
            "verification": self.verification,
            "settings": as_json(parse_assignments(self.config)),
        }

    def _changes(self) -> dict[str, tuple[str, ...]]:
        """Returns the words of each option that is not the default."""
        changes: dict[str, tuple[str, ...]] = {}
        if self.explorer is not None:
            changes["explorer"] = ("--explorer", self.explorer)
        if self.verification != RunOptions.verification:
            changes["verification"] = ("--verification", self.verification)
        if self.config:
            changes["config"] = ("--config", *self.config)
        return changes


def file_name(text: str) -> str:
    """Returns a text without the characters that separate folders, or modules from names."""
    return text.replace(":", "_").replace("/", "_")


def _options(name: str) -> dict[str, list[str]]:
    """Returns the words of the agent and of each option in the text of a setup."""
    try:
        words = shlex.split(name)
    except ValueError as error:
        raise ConfigError(f"--agents: {name!r} cannot be read: {error}.") from None
    options: dict[str, list[str]] = {"agent": []}
    of = "agent"
    for word in words:
        if not word.startswith("--"):
            options[of].append(word)
            continue
        of = word.removeprefix("--")
        if of not in ("semantics", "explorer", "verification", "config") or of in options:
            raise ConfigError(f"--agents: {name!r} has the option {word}; an agent is given as {FORM}.")
        options[of] = []
    for option, given in options.items():
        if not given or (option != "config" and len(given) > 1):
            wanted = "at least one FIELD=VALUE" if option == "config" else "one name"
            raise ConfigError(f"--agents: {name!r} needs {wanted} for {option}; an agent is given as {FORM}.")
    return options
