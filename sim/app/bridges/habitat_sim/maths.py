"""Vectors and quaternions: the small part of magnum that habitat-lab uses, and `habitat_sim.utils.common`."""

from __future__ import annotations

import colorsys
import math
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import numpy as np
import quaternion as _quaternion
from numpy.typing import ArrayLike, NDArray


class Deg(float):
    """An angle in degrees."""


class Rad(float):
    """An angle in radians."""

    def __new__(cls, angle: float) -> Rad:
        """Returns an angle given in either unit."""
        return super().__new__(cls, _radians(angle))


class Vector3(np.ndarray):
    """A vector (3,) of float32 that NumPy can compute with; `list` of it gives floats of Python, as of magnum's."""

    def __new__(cls, *values: Any) -> Vector3:
        """Returns the vector of three numbers, of one for all three, or of an array."""
        given = values[0] if len(values) == 1 else values or (0.0, 0.0, 0.0)
        return np.broadcast_to(np.asarray(given, np.float32), (3,)).copy().view(cls)

    def __iter__(self) -> Iterator[Any]:  # pyright: ignore[reportIncompatibleMethodOverride]
        return iter(self.tolist())

    @classmethod
    def zero_init(cls) -> Vector3:
        """Returns the vector of zeros."""
        return cls(0.0)

    @classmethod
    def x_axis(cls, length: float = 1.0) -> Vector3:
        """Returns the vector to the right."""
        return cls(length, 0.0, 0.0)

    @classmethod
    def y_axis(cls, length: float = 1.0) -> Vector3:
        """Returns the vector up."""
        return cls(0.0, length, 0.0)

    @classmethod
    def z_axis(cls, length: float = 1.0) -> Vector3:
        """Returns the vector back."""
        return cls(0.0, 0.0, length)

    @property
    def x(self) -> float:
        """The component to the right."""
        return float(self[0])

    @property
    def y(self) -> float:
        """The component up."""
        return float(self[1])

    @property
    def z(self) -> float:
        """The component back."""
        return float(self[2])

    def dot(self, other: ArrayLike | None = None) -> float:  # pyright: ignore[reportIncompatibleMethodOverride]
        """Returns the product with another vector; without one, with itself."""
        own = np.asarray(self, np.float64)
        return float(own @ (own if other is None else np.asarray(other, np.float64)))

    def length(self) -> float:
        """Returns the length."""
        return math.sqrt(self.dot())

    def normalized(self) -> Vector3:
        """Returns the vector of length 1 in the same direction."""
        return Vector3(np.asarray(self) / self.length())


class Quaternion:
    """A rotation: `vector` (x, y, z) and `scalar` (w)."""

    def __init__(self, vector: Any = (0.0, 0.0, 0.0), scalar: float | None = None) -> None:
        if scalar is None and isinstance(vector, Sequence) and len(vector) == 2:
            vector, scalar = vector  # magnum takes one tuple of both, too
        self.vector = Vector3(vector)
        self.scalar = 1.0 if scalar is None else float(scalar)

    @classmethod
    def identity_init(cls) -> Quaternion:
        """Returns no rotation."""
        return cls()

    @classmethod
    def rotation(cls, angle: float, axis: ArrayLike) -> Quaternion:
        """Returns the rotation by an angle (`Deg` or radians) about a unit axis."""
        half = 0.5 * _radians(angle)
        return cls(np.asarray(axis, np.float64) * math.sin(half), math.cos(half))

    def __mul__(self, other: Quaternion) -> Quaternion:
        a, b = np.asarray(self.vector, np.float64), np.asarray(other.vector, np.float64)
        return Quaternion(
            self.scalar * b + other.scalar * a + np.cross(a, b), self.scalar * other.scalar - float(a @ b)
        )

    def inverted(self) -> Quaternion:
        """Returns the opposite rotation."""
        return Quaternion(-np.asarray(self.vector), self.scalar)

    def normalized(self) -> Quaternion:
        """Returns the same rotation with length 1."""
        size = math.sqrt(self.vector.dot() + self.scalar**2)
        return Quaternion(np.asarray(self.vector) / size, self.scalar / size)

    def transform_vector(self, vector: ArrayLike) -> Vector3:
        """Returns a rotated vector."""
        turned = self * Quaternion(vector, 0.0) * self.inverted()
        return turned.vector

    def angle(self) -> Rad:
        """Returns the angle of the rotation."""
        return Rad(2.0 * math.acos(max(-1.0, min(1.0, self.scalar))))

    def __repr__(self) -> str:
        return f"Quaternion({self.vector.tolist()}, {self.scalar})"


def rotation_of(given: Any) -> Any:
    """Returns a rotation as `np.quaternion`.

    Args:
        given: one of the package `numpy-quaternion`, a `Quaternion`, or xyzw, (4,).
    """
    if isinstance(given, _quaternion.quaternion):
        return given
    return quat_from_magnum(given) if isinstance(given, Quaternion) else quat_from_coeffs(given)


def quat_from_coeffs(coeffs: ArrayLike) -> Any:
    """Returns xyzw, (4,), as `np.quaternion`."""
    x, y, z, w = np.asarray(coeffs, np.float64).tolist()
    return _quaternion.quaternion(w, x, y, z)


def quat_to_coeffs(quat: Any) -> NDArray[np.float64]:
    """Returns xyzw, (4,)."""
    return np.array([quat.x, quat.y, quat.z, quat.w])


def quat_to_magnum(quat: Any) -> Quaternion:
    """Returns `np.quaternion` as a `Quaternion`."""
    return Quaternion((quat.x, quat.y, quat.z), quat.w)


def quat_from_magnum(quat: Quaternion) -> Any:
    """Returns a `Quaternion` as `np.quaternion`."""
    return quat_from_coeffs([*quat.vector.tolist(), quat.scalar])


def quat_from_angle_axis(theta: float, axis: ArrayLike) -> Any:
    """Returns the rotation by an angle in radians about an axis (3,)."""
    along = np.asarray(axis, np.float64)
    return _quaternion.from_rotation_vector(theta * along / np.linalg.norm(along))


def quat_to_angle_axis(quat: Any) -> tuple[float, NDArray[np.float64]]:
    """Returns the angle in radians and the unit axis (3,) of a rotation."""
    turned = _quaternion.as_rotation_vector(quat)
    theta = float(np.linalg.norm(turned))
    return (theta, turned / theta) if theta > 1e-9 else (0.0, np.array([1.0, 0.0, 0.0]))


def quat_rotate_vector(quat: Any, vector: ArrayLike) -> NDArray[np.float64]:
    """Returns a rotated vector (3,)."""
    turned = quat * _quaternion.quaternion(0.0, *np.asarray(vector, np.float64).tolist()) * quat.inverse()
    return np.asarray(turned.imag)


def quat_from_two_vectors(first: ArrayLike, second: ArrayLike) -> Any:
    """Returns the shortest rotation from the direction of one vector (3,) to that of another."""
    a, b = (np.asarray(vector, np.float64) / np.linalg.norm(vector) for vector in (first, second))
    if float(a @ b) < -1.0 + 1e-8:
        away = np.cross(a, [1.0, 0.0, 0.0] if abs(a[0]) < 0.9 else [0.0, 1.0, 0.0])
        return quat_from_angle_axis(math.pi, away)
    return _quaternion.quaternion(1.0 + float(a @ b), *np.cross(a, b).tolist()).normalized()


def angle_between_quats(first: Any, second: Any) -> float:
    """Returns the angle between two rotations in radians."""
    return float(2.0 * math.acos(min(1.0, abs((first.inverse() * second).w))))


def colours(count: int = 40) -> NDArray[np.uint8]:
    """Returns colours (count, 3) that are easy to tell apart, for pictures of segmentations."""
    hues: Iterable[float] = (i * 0.618034 % 1.0 for i in range(count))
    rgb = [colorsys.hsv_to_rgb(hue, 0.5 + 0.5 * (i % 2), 0.95 - 0.3 * (i // 2 % 2)) for i, hue in enumerate(hues)]
    return np.round(255.0 * np.array(rgb)).astype(np.uint8)


d3_40_colors_rgb = colours()
RIGHT, UP, BACK = (np.eye(3)[axis] for axis in range(3))
"""Directions in Habitat's frame, (3,)."""
LEFT, GRAVITY, FRONT = -RIGHT, -UP, -BACK


def _radians(angle: float) -> float:
    """Returns an angle that is a `Deg`, or a number of radians, in radians."""
    return math.radians(angle) if isinstance(angle, Deg) else float(angle)
