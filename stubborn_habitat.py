"""`import stubborn_habitat` runs habitat-lab on the houses and the physics of this project.

It provides `habitat_sim` to this process; habitat-lab's own simulator, tasks, measures and data sets are then used
unchanged. `configure(motion="sliding", noise="realsense")` sets what Habitat's configuration has no entry for;
docs/habitat.md describes all of it. Where habitat-lab is installed, the splits are registered as data sets.
"""

import importlib.util
from typing import Any

from sim.app.bridges.habitat_sim.finder import install

install()

if importlib.util.find_spec("habitat") is not None:
    from sim.app.bridges.habitat_sim.lab import register

    register()


def configure(**options: str) -> Any:
    """Sets `motion`, `noise` and `profile` of simulators that are made later; see `Options` of the simulator."""
    from sim.app.bridges.habitat_sim.simulator import configure as configure_simulator

    return configure_simulator(**options)
