"""Records the contacts of the robot during one action: object, position, direction of the force, duration."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sim.gl import mujoco
from sim.houses.labels import Labels
from sim.robot.body import Body

SIDEWAYS = 0.3
"""Horizontal part of a unit normal: a wheel that stands on an edge lower than 5 % of its radius pushes less."""
SLOPING = 0.1
"""The same for a slope of 6 degrees, which stops a robot that nothing else has stopped."""


@dataclass(frozen=True)
class Contact:
    """One geom that the robot touched during an action."""

    instance: str
    """Name of the instance, for example `chair_03`; "" for a geom without a label."""
    geom: str
    """Name of the geom in the compiled world."""
    position_m: tuple[float, float, float]
    """Position in the world: the mean over the duration of the contact, weighted by force."""
    direction: tuple[float, float, float]
    """Unit vector of the force on the robot in the world; zero without a force."""
    duration_s: float
    """Duration of the contact, a multiple of the controller's tick."""
    stopped: bool
    """True: this contact pushed against the motion when the motion was aborted."""


class _Touch:
    """Sums over the contacts with one geom during an action."""

    def __init__(self) -> None:
        self.weight = 0.0
        self.position = np.zeros(3)
        self.force = np.zeros(3)
        self.last_tick = -1
        self.ticks = 0


class ContactLog:
    """Collects the contacts of the robot during one action, one sample per tick."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, labels: Labels, body: Body) -> None:
        self._model, self._data, self._labels = model, data, labels
        self._hull = frozenset(body.hull_geoms)
        self._tyres = np.array(body.tyre_geoms)
        self._all_parts = self._hull | frozenset(body.wheel_geoms)
        self._wrench = np.zeros(6)
        self._touches: dict[int, _Touch] = {}

    def clear(self) -> None:
        """Removes all samples; called at the start of an action."""
        self._touches = {}

    def compression_m(self) -> float:
        """Returns the depth to which the tyres are pressed into the ground now, the mean of their contacts."""
        contacts = self._data.contact
        depths = -contacts.dist[np.isin(contacts.geom, self._tyres).any(axis=1)]
        return float(depths.mean()) if len(depths) else 0.0

    def sample(self, tick: int, *, sideways: float | None = None) -> None:
        """Adds the current contacts of the hull at the end of one tick of the action.

        Args:
            tick: number of the tick.
            sideways: also those of wheels and casters with normals whose horizontal part is at least this, since they
                are not those with the ground below; None: only those of the hull.
        """
        contacts = self._data.contact
        parts = self._hull if sideways is None else self._all_parts
        for index, (first, second) in enumerate(contacts.geom.tolist()):
            if first in parts:
                part, other, sign = first, second, -1.0
            elif second in parts:
                part, other, sign = second, first, 1.0
            else:
                continue
            if part not in self._hull and math.hypot(*contacts.frame[index, :2].tolist()) < (sideways or 0.0):
                continue
            mujoco.mj_contactForce(self._model, self._data, index, self._wrench)
            # The rows of `frame` are the axes of the contact; the force acts on the second geom.
            force = sign * (self._wrench[:3] @ contacts.frame[index].reshape(3, 3))
            self._add(tick, other, contacts.pos[index], force)

    def _add(self, tick: int, geom: int, position: np.ndarray, force: np.ndarray) -> None:
        touch = self._touches.setdefault(geom, _Touch())
        if touch.last_tick != tick:
            touch.ticks += 1
            touch.last_tick = tick
        weight = float(np.linalg.norm(force)) + 1e-9
        touch.weight += weight
        touch.position += weight * position
        touch.force += force

    def contacts(self, tick_s: float) -> tuple[Contact, ...]:
        """Returns the contacts of a motion that reached its end, in order of first contact; a sample lasts `tick_s`."""
        return tuple(self._contact(geom, touch, tick_s, stopped=False) for geom, touch in self._touches.items())

    def contacts_of_aborted(
        self, tick_s: float, tick: int, since_tick: int, direction: tuple[float, float]
    ) -> tuple[Contact, ...]:
        """Returns the contacts of a motion that is aborted now, those of wheels and casters included.

        Args:
            tick_s: duration of one sample.
            tick: number of the present tick.
            since_tick: contacts of this tick or later have `stopped` the motion, unless they pushed along with it.
            direction: direction of the motion in plan; (0, 0) for a turn, which any contact may have stopped.
        """
        for sideways in (SIDEWAYS, SLOPING):
            self.sample(tick, sideways=sideways)
            contacts = self._contacts_of_aborted(tick_s, since_tick, direction)
            if any(contact.stopped for contact in contacts):
                break
        return contacts

    def _contacts_of_aborted(
        self, tick_s: float, since_tick: int, direction: tuple[float, float]
    ) -> tuple[Contact, ...]:
        """Returns the contacts so far; see `contacts_of_aborted`."""
        turning = direction == (0.0, 0.0)
        contacts = []
        for geom, touch in self._touches.items():
            along = float(direction[0] * touch.force[0] + direction[1] * touch.force[1])
            stopped = touch.last_tick >= since_tick and (turning or along <= 0.0)
            contacts.append(self._contact(geom, touch, tick_s, stopped=stopped))
        return tuple(contacts)

    def _contact(self, geom: int, touch: _Touch, tick_s: float, *, stopped: bool) -> Contact:
        instance = int(self._labels.geom_instance[geom])
        size = float(np.linalg.norm(touch.force))
        direction = touch.force / size if size > 0.0 else np.zeros(3)
        return Contact(
            instance=self._labels.instances[instance].name if instance >= 0 else "",
            geom=self._model.geom(geom).name,
            position_m=_triple(touch.position / touch.weight),
            direction=_triple(direction),
            duration_s=touch.ticks * tick_s,
            stopped=stopped,
        )


def _triple(vector: np.ndarray) -> tuple[float, float, float]:
    x, y, z = vector.tolist()
    return x, y, z
