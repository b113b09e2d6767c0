"""Reads the category and the instance of each geom from the names of geoms and bodies (docs/houses.md).

A label is a name `<category>_<number>` (`chair_03`, `chest_of_drawers_00`), with a category of mpcat40 in underscores.
A geom gets the first label among its own name, its body's name and the names of the body's ancestors; that name is its
instance. For third-party scenes, rules `{regex: category}` are tried before this pattern.
"""

from __future__ import annotations

import difflib
import re
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import regex
from numpy.typing import NDArray

from sim.core.errors import HouseError
from sim.core.interface import MPCAT40, MPCAT40_ID
from sim.gl import mujoco

COVER_MASK = (8, 0)
"""Contype and conaffinity of floors that only wheels and casters touch: furniture stands on the floor below."""
RENDERED_GROUPS = 3
"""Geoms of groups 0, 1 and 2 are rendered; those of group 3 and above are collision geoms only."""
VOID = "void"
ROBOT_PREFIX = "stubborn_robot/"
"""Prefix of every name of the robot in a compiled world. No house has it; other simulators write `robot/`."""
RULES_S = 5.0
"""Time for the label rules on all names of a house; those of a scene of 1,000 geoms take some milliseconds."""
MAX_RULE_CHARACTERS = 1000
_LABEL = re.compile(r"(?P<category>[A-Za-z][A-Za-z_]*)_(?P<number>\d+)")


@dataclass(frozen=True)
class Instance:
    """One labelled object: its name, its category and all its geoms, visual or not."""

    name: str
    category: str
    geom_ids: tuple[int, ...]


@dataclass(frozen=True)
class Labels:
    """Category and instance of each geom of one compiled model."""

    instances: tuple[Instance, ...]
    geom_category: NDArray[np.uint8]  # (ngeom,) mpcat40 id; 0: void
    geom_instance: NDArray[np.int32]  # (ngeom,) index into `instances`; -1: none
    void_geoms: int
    """Visible geoms without a label, other than the robot's; more than 0 only with rules."""

    def of_category(self, category: str) -> tuple[Instance, ...]:
        """Returns the instances of one category, in the model's order."""
        return tuple(instance for instance in self.instances if instance.category == category)

    def categories(self) -> tuple[str, ...]:
        """Returns the categories that have an instance, in the order of mpcat40."""
        present = {instance.category for instance in self.instances}
        return tuple(name for name in MPCAT40 if name in present)


def read_labels(
    model: mujoco.MjModel, *, rules: Mapping[str, str] | None = None, ignore_prefix: str = ROBOT_PREFIX
) -> Labels:
    """Returns the labels of a compiled house or world.

    Args:
        model: the compiled model.
        rules: regular expressions to search for in names, in this order, and the category of each ("void" is allowed).
            With rules, a visible geom without a label becomes void and is counted.
        ignore_prefix: a geom gets no label if its name or its body's name begins with it (the robot's); "" ignores
            no geom.

    Raises:
        HouseError: a visible geom has no label and no rules were given, or a rule is not valid.
    """
    compiled_rules = _compile_rules(rules)
    until_s = time.monotonic() + RULES_S
    category_of_geom = np.zeros(model.ngeom, dtype=np.uint8)
    instance_of_geom = np.full(model.ngeom, -1, dtype=np.int32)
    members: dict[str, tuple[str, list[int]]] = {}
    void_geoms = 0
    visible = rendered_geoms(model)
    ignored = geoms_of(model, ignore_prefix) if ignore_prefix else np.zeros(model.ngeom, dtype=np.bool_)
    for geom in np.flatnonzero(~ignored).tolist():
        names = names_of_geom(model, geom)
        owner, category = _first_label(names, compiled_rules, until_s)
        if category == VOID:
            if visible[geom]:
                if rules is None:
                    raise HouseError(_unlabelled(model, geom, names))
                void_geoms += 1
            continue
        members.setdefault(owner, (category, []))[1].append(geom)
        category_of_geom[geom] = MPCAT40_ID[category]
    instances = tuple(Instance(name, category, tuple(ids)) for name, (category, ids) in members.items())
    for index, instance in enumerate(instances):
        instance_of_geom[list(instance.geom_ids)] = index
    return Labels(instances, category_of_geom, instance_of_geom, void_geoms)


def categories_by_rules(names: Sequence[str], rules: Mapping[str, str]) -> dict[str, str]:
    """Returns the category of each name that matches a rule, by the first one; "void" is one of them.

    Raises:
        HouseError: a rule is not valid or takes too long.
    """
    compiled, until_s = _compile_rules(rules), time.monotonic() + RULES_S
    instances = {}
    for name in names:
        rule = _matching(name, compiled, until_s)
        if rule is not None:
            instances[name] = rule
    return instances


def rendered_geoms(model: mujoco.MjModel) -> NDArray[np.bool_]:
    """Returns (ngeom,) True for visual geoms: group below 3 and not fully transparent."""
    return (model.geom_group < RENDERED_GROUPS) & (opacity(model) > 0.0)


def collidable_geoms(model: mujoco.MjModel) -> NDArray[np.bool_]:
    """Returns (ngeom,) True for collision geoms."""
    return (model.geom_contype != 0) | (model.geom_conaffinity != 0)


def cover_geoms(model: mujoco.MjModel) -> NDArray[np.bool_]:
    """Returns (ngeom,) True for floor coverings, for example rugs: geoms with the masks `COVER_MASK`."""
    return (model.geom_contype == COVER_MASK[0]) & (model.geom_conaffinity == COVER_MASK[1])


def geoms_of(model: mujoco.MjModel, prefix: str) -> NDArray[np.bool_]:
    """Returns (ngeom,) True for a geom if its name or its body's name begins with `prefix`, such as the robot's."""
    bodies = np.array([model.body(body).name.startswith(prefix) for body in range(model.nbody)], dtype=np.bool_)
    named = np.array([model.geom(geom).name.startswith(prefix) for geom in range(model.ngeom)], dtype=np.bool_)
    return bodies[model.geom_bodyid] | named


def parse_label(name: str) -> str | None:
    """Returns the category of a name that is a label, else None."""
    match = _LABEL.fullmatch(name)
    if match is None or match["category"] not in MPCAT40_ID or match["category"] == VOID:
        return None
    return match["category"]


def suggest(category: str) -> str:
    """Returns `Did you mean 'chair'?`, or the list of categories when no category is similar."""
    names = [name for name in MPCAT40 if name != VOID]
    similar = difflib.get_close_matches(category.lower().replace("-", "_"), names, n=1)
    return f"Did you mean '{similar[0]}'?" if similar else f"The categories of mpcat40 are: {', '.join(names)}."


def describe_geom(model: mujoco.MjModel, geom: int) -> str:
    """Returns a description of a geom for error messages, also when it has no name."""
    name = model.geom(geom).name
    if name:
        return f"geom '{name}'"
    shape = mujoco.mjtGeom(model.geom_type[geom]).name.removeprefix("mjGEOM_").lower()
    body = model.body(model.geom_bodyid[geom]).name or "(unnamed)"
    x, y, z = model.geom_pos[geom]
    return f"the unnamed {shape} number {geom} at ({x:.2f}, {y:.2f}, {z:.2f}) in body '{body}'"


def names_of_geom(model: mujoco.MjModel, geom: int) -> tuple[str, ...]:
    """Returns the names of a geom, its body and the body's ancestors below the world; "" for unnamed ones.

    A geom that is unnamed with all its bodies is called `#<number>`, so that label rules can name it as well.
    """
    names = [model.geom(geom).name]
    body = int(model.geom_bodyid[geom])
    while body != 0:
        names.append(model.body(body).name)
        body = int(model.body_parentid[body])
    return tuple(names) if any(names) else (*names, f"#{geom}")


def opacity(model: mujoco.MjModel) -> NDArray[np.float32]:
    """Returns the rendered opacity (ngeom,): that of a geom's own colour, else of its material."""
    alpha = model.geom_rgba[:, 3].copy()
    default = np.all(model.geom_rgba == np.array([0.5, 0.5, 0.5, 1.0], dtype=np.float32), axis=1)
    by_material = default & (model.geom_matid >= 0)
    alpha[by_material] = model.mat_rgba[model.geom_matid[by_material], 3]
    return alpha


def _first_label(
    names: tuple[str, ...], rules: list[tuple[regex.Pattern[str], str]], until_s: float
) -> tuple[str, str]:
    """Returns the first name that is a label and its category; ("", "void") if no name is a label."""
    for name in names:
        if not name:
            continue
        category = _matching(name, rules, until_s) or parse_label(name)
        if category is not None:
            return name, category
    return "", VOID


def _matching(name: str, rules: list[tuple[regex.Pattern[str], str]], until_s: float) -> str | None:
    """Returns the category of the first rule that a name matches, or None."""
    for pattern, category in rules:
        try:
            match = pattern.search(name, timeout=max(1e-3, until_s - time.monotonic()))
        except TimeoutError:
            raise HouseError(
                f"label rule '{pattern.pattern}' takes too long on '{name}': all rules of a house have {RULES_S:g} "
                "s; write it without a repetition inside a repetition."
            ) from None
        if match:
            return category
    return None


def _compile_rules(rules: Mapping[str, str] | None) -> list[tuple[regex.Pattern[str], str]]:
    compiled = []
    for rule, category in (rules or {}).items():
        if category not in MPCAT40_ID:
            raise HouseError(f"label rule '{rule}' gives '{category}', which is not a category. {suggest(category)}")
        if len(rule) > MAX_RULE_CHARACTERS:
            raise HouseError(f"label rule '{rule[:40]}...' has {len(rule)} characters; at most {MAX_RULE_CHARACTERS}.")
        try:
            compiled.append((regex.compile(rule), category))
        except (regex.error, RecursionError, OverflowError) as error:
            raise HouseError(f"label rule '{rule}' is not a regular expression: {error}.") from None
    return compiled


def _unlabelled(model: mujoco.MjModel, geom: int, names: tuple[str, ...]) -> str:
    """Returns the error message for a visible geom without a label."""
    where = describe_geom(model, geom)
    for name in names:
        match = _LABEL.fullmatch(name)
        if match is not None:
            category = match["category"]
            return f"{where} is visible and named '{name}', but '{category}' is not a category. {suggest(category)}"
    return (
        f"{where} is visible and has no label: name it, its body or an ancestor <category>_<number>, for example "
        "chair_03."
    )
