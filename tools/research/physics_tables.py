"""Measures the robot's physics: errors of motions, edges that it climbs, forces with which it pushes, time steps.

    python -m tools.research.physics_tables                                  # all tables, some minutes
    python -m tools.research.physics_tables --tables motions,pushing --out runs/physics.json

| table | measures |
|---|---|
| motions | errors of a forward and a turn with each noise preset, and those of a LoCoBot (PyRobot, controller ILQR) |
| edges | how many of the approaches climb an edge, by its height, the friction and the base |
| pushing | force on a box that is pushed, against the force of dry friction at its corners |
| steps | edges again, with several time steps |
"""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.table import Table
from scipy.optimize import minimize

from sim.app import cli
from sim.app.analysis import display
from sim.core.files import write_atomically
from sim.core.geometry.pose import Pose
from sim.core.interface import FORWARD_M, TURN_RAD, Action
from sim.gl import mujoco
from sim.houses.house import House
from sim.robot.body import GRAVITY_M_S2
from sim.robot.config import Base, DriveConfig, PhysicsConfig, RobotConfig
from sim.sensors.noise import NOISE_PRESETS
from sim.world.world import World

Row = dict[str, str | float]
LOCOBOT = {"forward_mm": 14.0, "sideways_mm": 9.0, "turn_deg": math.degrees(0.023)}
"""Mean errors of a forward and a turn that PyRobot publishes for a LoCoBot with the controller ILQR."""
LOCOBOT_STD = {"forward_std_mm": 6.0, "sideways_std_mm": 5.0, "turn_std_deg": math.degrees(0.012)}
"""Their standard deviations."""
EPISODES = 30
"""Draws of an episode's conditions for each preset."""
HEIGHTS_M = (0.006, 0.010, 0.012, 0.014, 0.016, 0.018, 0.020, 0.025, 0.030)
HEADINGS_DEG, PHASES_M = (0.0, 20.0, 45.0, 60.0), (0.0, 0.06, 0.12)
"""Approaches of an edge: angle from its normal, and distance beyond 0.4 m, which sets the speed at the edge."""
BOX_M = 0.4
"""Edge of the boxes that are pushed."""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Measure the robot's physics, and print one table for each part."""

    tables: str = "motions,edges,pushing,steps"
    """Names with commas between."""
    out: cli.OutFile | None = None
    """A JSON file for the rows."""


def main(args: Args) -> int:
    """Measures and prints the tables; returns the exit status."""
    write_tables({name: TABLES[name] for name in cli.chosen(args.tables, TABLES, option="--tables")}, args.out)
    return 0


def write_tables(tables: Mapping[str, Callable[[], Iterator[Row]]], out: Path | None) -> None:
    """Measures and prints tables, and writes their rows to a JSON file unless it is None."""
    rows_of = {}
    for name, rows in tables.items():
        rows_of[name] = list(rows())
        show(name, rows_of[name])
    if out is not None:
        write_atomically(out, json.dumps(rows_of, indent=2) + "\n")


def show(name: str, rows: list[Row]) -> None:
    """Prints the rows of one table."""
    table = Table(title=name)
    for key in rows[0]:
        table.add_column(key.replace("_", " "))
    for row in rows:
        table.add_row(*(f"{value:.3g}" if isinstance(value, float) else str(value) for value in row.values()))
    display.make_console().print(table)


def floor(friction: float) -> mujoco.MjSpec:
    """Returns an endless floor."""
    spec = mujoco.MjSpec()
    spec.worldbody.add_geom(name="floor_00", type=mujoco.mjtGeom.mjGEOM_PLANE, size=(0, 0, 1))
    spec.geom("floor_00").friction[0] = friction
    return spec


def motions() -> Iterator[Row]:
    """Yields the mean absolute errors of forwards and turns with each noise preset, on a floor of friction 0.7, and the
    standard deviations within an episode."""
    world = World(House("floor", floor(0.7)))
    for name, noise in NOISE_PRESETS.items():
        errors: dict[str, list[list[float]]] = {key: [] for key in LOCOBOT}  # by episode
        for number in range(EPISODES):
            world.reset(Pose(0.0, 0.0, 0.0), noise.actuation.draw(np.random.default_rng(number)))
            for values in errors.values():
                values.append([])
            for action in map(Action, (1, 2, 1, 3, 1, 1, 2, 2, 1, 3, 1, 3, 1, 1)):
                before = world.pose
                world.move(action)
                moved = world.pose.relative_to(before)
                if action == Action.MOVE_FORWARD:
                    errors["forward_mm"][-1].append(1000.0 * (moved.x_m - FORWARD_M))
                    errors["sideways_mm"][-1].append(1000.0 * moved.y_m)
                else:
                    errors["turn_deg"][-1].append(math.degrees(abs(moved.yaw_rad) - TURN_RAD))
        means = {key: float(np.abs(values).mean()) for key, values in errors.items()}
        within = [float(np.std(values, axis=1, ddof=1).mean()) for values in errors.values()]
        yield {"preset": name, **means, **dict(zip(LOCOBOT_STD, within, strict=True))}
    yield {"preset": "LoCoBot, published", **LOCOBOT, **LOCOBOT_STD}


def edges(
    timestep_s: float = PhysicsConfig().timestep_s,
    bases: Sequence[Base] = ("free", "planar"),
    frictions: Sequence[float] = (0.5, 0.7, 1.0),
) -> Iterator[Row]:
    """Yields the number of approaches that climb a bar across the path."""
    for base in bases:
        config = RobotConfig(base=base, physics=PhysicsConfig(timestep_s=timestep_s))
        for friction in frictions:
            row: Row = {"base": base, "step_ms": 1000.0 * timestep_s, "friction": friction}
            for height_m in HEIGHTS_M:
                climbed = [
                    climbs(config, height_m, friction, math.radians(angle), phase)
                    for angle in HEADINGS_DEG
                    for phase in PHASES_M
                ]
                row[f"{1000 * height_m:.0f} mm"] = f"{sum(climbed)}/{len(climbed)}"
            yield row


def climbs(config: RobotConfig, height_m: float, friction: float, angle_rad: float, phase_m: float) -> bool:
    """Returns whether the robot crosses a bar, 7 cm wide, within six forwards."""
    spec, half_m = floor(friction), (0.035, 4.0, 0.5 * height_m)
    bar = spec.worldbody.add_geom(
        name="door_00", type=mujoco.mjtGeom.mjGEOM_BOX, pos=(1.0, 0.0, half_m[2]), size=half_m
    )
    bar.friction[0] = friction
    world, away_m = World(House("edge", spec), robot=config), 0.4 + phase_m
    world.reset(Pose(0.965 - away_m * math.cos(angle_rad), -away_m * math.sin(angle_rad), angle_rad))
    for _ in range(math.ceil((away_m + 0.25 / math.cos(angle_rad)) / FORWARD_M) + 2):
        world.move(Action.MOVE_FORWARD)
    return world.pose.x_m > 1.2


def pushing() -> Iterator[Row]:
    """Yields the force on boxes that are pushed slowly over 0.4 m, and that of dry friction at their corners."""
    drive = DriveConfig(forward_m=0.5, speed_m_s=0.15, acceleration_m_s2=0.5)
    config = RobotConfig(drive=drive)
    limit_n = drive.push_share * config.wheels.max_push_n
    for mass_kg in (2.0, 4.0, 8.0, 16.0):
        for friction in (0.2, 0.4, 0.6):
            for offset_m in (0.0, 0.1):
                theory_n = friction * sliding_force(offset_m) * mass_kg * GRAVITY_M_S2
                measured_n, moved_m, ended = push(config, mass_kg, friction, offset_m)
                moves = moved_m > 0.1
                yield {
                    "mass_kg": mass_kg,
                    "friction": friction,
                    "offset_m": offset_m,
                    "theory_n": theory_n,
                    "measured_n": measured_n if moves else math.nan,
                    "error_%": 100.0 * (measured_n / theory_n - 1.0) if moves else math.nan,
                    "theory": "moves" if theory_n < limit_n else "blocked",
                    "robot": "moves" if moves else ended,
                }


def sliding_force(offset_m: float) -> float:
    """Returns the force that slides a box on its four corners, relative to friction times weight.

    The force acts at right angles to a side, `offset_m` from its middle. By the upper-bound theorem it is the smallest
    ratio of the power that friction takes to the speed of the contact, over all motions of the box in plan.
    """
    half = 0.5 * BOX_M
    corners = np.array([(half, half), (half, -half), (-half, half), (-half, -half)])

    def ratio(motion: NDArray[np.float64]) -> float:
        sideways, turn = motion
        speed = np.hypot(1.0 - turn * corners[:, 1], sideways + turn * corners[:, 0]).mean()
        contact = 1.0 - turn * offset_m
        return float(speed / contact) if contact > 1e-6 else math.inf

    starts = ((0.0, 0.0), (0.0, -2.0), (0.0, 2.0))
    return min(float(minimize(ratio, start, method="Nelder-Mead").fun) for start in starts)


def push(config: RobotConfig, mass_kg: float, friction: float, offset_m: float) -> tuple[float, float, str]:
    """Returns the mean force while a box begins to move, N, its displacement, m, and how the motion ended."""
    spec, half = floor(0.8), 0.5 * BOX_M
    body = spec.worldbody.add_body(name="stool_00", pos=(0.18 + half + 0.02, offset_m, half))
    body.add_freejoint()
    box = body.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=(half, half, half), mass=mass_kg)
    box.friction, box.priority = (friction, 0.005, 0.0001), 1
    world = World(House("push", spec), robot=config)
    world.reset(Pose(0.0, 0.0, 0.0))
    joint = world.model.body("stool_00").jntadr[0]
    q, v, forces = world.model.jnt_qposadr[joint], world.model.jnt_dofadr[joint], []
    touch = world.model.sensor("stubborn_robot/touch").adr[0]

    def sample(model: mujoco.MjModel, data: mujoco.MjData) -> None:
        del model
        # At the speed of the robot, before the box has turned much; the robot itself still accelerates before 0.5 s.
        if 0.02 < data.qvel[v] < 0.18 and 0.01 < data.qpos[q] - x_m < 0.08:
            forces.append(float(data.sensordata[touch + 1]))

    x_m = float(world.data.qpos[q])
    mujoco.set_mjcb_control(sample)
    try:
        motion = world.move(Action.MOVE_FORWARD)
    finally:
        mujoco.set_mjcb_control(None)
    return float(np.mean(forces)) if forces else math.nan, float(world.data.qpos[q]) - x_m, motion.ended


def steps() -> Iterator[Row]:
    """Yields the table of edges of the free base for several time steps."""
    for timestep_s in (0.004, 0.0025, 0.002, 0.001):
        yield from edges(timestep_s, ("free",), (0.7, 1.0))


TABLES: Mapping[str, Callable[[], Iterator[Row]]] = {
    "motions": motions, "edges": edges, "pushing": pushing, "steps": steps,
}  # fmt: skip


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
