"""Writes one MP4 per episode: `stubborn run --video` writes `<out>/videos/<episode_id>.mp4`.

The codec is H.264, which browsers, desktop players and slides show, encoded by x264 through PyAV; a PyAV whose FFmpeg
lacks x264 writes VP9. PyAV's wheel (36 MB) bundles an FFmpeg with x264 and x265, which are GPL; nothing of it is
distributed here. The FFmpeg inside OpenCV would add nothing, but it takes no options for its encoder: VP9 at libvpx's
default speed took 580 ms of processor time for a frame that x264 encodes in 25 ms.
"""

from __future__ import annotations

import contextlib
import queue
import threading
from collections.abc import Iterator, Mapping
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
from numpy.typing import NDArray

from sim.app.viewers import overlay
from sim.app.viewers.chase import ChaseView
from sim.app.viewers.topview import TopView
from sim.app.viewers.viewer import MapPainter, Moment, SeesFrames
from sim.core.errors import ConfigError
from sim.core.files import episode_file, part_file
from sim.core.reading import reason_of
from sim.env.objectnav import ObjectNavEnv
from sim.env.scene import Scene
from sim.task.explanations import explain_end
from sim.task.result import RolloutResult

FOLDER = "videos"
FRAMES_PER_S = 5.0
"""An action takes 0.2 s, so that 500 of them are 100 s."""
END_FRAMES = 12
"""Number of frames that hold the last moment, with an explanation of the outcome: 2.4 s."""
CODECS = {
    "libx264": {"preset": "superfast", "crf": "23"},
    "libvpx-vp9": {"deadline": "realtime", "cpu-used": "8", "crf": "32", "b": "0"},
}
"""Encoders with their options; the first that PyAV has is used."""
_WAITING_FRAMES = 8
"""Largest number of frames that wait for the encoder: 22 MB."""


def video_file(run: Path, episode_id: str) -> Path:
    """Returns the video file of an episode."""
    return episode_file(run / FOLDER, episode_id, ".mp4")


class VideoWriter:
    """A writer of one video file, which exists only when it is complete; it encodes in a thread of its own."""

    def __init__(
        self,
        file: Path,
        *,
        size_px: tuple[int, int],
        frames_per_s: float = FRAMES_PER_S,
        keyframe_every: int | None = None,
    ) -> None:
        """Creates a file.

        Args:
            file: ends with `.mp4`; its folder is created.
            size_px: width and height, even numbers.
            frames_per_s: playback speed.
            keyframe_every: largest number of frames from one that is decoded alone to the next; None: the encoder's.

        Raises:
            ConfigError: the folder is not writable, or this PyAV has none of the codecs.
        """
        codec = next((name for name in CODECS if name in av.codecs_available), None)
        if codec is None:
            raise ConfigError(
                f"--video: this build of PyAV has no encoder {' or '.join(CODECS)}; the wheel of `av` has."
            )
        self.file = file
        self._part = part_file(file, what="video")
        self._size_px, self._frames_per_s, self.codec = size_px, frames_per_s, codec
        self._options = CODECS[codec] | ({} if keyframe_every is None else {"g": str(keyframe_every)})
        self._frames: queue.Queue[NDArray[np.uint8] | None] = queue.Queue(maxsize=_WAITING_FRAMES)
        self._failure: Exception | None = None
        self._thread = threading.Thread(target=self._encode, daemon=True, name="video")
        self._thread.start()

    def write(self, frame: NDArray[np.uint8]) -> None:
        """Adds a frame, uint8 RGB (height, width, 3); it must not be changed afterwards."""
        self._frames.put(frame)

    def finish(self) -> None:
        """Waits until all frames are encoded, and gives the file its name.

        Raises:
            ConfigError: a frame could not be written, for example because the disk is full; the file is removed.
        """
        self._stop()
        if self._failure is not None:
            self._part.unlink(missing_ok=True)
            raise ConfigError(
                f"Cannot write the video '{self.file}': {reason_of(self._failure)}. "
                "The same command films this episode again."
            ) from self._failure
        self._part.replace(self.file)

    def discard(self) -> None:
        """Ends without a file."""
        self._stop()
        with contextlib.suppress(OSError):
            self._part.unlink()

    def _stop(self) -> None:
        self._frames.put(None)
        self._thread.join()

    def _encode(self) -> None:
        frames = self._until_the_end()
        try:
            self._encode_all(frames)
        except Exception as error:  # errors of FFmpeg have many classes, and `finish` has to learn of each
            self._failure = error
            for _ in frames:  # the caller must not wait for room in the queue
                pass

    def _until_the_end(self) -> Iterator[NDArray[np.uint8]]:
        while (frame := self._frames.get()) is not None:
            yield frame

    def _encode_all(self, frames: Iterator[NDArray[np.uint8]]) -> None:
        width, height = self._size_px
        rate = Fraction(self._frames_per_s).limit_denominator(1000)
        with av.open(str(self._part), "w", format="mp4", options={"movflags": "+faststart"}) as container:
            stream = container.add_stream(self.codec, rate=rate, options=self._options)
            assert isinstance(stream, av.VideoStream)
            stream.width, stream.height, stream.pix_fmt = width, height, "yuv420p"
            stream.codec_context.thread_count = 1
            for frame in frames:
                container.mux(stream.encode(av.VideoFrame.from_ndarray(frame, format="rgb24")))
            container.mux(stream.encode(None))


class VideoRecorder:
    """A viewer that records a video of each episode (`sim.app.viewers.viewer.Viewer`)."""

    def __init__(self, run: Path, painter: MapPainter | None = None, seen: SeesFrames | None = None) -> None:
        """Records episodes of a run.

        Args:
            run: folder of the run; files go to `videos/` in it.
            painter: draws the agent's map; None: it has none.
            seen: provides the segmentation that the agent acts on; None: it has none.
        """
        self._run, self._painter, self._seen = run, painter, seen
        self._writer: VideoWriter | None = None
        self._chase: ChaseView | None = None
        self._scene: Scene | None = None
        self._frame: NDArray[np.uint8] | None = None

    def begin(self, env: ObjectNavEnv) -> None:
        """Starts the episode's file."""
        self._discard()
        if env.scene is not self._scene:
            self._free_chase()
            width, height = overlay.CHASE_PX
            self._scene, self._chase = env.scene, ChaseView(env.scene, width_px=width, height_px=height, finer=2)
        self._env, self._frame, self._plan = env, None, TopView(env, heading_up=self._painter is not None)
        self._composer = self._composer_for(env.scene.task.goal)
        file = video_file(self._run, env.episode.episode_id)
        self._writer = VideoWriter(file, size_px=(overlay.WIDTH_PX, overlay.HEIGHT_PX))

    def _composer_for(self, goal: str) -> overlay.FrameComposer:
        env, task = self._env, self._env.scene.task
        return overlay.FrameComposer(
            goal,
            env.camera_model,
            plan_legend=self._plan.legend,
            map_legend=None if self._painter is None else self._painter.legend,
            scores=self._seen is not None,
            names=self._seen is not None and self._seen.names,
            max_steps=env.task_config.max_steps,
            segmentation=self._seen.name if self._seen is not None else "",
            picture=env.scene.picture_of(task.goals[task.goal_number]),
        )

    def decided(self, moment: Moment) -> None:
        """Draws the frame now, while the agent's map and the world are those of its decision."""
        assert self._chase is not None
        task = self._env.scene.task
        goal = task.goal
        if goal != self._composer.goal:
            self._composer = self._composer_for(goal)
        if task.is_chain:
            moment = replace(moment, step=task.goal_metrics().num_steps + 1)
        self._frame = self._composer.compose(
            moment,
            plan=self._plan.draw(*self._composer.plan_px),
            map_panel=self._agent_map(),
            chase=self._chase.render(),
            perceived=self._seen.perceived(moment.observation, goal) if self._seen is not None else None,
            goal_mask=task.goal_mask(moment.images),
            goals=overlay.goal_marks(task),
        )

    def moved(self, info: Mapping[str, object]) -> None:
        """Adds the outcome of the action and writes the frame."""
        assert self._frame is not None
        assert self._writer is not None
        self._composer.add_outcome(self._frame, info)
        self._writer.write(self._frame)

    def end(self, result: RolloutResult) -> None:
        """Holds the last frame with an explanation of the outcome, and closes the file."""
        writer, self._writer = self._writer, None
        assert writer is not None
        if self._frame is None:
            writer.discard()
            return
        last = self._frame.copy()
        overlay.tick_off(last, overlay.goal_marks(self._env.scene.task), opaque=True)
        nearest_m = self._env.scene.task.trajectory().nearest_instance_m
        rule, detects = self._env.success_rule, self._seen is not None
        self._composer.add_end(last, explain_end(result, self._env.episode.goal, rule, nearest_m, detects=detects))
        for _ in range(END_FRAMES):
            writer.write(last)
        self._frame = None
        writer.finish()

    def close(self) -> None:
        """Discards the video of an unfinished episode, and frees the renderer."""
        self._discard()
        self._free_chase()

    def _agent_map(self) -> overlay.MapPanel | None:
        """Returns the agent's map; None if it has none."""
        painter = self._painter
        if painter is None:
            return None
        image = painter.paint(overlay.MAP_PX)
        return overlay.MapPanel(image=image, words=painter.words())

    def _discard(self) -> None:
        if self._writer is not None:
            self._writer.discard()
            self._writer = None

    def _free_chase(self) -> None:
        if self._chase is not None:
            self._chase.close()
        self._chase = self._scene = None
