"""Changes light and camera of training views, so that a network learns neither our lamps nor a level camera.

Of a house: lamps are off, dimmed, or warmer; the sun has another direction, height and strength; the ambient light
changes. Of a view: the body leans, as on rugs and ramps.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from sim.core.geometry.pose import BodyPose, Pose
from sim.gl import mujoco
from sim.houses.house import House

LAMP_OFF = 0.2
"""Share of the lamps that are off."""
DIMMED, AMBIENT = (0.5, 1.5), (0.6, 1.4)
"""Smallest and largest factor of a light, and of the ambient light."""
WARM = (1.12, 1.0, 0.78)
"""Factors of red, green and blue of the warmest light, about 2700 K; the coolest has their inverse to the power 0.4."""
SUN_HEIGHT_DEG = (25.0, 70.0)
LEANS, LEAN_DEG, MAX_LEAN_DEG = 0.4, 1.5, 6.0
"""Share of the views in which the body leans, standard deviation of pitch and roll, and their largest value."""


def with_other_light(house: House, rng: np.random.Generator) -> House:
    """Returns a house with other light; its name, geometry and labels are the same."""
    spec = house.spec.copy()
    head = spec.visual.headlight
    head.ambient = list(np.array(head.ambient) * rng.uniform(*AMBIENT))
    for light in spec.lights:
        if light.type == mujoco.mjtLightType.mjLIGHT_DIRECTIONAL:
            turn, height = rng.uniform(-math.pi, math.pi), math.radians(rng.uniform(*SUN_HEIGHT_DEG))
            light.dir = [math.cos(height) * math.cos(turn), math.cos(height) * math.sin(turn), -math.sin(height)]
        elif rng.random() < LAMP_OFF:
            light.active = False
        tint = np.array(WARM) ** rng.uniform(-0.4, 1.0)
        for name in ("diffuse", "specular"):
            setattr(light, name, list(np.clip(np.array(getattr(light, name)) * tint * rng.uniform(*DIMMED), 0.0, 1.0)))
    return replace(house, source=spec, checksum=None)  # what is kept of its file has the old light


def leaning(pose: Pose, rng: np.random.Generator) -> Pose:
    """Returns a pose, in a share of the cases with a body that leans."""
    if rng.random() >= LEANS:
        return pose
    pitch, roll = np.radians(np.clip(rng.normal(0.0, LEAN_DEG, 2), -MAX_LEAN_DEG, MAX_LEAN_DEG))
    return BodyPose(pose.x_m, pose.y_m, pose.yaw_rad, pose.floor_z_m, 0.0, float(pitch), float(roll))
