"""The facts that a house file states about an item: its everyday name, and what most of its surface is.

The surface of an item is that of its own geoms, without the items on it. Colour and material are each stated if one of
them covers at least `CLEAR_SHARE` of the surface.
"""

from __future__ import annotations

import functools
import math
from collections import defaultdict
from collections.abc import Mapping

import numpy as np

from sim.core.colours import clear_colour_name
from sim.homes.housegen.furniture.item import Geom, Item, Look
from sim.homes.housegen.furniture.names import name_of_style
from sim.homes.housegen.mjcf.triangles import triangle_areas
from sim.homes.housegen.surfaces.textures import mean_colour
from sim.houses.instance_facts import InstanceFacts

CLEAR_SHARE = 0.6
"""Smallest share of the surface with one colour, or of one material, that is stated."""
_NAMELESS = frozenset(("wall", "floor", "ceiling", "stairs"))
"""Categories of the building without facts; a rug, which is labelled floor, has them."""
_MATERIAL_WORDS = {
    "wood": "wood", "lacquer": "lacquer", "fabric": "fabric", "linen": "fabric", "bedding": "fabric",
    "towel": "fabric", "curtain": "fabric", "sheer": "fabric", "denim": "fabric", "rug": "fabric",
    "leather": "leather", "chrome": "metal", "metal": "metal", "steel": "metal", "iron": "metal", "brass": "metal",
    "appliance": "metal", "glass": "glass", "mirror": "glass", "stone": "stone", "ceramic": "ceramic",
    "plastic": "plastic", "wicker": "wicker", "cardboard": "cardboard", "paper": "paper", "rubber": "rubber",
}  # fmt: skip
"""The word for each material of `sim.homes.housegen.surfaces.materials`; the others have none."""
_PICTURES = frozenset(("books", "small", "rug", "mirror", "masonry", "screen"))
"""Materials whose texture is a picture of several colours, or that show something else."""


def facts_of(item: Item) -> InstanceFacts:
    """Returns the name of an item and the colour and material of most of its surface."""
    if item.category in _NAMELESS and item.mount == "floor" and not item.walk_over:
        return InstanceFacts()
    colours: defaultdict[str | None, float] = defaultdict(float)
    words: defaultdict[str | None, float] = defaultdict(float)
    for geom in item.geoms:
        area_m2 = _surface_m2(geom)
        words[_material_word(geom.look)] += area_m2
        colours[_colour(geom.look)] += area_m2
    name = item.name or name_of_style(item.category, item.style)
    return InstanceFacts(name, _most(colours), _most(words))  # type: ignore[arg-type]


def _most(areas_m2: Mapping[str | None, float]) -> str | None:
    """Returns the value that covers enough of the whole area."""
    if not areas_m2:
        return None
    value, area_m2 = max(areas_m2.items(), key=lambda item: item[1])
    return value if area_m2 >= CLEAR_SHARE * sum(areas_m2.values()) else None


def _material_word(look: Look) -> str | None:
    if look.material == "masonry":
        return "brick" if look.texture is not None and look.texture.startswith("brick") else "stone"
    return _MATERIAL_WORDS.get(look.material)


@functools.lru_cache(maxsize=4096)
def _colour(look: Look) -> str | None:
    """Returns the name of the mean colour of a look; None if no name is clear, or it shows several colours."""
    if look.rgba[3] < 1.0 or look.material in _PICTURES or (look.texture or "").startswith("view_"):
        return None
    mean = (1.0, 1.0, 1.0) if look.texture is None else mean_colour(look.texture)
    return clear_colour_name(np.multiply(look.rgba[:3], mean))


def _surface_m2(geom: Geom) -> float:
    """Returns the area of a geom's surface; that of an ellipsoid by Thomsen's formula (error at most 1.1 %)."""
    if geom.shape == "mesh":
        if geom.mesh is None or not len(geom.mesh.faces):
            return 0.0
        return float(triangle_areas(geom.mesh.vertices_m[geom.mesh.faces]).sum())
    size = geom.size_m
    if geom.shape == "box":
        x, y, z = size
        return 8.0 * (x * y + y * z + z * x)
    if geom.shape == "sphere":
        return 4.0 * math.pi * size[0] ** 2
    if geom.shape == "ellipsoid":
        p = 1.6075
        x, y, z = (side**p for side in size)
        return float(4.0 * math.pi * ((x * y + y * z + z * x) / 3.0) ** (1.0 / p))
    radius, half = size[0], size[1]
    ends = 4.0 * math.pi * radius**2 if geom.shape == "capsule" else 2.0 * math.pi * radius**2
    return 4.0 * math.pi * radius * half + ends
