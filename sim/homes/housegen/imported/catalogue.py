"""Styles of furniture made of imported models, catalogues that have them, and the credits in house files."""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sim.gl import mujoco
from sim.homes.housegen.furniture import CATALOGUE
from sim.homes.housegen.furniture.catalogue import Catalogue, Style
from sim.homes.housegen.furniture.item import Look, Pool
from sim.homes.housegen.furniture.workbench import Workbench
from sim.homes.housegen.generator import GeneratedHouse, HouseConfig, generate_house
from sim.homes.housegen.imported.library import Model, ModelSplit, Shape, read_index, read_shape
from sim.homes.housegen.mjcf.triangles import mesh_shape
from sim.homes.housegen.withheld import Withheld, restricted, without_covered

_MESH_NAME = re.compile(r"(i[0-9a-f]{8})-\d+")


@dataclass(frozen=True)
class ImportedFurniture:
    """The models of one split in a folder of imported models, as furniture of generated houses."""

    folder: Path
    split: ModelSplit = "train"
    alone: bool = False
    """True: models of `train` too replace our own styles."""

    @property
    def models(self) -> tuple[Model, ...]:
        """The models of the split, the same order on every machine."""
        return _models(self.folder, self.split)

    def catalogue(self, pool: Pool) -> Catalogue:
        """Returns the shipped catalogue with the models in the houses of a pool.

        Models of `train` are added to our own styles. Models of `transfer`, and with `alone` all, replace the styles of
        the uses that they have, so that a house shows our own design only where a model is missing.

        Raises:
            ConfigError: the folder is missing or broken.
        """
        return _catalogue(self.folder, self.split, pool, self.alone or self.split == "transfer")

    def make_house(self, seed: int, config: HouseConfig, *, withheld: Withheld | None = None) -> GeneratedHouse:
        """Returns a house with the models, and with their credits in its comment.

        `withheld` leaves out the withheld styles and models, or prefers them (`sim.homes.housegen.withheld`).

        Raises:
            ConfigError: the folder or the seed is not allowed.
            HouseError: the seed gives no house.
        """
        catalogue = restricted(self.catalogue(config.pool), withheld)
        made = generate_house(seed, config, catalogue)
        add_credits(made.spec, self.models)
        return made


def add_credits(spec: mujoco.MjSpec, models: Sequence[Model]) -> None:
    """Writes name, author, licence and origin of every imported model of a house into the comment of its file."""
    keys = {match[1] for mesh in spec.meshes if (match := _MESH_NAME.fullmatch(mesh.name))}
    lines = [
        f"{model.key}: {model.name} ({model.category}), author: {model.author or 'not given'}, "
        f"licence: {model.licence or 'not given'}, from {model.origin}"
        for model in models
        if model.key in keys
    ]
    if lines:
        text = "\n".join(["Models of other authors in this house, by the beginning of their meshes' names:", *lines])
        spec.comment = re.sub(r"-(?=-)", "- ", text) + "\n"  # a comment of XML must not contain two hyphens


@functools.lru_cache(maxsize=8)
def _models(folder: Path, split: ModelSplit) -> tuple[Model, ...]:
    return tuple(sorted((m for m in read_index(folder) if m.split == split), key=lambda model: model.key))


@functools.lru_cache(maxsize=8)
def _catalogue(folder: Path, split: ModelSplit, pool: Pool, alone: bool) -> Catalogue:
    models = _models(folder, split)
    styles = [style_of(folder, model, pool) for model in models]
    if not alone:
        return CATALOGUE.with_styles(*styles)
    kept = (remaining for style in CATALOGUE.all_styles if (remaining := without_covered(style, models)) is not None)
    return Catalogue([*kept, *styles])


def style_of(folder: Path, model: Model, pool: Pool) -> Style:
    """Returns a style that builds an imported model, always in its own size and colours."""
    name = f"{re.sub('[^a-z0-9]+', '_', model.name.lower()).strip('_')}_{model.key}"
    return Style(model.category, name, pool, _builder(folder, model), model.uses, model.mount)


def _builder(folder: Path, model: Model) -> Callable[[Workbench], None]:
    def build(w: Workbench) -> None:
        shape = _shape(folder, model)
        for part in shape.parts:
            middle = np.round(0.5 * (part.vertices_m.min(axis=0) + part.vertices_m.max(axis=0)), 3)
            mesh = mesh_shape(f"{model.key}-", part.vertices_m - middle, part.faces)
            look = Look(rgba=part.rgba, specular=0.15, shininess=0.15)
            x, y, z = (float(v) for v in middle)
            w.add("mesh", (), (x, y, z), np.eye(3), look, solid=False, mesh=mesh)
        for x0, y0, z0, x1, y1, z1 in shape.boxes_m.tolist():
            w.hidden_box((x0, x1), (y0, y1), (z0, z1))
        if shape.top_m:
            x0, y0, x1, y1, z = shape.top_m
            w.top((x0, x1), (y0, y1), z)
        if model.mount == "wall":
            w.mount_height_m = model.elevation_m

    return build


@functools.lru_cache(maxsize=512)
def _shape(folder: Path, model: Model) -> Shape:
    return read_shape(folder, model)
