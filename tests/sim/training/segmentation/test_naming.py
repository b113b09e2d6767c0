"""Training of the head for names: what is a label, and that it learns without changing the network."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from sim.core.interface import MPCAT40_ID, ConfigError
from sim.houses.labels import Instance
from sim.training.segmentation import naming
from sim.training.segmentation.balanced import Annotation
from sim.training.segmentation.naming import Args, Trainer, known_name
from sim.training.views.coco import annotate
from sim.training.views.shards import write_shard
from sim.training.views.views import View
from stubborn.segmentation.checkpoints import load_network, save_network
from stubborn.segmentation.names import NameGroups
from stubborn.segmentation.networks import without_names
from stubborn.segmentation.shipped import SHIPPED_REDNET

STYLES = {"appliances_00": "retro_fridge", "appliances_01": "stove", "appliances_02": "dishwasher"}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Views of a bright fridge, a dark cooker and a dishwasher, which no training may use."""
    rng, views = np.random.default_rng(0), []
    for number in range(24):
        ids = np.repeat(1 + rng.permutation(3), 100)[:, None].repeat(240, axis=1).T.astype(np.uint16)
        ids = np.pad(ids, ((0, 0), (0, 20)))
        rgb = np.array([120, 250, 10, 120], np.uint8)[ids][..., None].repeat(3, axis=2)
        semantic = np.where(ids > 0, MPCAT40_ID["appliances"], MPCAT40_ID["wall"]).astype(np.uint8)
        objects = [Instance(name, "appliances", (i,)) for i, name in enumerate(STYLES)]
        depth, record = np.full(ids.shape, 2000, np.uint16), {"house": "h"}
        views.append(View(f"v{number:05d}", rgb, depth, semantic, record, ids, annotate(ids, objects, STYLES)))
    write_shard(tmp_path / "views", "views-000000", views, house="h", config={"shrink": 2})
    network, metadata = load_network(SHIPPED_REDNET)
    save_network(tmp_path / "bare.safetensors", without_names(network), metadata)
    return tmp_path


def args_of(folder: Path, **changes: object) -> Args:
    views = (folder / "views",)
    chosen = {"weights": folder / "bare.safetensors", **changes}
    return Args(views=views, val_views=views, out=folder / "out", batch=4, **chosen)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("category", "style", "everyday_name", "name"),
    [
        ("appliances", "retro_fridge", "", "fridge"),
        ("appliances", "dishwasher", "", None),  # UNSEEN
        ("table", "wooden_table_ic0", "", None),  # of an imported model: its style says nothing
        ("table", "wooden_table_ic0", "desk", "desk"),
        ("table", "", "washing machine", None),
        ("table", "", "spaceship", None),
        ("window", "pane", "", None),
    ],
)
def test_labels_are_the_listed_names_that_training_may_use(category, style, everyday_name, name):
    annotation = Annotation(id=1, category_id=1, area=100, style=style, everyday_name=everyday_name)
    assert known_name(category, annotation) == name


@pytest.mark.costly
def test_the_head_learns_to_tell_names_apart_and_the_network_stays(folder: Path):
    trainer = Trainer(args_of(folder, val_count=8))
    for _ in range(20):
        trainer.train_once()
    right = trainer.evaluate(trainer.model.eval())[1]["right"]
    assert isinstance(right, float)
    assert right > 0.8
    trained = {name: tensor.clone() for name, tensor in trainer.model.state_dict().items()}
    average = trainer.average.module
    trainer.save(folder / "out/rednet.safetensors", average, {"val": {"right": right}})
    assert all(torch.equal(trained[name], tensor) for name, tensor in trainer.model.state_dict().items())
    network, metadata = load_network(folder / "out/rednet.safetensors")
    shipped, of_shipped = load_network(SHIPPED_REDNET)
    assert network.config.names == ("cooker", "fridge")
    state = network.state_dict()
    torch.testing.assert_close(
        state["names_head.layers.6.bias"], average.state_dict()["layers.6.bias"], atol=1e-3, rtol=1e-2
    )
    assert all(torch.equal(state[name], tensor) for name, tensor in without_names(shipped).state_dict().items())
    assert metadata["calibration"] == of_shipped["calibration"]
    assert metadata["names"]["val"]["right"] == right


@pytest.mark.costly
def test_without_names_that_share_a_category_no_share_of_right_ones_is_reported(folder: Path):
    trainer = Trainer(args_of(folder, val_count=2))
    trainer.groups = NameGroups.of(("bed", "fridge"))
    _, row, text = trainer.evaluate(trainer.model)
    assert (row["names"], row["right"]) == (0, "")
    assert "right" not in text


@pytest.mark.costly
def test_a_head_is_trained_further_with_its_own_names(folder: Path):
    first = Trainer(args_of(folder))
    file = folder / "w.safetensors"
    first.save(file, first.model, {})
    (folder / "out").rename(folder / "first")
    more = Trainer(args_of(folder, weights=file))
    assert more.names == first.names
    for one, other in zip(first.model.parameters(), more.model.parameters(), strict=True):
        torch.testing.assert_close(one, other, atol=1e-3, rtol=1e-2)  # files have 16 bits


def test_views_without_a_learned_name_cannot_evaluate_it(folder: Path):
    view = View("v00000", np.zeros((240, 320, 3), np.uint8), np.full((240, 320), 2000, np.uint16),
                np.zeros((240, 320), np.uint8), {"house": "h"}, np.zeros((240, 320), np.uint16), [])  # fmt: skip
    write_shard(folder / "bare", "views-000000", [view], house="h", config={"shrink": 2})
    with pytest.raises(ConfigError, match="--val-views show no object"):
        Trainer(replace(args_of(folder), val_views=(folder / "bare",)))


def test_views_with_one_name_cannot_train_it(folder: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(naming, "MIN_OBJECTS", 25)
    with pytest.raises(ConfigError, match="0 names with 25 objects"):
        Trainer(args_of(folder))
