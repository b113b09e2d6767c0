"""Registers the environment with Gymnasium; importing this module is all it takes.

    env = gymnasium.make("sim.gym:stubborn/ObjectNav-v0", split="val")

Gymnasium 1.0 gave up entry points: a package's environments are found by importing it, and the part of an id before
the colon is the module that `make` and `make_vec` (in its worker processes too) import.
"""

from __future__ import annotations

import gymnasium

ENV_ID = "stubborn/ObjectNav-v0"

if ENV_ID not in gymnasium.registry:
    gymnasium.register(id=ENV_ID, entry_point="sim.env:ObjectNavEnv")  # no time limit: the task truncates by itself
