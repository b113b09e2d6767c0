"""The map of starts and goals of a house's episodes."""

from __future__ import annotations

import cv2
import numpy as np

from sim.app.viewers import episode_map
from sim.app.viewers.topview import OBSTACLE


def test_the_outline_of_a_name_lies_around_its_own_letters() -> None:
    text, middle = "chest of drawers", np.array([150, 40], np.int32)
    dark = np.full((80, 300, 3), OBSTACLE, np.uint8)
    episode_map._write(dark, text, middle, [])
    (width, height), _ = cv2.getTextSize(text, episode_map._FONT, episode_map.TEXT, 1)
    letters = np.zeros((80, 300), np.uint8)
    base = 150 - width // 2, 40 + height // 2
    cv2.putText(letters, text, base, episode_map._FONT, episode_map.TEXT, 255, 1, cv2.LINE_AA)
    written, own = (np.flatnonzero(image.any(axis=0)) for image in ((dark != OBSTACLE).any(axis=2), letters > 0))
    assert abs(int(written[0]) - int(own[0])) <= 2
    assert abs(int(written[-1]) - int(own[-1])) <= 2
