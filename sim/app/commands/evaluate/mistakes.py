"""Shows what the network saw in failed episodes: at the STOP or, without one, in the frame with most of the goal.

    stubborn run --episodes 100 --record --out runs/mine
    stubborn evaluate mistakes runs/mine --out runs/false.png
    stubborn evaluate mistakes runs/mine --cause missed_detection --out runs/missed.png

One row per episode: the camera image, the true categories, those of the segmentation (a network of this project or
your own), and its score of the goal (white 0, red 1). No episode is run again: the house is rendered from the recorded
pose, without sensor noise and with movable objects at their start positions. One cause of failure is drawn; the last
line of the output names the others.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import tyro
from numpy.typing import NDArray

from sim.app import cli
from sim.app.analysis.comparison import Run, read_run
from sim.app.analysis.report.drawings import split_of
from sim.app.commands.evaluate.own import segmenter_for
from sim.app.composition.own_segmentation import OwnSegmenter
from sim.app.composition.segmenters import file_sha256, weights_file
from sim.app.evaluation.results import own_weights
from sim.app.viewers.palette import with_legend
from sim.core.configuration import with_fields
from sim.core.files import write_picture
from sim.core.geometry.pose import Pose
from sim.core.interface import MPCAT40, CameraModel, ConfigError
from sim.core.pictures import tiled
from sim.core.vocabulary import counted
from sim.renderer.camera import Camera
from sim.robot.config import RobotConfig
from sim.task.failures import CAUSES
from sim.task.result import EpisodeResult
from sim.task.trajectory import Trajectory, read_trajectory, trajectory_file
from sim.world.world import World
from stubborn.segmentation.network import NetworkSegmenter

Picture = NDArray[np.uint8]
PANEL_PX = 320
CAPTION_PX = 22
HEADINGS = ("camera", "true categories", "predicted categories", "score of the goal")
"""Titles of the panels, above the first row."""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Draw failures of a run with a network or a segmentation of your own, and --record."""

    run: tyro.conf.Positional[Path]
    """Folder of the run."""
    out: cli.OutPicture
    """The picture, a .png or .jpg file."""
    cause: str = "false_detection"
    """Cause of the failures to draw (sim/task/failures.py)."""
    count: cli.Count = 10
    """Largest number of failures; the first ones are drawn."""


def main(args: Args) -> int:
    """Draws the sheet and prints a sentence per row; returns the exit status, 1 if there is no such failure."""
    if args.cause not in CAUSES:
        raise ConfigError(f"--cause must be one of {', '.join(CAUSES)}, got '{args.cause}'.")
    run = read_run(args.run)
    segmenter = segmenter_of(run)
    split = split_of(run)
    failed = [result for result in run.results.values() if result.failure is not None and not result.is_error]
    recorded = [result for result in failed if trajectory_file(run.path, result.episode_id).is_file()]
    picked = [result for result in recorded if result.failure == args.cause]
    if not picked:
        print(f"No recorded episode of '{args.run}' failed by {args.cause}.{_others(recorded, args.cause)}")
        return 1
    available, picked = len(picked), picked[: args.count]
    rows: list[Picture] = []
    for result in sorted(picked, key=lambda result: result.house):
        trajectory = read_trajectory(trajectory_file(run.path, result.episode_id))
        step = decisive_step(trajectory)
        images = render_at(World(split.load_house(result.house)), trajectory.poses[step])
        row, words = draw(images, segmenter, result.goal)
        about = f"{result.episode_id} {result.goal}, step {step}: {words}"
        print(about)
        rows.append(_captioned(row, about))
    write_picture(args.out, np.vstack([_headings(rows[0].shape[1]), tiled(rows, columns=1)], dtype=np.uint8))
    of = f" of {available} (--count {available} draws all)" if available > len(rows) else ""
    drawn = f"{counted(len(rows), 'episode')}{of} that failed by {args.cause}, in {args.out}."
    print(f"{drawn}{_others(recorded, args.cause)}")
    return 0


def segmenter_of(run: Run) -> NetworkSegmenter | OwnSegmenter:
    """Returns the segmenter of a run; prints a sentence if its network computes in another precision here.

    Raises:
        ConfigError: the run had another robot or camera than ours, its agent acted on neither a network nor a
            segmentation of the user, or its weights have been deleted or replaced.
    """
    tree, semantics = run.config.get("config", {}), str(run.config.get("semantics"))
    robot = {name: value for name, value in tree.get("robot", {}).items() if name != "motion"}  # it changes no picture
    if run.config.get("robot"):
        raise ConfigError(f"'{run.path}' was run with another robot; views are rendered for the default one.")
    for part, ours, used in (("camera", CameraModel(), tree.get("camera", {})), ("robot", RobotConfig(), robot)):
        if with_fields(ours, used) != ours:
            raise ConfigError(f"'{run.path}' had another {part} than ours; views are drawn with ours.")
    declared = run.config.get("segmentation")
    if declared is not None and declared.keys() == {"name"}:  # no declaration of a source of `--semantics`
        raise ConfigError(
            f"The agent of '{run.path}' did not use --semantics; its segmentation is {declared['name'] or 'none'}."
        )
    if ":" in semantics:
        settings = run.config.get("settings", {})
        of_detector = {name: value for name, value in settings.items() if name.startswith("detector.")}
        return segmenter_for(semantics, CameraModel(), of_detector)
    if semantics != "rednet":
        raise ConfigError(f"'{run.path}' was run with --semantics {semantics}, without a network.")
    detector = tree.get("detector") or {}
    own = own_weights(run.config)
    file = weights_file(Path(own) if own else None)
    checksum = run.config.get("files_sha256", {}).get("weights")
    if checksum is not None and checksum != file_sha256(file):
        raise ConfigError(f"'{run.path}' was run with other weights than '{file}' holds now.")
    network = NetworkSegmenter.from_file(
        file, temperature=detector.get("temperature"), mirrored=detector.get("mirrored", False)
    )
    before = (run.config.get("segmentation") or {}).get("precision")
    here = "bf16" if network.bf16 else "fp32"
    if before not in (None, here):
        print(f"The network computed in {before} in the run and computes in {here} here; its scores differ slightly.")
    return network


def _others(recorded: Sequence[EpisodeResult], cause: str) -> str:
    """Returns a sentence on the recorded failures by other causes; "" if there are no such failures."""
    others = Counter(result.failure for result in recorded if result.failure != cause)
    if not others:
        return ""
    named = ", ".join(f"--cause {name} ({count})" for name, count in others.most_common())
    return f" Failures by other causes are drawn with {named}."


def decisive_step(trajectory: Trajectory) -> int:
    """Returns the number of the frame to show: that of the STOP, or else the frame with most of the goal."""
    if trajectory.end_reason == "stop":
        return trajectory.num_steps
    return int(np.argmax(np.nan_to_num(trajectory.goal_share, nan=-1.0)))


def render_at(world: World, pose: Sequence[float] | NDArray[np.floating]) -> dict[str, NDArray]:
    """Returns colour, depth and categories from the pose (x, y, yaw, floor height)."""
    x_m, y_m, yaw_rad, floor_z_m = (float(value) for value in pose)
    camera = Camera(world.model, world.labels)
    images = camera.render(world.data, Pose(x_m, y_m, yaw_rad, floor_z_m), ("rgb", "depth", "semantic"))
    camera.close()
    return images


def draw(images: dict[str, NDArray], segmenter: NetworkSegmenter | OwnSegmenter, goal: str) -> tuple[Picture, str]:
    """Returns one row of panels, and a text with the true categories where the segmenter sees the goal.

    A goal in words or in a picture has no score: the last panel stays white.
    """
    size = (PANEL_PX, PANEL_PX * images["rgb"].shape[0] // images["rgb"].shape[1])
    guess, scored = segmenter.categories(images), goal in MPCAT40
    score = segmenter.scores(images, goal).target if scored else np.zeros(images["semantic"].shape, np.float32)
    guess = np.zeros_like(score, np.uint8) if guess is None else guess  # a segmenter of scores alone
    labels = [
        with_legend(np.asarray(cv2.resize(of, size, interpolation=cv2.INTER_NEAREST), np.uint8))
        for of in (images["semantic"], guess)
    ]
    faint = cv2.resize(255.0 * (1.0 - score), size)
    heat = np.dstack([np.full_like(faint, 255.0), faint, faint]).astype(np.uint8)
    rgb = np.asarray(cv2.resize(images["rgb"], size, interpolation=cv2.INTER_AREA), np.uint8)
    text = in_words(images["semantic"], score) if scored else "this goal has no score"
    return np.hstack([rgb, *labels, heat], dtype=np.uint8), text


def in_words(semantic: NDArray[np.uint8], score: NDArray[np.float32]) -> str:
    """Returns the true categories where the score of the goal is above 0.5, the largest first, or the highest score."""
    every = semantic.shape[0] // score.shape[0]
    true = semantic[every // 2 :: every, every // 2 :: every][score > 0.5]
    if true.size == 0:
        return f"nothing scored above 0.5, at most {score.max():.2f}"
    shares = np.bincount(true, minlength=len(MPCAT40)) / true.size
    named = [f"{MPCAT40[i]} {shares[i]:.0%}" for i in np.argsort(-shares)[:3] if shares[i] >= 0.05]
    return f"taken for it: {', '.join(named)}"


def _headings(width: int) -> Picture:
    """Returns a strip with the titles of the panels."""
    strip = np.full((CAPTION_PX, width, 3), 255, np.uint8)
    for place, words in enumerate(HEADINGS):
        left_px = place * width // len(HEADINGS) + 6
        cv2.putText(strip, words, (left_px, 16), cv2.FONT_HERSHEY_SIMPLEX, 0.5, (0, 0, 0), 1, cv2.LINE_AA)
    return strip


def _captioned(row: Picture, words: str) -> Picture:
    caption = np.full((CAPTION_PX, row.shape[1], 3), 255, np.uint8)
    cv2.putText(caption, words, (6, 16), cv2.FONT_HERSHEY_SIMPLEX, 0.48, (30, 30, 30), 1, cv2.LINE_AA)
    return np.vstack([caption, row], dtype=np.uint8)
