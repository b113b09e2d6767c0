"""Makes `gymnasium.make("stubborn/ObjectNav-v0")` work wherever the package is installed (entry point in pyproject)."""

from __future__ import annotations

import gymnasium


def register() -> None:
    """Add the environment to Gymnasium's registry; called by Gymnasium at its import."""
    gymnasium.register(
        id="ObjectNav-v0",  # the namespace `stubborn/` comes from the entry point's name
        entry_point="sim.env:ObjectNavEnv",
        max_episode_steps=None,  # the task truncates by itself
        nondeterministic=False,
    )
