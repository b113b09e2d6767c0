"""Micro-slip of the wheels: a rubber tyre that transmits a force turns more than it rolls, long before it slides.

By the brush model of a tyre (Pacejka, "Tire and vehicle dynamics", third edition 2012, section 3.2) a wheel with load N
on a surface of friction mu that pushes with a force F slips by

    s = 3 mu / c (1 - (1 - F / (mu N))^(1/3))

where c is the slip stiffness per load. It depends on the load, on the surface, and on what the wheel pushes. On carpet
the pile bends instead of the tread, which is softer, and the wheel also climbs out of its own print: the rolling
resistance of small wheels is about 0.01 of the load on hard floors and 0.05 on carpet. A tyre on a contact solver's
floor hardly creeps; hence the slip is added to what the encoders measure.
"""

from __future__ import annotations

import math

import numpy as np

from sim.gl import mujoco
from sim.robot.body import GRAVITY_M_S2, Body
from sim.robot.config import RobotConfig

HARD_STIFFNESS, SOFT_STIFFNESS = 15.0, 7.0
"""Slip stiffness per load, c. Tyres of cars have 10 to 25; that of carpet is an assumption."""
HARD_RESISTANCE, SOFT_RESISTANCE = 0.01, 0.05
"""Rolling resistance by load."""
FREE_SLIP = 0.001
"""Mean slip of forwards on a hard floor without a load, for which a base is calibrated; it was measured so."""
SOFT_TEXTURES = ("carpet", "rug")
"""Floors with a texture of such a name are carpet, and so are geoms of the same instance that show nothing."""


SURFACE_TICKS = 5
"""The surface below the wheels is found again after so many ticks of the controller: 5 cm at full speed."""


class Creep:
    """Computes the slip of both wheels from the forces and the surfaces at their tyres."""

    def __init__(self, config: RobotConfig, model: mujoco.MjModel, data: mujoco.MjData, body: Body) -> None:
        self._data, self._body, self._tick_s = data, body, config.drive.tick_s
        self._half_mass_kg, self._radius_m = 0.5 * config.body.mass_kg, config.wheels.radius_m
        self._side = {geom: int("right" in model.geom(geom).name) for geom in body.tyre_geoms}
        self._soft = frozenset(_soft_geoms(model))
        self.reset()

    def reset(self) -> None:
        """Starts an episode, at rest."""
        self._ticks, self._speeds = 0, (0.0, 0.0)
        self._surfaces = [(1.0, HARD_STIFFNESS, HARD_RESISTANCE)] * 2  # friction, stiffness, resistance

    def slip(self) -> tuple[float, float]:
        """Returns the slip of the left and the right wheel in the last tick of the controller.

        It is the share of the distance that a wheel rolls by which it turns more than it rolls: positive while the
        ground pushes the robot ahead. It is 0 for a wheel in the air.
        """
        if self._ticks % SURFACE_TICKS == 0:
            self._look()
        self._ticks += 1
        ahead, up = self._body.ahead_and_up()
        before, self._speeds = self._speeds, self._body.wheel_speeds()
        # Half of what the hull pushes and of what the slope takes; the rest accelerates the robot.
        _, x_n, y_n, z_n = self._body.touch.tolist()
        steady_n = 0.5 * (ahead[0] * x_n + ahead[1] * y_n + ahead[2] * z_n)
        steady_n += self._half_mass_kg * GRAVITY_M_S2 * ahead[2]
        slips = []
        for tread, last, speed, (friction, stiffness, resistance) in zip(
            self._body.treads.tolist(), before, self._speeds, self._surfaces, strict=True
        ):
            _, x_n, y_n, z_n = tread  # the tyre pushes the ground down
            load_n = -(up[0] * x_n + up[1] * y_n + up[2] * z_n)
            force_n = steady_n + self._half_mass_kg * self._radius_m * (speed - last) / self._tick_s
            slips.append(slip_of(force_n + math.copysign(resistance * load_n, speed), load_n, friction, stiffness))
        return slips[0], slips[1]

    def _look(self) -> None:
        """Notes the surfaces at which the tyres are."""
        contacts = self._data.contact
        friction = contacts.friction[:, 0].tolist()
        for index, (first, second) in enumerate(contacts.geom.tolist()):
            tyre, other = (first, second) if first in self._side else (second, first)
            if tyre in self._side:
                kind = (SOFT_STIFFNESS, SOFT_RESISTANCE) if other in self._soft else (HARD_STIFFNESS, HARD_RESISTANCE)
                self._surfaces[self._side[tyre]] = (friction[index], *kind)


def slip_of(force_n: float, load_n: float, friction: float, stiffness: float) -> float:
    """Returns the slip of a wheel by the brush model, with the sign of the force: at most 3 mu / c."""
    if load_n <= 0.0 or friction <= 0.0:
        return 0.0
    used = min(1.0, abs(force_n) / (friction * load_n))
    return math.copysign(3.0 * friction / stiffness * (1.0 - (1.0 - used) ** (1.0 / 3.0)), force_n)


def _soft_geoms(model: mujoco.MjModel) -> list[int]:
    """Returns the ids of the geoms of carpet."""
    textures = {number for number in range(model.ntex) if model.tex(number).name.startswith(SOFT_TEXTURES)}
    materials = {number for number in range(model.nmat) if textures.intersection(model.mat_texid[number].tolist())}
    shown = [geom for geom in range(model.ngeom) if int(model.geom_matid[geom]) in materials]
    instances = {_instance(model, geom) for geom in shown}
    unseen = np.flatnonzero(model.geom_matid < 0).tolist()
    return [*shown, *(geom for geom in unseen if _instance(model, geom) in instances)] if shown else []


def _instance(model: mujoco.MjModel, geom: int) -> str:
    """Returns the name of the instance of an unnamed geom (`sim.world.compile`), else that of the geom."""
    return model.geom(geom).name.partition(":")[0]
