"""Appearance and sizes of furniture: visible glass tops, light toilet bowls, leaves that are not discs."""

from __future__ import annotations

import numpy as np
import pytest

from sim.homes.housegen.furniture import CATALOGUE
from sim.homes.housegen.furniture.item import Item
from sim.homes.housegen.mjcf.boxes import geom_box
from sim.homes.housegen.mjcf.merging import assemble

PLANTS = [(s.pool, s.name) for s in CATALOGUE.styles("plant")]
TOILETS = [(s.pool, s.name) for s in CATALOGUE.styles("toilet")]


def made(category: str, pool: str, style: str, seed: int) -> Item:
    return CATALOGUE.make_item(category, np.random.default_rng(seed), pool=pool, style=style)  # type: ignore[arg-type]


@pytest.mark.parametrize("pool", ["train", "heldout"])
def test_the_sides_of_a_glass_top_are_opaque_and_the_glass_is_tinted(pool):
    found = 0
    for style in CATALOGUE.styles("table", pool):
        for seed in range(6):
            item = made("table", style.pool, style.name, seed)
            boxes = [(geom_box(g), g.look.rgba[3]) for g in item.geoms if g.shape == "box"]
            for top, alpha in boxes:
                if alpha == 1.0 or not any(abs(surface.centre_m[2] - top[5]) < 1e-3 for surface in item.surfaces):
                    continue
                found += 1
                assert alpha >= 0.5
                for axis, end in ((0, 0), (0, 3), (1, 1), (1, 4)):
                    side = 1 - axis
                    solid = [box for box, opaque in boxes if opaque == 1.0 and abs(box[5] - top[5]) < 0.02]
                    edges = [box for box in solid if box[axis] - 0.01 <= top[end] <= box[axis + 3] + 0.01]
                    long = max((box[side + 3] - box[side] for box in edges), default=0.0)
                    assert long > 0.9 * (top[side + 3] - top[side]), f"{style.name}: side {end} has no edge"
    assert found > 0


@pytest.mark.parametrize(("pool", "style"), TOILETS)
def test_the_bowl_of_a_toilet_is_light(pool, style):
    bowls = [
        geom for seed in range(12) for geom in made("toilet", pool, style, seed).geoms if geom.shape == "ellipsoid"
    ]
    assert bowls, "some lids are up"
    assert min(np.mean(geom.look.rgba[:3]) for geom in bowls) > 0.6


@pytest.mark.parametrize(("pool", "style"), PLANTS)
def test_leaves_are_no_discs_and_are_few_geoms(pool, style):
    for seed in range(3):
        item = made("plant", pool, style, seed)
        round_sizes = [geom.size_m for geom in item.geoms if geom.shape == "ellipsoid"]
        assert all(min(size) > 0.2 * max(size) for size in round_sizes)
        assembled = assemble(item).visual
        assert len(assembled) <= 12
        assert sum(len(geom.mesh.faces) for geom in assembled if geom.mesh) <= 450


@pytest.mark.parametrize("pool", ["train", "heldout"])
def test_bathtubs_leave_room_in_a_bathroom(pool):
    for style in CATALOGUE.styles("bathtub", pool):
        for seed in range(4):
            depth, width, _ = made("bathtub", pool, style.name, seed).size_m
            limit = 1.5 if style.name == "corner" else 0.95
            assert depth <= limit, style.name
            assert width <= 1.9, style.name


@pytest.mark.parametrize(("use", "low_m", "high_m"), [("dining", 0.70, 0.79), ("coffee", 0.28, 0.50)])
def test_tables_are_as_high_as_real_ones(use, low_m, high_m):
    for pool in ("train", "heldout"):
        for style in CATALOGUE.styles("table", pool, use):
            top = max(surface.centre_m[2] for surface in made("table", style.pool, style.name, 0).surfaces)
            assert low_m <= top <= high_m, style.name
