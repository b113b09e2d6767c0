"""Times three fixed pieces of work, which do not depend on our code: they show how fast and how busy a machine is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import skfmm

from sim.app.commands.bench.figures import timed
from sim.gl import mujoco

_CELLS = 240
_STEPS = 200
_SCENE = """
<mujoco>
  <visual><global offwidth="640" offheight="480"/></visual>
  <worldbody>
    <light pos="0 0 4"/>
    <geom type="plane" size="5 5 1"/>
    {boxes}
    <body pos="0 0 1"><freejoint/><geom type="box" size=".1 .1 .1" mass="1"/></body>
  </worldbody>
</mujoco>
"""


@dataclass(frozen=True)
class Calibration:
    """The smallest milliseconds of each piece."""

    render_ms: float
    """640 x 480, 100 boxes and a plane, `mujoco.Renderer` at its default quality."""
    step_ms: float
    """200 `mj_step` of a box that falls onto a plane."""
    fast_marching_ms: float
    """`skfmm.distance` from the middle of 240 x 240 cells with walls."""


class Calibrator:
    """Holds the fixed work, so that it can be timed repeatedly."""

    def __init__(self) -> None:
        boxes = "".join(
            f'<geom type="box" pos="{3 * np.cos(i):.3f} {3 * np.sin(i):.3f} {0.02 * i:.3f}" size=".1 .1 .1"/>'
            for i in range(100)
        )
        self._model = mujoco.MjModel.from_xml_string(_SCENE.format(boxes=boxes))
        self._data = mujoco.MjData(self._model)
        self._renderer = mujoco.Renderer(self._model, 480, 640)
        field = np.ones((_CELLS, _CELLS))
        field[_CELLS // 2, _CELLS // 2] = -1.0
        walls = np.zeros(field.shape, bool)
        walls[20::40, :200], walls[:200, 30::60] = True, True
        walls[60:180:30], walls[:, 60:180:30] = False, False  # doors
        self._field = np.ma.MaskedArray(field, walls)

    def measure(self, tries: int) -> Calibration:
        """Returns the smallest time of several tries of each piece."""
        render = min(self.render_ms() for _ in range(tries))
        step = min(timed(self._step) for _ in range(tries))
        return Calibration(render, step, min(self.fast_marching_ms() for _ in range(tries)))

    def render_ms(self) -> float:
        """Times the fixed render once."""
        return timed(self._render)

    def fast_marching_ms(self) -> float:
        """Times the fixed fast marching once."""
        return timed(lambda: skfmm.distance(self._field, dx=0.05))

    def close(self) -> None:
        """Frees the renderer."""
        self._renderer.close()

    def _render(self) -> None:
        mujoco.mj_resetData(self._model, self._data)
        mujoco.mj_forward(self._model, self._data)
        self._renderer.update_scene(self._data)
        self._renderer.render()

    def _step(self) -> None:
        mujoco.mj_resetData(self._model, self._data)
        mujoco.mj_step(self._model, self._data, nstep=_STEPS)
