"""Adds light to a scene without lamps: MuJoCo's default is a weak headlight, with which walls are nearly black."""

from __future__ import annotations

import numpy as np

from sim.gl import mujoco

MIN_AMBIENT = 0.3
"""A scene without lamps keeps its light if its headlight has at least this ambient part."""
AMBIENT, HEADLIGHT = 0.5, 0.2
"""Ambient and diffuse part of the headlight that is set."""
SIDES = (((0.45, 0.3, -0.85), 0.25), ((-0.6, -0.35, -0.7), 0.12))
"""Direction and strength of two added lights without shadows: the walls of a corner then differ in brightness."""


def add_light(spec: mujoco.MjSpec) -> tuple[str, ...]:
    """Adds light to a scene without lamps if its headlight is weak; returns a sentence if it has added light.

    A bare room of medium grey then has a mean grey level of about 80 of 255 in the images of the robot's camera.
    """
    head = spec.visual.headlight
    if any(light.active for light in spec.lights) or (head.active and np.mean(head.ambient) >= MIN_AMBIENT):
        return ()
    head.active = 1
    head.ambient, head.diffuse, head.specular = [AMBIENT] * 3, [HEADLIGHT] * 3, [0.0] * 3
    for direction, strength in SIDES:
        light = spec.worldbody.add_light()
        light.type = mujoco.mjtLightType.mjLIGHT_DIRECTIONAL
        light.pos, light.dir = [0.0, 0.0, 3.0], list(direction)
        light.ambient, light.diffuse, light.specular = [0.0] * 3, [strength] * 3, [0.0] * 3
        light.castshadow = False
    return ("Added light: the scene has no lamps and a weak headlight.",)
