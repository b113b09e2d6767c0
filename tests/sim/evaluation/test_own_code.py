"""A message about an error in a user's code names the innermost line of that code; a hash tells two versions apart."""

from __future__ import annotations

import importlib
import importlib.util
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from sim.errors import AgentError
from sim.evaluation.own_code import hash_of_own
from sim.evaluation.rollout import ask
from sim.interface import Scores
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
    """A module `mine/bad.py` below the current folder."""
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


def test_the_hash_is_of_the_agent_and_of_the_imported_modules_beside_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(tmp_path)
    agent, helper, unrelated = (tmp_path / f"hashed_{name}.py" for name in ("agent", "helper", "unrelated"))
    agent.write_text("import hashed_helper\n")
    helper.write_text("GAIN = 1\n")
    importlib.import_module("hashed_agent")
    before = hash_of_own(["hashed_agent"])
    unrelated.write_text("GAIN = 1\n")
    assert hash_of_own(["hashed_agent"]) == before
    helper.write_text("GAIN = 2\n")
    edited = hash_of_own(["hashed_agent"])
    assert edited != before
    agent.write_text("import hashed_helper  # edited\n")
    assert hash_of_own(["hashed_agent"]) not in (before, edited)


def test_modules_of_this_project_and_of_libraries_are_not_the_users() -> None:
    importlib.import_module("stubborn.agents")
    assert hash_of_own(["stubborn.agents", "json", "sys"]) == ""
