"""Pictures of traps: a trial with the robot's true path and the agent's map, and the traps of a family."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.app.commands.traps.trial import Trial
from sim.app.viewers.chase import hidden_obstacles
from sim.app.viewers.text import BOLD, text_width, write
from sim.app.viewers.topview import TopView
from sim.app.viewers.viewer import Colour
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.episode import Episode
from sim.houses.geoms import geom_polytope
from sim.houses.sidecar import TrapFacts

Picture = NDArray[np.uint8]
HEIGHT_PX = 480
HEAD_PX, FOOT_PX = 32, 26
"""Height of the title above the plan and of the legend below it."""
INVISIBLE: Colour = (20, 160, 225)
"""Colour of obstacles that cameras do not render."""
LEGEND = (*TopView.legend[:-1], ("invisible", INVISIBLE))
PAPER, INK = (245, 245, 245), (30, 30, 30)
CAMERA_WIDTH_PX = HEIGHT_PX * 4 // 3
TITLE_PX = 30
"""Height of the title of a trap of a family."""


def draw_trial(env: ObjectNavEnv, trial: Trial, belief: Picture | None) -> Picture:
    """Returns the plan and, if there is a map, the map next to it, uint8 (h, w, 3), between title and legend."""
    picture = plan_of(env)
    if belief is not None:
        width = round(belief.shape[1] * HEIGHT_PX / belief.shape[0])
        small = np.asarray(cv2.resize(belief, (width, HEIGHT_PX), interpolation=cv2.INTER_AREA), np.uint8)
        picture = np.hstack([picture, small])
    outcome = "escaped" if trial.escaped else "stuck"
    title = f"{trial.episode_id}, {trial.agent}: {outcome}, {len(trial.motions)} steps"
    return _framed(picture, title)


def plan_of(env: ObjectNavEnv) -> Picture:
    """Returns the plan of the running episode (`TopView`), uint8 (HEIGHT_PX, w, 3), with the invisible obstacles."""
    world = env.scene.world
    rows, columns = env.scene.task.truth.space(env.episode.start.floor_z_m).frame.shape
    view = TopView(env)
    image = view.draw(round(HEIGHT_PX * columns / rows), HEIGHT_PX)
    for geom in np.flatnonzero(hidden_obstacles(world)).tolist():
        corners_m = geom_polytope(world.model, world.data, geom).vertices_m
        cv2.polylines(image, [cv2.convexHull(view.pixels(corners_m[:, :2]))], True, INVISIBLE, 1, cv2.LINE_AA)
    return image


def _framed(picture: Picture, title: str) -> Picture:
    """Returns a picture with a title above it and the legend of the plan below it."""
    wide = picture.shape[1]
    head, foot = (np.full((high, wide, 3), PAPER, np.uint8) for high in (HEAD_PX, FOOT_PX))
    write(head, title, (10, 22), wide - 20, 18, INK, BOLD)
    x_px = 10
    for words, colour in LEGEND:
        cv2.circle(foot, (x_px + 6, FOOT_PX // 2), 6, colour, -1, cv2.LINE_AA)
        write(foot, words, (x_px + 18, 18), wide - x_px, 14, INK)
        x_px += 38 + text_width(words, 14)
    return np.vstack([head, picture, foot])


def draw_family(env: ObjectNavEnv, episodes: list[Episode]) -> Picture:
    """Returns a picture (h, w, 3) with a row for each episode."""
    rows = [_row(env, episode) for episode in episodes]
    width = max(row.shape[1] for row in rows)
    padded = [cv2.copyMakeBorder(row, 0, 6, 0, width - row.shape[1], cv2.BORDER_CONSTANT, value=PAPER) for row in rows]
    return np.asarray(np.vstack(padded), np.uint8)


def _row(env: ObjectNavEnv, episode: Episode) -> Picture:
    """Returns the plan of the trap next to the first frame, below a title."""
    observation, _ = env.reset(seed=0, options={"episode": episode})
    frame = cv2.resize(observation["rgb"], (CAMERA_WIDTH_PX, HEIGHT_PX), interpolation=cv2.INTER_AREA)
    picture = np.hstack([plan_of(env), np.asarray(frame, np.uint8)])
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
