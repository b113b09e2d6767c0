"""Errors of this project, one class per kind. A message says what was given and what is allowed."""

from __future__ import annotations


class ObjectNavError(Exception):
    """Base class of all errors that this project raises on purpose."""


class ConfigError(ObjectNavError, ValueError):
    """A value given by the user is not allowed; the message names the value and what is allowed."""


class HouseError(ObjectNavError, ValueError):
    """A house file is missing, unreadable, or breaks a rule of the house format."""


class EpisodeError(ObjectNavError, ValueError):
    """An episode cannot be set up: an unknown goal, a start inside a wall, no path to the goal."""


class PhysicsError(ObjectNavError, RuntimeError):
    """The simulation reached an unphysical state: NaN, an unstable state, a robot that tipped over."""


class RenderError(ObjectNavError, RuntimeError):
    """OpenGL is not available, or the frame buffer is too small."""


class WorkersError(ObjectNavError, RuntimeError):
    """Workers cannot start, or one item of work makes every worker fail."""
