"""Composes a video frame of 1280 x 720 pixels.

    +---------------------------------------------------------------------+
    | Looking for a chair          step 48 / 500   turn left   [collision] |
    +-----------------------------------+---------------------+-----------+
    | camera, 640 x 480                 | the robot in        | depth     |
    | (goals of a chain)                | third person        | score     |
    |                                   +----------------+----+-----------+
    |                                   | the agent's    | the true       |
    +-----------+-----------+-----------+ map            | plan           |
    | agent's   | true      | colours   +----------------+----------------+
    | segments  | segments  | in sight  | legends, state of the agent     |
    +-----------+-----------+-----------+---------------------------------+

Without a map of the agent, the plan fills the area of both; without a segmentation, or with the true one, the picture
of the agent's segments is left out.
A text that is too wide for its place is written smaller.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import cast

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.app.viewers.palette import PALETTE, colour_segmentation
from sim.app.viewers.text import BOLD, NORMAL, text_width, wrapped, write
from sim.app.viewers.viewer import Colour, Moment
from sim.core.interface import MPCAT40, MPCAT40_ID, CameraModel, Perceived
from sim.core.vocabulary import counted, in_words, with_article
from sim.core.wishes import categories_of
from sim.task.explanations import ACTION_WORDS, Outcome
from sim.task.objectnav import Task

Picture = NDArray[np.uint8]
WIDTH_PX, HEIGHT_PX = 1280, 720
MAP_PX = 296
"""Edge of both maps in the frame."""
CHASE_PX = (400, 250)
"""Width and height of the view in third person."""
PAPER: Colour = (246, 246, 244)
INK: Colour = (28, 28, 30)
PALE: Colour = (104, 106, 112)
HEADER: Colour = (30, 34, 42)
WHITE: Colour = (255, 255, 255)
GOAL: Colour = (228, 28, 130)
ALARM: Colour = (222, 40, 30)
FOUND: Colour = (120, 226, 145)
MISSED: Colour = (255, 138, 122)
MIN_SHARE = 0.0005
"""Categories that cover less of the frame are not named, except the goal."""

_HEADER_PX = 40
_CAMERA = (8, 60, 640, 480)  # left, top, width, height
_SMALL = (204, 153)
_SMALL_TOP, _SMALL_LEFT = 562, (8, 226)
_CHASE = (656, 60, *CHASE_PX)
_DEPTH = (1068, 60, 204, 153)
_LOW_DEPTH, _SCORE = (1068, 60, 204, 112), (1068, 198, 204, 112)
_INSET_SHARE = 0.3
"""Side of the picture of a goal, as a share of the height of the camera's picture, over which it lies."""
_NAMES_PX = 103
"""Width of a column of names of categories."""
_MAPS_TOP, _MAP_LEFT, _PLAN_LEFT = 334, 656, 976
_LEGEND_TOP, _ROW_PX, _COLUMN_PX = _MAPS_TOP + MAP_PX + 5, 14, 98
_STATE_TOP = 691
_FLASH_PX = 7


@dataclass(frozen=True, kw_only=True)
class MapPanel:
    """The agent's map in a frame."""

    image: Picture
    """(MAP_PX, MAP_PX, 3)."""
    words: str = ""
    """Text that says what the agent is doing."""


@dataclass(frozen=True)
class GoalMark:
    """A goal of a chain and how it ended."""

    words: str
    found: bool | None
    """None: it has not ended."""
    present: bool = False
    """True: the robot looks for it."""


def goal_marks(task: Task) -> list[GoalMark]:
    """Returns the goals of a chain with their outcomes; none: the episode has one goal."""
    if not task.is_chain:
        return []
    return [
        GoalMark(
            in_words(result.goal),
            None if result.end_reason is None else result.success == 1.0,
            present=number == task.goal_number,
        )
        for number, result in enumerate(task.goal_results())
    ]


class FrameComposer:
    """Composes the frames of one episode; what does not change is drawn once.

    Args:
        goal: category that the episode asks for.
        camera: the range of depth.
        plan_legend: names and colours of the true plan.
        map_legend: names and colours of the agent's map; None: the agent has no map.
        scores: whether the agent has a segmentation, which computes scores of the goal.
        names: whether that segmentation names the category of each pixel.
        max_steps: number of actions that the episode allows.
        segmentation: name of the agent's segmentation.
        picture: the picture of the goal, uint8 (h, w, 3); None: the goal is text.
    """

    def __init__(
        self,
        goal: str,
        camera: CameraModel,
        *,
        plan_legend: tuple[tuple[str, Colour], ...],
        map_legend: tuple[tuple[str, Colour], ...] | None = None,
        scores: bool = False,
        names: bool = False,
        max_steps: int = 500,
        segmentation: str = "",
        picture: Picture | None = None,
    ) -> None:
        self._picture = picture
        self.goal, self._camera, self._max_steps = goal, camera, max_steps
        self._depth = _LOW_DEPTH if scores else _DEPTH
        is_true = segmentation == "ground truth"
        self._segments = ("predicted", "true") if names and not is_true else ("true",)
        self._plan_left = _MAP_LEFT if map_legend is None else _PLAN_LEFT
        self.plan_px = WIDTH_PX - 8 - self._plan_left, MAP_PX
        """Width and height of the plan."""
        module, own, last = segmentation.rpartition(":")
        named = f"by {module.rpartition('.')[2]}:{last}" if own else f"segmentation ({segmentation})"
        captions = {"predicted": named, "true": named if is_true else "segmentation (true)"}
        self._ground = np.full((HEIGHT_PX, WIDTH_PX, 3), PAPER, np.uint8)
        frame = self._ground
        frame[:_HEADER_PX] = HEADER
        asked = with_article(goal) if picture is None else "the object in the picture"
        write(frame, f"Looking for {asked}", (14, 28), 560, 24, WHITE, BOLD)
        for box, title in (
            (_CAMERA, "camera of the robot"),
            (_CHASE, "third person (blue: obstacles that no camera shows)"),
            *((self._segment_box(name), captions[name]) for name in self._segments),
            ((self._plan_left, _MAPS_TOP, *self.plan_px), "plan (true)"),
        ):
            self._caption(frame, title, box)
        self._caption(frame, "depth", (*_DEPTH[:2], 60, _DEPTH[3]))
        _depth_scale(frame, camera)
        _legend(frame, plan_legend, self._plan_left, self.plan_px[0])
        _legend(frame, map_legend or (), _MAP_LEFT, MAP_PX)

    def compose(
        self,
        moment: Moment,
        *,
        plan: Picture,
        map_panel: MapPanel | None = None,
        chase: Picture | None = None,
        perceived: Perceived | None = None,
        goal_mask: NDArray[np.bool_] | None = None,
        goals: Sequence[GoalMark] = (),
    ) -> Picture:
        """Returns the frame without the outcome of the action, uint8 RGB (720, 1280, 3).

        `goal_mask` (h, w) are the true pixels of the goal; None: those of its category. `goals` are those of a chain.
        """
        frame = self._ground.copy()
        _put(frame, with_inset(moment.seen("rgb"), self._picture), _CAMERA)
        tick_off(frame, goals)
        self._segmentations(frame, moment, perceived, goal_mask)
        _put(frame, colour_depth(_resized(moment.seen("depth"), self._depth), self._camera), self._depth)
        if chase is not None:
            _put(frame, chase, _CHASE)
        frame[_MAPS_TOP : _MAPS_TOP + MAP_PX, self._plan_left : self._plan_left + self.plan_px[0]] = plan
        if map_panel is not None:
            self._caption(frame, "the agent's map", (_MAP_LEFT, _MAPS_TOP, MAP_PX, MAP_PX))
            frame[_MAPS_TOP : _MAPS_TOP + MAP_PX, _MAP_LEFT : _MAP_LEFT + MAP_PX] = map_panel.image
            for row, words in enumerate(wrapped(map_panel.words, MAP_PX, 13)[:2]):
                write(frame, words, (_MAP_LEFT, _STATE_TOP + 12 + 15 * row), MAP_PX, 13, INK)
        write(frame, f"step {moment.step} / {self._max_steps}", (612, 27), 130, 18, WHITE)
        write(frame, ACTION_WORDS[moment.action], (756, 27), 120, 18, WHITE, BOLD)
        return frame

    def add_outcome(self, frame: Picture, info: Mapping[str, object]) -> None:
        """Writes the outcome of the action into a frame of `compose`: collision and the counts so far."""
        write(frame, str(info["episode_id"]), (890, 26), 230, 14, (170, 174, 182))
        distance_m = info["distance_to_goal"]
        to_go = "no path to the goal" if distance_m is None else f"{distance_m:.1f} m to go"
        collisions = counted(cast(int, info["collisions"]), "collision")
        write(frame, f"driven {info['path_length']:.1f} m, {to_go}", (self._plan_left, _STATE_TOP + 3), MAP_PX, 14, INK)
        write(frame, collisions, (self._plan_left, _STATE_TOP + 20), MAP_PX, 14, ALARM if info["collided"] else INK)
        if info["collided"]:
            self._flash(frame)

    def add_end(self, frame: Picture, outcome: Outcome) -> None:
        """Writes the outcome of the episode over the camera's picture, and its headline into the header."""
        colour = FOUND if outcome.found else MISSED
        frame[:_HEADER_PX, 600:] = HEADER
        write(frame, outcome.headline, (612, 28), WIDTH_PX - 630, 22, colour, BOLD)
        left, top, width, height = _CAMERA
        lines = wrapped(outcome.sentence, width - 48, 18)[:5]
        tall = 58 + 25 * len(lines)
        card = frame[top + height - tall : top + height, left : left + width]
        card[:] = (card.astype(np.uint16) * 1 // 5 + np.array(HEADER, np.uint16) * 4 // 5).astype(np.uint8)
        frame[top + height - tall : top + height - tall + 4, left : left + width] = colour
        base = top + height - tall + 38
        write(frame, outcome.headline, (left + 24, base), width - 48, 24, colour, BOLD)
        for row, words in enumerate(lines, start=1):
            write(frame, words, (left + 24, base + 4 + 25 * row), width - 48, 18, WHITE)

    def _segmentations(
        self, frame: Picture, moment: Moment, perceived: Perceived | None, goal_mask: NDArray[np.bool_] | None
    ) -> None:
        """Draws the predicted and the true segmentation with the names of their colours, and the score of the goal."""
        shown = {"true": moment.images["semantic"]}
        if perceived is not None and perceived.categories is not None:
            shown["predicted"] = perceived.categories
        small = {name: _resized(shown[name], self._segment_box(name)) for name in self._segments if name in shown}
        for name, segments in small.items():
            box = self._segment_box(name)
            outlined = None if goal_mask is None or name != "true" else _resized(goal_mask.astype(np.uint8), box) > 0
            _put(frame, segmentation_picture(segments, self.goal, outlined), box)
        self._names(frame, list(small.values()))
        if "predicted" in self._segments and "predicted" not in small:
            left, top, width, height = self._segment_box("predicted")
            write(frame, "not used in this step", (left + 12, top + height // 2), width - 24, 14, PALE)
        if perceived is not None and perceived.scores is not None:
            target = perceived.scores.target
            self._caption(frame, f"score of the goal, at most {float(target.max()):.2f}", _SCORE)
            _put(frame, score_picture(_fitted(moment.seen("rgb"), _SCORE), target), _SCORE)

    def _segment_box(self, name: str) -> tuple[int, int, int, int]:
        return (_SMALL_LEFT[self._segments.index(name)], _SMALL_TOP, *_SMALL)

    def _names(self, frame: Picture, segments: list[NDArray[np.uint8]]) -> None:
        """Draws names and colours of the categories next to the segmentations, in columns and in a fixed order."""
        left = _SMALL_LEFT[len(self._segments) - 1] + _SMALL[0] + 12
        columns = (_CAMERA[0] + _CAMERA[2] - left) // _NAMES_PX
        rows, goal_ids = _SMALL[1] // _ROW_PX, ids_of(self.goal)
        together = np.concatenate([segment.ravel() for segment in segments])
        for place, category in enumerate(names_in_sight(together, self.goal, columns * rows)):
            x, y = left + (place // rows) * _NAMES_PX, _SMALL_TOP + (place % rows) * _ROW_PX
            red, green, blue = PALETTE[category].tolist()
            is_goal = category in goal_ids
            _swatch(frame, x, y, (red, green, blue), GOAL if is_goal else PALE)
            name = in_words(MPCAT40[category])
            colour, weight = (GOAL, BOLD) if is_goal else (INK, NORMAL)
            write(frame, name, (x + 15, y + 10), _NAMES_PX - 18, 12, colour, weight)

    def _flash(self, frame: Picture) -> None:
        """Marks a collision: a red frame around the camera's picture, and a badge in the header."""
        left, top, width, height = _CAMERA
        corner = left + width - 1, top + height - 1
        half = _FLASH_PX // 2
        cv2.rectangle(frame, (left + half, top + half), (corner[0] - half, corner[1] - half), ALARM, _FLASH_PX)
        left, top, width, height = _CHASE
        cv2.rectangle(frame, (left + 2, top + 2), (left + width - 3, top + height - 3), ALARM, 4)
        wide = text_width("collision", 18, BOLD)
        cv2.rectangle(frame, (WIDTH_PX - 36 - wide, 6), (WIDTH_PX - 12, _HEADER_PX - 6), ALARM, cv2.FILLED)
        write(frame, "collision", (WIDTH_PX - 24 - wide, 26), wide + 12, 18, WHITE, BOLD)

    def _caption(self, frame: Picture, words: str, box: tuple[int, int, int, int]) -> None:
        left, top, width, _ = box
        write(frame, words, (left, top - 6), width, 13, PALE)


def names_in_sight(semantic: NDArray[np.uint8], goal: str, most: int = len(MPCAT40)) -> list[int]:
    """Returns the mpcat40 ids of the `most` largest visible categories.

    The goal is the first if it is visible. The others are in the order of their numbers.
    """
    counts = np.bincount(semantic.ravel(), minlength=len(MPCAT40))
    goal_ids = [i for i in ids_of(goal) if counts[i]]
    others = [i for i in np.flatnonzero(counts >= MIN_SHARE * semantic.size).tolist() if i not in goal_ids]
    largest = sorted(others, key=lambda i: -counts[i])[: max(0, most - len(goal_ids))]
    return goal_ids + sorted(largest)


def ids_of(goal: str) -> tuple[int, ...]:
    """Returns the mpcat40 ids of the categories that a goal may mean."""
    return tuple(MPCAT40_ID[category] for category in categories_of(goal))


def segmentation_picture(semantic: NDArray[np.uint8], goal: str, outlined: NDArray[np.bool_] | None = None) -> Picture:
    """Returns categories (h, w) in colours, with the goal outlined, uint8 RGB (h, w, 3).

    Args:
        semantic: the categories.
        goal: the goal.
        outlined: (h, w) the pixels of the goal; None: all of its categories.
    """
    picture = np.ascontiguousarray(colour_segmentation(semantic))
    mask = np.isin(semantic, ids_of(goal)) if outlined is None else outlined
    contours, _ = cv2.findContours(mask.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    cv2.drawContours(picture, contours, -1, GOAL, 2)
    return picture


def score_picture(rgb: Picture, target: NDArray[np.float32]) -> Picture:
    """Returns the score of the goal over the grey camera picture: none is grey, 1 is bright yellow; (h, w, 3)."""
    size = (rgb.shape[1], rgb.shape[0])
    level = (cv2.resize(target, size, interpolation=cv2.INTER_LINEAR) * 255.0).clip(0.0, 255.0).astype(np.uint8)
    grey = cv2.cvtColor(cv2.cvtColor(rgb, cv2.COLOR_RGB2GRAY) // 2, cv2.COLOR_GRAY2RGB)
    hot = cv2.cvtColor(cv2.applyColorMap(level, cv2.COLORMAP_INFERNO), cv2.COLOR_BGR2RGB)
    weight = np.sqrt(level.astype(np.float32) / 255.0)[..., None]
    return (grey * (1.0 - weight) + hot * weight).astype(np.uint8)


def colour_depth(depth: NDArray[np.float32], camera: CameraModel) -> Picture:
    """Returns a picture (h, w, 3): near is bright, far is dark, and no return is black."""
    span_m = camera.max_depth_m - camera.min_depth_m
    level = np.clip((camera.max_depth_m - depth) * np.float32(235.0 / span_m) + 20.0, 0.0, 255.0).astype(np.uint8)
    coloured = cv2.applyColorMap(level, cv2.COLORMAP_VIRIDIS)[..., ::-1]
    return np.where(depth[..., None] > 0.0, coloured, np.uint8(0))


def _size_in(image: NDArray, box: tuple[int, int, int, int]) -> tuple[int, int]:
    """Returns width and height of an image at the largest size that fits into a box, with its proportions."""
    scale = min(box[2] / image.shape[1], box[3] / image.shape[0])
    return max(1, round(image.shape[1] * scale)), max(1, round(image.shape[0] * scale))


def _fitted(image: Picture, box: tuple[int, int, int, int]) -> Picture:
    """Returns a picture resized to a box, with its proportions."""
    size = _size_in(image, box)
    if size == (image.shape[1], image.shape[0]):
        return image
    method = cv2.INTER_AREA if size[0] < image.shape[1] else cv2.INTER_LINEAR
    return np.asarray(cv2.resize(image, size, interpolation=method), np.uint8)


def _resized(image: NDArray, box: tuple[int, int, int, int]) -> NDArray:
    """Returns an image of numbers, resized to a box without interpolation."""
    return np.asarray(cv2.resize(image, _size_in(image, box), interpolation=cv2.INTER_NEAREST))


def _put(frame: Picture, image: Picture, box: tuple[int, int, int, int]) -> None:
    """Draws a picture into the upper left corner of a box."""
    left, top = box[:2]
    fitted = _fitted(image, box)
    frame[top : top + fitted.shape[0], left : left + fitted.shape[1]] = fitted


def _depth_scale(frame: Picture, camera: CameraModel) -> None:
    """Draws the scale of the depth colours above the depth image."""
    left, top, width, _ = _DEPTH
    base, first, last = top - 6, left + 88, left + width - 28
    metres = np.linspace(camera.min_depth_m, camera.max_depth_m, last - first, dtype=np.float32)
    frame[base - 9 : base + 1, first:last] = colour_depth(metres[None], camera)
    near, far = f"{camera.min_depth_m:g} m", f"{camera.max_depth_m:g} m"
    write(frame, near, (first - 4 - text_width(near, 12), base), 40, 12, PALE)
    write(frame, far, (last + 4, base), 24, 12, PALE)


def _legend(frame: Picture, legend: tuple[tuple[str, Colour], ...], left: int, width: int) -> None:
    """Writes the legend of a map below it, in columns."""
    rows = max(1, -(-len(legend) // (width // _COLUMN_PX)))
    for place, (name, colour) in enumerate(legend):
        x, y = left + (place // rows) * _COLUMN_PX, _LEGEND_TOP + (place % rows) * _ROW_PX
        _swatch(frame, x, y, colour, PALE)
        write(frame, name, (x + 15, y + 9), _COLUMN_PX - 17, 12, INK)


def _swatch(frame: Picture, left: int, top: int, colour: Colour, rim: Colour) -> None:
    cv2.rectangle(frame, (left, top), (left + 11, top + 9), colour, cv2.FILLED)
    cv2.rectangle(frame, (left, top), (left + 11, top + 9), rim, 1)


def with_inset(image: Picture, picture: Picture | None) -> Picture:
    """Returns an image of the camera with the picture of the goal in its upper right corner; None: without one."""
    if picture is None:
        return image
    side_px = round(_INSET_SHARE * image.shape[0])
    small = cv2.resize(picture, (side_px, side_px), interpolation=cv2.INTER_AREA)
    framed, result = cv2.copyMakeBorder(small, 3, 3, 3, 3, cv2.BORDER_CONSTANT, value=WHITE), image.copy()
    result[8 : 8 + framed.shape[0], -8 - framed.shape[1] : -8] = framed
    return result


def tick_off(frame: Picture, goals: Sequence[GoalMark], *, opaque: bool = False) -> None:
    """Writes the goals of a chain over the upper left corner of the camera's picture: found, missed, present, later.

    Args:
        frame: the picture.
        goals: of the chain; none: nothing is drawn.
        opaque: whether to hide what is below.
    """
    if not goals:
        return
    left, top, row_px, wide = _CAMERA[0] + 8, _CAMERA[1] + 8, 20, 300
    present = next((number for number, goal in enumerate(goals) if goal.present), 0)
    first = max(0, min(present - _MAX_ROWS // 2, len(goals) - _MAX_ROWS))
    rows = list(enumerate(goals))[first : first + _MAX_ROWS]
    panel = frame[top : top + row_px * len(rows) + 8, left : left + wide]
    below = 0 if opaque else panel.astype(np.uint16)
    panel[:] = (below * 1 // 4 + np.array(HEADER, np.uint16) * (4 if opaque else 3) // 4).astype(np.uint8)
    for row, (number, goal) in enumerate(rows):
        base = top + row_px * (row + 1)
        colour = _GOAL_COLOURS[goal.found]
        middle = left + 14, base - 5
        if goal.found is None:
            cv2.circle(frame, middle, 5, WHITE if goal.present else colour, -1 if goal.present else 1, cv2.LINE_AA)
        elif goal.found:
            tick = np.array([[-5, 0], [-1, 4], [6, -5]]) + middle
            cv2.polylines(frame, [tick.astype(np.int32)], False, colour, 2, cv2.LINE_AA)
        else:
            for way in (-1, 1):
                ends = (middle[0] - 4, middle[1] - 4 * way), (middle[0] + 4, middle[1] + 4 * way)
                cv2.line(frame, *ends, colour, 2, cv2.LINE_AA)
        ink, weight = (WHITE, BOLD) if goal.present else (colour, NORMAL)
        write(frame, f"{number + 1}  {goal.words}", (left + 28, base), wide - 36, 14, ink, weight)


_MAX_ROWS = 12
"""Goals of a long chain that are shown, around the present one."""
_GOAL_COLOURS: Mapping[bool | None, Colour] = {True: FOUND, False: MISSED, None: (190, 194, 202)}
