"""Composes a video frame of 1280 x 720 pixels: camera, depth, segmentation, the agent's map and its state.

    +--------------------------------------------------------------+
    | Looking for a chair     step 48 / 500   turn left   [blocked] |
    +----------------+----------------+----------------------------+
    | camera         | segmentation   | map                        |
    | depth          | in sight       | legend of the map          |
    |                |                | state of the agent         |
    +----------------+----------------+----------------------------+

A text that is too wide for its place is written smaller.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.interface import MPCAT40, MPCAT40_ID, Action, CameraModel
from sim.viewers.palette import PALETTE, colour_segmentation
from sim.viewers.viewer import Colour, Moment

Picture = NDArray[np.uint8]
WIDTH_PX, HEIGHT_PX = 1280, 720
PAPER: Colour = (246, 246, 244)
INK: Colour = (28, 28, 30)
PALE: Colour = (110, 110, 114)
HEADER: Colour = (36, 40, 48)
GOAL: Colour = (228, 28, 130)
ALARM: Colour = (204, 42, 32)
ACTION_WORDS: Mapping[Action, str] = {
    Action.STOP: "stop",
    Action.MOVE_FORWARD: "forward",
    Action.TURN_LEFT: "turn left",
    Action.TURN_RIGHT: "turn right",
}
MIN_SHARE = 0.0005
"""Categories that cover less of the frame are not named, except the goal."""

_FONT = cv2.FONT_HERSHEY_SIMPLEX
_HEADER_PX, _TITLE_PX, _GAP_PX = 52, 22, 8
_IMAGE = (400, 300)
_MAP_PX = 448
_LEFT, _MIDDLE = _GAP_PX, 2 * _GAP_PX + _IMAGE[0]
_RIGHT = 3 * _GAP_PX + 2 * _IMAGE[0]
_TOP = _HEADER_PX + _GAP_PX + _TITLE_PX
_BELOW = _TOP + _IMAGE[1] + _TITLE_PX
_ROW_PX = 21


@dataclass(frozen=True, kw_only=True)
class MapPanel:
    """The map beside the images."""

    image: Picture
    """(448, 448, 3); see `MAP_PX`."""
    legend: tuple[tuple[str, Colour], ...]
    title: str
    words: str
    """What the agent is doing."""


MAP_PX = _MAP_PX
"""Edge of the map in the frame."""


def compose(moment: Moment, goal: str, camera: CameraModel, map_panel: MapPanel) -> Picture:
    """Returns the frame without the outcome of the action, uint8 RGB (720, 1280, 3)."""
    frame = np.full((HEIGHT_PX, WIDTH_PX, 3), PAPER, np.uint8)
    semantic = moment.seen("semantic")
    _put(frame, moment.seen("rgb"), (_LEFT, _TOP), "camera")
    _put(frame, _segmentation(semantic, goal), (_MIDDLE, _TOP), "segmentation (true)")
    depth = np.asarray(_shrunk(moment.seen("depth")), np.float32)
    _put(frame, colour_depth(depth, camera), (_LEFT, _BELOW), "depth")
    _depth_scale(frame, camera)
    _write(frame, "in sight", (_MIDDLE, _BELOW - 6), _IMAGE[0], 0.5, PALE)
    _categories(frame, semantic, goal)
    _write(frame, map_panel.title, (_RIGHT, _TOP - 6), _MAP_PX, 0.5, PALE)
    frame[_TOP : _TOP + _MAP_PX, _RIGHT : _RIGHT + _MAP_PX] = map_panel.image
    _map_legend(frame, map_panel)
    frame[:_HEADER_PX] = HEADER
    article = "an" if goal[0] in "aeiou" else "a"
    _write(frame, f"Looking for {article} {in_words(goal)}", (_LEFT + 8, 35), 560, 0.9, (255, 255, 255), 2)
    return frame


def add_outcome(frame: Picture, moment: Moment, info: Mapping[str, Any]) -> None:
    """Writes the outcome of the action into a frame of `compose`: step, action, collision and the counts so far."""
    white = (255, 255, 255)
    _write(frame, f"step {moment.step}", (600, 34), 120, 0.7, white)
    _write(frame, ACTION_WORDS[moment.action], (730, 34), 140, 0.7, white)
    _write(frame, str(info["episode_id"]), (900, 34), 220, 0.5, (170, 174, 182))
    if info["collided"]:
        _badge(frame, "collision", ALARM)
    _facts(frame, info)


def add_end(frame: Picture, line: Mapping[str, Any]) -> None:
    """Writes the outcome of the episode over the header of a frame."""
    frame[:_HEADER_PX, 600:] = HEADER
    success = bool(line["success"])
    fell = line.get("end_reason") == "fallen"
    why = "the robot fell" if fell else str(line.get("error") or line.get("failure") or line.get("end_reason") or "")
    why = why.replace("_", " ")
    words = f"found after {line['num_steps']} steps" if success else f"not found after {line['num_steps']} steps"
    words += f", SPL {line['spl']:.2f}" if success else f": {why}"
    _write(frame, words, (600, 34), WIDTH_PX - 620, 0.7, (150, 230, 165) if success else (255, 150, 140), 2)


def in_words(category: str) -> str:
    """Returns the name of a category with spaces: "chest of drawers"."""
    return category.replace("_", " ")


def colour_depth(depth: NDArray[np.float32], camera: CameraModel) -> Picture:
    """Returns a picture (h, w, 3): near is bright, far is dark, and no return is black."""
    span_m = camera.max_depth_m - camera.min_depth_m
    level = np.clip((camera.max_depth_m - depth) * np.float32(235.0 / span_m) + 20.0, 0.0, 255.0).astype(np.uint8)
    coloured = cv2.applyColorMap(level, cv2.COLORMAP_VIRIDIS)[..., ::-1]
    return np.where(depth[..., None] > 0.0, coloured, np.uint8(0))


def _put(frame: Picture, image: Picture, corner: tuple[int, int], title: str) -> None:
    """Draws an image of the camera with its title above."""
    left, top = corner
    scale = min(_IMAGE[0] / image.shape[1], _IMAGE[1] / image.shape[0])
    width, height = round(image.shape[1] * scale), round(image.shape[0] * scale)
    small = cv2.resize(image, (width, height), interpolation=cv2.INTER_AREA)
    frame[top : top + height, left : left + width] = small
    _write(frame, title, (left, top - 6), _IMAGE[0], 0.5, PALE)


def _shrunk(image: NDArray) -> NDArray:
    """Returns an image of numbers, resized to its panel without interpolation."""
    scale = min(_IMAGE[0] / image.shape[1], _IMAGE[1] / image.shape[0])
    size = (round(image.shape[1] * scale), round(image.shape[0] * scale))
    return np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_NEAREST))


def _segmentation(semantic: NDArray[np.uint8], goal: str) -> Picture:
    """Returns the segmentation in colours, with the goal outlined."""
    small = np.asarray(_shrunk(semantic), np.uint8)
    picture = np.ascontiguousarray(colour_segmentation(small))
    mask = (small == MPCAT40_ID[goal]).astype(np.uint8)
    contours, _ = cv2.findContours(mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    cv2.drawContours(picture, contours, -1, GOAL, 2)
    return picture


def _depth_scale(frame: Picture, camera: CameraModel) -> None:
    """Draws the scale of the depth colours above the right end of the panel."""
    base, right = _BELOW - 6, _LEFT + _IMAGE[0] - 42
    left = right - 140
    metres = np.linspace(camera.min_depth_m, camera.max_depth_m, right - left, dtype=np.float32)
    frame[base - 11 : base + 1, left:right] = colour_depth(metres[None], camera)
    _write(frame, f"{camera.min_depth_m:g} m", (left - 48, base), 44, 0.45, PALE)
    _write(frame, f"{camera.max_depth_m:g} m", (right + 6, base), 36, 0.45, PALE)


def _categories(frame: Picture, semantic: NDArray[np.uint8], goal: str) -> None:
    """Writes names and colours of the visible categories, in two columns in a fixed order."""
    counts = np.bincount(semantic.ravel(), minlength=len(MPCAT40))
    goal_id = MPCAT40_ID[goal]
    shown = [i for i in np.flatnonzero(counts >= MIN_SHARE * semantic.size).tolist() if i != goal_id]
    shown = ([goal_id] if counts[goal_id] else []) + shown
    rows = _IMAGE[1] // _ROW_PX
    for place, category in enumerate(shown[: 2 * rows]):
        left = _MIDDLE + (place // rows) * (_IMAGE[0] // 2)
        top = _BELOW + (place % rows) * _ROW_PX
        red, green, blue = PALETTE[category].tolist()
        _swatch(frame, left, top, (red, green, blue), GOAL if category == goal_id else PALE)
        name = in_words(MPCAT40[category]) + (" (the goal)" if category == goal_id else "")
        _write(frame, name, (left + 26, top + 15), _IMAGE[0] // 2 - 32, 0.5, INK)


def _map_legend(frame: Picture, panel: MapPanel) -> None:
    """Draws the legend of the map in three columns, and what the agent is doing."""
    column = _MAP_PX // 3
    rows = -(-len(panel.legend) // 3)
    for place, (name, colour) in enumerate(panel.legend):
        left, top = _RIGHT + (place // rows) * column, _TOP + _MAP_PX + 10 + (place % rows) * _ROW_PX
        _swatch(frame, left, top, colour, PALE)
        _write(frame, name, (left + 24, top + 15), column - 28, 0.48, INK)
    if panel.words:
        _write(frame, f"The agent {panel.words}", (_RIGHT, HEIGHT_PX - 58), _MAP_PX, 0.55, INK)


def _facts(frame: Picture, info: Mapping[str, Any]) -> None:
    """Writes path length, collisions and distance to the goal after the action."""
    distance_m = info["distance_to_goal"]
    to_go = "no way to the goal" if distance_m is None else f"goal {distance_m:.1f} m away (true)"
    count = info["collisions"]
    collisions = f"{count} collision" + ("" if count == 1 else "s")
    _write(frame, f"driven {info['path_length']:.1f} m, {collisions}", (_RIGHT, HEIGHT_PX - 35), _MAP_PX, 0.55, INK)
    _write(frame, to_go, (_RIGHT, HEIGHT_PX - 12), _MAP_PX, 0.55, INK)


def _badge(frame: Picture, words: str, colour: Colour) -> None:
    """Draws text on a coloured rectangle at the right end of the header."""
    (width, _), _ = cv2.getTextSize(words, _FONT, 0.7, 2)
    cv2.rectangle(frame, (WIDTH_PX - 36 - width, 9), (WIDTH_PX - 12, _HEADER_PX - 9), colour, cv2.FILLED)
    _write(frame, words, (WIDTH_PX - 24 - width, 34), width + 12, 0.7, (255, 255, 255), 2)


def _swatch(frame: Picture, left: int, top: int, colour: Colour, rim: Colour) -> None:
    cv2.rectangle(frame, (left, top), (left + 17, top + 15), colour, cv2.FILLED)
    cv2.rectangle(frame, (left, top), (left + 17, top + 15), rim, 1 if rim == PALE else 2)


def _write(
    frame: Picture,
    words: str,
    left_base: tuple[int, int],
    width_px: int,
    scale: float,
    colour: Colour,
    thickness: int = 1,
) -> None:
    """Writes text from its lower left corner, smaller where it would be wider than `width_px`."""
    (text_px, _), _ = cv2.getTextSize(words, _FONT, scale, thickness)
    if text_px > width_px:
        scale *= width_px / text_px
    cv2.putText(frame, words, left_base, _FONT, scale, colour, thickness, cv2.LINE_AA)
