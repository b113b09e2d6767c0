"""The configuration of the robot: its body, wheels, controller and physics. SI units.

The defaults were tuned with mujoco 4.0; `tests/sim/robot` tests the properties that they must keep.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Literal, get_args

from sim.core.interface import CLIMB_M, FORWARD_M, TURN_RAD, ConfigError, RobotModel

PHYSICS_VERSION = 3
"""Results of different versions of the physics are not comparable, and runs are not resumed across them. 1: feedback of
the true pose, wheels that collide with floors only. 2: a level camera, a limit of the lean while pushing."""
Base = Literal["planar", "free"]
"""`planar`: three slides and a vertical hinge keep the body upright; `free`: only its wheels and casters carry it."""
MotionKind = Literal["contacts", "no-sliding", "sliding"]


def _require_positive(config: object, *names: str) -> None:
    """Raises a ConfigError for fields that are not finite numbers > 0."""
    for name in names:
        value = getattr(config, name)
        if not (math.isfinite(value) and value > 0.0):
            raise ConfigError(f"{type(config).__name__}.{name} must be a finite number > 0, got {value}.")


@dataclass(frozen=True, kw_only=True)
class BodyConfig:
    """The hull (two stacked cylinders around the robot's axis) and the mass of the robot."""

    radius_m: float = 0.18
    height_m: float = 0.88
    """Top of the hull above the floor."""
    clearance_m: float = 0.0128
    """Bottom of the hull above the floor. It is little above `RobotConfig.climb_m`: an edge that the wheels climb only
    with luck meets the hull first, so that heights and not friction decide what blocks the robot."""
    waist_m: float = 0.20
    """Height where the upper cylinder begins: contacts with low obstacles are better conditioned on a low cylinder."""
    skin_m: float = 0.003
    """Contact margin: the collision geoms are smaller by this much and push when another geom is this near.

    Geoms that stay apart have exact distances and normals. For cylinders that overlap by micrometres MuJoCo 4.0 gives,
    in one of ten cases, a normal that is wrong by up to 70 deg and a depth that is wrong by up to 7 cm.
    """
    mass_kg: float = 6.9
    """The whole robot, wheels and casters included."""
    com_height_m: float = 0.12
    """Centre of mass above the floor; it is low because the batteries are at the bottom."""
    friction: float = 0.1
    """Sliding friction of the hull against all geoms."""
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
    """Two driven wheels on springs on the axis through the centre, and frictionless casters in front and behind.

    A wheel of radius r that stands against an edge of height h climbs it from rest if the friction is at least
    tan(arccos(1 - h / r)): 0.67 for 12 mm.
    """

    radius_m: float = 0.07
    half_track_m: float = 0.104
    """Distance of each wheel from the centre."""
    mass_kg: float = 0.3
    """Mass of one wheel."""
    armature_kg_m2: float = 0.009
    """Inertia of the motor at the wheel."""
    motor_gain_nm_s: float = 2.2
    """Torque per rad/s of difference between commanded and actual wheel speed."""
    max_torque_nm: float = 1.4
    """Largest torque of one motor."""
    spring_n_m: float = 2500.0
    """Stiffness of the spring of each wheel of a free base. The wheels of a planar base have no springs."""
    spring_damping_n_s_m: float = 220.0
    """About critical for the mass that a spring carries: the body does not rock over an edge after an impact."""
    spring_travel_m: float = 0.010
    """Largest displacement of a sprung wheel up and down from its position on a level floor."""
    load_share: float = 0.85
    """Share of the weight that sprung wheels carry on a level floor; the casters carry the rest."""
    caster_radius_m: float = 0.045
    caster_offset_m: float = 0.13
    """Distance of each caster from the centre, along the heading."""
    caster_gap_m: float = 0.0005
    """Gap between casters and floor before the springs are compressed."""

    def __post_init__(self) -> None:
        _require_positive(self, *(f.name for f in fields(self) if f.name != "caster_gap_m"))
        if self.load_share > 1.0:
            raise ConfigError(f"WheelConfig.load_share must be at most 1, got {self.load_share}.")
        if not 0.0 <= self.caster_gap_m < self.caster_radius_m:
            raise ConfigError(
                f"WheelConfig.caster_gap_m must lie in [0, caster_radius_m = {self.caster_radius_m}), "
                f"got {self.caster_gap_m}."
            )

    @property
    def max_push_n(self) -> float:
        """Force at the floor with both motors at their largest torque."""
        return 2.0 * self.max_torque_nm / self.radius_m


@dataclass(frozen=True, kw_only=True)
class DriveConfig:
    """The controller of actions: motion profiles, gains, and the criteria of a blocked motion."""

    forward_m: float = FORWARD_M
    turn_rad: float = TURN_RAD
    tick_s: float = 0.02
    """Period of the controller."""
    speed_m_s: float = 0.5
    acceleration_m_s2: float = 1.0
    turn_speed_rad_s: float = 1.8
    turn_acceleration_rad_s2: float = 6.0
    lookahead_s: float = 0.024
    """The planned speed is taken this far ahead of the current time: half a tick and the lag of the motors."""
    position_gain_1_s: float = 6.0
    """Speed per metre behind the profile."""
    heading_gain_1_s: float = 6.0
    """Turn rate per radian of heading error."""
    blocked_s: float = 0.2
    """A motion is blocked when the motors have pushed for this long ..."""
    blocked_m: float = 0.005
    """... and the body has moved by less than this ..."""
    blocked_rad: float = math.radians(0.7)
    """... or has turned by less than this."""
    pushing_m_s: float = 0.05
    """Motors push while their commanded speed is at least this ..."""
    pushing_rad_s: float = 0.15
    """... or their commanded turn rate is."""
    push_share: float = 0.75
    """Largest share of the force of the motors that pushes an object; the rest keeps the heading."""
    gyro: bool = True
    """The base has a gyro, which measures its heading; False: the wheel encoders measure it."""
    touch_memory_s: float = 0.1
    """The hull counts as touching an object for this long after the last contact, since it may bounce."""
    back_off_m: float = 0.004
    """Distance to move back after a blocked motion, so that the hull touches nothing ..."""
    back_off_speed_m_s: float = 0.04
    """... at this speed ..."""
    back_off_max_s: float = 0.2
    """... and for at most this time."""
    realign_max_s: float = 0.6
    """Longest time to turn back to the heading reference after a blocked motion."""
    rest_max_s: float = 0.4
    """Longest time to brake at the end of an action."""
    position_tolerance_m: float = 0.0005
    """A forward motion has reached its end when it is this near to it ..."""
    touching_tolerance_m: float = 0.005
    """... or this near while it pushes an object, which holds it back ..."""
    heading_tolerance_rad: float = math.radians(0.05)
    """... and its heading is this near to the reference ..."""
    rest_speed_m_s: float = 0.002
    """... and it moves more slowly than this ..."""
    rest_speed_rad_s: float = 0.01
    """... and turns more slowly than this."""
    coarse_after_s: float = 0.2
    """So much time after the end of its profile a motion that stands still has reached its end also when it is this
    near to it: `touching_tolerance_m` and `coarse_heading_rad`. Motors with an error do not get nearer."""
    coarse_heading_rad: float = math.radians(1.0)
    timeout_s: float = 1.0
    """Time limit of a motion in addition to the duration of its profile."""

    def __post_init__(self) -> None:
        _require_positive(self, *(f.name for f in fields(self) if f.name != "gyro"))
        if self.push_share > 1.0:
            raise ConfigError(f"DriveConfig.push_share must be at most 1, got {self.push_share}.")


@dataclass(frozen=True, kw_only=True)
class PhysicsConfig:
    """The time step, and the limits beyond which a state is not physical."""

    timestep_s: float = 0.004
    """Chosen by convergence: at 4, 2.5, 2 and 1 ms the robot climbs and is stopped by the same edges; the hull overlaps
    obstacles by less than 3 mm."""
    settle_s: float = 0.2
    """Simulated time for the robot to come to rest after it was placed on the floor."""
    max_overlap_m: float = 0.001
    """A start where the hull overlaps a geom by more than this is refused."""
    max_step_m: float = 0.05
    """A wheel or a caster is not supported if the floor is farther below it than this; a rug or a threshold is less."""
    max_drop_m: float = 0.1
    """A robot has fallen if an action lowers it by more than this, or if its centre of mass is outside the hull of its
    supported wheels and casters (`sim.world.support`)."""
    max_tilt_rad: float = math.radians(25.0)
    """A free base that leans more than this, and has not fallen, has tipped over."""

    def __post_init__(self) -> None:
        _require_positive(self, *(f.name for f in fields(self)))


@dataclass(frozen=True)
class RobotFile:
    """A third-party body that replaces the default one (`sim.robot.foreign`)."""

    path: Path
    """The MJCF file."""
    wheel_joints: tuple[str, ...]
    """Names of the hinges of the left wheels, then those of as many right ones."""
    casters: tuple[str, ...] = ()
    """Names of geoms or bodies that slide on the floor."""
    heading_rad: float = 0.0
    """Direction that is ahead in the file, counter-clockwise from +x."""
    track_m: float | None = None
    """Distance between the middles of the tyres; None: that of the wheels' joints."""
    pose: tuple[tuple[str, float], ...] = ()
    """Names of other joints and their positions, rad or m, in which they are fixed; those not named stay at zero."""
    cylinder_m: tuple[float, float] | None = None
    """Radius and height of the upright cylinder around the robot, if the sidecar has both: the body of a robot without
    collision geoms."""
    root: Path | None = None
    """Another folder whose files the robot may use; None: only its own."""

    @property
    def sides(self) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """The wheel joints of the left and of the right side."""
        half = len(self.wheel_joints) // 2
        return self.wheel_joints[:half], self.wheel_joints[half:]

    @property
    def skids(self) -> bool:
        """Whether it has several wheels a side (skid steering)."""
        return len(self.wheel_joints) > 2


@dataclass(frozen=True, kw_only=True)
class RobotConfig:
    """The complete configuration of the robot."""

    base: Base = "free"
    climb_m: float = CLIMB_M
    """Height of the highest edge that the robot climbs; any higher geom is an obstacle (`sim.world.obstacles`)."""
    body: BodyConfig = field(default_factory=BodyConfig)
    wheels: WheelConfig = field(default_factory=WheelConfig)
    drive: DriveConfig = field(default_factory=DriveConfig)
    physics: PhysicsConfig = field(default_factory=PhysicsConfig)
    file: RobotFile | None = None
    """A third-party body, which `body` and `wheels` then describe; None: the default body, which is built from them."""
    camera_forward_m: float = 0.0
    """Distance of the camera ahead of the axle."""
    motion: MotionKind = "contacts"
    """How actions move the robot: `contacts` is physics. The other two are those of Habitat: a disc glides over the
    free space without physics, and an obstacle ends its motion (`no-sliding`) or deflects it (`sliding`)."""

    def __post_init__(self) -> None:
        if self.motion not in get_args(MotionKind):
            kinds = ", ".join(get_args(MotionKind))
            raise ConfigError(f"RobotConfig.motion must be one of {kinds}, got '{self.motion}'.")
        if self.base not in get_args(Base):
            raise ConfigError(f"RobotConfig.base must be one of {', '.join(get_args(Base))}, got '{self.base}'.")
        if self.file is not None and self.base == "free":
            raise ConfigError("RobotConfig.base 'free' is for the default body only; use 'planar' with a file.")
        steps = self.drive.tick_s / self.physics.timestep_s
        if abs(steps - round(steps)) > 1e-6 or round(steps) < 1:
            raise ConfigError(
                "DriveConfig.tick_s must be a whole multiple of PhysicsConfig.timestep_s, got "
                f"{self.drive.tick_s} s and {self.physics.timestep_s} s."
            )
        wheels = self.wheels
        if self.body.mass_kg <= 2.0 * wheels.mass_kg:
            raise ConfigError(
                "BodyConfig.mass_kg is the mass of the whole robot and must exceed that of its wheels, "
                f"{2 * wheels.mass_kg} kg; got {self.body.mass_kg} kg."
            )
        stiffness = wheels.motor_gain_nm_s * self.physics.timestep_s / wheels.armature_kg_m2
        if stiffness >= 1.0:
            raise ConfigError(
                "motor_gain_nm_s * timestep_s / armature_kg_m2 must be below 1, or the wheels oscillate; it is "
                f"{wheels.motor_gain_nm_s} * {self.physics.timestep_s} / {wheels.armature_kg_m2} = {stiffness:.2f}."
            )
        if not 0.0 <= self.climb_m < self.body.waist_m:
            raise ConfigError(
                f"RobotConfig.climb_m must lie in [0, waist_m = {self.body.waist_m}), got {self.climb_m} m."
            )
        if not abs(self.camera_forward_m) < self.body.radius_m:
            raise ConfigError(
                f"RobotConfig.camera_forward_m must be within the body's radius of {self.body.radius_m:.3f} m, or "
                f"the camera would see through walls; got {self.camera_forward_m} m."
            )
        if wheels.half_track_m >= self.body.radius_m or wheels.caster_offset_m >= self.body.radius_m:
            raise ConfigError(
                f"Wheels and casters must be within the hull's radius of {self.body.radius_m} m, got "
                f"half_track_m {wheels.half_track_m} and caster_offset_m {wheels.caster_offset_m}."
            )

    @property
    def steps_per_tick(self) -> int:
        """Physics steps per tick of the controller."""
        return round(self.drive.tick_s / self.physics.timestep_s)

    @property
    def model(self) -> RobotModel:
        """The part of the configuration that agents get."""
        return RobotModel(
            radius_m=self.body.radius_m,
            height_m=self.body.height_m,
            camera_forward_m=self.camera_forward_m,
            clearance_m=self.body.clearance_m,
            climb_m=self.climb_m,
        )
