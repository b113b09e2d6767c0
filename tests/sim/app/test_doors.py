"""The ways to start the commands, and the list of commands without the packages that only commands need."""

from __future__ import annotations

import subprocess
import sys

import pytest


def _python(*words: str) -> str:
    return subprocess.run([sys.executable, *words], capture_output=True, text=True, check=True).stdout


@pytest.mark.parametrize(
    "words", [["-m", "stubborn"], ["-m", "sim.cli"], ["-m", "sim.app.commands.main"]], ids="-".join
)
def test_python_starts_the_commands(words: list[str]) -> None:
    assert "Run episodes of an agent" in _python(*words, "--help")


@pytest.mark.parametrize("words", [[], ["--help"], ["--version"]], ids="".join)
def test_the_list_of_commands_imports_neither_numpy_nor_tyro(words: list[str]) -> None:
    code = (
        f"import sys; sys.argv = ['stubborn', *{words}]\nfrom sim.app.commands.main import entry\nassert entry() == 0"
    )
    imported = _python("-c", f"{code}\nprint(sorted({{'numpy', 'tyro', 'mujoco', 'rich'}} & set(sys.modules)))")
    assert imported.splitlines()[-1] == "[]"
