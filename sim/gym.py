"""Registers the environment with Gymnasium, on import.

    env = gymnasium.make("sim.gym:stubborn/ObjectNav-v0", split="val")

Gymnasium 1.0 has no entry points any more: the part of an id before the colon is the module that `make` and `make_vec`
(in its worker processes too) import. After `import sim.gym` the id without that part is sufficient.

    envs = gymnasium.make_vec(
        "sim.gym:stubborn/ObjectNav-v0", num_envs=2, vectorization_mode="async", vector_kwargs={"context": "spawn"}
    )

Forked worker processes, the default on Linux up to Python 3.13, cannot render if the parent process has rendered
before; they raise `RenderError`. Spawned processes always can.

The task truncates by itself (`max_steps=`), and only then do `end_reason` and `failure` have a value. The `TimeLimit`
wrapper of `max_episode_steps=` truncates from outside and leaves them None.
"""

from __future__ import annotations

import gymnasium

ENV_ID = "stubborn/ObjectNav-v0"

if ENV_ID not in gymnasium.registry:
    gymnasium.register(
        id=ENV_ID, entry_point="sim.env.objectnav:ObjectNavEnv"
    )  # no time limit: the task truncates by itself
