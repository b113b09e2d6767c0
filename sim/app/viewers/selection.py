"""Builds the viewers that the options `--video`, `--view`, `--rerun`, `--rerun-save` and `--mcap` select."""

from __future__ import annotations

from sim.app.options import RunOptions
from sim.app.viewers.viewer import MapPainter, SeesFrames, Viewer
from sim.core.errors import ConfigError


def check(options: RunOptions) -> None:
    """Raises ConfigError if a selected viewer cannot run here."""
    for name, selected in (("--view", options.view), ("--rerun", options.rerun)):
        if selected and options.workers > 1:
            raise ConfigError(f"{name} shows one episode at a time: it needs --workers 1, got {options.workers}.")
    if options.rerun and options.rerun_save:
        raise ConfigError("--rerun opens a viewer and --rerun-save writes files: give only one of them.")
    if options.view:
        from sim.app.viewers import live

        live.require_display()
    if options.rerun or options.rerun_save:
        from sim.app.viewers import rerun_log

        rerun_log.require_rerun(window=options.rerun)
    if options.mcap:
        from sim.app.viewers import mcap_log

        mcap_log.require_mcap()


def make(options: RunOptions, painter: MapPainter | None, seen: SeesFrames | None = None) -> list[Viewer]:
    """Returns the selected viewers.

    Args:
        options: of the run.
        painter: draws the agent's map; None if it has none.
        seen: provides the segmentation that the agent acts on; None if it has none.
    """
    viewers: list[Viewer] = []
    if options.video and options.out is not None:
        from sim.app.viewers.video import VideoRecorder

        viewers.append(VideoRecorder(options.out, painter, seen))
    if options.view:
        from sim.app.viewers.live import LiveView

        viewers.append(LiveView())
    if options.rerun or options.rerun_save:
        from sim.app.viewers.rerun_log import RerunLog

        viewers.append(RerunLog(options.out if options.rerun_save else None, painter))
    if options.mcap and options.out is not None:
        from sim.app.viewers.mcap_log import McapLog

        viewers.append(McapLog(options.out))
    return viewers
