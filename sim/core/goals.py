"""The goal of an episode: a category, words, the label of an object, or a picture of it.

A plain string is a goal too: `GoalSpec.of` finds its kind. Only a picture, or a place in a chain, needs more.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from sim.core.errors import EpisodeError
from sim.core.geometry.numbers import require_numbers
from sim.core.geometry.pose import BodyPose
from sim.core.interface import GOAL_CATEGORIES, CameraModel
from sim.core.wishes import category_of_label, parse_wish, require_goal

GoalKind = Literal["category", "words", "description", "instance", "picture", "none"]
"""`words` name objects ("fridge"), a `description` has further conditions ("the red chair next to the bed"), an
`instance` is the label of an object (`chair_03`), of which only agents with the ground truth can know. `none` is the
goal of a person who drives around in a house."""
PICTURE_PX = 512
"""Default width and height of a picture of a goal, as in GOAT-Bench and InstanceImageNav."""
MAX_GOALS = 50
"""Largest number of goals of a chain."""


@dataclass(frozen=True, kw_only=True)
class PictureCamera:
    """The camera of a picture of a goal, which is not that of the robot: metres in the world, z up, and radians."""

    x_m: float
    y_m: float
    z_m: float
    """Height of the optical centre in the world."""
    yaw_rad: float
    """Heading of the optical axis, counter-clockwise from +x."""
    pitch_rad: float = 0.0
    """Angle of the optical axis below the horizontal."""
    hfov_rad: float = 1.3
    """Horizontal field of view."""
    width_px: int = PICTURE_PX
    height_px: int = PICTURE_PX

    def __post_init__(self) -> None:
        require_numbers(self)
        self.model  # noqa: B018 - checks the intrinsics

    @property
    def model(self) -> CameraModel:
        """Its intrinsics."""
        return CameraModel(width_px=self.width_px, height_px=self.height_px, hfov_rad=self.hfov_rad)

    @property
    def pose(self) -> BodyPose:
        """The pose of a body that carries a camera of `model` at its height above the floor."""
        # The optical centre is `height_m` above the body's origin along the body's own axis, which leans with it.
        upright = BodyPose(0.0, 0.0, self.yaw_rad, pitch_rad=self.pitch_rad)
        dx_m, dy_m, dz_m = upright.point(0.0, 0.0, self.model.height_m).tolist()
        return BodyPose(self.x_m - dx_m, self.y_m - dy_m, self.yaw_rad, self.z_m - dz_m, pitch_rad=self.pitch_rad)


@dataclass(frozen=True)
class GoalSpec:
    """One goal.

    Raises:
        EpisodeError: there is no such category or object, a word is not known, or a picture has no camera.
    """

    text: str
    """A goal category, words (`sim.core.wishes`), or the label of the object; with a picture its label too."""
    kind: GoalKind
    camera: PictureCamera | None = None
    """The camera of a picture; None: another kind."""
    repeats: int | None = None
    """In a chain, the number of the earlier goal that asked for the same objects; None: it is not a second visit."""

    def __post_init__(self) -> None:
        if self.kind != "none":
            require_goal(self.text)
        elif self.text:
            raise EpisodeError(f"The goal '{self.text}' has the kind 'none', which has no text.")
        if (self.camera is None) == (self.kind == "picture"):
            raise EpisodeError(f"The goal '{self.text}': a picture, and only a picture, has a camera.")
        if self.kind in ("instance", "picture") and category_of_label(self.text) is None:
            raise EpisodeError(f"The goal '{self.text}' must be the label of an object, such as 'chair_03'.")

    @classmethod
    def of(cls, goal: str | GoalSpec) -> GoalSpec:
        """Returns a goal that is given as text.

        Raises:
            EpisodeError: the text is not a category, a label, or words that are known.
        """
        if isinstance(goal, GoalSpec):
            return goal
        if goal in GOAL_CATEGORIES:
            return cls(goal, "category")
        if category_of_label(goal) is not None:
            return cls(goal, "instance")
        require_goal(goal)
        return cls(goal, "words" if parse_wish(goal).is_plain else "description")

    @property
    def told(self) -> str:
        """The text that an agent gets; "": it gets a picture (the sensor `goal_picture`)."""
        return "" if self.kind == "picture" else self.text

    def __str__(self) -> str:
        """Returns the text by which the task finds the objects that satisfy the goal."""
        return self.text


NO_GOAL = GoalSpec("", "none")
"""No object satisfies it, and no STOP succeeds."""


def require_chain(goals: Sequence[GoalSpec]) -> None:
    """Raises EpisodeError if a goal of a chain repeats one that does not come before it."""
    for number, goal in enumerate(goals):
        if goal.repeats is not None and not 0 <= goal.repeats < number:
            raise EpisodeError(f"Goal {number} of a chain repeats goal {goal.repeats}, which does not come before it.")
