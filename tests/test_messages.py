"""The catalogue of all messages of errors: each is a sentence, and none has the grammar that readers stumble over."""

from __future__ import annotations

import ast
import functools
import re
from pathlib import Path

import pytest

from sim.core import errors

ROOT = Path(__file__).parents[1]
ERRORS = {name for name, value in vars(errors).items() if isinstance(value, type) and issubclass(value, Exception)}
STUMBLES = {
    "a nominal negation": re.compile(r"(?<![Tt]here )\b(is|are) (no|none)\b(?! longer)"),
    "a relative clause that begins with 'of which'": re.compile(r"\bof which\b"),
    "'letters' in place of characters": re.compile(r"\bletters\b"),
    "'thing' in place of object": re.compile(r"\bthings?\b(?! that can be pushed)"),
    "'play' in place of run": re.compile(r"\bplay(s|ed)?\b"),
}
"""What style sheets of this project replace, and how it is recognised."""

COMPLETED = ("sim/app/bridges/process.py", "sim/app/bridges/process_pipe.py")
"""Modules whose callers put the agent's name before the message and a period after it."""


def text_of(node: ast.expr) -> str | None:
    """Returns the text of a literal with `{}` for its values; None if it is not a literal."""
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return node.value
    if isinstance(node, ast.JoinedStr):
        return "".join("{}" if isinstance(part, ast.FormattedValue) else str(text_of(part)) for part in node.values)
    return None


@functools.cache
def messages() -> list[tuple[str, str]]:
    """Returns place and text of each message that the code raises."""
    found = []
    for package in ("sim", "stubborn"):
        for file in sorted((ROOT / package).rglob("*.py")):
            for node in ast.walk(ast.parse(file.read_text())):
                if (
                    isinstance(node, ast.Call)
                    and isinstance(node.func, ast.Name)
                    and node.func.id in ERRORS
                    and node.args
                ):
                    text = text_of(node.args[0])
                    if text is not None:
                        found.append((f"{file.relative_to(ROOT)}:{node.lineno}", text))
    return found


def test_the_catalogue_has_the_messages_of_all_layers() -> None:
    assert len(messages()) > 500
    assert {place.split("/")[1] for place, _ in messages() if place.startswith("sim")} >= {
        "core",
        "houses",
        "homes",
        "app",
    }


def test_each_message_is_a_sentence() -> None:
    begins, ends = re.compile(r"[A-Z{'\"`\-]|\w+[:.=(\[ ]"), re.compile(r"[.?!]['\"`)]?$|\{\}$|'$")
    broken = [
        f"{place} {text}"
        for place, text in messages()
        if not place.startswith(COMPLETED) and not (begins.match(text) and ends.search(text))
    ]
    assert broken == []


@pytest.mark.parametrize("what", STUMBLES)
def test_no_message_has_the_grammar_that_readers_stumble_over(what: str) -> None:
    assert [f"{place} {text}" for place, text in messages() if STUMBLES[what].search(text)] == []
