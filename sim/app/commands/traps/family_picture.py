"""Draws a family of traps: for each difficulty a trap from above, and what the robot's camera sees at its start."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.app.commands.traps.picture import BOLD, END, HEIGHT_PX, INK, PAPER, START, TopView
from sim.app.viewers.text import write
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.episode import Episode
from sim.houses.sidecar import TrapFacts

Picture = NDArray[np.uint8]
CAMERA_WIDTH_PX = HEIGHT_PX * 4 // 3
TITLE_PX = 30


def draw_family(env: ObjectNavEnv, episodes: list[Episode]) -> Picture:
    """Returns a picture (h, w, 3) with a row for each episode; the shortest path is drawn from the start to its end."""
    rows = [_row(env, episode) for episode in episodes]
    width = max(row.shape[1] for row in rows)
    padded = [cv2.copyMakeBorder(row, 0, 6, 0, width - row.shape[1], cv2.BORDER_CONSTANT, value=PAPER) for row in rows]
    return np.asarray(np.vstack(padded), np.uint8)


def _row(env: ObjectNavEnv, episode: Episode) -> Picture:
    """Returns the trap from above next to the first frame, below a title."""
    observation, _ = env.reset(seed=0, options={"episode": episode})
    world, task = env.scene.world, env.scene.task
    space = task.truth.space(episode.start.floor_z_m)
    target = task.truth.target(episode.goal, episode.start.floor_z_m)
    top = TopView(world.house, space.frame)
    top.invisible(world)
    path_m = space.path(target.distance_m, episode.start.x_m, episode.start.y_m)
    if path_m is not None:
        places = [(float(x), float(y)) for x, y in path_m]
        top.path(places)
        top.dot(places[-1], END, 7)
    top.dot((episode.start.x_m, episode.start.y_m), START, 7)
    frame = cv2.resize(observation["rgb"], (CAMERA_WIDTH_PX, HEIGHT_PX), interpolation=cv2.INTER_AREA)
    picture = np.hstack([top.image, np.asarray(frame, np.uint8)])
    head = np.full((TITLE_PX, picture.shape[1], 3), PAPER, np.uint8)
    write(head, _title(episode, env.split.sidecar(episode.house).trap), (10, 21), picture.shape[1] - 20, 16, INK, BOLD)
    return np.vstack([head, picture])


def _title(episode: Episode, facts: TrapFacts | None) -> str:
    if facts is None:
        return episode.house
    return (
        f"{episode.house}: gap {facts.gap_m:.2f} m, path {facts.shortest_path_m:.1f} m, "
        f"{facts.open_path_m:.1f} m without what is hidden"
    )
