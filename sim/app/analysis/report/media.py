"""Pictures and videos of a run: links that are relative to the page, and thumbnails that are part of it."""

from __future__ import annotations

import base64
import os
import urllib.parse
from pathlib import Path

import cv2

from sim.app.analysis.comparison import Run
from sim.app.evaluation.last_view import picture_file
from sim.app.viewers.video import video_file
from sim.core.pictures import decode_picture
from sim.core.reading import read_bytes

THUMBNAIL_PX = (128, 96)
"""Largest width and height of a thumbnail: 2 to 4 KB each."""
THUMBNAIL_QUALITY = 70


def video_of(run: Run, episode_id: str) -> Path | None:
    """Returns the video of an episode, None if it does not exist."""
    file = video_file(run.path, episode_id)
    return file if file.is_file() else None


def picture_of(run: Run, episode_id: str) -> Path | None:
    """Returns the camera's last picture of an episode, None if it does not exist."""
    file = picture_file(run.path, episode_id)
    return file if file.is_file() else None


def link_to(file: Path | None, folder: Path) -> str | None:
    """Returns the relative address of a file from a page in a folder."""
    if file is None:
        return None
    return urllib.parse.quote(os.path.relpath(file.resolve(), folder.resolve()))


def thumbnail(file: Path) -> str:
    """Returns a small copy of an image as base64 of a JPEG file.

    Raises:
        ConfigError: the file is not an image, or too large.
    """
    content = read_bytes(file, what="Picture")
    image = decode_picture(content, where=f"Picture '{file}'")
    height, width = image.shape[:2]
    scale = min(1.0, THUMBNAIL_PX[0] / width, THUMBNAIL_PX[1] / height)
    size_px = max(1, round(scale * width)), max(1, round(scale * height))
    small = cv2.resize(image, size_px, interpolation=cv2.INTER_AREA)
    _, jpeg = cv2.imencode(".jpg", small, [cv2.IMWRITE_JPEG_QUALITY, THUMBNAIL_QUALITY])
    return base64.b64encode(jpeg.tobytes()).decode("ascii")
