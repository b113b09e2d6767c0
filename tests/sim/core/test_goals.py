"""Kinds of goals, and cameras of pictures."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from sim.core.errors import EpisodeError
from sim.core.goals import GoalSpec, PictureCamera, require_chain
from sim.core.interface import GOAL_CATEGORIES, ConfigError

CAMERA = PictureCamera(x_m=1.0, y_m=-2.0, z_m=1.4, yaw_rad=0.7, pitch_rad=0.3)


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        *((goal, "category") for goal in GOAL_CATEGORIES),
        ("chair_03", "instance"),
        ("fridge", "words"),
        ("something to sit on", "words"),
        ("the red chair in the bedroom", "description"),
        ("the largest bed", "description"),
    ],
)
def test_a_text_is_a_goal_of_its_kind(text: str, kind: str) -> None:
    goal = GoalSpec.of(text)
    assert (goal.kind, goal.text, goal.told, str(goal)) == (kind, text, text, text)
    assert GoalSpec.of(goal) is goal


def test_the_text_of_a_picture_is_not_told() -> None:
    assert GoalSpec("chair_03", "picture", CAMERA).told == ""


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: GoalSpec.of("gadget"), "No object is known as 'gadget'"),
        (lambda: GoalSpec("chair_03", "picture"), "has a camera"),
        (lambda: GoalSpec("chair", "category", CAMERA), "has a camera"),
        (lambda: GoalSpec("chair", "picture", CAMERA), "must be the label"),
        (lambda: require_chain([GoalSpec("chair", "category", None, 0)]), "does not come before"),
    ],
)
def test_a_wrong_goal_is_refused(make, message: str) -> None:
    with pytest.raises(EpisodeError, match=message):
        make()


@pytest.mark.parametrize("wrong", [{"hfov_rad": 4.0}, {"width_px": 0}, {"pitch_rad": math.nan}])
def test_a_camera_of_a_picture_has_possible_numbers(wrong: dict[str, Any]) -> None:
    with pytest.raises(ConfigError):
        PictureCamera(x_m=0.0, y_m=0.0, z_m=1.0, yaw_rad=0.0, **wrong)


def test_the_optical_centre_of_a_picture_is_where_its_camera_is() -> None:
    body = CAMERA.pose
    assert body.point(0.0, 0.0, CAMERA.model.height_m) == pytest.approx((1.0, -2.0, 1.4))
    ahead = body.axes[0]
    assert np.degrees(np.arcsin(-ahead[2])) == pytest.approx(np.degrees(0.3))
    assert math.atan2(ahead[1], ahead[0]) == pytest.approx(0.7)
