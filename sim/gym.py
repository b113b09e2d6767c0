"""Registers the environment with Gymnasium; importing this module is all it takes.

    env = gymnasium.make("sim.gym:stubborn/ObjectNav-v0", split="val")

Gymnasium 1.0 gave up entry points: a package's environments are found by importing it, and the part of an id before
the colon is the module that `make` and `make_vec` (in its worker processes too) import. After `import sim.gym` the
bare id will do.

    envs = gymnasium.make_vec(
        "sim.gym:stubborn/ObjectNav-v0", num_envs=2, vectorization_mode="async", vector_kwargs={"context": "spawn"}
    )

Worker processes that are forked, as they are by default on Linux up to Python 3.13, cannot draw where the parent has
drawn before; they say so (`RenderError`). Spawned ones always can.

The task truncates by itself (`max_steps=`), and only then do `end_reason` and `failure` have a value. The `TimeLimit`
that `max_episode_steps=` puts around the environment cuts from outside and leaves them None.
"""

from __future__ import annotations

import gymnasium

ENV_ID = "stubborn/ObjectNav-v0"

if ENV_ID not in gymnasium.registry:
    gymnasium.register(
        id=ENV_ID, entry_point="sim.env.objectnav:ObjectNavEnv"
    )  # no time limit: the task truncates by itself
