"""An MP4 an episode: `python -m sim.run --video` writes `<out>/videos/<episode_id>.mp4`.

The codec is VP9 in an MP4 container, written by the FFmpeg inside `opencv-python-headless`, which the project needs
anyway. Why this one (wheels looked at for Linux x86-64, November 2026):

====================================  =============  ==============================================================
wheel                                 adds           what it bundles
====================================  =============  ==============================================================
opencv-python-headless 5.0.0          nothing        FFmpeg "LGPL version 2.1 or later" and libvpx (BSD): VP9
av 18.1 (PyAV)                        36 MB          FFmpeg with the libraries of x264 and x265, which are GPL
imageio-ffmpeg 0.8.1                  68 MB          an FFmpeg program configured with `--enable-gpl`
====================================  =============  ==============================================================

VP9 has no patent pool to pay, and Chrome, Firefox, Edge and Safari (14 and newer) play it in an MP4. Its price is time:
OpenCV passes no options to the encoder, so it runs at libvpx's default speed, in a thread beside the agent.
"""

from __future__ import annotations

import contextlib
import queue
import threading
import urllib.parse
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.env.objectnav import ObjectNavEnv
from sim.errors import ConfigError
from sim.files import part_file
from sim.viewers import overlay
from sim.viewers.topview import TopView
from sim.viewers.viewer import MapPainter, Moment

FOLDER = "videos"
FRAMES_PER_S = 5.0
"""An action takes 0.2 s, so that 500 of them are 100 s."""
END_FRAMES = 5
"""How long the outcome stays."""
_WAITING_FRAMES = 8
"""Frames that may wait for the encoder: 22 MB."""


def video_file(run: Path, episode_id: str) -> Path:
    """Where a run keeps the video of an episode; what no file name may hold is written as %xx."""
    return run / FOLDER / f"{urllib.parse.quote(episode_id, safe=' ')}.mp4"


class VideoWriter:
    """Writes one file, whole or not at all; encodes in a thread of its own."""

    def __init__(self, file: Path, *, size_px: tuple[int, int], frames_per_s: float = FRAMES_PER_S) -> None:
        """Begin a file.

        Args:
            file: ends with `.mp4`; its folder is made.
            size_px: width and height, even numbers.
            frames_per_s: how fast it plays.

        Raises:
            ConfigError: nothing can be written there, or this OpenCV has no VP9.
        """
        self.file = file
        self._part = part_file(file, what="video")
        fourcc = cv2.VideoWriter.fourcc(*"vp09")
        self._encoder = cv2.VideoWriter(str(self._part), cv2.CAP_FFMPEG, fourcc, frames_per_s, size_px)
        if not self._encoder.isOpened():
            self._part.unlink()
            raise ConfigError(
                "--video: this build of OpenCV cannot write VP9; the wheels of opencv-python-headless can."
            )
        self._frames: queue.Queue[NDArray[np.uint8] | None] = queue.Queue(maxsize=_WAITING_FRAMES)
        self._thread = threading.Thread(target=self._encode, daemon=True, name="video")
        self._thread.start()

    def write(self, frame: NDArray[np.uint8]) -> None:
        """One frame, uint8 RGB (height, width, 3); must not be changed afterwards."""
        self._frames.put(frame)

    def finish(self) -> None:
        """Wait until all is encoded, and give the file its name."""
        self._stop()
        self._part.replace(self.file)

    def drop(self) -> None:
        """End without a file."""
        self._stop()
        with contextlib.suppress(OSError):
            self._part.unlink()

    def _stop(self) -> None:
        self._frames.put(None)
        self._thread.join()
        self._encoder.release()

    def _encode(self) -> None:
        while (frame := self._frames.get()) is not None:
            self._encoder.write(cv2.cvtColor(frame, cv2.COLOR_RGB2BGR))


class VideoWatcher:
    """Films each episode (a `sim.viewers.viewer.Watcher`)."""

    def __init__(self, run: Path, painter: MapPainter | None = None) -> None:
        """Film episodes of a run.

        Args:
            run: folder of the run; files go to `videos/` in it.
            painter: of the agent's map; without one the true floor plan is shown.
        """
        self._run, self._painter = run, painter
        self._writer: VideoWriter | None = None
        self._shown: NDArray[np.uint8] | None = None

    def begin(self, env: ObjectNavEnv) -> None:
        """Start the episode's file."""
        self.close()
        self._env, self._shown = env, None
        self._map: MapPainter = self._painter or TopView(env)
        file = video_file(self._run, env.episode.episode_id)
        self._writer = VideoWriter(file, size_px=(overlay.WIDTH_PX, overlay.HEIGHT_PX))

    def decided(self, moment: Moment) -> None:
        """Draw while the agent's map is that of its decision."""
        title = "the agent's map" if self._painter is not None else "floor plan (true)"
        panel = overlay.MapPanel(
            image=self._map.paint(overlay.MAP_PX), legend=self._map.legend, title=title, words=self._map.words()
        )
        self._moment = moment
        self._shown = overlay.compose(moment, self._env.episode.goal, self._env.camera_model, panel)

    def moved(self, info: Mapping[str, Any]) -> None:
        """Now the outcome of the action is known as well."""
        assert self._shown is not None
        assert self._writer is not None
        overlay.add_outcome(self._shown, self._moment, info)
        self._writer.write(self._shown)

    def end(self, line: Mapping[str, Any]) -> None:
        """Let the outcome stand for a while and close the file."""
        writer, self._writer = self._writer, None
        assert writer is not None
        if self._shown is None:
            writer.drop()
            return
        last = self._shown.copy()
        overlay.add_end(last, line)
        for _ in range(END_FRAMES):
            writer.write(last)
        self._shown = None
        writer.finish()

    def close(self) -> None:
        """Drop what was not ended."""
        if self._writer is not None:
            self._writer.drop()
            self._writer = None
