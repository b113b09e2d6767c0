"""`stubborn`: the table of its commands, its list, and its messages about names that do not exist."""

from __future__ import annotations

import ast
import importlib
import importlib.metadata
from collections.abc import Iterator
from pathlib import Path

import pytest

from sim.app.commands.habitat.script import has_lab
from sim.app.commands.main import COMMANDS, entry

ROOT = Path(__file__).resolve().parents[4]


def file_of(module: str) -> Path:
    return ROOT / f"{module.replace('.', '/')}.py"


def top_names(module: ast.Module) -> Iterator[str]:
    """Yields the names that a module defines, and those that it passes on (`from ... import X as X`)."""
    for node in module.body:
        if isinstance(node, ast.ImportFrom):
            yield from (alias.asname for alias in node.names if alias.asname is not None)
        elif isinstance(node, ast.Assign):
            yield from (target.id for target in node.targets if isinstance(target, ast.Name))
        elif isinstance(node, (ast.ClassDef, ast.FunctionDef)):
            yield node.name


def test_every_module_with_options_is_in_the_table() -> None:
    modules = {
        ".".join(file.relative_to(ROOT).with_suffix("").parts)
        for file in (ROOT / "sim" / "app" / "commands").rglob("*.py")
        if {"Args", "main"} <= set(top_names(ast.parse(file.read_text())))
    }
    assert modules == {
        command.module for command in COMMANDS.values() if command.module.startswith("sim.app.commands.")
    }


@pytest.mark.parametrize("name", COMMANDS)
def test_the_docstring_of_a_command_has_its_purpose_and_its_call(name: str) -> None:
    module = ast.parse(file_of(COMMANDS[name].module).read_text(encoding="utf-8"))
    about = ast.get_docstring(module) or ""
    assert about.splitlines()[0].endswith((".", ",")) or name in ("run", "web")
    assert f"stubborn {name}" in about
    summary = COMMANDS[name].summary
    assert summary[0].isupper()
    assert not summary.endswith(".")
    assert len(summary) <= 60


@pytest.mark.parametrize("name", COMMANDS)
def test_help_of_a_command_has_its_name_and_says_what_it_does(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        entry([*name.split(), "--help"])
    assert ended.value.code == 0
    shown = capsys.readouterr().out
    assert shown.startswith(f"usage: stubborn {name} [-h]")
    assert importlib.import_module(COMMANDS[name].module).Args.__doc__.splitlines()[0][:40] in " ".join(shown.split())
    assert "Options of the" not in shown
    assert "tools/" not in shown
    assert "(default: True)" not in shown  # `--no-NAME` is the option, so that its text would contradict it


@pytest.mark.parametrize("words", [[], ["--help"], ["-h"], ["help"]])
def test_the_list_has_one_line_for_each_command(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert entry(words) == 0
    lines = capsys.readouterr().out.splitlines()
    for name, command in COMMANDS.items():
        assert [line for line in lines if line.split("  ")[1:2] == [name] and line.endswith(f"  {command.summary}.")]
    assert max(map(len, lines)) <= 90


@pytest.mark.parametrize("group", ["houses", "train", "import"])
def test_a_group_alone_lists_its_commands(group: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert entry([group]) == 0
    shown = capsys.readouterr().out
    for name in COMMANDS:
        assert (f"  {name}  " in shown) == name.startswith(f"{group} ")


@pytest.mark.parametrize(
    ("typed", "message"),
    [
        ("rnu --episodes 3", "There is no command 'rnu'. Did you mean 'run'?"),
        ("houses generat", "There is no command 'houses generat'. Did you mean 'houses generate'?"),
        ("views shwo", "There is no command 'views shwo'. Did you mean 'views show'?"),
        ("zzzzqqq", "There is no command 'zzzzqqq'."),
        ("a\x1b[31m", "There is no command 'a\\x1b[31m'."),
    ],
)
def test_an_unknown_command_is_one_line_with_the_nearest_name(
    typed: str, message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert entry(typed.split(" ")) == 2
    assert capsys.readouterr().err == f"error: {message} `stubborn` lists all commands.\n"


def test_a_group_with_a_default_takes_options_directly(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert entry(["views", "--split", "nowhere", "--out", str(tmp_path / "out")]) == 2
    assert "Unknown split 'nowhere'" in capsys.readouterr().err


def test_the_version_is_that_of_the_package(capsys: pytest.CaptureFixture[str]) -> None:
    assert entry(["--version"]) == 0
    assert capsys.readouterr().out.strip() == importlib.metadata.version("stubborn-objectnav")


def test_both_forms_of_run_are_the_same_command(capsys: pytest.CaptureFixture[str]) -> None:
    from sim.app.commands import run

    assert entry(["run", "--list-agents"]) == 0
    listed = capsys.readouterr().out
    assert run.entry(["--list-agents"]) == 0
    assert capsys.readouterr().out == listed


@pytest.mark.parametrize("file", [*(ROOT / "sim/app/commands").rglob("*.py"), *(ROOT / "sim").glob("*.py")], ids=str)
def test_commands_import_nothing_from_tools_tests_or_examples(file: Path) -> None:
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
        names += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
        assert not [name for name in names if name.split(".")[0] in ("tools", "tests", "examples")]


def test_no_file_changes_where_modules_are_looked_for() -> None:
    folders = ("sim", "stubborn", "tools", "examples", "tests")
    files = [
        str(file.relative_to(ROOT))
        for folder in folders
        for file in (ROOT / folder).rglob("*.py")
        if "sys.path." + "insert" in file.read_text(encoding="utf-8")
    ]
    assert files == ["sim/app/composition/imports.py"]  # the current folder, where `--agent package.module:NAME` looks


@pytest.mark.skipif(has_lab(), reason="the script then runs in this Python")
def test_a_script_of_habitat_runs_elsewhere_with_all_options(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    python = tmp_path / "bin" / "python"
    python.parent.mkdir()
    python.write_text('#!/bin/sh\necho "$@"\n')
    python.chmod(0o755)
    words = ["habitat", str(Path(__file__)), "--split", "val", "--environment", str(tmp_path), "--debug"]
    assert entry(words) == 0
    assert f"habitat {Path(__file__)} --split val --debug" in capfd.readouterr().out
