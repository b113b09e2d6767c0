"""The composition root: from the options of a run to a configuration, an environment and an agent.

In addition to `sim.training.plan_env` and the commands `sim.run` and `sim.teleop`, only this package of `sim` imports
`stubborn`.
"""
