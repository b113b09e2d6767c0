"""The two motors: they turn the wheels at the commanded speed, with errors that an episode may have."""

from __future__ import annotations

from collections import deque

from sim.gl import mujoco
from sim.robot.body import PREFIX, Body
from sim.robot.conditions import NOMINAL, Conditions
from sim.robot.config import RobotConfig
from sim.robot.variation import ActionErrors

STILL_M_S = 0.03
"""A wheel that is commanded to stand and rolls more slowly than this is held."""

HOLD_IMPEDANCE = 0.99
"""Share of the load that the constraint of a held wheel takes (solimp): with MuJoCo's 0.9 to 0.95 it creeps."""


class Motors:
    """Velocity servos with limited torque. An ideal one follows its command at once, up to its torque.

    Gain and bias change the speed at which a wheel turns for a command, latency delays the command.
    """

    def __init__(self, config: RobotConfig, model: mujoco.MjModel, body: Body) -> None:
        self._model, self._body = model, body
        self._tick_s = config.drive.tick_s
        self._ids = [model.actuator(f"{PREFIX}{side}_motor").id for side in ("left", "right")]
        self._gain = model.actuator_gainprm[self._ids, 0].copy()
        self._dofs = [int(model.jnt_dofadr[joint]) for joint in model.actuator_trnid[self._ids, 0].tolist()]
        model.dof_solimp[self._dofs, :2] = HOLD_IMPEDANCE
        self._max_torque_nm = config.wheels.max_torque_nm
        self._still_rad_s = STILL_M_S / config.wheels.radius_m
        self.reset(NOMINAL)

    def reset(self, conditions: Conditions) -> None:
        """Starts an episode."""
        self._scale = conditions.motor_gain_scale
        self.vary(ActionErrors())
        self._bias_rad_s = conditions.motor_bias_rad_s
        self._waiting = deque([(0.0, 0.0)] * round(conditions.motor_latency_s / self._tick_s))

    def vary(self, errors: ActionErrors) -> None:
        """Changes the speeds of the motors for an action."""
        scale = [common * own for common, own in zip(self._scale, errors.motor_scale, strict=True)]
        self._model.actuator_gainprm[self._ids, 0] = self._gain * scale

    def command(self, left_rad_s: float, right_rad_s: float) -> None:
        """Commands the speeds of both wheels for one tick."""
        self._waiting.append((left_rad_s, right_rad_s))
        left, right = self._waiting.popleft()
        moving = left != 0.0 or right != 0.0
        self._hold(not moving)
        self._body.ctrl[0] = left + self._bias_rad_s[0] * moving
        self._body.ctrl[1] = right + self._bias_rad_s[1] * moving

    def stop(self) -> None:
        """Commands both wheels to stand still, at once."""
        self._waiting = deque([(0.0, 0.0)] * len(self._waiting))
        self._body.ctrl[:] = 0.0
        self._hold(True)

    def _hold(self, at_rest: bool) -> None:
        """Locks wheels that are commanded to stand and hardly turn, or releases them.

        A servo of speed alone lets a robot on a slope roll: it needs an error of speed for its torque. A wheel that is
        held resists with the largest torque of the motor, as a servo of position does.
        """
        for dof, speed in zip(self._dofs, self._body.wheel_speeds(), strict=True):
            held = at_rest and abs(speed) < self._still_rad_s
            self._model.dof_frictionloss[dof] = self._max_torque_nm if held else 0.0
