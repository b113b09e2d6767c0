"""ObjectNav driven by velocities, as a real base is: the same task, sensors, metrics and splits as `ObjectNavEnv`."""

from __future__ import annotations

import math
import reprlib
from collections.abc import Mapping
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import ArrayLike

from sim.core.errors import ConfigError
from sim.core.interface import MAX_STEPS, Action
from sim.env.objectnav import ObjectNavEnv, StepResult
from sim.robot.variation import ACTION_S
from sim.robot.velocity import Velocity


class ObjectNavVelocityEnv(ObjectNavEnv):
    """`ObjectNavEnv` with velocities in place of discrete actions.

    ## Actions
    `Box(3)`, float32: forward speed (m/s), turn rate (rad/s, counter-clockwise), and STOP if the third number is above
    0.5. Speeds are held for `period_s`; the limits of speed and acceleration are those of the robot's drive, by default
    0.5 m/s, 1.8 rad/s, 1 m/s2 and 6 rad/s2. Numbers outside of the space are clipped. STOP counts where the robot is.

    ## Observations, reward, info
    As `ObjectNavEnv`; a step is one period, also in `num_steps` and `first_seen_step`. `info` also has `simulated_s`,
    the time since the start, and `blocked`: a contact blocks the robot. `collided` is true only in the period in which
    a contact begins to block; `collisions` counts these. The window of 100 actions of `trapped` is 120 s.

    ## End
    `terminated` at STOP and at a fall, `truncated` after `time_limit_s` (`end_reason` is `time_limit`).

    Args:
        period_s: time for which a command is held, a whole multiple of the tick of the drive (20 ms).
        time_limit_s: simulated time of an episode; the default is what 500 discrete actions take at most.
        options: those of `ObjectNavEnv`, except for `max_steps`, also that of `task`, and `look`.

    Raises:
        ConfigError: see `ObjectNavEnv`; or a period, a limit or an action that is not allowed.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 10}  # noqa: RUF012 - declared by Gymnasium

    def __init__(self, *, period_s: float = 0.1, time_limit_s: float = MAX_STEPS * ACTION_S, **options: Any) -> None:
        task = options.get("task")
        of_task = task.get("max_steps") if isinstance(task, Mapping) else getattr(task, "max_steps", None)
        if options.get("look"):
            raise ConfigError("look=True adds discrete actions, and this environment takes velocities.")
        if not 0.0 < period_s <= ACTION_S:
            raise ConfigError(f"period_s must lie in (0, {ACTION_S}] s, got {period_s}.")
        if not period_s <= time_limit_s < math.inf:
            raise ConfigError(f"time_limit_s must be finite and at least period_s = {period_s} s, got {time_limit_s}.")
        periods = math.ceil(time_limit_s / period_s - 1e-6)
        if options.get("max_steps") is not None or of_task not in (None, MAX_STEPS, periods):
            raise ConfigError("The limit of an episode driven by velocities is time_limit_s, in place of max_steps.")
        self.period_s, self.time_limit_s = period_s, time_limit_s
        self.metadata = {**self.metadata, "render_fps": max(1, round(1.0 / period_s))}
        super().__init__(**options, max_steps=periods)
        self._steps_per_action, self._limit = max(1, round(ACTION_S / period_s)), "time_limit"
        if self._robot.motion != "contacts":
            raise ConfigError(f"Velocities need the motion 'contacts'; this robot has '{self._robot.motion}'.")
        drive = self._robot.drive
        ticks = period_s / drive.tick_s
        if abs(ticks - round(ticks)) > 1e-6:
            raise ConfigError(f"period_s must be a whole multiple of {drive.tick_s} s, got {period_s}.")
        high = np.array([drive.speed_m_s, drive.turn_speed_rad_s, 1.0], np.float32)
        self.action_space = spaces.Box(high * np.array([-1.0, -1.0, 0.0], np.float32), high)

    def step(self, action: ArrayLike) -> StepResult:
        """Holds one command for a period; see the class."""
        self.scene.task.require_running()
        speed_m_s, rate_rad_s, stop = self._clipped(action)
        if stop > 0.5:
            return self._outcome(self.scene.world.move(Action.STOP))
        return self._outcome(self.scene.world.hold(Velocity(speed_m_s, rate_rad_s), self.period_s))

    def _clipped(self, action: ArrayLike) -> tuple[float, float, float]:
        """Returns speed, turn rate and STOP, within the space."""
        try:
            given = np.asarray(action)
            command = given.astype(np.float64) if given.dtype.kind in "bifuO" else np.zeros(0)
        except (TypeError, ValueError, OverflowError):
            command = np.zeros(0)
        if command.shape != (3,) or not np.isfinite(command).all():
            raise ConfigError(
                f"An action is three finite numbers: m/s forward, rad/s to the left, and STOP above 0.5; got "
                f"{reprlib.repr(action)}."
            )
        space = self.action_space
        assert isinstance(space, spaces.Box)
        speed_m_s, rate_rad_s, stop = np.clip(command, space.low, space.high).tolist()
        return speed_m_s, rate_rad_s, stop

    def _info(self, collided: bool) -> dict[str, object]:
        info, motion = super()._info(collided), self.motion
        blocked = motion is not None and motion.ended == "blocked"
        return info | {"blocked": blocked}
