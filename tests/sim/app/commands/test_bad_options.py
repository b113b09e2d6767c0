"""Bad options of every command give one line on stderr and exit status 2; new commands need no entry here."""

from __future__ import annotations

import dataclasses
import importlib
import math
import re
import typing
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
import tyro

from sim.app import cli
from sim.app.commands.main import COMMANDS as COMMANDS_OF_USERS
from sim.core.errors import ConfigError

ROOT = Path(__file__).resolve().parents[4]
NUMBERS = {int: (-7, 10**30), float: (-7.0, math.nan, math.inf, 1e308)}
"""Values that no option of these types takes."""


def commands() -> dict[str, ModuleType]:
    """Returns all modules that have options and a main function."""
    tools = [".".join(file.relative_to(ROOT).with_suffix("").parts) for file in (ROOT / "tools").glob("*/*.py")]
    names = [
        *(command.module for command in COMMANDS_OF_USERS.values()),
        *(name for name in tools if "def main(" in source(name)),
    ]
    modules = {name: importlib.import_module(name) for name in sorted(names)}
    return {name: module for name, module in modules.items() if hasattr(module, "Args")}


def source(name: str) -> str:
    return (ROOT / f"{name.replace('.', '/')}.py").read_text(encoding="utf-8")


COMMANDS = commands()


def required(args_type: type) -> list[str]:
    """Returns words for the options that have no default."""
    words: list[str] = []
    hints = typing.get_type_hints(args_type, include_extras=True)
    for field in dataclasses.fields(args_type):
        if field.default is dataclasses.MISSING and field.default_factory is dataclasses.MISSING:
            positional = any("Positional" in str(mark) for mark in cli._marks(hints[field.name]))
            is_picture = any(getattr(mark, "picture", False) for mark in cli._marks(hints[field.name]))
            value = "x.png" if is_picture else "x"
            words += [value] if positional else [f"--{field.name.replace('_', '-')}", value]
    return words


def bad_values(args_type: type) -> Iterator[tuple[str, Any]]:
    """Yields fields with values that are not allowed: numbers out of range, and paths that cannot be written."""
    for name, hint in typing.get_type_hints(args_type, include_extras=True).items():
        bare, marks = cli._bare(hint), list(cli._marks(hint))
        if any(isinstance(mark, tyro.constructors.PrimitiveConstructorSpec) for mark in marks):
            continue  # its own parser checks it
        several = typing.get_origin(bare) is tuple
        if several:
            bare = cli._bare(next(iter(typing.get_args(bare))))
        for value in NUMBERS.get(bare, ()):
            yield name, (value,) if several else value
        if any(isinstance(mark, cli.Written) for mark in marks):
            yield from ((name, Path(text)) for text in ("/dev/null/x", "n" * 300))
        if any(getattr(mark, "picture", False) for mark in marks):
            yield from ((name, Path(text)) for text in ("sheet", "sheet.txt"))


def refusal(
    name: str, words: list[str], capsys: pytest.CaptureFixture[str], main: Any = None, lines: int | None = 1
) -> str:
    """Returns the message of a command that is refused, after checking that it is one line without a traceback."""
    module = COMMANDS[name]
    capsys.readouterr()
    assert cli.run(module.Args, main or module.main, words) == 2, f"{name} {words}"
    message = capsys.readouterr().err
    assert lines is None or (message.startswith("error: ") and message.count("\n") == lines), f"{words}: {message}"
    return message


@pytest.mark.parametrize("name", COMMANDS)
def test_every_number_and_path_of_a_command_is_checked_before_it_begins(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    args_type, words = COMMANDS[name].Args, required(COMMANDS[name].Args)
    args = cli.parse(args_type, words)
    cli.check(args)
    for field, value in bad_values(args_type):
        with pytest.raises(ConfigError, match=f"--{field.replace('_', '-')} "):
            cli.check(dataclasses.replace(args, **{field: value}))
    for more in (["--no-such-option", "x"], ["a\x1b[31m"], ["--debug", "a\udcff"]):
        message = refusal(name, [*words, *more], capsys, main=lambda args: pytest.fail("it began"), lines=None)
        assert "\x1b" not in message
    assert list(tmp_path.iterdir()) == []


BAD: dict[str, list[tuple[str, str]]] = {
    "sim.app.commands.report": [("nowhere", "it has no config.json"), ("FILE", "config.json")],
    "tools.benchmarks.against": [
        ("--against nowhere", "names no commit"),
        ("--against HEAD --parts walk", "--parts must be some of"),
        ("--against HEAD --rounds 0", "--rounds must be at least 1"),
    ],
    "sim.app.commands.houses.check": [
        ("--split nowhere", "Unknown split 'nowhere'"),
        ("--kind castle", "castle"),
        ("--split val --kind estate", "--kind is for new houses"),
        ("--furnished", "--furnished needs --split or --house"),
    ],
    "sim.app.commands.compare": [("nowhere nowhere", "is not a run")],
    "tools.maintenance.describe_houses": [("--root nowhere --out OUT", "nowhere")],
    "sim.app.commands.evaluate.segmentation": [
        ("--views nowhere --weights nowhere", "No weights at 'nowhere'"),
        ("--views nowhere --weights FILE", "cannot be read"),
        ("--views nowhere --curves OUT", "--curves needs --card"),
    ],
    "sim.app.commands.gallery": [
        ("--out OUT", "needs --houses FILE ..., --house FILE or --sheet"),
        ("--out OUT --houses nowhere.xml", "no such file"),
        ("--out OUT --houses FILE", "is not text in utf-8"),
        ("--out OUT --sheet --categories spoons", "spoons"),
        ("--out OUT --house FILE --categories chair", "--categories needs --sheet"),
        ("--out OUT --sheet --furniture nowhere", "has no models.json"),
    ],
    "sim.app.commands.houses.generate": [
        ("--out OUT --split nowhere", "No split 'nowhere'"),
        ("--out OUT --transfer-test", "needs --furniture"),
        ("--out OUT --only-imported", "needs --furniture"),
        ("--out OUT --furniture-split transfer", "--furniture-split needs --furniture"),
        ("--out OUT --furniture OUT --transfer-test --only-imported", "--only-imported has no effect with"),
        ("--out OUT --furniture nowhere", "has no models.json"),
    ],
    "sim.app.commands.views.generate": [
        ("--out OUT --split nowhere", "Unknown split"),
        ("--out OUT --shrink 7", "--shrink must divide"),
        ("--out OUT --rgb gif", "invalid choice 'gif' for argument '--rgb'"),
        ("--out OUT --profile best", "best"),
        ("--out OUT --shard 3/2", '--shard must be "i/n"'),
        ("--out OUT --executor cloud", "cloud"),
        ("--out OUT --aim common", "invalid choice 'common' for argument '--aim'"),
        ("--out OUT --withheld only", "--withheld needs --pool"),
    ],
    "sim.app.commands.views.mix": [("--out OUT --furniture nowhere", "is not a folder")],
    "sim.app.commands.importing.furniture": [("--source nowhere --out OUT", "nowhere")],
    "sim.app.commands.episodes": [
        ("--split nowhere", "There is no house"),
        ("--split nowhere --recipe cake", "no house|cake"),
    ],
    "sim.app.commands.merge": [("nowhere", "Give one folder"), ("nowhere nowhere --out OUT", "is not a run")],
    "tools.training.render_demonstrations": [
        ("nowhere --out OUT", "is not a run"),
        ("--out OUT", "Name at least one run"),
    ],
    "sim.app.commands.reproduce.reproduce": [
        ("dinner --out OUT", "dinner"),
        ("ablation --split nowhere --out OUT", "Unknown split"),
    ],
    "sim.app.commands.evaluate.mistakes": [
        ("nowhere --out OUT", "is not a run"),
        ("nowhere --out OUT --cause hunger", "--cause must be one of"),
    ],
    "sim.app.commands.views.show": [("--views nowhere --out OUT", "No shards")],
    "tools.maintenance.split_report": [("--splits nowhere", "Unknown split")],
    "sim.app.commands.seal.make": [
        ("--out OUT --announced FILE --beacon x --houses 3", "--houses has no effect with --announced"),
    ],
    "sim.app.commands.run": [("--verification none --verifier FILE", "--verifier has no effect")],
    "sim.training.cloned.trainer": [("--demonstrations nowhere --out OUT", "No demonstration in 'nowhere'")],
    "sim.app.commands.train.segmentation": [
        ("--views nowhere --val-views nowhere --out OUT --size vast", "--size must be one of"),
        ("--views nowhere --val-views nowhere --out OUT --batch 1", "--batch must be at least 2"),
        ("--views nowhere --val-views nowhere --out OUT", "No shards"),
        ("--views nowhere --out OUT", "--views and --val-views are given together"),
        ("--furniture nowhere --out OUT", "is not a folder"),
    ],
    "sim.app.commands.train.fusion": [
        ("--split val --out OUT", "fitted on houses of 'val'"),
        ("--split OUT --semantics gt --out OUT", "makes no errors to learn"),
        ("--split nowhere --out OUT", "nowhere"),
        ("--split train --out OUT --minutes 0 --log OUT", "has no tracks"),
    ],
    "sim.app.commands.train.verifier": [
        ("--semantics gt --out OUT", "makes no errors to learn"),
        ("--split nowhere --out OUT", "Unknown split"),
        ("--split val --out OUT", "fitted on houses of 'val'"),
    ],
    "sim.app.commands.traps.make": [
        ("--out OUT --family glass", "pane_gap"),
        ("--out OUT --split contact", "contact-val"),
        ("--out OUT", "Name either a family"),
        ("--out OUT --family jam --split contact-val", "Name either a family"),
        ("--out OUT --split contact-val --count 3", "--count needs --family"),
    ],
    "sim.app.commands.traps.report": [
        ("--out OUT --split nowhere", "Unknown split"),
        ("--out OUT --agents nobody", "nobody"),
        ("--out OUT --traps pit", "pit"),
    ],
    "tools.training.plan_demonstrations": [("--out OUT --kind castle", "castle")],
    "sim.app.commands.views.unpack": [("--views nowhere --out OUT", "No shards")],
}


@pytest.mark.costly
@pytest.mark.parametrize(
    ("name", "words", "message"), [(name, words, message) for name, rows in BAD.items() for words, message in rows]
)
def test_options_that_name_nothing_are_one_line_and_leave_no_file(
    name: str,
    words: str,
    message: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_bytes(b"\x00\xffno file of ours\n")
    arguments = [{"OUT": "out/page.png", "FILE": "file"}.get(word, word) for word in words.split()]
    assert re.search(message, refusal(name, arguments, capsys))
    assert [path.name for path in tmp_path.iterdir()] == ["file"]
