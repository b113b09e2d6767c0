"""From options to watchers: what `--video`, `--view`, `--rerun` and `--rerun-save` ask for."""

from __future__ import annotations

from pathlib import Path
from typing import Protocol

from sim.errors import ConfigError
from sim.viewers.video import VideoWatcher
from sim.viewers.viewer import MapPainter, Watcher


class WatchOptions(Protocol):
    """The options of a run that watchers go by."""

    @property
    def out(self) -> Path | None: ...  # noqa: D102
    @property
    def workers(self) -> int: ...  # noqa: D102
    @property
    def video(self) -> bool: ...  # noqa: D102
    @property
    def view(self) -> bool: ...  # noqa: D102
    @property
    def rerun(self) -> bool: ...  # noqa: D102
    @property
    def rerun_save(self) -> bool: ...  # noqa: D102


def any_asked(options: WatchOptions) -> bool:
    """Whether somebody looks on, so that all images must be rendered."""
    return options.video or options.view or options.rerun or options.rerun_save


def check(options: WatchOptions) -> None:
    """Raise ConfigError where what was asked for cannot be had here."""
    for name, asked in (("--view", options.view), ("--rerun", options.rerun)):
        if asked and options.workers > 1:
            raise ConfigError(f"{name} shows one episode at a time: it needs --workers 1, got {options.workers}.")
    if options.rerun and options.rerun_save:
        raise ConfigError("--rerun shows and --rerun-save writes files: give one of them.")
    if options.view:
        from sim.viewers import live

        live.require_display()
    if options.rerun or options.rerun_save:
        from sim.viewers import rerun_log

        rerun_log.require_rerun(window=options.rerun)


def make(options: WatchOptions, painter: MapPainter | None) -> list[Watcher]:
    """The watchers that were asked for; `painter` draws the agent's map, None where it has none.

    Raises:
        ConfigError: as `check`.
    """
    check(options)
    watchers: list[Watcher] = []
    if options.video and options.out is not None:
        watchers.append(VideoWatcher(options.out, painter))
    if options.view:
        from sim.viewers.live import LiveView

        watchers.append(LiveView())
    if options.rerun or options.rerun_save:
        from sim.viewers.rerun_log import RerunLog

        watchers.append(RerunLog(options.out if options.rerun_save else None, painter))
    return watchers
