"""The composition root: from the options of a run to a configuration, an environment and an agent.

The one room of `sim` that imports `stubborn`, besides the commands `sim.run` and `sim.teleop`, which use it.
"""
