"""Finds the houses of Habitat's data sets in a folder, and makes each a house of this project.

A path can be a data set (`X.scene_dataset_config.json`) or the folder with one, a scene of it
(`.scene_instance.json`), a scan of HM3D (`X.semantic.txt`) or of Matterport3D (`X.house`), or a folder that has scans
in it or in folders below.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from sim.core.errors import ConfigError, HouseError
from sim.homes.importers.habitat_files import DATASET, SCENE, SceneDataset, dataset_of, read_dataset
from sim.homes.importers.habitat_scans import read_hm3d, read_mp3d
from sim.homes.importers.habitat_scenes import read_scene, used_files
from sim.homes.importers.losses import Losses
from sim.homes.importers.mesh_house import MeshConfig, MeshHouse, build_house

HM3D, MP3D = ".semantic.txt", ".house"
SCAN_AMBIENT = 0.85
"""Light from all sides in a scan: its pictures have the light of the place already."""
MAX_SCANS = 10_000


@dataclass(frozen=True)
class Source:
    """A house to import."""

    name: str
    kind: Literal["scene", "hm3d", "mp3d"]
    file: Path
    dataset: SceneDataset | None = None

    def files(self) -> list[Path]:
        """Returns the files on which the result depends."""
        if self.dataset is not None:
            return [self.dataset.file, self.file, *used_files(self.file, self.dataset)]
        stem = self.file.name.removesuffix(HM3D).removesuffix(MP3D)
        names = (".semantic.txt", ".semantic.glb", ".glb", ".basis.glb", ".house", "_semantic.ply")
        return [sibling for name in names if (sibling := self.file.with_name(f"{stem}{name}")).is_file()]


def find_sources(path: Path) -> list[Source]:
    """Returns the houses of a path, sorted by name.

    Raises:
        ConfigError: the folder has no scenes, or a data set is broken.
    """
    name = path.name
    if path.is_dir():
        configs = sorted(path.glob(f"*{DATASET}"))
        sources = list(itertools.chain.from_iterable(_scenes(read_dataset(config)) for config in configs))
        sources = sources or list(_scans(path))
    elif name.endswith(DATASET):
        sources = list(_scenes(read_dataset(path))) or list(_scans(path.parent))
    elif name.endswith(SCENE):
        sources = [Source(name.removesuffix(SCENE), "scene", path, read_dataset(dataset_of(path)))]
    elif name.endswith((HM3D, MP3D)):
        sources = [_scan(path)]
    else:
        sources = []
    if not sources:
        raise ConfigError(
            f"'{path}' has no house of Habitat's data sets: *{DATASET} with scenes, *{HM3D} or *{MP3D} with its meshes."
        )
    twice = next(
        (a.name for a, b in itertools.pairwise(sorted(sources, key=lambda s: s.name)) if a.name == b.name), None
    )
    if twice is not None:
        raise ConfigError(f"'{path}' has two houses of the name '{twice}'.")
    return sorted(sources, key=lambda source: source.name)


def _scenes(dataset: SceneDataset) -> Iterator[Source]:
    for file in dataset.scenes():
        yield Source(file.name.removesuffix(SCENE), "scene", file, dataset)


def _scans(folder: Path) -> Iterator[Source]:
    for pattern in (f"*{HM3D}", f"*/*{HM3D}", f"*/*/*{HM3D}", f"*{MP3D}", f"*/*{MP3D}", f"*/*/*{MP3D}"):
        for file in itertools.islice(sorted(folder.glob(pattern)), MAX_SCANS):
            yield _scan(file)


def _scan(file: Path) -> Source:
    hm3d = file.name.endswith(HM3D)
    return Source(file.name.removesuffix(HM3D if hm3d else MP3D), "hm3d" if hm3d else "mp3d", file)


def import_source(source: Source, config: MeshConfig) -> MeshHouse:
    """Returns a house.

    Raises:
        HouseError: it is broken; the message names file and place.
    """
    losses, ambient = Losses(), None
    try:
        if source.kind == "scene":
            assert source.dataset is not None
            made = read_scene(source.file, source.dataset, losses, config.texture_px)
        else:
            read = read_hm3d if source.kind == "hm3d" else read_mp3d
            made, ambient = read(source.file, losses, config.texture_px), SCAN_AMBIENT
        if not made.objects:
            raise HouseError("it has no objects.")
        return build_house(source.name, str(source.file), made.objects, made.rooms, config, losses, ambient=ambient)
    except HouseError as error:
        text = str(error)
        raise HouseError(text if str(source.file.parent) in text else f"'{source.file}': {text}") from None
    except MemoryError:
        raise HouseError(f"'{source.file}' needs more memory than is available.") from None
