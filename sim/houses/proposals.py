"""Proposes label rules for a scene from elsewhere, from the names and the sizes of its geoms (`stubborn label`).

A rule is proposed for each name with a word of `WORDS` in it (`Couch.001`, `wall_left_visual`, `hingecabinet`), unless
an enclosing body already has that category: a sofa with a named leg stays one instance. Visible geoms without such a
name are judged by their size: large flat ones at z = 0 are floor, large thin upright ones are wall. The others become
`void`, with a rule of their own for the user to edit. Names that differ only in their numbers share a rule.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.core.interface import MPCAT40
from sim.gl import mujoco
from sim.houses.geoms import data_at_rest, world_boxes
from sim.houses.labels import VOID, Labels, collidable_geoms, names_of_geom, rendered_geoms
from sim.houses.taxonomies import category_of_ending, words_of

WORDS: Mapping[str, tuple[str, ...]] = {
    "wall": ("backwall", "partition", "perimeter"),
    "floor": ("ground", "carpet", "rug", "terrain", "pitch", "parquet"),
    "ceiling": ("roof",),
    "chair": ("armchair", "seat"),
    "table": ("desk", "workbench"),
    "door": ("gate", "doorway", "doorframe"),
    "picture": ("painting", "poster", "photo"),
    "cabinet": ("cupboard", "wardrobe", "closet", "sideboard", "locker"),
    "cushion": ("pillow",),
    "sofa": ("couch", "settee", "loveseat"),
    "bed": ("bunk", "mattress"),
    "curtain": ("drape",),
    "chest_of_drawers": ("dresser", "commode", "drawers", "nightstand"),
    "plant": ("tree", "bush", "flower", "flowerpot"),
    "sink": ("basin", "washbasin"),
    "stairs": ("stair", "stairway", "steps"),
    "toilet": ("wc",),
    "stool": ("barstool", "ottoman", "pouf"),
    "tv_monitor": ("tv", "television", "monitor", "screen"),
    "bathtub": ("tub", "bath"),
    "counter": ("worktop", "countertop", "kitchenette"),
    "column": ("pillar", "pole"),
    "lighting": ("lamp", "chandelier", "bulb"),
    "railing": ("banister", "handrail", "fence"),
    "shelving": ("shelf", "bookcase", "rack", "bookshelf"),
    "gym_equipment": ("treadmill", "dumbbell", "barbell", "goalpost", "gym"),
    "seating": ("bench", "pew"),
    "board_panel": ("whiteboard", "blackboard", "panel"),
    "appliances": (
        "oven", "fridge", "refrigerator", "microwave", "dishwasher", "stove", "cooker", "hood", "freezer", "washer",
    ),
    "clothes": ("coat", "jacket", "shirt"),
    "objects": (
        "ball", "book", "bottle", "bread", "can", "cereal", "cup", "kettle", "laptop", "lemon", "milk", "mug",
        "plate", "pot", "basket", "bin", "crate", "bag", "lid", "toy", "clock", "vase",
    ),
}  # fmt: skip
"""For each category, words that name it, in addition to the category's own name."""
PARTS = ("seat", "seats")
"""Words for a part of a larger object, if another word says which one: `toilet_seat`, or a seat in the body `sofa`."""
MIN_ENDING = 4
"""A word with at least this many characters is also found at the end of a longer one: `hingecabinet`, `backwall`."""
FLAT_M = 0.3
"""Largest thickness of a wall, a floor or a ceiling that is recognized by its size."""
LARGE_M = 1.5
"""Least sides of such a floor."""
LONG_M = 1.0
"""Least length of such a wall."""
TALL_M = 1.5
"""Least height of such a wall."""
AT_FLOOR_M = 0.05
"""Largest distance of a floor's top from z = 0."""
CEILING_FROM_M = 2.0
LARGEST_M: Mapping[str, float] = {
    "chair": 1.6, "table": 4.0, "picture": 3.0, "cushion": 1.2, "sofa": 4.5, "bed": 3.0, "chest_of_drawers": 3.0,
    "plant": 4.0, "sink": 2.5, "toilet": 1.5, "stool": 1.2, "towel": 2.0, "tv_monitor": 3.0, "bathtub": 2.5,
}  # fmt: skip
"""Largest plausible side of an instance; a larger one is marked in the table."""
SMALLEST_M = 0.1
"""Smallest plausible longest side of an instance of these categories."""


@dataclass(frozen=True)
class Proposal:
    """A label for the geoms with one name."""

    name: str
    """Name of the geom or of a body around it; `#12` is the unnamed geom number 12."""
    category: str
    reason: str
    """`name`, `size` or `unknown`."""


def propose(model: mujoco.MjModel) -> tuple[Proposal, ...]:
    """Returns a proposal for each name that needs a rule, in the order of the model's geoms.

    Args:
        model: a scene without its robot, compiled; `sim.houses.foreign.remove_unsupported` has been applied.
    """
    data = data_at_rest(model)
    visible, collides = rendered_geoms(model), collidable_geoms(model)
    accepted: dict[str, Proposal] = {}
    unknown: list[list[str]] = []
    around: set[str] = set()  # names of bodies that hold an object of a known category
    for geom in np.flatnonzero(visible | collides).tolist():
        names = [name for name in names_of_geom(model, geom) if name]
        proposals = list(_by_name(names))
        if not proposals and visible[geom]:
            category = category_by_size(*geom_box(model, data, geom), movable=_is_movable(model, geom))
            proposals = [Proposal(names[0], category, "size")] if category else []
            unknown += [] if category else [names]
        around |= {name for proposal in proposals for name in names[names.index(proposal.name) :]}
        accepted |= {proposal.name: proposal for proposal in proposals if proposal.name not in accepted}
    for names in unknown:
        name = next((name for name in reversed(names) if name not in around), names[0])
        accepted.setdefault(name, Proposal(name, VOID, "unknown"))
    return tuple(accepted.values())


def rules_of(proposals: tuple[Proposal, ...]) -> dict[str, str]:
    """Returns label rules: a regular expression for each name, names that differ only in their numbers together."""
    groups: dict[tuple[str, str], list[str]] = {}
    for proposal in proposals:
        groups.setdefault((re.sub(r"\d+", "0", proposal.name), proposal.category), []).append(proposal.name)
    stems = [stem for stem, _ in groups]
    rules = {}
    for (stem, category), names in groups.items():
        alone = len(names) == 1 or stems.count(stem) > 1  # the same stem has names of another category
        for pattern in [_exact(name) for name in names] if alone else [_any_number(stem)]:
            rules[pattern] = category
    return rules


def void_objects(model: mujoco.MjModel, labels: Labels) -> dict[str, list[int]]:
    """Returns the visible geoms without a category by their name: the outermost one that holds no labelled geom."""
    labelled = np.flatnonzero(labels.geom_category != 0).tolist()
    around = {name for geom in labelled for name in names_of_geom(model, geom)}
    objects: dict[str, list[int]] = {}
    for geom in np.flatnonzero(rendered_geoms(model) & (labels.geom_category == 0)).tolist():
        names = [name for name in names_of_geom(model, geom) if name]
        outermost = next((name for name in reversed(names) if name not in around), names[0])
        objects.setdefault(outermost, []).append(geom)
    return objects


def category_of_name(name: str) -> str | None:
    """Returns the category of a name by its last word of `WORDS` or its last name of the table, or None."""
    words = words_of(name)
    joined = "_".join(words)
    for category in MPCAT40:
        if "_" in category and category in joined:
            return category
    for end in range(len(words), 0, -1):
        if category := category_of_ending(words[:end]) or _category_of_word(words[end - 1]):
            whole = category_of_name("_".join(words[: end - 1])) if words[end - 1] in PARTS else None
            return whole or category
    return None


def category_by_size(low_m: NDArray[np.float64], high_m: NDArray[np.float64], *, movable: bool = False) -> str | None:
    """Returns floor, wall or ceiling for a box (3,), (3,) around a geom that has the size of one; else None."""
    x, y, z = (high_m - low_m).tolist()
    if movable:
        return None
    if z <= FLAT_M and min(x, y) >= LARGE_M:
        if abs(high_m[2]) <= AT_FLOOR_M:
            return "floor"
        return "ceiling" if low_m[2] >= CEILING_FROM_M else None
    if z >= TALL_M and min(x, y) <= FLAT_M and max(x, y) >= LONG_M:
        return "wall"
    return None


def size_doubt(category: str, size_m: NDArray[np.float64]) -> str:
    """Returns "too large" or "too small" if a size (3,) is implausible for the category; else ""."""
    if category not in LARGEST_M:
        return ""
    longest = float(size_m.max())
    return "too large" if longest > LARGEST_M[category] else "too small" if longest < SMALLEST_M else ""


def geom_box(model: mujoco.MjModel, data: mujoco.MjData, geom: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Returns the lowest and the highest corner (3,) of the box around a geom in the world, metres.

    A plane is its rendered rectangle, or 200 m wide without one.
    """
    if model.geom_type[geom] != mujoco.mjtGeom.mjGEOM_PLANE:
        low, high = world_boxes(model, data, [geom])
        return low[0], high[0]
    half = np.array([*np.where(model.geom_size[geom, :2] > 0.0, model.geom_size[geom, :2], 100.0), 0.0])
    reach = np.abs(data.geom_xmat[geom].reshape(3, 3)) @ half
    return data.geom_xpos[geom] - reach, data.geom_xpos[geom] + reach


def box_around(
    model: mujoco.MjModel, data: mujoco.MjData, geoms: Iterable[int]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Returns the lowest and the highest corner (3,) of the box around geoms in the world, metres."""
    boxes = [geom_box(model, data, geom) for geom in geoms]
    return np.min([low for low, _ in boxes], axis=0), np.max([high for _, high in boxes], axis=0)


def _by_name(names: list[str]) -> Iterator[Proposal]:
    """Yields a proposal for each name with a category, from outside; a repeated category is the same object."""
    around = None
    for name in reversed(names):
        category = category_of_name(name)
        is_part = around is not None and words_of(name)[-1:] in [(word,) for word in PARTS]
        if category is not None and category != around and not is_part:
            yield Proposal(name, category, "name")
            around = category


def _category_of_word(word: str) -> str | None:
    for candidate in (word, word.removesuffix("s"), word.removesuffix("es")):
        if candidate in _CATEGORY_OF:
            return _CATEGORY_OF[candidate]
    for known in sorted(_CATEGORY_OF, key=len, reverse=True):
        if len(known) >= MIN_ENDING and (word.endswith(known) or word.removesuffix("s").endswith(known)):
            return _CATEGORY_OF[known]
    return None


_CATEGORY_OF = {
    category: category for category in MPCAT40 if category not in (VOID, "misc") and "_" not in category
} | {word: category for category, words in WORDS.items() for word in words}


def _is_movable(model: mujoco.MjModel, geom: int) -> bool:
    return bool(model.body_weldid[model.geom_bodyid[geom]] != 0)


def _exact(name: str) -> str:
    return f"^{_escape(name)}$"


def _any_number(stem: str) -> str:
    return "^" + r"\d+".join(_escape(part) for part in stem.split("0")) + "$"


def _escape(text: str) -> str:
    """Returns a regular expression for a text, in which only signs with a meaning are escaped, for readers."""
    return re.sub(r"([\\.^$*+?{}\[\]|()])", r"\\\1", text)
