"""Everything that can be chosen about the robot, in one declared tree.

SI units. The values were measured on mujoco 4.0; `tests/sim/robot` holds what they must keep: change one, run it again.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Literal, get_args

from sim.interface import FORWARD_M, TURN_RAD, ConfigError, RobotModel

Base = Literal["planar", "free"]
"""How the body is held: upright by three slides and a hinge, or by nothing but its wheels."""


def _require_positive(config: object, *names: str) -> None:
    """Refuse values that are not finite and above zero."""
    for name in names:
        value = getattr(config, name)
        if not (math.isfinite(value) and value > 0.0):
            raise ConfigError(f"{type(config).__name__}.{name} must be a finite number > 0, got {value}.")


@dataclass(frozen=True, kw_only=True)
class BodyConfig:
    """The hull: two stacked cylinders around the axis, its mass and where that sits."""

    radius_m: float = 0.18
    height_m: float = 0.88
    """Top of the hull above the floor."""
    clearance_m: float = 0.03
    """Bottom of the hull above the floor: what is lower passes under."""
    waist_m: float = 0.20
    """Where the lower cylinder ends and the upper one begins: low obstacles then meet a low, well-conditioned body."""
    skin_m: float = 0.005
    """The hull's outermost layer, into which other things may sink; only below it lies the core that MuJoCo collides.

    A core that is never reached is always at a distance, and distances are exact. Cores that touch by micrometres are
    not: MuJoCo 4.0 then gives one in ten cylinders a normal that is wrong by up to 70 deg and 7 cm of depth.
    """
    mass_kg: float = 6.9
    """The whole robot, wheels and casters included."""
    com_height_m: float = 0.12
    """Centre of mass above the floor: the batteries are at the bottom."""
    friction: float = 0.1
    """Sliding friction of the hull against anything."""
    contact_time_s: float = 0.006
    """Time constant of the hull's contacts (solref); MuJoCo raises it to two time steps."""

    def __post_init__(self) -> None:
        names = [f.name for f in fields(self)]
        _require_positive(self, *names)
        if not self.clearance_m < self.waist_m < self.height_m:
            raise ConfigError(
                "BodyConfig needs clearance_m < waist_m < height_m, got "
                f"{self.clearance_m}, {self.waist_m} and {self.height_m} m."
            )
        thinnest = min(self.radius_m, 0.5 * (self.waist_m - self.clearance_m), 0.5 * (self.height_m - self.waist_m))
        if self.skin_m >= thinnest:
            raise ConfigError(
                f"BodyConfig.skin_m must be thinner than either cylinder, {thinnest:.3f} m; got {self.skin_m} m."
            )


@dataclass(frozen=True, kw_only=True)
class WheelConfig:
    """Two driven wheels on the axis through the centre, a frictionless caster in front and one behind."""

    radius_m: float = 0.04
    half_track_m: float = 0.14
    """Each wheel's distance from the centre."""
    mass_kg: float = 0.2
    """One wheel."""
    armature_kg_m2: float = 0.003
    """Inertia of the motor as seen by the wheel."""
    motor_gain_nm_s: float = 0.6
    """Torque for each rad/s that the wheel is slower than commanded."""
    max_torque_nm: float = 0.7
    """Of one motor."""
    caster_radius_m: float = 0.028
    caster_offset_m: float = 0.15
    """Distance of each caster from the centre, along the heading."""
    caster_gap_m: float = 0.0005
    """How far the casters hang above the floor: the wheels carry the weight, and so have traction."""

    def __post_init__(self) -> None:
        _require_positive(self, *(f.name for f in fields(self) if f.name != "caster_gap_m"))
        if not 0.0 <= self.caster_gap_m < self.caster_radius_m:
            raise ConfigError(
                f"WheelConfig.caster_gap_m must lie in [0, caster_radius_m = {self.caster_radius_m}), "
                f"got {self.caster_gap_m}."
            )

    @property
    def max_push_n(self) -> float:
        """Force at the floor when both motors give all they have."""
        return 2.0 * self.max_torque_nm / self.radius_m


@dataclass(frozen=True, kw_only=True)
class DriveConfig:
    """How an action becomes a motion: profiles, gains, and when a motion counts as blocked."""

    forward_m: float = FORWARD_M
    turn_rad: float = TURN_RAD
    tick_s: float = 0.02
    """Period of the controller."""
    speed_m_s: float = 0.5
    acceleration_m_s2: float = 1.0
    turn_speed_rad_s: float = 1.8
    turn_acceleration_rad_s2: float = 6.0
    lookahead_s: float = 0.017
    """The planned speed is read this far ahead of the clock: half a tick, and what the motors lag behind."""
    position_gain_1_s: float = 9.0
    """Speed for each metre behind the profile."""
    heading_gain_1_s: float = 9.0
    """Turn rate for each radian off the heading."""
    blocking_force_n: float = 25.0
    """A contact that pushes against the motion with this much, for `blocking_ticks`, ends it; less is pushed along."""
    blocking_ticks: int = 2
    stall_lag_m: float = 0.03
    """Blocked as well: this far behind the profile and slower than `stall_speed_m_s` for `stall_s`."""
    stall_speed_m_s: float = 0.05
    stall_lag_rad: float = 0.20
    """The same for turns."""
    stall_speed_rad_s: float = 0.15
    stall_s: float = 0.1
    touch_memory_s: float = 0.1
    """A body that bounces along something still touches it for this long after the last contact."""
    back_off_m: float = 0.004
    """Way back after a block, so that the hull rests against nothing ..."""
    back_off_speed_m_s: float = 0.04
    """... at this speed ..."""
    back_off_max_s: float = 0.2
    """... and for no longer than this."""
    realign_max_s: float = 0.6
    """Time given to turn back to the heading reference after a block."""
    rest_max_s: float = 0.4
    """Time given to brake at the end of an action."""
    position_tolerance_m: float = 0.0005
    """A forward motion has arrived when it is this near its end ..."""
    touching_tolerance_m: float = 0.005
    """... this near while it pushes something along, which holds it back for good ..."""
    heading_tolerance_rad: float = math.radians(0.05)
    """... and its heading this near the reference ..."""
    rest_speed_m_s: float = 0.002
    """... and it moves slower than this ..."""
    rest_speed_rad_s: float = 0.01
    """... and turns slower than this."""
    timeout_s: float = 1.0
    """A motion may take this much longer than its profile."""

    def __post_init__(self) -> None:
        _require_positive(self, *(f.name for f in fields(self)))
        if self.blocking_ticks != int(self.blocking_ticks):
            raise ConfigError(f"DriveConfig.blocking_ticks must be a whole number, got {self.blocking_ticks}.")


@dataclass(frozen=True, kw_only=True)
class PhysicsConfig:
    """The integrator's step and what counts as leaving the physical."""

    timestep_s: float = 0.004
    """2 ms costs twice as much; hulls then sink 1.1 instead of 1.7 mm into what they hit."""
    settle_s: float = 0.2
    """Time the body is given to come to rest on the floor after it was placed."""
    max_overlap_m: float = 0.001
    """A start where the hull is deeper inside something is refused."""
    max_drop_m: float = 0.3
    """An action that ends this far below where it began fell off something."""
    max_tilt_rad: float = math.radians(25.0)
    """A free base that leans more has tipped over."""

    def __post_init__(self) -> None:
        _require_positive(self, *(f.name for f in fields(self)))


@dataclass(frozen=True)
class RobotFile:
    """A body from elsewhere in place of ours (`sim.robot.foreign`)."""

    path: Path
    """The MJCF file."""
    wheel_joints: tuple[str, str]
    """Names of the left and the right wheel's hinge."""
    casters: tuple[str, ...] = ()
    """Names of geoms or bodies that slide on the floor."""


@dataclass(frozen=True, kw_only=True)
class RobotConfig:
    """The robot, whole."""

    base: Base = "planar"
    body: BodyConfig = field(default_factory=BodyConfig)
    wheels: WheelConfig = field(default_factory=WheelConfig)
    drive: DriveConfig = field(default_factory=DriveConfig)
    physics: PhysicsConfig = field(default_factory=PhysicsConfig)
    file: RobotFile | None = None
    """A body from elsewhere, which the numbers of `body` and `wheels` then describe; None: ours is made from them."""
    camera_forward_m: float = 0.0
    """Camera mount ahead of the axle."""

    def __post_init__(self) -> None:
        if self.base not in get_args(Base):
            raise ConfigError(f"RobotConfig.base must be one of {', '.join(get_args(Base))}, got '{self.base}'.")
        steps = self.drive.tick_s / self.physics.timestep_s
        if abs(steps - round(steps)) > 1e-6 or round(steps) < 1:
            raise ConfigError(
                "DriveConfig.tick_s must be a whole multiple of PhysicsConfig.timestep_s, got "
                f"{self.drive.tick_s} s and {self.physics.timestep_s} s."
            )
        wheels = self.wheels
        if self.body.mass_kg <= 2.0 * wheels.mass_kg:
            raise ConfigError(
                f"BodyConfig.mass_kg is the whole robot's and must exceed that of its wheels, {2 * wheels.mass_kg} kg; "
                f"got {self.body.mass_kg} kg."
            )
        stiffness = wheels.motor_gain_nm_s * self.physics.timestep_s / wheels.armature_kg_m2
        if stiffness >= 1.0:
            raise ConfigError(
                "motor_gain_nm_s * timestep_s / armature_kg_m2 must stay below 1 or the wheels shake; it is "
                f"{wheels.motor_gain_nm_s} * {self.physics.timestep_s} / {wheels.armature_kg_m2} = {stiffness:.2f}."
            )
        if self.drive.blocking_force_n >= wheels.max_push_n:
            raise ConfigError(
                f"DriveConfig.blocking_force_n must be below what the motors can push, {wheels.max_push_n:.1f} N; "
                f"got {self.drive.blocking_force_n} N."
            )
        if not abs(self.camera_forward_m) < self.body.radius_m:
            raise ConfigError(
                f"RobotConfig.camera_forward_m must stay inside the body's radius of {self.body.radius_m:.3f} m, or "
                f"the camera would look through walls; got {self.camera_forward_m} m."
            )
        if wheels.half_track_m >= self.body.radius_m or wheels.caster_offset_m >= self.body.radius_m:
            raise ConfigError(
                f"Wheels and casters must stand inside the hull's radius of {self.body.radius_m} m, got "
                f"half_track_m {wheels.half_track_m} and caster_offset_m {wheels.caster_offset_m}."
            )

    @property
    def steps_per_tick(self) -> int:
        """Physics steps for each tick of the controller."""
        return round(self.drive.tick_s / self.physics.timestep_s)

    @property
    def model(self) -> RobotModel:
        """What an agent may know of it."""
        return RobotModel(
            radius_m=self.body.radius_m, height_m=self.body.height_m, camera_forward_m=self.camera_forward_m
        )
