"""Registers the environments with Gymnasium, on import.

    import sim.gym
    env = gymnasium.make("stubborn/ObjectNav-v0", split="val")
    env = gymnasium.make("sim.gym:stubborn/ObjectNav-v0", split="val")  # the same, without the import
    env = gymnasium.make("stubborn/ObjectNavVelocity-v0", split="val")  # driven by velocities
    env = gymnasium.make("stubborn/ObjectNavChain-v0")  # several goals, one after the other

Gymnasium 1.0 has no entry points any more. An id that is not registered raises `NamespaceNotFound: Namespace stubborn
not found. Have you installed the proper package for stubborn?`, although the package is installed: the module has to be
imported first, or to be named before the colon of the id; `make` and `make_vec` (in its worker processes too) then
import it.

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

from sim.env.discrete import DiscreteActions
from sim.env.progress import ProgressReward

__all__ = ["CHAIN_ENV_ID", "ENV_ID", "VELOCITY_ENV_ID", "DiscreteActions", "ProgressReward"]

ENV_ID = "stubborn/ObjectNav-v0"
VELOCITY_ENV_ID = "stubborn/ObjectNavVelocity-v0"
CHAIN_ENV_ID = "stubborn/ObjectNavChain-v0"

if ENV_ID not in gymnasium.registry:
    gymnasium.register(
        id=ENV_ID, entry_point="sim.env.objectnav:ObjectNavEnv"
    )  # no time limit: the task truncates by itself
if VELOCITY_ENV_ID not in gymnasium.registry:
    gymnasium.register(id=VELOCITY_ENV_ID, entry_point="sim.env.velocity:ObjectNavVelocityEnv")
if CHAIN_ENV_ID not in gymnasium.registry:
    gymnasium.register(
        id=CHAIN_ENV_ID,
        entry_point="sim.env.objectnav:ObjectNavEnv",
        kwargs={"split": "chains-val", "sensors": ("rgb", "depth", "goal")},
    )
