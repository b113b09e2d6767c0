"""Removes elements that the house format does not allow from third-party scenes (`--labels`), and reports them.

A house consists of static and of freely movable objects. Other scenes also contain cameras, actuators, saved states and
hinged doors. Cameras, actuators, sensors and constraints are removed. Hinge, slide and ball joints are removed too, so
that their bodies stay in the pose of the file. Free joints remain, so that chairs and balls can be pushed.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from typing import Any

import numpy as np

from sim.core.interface import MPCAT40_ID
from sim.core.vocabulary import counted
from sim.gl import mujoco
from sim.houses.labels import Labels, collidable_geoms, names_of_geom, rendered_geoms

MAX_NAMES = 8
"""Most names that a sentence lists."""


def remove_unsupported(spec: mujoco.MjSpec) -> tuple[str, ...]:
    """Removes the elements that a house may not contain; returns a sentence for each kind of change."""
    spec.compiler.discardvisual = False  # visual geoms belong to the house, and geoms keep their numbers
    removed = [
        _remove(spec, kind, elements)
        for kind, elements in (  # an element goes before those that it refers to
            ("keyframe", spec.keys),
            ("sensor", spec.sensors),
            ("actuator", spec.actuators),
            ("equality constraint", spec.equalities),
            ("tendon", spec.tendons),
            ("camera", spec.cameras),
        )
    ]
    counts = ", ".join(count for count in removed if count)
    notes = [f"Removed: {counts}."] if counts else []
    fixed = [joint for joint in spec.joints if joint.type != mujoco.mjtJoint.mjJNT_FREE]
    names = [joint.name or joint.parent.name for joint in fixed]
    for joint in fixed:
        spec.delete(joint)
    if fixed:
        notes.append(f"Fixed in the pose of the file: {_count('joint', names)}.")
    return tuple(notes)


def make_walls_solid(spec: mujoco.MjSpec, model: mujoco.MjModel, labels: Labels) -> tuple[str, ...]:
    """Lets boxes collide that are labelled wall and only visual in the file; returns a sentence that lists them.

    Robots that are bolted to the floor need no solid walls, so that the scenes of arms often have none. A mesh stays
    visual: it would collide as its convex hull, without its doorways.

    Args:
        spec: of the scene; it was compiled to `model`.
        model: the compiled model.
        labels: of the model.
    """
    walls = (labels.geom_category == MPCAT40_ID["wall"]) & ~collidable_geoms(model)
    walls &= model.geom_type == mujoco.mjtGeom.mjGEOM_BOX
    names = []
    for geom in spec.geoms:
        if walls[geom.id]:
            geom.contype = geom.conaffinity = 1
            names.append(_first_name(model, geom.id))
    return (f"Made solid: {_count('visual wall', names)}.",) if names else ()


def void_notes(model: mujoco.MjModel, labels: Labels) -> tuple[str, ...]:
    """Returns a sentence that lists the visible geoms without a label; nothing when all have one."""
    if not labels.void_geoms:
        return ()
    void = np.flatnonzero(rendered_geoms(model) & (labels.geom_category == 0))
    geoms = "1 visible geom has" if len(void) == 1 else f"{len(void)} visible geoms have"
    return (f"{geoms} no label and became void: {_list(_first_name(model, geom) for geom in void.tolist())}.",)


def _first_name(model: mujoco.MjModel, geom: int) -> str:
    """Returns the first name among a geom, its body and the body's ancestors; "#<number>" if all are unnamed."""
    return next(name for name in names_of_geom(model, geom) if name)


def _remove(spec: mujoco.MjSpec, kind: str, elements: Iterable[Any]) -> str:
    """Deletes elements; returns, for example, "2 cameras (front, top)", or "" if the list is empty."""
    elements = list(elements)
    names = [element.name for element in elements]
    for element in elements:
        spec.delete(element)
    return _count(kind, names) if names else ""


def _count(kind: str, names: list[str]) -> str:
    number = counted(len(names), kind)
    named = [name for name in names if name]
    return f"{number} ({_list(named)})" if named else number


def _list(names: Iterable[str]) -> str:
    """Returns the first `MAX_NAMES` different names, each with its number of occurrences."""
    shown = [name if count == 1 else f"{name} ({count} x)" for name, count in Counter(names).items()]
    more = f" and {len(shown) - MAX_NAMES} more" if len(shown) > MAX_NAMES else ""
    return ", ".join(shown[:MAX_NAMES]) + more
