"""The ground of a generated house: friction by material, heights of rugs, thresholds, wet spots and uneven tiles.

A house is furnished on a level ground first. `survey` reads its rooms, doorways and rugs from the specification, `draw`
chooses the ground from a random stream of its own, and `lay` changes the specification. Rooms, furniture and textures
therefore do not depend on the ground.
"""

from __future__ import annotations

import numpy as np

from sim.gl import mujoco
from sim.homes.housegen.ground.draw import draw_ground
from sim.homes.housegen.ground.lay import lay
from sim.homes.housegen.ground.survey import survey

_STREAM = 3
"""Number of the random stream of the ground, in addition to the seed and the pool of a house."""


def lay_ground(spec: mujoco.MjSpec, text: str, seed: int, pool_stream: int) -> None:
    """Lays the ground of a furnished house.

    Args:
        spec: the house; it is changed.
        text: its file. The ground is drawn from the numbers in the file, which are rounded, and not from those of
            `spec`, so that a house that was read from a file gets the same ground.
        seed: of the house.
        pool_stream: number of the pool of the house (`sim.homes.housegen.config.POOL_STREAM`).
    """
    rng = np.random.default_rng([seed, pool_stream, _STREAM])
    lay(spec, draw_ground(rng, survey(mujoco.MjSpec.from_string(text))))
