"""Habitat's ObjectNav files: the one place where its y-up frame and xyzw quaternions are read and written.

Habitat's world is y up and right-handed; an agent without rotation looks along -z. Our world is z up; a heading of 0
looks along +x. Our (x, y, z) is Habitat's (x, z, -y), and our heading of 90 degrees is Habitat's identity rotation.

A split named `val` has the files `val.json.gz` (version, order of the episodes, category ids) and
`content/<house>.json.gz` (episodes and `goals_by_category` with view points), the layout of the ObjectNav challenge
2021.
"""

from __future__ import annotations

import gzip
import io
import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, TypedDict

import msgspec

from sim.core.geometry.pose import Pose
from sim.core.goals import MAX_GOALS, GoalKind, GoalSpec, PictureCamera
from sim.core.interface import GOAL_CATEGORIES, MPCAT40_ID, wrap_angle
from sim.core.reading import Count, Metres, Name, Number, read_gzip_json


class AgentState(TypedDict):
    """A pose as Habitat writes it: position in metres, y up, and quaternion xyzw."""

    position: list[float]
    rotation: list[float]


class ViewPoint(TypedDict):
    """A position from which a goal can be seen."""

    agent_state: AgentState
    iou: float | None


class Goal(TypedDict):
    """A goal instance as the file of a house lists it."""

    position: list[float]
    radius: None
    object_id: int
    """Place of the instance among the labels of its house, from 1: its value in Habitat's semantic images."""
    object_name: str
    """Name of the instance in the house file."""
    object_name_id: None
    object_category: str
    room_id: str | None
    room_name: str | None
    view_points: list[ViewPoint]


def to_position(x_m: float, y_m: float, z_m: float) -> list[float]:
    """Returns a position of the project's frame in Habitat's."""
    return [x_m, z_m, 0.0 - y_m]


def from_position(position: Sequence[float]) -> tuple[float, float, float]:
    """Returns a position of Habitat's frame in the project's frame."""
    x, up, back = position
    return x, 0.0 - back, up


def to_rotation(yaw_rad: float) -> list[float]:
    """Returns a heading as Habitat's quaternion, xyzw."""
    half = 0.5 * (yaw_rad - 0.5 * math.pi)
    return [0.0, math.sin(half), 0.0, math.cos(half)]


def from_rotation(rotation: Sequence[float]) -> float:
    """Returns the heading, in (-pi, pi], of an upright agent with Habitat's quaternion, xyzw."""
    _, y, _, w = rotation
    return wrap_angle(2.0 * math.atan2(y, w) + 0.5 * math.pi)


def to_tilted_rotation(yaw_rad: float, pitch_rad: float) -> tuple[float, float, float, float]:
    """Returns a heading and an angle below the horizontal as Habitat's quaternion, xyzw, of a camera without roll."""
    _, y, _, w = to_rotation(yaw_rad)
    sin, cos = math.sin(-0.5 * pitch_rad), math.cos(0.5 * pitch_rad)
    return w * sin, y * cos, -y * sin, w * cos


def from_tilted_rotation(rotation: Sequence[float]) -> tuple[float, float]:
    """Returns the heading in (-pi, pi] and the angle below the horizontal of Habitat's quaternion, xyzw."""
    x, y, z, w = rotation
    pitch_rad = -2.0 * math.atan2(math.hypot(x, z), math.hypot(y, w))
    sign = math.copysign(1.0, x * w - y * z)
    return wrap_angle(2.0 * math.atan2(y, w) + 0.5 * math.pi), pitch_rad * sign + 0.0


def to_agent_state(pose: Pose) -> AgentState:
    """Returns a pose as an `agent_state` of Habitat."""
    return {"position": to_position(pose.x_m, pose.y_m, pose.floor_z_m), "rotation": to_rotation(pose.yaw_rad)}


def from_agent_state(position: Sequence[float], rotation: Sequence[float]) -> Pose:
    """Returns the pose of an `agent_state` of Habitat in our frame."""
    x, y, z = from_position(position)
    return Pose(x, y, from_rotation(rotation), z)


def goals_key(house: str, goal: str) -> str:
    """Returns the key in `goals_by_category`: the scene's file name and the category."""
    return f"{house}.xml_{goal}"


def category_tables() -> dict[str, dict[str, int]]:
    """Returns the two tables that Habitat's loader needs in each file."""
    return {
        "category_to_task_category_id": {goal: i for i, goal in enumerate(GOAL_CATEGORIES)},
        "category_to_mp3d_category_id": {goal: MPCAT40_ID[goal] for goal in GOAL_CATEGORIES},
    }


class ImageGoal(msgspec.Struct):
    """The camera of a picture of a goal, as Habitat's `InstanceImageParameters` have it."""

    position: tuple[Metres, Metres, Metres]
    rotation: tuple[Number, Number, Number, Number]
    hfov: Annotated[float, msgspec.Meta(gt=0.0, lt=180.0)]
    """Degrees."""
    image_dimensions: tuple[Count, Count]
    """Height and width, pixels."""

    @classmethod
    def of(cls, camera: PictureCamera) -> ImageGoal:
        """Returns a camera in Habitat's form."""
        return cls(
            tuple(to_position(camera.x_m, camera.y_m, camera.z_m)),  # type: ignore[arg-type]
            to_tilted_rotation(camera.yaw_rad, camera.pitch_rad),
            math.degrees(camera.hfov_rad),
            (camera.height_px, camera.width_px),
        )

    @property
    def camera(self) -> PictureCamera:
        """The camera in the project's form."""
        x_m, y_m, z_m = from_position(self.position)
        yaw_rad, pitch_rad = from_tilted_rotation(self.rotation)
        height, width = self.image_dimensions
        return PictureCamera(
            x_m=x_m, y_m=y_m, z_m=z_m, yaw_rad=yaw_rad, pitch_rad=pitch_rad, hfov_rad=math.radians(self.hfov),
            width_px=width, height_px=height,
        )  # fmt: skip


class GoalEntry(msgspec.Struct, omit_defaults=True):
    """Not of Habitat: a goal of a chain, or a picture."""

    text: Name
    kind: GoalKind
    repeats: Count | None = None
    image_goal: ImageGoal | None = None


class EpisodeInfo(msgspec.Struct):
    """The measured part of an episode, and its goals where they are more than a text."""

    geodesic_distance: Annotated[float, msgspec.Meta(ge=0.0, le=1e6)] | None = None
    goals: Annotated[list[GoalEntry], msgspec.Meta(max_length=MAX_GOALS)] = msgspec.field(default_factory=list)


def goals_info(goals: Sequence[GoalSpec]) -> dict[str, object]:
    """Returns the entry of `info` with the goals of an episode; {}: its goal is text alone."""
    entries = [
        GoalEntry(goal.text, goal.kind, goal.repeats, None if goal.camera is None else ImageGoal.of(goal.camera))
        for goal in goals
    ]
    return {"goals": msgspec.to_builtins(entries)} if entries else {}


def goals_of(info: EpisodeInfo) -> tuple[GoalSpec, ...]:
    """Returns the goals in the `info` of an episode.

    Raises:
        EpisodeError: a goal is not allowed.
    """
    return tuple(
        GoalSpec(entry.text, entry.kind, None if entry.image_goal is None else entry.image_goal.camera, entry.repeats)
        for entry in info.goals
    )


class EpisodeEntry(msgspec.Struct):
    """The fields of an episode that are read from a file."""

    episode_id: Name | int
    scene_id: Name
    start_position: tuple[Metres, Metres, Metres]
    start_rotation: tuple[Number, Number, Number, Number]
    object_category: Name
    info: EpisodeInfo = msgspec.field(default_factory=EpisodeInfo)


class EpisodeFile(msgspec.Struct):
    """The file of a house."""

    episodes: list[EpisodeEntry]


class IndexFile(msgspec.Struct):
    """The file of a split."""

    version: Name = "unknown"
    order: list[Name | int] | None = None
    houses_of: Name | None = None
    """Not of Habitat: the folder beside the split's that holds its houses."""
    in_words: bool = False
    """Not of Habitat: goals are in words."""
    pictures: bool = False
    """Not of Habitat: goals are pictures."""


def read_episodes(path: Path) -> list[EpisodeEntry]:
    """Returns the episodes of a house.

    Raises:
        ConfigError: the file is not in Habitat's ObjectNav layout.
    """
    return read_gzip_json(path, EpisodeFile, what="Episode file").episodes


def read_index(path: Path) -> IndexFile:
    """Returns the version of a split and the order of its episodes.

    Raises:
        ConfigError: the file is not in Habitat's ObjectNav layout.
    """
    return read_gzip_json(path, IndexFile, what="Episode file")


def zipped_json(content: Mapping[str, object]) -> bytes:
    """Returns one gzipped JSON object; the same content gives the same bytes."""
    text, raw = json.dumps(content, separators=(",", ":"), allow_nan=False), io.BytesIO()
    with gzip.GzipFile(filename="", mode="wb", fileobj=raw, mtime=0) as file:
        file.write(text.encode("utf-8"))
    return raw.getvalue()
