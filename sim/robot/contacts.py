"""What the hull touched during one action: which thing, where, in which direction it pushed, for how long."""

from __future__ import annotations

from dataclasses import dataclass, replace

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
        self.last_force = np.zeros(3)
        self.last_tick = -1
        self.ticks = 0


class ContactLog:
    """Collects the hull's contacts over one action, a sample each tick."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, labels: Labels, hull_geoms: tuple[int, ...]) -> None:
        self._model, self._data, self._labels = model, data, labels
        self._hull = frozenset(hull_geoms)
        self._wrench = np.zeros(6)
        self._touches: dict[int, _Touch] = {}
        self._tick = 0

    def clear(self) -> None:
        """Forget everything: a new action begins."""
        self._touches = {}
        self._tick = 0

    def sample(self) -> None:
        """Add the contacts that the data hold now; called at most once a tick."""
        self._tick += 1
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
            self._add(other, contacts.pos[index], force)

    def _add(self, geom: int, position: np.ndarray, force: np.ndarray) -> None:
        touch = self._touches.setdefault(geom, _Touch())
        if touch.last_tick != self._tick:
            touch.ticks += 1
            touch.last_tick = self._tick
            touch.last_force = np.zeros(3)
        weight = float(np.linalg.norm(force)) + 1e-9
        touch.weight += weight
        touch.position += weight * position
        touch.force += force
        touch.last_force = touch.last_force + force

    def contacts(self, tick_s: float, against: tuple[float, float] | None) -> tuple[Contact, ...]:
        """What was touched, in the order of first touch.

        Args:
            tick_s: time that one sample stands for.
            against: direction in plan of a motion that was given up at the last sample, (0, 0) for a turn; contacts
                of that sample which push against it `stopped` it. None when no motion was given up.
        """
        found = []
        for geom, touch in self._touches.items():
            stopped = False
            if against is not None and touch.last_tick == self._tick:
                along = against[0] * touch.last_force[0] + against[1] * touch.last_force[1]
                stopped = bool(along < 0.0) or against == (0.0, 0.0)
            found.append(replace(self._contact(geom, touch, tick_s), stopped=stopped))
        return tuple(found)

    def _contact(self, geom: int, touch: _Touch, tick_s: float) -> Contact:
        instance = int(self._labels.geom_instance[geom])
        size = float(np.linalg.norm(touch.force))
        direction = touch.force / size if size > 0.0 else np.zeros(3)
        return Contact(
            instance=self._labels.instances[instance].name if instance >= 0 else "",
            geom=self._model.geom(geom).name,
            position_m=_triple(touch.position / touch.weight),
            direction=_triple(direction),
            duration_s=touch.ticks * tick_s,
            stopped=False,
        )


def _triple(vector: np.ndarray) -> tuple[float, float, float]:
    x, y, z = vector.tolist()
    return x, y, z
