"""The files of Habitat's scene data sets: the configuration of a data set, scenes, objects, stages, names of classes.

A data set is `X.scene_dataset_config.json`; it lists the folders of configurations, which a scene
(`*.scene_instance.json`) names by the stems of their files. Attributes of a configuration replace the defaults of the
data set. The format is described at https://aihabitat.org/docs/habitat-sim/attributesJSON.html. Paths must stay in the
folder of the data set.
"""

from __future__ import annotations

import contextlib
import itertools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Literal

import msgspec
from msgspec import Meta, Struct

from sim.core.errors import ConfigError, HouseError
from sim.core.reading import Name, convert, printable, read_csv, read_json

DATASET, SCENE = ".scene_dataset_config.json", ".scene_instance.json"
SUFFIXES = {"objects": ".object_config.json", "stages": ".stage_config.json"}
MAX_FILES = 200_000
MAX_OBJECTS = 20_000
"""Objects of a scene."""
LEVELS_UP = 4
"""Number of folders above a scene's own that are searched for its data set."""
Coordinate = Annotated[float, Meta(ge=-2000.0, le=2000.0)]
Factor = Annotated[float, Meta(ge=-1000.0, le=1000.0)]
Vector = tuple[Coordinate, Coordinate, Coordinate]
Factors = tuple[Factor, Factor, Factor]
Origin = Literal["asset_local", "com", "unknown", "default", "ASSET_LOCAL", "COM"]


class Attributes(Struct):
    """The mesh in a configuration of an object or a stage."""

    render_asset: Name | None = None
    up: Vector = (0.0, 1.0, 0.0)
    front: Vector = (0.0, 0.0, -1.0)
    scale: Factors = (1.0, 1.0, 1.0)
    units_to_meters: Annotated[float, Meta(gt=0.0, le=1000.0)] = 1.0
    mass: Annotated[float, Meta(ge=0.0, le=1e6)] | None = None
    COM: Vector | None = None
    is_collidable: bool = True
    semantic_id: int = 0


class ObjectInstance(Struct):
    """An object or the stage of a scene; rotation w, x, y, z."""

    template_name: Name
    translation: Vector = (0.0, 0.0, 0.0)
    rotation: tuple[Factor, Factor, Factor, Factor] = (1.0, 0.0, 0.0, 0.0)
    translation_origin: Origin | None = None
    motion_type: Name = "static"
    uniform_scale: Factor = 1.0
    non_uniform_scale: Factors = (1.0, 1.0, 1.0)


class SceneInstance(Struct):
    """A scene."""

    stage_instance: ObjectInstance
    object_instances: Annotated[list[ObjectInstance], Meta(max_length=MAX_OBJECTS)] = []
    articulated_object_instances: Annotated[list[Any], Meta(max_length=MAX_OBJECTS)] = []
    translation_origin: Origin = "com"
    semantic_scene_instance: str = ""


class Region(Struct):
    """A room: a polygon in Habitat's frame and its heights."""

    poly_loop: Annotated[list[Vector], Meta(min_length=3, max_length=10_000)]
    floor_height: Coordinate
    extrusion_height: Annotated[float, Meta(gt=0.0, le=100.0)] = 2.5
    label: str = "room"


class _Class(Struct):
    id: int
    name: Name


class Semantics(Struct):
    """Names of classes and regions."""

    classes: list[_Class] = []
    region_annotations: Annotated[list[Region], Meta(max_length=10_000)] = []


class _Section(Struct):
    default_attributes: dict[str, object] = {}
    paths: dict[str, list[str]] = {}
    configs: list[dict[str, object]] = []


class _Dataset(Struct):
    stages: _Section = msgspec.field(default_factory=_Section)
    objects: _Section = msgspec.field(default_factory=_Section)
    scene_instances: _Section = msgspec.field(default_factory=_Section)
    semantic_scene_descriptor_instances: dict[str, object] = {}


@dataclass(frozen=True)
class Template:
    """A configuration of an object or a stage."""

    name: str
    attributes: Attributes
    asset: Path
    file: Path | None = None
    """The configuration."""


@dataclass(frozen=True)
class SceneDataset:
    """A data set; its configurations are read on demand."""

    file: Path
    content: _Dataset
    files: Mapping[str, Mapping[str, Path]]
    """Configurations or meshes by name, for `objects` and `stages`."""
    category_of_id: Mapping[str, str] = field(default_factory=dict)
    """Names of categories of objects, from tables (HSSD)."""

    @property
    def folder(self) -> Path:
        """The folder that holds all files of the data set."""
        return self.file.parent

    def scenes(self) -> list[Path]:
        """Returns the scenes, sorted."""
        scenes = set(_listed(self.file, self.content.scene_instances.paths, SCENE))
        return sorted(scenes)

    def template(self, kind: str, name: str, where: str) -> Template:
        """Returns the configuration that a scene names.

        Args:
            kind: `objects` or `stages`.
            name: stem of its file, with or without folders.
            where: the scene, for messages.

        Raises:
            HouseError: it is missing or broken, or its mesh is outside of the data set.
        """
        section: _Section = getattr(self.content, kind)
        short = name.rpartition("/")[2].removesuffix(SUFFIXES[kind])
        values: dict[str, object] = dict(section.default_attributes)
        for config in section.configs:
            if config.get("template_handle") == short:
                original = config.get("original_file")
                base, source = self.folder, None
                if isinstance(original, str):
                    source = self.inside(self.folder / original, where)
                    base = source.parent
                    values |= read_json(source, dict[str, object], what="Configuration", error=HouseError)
                own = config.get("attributes", {})
                values |= own if isinstance(own, dict) else {}
                renamed = isinstance(own, dict) and "render_asset" in own
                return self._template(short, values, self.folder if renamed else base, where, source)
        file = self.files[kind].get(short)
        if file is None:  # Habitat also takes a part of a handle
            similar = sorted(known for known in self.files[kind] if short and short in known)
            if len(similar) != 1:
                fits = f" It is part of several: {', '.join(map(printable, similar[:3]))}." if similar else ""
                raise HouseError(f"{where}: the {kind} have no configuration '{printable(name)[:80]}'.{fits}")
            file = self.files[kind][similar[0]]
        if not file.name.endswith(".json"):
            return self._template(short, values | {"render_asset": file.name}, file.parent, where)
        values |= read_json(file, dict[str, object], what="Configuration", error=HouseError)
        return self._template(short, values, file.parent, where, file)

    def _template(
        self, name: str, values: dict[str, object], base: Path, where: str, file: Path | None = None
    ) -> Template:
        what = f"Configuration '{printable(name)}' of {self.file.name}"
        attributes = convert(values, Attributes, where=what, error=HouseError)
        if attributes.render_asset is None:
            raise HouseError(f"{what} has no field 'render_asset'.")
        return Template(name, attributes, self.inside(base / attributes.render_asset, where), file)

    def inside(self, file: Path, where: str) -> Path:
        """Returns the path of a file; raises HouseError if it is outside of the folder of the data set."""
        try:
            target = file.resolve()
            is_inside = target.is_relative_to(self.folder.resolve())
        except (OSError, ValueError, RuntimeError):
            raise HouseError(f"{where}: '{printable(str(file))[:100]}' is not the name of a file.") from None
        if not is_inside:
            raise HouseError(f"{where}: '{printable(str(file))[:200]}' is outside of the data set '{self.folder}'.")
        return target

    def _has(self, file: Path) -> bool:
        """Returns whether a file exists and is in the folder of the data set."""
        with contextlib.suppress(HouseError):
            return self.inside(file, "").is_file()
        return False

    def semantics(self, scene: SceneInstance, stem: str) -> Semantics:
        """Returns the names of classes and the regions of a scene; empty where the data set has none.

        Args:
            scene: the scene.
            stem: its name.
        """
        name = scene.semantic_scene_instance or str(
            self.content.scene_instances.default_attributes.get("semantic_scene_instance", "")
        )
        name = name.replace("%%CONFIG_NAME_AS_ASSET_FILENAME%%", stem)
        section = self.content.semantic_scene_descriptor_instances
        paths, defaults = section.get("paths", {}), section.get("default_attributes", {})
        where = f"Data set '{self.file}'"
        listed = _listed(self.file, convert(paths, dict[str, list[str]], where=where), "")
        own = next((file for file in listed if name and file.name in (name, f"{name}.semantic_config.json")), None)
        semantics = Semantics() if own is None else read_json(own, Semantics, what="Semantics", error=HouseError)
        shared = section.get(name) or (
            defaults.get("semantic_descriptor_filename") if isinstance(defaults, dict) else ""
        )
        if semantics.classes or not isinstance(shared, str) or not shared:
            return semantics
        # A default is relative to the descriptor of the scene, another name to the data set.
        base = self.folder if own is None else own.parent
        file = next((candidate for candidate in (base / shared, self.folder / shared) if self._has(candidate)), None)
        if file is None:
            return semantics
        more = read_json(file, Semantics, what="Semantics", error=HouseError)
        return Semantics(more.classes, semantics.region_annotations or more.region_annotations)


def read_dataset(file: Path) -> SceneDataset:
    """Returns a data set.

    Raises:
        ConfigError: the file is broken, or lists too many files.
    """
    content = read_json(file, _Dataset, what="Scene data set")
    files: dict[str, dict[str, Path]] = {}
    for kind, suffix in SUFFIXES.items():
        section: _Section = getattr(content, kind)
        templates = files.setdefault(kind, {})
        for name in _listed(file, {".glb": section.paths.get(".glb", [])}, ".glb"):
            templates[name.name.removesuffix(".glb")] = name
        for name in _listed(file, {".json": section.paths.get(".json", [])}, suffix):
            templates[name.name.removesuffix(suffix)] = name
    return SceneDataset(file, content, files, _tables(file.parent))


def _listed(file: Path, paths: Mapping[str, list[str]], suffix: str) -> Iterator[Path]:
    """Yields the files with a suffix that folders and patterns of a data set name; those outside of it are left out."""
    base = file.parent.resolve()
    for pattern in itertools.chain.from_iterable(paths.values()):
        if not pattern or pattern.startswith(("/", "~")) or ".." in pattern.split("/"):
            continue
        below = "/".join(part for part in pattern.split("/") if part not in ("", "."))
        try:
            matches = itertools.islice(file.parent.glob(below) if below else [file.parent], MAX_FILES)
            for match in matches:
                inner = itertools.islice(match.iterdir(), MAX_FILES) if match.is_dir() else [match]
                for entry in inner:
                    if entry.name.endswith(suffix) and entry.is_file() and entry.resolve().is_relative_to(base):
                        yield entry
        except (OSError, ValueError, NotImplementedError):
            raise ConfigError(
                f"Scene data set '{file}': '{printable(pattern)[:80]}' is not a pattern of files."
            ) from None


def _tables(folder: Path) -> dict[str, str]:
    """Returns the categories of objects by id, from the tables of HSSD (`semantics/*.csv`, `metadata/*.csv`)."""
    names: dict[str, str] = {}
    for file in sorted([*folder.glob("semantics/*.csv"), *folder.glob("metadata/*.csv")])[:20]:
        for row in read_csv(file, what="Table of objects"):
            ident = next((row[name] for name in ("id", "object_id", "object_hash") if row.get(name)), "")
            category = next(
                (row[name] for name in ("main_category", "clean_category", "category") if row.get(name)), ""
            )
            if ident and category:
                names.setdefault(ident, category)
    return names


def dataset_of(scene: Path) -> Path:
    """Returns the data set to which a scene belongs: the nearest one in a folder above.

    Raises:
        ConfigError: it is missing, or there are several.
    """
    for folder in list(scene.resolve().parents)[:LEVELS_UP]:
        configs = sorted(folder.glob(f"*{DATASET}"))
        if len(configs) == 1:
            return configs[0]
        if configs:
            raise ConfigError(f"Scene '{scene}': '{folder}' has several data sets; give the path of one of them.")
    raise ConfigError(f"Scene '{scene}': no folder above has a *{DATASET}.")
