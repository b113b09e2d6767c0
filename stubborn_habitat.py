"""`import stubborn_habitat`, before `import habitat`, runs habitat-lab on the houses and the physics of this project.

It provides `habitat_sim` to this process; habitat-lab's own simulator class, tasks, measures and data sets then run
unchanged, and the splits are registered as data sets (docs/habitat.md). In the environment that
`stubborn habitat setup` makes, this happens in every process, so that scripts need not import it.
"""

from collections.abc import Sequence
from typing import Any

from sim.app.bridges.habitat_sim.finder import install

install()


def configure(**options: str) -> Any:
    """Sets `motion`, `noise`, `profile` or `detectors` of simulators made later in this process; returns all four.

    The environment variable STUBBORN_HABITAT does the same for all processes: `motion=sliding,noise=realsense`.

    Raises:
        ConfigError: an unknown option or value.
    """
    from sim.app.bridges.habitat_sim.options import configure as configure_simulator

    return configure_simulator(**options)


def get_config(split: str = "val", overrides: Sequence[str] = (), **others: str) -> Any:
    """Returns habitat-lab's configuration for a shipped split; see `sim.app.bridges.habitat_sim.lab.get_config`."""
    from sim.app.bridges.habitat_sim.lab import get_config as lab_config

    return lab_config(split, overrides, **others)
