"""Training commands without a package of the extra `train`: one line before any work, and help text all the same."""

from __future__ import annotations

import importlib
import subprocess
import sys
from pathlib import Path

import pytest

from sim.app import cli
from sim.app.commands.main import COMMANDS

NEEDS = {
    "poni": ("--plans nowhere", ["matplotlib"]),
    "cloned": ("--demonstrations nowhere", ["matplotlib"]),
    "semexp": ("--plans nowhere", ["matplotlib", "stable_baselines3"]),
    "fusion": ("--split nowhere", ["sklearn"]),
    "verifier": ("--split nowhere", ["sklearn"]),
}
"""Options and needed packages of each command."""


@pytest.mark.parametrize(
    ("name", "package"), [(name, package) for name, (_, packages) in NEEDS.items() for package in packages]
)
def test_a_missing_package_is_reported_in_one_line_before_any_work(
    name: str, package: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    module = importlib.import_module(COMMANDS[f"train {name}"].module)
    words = [*NEEDS[name][0].split(), "--out", str(tmp_path / "out")]
    monkeypatch.setitem(sys.modules, package, None)  # as if it was not installed
    assert cli.run(module.Args, module.main, words) == 2
    message = f"error: This command needs the package {package}: pip install 'stubborn-objectnav[train]'.\n"
    assert capsys.readouterr().err == message


@pytest.mark.costly
def test_the_options_of_each_command_are_known_without_the_packages() -> None:
    packages = {package for _, needed in NEEDS.values() for package in needed}
    program = f"import importlib, sys; sys.modules.update(dict.fromkeys({packages!r}))\n" + "".join(
        f"importlib.import_module({COMMANDS[f'train {name}'].module!r}).Args\n" for name in NEEDS
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
