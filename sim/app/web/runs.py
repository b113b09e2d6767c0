"""Lists the finished runs in a folder, and finds their reports, pictures and videos.

Files are found by the names in the results, never by a path in a request. Links that lead out of the folder of the runs
are refused, and only plain files count.
"""

from __future__ import annotations

import fcntl
import os
import shutil
import tempfile
import zipfile
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from sim.app.analysis.comparison import Run, compare, differences_table
from sim.app.analysis.tables import Cell, ResultTable
from sim.app.evaluation.last_view import picture_file
from sim.app.evaluation.results import read_record, read_results, segmentation_of
from sim.app.viewers.video import video_file
from sim.core import invocation
from sim.core.errors import ConfigError
from sim.core.files import open_to_grow
from sim.core.reading import printable, reason_of
from sim.task.result import EpisodeResult

MAX_RUNS = 100
"""Largest number of runs that are listed, the newest ones."""
REPORT = "report.html"
_PART_BYTES = 1 << 18
_FILES: Mapping[str, Callable[[Path, str], Path]] = {"pictures": picture_file, "videos": video_file}
"""Functions that return the path of an episode's file to which a report links, by the file's folder."""
_COLUMNS = (
    "episode_id", "house", "goal", "agent", "success", "spl", "num_steps", "collisions", "failure", "end_reason",
)  # fmt: skip


class _Read(NamedTuple):
    """A run that was read, and the times and sizes of its files at that time."""

    state: tuple[tuple[int, int], ...]
    run: Run


class Runs:
    """The finished runs in one folder. A run is named by its folder, with escapes for bytes that are not UTF-8."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._read: dict[Path, _Read] = {}

    def as_json(self) -> list[dict[str, object]]:
        """Returns the runs, the newest first; a run whose files are broken is listed with the reason."""
        newest = sorted(self._found(), reverse=True)[:MAX_RUNS]
        return [self._about(changed_ns, folder) for changed_ns, folder in newest]

    def episodes(self, name: str) -> list[dict[str, object]]:
        """Returns the result lines of a run, and whether each has a video.

        Raises:
            ConfigError: there is no such run, or it cannot be read.
        """
        run = self.run(name)
        return [
            {**{key: getattr(result, key) for key in _COLUMNS}, "video": self._there(video_file(run.path, episode_id))}
            for episode_id, result in run.results.items()
        ]

    def run(self, name: str) -> Run:
        """Returns a run.

        Raises:
            ConfigError: there is no such run, or its files cannot be read.
        """
        return self._content(self._folder_of(name))

    def result(self, name: str, episode_id: str) -> tuple[Run, EpisodeResult]:
        """Returns a run and the result of one of its episodes.

        Raises:
            ConfigError: there is no such run or episode.
        """
        run = self.run(name)
        if episode_id not in run.results:
            raise ConfigError(f"Run '{name}' has no episode '{episode_id}'.")
        return run, run.results[episode_id]

    def video(self, name: str, episode_id: str) -> Path:
        """Returns the file of the video of an episode.

        Raises:
            ConfigError: it does not exist.
        """
        run = self.run(name)
        if episode_id in run.results:
            file = video_file(run.path, episode_id)
            if self._there(file):
                return file
        raise ConfigError(f"Run '{name}' has no video of '{episode_id}'.")

    def linked(self, name: str, kind: str, file_name: str) -> Path:
        """Returns the file of a picture or a video to which the report of a run links.

        Args:
            name: name of the run.
            kind: the folder of the file, `pictures` or `videos`.
            file_name: name of the file in that folder.

        Raises:
            ConfigError: no episode of the run has such a file.
        """
        run = self.run(name)
        for episode_id in run.results if kind in _FILES else ():
            file = _FILES[kind](run.path, episode_id)
            if file.name == file_name and self._there(file):
                return file
        raise ConfigError(f"Run '{name}' has no file '{file_name}' in '{kind}'.")

    def packed(self, name: str) -> Iterator[bytes]:
        """Returns the parts of a ZIP file of a run's folder; links are left out.

        Raises:
            ConfigError: there is no such run, or a file cannot be read.
        """
        folder = self._folder_of(name)
        packed = tempfile.TemporaryFile()  # noqa: SIM115 - closed when the response drops it
        try:
            # Its large files are compressed already.
            with zipfile.ZipFile(packed, "w", zipfile.ZIP_STORED, strict_timestamps=False) as archive:
                for file in sorted(folder.rglob("*")):
                    if not file.name.startswith(".") and not file.is_symlink() and self._there(file):
                        archive.write(file, printable(f"{folder.name}/{file.relative_to(folder)}"))
        except (OSError, ValueError) as error:
            packed.close()
            raise ConfigError(f"Run '{name}' cannot be packed: {reason_of(error)}.") from None
        packed.seek(0)
        return iter(lambda: packed.read(_PART_BYTES), b"")

    def delete(self, name: str) -> None:
        """Deletes the folder of a run.

        Raises:
            ConfigError: there is no such run, it is being written, or it cannot be deleted.
        """
        folder = self._folder_of(name)
        try:
            with open_to_grow(folder / ".lock") as lock:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
                shutil.rmtree(folder)
        except BlockingIOError:
            raise ConfigError(f"Run '{name}' is being written; it can be deleted when it has ended.") from None
        except OSError as error:
            raise ConfigError(f"Run '{name}' cannot be deleted: {reason_of(error)}.") from None
        self._read.pop(folder, None)

    def report(self, name: str) -> Path:
        """Returns the file of the report of a run.

        Raises:
            ConfigError: it does not exist.
        """
        file = self._folder_of(name) / REPORT
        if not self._there(file):
            raise ConfigError(f"Run '{name}' has no report; {invocation.command('report', file.parent)} makes it.")
        return file

    def comparison(self, first: str, second: str) -> list[dict[str, object]]:
        """Returns the paired differences of two runs, and the fields in which their configurations differ, as tables.

        Tables and messages name the runs as the page does, without the folder of the runs.

        Raises:
            ConfigError: there are no such runs, or they share no episode.
        """
        a, b = (replace(self.run(name), path=Path(name)) for name in (first, second))
        return [_table_as_json(table) for table in (compare(a, b), differences_table(a, b))]

    def _found(self) -> Iterator[tuple[int, Path]]:
        """Yields the folders that hold results, with the time of the last line, nanoseconds since 1970."""
        try:
            entries = list(os.scandir(self._folder))
        except OSError:  # there are no runs yet
            return
        for entry in entries:
            file = Path(entry.path) / "results.jsonl"
            try:
                is_report = (Path(entry.path) / "traps.csv").exists()  # of traps: with results, but no run
                if entry.is_dir(follow_symlinks=False) and not is_report and self._there(file):
                    yield file.stat().st_mtime_ns, Path(entry.path)
            except OSError:  # it has just been removed
                continue

    def _folder_of(self, name: str) -> Path:
        for _, folder in self._found():
            if printable(folder.name) == name:
                return folder
        raise ConfigError(f"There is no run '{name}'.")

    def _about(self, changed_ns: int, folder: Path) -> dict[str, object]:
        about: dict[str, object] = {"name": printable(folder.name), "changed_s": changed_ns / 1e9}
        try:
            run = self._content(folder)
        except ConfigError as error:
            return about | {"broken": printable(str(error))}
        lines, record = run.results.values(), run.config
        return about | {
            "agent": record.get("agent"),
            "segmentation": segmentation_of(record),
            "explorer": record.get("explorer"),
            "split": (record.get("split_identity") or {}).get("name"),
            "episodes": len(lines),
            "found": sum(result.success == 1.0 for result in lines),
            "errors": sum(result.is_error for result in lines),
            "spl": sum(result.spl for result in lines) / max(1, len(lines)),
            "report": self._there(folder / REPORT),
        }

    def _content(self, folder: Path) -> Run:
        """Returns the run in a folder; it is read again only when its files have changed."""
        config, results = folder / "config.json", folder / "results.jsonl"
        for file in (config, results):
            if not self._there(file):
                raise ConfigError(f"'{folder.name}' has no plain file {file.name} in the folder of the runs.")
        try:
            state = tuple((file.stat().st_mtime_ns, file.stat().st_size) for file in (config, results))
        except OSError as error:
            raise ConfigError(f"'{folder.name}' cannot be read: {error.strerror}.") from None
        known = self._read.get(folder)
        if known is not None and known.state == state:
            return known.run
        run = Run(folder, read_record(config), {result.episode_id: result for result in read_results(results).values})
        self._read[folder] = _Read(state, run)
        while len(self._read) > MAX_RUNS:
            self._read.pop(next(iter(self._read)), None)
        return run

    def _there(self, file: Path) -> bool:
        """Returns whether a plain file exists and no link leads out of the folder of the runs."""
        try:
            return file.is_file() and file.resolve().is_relative_to(self._folder.resolve())
        except (OSError, ValueError, RuntimeError):  # a name that is too long, a loop of links
            return False


def _table_as_json(table: ResultTable) -> dict[str, object]:
    """Returns a table as JSON types; a cell is its text and its verdict."""
    rows = [
        [label, *({"text": cell.text(), "verdict": cell.verdict} if isinstance(cell, Cell) else cell for cell in cells)]
        for label, cells in table.rows
    ]
    return {"title": table.title, "header": list(table.header), "rows": rows, "notes": list(table.footnotes)}
