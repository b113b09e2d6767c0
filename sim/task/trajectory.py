"""Trajectories: the true record of an episode, step by step; recorded, written with `--record`, read back.

A file `trajectories/<episode_id>.npz` holds the arrays of a `Trajectory` and, as JSON, a `Recording`. No pickle; 500
steps are about 10 KB.
"""

from __future__ import annotations

import contextlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import get_args

import msgspec
import numpy as np
from numpy.typing import NDArray

from sim.core.files import episode_file, part_file
from sim.core.geometry.pose import Pose
from sim.core.interface import Action, ConfigError
from sim.core.reading import FARTHEST_M, MAX_BYTES, Metres, parse_json, read_npz, reason_of
from sim.robot.drive import Ended, Motion
from sim.task.result import NO_STOP_TARGET, READ_BY, EndReason, EpisodeResult, StopTarget

FORMAT = 1
"""Version of the file format; it is increased when the arrays change their meaning."""
FOLDER = "trajectories"
ENDED: tuple[str, ...] = get_args(Ended)
"""Meaning of the numbers in `Trajectory.ended`."""


class StartPose(msgspec.Struct, frozen=True):
    """The start of a recorded episode in the world."""

    x_m: Metres
    y_m: Metres
    yaw_rad: float
    floor_z_m: Metres


class SplitName(msgspec.Struct, frozen=True):
    """The split of a recorded episode."""

    name: str
    version: str


class Recording(msgspec.Struct, frozen=True, kw_only=True):
    """The identity of a recorded episode, and its result."""

    profile: str
    noise: str
    split: SplitName
    versions: dict[str, str]
    """Packages, processor, OpenGL renderer and code."""
    start: StartPose
    scores: EpisodeResult
    """The result without times."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Trajectory:
    """An episode of n actions; index i of the poses, shares and distances is the moment before action i."""

    poses: NDArray[np.float32]  # (n + 1, 4)
    """x, y, yaw and floor height in the world; metres and radians."""
    actions: NDArray[np.uint8]  # (n,)
    """Values of `sim.core.interface.Action`."""
    ended: NDArray[np.uint8]  # (n,)
    """Reason why each motion ended: index into `ENDED`."""
    collided: NDArray[np.bool_]  # (n,)
    """True: a contact of the body stopped the motion."""
    touched: NDArray[np.bool_]  # (n,)
    """True: the body was in contact, whether or not that stopped the motion."""
    goal_share: NDArray[np.float32]  # (n + 1,)
    """Share of the frame that the goal's true mask covers, in [0, 1]; nan: there was no frame."""
    distance_m: NDArray[np.float32]  # (n + 1,)
    """Geodesic distance to the nearest place where a STOP succeeds; nan: no path."""
    duration_s: NDArray[np.float32]  # (n,)
    """Simulated time of each action."""
    contacts: NDArray[np.float32]  # (m, 3)
    """Contacts that stopped a motion: number of the action, x and y in the world, metres."""
    goal_on_storey: bool
    """True: the storey of the start has an instance."""
    nearest_instance_m: float | None
    """Metres in plan from the end of the episode to the nearest instance, walls ignored; None: storey has none."""
    success: bool
    end_reason: EndReason | None
    """None: the episode still runs."""
    stop: StopTarget = NO_STOP_TARGET
    about: Recording | None = None
    """None: the trajectory was not read from a run."""

    @property
    def num_steps(self) -> int:
        """Number of actions, STOP included."""
        return len(self.actions)

    @property
    def positions_m(self) -> NDArray[np.float32]:
        """x and y of the robot's centre, (n + 1, 2)."""
        return self.poses[:, :2]

    @property
    def moved_m(self) -> NDArray[np.float64]:
        """Displacement of each action in plan, (n,) metres."""
        return np.hypot(*np.diff(self.positions_m.astype(np.float64), axis=0).T)


_ARRAYS: Mapping[str, tuple[type, int, int]] = {
    "poses": (np.float32, 2, 1),
    "actions": (np.uint8, 1, 0),
    "ended": (np.uint8, 1, 0),
    "collided": (np.bool_, 1, 0),
    "touched": (np.bool_, 1, 0),
    "goal_share": (np.float32, 1, 1),
    "distance_m": (np.float32, 1, 1),
    "duration_s": (np.float32, 1, 0),
}
"""Dtype, number of axes, and number of entries beyond the number of actions."""


class Recorder:
    """Collects a trajectory while an episode runs."""

    def __init__(self, start: Pose, *, distance_m: float | None, goal_on_storey: bool) -> None:
        self._goal_on_storey = goal_on_storey
        self._poses = [(start.x_m, start.y_m, start.yaw_rad, start.floor_z_m)]
        self._shares = [np.nan]
        self._distances_m = [_or_nan(distance_m)]
        self._motions: list[Motion] = []

    def look(self, goal_share: float) -> None:
        """Records the share of the goal in the frame at the robot's current pose."""
        self._shares[-1] = goal_share

    def move(self, motion: Motion, pose: Pose, distance_m: float | None) -> None:
        """Records one action that was carried out."""
        self._motions.append(motion)
        self._poses.append((pose.x_m, pose.y_m, pose.yaw_rad, pose.floor_z_m))
        self._shares.append(np.nan)
        self._distances_m.append(_or_nan(distance_m))

    def trajectory(
        self,
        *,
        success: bool = False,
        end_reason: EndReason | None = None,
        nearest_instance_m: float | None = None,
        stop: StopTarget = NO_STOP_TARGET,
    ) -> Trajectory:
        """Returns the trajectory so far."""
        stops = [
            (step, *contact.position_m[:2])
            for step, motion in enumerate(self._motions)
            for contact in motion.contacts
            if contact.stopped
        ]
        return Trajectory(
            poses=np.array(self._poses, np.float32),
            actions=np.array([motion.action for motion in self._motions], np.uint8),
            ended=np.array([ENDED.index(motion.ended) for motion in self._motions], np.uint8),
            collided=np.array([motion.collided for motion in self._motions], np.bool_),
            touched=np.array([bool(motion.contacts) for motion in self._motions], np.bool_),
            duration_s=np.array([motion.duration_s for motion in self._motions], np.float32),
            goal_share=np.array(self._shares, np.float32),
            distance_m=np.array(self._distances_m, np.float32),
            contacts=np.array(stops, np.float32).reshape(-1, 3),
            goal_on_storey=self._goal_on_storey,
            nearest_instance_m=nearest_instance_m,
            success=success,
            end_reason=end_reason,
            stop=stop,
        )


def by_action(trajectory: Trajectory, steps: int) -> Trajectory:
    """Returns a trajectory of short steps as one of actions that take `steps` of them each; the last one is whole.

    A moment of the result is one of the given trajectory; what an action touched is what any of its steps did.
    """
    count = trajectory.num_steps
    if steps == 1 or count == 0:
        return trajectory
    moments = np.unique(np.append(np.arange(count, -1, -steps), 0))
    begins = moments[:-1]
    return replace(
        trajectory,
        poses=trajectory.poses[moments],
        goal_share=trajectory.goal_share[moments],
        distance_m=trajectory.distance_m[moments],
        actions=trajectory.actions[moments[1:] - 1],
        ended=trajectory.ended[moments[1:] - 1],
        collided=np.logical_or.reduceat(trajectory.collided, begins),
        touched=np.logical_or.reduceat(trajectory.touched, begins),
        duration_s=np.add.reduceat(trajectory.duration_s, begins),
    )


def joined(parts: Sequence[Trajectory]) -> Trajectory:
    """Returns the trajectories of the goals of a chain as one; the moment between two goals is that of the later one.

    What is known only of the end is that of the last goal.
    """
    last, actions = parts[-1], np.cumsum([0, *(part.num_steps for part in parts)])
    if len(parts) == 1:
        return last
    numbered = [part.contacts + np.array([step, 0, 0], np.float32) for step, part in zip(actions, parts, strict=False)]
    arrays = {
        name: np.concatenate([*(getattr(part, name)[: part.num_steps] for part in parts[:-1]), getattr(last, name)])
        for name in _ARRAYS
    }
    return replace(last, **arrays, contacts=np.concatenate(numbered).astype(np.float32))


def trajectory_file(run: Path, episode_id: str) -> Path:
    """Returns the file of an episode's trajectory in a run."""
    return episode_file(run / FOLDER, episode_id, ".npz")


def write_trajectory(file: Path, trajectory: Trajectory, about: Recording | None) -> None:
    """Writes one file, completely or not at all.

    Args:
        file: its folder is created.
        trajectory: of one episode.
        about: identity and result of the episode; None: unknown.

    Raises:
        ConfigError: the file cannot be written.
    """
    scalars = _Scalars(
        goal_on_storey=trajectory.goal_on_storey,
        nearest_instance_m=trajectory.nearest_instance_m,
        success=trajectory.success,
        end_reason=trajectory.end_reason,
        **msgspec.structs.asdict(trajectory.stop),
    )
    text = msgspec.json.encode(_Header(format=FORMAT, scalars=scalars, about=about))
    arrays = {name: getattr(trajectory, name) for name in (*_ARRAYS, "contacts")}
    part = part_file(file, what="trajectory")
    try:
        with part.open("wb") as stream:
            np.savez_compressed(stream, about=np.frombuffer(text, np.uint8), **arrays)
        part.replace(file)
    except OSError as error:
        raise ConfigError(f"Cannot write the trajectory '{file}': {error.strerror}.") from None
    finally:  # the partial file is left only by a write that failed
        with contextlib.suppress(OSError):
            part.unlink()


def read_trajectory(file: Path) -> Trajectory:
    """Returns the trajectory in a file.

    Raises:
        ConfigError: there is no such file, or it is not a trajectory.
    """
    if not file.is_file():
        raise ConfigError(f"There is no trajectory '{file}': it is written with --record.")
    arrays = read_npz(file, what="trajectory", most_bytes=MAX_BYTES)
    names = (*_ARRAYS, "contacts", "about")
    missing = next((name for name in names if name not in arrays), None)
    if missing is not None:
        raise ConfigError(
            f"'{file}' is not a trajectory: it has no '{missing}'; version {READ_BY} reads files of an older format."
        )
    arrays = {name: arrays[name] for name in names}
    try:
        header = parse_json(arrays.pop("about").tobytes(), _Header, where="its header 'about'")
        if header.format != FORMAT:
            raise ValueError(f"its format is {header.format}, this program reads {FORMAT}")
        scalars = header.scalars
        stop = StopTarget(**{name: getattr(scalars, name) for name in StopTarget.__struct_fields__})
        trajectory = Trajectory(
            **arrays,
            goal_on_storey=scalars.goal_on_storey,
            nearest_instance_m=scalars.nearest_instance_m,
            success=scalars.success,
            end_reason=scalars.end_reason,
            stop=stop,
            about=header.about,
        )
        _check(trajectory)
    except ValueError as error:
        raise ConfigError(f"'{file}' is not a trajectory: {reason_of(error)}.") from None
    return trajectory


class _Scalars(StopTarget, frozen=True, kw_only=True):
    goal_on_storey: bool
    nearest_instance_m: Metres | None
    success: bool
    end_reason: EndReason | None


class _Header(msgspec.Struct):
    """The JSON in `about`."""

    format: int
    scalars: _Scalars
    about: Recording | None


def _check(trajectory: Trajectory) -> None:
    """Raises ValueError if the arrays do not fit each other, or hold numbers without meaning."""
    count = trajectory.actions.size
    for name, (kind, axes, more) in _ARRAYS.items():
        array = getattr(trajectory, name)
        if array.dtype != kind or array.ndim != axes or len(array) != count + more:
            raise ValueError(f"{name} is {array.dtype} {array.shape} for {count} actions")
    if not np.isfinite(trajectory.duration_s).all():
        raise ValueError("duration_s holds NaN or infinity")
    if trajectory.contacts.dtype.kind != "f":
        raise ValueError(f"contacts is {trajectory.contacts.dtype}")
    if trajectory.poses.shape[1:] != (4,) or trajectory.contacts.shape[1:] != (3,):
        raise ValueError(f"poses are {trajectory.poses.shape}, contacts {trajectory.contacts.shape}")
    for name in ("poses", "contacts"):
        if not bool((np.abs(getattr(trajectory, name)) <= FARTHEST_M).all()):
            raise ValueError(f"{name} hold NaN, infinity or a number beyond {FARTHEST_M:g}")
    if np.any(trajectory.actions >= len(Action)) or np.any(trajectory.ended >= len(ENDED)):
        raise ValueError("an action or the reason of its end is out of range")


def _or_nan(value: float | None) -> float:
    return np.nan if value is None else value
