"""The two motors: they turn the wheels at the commanded speed, with errors that an episode may have."""

from __future__ import annotations

from collections import deque

from sim.gl import mujoco
from sim.robot.body import PREFIX, Body
from sim.robot.conditions import NOMINAL, Conditions
from sim.robot.config import RobotConfig


class Motors:
    """Velocity servos with limited torque. An ideal one follows its command at once, up to its torque.

    Gain and bias change the speed at which a wheel turns for a command, latency delays the command.
    """

    def __init__(self, config: RobotConfig, model: mujoco.MjModel, body: Body) -> None:
        self._model, self._body = model, body
        self._tick_s = config.drive.tick_s
        self._ids = [model.actuator(f"{PREFIX}{side}_motor").id for side in ("left", "right")]
        self._gain = model.actuator_gainprm[self._ids, 0].copy()
        self.reset(NOMINAL)

    def reset(self, conditions: Conditions) -> None:
        """Starts an episode."""
        self._model.actuator_gainprm[self._ids, 0] = self._gain * conditions.motor_gain_scale
        self._bias_rad_s = conditions.motor_bias_rad_s
        self._waiting = deque([(0.0, 0.0)] * round(conditions.motor_latency_s / self._tick_s))

    def command(self, left_rad_s: float, right_rad_s: float) -> None:
        """Commands the speeds of both wheels for one tick."""
        self._waiting.append((left_rad_s, right_rad_s))
        left, right = self._waiting.popleft()
        moving = left != 0.0 or right != 0.0  # a motor at rest holds its wheel
        self._body.ctrl[0] = left + self._bias_rad_s[0] * moving
        self._body.ctrl[1] = right + self._bias_rad_s[1] * moving

    def stop(self) -> None:
        """Commands both wheels to stand still, at once."""
        self._waiting = deque([(0.0, 0.0)] * len(self._waiting))
        self._body.ctrl[:] = 0.0
