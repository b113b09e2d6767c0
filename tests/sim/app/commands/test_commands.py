"""Every documented command runs, and the shipped houses are generated again with the same bytes."""

from __future__ import annotations

import dataclasses
import hashlib
import importlib
import shlex
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from sim.app import cli
from sim.app.commands.houses.generate import Args, main
from sim.app.commands.main import COMMANDS
from sim.core.interface import ConfigError
from sim.episodes.house_list import read_house_list
from sim.episodes.splits import load_split, shipped_splits
from sim.homes.housegen.splits.recipes import LISTED, SPLIT_VERSION, SPLITS
from sim.homes.housegen.traps.families.catalogue import CONTACT_SPLITS
from tests.helpers import documented
from tests.helpers.documented import PYTHON, TRIALS, UNTRIED, Only
from tests.helpers.sampling import sample

ROOT = Path(__file__).resolve().parents[4]
DOCUMENTED = {command: where for command, where in documented.commands().items() if "--help" not in command}
TRIED = {command: trial for command in DOCUMENTED if not isinstance(trial := documented.trial_of(command), Only)}
OUTPUTS = ("calibration", "out", "log", "card")
"""Fields of tools' `Args` that name what they write."""
SHIPPED = [(split, recipe.name) for split, recipes in SPLITS.items() if split not in LISTED for recipe in recipes]


@pytest.mark.costly
@pytest.mark.parametrize(("split", "name"), sample(SHIPPED, 2))
def test_a_house_made_again_is_the_shipped_file_to_the_byte(split: str, name: str) -> None:
    recipe = next(recipe for recipe in SPLITS[split] if recipe.name == name)
    made, shipped = recipe.house_bytes(), load_split(split).house_paths[name].read_bytes()
    assert hashlib.sha256(made).hexdigest() == hashlib.sha256(shipped).hexdigest()


def test_the_tool_writes_what_is_shipped(tmp_path: Path) -> None:
    assert main(Args(split="val", houses=1, out=tmp_path / "val")) == 0
    written = (tmp_path / "val" / "val_00.xml").read_bytes()
    assert written == load_split("val").house_paths["val_00"].read_bytes()
    assert (tmp_path / "textures").is_dir()


@pytest.mark.costly
@pytest.mark.parametrize("split", LISTED)
def test_a_listed_house_comes_out_as_listed(split: str) -> None:
    houses = load_split(split).house_list
    assert houses is not None
    name = sample(list(houses.recipes), 1)[0]
    assert hashlib.sha256(houses.recipes[name].house_bytes()).hexdigest() == houses.sha256[name]


@pytest.mark.parametrize("split", [*SPLITS, "train", "traps", *CONTACT_SPLITS])
def test_a_shipped_split_carries_the_one_version(split: str) -> None:
    assert split in shipped_splits()
    assert load_split(split).version == SPLIT_VERSION


@pytest.mark.costly
@pytest.mark.parametrize(("split", "first"), [("train", "train_000"), ("large-test", "large_test_00")])
def test_the_tool_lists_houses_that_pass_and_leaves_their_files_in_the_cache(
    split: str, first: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("STUBBORN_CACHE_DIR", str(tmp_path / "cache"))
    assert main(Args(split=split, houses=1, out=tmp_path / split)) == 0
    assert [file.name for file in (tmp_path / split).iterdir()] == ["houses.json"]
    assert [file.name for file in tmp_path.rglob("*.xml")] == [f"{first}.xml"]
    shipped = load_split(split).house_list
    assert shipped is not None
    assert read_house_list(tmp_path / split).sha256[first] == shipped.sha256[first]


def test_what_is_said_about_trials_is_said_about_documented_commands() -> None:
    stale = [command for command in TRIALS if command not in DOCUMENTED]
    stale += [part for part in UNTRIED if not any(f" {part}" in f" {command}" for command in DOCUMENTED)]
    assert not stale, "in tests/helpers/documented.py but in no page:\n" + "\n".join(stale)


@pytest.mark.parametrize(
    "typed", ["stubborn run --out x", ".venv/bin/stubborn run --out x", "python -m sim.run --out x"]
)
def test_a_command_has_one_form_however_a_page_writes_it(typed: str) -> None:
    assert documented.canonical(shlex.split(typed)) == "stubborn run --out x"


@pytest.mark.parametrize("wrong", ["stubborn rnu", "stubborn run --episode 3", "stubborn houses make --out x"])
def test_a_documented_command_that_does_not_exist_is_found(wrong: str) -> None:
    with pytest.raises(ConfigError):
        _parse(wrong)


def test_every_block_of_commands_says_that_it_is_one() -> None:
    """Every block of shell commands is marked sh and no block lacks a mark, so that no command is missed."""
    known = {"sh", "python", "xml", "json", "toml", "text"}
    odd = [
        f"{block.page}:{block.line}: {block.language or 'no language'}"
        for page in documented.pages()
        for block in documented.blocks(page)
        if block.language not in known
    ]
    assert not odd


@pytest.mark.parametrize("command", TRIED)
def test_a_trial_is_the_documented_command_with_less_to_do(command: str) -> None:
    program, words = documented.program_of(command)
    tried, tried_words = documented.program_of(TRIED[command][-1])
    assert tried == program
    assert {word for word in words if word.startswith("--")} <= set(tried_words)


def test_documented_commands_and_their_trials_are_such_as_their_tools_take() -> None:
    places = documented.commands() | documented.unmarked_commands()
    trials = {step: "tests/helpers/documented.py" for name in TRIED for step in _steps(name, Path("scratch"))}
    refused = []
    for command, where in {**trials, **places}.items():
        try:
            _parse(command)
        except (ConfigError, ImportError) as error:
            refused.append(f"{where}: {command}\n    {error}")
    assert not refused, "\n".join(refused)


def test_files_that_documented_commands_read_exist_or_are_written_by_another_command() -> None:
    parsed = {command: _parse(command) for command in documented.commands()}
    made = {str(value) for args in parsed.values() for name, value in _paths(args) if name in OUTPUTS}
    made |= {shlex.split(command)[-1] for command in parsed if "my_furniture.py" in command}
    made |= {str(parent) for value in made for parent in Path(value).parents if parent.name}
    for command, args in parsed.items():
        for name, path in _paths(args):
            whole = {str(path), *(str(parent) for parent in path.parents)}
            exists = (documented.ROOT / path).exists() or bool(whole & made) or str(path) in documented.STAND_INS
            assert name in OUTPUTS or exists, f"{command}: no command of the docs makes '{path}'"


@pytest.mark.costly
@pytest.mark.parametrize("command", sample(list(TRIED), 1))
def test_a_documented_command_runs(command: str, tmp_path: Path) -> None:
    _try(command, tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("command", TRIED)
def test_each_documented_command_runs(command: str, tmp_path: Path) -> None:
    _try(command, tmp_path)


def _try(command: str, scratch: Path) -> None:
    for step in _steps(command, scratch):
        words = [sys.executable if word == PYTHON else word for word in shlex.split(step)]
        if words[0] == "stubborn":
            words[:1] = [sys.executable, "-m", "sim.app.commands.main"]
        ended = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=False, timeout=300)
        assert ended.returncode == 0, f"{step}\n{ended.stdout[-2000:]}\n{ended.stderr[-2000:]}"


def _steps(command: str, scratch: Path) -> tuple[str, ...]:
    return tuple(step.replace("{tmp}", str(scratch)) for step in TRIED[command])


def _parse(command: str) -> Any:
    """Returns the `Args` that the tool reads from the command, or None if the command has no `Args`.

    Raises:
        ConfigError: the option does not exist, or a target, tool or program is unknown to this test.
    """
    words = shlex.split(command)
    if words[0] == "make" and len(words) == 2:
        ended = subprocess.run(["make", "-n", words[1]], cwd=ROOT, capture_output=True, text=True, check=False)
        if ended.returncode:
            raise ConfigError(ended.stderr)
        return None
    program, argv = documented.program_of(command)
    if words[0] == "stubborn":
        return _parse_options(COMMANDS[program].module, argv) if program in COMMANDS else _list_of(program, argv)
    if words[0] in documented.FOREIGN:
        return None
    if words[0] != PYTHON:
        raise ConfigError(f"no test knows what to make of '{words[0]}'")
    if program == "-c":  # part of a trial: writes the files that the next step reads
        return None
    if program.endswith(".py") and not (ROOT / program).is_file():
        raise ConfigError(f"no file {program}")
    return _parse_options(program.removesuffix(".py").replace("/", "."), argv)


def _list_of(program: str, argv: list[str]) -> None:
    """Checks a command that only lists commands, or prints the version.

    Raises:
        ConfigError: there is no such command.
    """
    if set(argv) - {"--help", "--version"}:
        raise ConfigError(f"stubborn has no command '{program} {argv[0]}'")


def _parse_options(name: str, argv: list[str]) -> Any:
    """Returns the options that the `Args` of a module reads."""
    module = importlib.import_module(name)
    if not hasattr(module, "Args"):
        if any(word.startswith("-") for word in argv):
            raise ConfigError(f"{name} has no options")
        return None
    try:
        return cli.parse(module.Args, argv)
    except SystemExit:
        assert "--help" in argv
        return None


def _paths(args: Any) -> list[tuple[str, Path]]:
    """Returns the fields of an `Args` that hold paths, including houses and splits that are given as a path."""
    paths = []
    for field in dataclasses.fields(args) if args is not None else ():
        value = getattr(args, field.name)
        for item in value if isinstance(value, tuple) else (value,):
            if isinstance(item, Path) or (field.name == "split" and "/" in str(item)):
                paths.append((field.name, Path(item)))
    return paths
