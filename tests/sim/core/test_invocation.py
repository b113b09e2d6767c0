"""Messages name commands as the user typed them, and files always use the same name."""

from __future__ import annotations

import re
import subprocess
import sys
from importlib.machinery import ModuleSpec
from pathlib import Path

import pytest

from sim.core import invocation

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture
def project(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Creates a folder with an environment in it, which is not on the path, and makes it the current folder."""
    binaries = tmp_path / "project" / ".venv" / "bin"
    binaries.mkdir(parents=True)
    (binaries / "python").symlink_to(sys.executable)
    (binaries / "stubborn").write_text("#!/bin/sh\n")
    (binaries / "stubborn").chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(binaries / "python"))
    monkeypatch.setenv("PATH", "/nowhere")
    monkeypatch.chdir(tmp_path / "project")
    return tmp_path / "project"


def start_as_module(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys.modules["__main__"], "__spec__", ModuleSpec(name, None))


def start_as_script(typed: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys.modules["__main__"], "__spec__", None)
    monkeypatch.setattr(sys, "argv", [typed])


def test_the_interpreter_is_named_as_one_would_type_it(
    project: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert invocation.python() == ".venv/bin/python"
    monkeypatch.chdir(tmp_path)
    assert invocation.python() == "project/.venv/bin/python"
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    assert invocation.python() == str(project / ".venv/bin/python")
    monkeypatch.setenv("PATH", str(project / ".venv/bin"))
    assert invocation.python() == "python"


def test_a_script_is_named_as_it_was_typed(project: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    start_as_script(".venv/bin/stubborn", monkeypatch)
    assert invocation.command("report", Path("runs/my run")) == ".venv/bin/stubborn report 'runs/my run'"
    start_as_script(str(project / ".venv/bin/stubborn"), monkeypatch)
    assert invocation.command("web") == f"{project}/.venv/bin/stubborn web"
    monkeypatch.setenv("PATH", str(project / ".venv/bin"))  # a shell gives a script of the path its whole name
    assert invocation.command("web") == "stubborn web"


@pytest.mark.parametrize("name", ["sim.run", "sim.web"])
def test_a_program_started_as_a_module_names_existing_modules(
    name: str, project: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    start_as_module(name, monkeypatch)
    assert invocation.command("report", Path("runs/my run")) == ".venv/bin/python -m sim.report 'runs/my run'"
    assert invocation.command("houses", "generate") == ".venv/bin/stubborn houses generate"
    (project / ".venv/bin/stubborn").unlink()
    assert invocation.command("houses", "generate") == "stubborn houses generate"


@pytest.mark.parametrize("name", ["pytest.__main__", "tools.research.lean_tables"])
def test_other_programs_name_the_installed_command(name: str, project: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    start_as_module(name, monkeypatch)
    assert invocation.command("episodes") == "stubborn episodes"


def test_the_command_that_runs_has_the_name_that_was_typed(project: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    start_as_module("sim.web", monkeypatch)
    assert invocation.program() == ".venv/bin/python -m sim.web"
    start_as_script(".venv/bin/stubborn", monkeypatch)
    with invocation.running("houses generate"):
        assert invocation.program() == ".venv/bin/stubborn houses generate"
    start_as_module("sim.app.commands.main", monkeypatch)
    with invocation.running("views"):
        assert invocation.program() == ".venv/bin/python -m sim.app.commands.main views"


@pytest.mark.costly
@pytest.mark.parametrize("words", ["-m sim.web", "-m sim.report", "-m sim.app.commands.main evaluate mistakes"])
def test_help_names_the_command_that_was_given(words: str) -> None:
    done = subprocess.run(
        [sys.executable, *words.split(), "--help"], cwd=ROOT, capture_output=True, text=True, check=False, timeout=100
    )
    assert re.search(rf"^usage: \S*python\S* {re.escape(words)} \[-h\]", done.stdout)
