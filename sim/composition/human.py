"""A person as an agent: pictures in a terminal, keys as actions. Used by `stubborn teleop`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from textwrap import wrap
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from sim.env.objectnav import ObjectNavEnv
from sim.interface import MPCAT40, MPCAT40_ID, Action, AgentSpec, Observation
from sim.task.explanations import ACTION_WORDS, in_words
from sim.viewers.overlay import colour_depth
from sim.viewers.palette import colour_segmentation
from sim.viewers.terminal import Colours, beside, fitted, half_blocks
from stubborn.agent import StubbornAgent
from stubborn.drawing.map_painter import AgentMapPainter, describe_intention
from stubborn.segmentation.ground_truth import GroundTruthSegmenter

KEYS: dict[str, Action] = {
    "w": Action.MOVE_FORWARD,
    "up": Action.MOVE_FORWARD,
    "a": Action.TURN_LEFT,
    "left": Action.TURN_LEFT,
    "d": Action.TURN_RIGHT,
    "right": Action.TURN_RIGHT,
    "x": Action.STOP,
}
HUMAN_NAME = "human"
"""The agent's name in the results of a person."""
HELP = "arrows or wad drive  x STOP  g distance  c camera  m layout  p path  q quit"
CAMERAS = ("rgb", "semantic", "depth")
LAYOUTS = ("both", "camera", "map")
_STRUCTURE = frozenset(MPCAT40_ID[name] for name in ("void", "wall", "floor", "ceiling", "door", "window"))


class Quit(KeyboardInterrupt):
    """The person has quit."""


class Cockpit(Protocol):
    """Shows pictures and reads keys; `sim.viewers.terminal.Terminal` is one."""

    colours: Colours

    @property
    def size(self) -> tuple[int, int]: ...  # noqa: D102
    def show(self, lines: Sequence[str]) -> None: ...  # noqa: D102
    def key(self) -> str: ...  # noqa: D102


class Human:
    """An `Agent` that asks a person; a Stubborn agent next to it draws the map and can show its route."""

    def __init__(self, env: ObjectNavEnv, cockpit: Cockpit) -> None:
        self._env, self._cockpit = env, cockpit
        self.mapper = StubbornAgent(camera=env.camera_model, robot=env.robot_model, segmenter=GroundTruthSegmenter())
        self.painter = AgentMapPainter(self.mapper, show_route=False)
        self.camera, self.layout = CAMERAS[0], LAYOUTS[0]

    def reset(self, goal: str, seed: int) -> None:
        """Starts a new episode."""
        self.mapper.reset(goal, seed)

    def act(self, observation: Observation) -> Action:
        """Shows the observation until a key chooses an action.

        Raises:
            Quit: the key to quit was pressed.
        """
        self.mapper.act(observation)  # it maps; its own action is shown only on request
        message = self._news()
        while True:
            self._cockpit.show(self._screen(observation, message))
            key = self._cockpit.key()
            if key in KEYS:
                self.mapper.overridden(KEYS[key])  # it infers collisions from the action that was carried out
                return KEYS[key]
            if key in ("q", ""):
                raise Quit
            message = self._answer(key)

    def _answer(self, key: str) -> str:
        """Carries out a key that does not move the robot; returns the message to show."""
        if key == "g":
            distance_m = self._env.scene.task.metrics()["distance_to_goal"]
            return "there is no path to the goal" if distance_m is None else f"goal: {distance_m:.1f} m to go"
        if key == "c":
            self.camera = _next(CAMERAS, self.camera)
            return f"camera shows {self.camera}"
        if key == "m":
            self.layout = _next(LAYOUTS, self.layout)
            return f"layout: {self.layout}"
        if key == "p":
            self.painter.show_route = not self.painter.show_route
            advised = self.mapper.last_action
            if advised is None or not self.painter.show_route:
                return "the agent's path is hidden"
            return f"the agent would: {ACTION_WORDS[advised]} ({describe_intention(self.mapper)})"
        return "that key does nothing"

    def _news(self) -> str:
        """Returns a sentence about the last action."""
        motion = self._env.motion
        if motion is None:
            return "you are at the start"
        if motion.collided:
            return f"{ACTION_WORDS[motion.action]}: COLLISION, an obstacle stopped the body"
        return f"{ACTION_WORDS[motion.action]}: done"

    def _screen(self, observation: Observation, message: str) -> list[str]:
        """Returns the lines of the whole screen."""
        columns, lines = self._cockpit.size
        step = self._env.scene.task.num_steps + 1
        head = wrap(f"Look for: {in_words(self.mapper.goal).upper()}, step {step}. {message}", columns)
        foot = [*wrap(f"in sight: {_names_in_sight(observation['semantic'])}", columns), *wrap(HELP, columns)]
        room = max(2, lines - len(head) - len(foot))
        blocks, widths = [], []
        share = columns if self.layout != "both" else (columns - 2) // 2
        if self.layout != "map":
            picture = fitted(self._picture(observation), share, room)
            blocks.append(half_blocks(picture, self._cockpit.colours))
            widths.append(picture.shape[1])
        if self.layout != "camera":
            size = max(4, min(share, 2 * room) // 2 * 2)
            blocks.append(half_blocks(self.painter.paint(size), self._cockpit.colours))
            widths.append(size)
        return [*head, *beside(blocks, widths), *foot][:lines]

    def _picture(self, observation: Observation) -> NDArray[np.uint8]:
        if self.camera == "semantic":
            return colour_segmentation(observation["semantic"])
        if self.camera == "depth":
            return colour_depth(observation["depth"], self._env.camera_model)
        return observation["rgb"]


def judged(line: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the result line of an episode that a person ended: a STOP far from the goal is `misc`.

    `false_detection` says that a segmentation took another object for the goal. A person has no segmentation.
    """
    return {**line, "failure": "misc"} if line["failure"] == "false_detection" else dict(line)


def _names_in_sight(semantic: NDArray[np.uint8], most: int = 8) -> str:
    """Returns the names of the furniture in the picture, the largest first."""
    counts = np.bincount(semantic.ravel(), minlength=len(MPCAT40))
    shown = [i for i in np.argsort(-counts, kind="stable").tolist() if counts[i] and i not in _STRUCTURE]
    return ", ".join(in_words(MPCAT40[i]) for i in shown[:most]) or "no furniture"


def _next(choices: Sequence[str], now: str) -> str:
    return choices[(choices.index(now) + 1) % len(choices)]


def _make_human(*, truth: ObjectNavEnv, cockpit: Cockpit, **_: object) -> Human:
    return Human(truth, cockpit)


HUMAN = AgentSpec(
    make=_make_human,
    description="a person at a terminal (stubborn teleop)",
    sensors=("rgb", "depth", "semantic"),
    uses_segmentation=False,
    uses_ground_truth=True,
)
"""The declaration of a person, who sees all images, the true segmentation included."""
