"""Draws the pictures of the running episode as JPEG files."""

from __future__ import annotations

from collections.abc import Callable, Collection

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.app.composition.runner import Parts
from sim.app.viewers import overlay
from sim.app.viewers.chase import ChaseView
from sim.app.viewers.palette import PALETTE
from sim.app.viewers.topview import TopView
from sim.app.viewers.viewer import Colour, Moment
from sim.core.interface import MPCAT40
from sim.core.pictures import jpeg_of
from sim.core.vocabulary import in_words
from sim.env.scene import Scene

NAMES = ("camera", "chase", "predicted", "score", "map", "plan", "semantic", "depth")
"""The pictures by name."""
MAP_PX = 480
CHASE_PX = (640, 480)
_SMALL = (320, 240)
_JPEG_QUALITY = 82


class Pictures:
    """Draws the pictures of one environment with its agent; it belongs to the thread that simulates."""

    def __init__(self, parts: Parts) -> None:
        self._parts = parts
        self._scene: Scene | None = None
        self._chase: ChaseView | None = None
        self._plan = TopView(parts.env, heading_up=parts.painter is not None)

    def draw(self, names: Collection[str], moment: Moment) -> dict[str, bytes]:
        """Returns the pictures of these names as JPEG; those that the agent does not have are left out."""
        env, goal, drawn = self._parts.env, self._parts.env.scene.task.goal, {}
        seen, perceived = self._parts.seen, None
        if seen is not None and {"predicted", "score"} & set(names):
            perceived = seen.perceived(moment.observation, goal)
        painter = self._parts.painter
        semantic, task = moment.images["semantic"], env.scene.task
        outlined = _small(task.goal_mask(moment.images).astype(np.uint8)) > 0
        make: dict[str, Callable[[], NDArray[np.uint8]]] = {
            "camera": lambda: overlay.with_inset(
                moment.seen("rgb"), env.scene.picture_of(task.goals[task.goal_number])
            ),
            "chase": self._third_person,
            "plan": lambda: self._plan.paint(MAP_PX),
            "semantic": lambda: overlay.segmentation_picture(_small(semantic), goal, outlined),
            "depth": lambda: overlay.colour_depth(_small(moment.seen("depth")), env.camera_model),
        }
        if painter is not None:
            make["map"] = lambda: painter.paint(MAP_PX)
        if perceived is not None:
            if perceived.scores is not None:
                target = perceived.scores.target
                make["score"] = lambda: overlay.score_picture(_small(moment.seen("rgb")), target)
            if perceived.categories is not None:
                categories = perceived.categories
                make["predicted"] = lambda: overlay.segmentation_picture(_small(categories), goal)
        for name in NAMES:
            if name in names and name in make:
                drawn[name] = jpeg_of(make[name](), _JPEG_QUALITY)
        return drawn

    def legends(self) -> dict[str, list[tuple[str, str]]]:
        """Returns names and colours (CSS) of the items in both maps."""
        painter = self._parts.painter
        return {"plan": _in_css(self._plan.legend), "map": _in_css(painter.legend) if painter is not None else []}

    def close(self) -> None:
        """Frees the renderer."""
        if self._chase is not None:
            self._chase.close()
        self._chase = self._scene = None

    def _third_person(self) -> NDArray[np.uint8]:
        scene = self._parts.env.scene
        if self._chase is None or scene is not self._scene:
            self.close()
            self._scene, self._chase = scene, ChaseView(scene, width_px=CHASE_PX[0], height_px=CHASE_PX[1])
        return self._chase.render()


def in_sight(semantic: NDArray[np.uint8], goal: str, goal_mask: NDArray[np.bool_]) -> list[dict[str, object]]:
    """Returns name and colour (CSS) of each true category in the frame, and whether the goal is in it.

    Args:
        semantic: (h, w) mpcat40 ids.
        goal: the goal.
        goal_mask: (h, w) its pixels; not every object of its categories is the goal if it is in words or a picture.
    """
    shown, of_goal = overlay.names_in_sight(semantic, goal), np.unique(semantic[goal_mask])
    return [
        {
            "name": in_words(MPCAT40[i]),
            "colour": css((int(PALETTE[i, 0]), int(PALETTE[i, 1]), int(PALETTE[i, 2]))),
            "goal": i in of_goal,
        }
        for i in shown
    ]


def css(colour: Colour) -> str:
    """Returns a colour as #rrggbb."""
    return "#{:02x}{:02x}{:02x}".format(*colour)


def _in_css(legend: tuple[tuple[str, Colour], ...]) -> list[tuple[str, str]]:
    return [(name, css(colour)) for name, colour in legend]


def _small(image: NDArray) -> NDArray:
    """Returns an image of numbers at the size of the small pictures, without interpolation."""
    return np.asarray(cv2.resize(image, _SMALL, interpolation=cv2.INTER_NEAREST))
