"""What can go wrong in the world, one class a kind; every message names what was given and what would do."""

from __future__ import annotations


class HouseError(ValueError):
    """A house file is missing, unreadable, or breaks a rule of the house format."""


class EpisodeError(ValueError):
    """An episode cannot be set up: an unknown goal, a start inside a wall, no way to the goal."""


class PhysicsError(RuntimeError):
    """The simulation left the physical: NaN, an unstable state, a robot that fell."""


class RenderError(RuntimeError):
    """No OpenGL could be had, or the frame buffer is too small."""


class WorkersError(RuntimeError):
    """Workers cannot start, or one piece of work kills every worker."""
