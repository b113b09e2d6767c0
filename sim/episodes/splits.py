"""Episodes of a split: which house, which goal, from where, and in which order.

A split is a folder of house files with its episodes beside them in Habitat's ObjectNav layout (see `sim.episodes.habitat`):
`val/<house>.xml`, `val/val.json.gz`, `val/content/<house>.json.gz`. In place of house files it may have a list of
recipes, `train/houses.json` (see `sim.housegen.recipes`); such houses are made when they are first needed.

`val/unreachable.json` names the things that no episode asks for since no place of the free space reaches them.
"""

from __future__ import annotations

import difflib
import hashlib
import json
import reprlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from sim.episodes import habitat
from sim.errors import EpisodeError, HouseError
from sim.geometry.pose import Pose
from sim.housegen.recipes import HouseList, has_house_list, read_house_list
from sim.houses.house import House
from sim.houses.load import load_house
from sim.houses.sidecar import NOTHING_FIXED, Sidecar, read_sidecar, sidecar_path
from sim.interface import GOAL_CATEGORIES, ConfigError
from sim.paths import assets_dir

T = TypeVar("T")
UNREACHABLE_FILE = "unreachable.json"


@dataclass(frozen=True)
class Episode:
    """One search: start here in this house, find one of these."""

    episode_id: str
    house: str
    """Name of the house within its split."""
    goal: str
    start: Pose
    shortest_path_m: float | None = None
    """Geodesic distance from the start to the nearest place that satisfies success, as recorded; None: unknown."""


@dataclass(frozen=True)
class Split:
    """Houses and the episodes in them, in the order in which they count."""

    name: str
    version: str
    """Raised when a house or an episode of the split changes, so that results name what they were made on."""
    sha256: str
    """Over the house files, their sidecars and the episodes; of listed houses, over their checksums."""
    house_paths: Mapping[str, Path]
    """Where each house lies; a listed one perhaps not yet (`house_file`)."""
    episodes: tuple[Episode, ...]
    labels_path: Path | None = None
    house_list: HouseList | None = None
    """Makes the houses that are shipped as a list."""

    @property
    def houses(self) -> tuple[str, ...]:
        """Names of the houses."""
        return tuple(self.house_paths)

    def house_file(self, name: str) -> Path:
        """The file of the house of that name, made now if it is only listed.

        Raises:
            HouseError: there is none, or it cannot be made here.
        """
        if name not in self.house_paths:
            there_is = reprlib.repr(list(self.houses)) if len(self.houses) > 40 else ", ".join(self.houses)
            raise HouseError(f"Split '{self.name}' has no house '{name}'. It has: {there_is}.")
        return self.house_paths[name] if self.house_list is None else self.house_list.fetch(name)

    def load_house(self, name: str) -> House:
        """The house of that name.

        Raises:
            HouseError: there is none, it cannot be made here, or it breaks the house format.
        """
        return load_house(self.house_file(name), labels_path=self.labels_path)

    def sidecar(self, house: str) -> Sidecar:
        """What the file beside a house fixes; nothing where there is none, or where it holds the label rules.

        Raises:
            HouseError: it breaks the form of `sim.houses.sidecar`.
        """
        path = self.house_paths[house]
        is_rules = self.labels_path is not None and self.labels_path.resolve() == sidecar_path(path).resolve()
        return NOTHING_FIXED if is_rules else read_sidecar(path)

    def episode(self, episode_id: str) -> Episode:
        """The episode of that id.

        Raises:
            EpisodeError: there is none.
        """
        for episode in self.episodes:
            if episode.episode_id == episode_id:
                return episode
        near = difflib.get_close_matches(episode_id, [episode.episode_id for episode in self.episodes], n=1)
        hint = f" Did you mean '{near[0]}'?" if near else ""
        raise EpisodeError(f"Split '{self.name}' has no episode '{episode_id}'.{hint}")


def shipped_splits() -> tuple[str, ...]:
    """Names of the splits that come with the package."""
    return tuple(sorted(folder.name for folder in assets_dir().iterdir() if _index_of(folder).is_file()))


def load_split(name_or_path: str | Path) -> Split:
    """A shipped split by name, or a folder laid out like one.

    Raises:
        ConfigError: there is no such split or folder, or its files are not what they should be.
    """
    shipped = shipped_splits()
    folder = assets_dir() / name_or_path if str(name_or_path) in shipped else Path(name_or_path)
    if not folder.is_dir():
        there_is = ", ".join(shipped) or "none"
        raise ConfigError(f"Unknown split '{name_or_path}': neither a shipped one (there is: {there_is}) nor a folder.")
    folder = folder.resolve()
    if not _index_of(folder).is_file():
        raise ConfigError(
            f"Split '{folder}' has no {_index_of(folder).name}: a split is a folder of house files with its episodes "
            "beside them (tools/make_episodes.py makes them)."
        )
    return _read_split(folder)


def one_house(path: str | Path, *, labels: str | Path | None = None) -> Split:
    """A split of one house file and no episodes: they are drawn.

    Raises:
        HouseError: there is no such file.
    """
    path = Path(path)
    if not path.is_file():
        raise HouseError(f"House '{path}': there is no such file.")
    labels_path = None if labels is None else Path(labels)
    digest = hashlib.sha256(path.read_bytes() + _sidecar_bytes(path))
    if labels_path is not None and labels_path.is_file():
        digest.update(labels_path.read_bytes())
    return Split(path.stem, "one-house", digest.hexdigest(), {path.stem: path}, (), labels_path)


def write_split(
    folder: Path,
    episodes: Sequence[Episode],
    goals_by_house: Mapping[str, Mapping[str, list[dict[str, Any]]]],
    *,
    version: str,
    unreachable: Mapping[str, Sequence[str]] | None = None,
) -> None:
    """Write the episodes of the houses in a folder beside them, in Habitat's layout; replaces those that are there.

    Args:
        folder: the split's folder, which holds the house files; its name is the split's.
        episodes: in the order in which they count; it is written down.
        goals_by_house: for each house, for each goal category, Habitat's goals (`sim.episodes.habitat`).
        version: of the split.
        unreachable: for each house, names of the goal instances that cannot be reached; None: nobody looked.
    """
    for stale in (folder / "content").glob("*.json.gz"):
        stale.unlink()
    if unreachable is not None:
        _write_unreachable(folder / UNREACHABLE_FILE, unreachable)
    index = {"version": version, "order": [episode.episode_id for episode in episodes], "episodes": []}
    habitat.write_json(_index_of(folder), habitat.category_tables() | index)
    for house, goals in goals_by_house.items():
        content = habitat.category_tables() | {
            "goals_by_category": {habitat.goals_key(house, goal): listed for goal, listed in goals.items()},
            "episodes": [_to_habitat(folder.name, episode) for episode in episodes if episode.house == house],
        }
        habitat.write_json(folder / "content" / f"{house}.json.gz", content)


def read_unreachable(folder: Path) -> dict[str, tuple[str, ...]]:
    """For each house of a split, the goal instances that cannot be reached; empty where nobody looked.

    Raises:
        ConfigError: the file is not what `write_split` writes.
    """
    file = folder / UNREACHABLE_FILE
    if not file.is_file():
        return {}
    try:
        content = json.loads(file.read_text(encoding="utf-8"))
        return {house: tuple(names) for house, names in content.items()}
    except (AttributeError, TypeError, ValueError) as error:
        raise ConfigError(f"'{file}' is no JSON object of lists: {error!r}.") from None


def _write_unreachable(file: Path, unreachable: Mapping[str, Sequence[str]]) -> None:
    """One house a line, those without such things left out."""
    lines = ",".join(
        f"\n{json.dumps(house)}: {json.dumps(list(names))}" for house, names in unreachable.items() if names
    )
    file.write_text(f"{{{lines}\n}}\n", encoding="utf-8")


def _index_of(folder: Path) -> Path:
    return folder / f"{folder.name}.json.gz"


def _read_split(folder: Path) -> Split:
    """The split in a folder that has an index."""
    index_file = _index_of(folder)
    index = _parsed(index_file, lambda content: content)
    episodes: dict[str, Episode] = {}
    for file in sorted((folder / "content").glob("*.json.gz")):
        episodes |= _parsed(file, _episodes_of)
    ordered = _parsed(index_file, lambda content: tuple(episodes[i] for i in content.get("order", sorted(episodes))))
    house_list = read_house_list(folder) if has_house_list(folder) else None
    houses = house_list.paths if house_list else {path.stem: path for path in sorted(folder.glob("*.xml"))}
    missing = sorted({episode.house for episode in ordered} - set(houses))
    if missing:
        where = "no such house in its list" if house_list else f"no {missing[0]}.xml"
        raise ConfigError(f"Split '{folder}' has episodes in '{missing[0]}' but {where}.")
    version = str(index.get("version", "unknown"))
    if house_list and house_list.version != version:
        raise ConfigError(
            f"Split '{folder}' has episodes of version {version} but a list of houses of version {house_list.version}: "
            "make both anew (tools/generate_houses.py, tools/make_episodes.py)."
        )
    sha256 = _sha256(house_list.sha256 if house_list else _file_sums(houses), ordered)
    return Split(folder.name, version, sha256, houses, ordered, house_list=house_list)


def _parsed(file: Path, parse: Callable[[habitat.Json], T]) -> T:
    """What `parse` makes of a file, or a sentence that names the file."""
    try:
        return parse(habitat.read_json(file))
    except (AttributeError, KeyError, TypeError, ValueError, OSError, EOFError) as error:
        raise ConfigError(f"Episode file '{file}' is not in Habitat's ObjectNav layout: {error!r}.") from None


def _episodes_of(content: habitat.Json) -> dict[str, Episode]:
    episodes = [_from_habitat(entry) for entry in content["episodes"]]
    return {episode.episode_id: episode for episode in episodes}


def _sha256(sums: Mapping[str, str], episodes: Sequence[Episode]) -> str:
    """Over the names and checksums of the houses and over the episodes."""
    digest = hashlib.sha256(json.dumps(dict(sums)).encode())
    digest.update(json.dumps([_to_habitat("", episode) for episode in episodes]).encode())
    return digest.hexdigest()


def _file_sums(houses: Mapping[str, Path]) -> dict[str, str]:
    """Checksum of each house file and its sidecar."""
    return {name: hashlib.sha256(path.read_bytes() + _sidecar_bytes(path)).hexdigest() for name, path in houses.items()}


def _sidecar_bytes(house_file: Path) -> bytes:
    file = sidecar_path(house_file)
    return file.read_bytes() if file.is_file() else b""


def _to_habitat(split: str, episode: Episode) -> dict[str, Any]:
    state = habitat.to_agent_state(episode.start)
    return {
        "episode_id": episode.episode_id,
        "scene_id": f"mjcf_houses/{split}/{episode.house}.xml",
        "start_position": state["position"],
        "start_rotation": state["rotation"],
        "object_category": episode.goal,
        "info": {"geodesic_distance": episode.shortest_path_m},
        "goals": [],
    }


def _from_habitat(entry: Mapping[str, Any]) -> Episode:
    goal = entry["object_category"]
    if goal not in GOAL_CATEGORIES:
        raise ValueError(f"episode {entry['episode_id']} asks for '{goal}', which is no goal category")
    return Episode(
        episode_id=str(entry["episode_id"]),
        house=Path(entry["scene_id"]).stem,
        goal=goal,
        start=habitat.from_agent_state(entry["start_position"], entry["start_rotation"]),
        shortest_path_m=entry.get("info", {}).get("geodesic_distance"),
    )
