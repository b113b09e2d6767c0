"""Items in other proportions than those of their styles."""

from __future__ import annotations

import numpy as np
import pytest

from sim.core.interface import GOAL_CATEGORIES
from sim.homes.housegen.furniture import CATALOGUE
from sim.homes.housegen.furniture.item import Geom, Item, Look, Pool
from sim.homes.housegen.furniture.reshape import may_reshape, reshaped
from sim.homes.housegen.furniture.shapes import Ring, loft
from sim.homes.housegen.furniture.transforms import geom_bounds

BOUNDS_M: dict[tuple[str, str], tuple[tuple[float, float], ...]] = {
    ("chair", "dining"): ((0.34, 0.95), (0.34, 0.95), (0.62, 1.25)),
    ("stool", "bar"): ((0.22, 0.85), (0.22, 0.85), (0.60, 1.25)),
    ("stool", "low"): ((0.2, 0.75), (0.2, 0.75), (0.36, 0.95)),
    ("table", "dining"): ((0.55, 1.4), (0.55, 2.6), (0.65, 0.85)),
    ("table", "nightstand"): ((0.25, 0.6), (0.28, 0.7), (0.36, 0.8)),
    ("cabinet", "wardrobe"): ((0.4, 0.85), (0.6, 2.4), (1.5, 2.45)),
    ("chest_of_drawers", "nightstand"): ((0.25, 0.65), (0.3, 0.75), (0.35, 1.05)),
    ("counter", "run"): ((0.5, 0.9), (0.9, 3.2), (0.75, 1.75)),
    ("plant", "floor"): ((0.15, 2.0), (0.15, 2.0), (0.3, 2.4)),
}
"""Smallest and largest depth, width and height of items of a use."""


def make(category: str, seed: int, pool: Pool = "train", **hints) -> Item:
    return CATALOGUE.make_item(category, np.random.default_rng(seed), pool=pool, reshape=True, **hints)


def shape_of(item: Item) -> tuple:
    """Returns the geometry of an item without its colours."""
    return tuple((g.shape, g.size_m, g.pos_m, g.euler_rad, g.mesh and g.mesh.name) for g in item.geoms)


@pytest.mark.parametrize("category", GOAL_CATEGORIES)
def test_same_seed_gives_the_same_shape(category):
    for seed in range(2):
        assert shape_of(make(category, seed)) == shape_of(make(category, seed))


@pytest.mark.costly
def test_about_half_of_the_items_have_a_shape_of_their_own():
    counts = np.zeros(2)
    for category in GOAL_CATEGORIES:
        for seed in range(6):
            style = CATALOGUE.make_item(category, np.random.default_rng(seed), pool="train").style
            plain = CATALOGUE.make_item(category, np.random.default_rng(seed), pool="train", style=style)
            counts[int(shape_of(plain) != shape_of(make(category, seed, style=style)))] += 1
    assert 0.35 < counts[1] / counts.sum() < 0.65


@pytest.mark.parametrize(("category", "use"), BOUNDS_M)
def test_sizes_stay_plausible(category, use):
    for seed in range(15):
        item = make(category, seed, use=use)
        for size, (low, high) in zip(item.size_m, BOUNDS_M[category, use], strict=True):
            assert low <= size <= high, (item.style, seed, item.size_m)


@pytest.mark.parametrize("category", ["counter", "picture"])
def test_width_hint_is_kept_exactly(category):
    for seed in range(8):
        assert make(category, seed, width_m=1.23).size_m[1] == pytest.approx(1.23, abs=0.03)


def test_reshaped_parts_still_touch_and_meshes_still_face_outwards():
    rings = [Ring(0.0, 0.1, 0.12), Ring(0.1, 0.2, 0.2), Ring(0.2, 0.1, 0.1)]
    geoms = (
        Geom("box", (0.3, 0.2, 0.1), (0.0, 0.05, 0.1), Look()),
        Geom("cylinder", (0.02, 0.2), (0.1, 0.1, 0.4), Look()),
        Geom("mesh", (), (0.0, 0.1, 0.6), Look(), mesh=loft(rings, 8)),
    )
    item = Item("chair", "stack", (0.6, 0.4, 0.8), geoms)
    assert may_reshape(item)
    for seed in range(10):
        made = reshaped(item, np.random.default_rng(seed), {})
        lows, highs = zip(*(geom_bounds(geom) for geom in made.geoms), strict=True)
        assert lows[0][2] == pytest.approx(0.0, abs=1e-3)
        assert highs[0][2] == pytest.approx(lows[1][2], abs=1e-3)
        assert highs[1][2] == pytest.approx(lows[2][2], abs=1e-3)
        mesh = made.geoms[2].mesh
        assert mesh is not None
        a, b, c = (mesh.vertices_m[mesh.faces[:, i]] for i in range(3))
        assert np.einsum("ij,ij->", a, np.cross(b, c)) > 0.0
        assert made.size_m == pytest.approx(np.max(highs, axis=0) - np.min(lows, axis=0), abs=1e-3)
