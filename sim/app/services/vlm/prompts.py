"""The texts of the questions, from `prompts.toml` or a file of the user with the same keys."""

from __future__ import annotations

import string
import tomllib
from pathlib import Path

import msgspec

from sim.core.errors import ConfigError
from sim.core.reading import open_plain

FILE = Path(__file__).with_name("prompts.toml")


class Shown(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Sentences on the pictures."""

    map: str
    views: str
    outlined: str


class Prompts(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The texts; words that begin with `$` are filled in (`string.Template`)."""

    system: str
    ready: str
    place: str
    stop: str
    shown: Shown

    @classmethod
    def read(cls, file: Path) -> Prompts:
        """Returns the texts in a file.

        Raises:
            ConfigError: it is not a TOML file with these keys, or a text has a word with `$` that nothing fills in.
        """
        with open_plain(file, what="Prompts") as stream:
            content = stream.read()
        try:
            prompts = msgspec.toml.decode(content, type=cls)
            filled(prompts.place, goal="", places="", count="", pictures="")
            filled(prompts.stop, goal="", outlined="")
        except (ConfigError, msgspec.DecodeError, UnicodeError, tomllib.TOMLDecodeError) as error:
            raise ConfigError(f"Prompts '{file}': {error}") from None
        return prompts


def filled(text: str, **values: str) -> str:
    """Returns a text with its words filled in.

    Raises:
        ConfigError: it has another word with `$`.
    """
    try:
        return string.Template(text).substitute(values).strip()
    except (KeyError, ValueError) as error:
        names = ", ".join(f"${name}" for name in values)
        raise ConfigError(f"a text may use {names}, and $$ for a dollar sign; it has {error}.") from None
