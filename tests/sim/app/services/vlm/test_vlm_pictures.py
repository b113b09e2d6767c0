"""Numbers on views and on the map are where the places are."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sim.app.services.vlm.pictures import MAX_VIEWS, NUMBER, Views, directions, outlined
from sim.core.geometry.pose import Pose
from sim.core.interface import CameraModel

CAMERA = CameraModel()
GREY = np.full((480, 640, 3), 128, np.uint8)
FAR = np.full((480, 640), 5.0, np.float32)


def disc_of(picture: np.ndarray) -> tuple[float, float]:
    """Returns the middle (u, v) of the pixels in the colour of numbers."""
    rows, columns = np.nonzero((picture == NUMBER).all(axis=2))
    return float(columns.mean()), float(rows.mean())


def views_from(*poses: Pose, depth: np.ndarray = FAR) -> Views:
    views = Views(CAMERA, 0.0)
    for pose in poses:
        views.add(pose, GREY, depth)
    return views


def test_a_place_is_marked_where_the_camera_sees_it() -> None:
    (picture,), shown = views_from(Pose(1.0, 2.0, 0.5 * math.pi)).with_numbers(np.array([[0.0, 5.0]]))
    assert shown == [0]
    u, v = disc_of(picture)
    assert u == pytest.approx(320 - CAMERA.focal_px * 1.0 / 3.0, abs=3)  # 3 m ahead, 1 m to the left
    assert v == pytest.approx(240 + CAMERA.focal_px * (CAMERA.height_m - 0.3) / 3.0, abs=3)
    assert (GREY == 128).all()  # the view itself is not changed


def test_places_behind_and_hidden_ones_are_in_no_view() -> None:
    wall = FAR.copy()
    wall[:, :320] = 1.5
    places = np.array([[3.0, 1.0], [3.0, -1.0], [-3.0, 0.0]])
    pictures, shown = views_from(Pose(0.0, 0.0, 0.0), depth=wall).with_numbers(places)
    assert shown == [-1, 0, -1]
    assert len(pictures) == 1


def test_the_nearest_view_of_a_place_shows_it_and_only_different_views_are_kept() -> None:
    views = views_from(*(Pose(0.6 * i, 0.0, 0.0) for i in range(MAX_VIEWS + 5)))
    assert len(views._views) == MAX_VIEWS
    views = views_from(Pose(0.0, 0.0, 0.0), Pose(2.0, 0.0, 0.0), Pose(2.1, 0.0, 0.0), Pose(2.2, 0.0, 0.0))
    assert [view.pose.x_m for view in views._views] == [0.0, 2.0, 2.2]  # the latest one is always there
    (picture,), shown = views.with_numbers(np.array([[4.0, 0.5]]))
    assert shown == [0]
    assert disc_of(picture)[0] == pytest.approx(320 - CAMERA.focal_px * 0.5 / 1.8, abs=3)
    views.forget()
    assert views.with_numbers(np.array([[4.0, 0.5]])) == ([], [-1])


def test_the_outline_of_a_mask_surrounds_it() -> None:
    mask = np.zeros((120, 160), np.bool_)
    mask[30:60, 40:80] = True
    marked = (outlined(GREY, mask) == NUMBER).all(axis=2)
    rows, columns = np.nonzero(marked)
    assert (rows.min(), rows.max()) == pytest.approx((120, 239), abs=2)
    assert (columns.min(), columns.max()) == pytest.approx((160, 319), abs=2)
    assert not marked[140:220, 180:300].any()


def test_directions_are_stated_from_the_robots_heading() -> None:
    places = np.array([[1.0, 3.0], [3.0, 1.0], [0.0, 1.0]])
    assert directions(places, Pose(1.0, 1.0, 0.5 * math.pi), [0, -1, 1]).splitlines() == [
        "1: 2.0 m away, ahead, in view 1",
        "2: 2.0 m away, 90 degrees to the right, in no view",
        "3: 1.0 m away, 90 degrees to the left, in view 2",
    ]
