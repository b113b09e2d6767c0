"""What the hull touched during one action: which thing, where, in which direction it pushed, for how long."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.gl import mujoco
from sim.houses.labels import Labels


@dataclass(frozen=True)
class Contact:
    """One thing that the hull touched during an action."""

    instance: str
    """Label of the thing, `chair_03`; "" for something without a label."""
    geom: str
    """Name of the geom in the world's model."""
    position_m: tuple[float, float, float]
    """Where they touched, in the world: the mean over the touch, weighted by force."""
    direction: tuple[float, float, float]
    """Unit vector of the force on the robot, in the world; zero where nothing pushed."""
    duration_s: float
    """How long they touched, in whole ticks of the controller."""
    stopped: bool
    """Whether this contact pushed against the motion when the motion was given up."""


class _Touch:
    """Sums over the ticks in which one geom was touched."""

    def __init__(self) -> None:
        self.weight = 0.0
        self.position = np.zeros(3)
        self.force = np.zeros(3)
        self.last_tick = -1
        self.ticks = 0


class ContactLog:
    """Collects the hull's contacts over one action, a sample each tick."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, labels: Labels, hull_geoms: tuple[int, ...]) -> None:
        self._model, self._data, self._labels = model, data, labels
        self._hull = frozenset(hull_geoms)
        self._wrench = np.zeros(6)
        self._touches: dict[int, _Touch] = {}

    def clear(self) -> None:
        """Forget everything: a new action begins."""
        self._touches = {}

    def sample(self, tick: int) -> None:
        """Add the contacts that the data hold now, at the end of one tick of the action."""
        contacts = self._data.contact
        for index, (first, second) in enumerate(contacts.geom.tolist()):
            if first in self._hull:
                other, sign = second, -1.0
            elif second in self._hull:
                other, sign = first, 1.0
            else:
                continue
            mujoco.mj_contactForce(self._model, self._data, index, self._wrench)
            # The rows of `frame` are the contact's axes; the force is the one on the second geom.
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
        """What was touched in a motion that arrived, in the order of first touch; one sample stands for `tick_s`."""
        return tuple(self._contact(geom, touch, tick_s, stopped=False) for geom, touch in self._touches.items())

    def contacts_of_stop(self, tick_s: float, since_tick: int, against: tuple[float, float]) -> tuple[Contact, ...]:
        """What was touched in a motion that was given up.

        Args:
            tick_s: time that one sample stands for.
            since_tick: contacts of this tick or later `stopped` it, but for those that pushed with the motion.
            against: direction of the motion in plan; (0, 0) for a turn, which any contact may hold back.
        """
        turning = against == (0.0, 0.0)
        found = []
        for geom, touch in self._touches.items():
            along = float(against[0] * touch.force[0] + against[1] * touch.force[1])
            stopped = touch.last_tick >= since_tick and (turning or along <= 0.0)
            found.append(self._contact(geom, touch, tick_s, stopped=stopped))
        return tuple(found)

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
