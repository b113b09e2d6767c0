"""What is left out of a scene from elsewhere so that it can be a house (with `--labels`), and said to be left out.

A house is things that stand, and things that can be pushed. Scenes from elsewhere also bring cameras, a robot's motors,
saved states, hinged doors. Cameras and all that drives or measures is dropped; what hangs on a hinge or a slide stands
still where the file has it; a free joint stays, so chairs and balls can be pushed.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from sim.gl import mujoco
from sim.houses.labels import Labels, rendered_geoms

MOST_NAMES = 8
"""Names that a sentence lists."""


def adopt(spec: mujoco.MjSpec) -> tuple[str, ...]:
    """Drop from a specification what no house holds; returns a sentence for each kind of thing that was changed."""
    dropped = [
        _dropped(spec, what, elements)
        for what, elements in (  # what refers to others goes before them
            ("keyframe", spec.keys),
            ("sensor", spec.sensors),
            ("actuator", spec.actuators),
            ("equality", spec.equalities),
            ("tendon", spec.tendons),
            ("camera", spec.cameras),
        )
    ]
    there = ", ".join(words for words in dropped if words)
    notes = [f"Left out: {there}."] if there else []
    fixed = [joint for joint in spec.joints if joint.type != mujoco.mjtJoint.mjJNT_FREE]
    names = [joint.name or joint.parent.name for joint in fixed]
    for joint in fixed:
        spec.delete(joint)
    if fixed:
        notes.append(f"Standing still where the file has them: what hangs on {_counted('joint', names)}.")
    return tuple(notes)


def tell_void(model: mujoco.MjModel, labels: Labels) -> tuple[str, ...]:
    """A sentence on what no rule gives a label, with the names that a rule could go by; none where all have one."""
    if not labels.void_geoms:
        return ()
    void = np.flatnonzero(rendered_geoms(model) & (labels.geom_category == 0))
    geoms = "1 visible geom has" if len(void) == 1 else f"{len(void)} visible geoms have"
    return (f"{geoms} no label and became void: {_listed(name_of(model, geom) for geom in void.tolist())}.",)


def name_of(model: mujoco.MjModel, geom: int) -> str:
    """The first name among a geom, its body and the body's ancestors; "(unnamed)" without one."""
    if name := model.geom(geom).name:
        return name
    body = int(model.geom_bodyid[geom])
    while body != 0:
        if name := model.body(body).name:
            return name
        body = int(model.body_parentid[body])
    return "(unnamed)"


def _dropped(spec: mujoco.MjSpec, what: str, elements: Iterable[Any]) -> str:
    """Delete elements; "2 cameras (front, top)", "" for none."""
    elements = list(elements)
    names = [element.name for element in elements]
    for element in elements:
        spec.delete(element)
    return _counted(what, names) if names else ""


def _counted(what: str, names: list[str]) -> str:
    number = f"{len(names)} {what}{'' if len(names) == 1 else 's'}"
    named = [name for name in names if name]
    return f"{number} ({_listed(named)})" if named else number


def _listed(names: Iterable[str]) -> str:
    """Each name once, with how often it comes; the first few."""
    counts: dict[str, int] = {}
    for name in names:
        counts[name] = counts.get(name, 0) + 1
    shown = [name if count == 1 else f"{name} ({count} x)" for name, count in counts.items()]
    more = f" and {len(shown) - MOST_NAMES} more" if len(shown) > MOST_NAMES else ""
    return ", ".join(shown[:MOST_NAMES]) + more
