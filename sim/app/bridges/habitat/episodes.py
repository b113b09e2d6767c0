"""Converts episodes to the form of Habitat's `ObjectGoalNavEpisode`, for evaluation scripts that read them."""

from __future__ import annotations

import functools
from dataclasses import dataclass, field
from pathlib import Path

import msgspec

from sim.app.bridges.habitat_client import Config, to_config
from sim.core.reading import read_gzip_json
from sim.episodes import habitat
from sim.episodes.episode import Episode
from sim.episodes.splits import Split


@dataclass(frozen=True, kw_only=True)
class ObjectGoal:
    """An instance of the goal category, as in the episode files."""

    object_id: str
    object_category: str
    position: list[float]
    """Centre of the instance in Habitat's frame: y up, metres."""
    view_points: list[Config] = field(default_factory=list)
    """Positions at which a STOP succeeds, as attributes or keys: `agent_state.position` and `.rotation`."""

    @property
    def object_name(self) -> str:
        """The name of the instance."""
        return self.object_id


@dataclass(frozen=True, kw_only=True)
class ObjectGoalNavEpisode:
    """An episode with Habitat's field names. Positions have y up; rotations are quaternions xyzw."""

    episode_id: str
    scene_id: str
    start_position: list[float]
    start_rotation: list[float]
    object_category: str
    info: dict[str, object]
    """`geodesic_distance`: recorded length of the shortest path, metres; None: unknown."""
    goals_file: Path
    """The file of the house's episodes and goals; it does not exist for episodes that are drawn in a house file."""

    @property
    def goals_key(self) -> str:
        """The key of the goals in the episode files."""
        return habitat.goals_key(Path(self.scene_id).stem, self.object_category)

    @functools.cached_property
    def goals(self) -> list[ObjectGoal]:
        """The instances of the goal category that the house's file lists; empty if there is no such file.

        Raises:
            ConfigError: the file has another format.
        """
        if not self.goals_file.is_file():
            return []
        content = read_gzip_json(self.goals_file, _GoalsFile, what="Episode file")
        return [
            ObjectGoal(
                object_id=str(goal.object_id),
                object_category=goal.object_category,
                position=goal.position,
                view_points=[to_config(place) for place in goal.view_points],
            )
            for goal in content.goals_by_category.get(self.goals_key, [])
        ]


class _GoalEntry(msgspec.Struct):
    """The fields of a goal that are read."""

    object_id: str | int
    object_category: str
    position: list[float]
    view_points: list[dict[str, object]] = msgspec.field(default_factory=list)


class _GoalsFile(msgspec.Struct):
    """The part of a house's file that lists goals."""

    goals_by_category: dict[str, list[_GoalEntry]] = msgspec.field(default_factory=dict)


def to_habitat(split: Split, episode: Episode) -> ObjectGoalNavEpisode:
    """Returns an episode of a split in Habitat's form."""
    state = habitat.to_agent_state(episode.start)
    return ObjectGoalNavEpisode(
        episode_id=episode.episode_id,
        scene_id=f"mjcf_houses/{split.name}/{episode.house}.xml",
        start_position=state["position"],
        start_rotation=state["rotation"],
        object_category=episode.goal,
        info={"geodesic_distance": episode.shortest_path_m},
        goals_file=split.house_paths[episode.house].parent / "content" / f"{episode.house}.json.gz",
    )
