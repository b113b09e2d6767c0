"""House plans: apartments as grids of 5 cm, with a camera, a robot and a task in them that need no MuJoCo.

`sim.homes.plans.export` and `sim.homes.plans.surfaces` make plans from MJCF houses and import MuJoCo; no other module
here does.
"""
