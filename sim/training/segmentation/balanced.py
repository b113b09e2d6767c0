"""Samples training views by the objects that they show: first the category, then the style, then the object.

Random views show hundreds of chairs for each stool. Here each goal category is sampled equally often, and each style
within it, so that a network learns from many designs. Views are read in any order, from their positions in the tar
files.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import msgspec
import numpy as np
import torch
from torch import Tensor
from torch.utils.data import DataLoader, Dataset

from sim.core.interface import GOAL_CATEGORIES, MPCAT40, ConfigError
from sim.core.reading import Count, open_plain
from sim.training.segmentation.dataset import LabelledView, decode_view, read_members
from sim.training.segmentation.recipe import Recipe
from sim.training.segmentation.samples import Sample, Sampler, WeightedSample

SMALLEST_PX = 40
"""An object with at least this many visible pixels, of 320 x 240, can be sampled."""


class StoredView(NamedTuple):
    """The place of a stored view: its file, and offset and size in bytes of each of its members."""

    file: Path
    key: str
    members: tuple[tuple[str, int, int], ...]

    def read(self) -> LabelledView:
        """Returns the view, without the masks of its objects.

        Raises:
            ConfigError: the view is incomplete or broken.
        """
        parts: dict[str, bytes] = {}
        with open_plain(self.file, what="Shard") as stream:
            for name, offset, size in self.members:
                if name != "coco":  # the instance image holds the same masks
                    stream.seek(offset)
                    parts[name] = stream.read(size)
        return decode_view(self.file, self.key, parts)


class ShownObject(NamedTuple):
    """An object that a view shows."""

    view: int
    """Index of the view."""
    number: int
    """Its number in the instance image."""


class Annotation(msgspec.Struct):
    """The part of an annotation that holds the category and the size of an object."""

    id: Annotated[int, msgspec.Meta(ge=0, le=65535)]
    category_id: Annotated[int, msgspec.Meta(ge=0, lt=len(MPCAT40))]
    area: Count
    style: str = ""
    everyday_name: str = ""


LabelOf = Callable[[str, Annotation], str | None]


def _goal_category(category: str, annotation: Annotation) -> str | None:
    del annotation
    return category if category in GOAL_CATEGORIES else None


@dataclass(frozen=True)
class ViewIndex:
    """All views of some shards, and the goal objects in them by category and style."""

    views: tuple[StoredView, ...]
    objects: dict[str, dict[str, list[ShownObject]]]
    """Objects by category (or another label), then by style; "" if the style is not known."""

    @classmethod
    def of(cls, shards: Sequence[Path], *, workers: int = 0, label_of: LabelOf = _goal_category) -> ViewIndex:
        """Returns the index of some shards, which `workers` processes read.

        Args:
            shards: the files.
            workers: number of processes.
            label_of: returns what an object is sampled by, from category and annotation; None: it is not sampled.

        Raises:
            ConfigError: a shard is broken or has no objects (`stubborn views --extras instances`).
        """
        views: list[StoredView] = []
        objects: dict[str, dict[str, list[ShownObject]]] = {}
        for own, shown in DataLoader(_ShardIndex(shards, label_of), batch_size=None, num_workers=workers):
            for category, style, view, number in shown:
                of_style = objects.setdefault(category, {}).setdefault(style, [])
                of_style.append(ShownObject(len(views) + view, number))
            views += own
        return cls(tuple(views), objects)

    def counts(self) -> dict[str, tuple[int, int]]:
        """Returns the number of objects and of styles of each category."""
        return {name: (sum(map(len, styles.values())), len(styles)) for name, styles in sorted(self.objects.items())}

    def draw(self, rng: np.random.Generator, *, object_share: float = 1.0) -> ShownObject:
        """Returns a random object: first the category, then the style, then the object is sampled uniformly.

        With probability 1 - `object_share` it returns any view, and the number 0.
        """
        if rng.random() >= object_share:
            return ShownObject(int(rng.integers(len(self.views))), 0)
        styles = self.objects[one_of(list(self.objects), rng)]
        return one_of(styles[one_of(list(styles), rng)], rng)


class _ShardIndex(Dataset):
    """The views of each shard, and their objects: label, style, index of the view in the shard, number."""

    def __init__(self, shards: Sequence[Path], label_of: LabelOf) -> None:
        self._shards, self._label_of = shards, label_of

    def __len__(self) -> int:
        return len(self._shards)

    def __getitem__(self, i: int) -> tuple[list[StoredView], list[tuple[str, str, int, int]]]:
        shard, decoder = self._shards[i], msgspec.json.Decoder(list[Annotation])
        views: list[StoredView] = []
        objects: list[tuple[str, str, int, int]] = []
        with open_plain(shard, what="Shard") as stream:
            for key, members in read_members(shard):
                for annotation in _annotations(decoder, shard, key, members, stream):
                    label = self._label_of(MPCAT40[annotation.category_id], annotation)
                    if label is not None and annotation.area >= SMALLEST_PX:
                        objects.append((label, annotation.style, len(views), annotation.id))
                views.append(StoredView(shard, key, tuple((name, *place) for name, place in members.items())))
        return views, objects


class Batches(Dataset):
    """The batches of a training. A batch depends only on seed, step and progress, so that a killed run continues alike.

    Samples are drawn by an object that they show, or are any views, as `Recipe.object_share` says. An item is chosen
    by a pair: the number of the step, and the share of all steps before it.

    Args:
        index: the views; all are of one size.
        sampler: makes a sample of a view; width and share of whole views are those of the recipe's phase.
        recipe: phases and sampling.
        batch: samples of a step, multiplied by those of the phase.
        seed: seeds all batches.

    Raises:
        ConfigError: no view shows an object of a goal category.
    """

    def __init__(self, index: ViewIndex, sampler: Sampler, recipe: Recipe, *, batch: int, seed: int) -> None:
        if not index.objects:
            raise ConfigError("No view shows an object of a goal category.")
        self.index, self.sampler, self.recipe, self.batch, self.seed = index, sampler, recipe, batch, seed
        self._stored_px = index.views[0].read().rgb.shape[1]

    def __getitem__(self, key: tuple[int, float]) -> tuple[Tensor, ...]:
        """Returns the samples of one step, stacked: see `sim.training.segmentation.samples.WeightedSample`."""
        step, progress = key
        rng, phase = np.random.default_rng([self.seed, step]), self.recipe.phase(progress)
        used_px = self._stored_px // (self.sampler.used_block_px or 1)
        width_px = self.recipe.width_px(phase, used_px, self._stored_px, rng)
        sampler = replace(self.sampler, window_px=width_px, whole_share=phase.whole_share)
        samples = [self._sample(sampler, rng) for _ in range(phase.batches * self.batch)]
        return tuple(torch.stack(parts) for parts in zip(*samples, strict=True))

    def _sample(self, sampler: Sampler, rng: np.random.Generator) -> Sample | WeightedSample:
        drawn = self.index.draw(rng, object_share=self.recipe.object_share)
        return sampler(self.index.views[drawn.view].read(), rng, instance=drawn.number or None)


def _annotations(
    decoder: msgspec.json.Decoder[list[Annotation]], shard: Path, key: str, members: dict[str, tuple[int, int]],
    stream: Any,
) -> list[Annotation]:  # fmt: skip
    """Returns the objects of a view; raises ConfigError if the shard has no objects or they are broken."""
    if "coco" not in members:
        raise ConfigError(f"Shard '{shard}': view '{key}' has no objects; make it with --extras instances.")
    offset, size = members["coco"]
    stream.seek(offset)
    try:
        return decoder.decode(stream.read(size))
    except msgspec.MsgspecError as error:
        raise ConfigError(f"Shard '{shard}': the objects of view '{key}' cannot be read: {error}.") from None


def one_of(choices: Sequence[Any], rng: np.random.Generator) -> Any:
    """Returns one of some choices, each equally often."""
    return choices[int(rng.integers(len(choices)))]
