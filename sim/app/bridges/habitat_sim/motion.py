"""Rigid states and their integration: what habitat-lab's action `velocity_control` needs."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from sim.app.bridges.habitat_sim.maths import Quaternion, Vector3


class RigidState:
    """A rotation (magnum's) and a place (3,)."""

    def __init__(self, rotation: Quaternion | None = None, translation: Any = (0.0, 0.0, 0.0)) -> None:
        self.rotation = rotation or Quaternion()
        self.translation = Vector3(translation)


class VelocityControl:
    """A linear velocity, m/s, and an angular one, rad/s, about the axes of the body."""

    def __init__(self) -> None:
        self.controlling_lin_vel = self.controlling_ang_vel = False
        self.lin_vel_is_local = self.ang_vel_is_local = False
        self.linear_velocity: Any = np.zeros(3)
        self.angular_velocity: Any = np.zeros(3)

    def integrate_transform(self, dt: float, rigid_state: RigidState) -> RigidState:
        """Returns the state after `dt` seconds: the place moves first, then the body turns, as in habitat-sim."""
        rotation, place = rigid_state.rotation, rigid_state.translation
        if self.controlling_lin_vel:
            along = np.asarray(self.linear_velocity, np.float64)
            moved = rotation.transform_vector(along) if self.lin_vel_is_local else along
            place = Vector3(np.asarray(place) + dt * np.asarray(moved))
        if self.controlling_ang_vel:
            rate = np.asarray(self.angular_velocity, np.float64)
            size = float(np.linalg.norm(rate))
            if size > 0.0:
                turn = Quaternion.rotation(math.fmod(dt * size, math.tau), rate / size)
                rotation = rotation * turn if self.ang_vel_is_local else turn * rotation
        return RigidState(rotation.normalized(), place)
