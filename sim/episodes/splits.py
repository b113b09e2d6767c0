"""Splits: houses and their episodes (house, goal, start), in a fixed order.

A split is a folder of house files with its episodes next to them in Habitat's ObjectNav layout (see
`sim.episodes.habitat`): `val/<house>.xml`, `val/val.json.gz`, `val/content/<house>.json.gz`. Instead of house files it
may have a list of recipes, `train/houses.json` (see `sim.episodes.house_list`), whose houses are generated on
first use.

A folder of files of HM3D-OVON or GOAT-Bench without houses (`stubborn habitat dataset`) is a split too; its scenes name
the houses.

`labels.json` in the folder holds label rules for its houses (docs/worlds.md).
`val/unreachable.json` names the objects that no episode asks for, because no place of the free space reaches them.
"""

from __future__ import annotations

import hashlib
import json
import reprlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import msgspec

from sim.core.errors import EpisodeError, HouseError, did_you_mean
from sim.core.files import inside, write_together
from sim.core.interface import ConfigError
from sim.core.invocation import command
from sim.core.paths import assets_dir
from sim.core.reading import Name, first_unprintable, printable, read_bytes, read_json, sha256_of
from sim.episodes import habitat
from sim.episodes.episode import Episode
from sim.episodes.house_list import HouseList, has_house_list, read_house_list
from sim.episodes.other_files import read_others
from sim.episodes.replicates import find_episode
from sim.houses.house import House
from sim.houses.load import load_house, no_such_house
from sim.houses.references import add_files
from sim.houses.sidecar import EMPTY_SIDECAR, Sidecar, read_sidecar, sidecar_path

UNREACHABLE_FILE = "unreachable.json"
LABELS_FILE = "labels.json"
HOUSE_SUFFIXES = (".xml", ".mjcf")
"""Suffixes of house files, in lower or upper case."""
_MAX_BYTES = 256 << 20
"""Largest size of a house file."""


@dataclass(frozen=True)
class Split:
    """Houses and their episodes, in the order of the split."""

    name: str
    version: str
    """Version of the split; it is increased when a house or an episode changes, and results record it."""
    sha256: str
    """Hash over house files, their sidecars and the episodes; for listed houses, over their checksums."""
    house_paths: Mapping[str, Path]
    """File of each house; a listed house may not be generated yet (`house_file`)."""
    episodes: tuple[Episode, ...]
    labels_path: Path | None = None
    root: Path | None = None
    """Another folder whose files the houses may use, in addition to the split's folder."""
    house_list: HouseList | None = None
    """Generates the houses of a split that is shipped as a list."""
    house_sums: Mapping[str, str] = field(default_factory=dict)
    """Checksum of each house with its sidecar and the files that it uses; for a house list, the list has them."""

    @property
    def houses(self) -> tuple[str, ...]:
        """Names of the houses."""
        return tuple(self.house_paths)

    @property
    def identity(self) -> dict[str, str]:
        """Name, version and checksum, as results record them."""
        return {"name": self.name, "version": self.version, "sha256": self.sha256}

    def house_file(self, name: str) -> Path:
        """Returns the file of a house; a listed house is generated if necessary.

        Raises:
            HouseError: there is no such house, or it cannot be generated here.
        """
        self._require_house(name)
        return self.house_paths[name] if self.house_list is None else self.house_list.fetch(name)

    def _require_house(self, name: str) -> None:
        if name not in self.house_paths:
            there_is = reprlib.repr(list(self.houses)) if len(self.houses) > 40 else ", ".join(self.houses)
            raise HouseError(f"Split '{self.name}' has no house '{name}'. It has: {there_is}.")

    def load_house(self, name: str) -> House:
        """Returns a house.

        Raises:
            HouseError: there is no such house, it cannot be generated here, or it violates the house format.
        """
        return load_house(self.house_file(name), labels_path=self.labels_path, root=self.root)

    def require_unchanged(self, name: str) -> None:
        """Raises HouseError if a house, its sidecar or a file that it uses has changed since this split was read."""
        if name in self.house_sums and house_sum(self.house_file(name), root=self.root) != self.house_sums[name]:
            raise HouseError(f"House '{name}': its files have changed since this run was planned; start the run again.")

    def sidecar(self, house: str) -> Sidecar:
        """Returns the settings that a house's sidecar fixes; empty if there is no sidecar, or if it holds label rules.

        Raises:
            HouseError: there is no such house, or the file violates the format of `sim.houses.sidecar`.
        """
        self._require_house(house)
        return house_sidecar(self.house_paths[house], self.labels_path)

    def episode(self, episode_id: str) -> Episode:
        """Returns the episode with an id, or one of its replicates (`sim.episodes.replicates`).

        Raises:
            EpisodeError: there is no such episode.
        """
        match = find_episode({episode.episode_id: episode for episode in self.episodes}, str(episode_id))
        if match is not None:
            return match
        hint = did_you_mean(str(episode_id), [episode.episode_id for episode in self.episodes])
        raise EpisodeError(f"Split '{self.name}' has no episode '{episode_id}'.{hint}")


def house_sidecar(house_file: Path, labels_path: Path | None) -> Sidecar:
    """Returns the sidecar of a house file; empty if it does not exist, or if the file holds the label rules.

    Raises:
        HouseError: the file violates the format of `sim.houses.sidecar`.
    """
    is_rules = labels_path is not None and labels_path.resolve() == sidecar_path(house_file).resolve()
    return EMPTY_SIDECAR if is_rules else read_sidecar(house_file)


def shipped_splits() -> tuple[str, ...]:
    """Returns the names of the splits that come with the package."""
    return tuple(sorted(folder.name for folder in assets_dir().iterdir() if _index_of(folder).is_file()))


def absolute_split(name: str) -> str:
    """Returns the name of a shipped split, or the path of a folder that stays valid if the current folder changes."""
    return name if name in shipped_splits() else str(Path(name).absolute())


def load_split(name_or_path: str | Path) -> Split:
    """Returns a shipped split by name, or the split in a folder with the same layout.

    Raises:
        ConfigError: there is no such split or folder, or its files have another format.
    """
    shipped = shipped_splits()
    folder_given = Path(name_or_path)
    if (
        str(name_or_path) in shipped
        and _index_of(folder_given).is_file()
        and folder_given.resolve().parent != assets_dir().resolve()
    ):
        raise ConfigError(
            f"'{name_or_path}' is a shipped split and a folder here: write ./{name_or_path} for the folder, or run the "
            "command elsewhere."
        )
    folder = _folder_of(name_or_path)
    if not folder.is_dir():
        there_is = ", ".join(shipped) or "none"
        raise ConfigError(
            f"Unknown split '{name_or_path}': neither a shipped one (available: {there_is}) nor a folder"
            f"{', but a file' if folder.is_file() else ''}."
        )
    folder = folder.resolve()
    if not _index_of(folder).is_file():
        raise ConfigError(
            f"Split '{folder}' has no {_index_of(folder).name}: a split is a folder of house files with its episodes "
            f"next to them (`{command('episodes')}` makes them)."
        )
    return _read_split(folder)


def read_index(name_or_path: str | Path) -> habitat.IndexFile:
    """Returns the index of a split, which says of which kinds its goals are; an empty one: there is no such split."""
    folder = _folder_of(name_or_path).resolve()
    if not _index_of(folder).is_file():
        return habitat.IndexFile()
    index = habitat.read_index(_index_of(folder))
    if index.order is not None:
        return index
    kinds = {goal.kind for episode in _read_split(folder).episodes for goal in episode.specs}
    return msgspec.structs.replace(index, in_words=bool(kinds - {"category", "picture"}), pictures="picture" in kinds)


def _folder_of(name_or_path: str | Path) -> Path:
    """Returns the folder of a shipped split by name, or the folder with this path."""
    return assets_dir() / name_or_path if str(name_or_path) in shipped_splits() else Path(name_or_path)


def one_house(path: str | Path, *, labels: str | Path | None = None, root: str | Path | None = None) -> Split:
    """Returns a split of one house file, without episodes; see `split_of_files`."""
    return split_of_files((path,), labels=labels, root=root)


def split_of_files(
    paths: Sequence[str | Path], *, labels: str | Path | None = None, root: str | Path | None = None
) -> Split:
    """Returns a split of the given house files, without episodes.

    Args:
        paths: the files; each name is that of one house.
        labels: label rules of all houses; None: those of `labels.json` beside the houses, as imports write it.
        root: another folder whose files they may use, in addition to their own folders.

    Raises:
        ConfigError: two files have one name.
        HouseError: there is no such file.
    """
    labels_path = _common_labels(list(map(Path, paths))) if labels is None else Path(labels)
    allowed = None if root is None else Path(root)
    files, sums = dict[str, Path](), dict[str, str]()
    for path in map(Path, paths):
        if not path.is_file():
            raise no_such_house(path)
        if path.stem in files:
            raise ConfigError(f"The houses '{files[path.stem]}' and '{path}' have one name; rename one of them.")
        files[path.stem], sums[path.stem] = path, house_sum(path, root=allowed)
    rules = b""
    if labels_path is not None and labels_path.is_file():
        rules = read_bytes(labels_path, what="Label rules", error=HouseError)
    if len(files) > 1:
        digest = hashlib.sha256("".join(sums.values()).encode() + rules).hexdigest()
        return Split("houses", "houses", digest, files, (), labels_path, allowed, house_sums=sums)
    ((name, path),) = files.items()
    digest = house_sum(path, with_also=rules, root=allowed) if rules else sums[name]
    return Split(name, "one-house", digest, files, (), labels_path, allowed, house_sums=sums)


def _common_labels(houses: list[Path]) -> Path | None:
    """Returns the label rules beside some houses; None if there are none, or if they lie in different folders."""
    found = {labels_of(house.parent) for house in houses}
    return found.pop() if len(found) == 1 else None


def house_sum(path: Path, *, with_also: bytes = b"", root: Path | None = None) -> str:
    """Returns the checksum of a house file with its sidecar and the files that it uses (SHA-256, hexadecimal).

    Args:
        path: the house file.
        with_also: further content to include.
        root: another folder whose files it may use.

    Raises:
        HouseError: a file cannot be read.
    """
    digest = hashlib.sha256(read_bytes(path, what="House", error=HouseError, most=_MAX_BYTES) + _sidecar_bytes(path))
    digest.update(with_also)
    add_files(digest, path, root)  # a house in a single file keeps the checksum of version 0.1
    return digest.hexdigest()


def write_split(
    folder: Path,
    episodes: Sequence[Episode],
    goals_by_house: Mapping[str, Mapping[str, Sequence[Mapping[str, object]]]],
    *,
    version: str,
    unreachable: Mapping[str, Sequence[str]] | None = None,
    houses_of: str = "",
) -> None:
    """Writes the episodes of a split next to its houses, in Habitat's layout; existing episodes are replaced.

    Args:
        folder: the split's folder, which holds the house files; its name is the split's.
        episodes: in the order of the split.
        goals_by_house: for each house, for each goal category, Habitat's goals (`sim.episodes.habitat`).
        version: version of the split.
        unreachable: for each house, names of the goal instances that cannot be reached; None: not computed.
        houses_of: name of the folder beside this one that holds the houses; "": this one holds them.
    """
    index = {"version": version, "order": [episode.episode_id for episode in episodes], "episodes": []}
    if houses_of:
        index["houses_of"] = houses_of
    kinds = {goal.kind for episode in episodes for goal in episode.specs}
    if kinds - {"category", "picture"}:
        index["in_words"] = True
    if "picture" in kinds:
        index["pictures"] = True
    files: dict[Path, bytes | str] = {}
    for house, goals in goals_by_house.items():
        content = habitat.category_tables() | {
            "goals_by_category": {habitat.goals_key(house, goal): listed for goal, listed in goals.items()},
            "episodes": [_to_habitat(folder.name, episode) for episode in episodes if episode.house == house],
        }
        files[inside(folder / "content", f"{house}.json.gz", what="name of a house")] = habitat.zipped_json(content)
    stale = [file for file in (folder / "content").glob("*.json.gz") if file not in files]
    if unreachable is not None:
        files[folder / UNREACHABLE_FILE] = _unreachable_text(unreachable)
    files[_index_of(folder)] = habitat.zipped_json(habitat.category_tables() | index)
    write_together(files)
    for file in stale:
        file.unlink()


def house_files(folder: Path) -> dict[str, Path]:
    """Returns the house files in a folder, by name without suffix, sorted; an empty dict if there is no such folder.

    Raises:
        ConfigError: the names of two files differ only in their suffix.
    """
    files = dict[str, Path]()
    for path in sorted(folder.iterdir()) if folder.is_dir() else ():
        if path.suffix.lower() not in HOUSE_SUFFIXES:
            continue
        if path.stem in files:
            raise ConfigError(f"The houses '{files[path.stem]}' and '{path}' have one name; rename one of them.")
        files[path.stem] = path
    return files


def labels_of(folder: Path) -> Path | None:
    """Returns the file of label rules in the folder of a split; None if its houses need none."""
    file = folder / LABELS_FILE
    return file if file.is_file() else None


def read_unreachable(folder: Path) -> dict[str, tuple[str, ...]]:
    """Returns for each house of a split the goal instances that cannot be reached; empty if there is no such file.

    Raises:
        ConfigError: the file has another format than that of `write_split`.
    """
    file = folder / UNREACHABLE_FILE
    if not file.is_file():
        return {}
    return read_json(file, dict[Name, tuple[Name, ...]], what="List of unreachable instances")


def _unreachable_text(unreachable: Mapping[str, Sequence[str]]) -> str:
    """Returns JSON with a line for each house that has unreachable instances."""
    lines = ",".join(
        f"\n{json.dumps(house)}: {json.dumps(list(names))}" for house, names in unreachable.items() if names
    )
    return f"{{{lines}\n}}\n"


def _index_of(folder: Path) -> Path:
    return folder / f"{folder.name}.json.gz"


def has_episodes(folder: Path) -> bool:
    """Returns whether a folder holds the episodes of a split."""
    return _index_of(folder.resolve()).is_file()


def _read_split(folder: Path) -> Split:
    """Returns the split in a folder that has an index."""
    index_file = _index_of(folder)
    index = habitat.read_index(index_file)
    episodes: dict[str, Episode] = {}
    home = folder if not index.houses_of else inside(folder.parent, index.houses_of, what="folder of the houses")
    is_own, scenes = index.order is not None or has_house_list(home) or bool(house_files(home)), set[Path]()
    for file in sorted((folder / "content").glob("*.json.gz")):
        for episode in _episodes_of(file) if is_own else _others_of(file, scenes):
            if episode.episode_id in episodes:
                raise ConfigError(f"Episode file '{file}': there are two episodes '{episode.episode_id}'.")
            episodes[episode.episode_id] = episode
    order = sorted(episodes) if index.order is None else [str(episode_id) for episode_id in index.order]
    for number, episode_id in enumerate(order):
        if episode_id not in episodes:
            raise ConfigError(f"Episode file '{index_file}', field 'order[{number}]': no episode '{episode_id}'.")
    if len(set(order)) < len(order):
        raise ConfigError(f"Episode file '{index_file}', field 'order': an episode is listed twice.")
    ordered = tuple(episodes[episode_id] for episode_id in order)
    if scenes:
        home = _home_of(folder, scenes)
    house_list = read_house_list(home) if has_house_list(home) else None
    houses = house_list.paths if house_list else house_files(home)
    if (bad := first_unprintable(houses)) is not None:
        raise ConfigError(f"Split '{folder}': the name of the house '{printable(bad)}' is not plain text.")
    missing = sorted({episode.house for episode in ordered} - set(houses))
    if missing:
        where = "no such house in its list" if house_list else f"no {missing[0]}.xml"
        raise ConfigError(f"Split '{folder}' has episodes in '{missing[0]}' but {where}.")
    version = index.version if is_own or house_list is None else house_list.version
    if house_list and house_list.version != version:
        raise ConfigError(
            f"Split '{folder}' has episodes of version {version} but a list of houses of version {house_list.version}: "
            f"generate both again (`{command('houses', 'generate')}`, `{command('episodes')}`)."
        )
    house_sums = {} if house_list else {name: house_sum(path) for name, path in houses.items()}
    sums = dict(house_list.sha256 if house_list else house_sums)
    labels = labels_of(home)
    if labels is not None:
        sums[LABELS_FILE] = sha256_of(labels, what="Label rules")
    digest = _sha256(sums, ordered)
    return Split(folder.name, version, digest, houses, ordered, labels, house_list=house_list, house_sums=house_sums)


def _episodes_of(file: Path) -> list[Episode]:
    """Returns the episodes of a file; raises ConfigError, which names file and episode, where one is not allowed."""
    episodes = []
    for number, entry in enumerate(habitat.read_episodes(file)):
        try:
            episodes.append(_from_habitat(entry))
        except EpisodeError as error:
            raise ConfigError(f"Episode file '{file}', field 'episodes[{number}]': {error}") from None
    return episodes


def _others_of(file: Path, scenes: set[Path]) -> list[Episode]:
    """Returns the episodes of a file of HM3D-OVON or GOAT-Bench, and adds their scenes; errors as `_episodes_of`."""
    try:
        episodes, of_file = read_others(file)
    except EpisodeError as error:
        raise ConfigError(f"Episode file '{file}': {error}") from None
    scenes |= of_file
    return episodes


def _home_of(folder: Path, scenes: set[Path]) -> Path:
    """Returns the folder of the houses of scenes: their own, or that of a shipped split (`stubborn/val/val_02.xml`)."""
    shipped = shipped_splits()
    homes = {
        assets_dir() / scene.parent.name if scene.parent.name in shipped and not scene.is_file() else scene.parent
        for scene in scenes
    }
    if len(homes) > 1:
        named = ", ".join(sorted(f"'{home}'" for home in homes))
        raise ConfigError(f"Split '{folder}': its houses must be in one folder, not in {named}.")
    return homes.pop()


def _sha256(sums: Mapping[str, str], episodes: Sequence[Episode]) -> str:
    """Returns a hash over the names and checksums of the houses and over the episodes."""
    digest = hashlib.sha256(json.dumps(dict(sums)).encode())
    digest.update(json.dumps([_to_habitat("", episode) for episode in episodes]).encode())
    return digest.hexdigest()


def _sidecar_bytes(house_file: Path) -> bytes:
    file = sidecar_path(house_file)
    return read_bytes(file, what="Sidecar", error=HouseError) if file.is_file() else b""


def _to_habitat(split: str, episode: Episode) -> dict[str, object]:
    state = habitat.to_agent_state(episode.start)
    return {
        "episode_id": episode.episode_id,
        "scene_id": f"mjcf_houses/{split}/{episode.house}.xml",
        "start_position": state["position"],
        "start_rotation": state["rotation"],
        "object_category": episode.goal,
        "info": {"geodesic_distance": episode.shortest_path_m} | habitat.goals_info(episode.goals),
        "goals": [],
    }


def _from_habitat(entry: habitat.EpisodeEntry) -> Episode:
    return Episode(
        episode_id=str(entry.episode_id),
        house=Path(entry.scene_id).stem,
        goal=entry.object_category,
        start=habitat.from_agent_state(entry.start_position, entry.start_rotation),
        shortest_path_m=entry.info.geodesic_distance,
        goals=habitat.goals_of(entry.info),
    )
