"""What a LeRobot policy sees and does: names, shapes and values, for datasets and for the environment.

| key | shape | meaning |
|---|---|---|
| observation.image | (h, w, 3) | colour of the camera |
| observation.state | (3,) | metres forward and left of the start, heading against the start's, radians |
| observation.environment_state | (21,) | 1 at the index of the goal category, for policies that read no words |
| action | (4,) | 1 for the chosen one of stop, move_forward, turn_left, turn_right; the largest value counts |
| task | text | the goal, such as "find a chair" |
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from types import MappingProxyType

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.core.errors import ConfigError
from sim.core.interface import GOAL_CATEGORIES, MOVES, Action, Observation
from sim.core.vocabulary import with_article
from sim.episodes.episode import Episode

FPS = 4
"""Frames a second in datasets and videos: one frame is one action, whatever time it takes."""
IMAGE, STATE, GOAL, ACTION = "observation.image", "observation.state", "observation.environment_state", "action"
VECTORS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        STATE: ("forward_m", "left_m", "yaw_rad"),
        GOAL: GOAL_CATEGORIES,
        ACTION: tuple(action.name.lower() for action in MOVES),
    }
)
"""Names of the entries of each vector, float32."""


def picture_of(rgb: NDArray[np.uint8], width_px: int) -> NDArray[np.uint8]:
    """Returns a colour image in the width of a dataset, (h, w, 3); the height is even.

    Raises:
        ConfigError: the camera's image is narrower, or the width is odd or less than 2.
    """
    height, width = rgb.shape[:2]
    if not 2 <= width_px <= width or width_px % 2:
        raise ConfigError(f"The width of pictures must be even and at most the camera's, {width} pixels.")
    size = width_px, 2 * round(0.5 * height * width_px / width)
    return rgb if size == (width, height) else np.asarray(cv2.resize(rgb, size, interpolation=cv2.INTER_AREA), np.uint8)


def state_of(observation: Observation) -> NDArray[np.float32]:
    """Returns the pose that the robot measures, (3,)."""
    return np.concatenate([observation["gps"], observation["compass"]]).astype(np.float32)


def goal_of(goal: str) -> NDArray[np.float32]:
    """Returns 1 at the index of a goal category, (21,); all 0 for a goal in words."""
    return np.array([name == goal for name in GOAL_CATEGORIES], np.float32)


def vector_of(action: Action) -> NDArray[np.float32]:
    """Returns an action as the vector of policies, (4,)."""
    return np.array([other is action for other in MOVES], np.float32)


def action_of(vector: NDArray[np.floating]) -> Action:
    """Returns the action with the largest value of a vector (4,).

    Raises:
        ConfigError: it has another shape, or no number.
    """
    values = np.asarray(vector, np.float64).reshape(-1)
    if values.shape != (len(MOVES),) or np.isnan(values).any():
        raise ConfigError(f"An action has {len(MOVES)} values, one for each of {', '.join(VECTORS[ACTION])}.")
    return MOVES[int(values.argmax())]


def task_of(goal: str) -> str:
    """Returns a goal, a category or words, as the task of a policy: "find a chair"."""
    return f"find {with_article(goal) if goal in GOAL_CATEGORIES else goal}"


def require_one_text(episodes: Iterable[Episode]) -> None:
    """Raises ConfigError if an episode is a chain or its goal is a picture: it has one `task`, which is a text."""
    for episode in episodes:
        if episode.is_chain or episode.in_picture:
            what = "several goals" if episode.is_chain else "a picture as its goal"
            raise ConfigError(f"Episode '{episode.episode_id}' has {what}; an episode of LeRobot has one goal, a text.")
