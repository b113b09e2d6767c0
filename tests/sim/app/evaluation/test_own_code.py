"""A message about an error in a user's code names its innermost line; a hash distinguishes two versions."""

from __future__ import annotations

import importlib
import importlib.util
import sys
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from sim.app.evaluation.own_code import hash_of_own
from sim.app.evaluation.rollout import ask
from sim.core.errors import AgentError
from sim.core.interface import Scores
from stubborn.segmentation.ground_truth import GroundTruthSegmenter

AGENT = """import json

from stubborn.segmentation.ground_truth import GroundTruthSegmenter


def read(observation):
    return observation["rgbx"]


def act(observation):
    return read(observation)


def in_a_library():
    return json.loads("{")


def in_this_project():
    return GroundTruthSegmenter().scores({}, "bed")
"""


@pytest.fixture
def mine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """Writes a module `mine/bad.py` below the current folder and returns it."""
    file = tmp_path / "mine" / "bad.py"
    file.parent.mkdir()
    file.write_text(AGENT)
    monkeypatch.chdir(tmp_path)
    spec = importlib.util.spec_from_file_location("bad", file)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def message_of(call: Any) -> str:
    with pytest.raises(AgentError) as raised:
        ask("Agent 'x:mine', step 1", call)
    return str(raised.value)


def test_the_innermost_line_of_the_users_code_is_named(mine: Any) -> None:
    assert message_of(lambda: mine.act({})) == "Agent 'x:mine', step 1: KeyError: 'rgbx' (mine/bad.py, line 7)"


def test_a_call_into_a_library_or_this_project_is_named_and_not_a_line_inside(mine: Any) -> None:
    assert message_of(mine.in_a_library).endswith("(mine/bad.py, line 15)")
    assert message_of(mine.in_this_project).endswith("(mine/bad.py, line 19)")


def test_an_agent_of_this_project_is_named_by_its_own_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)  # elsewhere: the last two names of the path

    def scores() -> Scores:
        return GroundTruthSegmenter().scores({}, "bed")

    assert "(evaluation/test_own_code.py, line" in message_of(scores)
    assert "(segmentation/ground_truth.py, line" in message_of(partial(GroundTruthSegmenter().scores, {}, "bed"))


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Writes a package with an agent and modules that it imports at the start, imports later, and does not import."""
    folder = tmp_path / "hashed"
    folder.mkdir()
    for name, text in {
        "__init__": "",
        "agent": "from . import helper\n\n\ndef make():\n    import hashed.late\n",
        "helper": "from hashed.deeper import GAIN\n",
        "deeper": "GAIN = 1\n",
        "late": "from sim.core.interface import Action\n",
        "unrelated": "",
    }.items():
        (folder / f"{name}.py").write_text(text)
    monkeypatch.syspath_prepend(tmp_path)
    importlib.import_module("hashed.agent")
    yield folder
    for name in [name for name in sys.modules if name.partition(".")[0] == "hashed"]:
        del sys.modules[name]


@pytest.mark.parametrize("name", ["agent", "helper", "deeper", "late", "__init__"])
def test_an_edit_of_a_module_that_an_agent_imports_changes_its_hash(package: Path, name: str) -> None:
    before = hash_of_own(["hashed.agent"])
    with (package / f"{name}.py").open("a") as file:
        file.write("# edited\n")
    assert hash_of_own(["hashed.agent"]) != before


def test_modules_that_an_agent_does_not_import_do_not_change_its_hash(package: Path) -> None:
    before = hash_of_own(["hashed.agent"])
    (package / "unrelated.py").write_text("GAIN = 3\n")
    importlib.import_module("hashed.unrelated")
    importlib.import_module("hashed.late")
    assert hash_of_own(["hashed.agent"]) == before


def test_modules_of_this_project_and_of_libraries_are_not_the_users() -> None:
    importlib.import_module("stubborn.agents")
    assert hash_of_own(["stubborn.agents", "json", "sys"]) == ""
