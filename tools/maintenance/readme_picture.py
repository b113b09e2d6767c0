"""Makes the animated picture of the README from the video of an episode.

stubborn run --agent stubborn-plus --video --episodes 2 --out runs/filmed
python -m tools.maintenance.readme_picture runs/filmed/videos/<episode_id>.mp4 --out docs/images/episode.webp
"""

from __future__ import annotations

import io
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import av
import cv2
import numpy as np
import tyro
from numpy.typing import NDArray

from sim.app import cli
from sim.core.errors import ConfigError
from sim.core.files import write_atomically
from sim.core.reading import open_plain


@dataclass(frozen=True, kw_only=True)
class Args:
    """Turn a video into an animated WebP picture, which browsers and GitHub show in a page without a player."""

    video: tyro.conf.Positional[Path]
    """The MP4 file of an episode (`sim.run --video`)."""
    width_px: cli.Count = 800
    """Width of the picture."""
    frames: cli.Count = 80
    """Largest number of frames; a longer video is thinned out evenly, its last frame stays."""
    frames_per_s: cli.Count = 6
    """Playback speed."""
    quality: cli.Count = 60
    """Quality of the WebP, 1 to 100."""
    out: cli.OutFile = Path("docs/images/episode.webp")
    """The WebP file."""


def main(args: Args) -> int:
    """Writes the picture; returns the exit status."""
    frames = thinned(frames_of(args.video), args.frames)
    size_px = args.width_px, round(args.width_px * frames[0].shape[0] / frames[0].shape[1])
    small = [np.asarray(cv2.resize(frame, size_px, interpolation=cv2.INTER_AREA), np.uint8) for frame in frames]
    content = animation(small, frames_per_s=args.frames_per_s, quality=args.quality)
    write_atomically(args.out, content)
    print(f"{args.out}: {len(small)} frames of {size_px[0]} x {size_px[1]} pixels, {len(content) / 1e6:.2f} MB")
    return 0


def frames_of(file: Path) -> list[NDArray[np.uint8]]:
    """Returns the frames of a video, uint8 RGB (height, width, 3) each.

    Raises:
        ConfigError: the file does not exist or holds no video.
    """
    try:
        with open_plain(file, what="Video") as stream, av.open(stream, mode="r") as container:
            frames = [np.asarray(frame.to_ndarray(format="rgb24"), np.uint8) for frame in container.decode(video=0)]
    except (OSError, ValueError, IndexError) as error:  # each error of FFmpeg is one of the first two
        raise ConfigError(f"'{file}' cannot be read as a video: {error}.") from None
    if not frames:
        raise ConfigError(f"The video '{file}' has no frames.")
    return frames


def thinned(frames: Sequence[NDArray[np.uint8]], largest: int) -> list[NDArray[np.uint8]]:
    """Returns at most that many frames, evenly spaced; first and last stay."""
    if len(frames) <= largest:
        return list(frames)
    return [frames[i] for i in np.linspace(0, len(frames) - 1, largest).round().astype(int)]


def animation(frames: Sequence[NDArray[np.uint8]], *, frames_per_s: int, quality: int) -> bytes:
    """Returns an animated WebP that repeats without end; frames are uint8 RGB of one size."""
    content = io.BytesIO()
    with av.open(content, "w", format="webp", options={"loop": "0"}) as container:
        stream = container.add_stream("libwebp_anim", rate=frames_per_s, options={"quality": str(quality)})
        assert isinstance(stream, av.VideoStream)
        stream.height, stream.width = frames[0].shape[:2]
        stream.pix_fmt = "yuv420p"
        for frame in frames:
            container.mux(stream.encode(av.VideoFrame.from_ndarray(np.ascontiguousarray(frame), format="rgb24")))
        container.mux(stream.encode(None))
    return content.getvalue()


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
