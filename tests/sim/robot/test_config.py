"""An impossible robot is refused when it is declared."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from sim.core.interface import ConfigError
from sim.robot.config import BodyConfig, DriveConfig, PhysicsConfig, RobotConfig, RobotFile, WheelConfig


def test_agents_get_the_size_of_the_hull():
    model = RobotConfig(body=BodyConfig(radius_m=0.2, height_m=1.0)).model
    assert (model.radius_m, model.height_m) == (0.2, 1.0)


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: RobotConfig(base="hovering"), "planar, free, got 'hovering'"),  # type: ignore[arg-type]
        (lambda: BodyConfig(mass_kg=0.0), "BodyConfig.mass_kg must be a finite number > 0, got 0.0"),
        (lambda: BodyConfig(radius_m=float("nan")), "BodyConfig.radius_m must be a finite number > 0, got nan"),
        (lambda: BodyConfig(waist_m=0.9), "clearance_m < waist_m < height_m"),
        (lambda: WheelConfig(caster_gap_m=-0.001), "WheelConfig.caster_gap_m"),
        (lambda: WheelConfig(max_torque_nm=-1.0), "WheelConfig.max_torque_nm"),
        (lambda: DriveConfig(blocked_s=0.0), "DriveConfig.blocked_s"),
        (lambda: DriveConfig(push_share=1.1), "DriveConfig.push_share must be at most 1, got 1.1"),
        (lambda: WheelConfig(load_share=1.1), "WheelConfig.load_share must be at most 1, got 1.1"),
        (lambda: PhysicsConfig(timestep_s=0.0), "PhysicsConfig.timestep_s"),
        (lambda: RobotConfig(physics=PhysicsConfig(timestep_s=0.003)), "whole multiple"),
        (lambda: RobotConfig(wheels=WheelConfig(armature_kg_m2=0.002)), "must be below 1, or the wheels oscillate"),
        (lambda: RobotConfig(wheels=WheelConfig(half_track_m=0.2)), "within the hull"),
        (lambda: RobotConfig(climb_m=0.3), "RobotConfig.climb_m must lie in [0, waist_m = 0.2), got 0.3 m"),
        (lambda: RobotConfig(body=BodyConfig(mass_kg=0.4)), "mass"),
        (
            lambda: RobotConfig(base="free", file=RobotFile(Path("robot.xml"), ("left", "right"))),
            "is for the default body only",
        ),
    ],
)
def test_impossible_values_are_refused_by_name(build, message):
    with pytest.raises(ConfigError) as error:
        build()
    assert message in str(error.value)


def test_a_nested_field_can_be_replaced_without_changing_the_original():
    config = RobotConfig()
    slower = replace(config, drive=replace(config.drive, speed_m_s=0.25))
    assert slower.drive.speed_m_s == 0.25
    assert config.drive.speed_m_s == 0.5
