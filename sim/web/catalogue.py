"""Lists what the page offers: houses, goals and agents to choose from, and finished runs to look at."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

from sim import invocation
from sim.composition.agents import SPECS
from sim.composition.segmenters import KINDS
from sim.episodes.splits import load_split, shipped_splits
from sim.errors import ConfigError
from sim.evaluation.last_view import picture_file
from sim.evaluation.results import read_record, read_result_lines
from sim.viewers.video import video_file
from sim.web.controls import Wish

NOT_OFFERED = ("test",)
"""Splits for a last measurement."""
FIRST = ("val", "large", "hazards", "traps")
"""The splits that come first."""
MOST_RUNS = 100
"""The newest runs are listed."""
REPORT = "report.html"
_FILES: Mapping[str, Callable[[Path, str], Path]] = {"pictures": picture_file, "videos": video_file}
"""Files of an episode that a report links to, by their folder."""
_COLUMNS = (
    "episode_id", "house", "goal", "agent", "success", "spl", "num_steps", "collisions", "failure", "end_reason",
)  # fmt: skip


class Choices:
    """Houses with their goals, agents and segmentations; read once."""

    def __init__(self, segmentations: Mapping[str, str] = MappingProxyType({})) -> None:
        """Reads the splits.

        Args:
            segmentations: names and descriptions of those that can be chosen in addition to the shipped ones.
        """
        self._segmentations = {name: kind.description for name, kind in KINDS.items()} | dict(segmentations)
        names = [name for name in shipped_splits() if name not in NOT_OFFERED]
        names.sort(key=lambda name: (FIRST.index(name) if name in FIRST else len(FIRST), name))
        self._goals: dict[str, dict[str, list[str]]] = {}
        for name in names:
            goals: dict[str, list[str]] = {}
            for episode in load_split(name).episodes:
                of_house = goals.setdefault(episode.house, [])
                if episode.goal not in of_house:
                    of_house.append(episode.goal)
            self._goals[name] = {house: sorted(found) for house, found in sorted(goals.items())}

    def as_json(self) -> dict[str, Any]:
        """Returns everything that can be chosen."""
        return {
            "splits": self._goals,
            "agents": {name: spec.description for name, spec in SPECS.items()},
            "uses_segmentation": {name: spec.uses_segmentation for name, spec in SPECS.items()},
            "semantics": self._segmentations,
            "run_command": invocation.command("run", "--video"),
        }

    def wish(self, message: dict[str, Any]) -> Wish:
        """Returns the episode that a message of the page asks for.

        Raises:
            ConfigError: something in it cannot be chosen. Only what ships or was given to the server can be.
        """
        chosen = {name: message.get(name) for name in ("split", "house", "goal", "agent", "semantics")}
        for name, value in chosen.items():
            if not isinstance(value, str):
                raise ConfigError(f"The message names no {name}.")
        houses = self._goals.get(str(chosen["split"]), {})
        goals = houses.get(str(chosen["house"]), [])
        if chosen["goal"] not in goals:
            raise ConfigError(f"There is no '{chosen['goal']}' in house '{chosen['house']}' of '{chosen['split']}'.")
        if chosen["agent"] not in SPECS:
            raise ConfigError(f"There is no agent '{chosen['agent']}' here.")
        if chosen["semantics"] not in self._segmentations:
            raise ConfigError(f"There is no segmentation '{chosen['semantics']}'.")
        driver = "person" if message.get("driver") == "person" else "agent"
        return Wish(**{name: str(value) for name, value in chosen.items()}, driver=driver)


class Runs:
    """The finished runs in one folder. Files are found by the names in their results, never by a path from outside."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def as_json(self) -> list[dict[str, Any]]:
        """Returns the runs, the newest first; one whose files are broken is left out."""
        found = []
        for run in self._newest():
            with contextlib.suppress(ConfigError):
                found.append(self._about(run))
        return found

    def episodes(self, name: str) -> list[dict[str, Any]]:
        """Returns the result lines of a run, and whether each has a video.

        Raises:
            ConfigError: there is no such run.
        """
        run = self._run(name)
        lines = _lines(run)
        return [
            {key: line.get(key) for key in _COLUMNS} | {"video": self._inside(video_file(run, line["episode_id"]))}
            for line in lines
        ]

    def video(self, name: str, episode_id: str) -> Path:
        """Returns the video of an episode.

        Raises:
            ConfigError: it does not exist.
        """
        run = self._run(name)
        if any(line["episode_id"] == episode_id for line in _lines(run)):
            file = video_file(run, episode_id)
            if self._inside(file):
                return file
        raise ConfigError(f"Run '{name}' has no video of '{episode_id}'.")

    def linked(self, name: str, kind: str, file_name: str) -> Path:
        """Returns a picture or a video to which the report of a run links.

        Args:
            name: of the run.
            kind: the folder in it, `pictures` or `videos`.
            file_name: in that folder.

        Raises:
            ConfigError: no episode of the run has such a file.
        """
        run = self._run(name)
        file_of = _FILES.get(kind)
        if file_of is not None:
            for line in _lines(run):
                file = file_of(run, line["episode_id"])
                if file.name == file_name and self._inside(file):
                    return file
        raise ConfigError(f"Run '{name}' has no file '{file_name}' in '{kind}'.")

    def report(self, name: str) -> Path:
        """Returns the report of a run.

        Raises:
            ConfigError: it does not exist.
        """
        file = self._run(name) / REPORT
        if not self._inside(file):
            raise ConfigError(f"Run '{name}' has no report; {invocation.command('report', file.parent)} makes it.")
        return file

    def _newest(self) -> list[Path]:
        found = list(self._found())
        found.sort(key=lambda run: (run / "results.jsonl").stat().st_mtime, reverse=True)
        return found[:MOST_RUNS]

    def _found(self) -> Iterator[Path]:
        if not self._folder.is_dir():
            return
        for entry in os.scandir(self._folder):
            run = Path(entry.path)
            if entry.is_dir(follow_symlinks=False) and self._inside(run / "results.jsonl"):
                yield run

    def _run(self, name: str) -> Path:
        for run in self._found():
            if run.name == name:
                return run
        raise ConfigError(f"There is no run '{name}'.")

    def _about(self, run: Path) -> dict[str, Any]:
        lines = _lines(run)
        record = read_record(run / "config.json")
        return {
            "name": run.name,
            "agent": record.get("agent"),
            "semantics": record.get("semantics"),
            "split": (record.get("split_identity") or {}).get("name"),
            "episodes": len(lines),
            "found": sum(bool(line.get("success")) for line in lines),
            "errors": sum(line.get("end_reason") == "error" for line in lines),
            "spl": sum(float(line.get("spl") or 0.0) for line in lines) / max(1, len(lines)),
            "report": self._inside(run / REPORT),
        }

    def _inside(self, file: Path) -> bool:
        """Returns whether a file exists and no link leads out of the folder of the runs."""
        return file.is_file() and file.resolve().is_relative_to(self._folder.resolve())


def _lines(run: Path) -> list[dict[str, Any]]:
    """Returns the result lines of a run.

    Raises:
        ConfigError: the file has other content.
    """
    return read_result_lines(run / "results.jsonl").values
