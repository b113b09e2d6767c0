"""A tiny split, recorded runs in it, and submissions that a test edits like a forger."""

from __future__ import annotations

import gzip
import json
import shlex
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from sim.app.commands import verify
from sim.app.commands.run import entry
from sim.app.submissions.audit import AuditOptions, Checked, check, verdicts
from sim.app.submissions.verdicts import Verdict
from sim.core.geometry.pose import Pose
from sim.episodes.episode import Episode
from sim.episodes.splits import write_split
from tests.helpers.worlds import sofa_room

Edit = Callable[[dict[str, Any]], None]
"""Changes the JSON of a submission."""
CLIENT_AGENT = Path(__file__).with_name("client_agent.py")
RUNS = {"oracle": ("oracle", "none"), "random": ("random", "harsh"), "process": ("process", "realsense")}
"""Agent and noise of each recorded run."""
SMALL = ("camera.width_px=96", "camera.height_px=72", "task.max_steps=25")
STARTS = (Pose(-1.0, 0.0, 0.3), Pose(-2.4, 2.4, 2.2), Pose(0.5, -2.3, -1.4))


def tiny_split(folder: Path) -> Path:
    """Writes a split of one room with a sofa and three episodes, and returns its folder."""
    split = folder / "tiny"
    split.mkdir(parents=True)
    (split / "sofa_room.xml").write_text(sofa_room().spec.to_xml())
    episodes = [Episode(f"tiny_{i:04d}", "sofa_room", "sofa", start) for i, start in enumerate(STARTS)]
    write_split(split, episodes, {"sofa_room": {"sofa": []}}, version="1")
    return split


def recorded(split: Path, out: Path, agent: str, *options: str, episodes: int = 3) -> Path:
    """Runs an agent on the first episodes of a split with small images, records it, and returns its folder.

    Options are fields of the configuration, and after them others.
    """
    name = "process:" + shlex.join([sys.executable, str(CLIENT_AGENT)]) if agent == "process" else agent
    fixed = ("--split", str(split), "--agent", name, "--semantics", "gt", "--episodes", str(episodes))
    assert entry([*fixed, "--out", str(out), "--record", "--config", *SMALL, *options]) == 0
    return out


def content_of(file: Path) -> dict[str, Any]:
    """Returns the JSON in a submission."""
    return json.loads(gzip.decompress(file.read_bytes()))


def written(file: Path, content: Any) -> Path:
    """Writes JSON as a submission and returns its file."""
    file.write_bytes(gzip.compress(json.dumps(content).encode(), 1))
    return file


def checked(folder: Path, file: Path, **changes: Any) -> tuple[Checked, AuditOptions]:
    options = replace(AuditOptions(split=folder / "tiny", draw_seed=1, frames=0.0, nonstandard=True), **changes)
    return check(file, options, verify.truth_of_agents()), options


def judged(folder: Path, file: Path, **changes: Any) -> list[Verdict]:
    return [verdict for verdict, _ in verdicts(*checked(folder, file, **changes))]


def in_manifest(**changes: Any) -> Edit:
    return lambda content: content["manifest"].update(changes)


def in_inputs(**changes: Any) -> Edit:
    return lambda content: content["manifest"]["inputs"].update(changes)


def in_first_result(**changes: Any) -> Edit:
    return lambda content: content["episodes"][0]["result"].update(changes)


def in_all_results(**changes: Any) -> Edit:
    def edit(content: dict[str, Any]) -> None:
        for episode in content["episodes"]:
            episode["result"].update(changes)

    return edit


def in_tree(part: str, **changes: Any) -> Edit:
    def edit(content: dict[str, Any]) -> None:
        node = content["config"]["config"]
        for name in part.split(".") if part else ():
            node = node[name]
        node.update(changes)

    return edit


def in_config(**changes: Any) -> Edit:
    return lambda content: content["config"].update(changes)


def in_actions(change: Callable[[str], str], *, counted: bool = False) -> Edit:
    def edit(content: dict[str, Any]) -> None:
        episode = content["episodes"][0]
        episode["actions"] = change(episode["actions"])
        if counted:
            episode["result"]["num_steps"] = len(episode["actions"])

    return edit


def together(*edits: Edit) -> Edit:
    def edit(content: dict[str, Any]) -> None:
        for edit in edits:
            edit(content)

    return edit


def in_split(**changes: Any) -> Edit:
    return lambda content: content["manifest"]["split"].update(changes)
