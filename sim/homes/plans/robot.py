"""The robot in a plan: a disc that turns on the spot and moves straight until the border of the free space."""

from __future__ import annotations

import math
from dataclasses import dataclass

from sim.core.geometry.pose import Pose
from sim.core.interface import FORWARD_M, TURN_RAD, Action, wrap_angle
from sim.homes.plans.motion_kernels import advance
from sim.homes.plans.plan import Plan

_STEPS = 25  # of a centimetre


@dataclass(frozen=True)
class PlanMotion:
    """The result of one action."""

    moved_m: float
    collided: bool
    """True: the border of the free space ended the motion."""


class PlanRobot:
    """The pose of a robot in a plan. It neither slides nor pushes: a motion ends at the border of the free space."""

    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        self.pose = Pose(0.0, 0.0, 0.0, plan.floor_z_m)

    def move(self, action: Action) -> PlanMotion:
        """Carries out an action and changes the pose."""
        pose = self.pose
        if action is Action.MOVE_FORWARD:
            frame, cells = self.plan.frame, FORWARD_M / _STEPS / self.plan.frame.cell_m
            made = advance(
                self.plan.slack_m,
                (pose.y_m - frame.origin_xy_m[1]) / frame.cell_m,
                (pose.x_m - frame.origin_xy_m[0]) / frame.cell_m,
                math.sin(pose.yaw_rad) * cells,
                math.cos(pose.yaw_rad) * cells,
                _STEPS,
            )
            moved_m = made * FORWARD_M / _STEPS
            self.pose = Pose(*pose.ahead(moved_m), pose.yaw_rad, pose.floor_z_m)
            return PlanMotion(moved_m, made < _STEPS)
        if action is not Action.STOP:
            turn_rad = TURN_RAD if action is Action.TURN_LEFT else -TURN_RAD
            self.pose = Pose(pose.x_m, pose.y_m, wrap_angle(pose.yaw_rad + turn_rad), pose.floor_z_m)
        return PlanMotion(0.0, False)
