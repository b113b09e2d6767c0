"""The tools for maintainers start as modules and document their commands."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

from tests.helpers.sampling import sample

ROOT = Path(__file__).resolve().parents[2]
TOOLS = {
    ".".join(file.relative_to(ROOT).with_suffix("").parts): ast.parse(file.read_text(encoding="utf-8"))
    for file in sorted((ROOT / "tools").glob("*/*.py"))
    if "cli.run(" in file.read_text(encoding="utf-8")
}


@pytest.mark.costly
@pytest.mark.parametrize("name", sample(sorted(TOOLS), 3))
def test_a_tool_starts_as_a_module(name: str) -> None:
    ended = subprocess.run(
        [sys.executable, "-m", name, "--help"], cwd=ROOT, capture_output=True, text=True, check=False, timeout=120
    )
    assert ended.returncode == 0, ended.stderr
    assert f"-m {name} [-h]" in ended.stdout


@pytest.mark.parametrize("name", TOOLS)
def test_a_tool_says_how_it_is_called(name: str) -> None:
    assert f"python -m {name}" in (ast.get_docstring(TOOLS[name]) or "")
