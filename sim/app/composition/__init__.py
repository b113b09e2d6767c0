"""The composition root: from the options of a run to a configuration, an environment and an agent."""

RUNNER = "sim.app.composition.runner"
"""The module that runs episodes, which a worker imports."""
