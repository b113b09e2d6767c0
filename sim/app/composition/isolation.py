"""Finds the modules of the user that a run imports, and whether they need a process of their own."""

from __future__ import annotations

from sim.app.bridges.process_command import is_process
from sim.app.evaluation.processes import Isolation
from sim.app.options import RunOptions

HABITAT = "habitat:"
"""Prefix of the name of an agent with Habitat's interface."""
STEP_TIMEOUT_S = 600.0
"""Longest time of a call of the agent if `--step-timeout` is not given."""
RUNNER = "sim.app.composition.runner"
"""The module that runs episodes, which a worker imports."""


def own_modules(options: RunOptions) -> list[str]:
    """Returns the modules of the user that the options name as `package.module:NAME`."""
    names = (options.agent, options.explorer, options.semantics)
    named = [name for name in names if name is not None and ":" in name and not is_process(name)]
    return [name.removeprefix(HABITAT).partition(":")[0] for name in named]


def step_limit_s(options: RunOptions) -> float:
    """Returns the longest time of a call of the agent; 0: no limit."""
    return STEP_TIMEOUT_S if options.step_timeout is None else options.step_timeout


def isolation_of(options: RunOptions) -> Isolation:
    """Returns whether the episodes of a run need a process of their own, and how long a call of the agent may take.

    A user's code needs one: it may hang, crash, or change the state of its process. An agent `process:COMMAND` has a
    process already, and `ProcessAgent` ends a call that takes too long, so that the loaded house is not lost.
    """
    if is_process(options.agent):
        return Isolation()
    limit_s = step_limit_s(options)
    own_process = bool(own_modules(options)) or options.step_timeout is not None
    return Isolation(needed=own_process and limit_s > 0.0, limit_s=limit_s)
