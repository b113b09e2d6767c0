"""Measures how the robot leans, pushes, slips and drifts, and the errors of its motions.

    python -m tools.research.lean_tables                                 # all tables, some minutes
    python -m tools.research.lean_tables --tables pushes,slopes --out runs/lean.json

| table | measures |
|---|---|
| rest | the lean at rest on a flat floor, on rugs and on ramps, and what it makes of the floor 3 m ahead |
| pushes | how far a forward moves legged chairs, by the height of the contact, against statics |
| slopes | ramps: whether the robot climbs, its speed when it is left alone, and whether a stop is a collision |
| ledges | displacement of the forward that leads over an edge down |
| surfaces | true and measured distance of 40 forwards by friction of the floor, and on carpet |
| noise | errors of a forward and a turn with each noise preset, and those of a LoCoBot (PyRobot, controller ILQR) |
| drift | true pose against odometry after 10 and 50 forwards and turns, by noise preset, with intervals |
"""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.table import Table

from sim.app import cli
from sim.app.analysis import display
from sim.core.files import write_atomically
from sim.core.geometry.pose import Pose
from sim.core.interface import FORWARD_M, TURN_RAD, Action
from sim.gl import mujoco
from sim.houses.house import House
from sim.robot.body import GRAVITY_M_S2
from sim.robot.config import RobotConfig
from sim.sensors.noise import NOISE_PRESETS
from sim.world.world import World

Row = dict[str, str | float]
FORWARD, LEFT, RIGHT = Action.MOVE_FORWARD, Action.TURN_LEFT, Action.TURN_RIGHT
FLOOR_FRICTION, GLIDE_FRICTION = 0.7, 0.2
SEAT_M, LEG_INSET_M = 0.4, 0.05
"""Edge of the seats that are pushed, and distance of their legs from the edge."""
DRIFT_EPISODES = 200
LOCOBOT = {"forward_mm": 14.0, "sideways_mm": 9.0, "turn_deg": math.degrees(0.023)}
"""Mean errors of a forward and a turn that PyRobot publishes for a LoCoBot with the controller ILQR."""
LOCOBOT_STD = {"forward_std_mm": 6.0, "sideways_std_mm": 5.0, "turn_std_deg": math.degrees(0.012)}
"""Their standard deviations."""
NOISE_EPISODES = 30
"""Draws of an episode's conditions for each preset."""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Measure how the robot leans, pushes, slips and drifts, and print one table for each part."""

    tables: str = "rest,pushes,slopes,ledges,surfaces,noise,drift"
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


def lean_deg(world: World) -> tuple[float, float]:
    """Returns pitch (nose down) and roll (to the right) of the robot, degrees."""
    matrix = np.empty(9)
    base = world.model.body("stubborn_robot/base")
    address = world.model.jnt_qposadr[base.jntadr[0]]
    mujoco.mju_quat2Mat(matrix, world.data.qpos[address + 3 : address + 7])
    return math.degrees(math.asin(-matrix[6])), math.degrees(math.atan2(matrix[7], matrix[8]))


def height_m(world: World) -> float:
    """Returns the height of the origin of the robot frame."""
    return float(world.data.qpos[world.model.jnt_qposadr[world.model.body("stubborn_robot/base").jntadr[0]] + 2])


def add_box(spec: mujoco.MjSpec, name: str, pos: tuple[float, ...], half: tuple[float, ...], pitch_rad: float = 0.0):
    """Adds a static box that is turned about y, and returns it."""
    quat = math.cos(0.5 * pitch_rad), 0.0, math.sin(0.5 * pitch_rad), 0.0
    geom = spec.worldbody.add_geom(name=name, type=mujoco.mjtGeom.mjGEOM_BOX, pos=pos, size=half, quat=quat)
    geom.friction[0] = FLOOR_FRICTION
    return geom


def ramp(angle_rad: float) -> mujoco.MjSpec:
    """Returns a floor with a ramp of 3 m that begins 1 m ahead."""
    spec, half, thick = floor(FLOOR_FRICTION), 1.5, 0.05
    cos, sin = math.cos(angle_rad), math.sin(angle_rad)
    pos = 1.0 + half * cos + thick * sin, 0.0, half * sin - thick * cos
    add_box(spec, "floor_01", pos, (half, 2.0, thick), -angle_rad)
    return spec


def rest() -> Iterator[Row]:
    """Yields the lean of the robot at rest, the largest over forwards from starts 5 cm apart."""
    for rug_mm in (0, 5, 12):
        spec = floor(FLOOR_FRICTION)
        if rug_mm:
            add_box(spec, "floor_01", (1.6, 0.0, 0.0005 * rug_mm), (0.6, 1.0, 0.0005 * rug_mm))
        yield {"ground": f"rug of {rug_mm} mm" if rug_mm else "floor", **_largest_lean(spec)}
    for angle_deg in (4.0, 8.0):
        yield {"ground": f"ramp of {angle_deg:g} deg", **_largest_lean(ramp(math.radians(angle_deg)))}


def _largest_lean(spec: mujoco.MjSpec) -> Row:
    world, frames, pitches, rolls = World(House("rest", spec)), 0, [], []
    for x_m in (0.0, 0.05, 0.10, 0.15, 0.20):
        for yaw_deg in (0.0, 30.0):
            world.reset(Pose(x_m, 0.0, math.radians(yaw_deg)))
            for _ in range(10):
                world.move(FORWARD)
                pitch, roll = lean_deg(world)
                frames, pitches, rolls = frames + 1, [*pitches, pitch], [*rolls, roll]
    lean = np.hypot(pitches, rolls)
    at = int(np.argmax(np.abs(pitches)))
    return {
        "pitch_deg": pitches[at],
        "roll_deg": rolls[int(np.argmax(np.abs(rolls)))],
        "frames_above_1_deg_%": 100.0 * float(np.mean(lean > 1.0)),
        "floor_at_3_m_off_by_m": 3.0 * math.tan(math.radians(float(lean.max()))),
    }


def pushes() -> Iterator[Row]:
    """Yields how far one forward moves a chair that the hull touches at a height; statics say whether it can."""
    config = RobotConfig()
    for contact_m in (0.10, 0.20, 0.30, 0.45, 0.60, 0.75):
        for mass_kg in (2.0, 4.0, 6.0, 8.0):
            slides_n = GLIDE_FRICTION * mass_kg * GRAVITY_M_S2
            most_n = largest_push_n(config, contact_m)
            moved_m, most_deg, ended = push_chair(contact_m, mass_kg)
            yield {
                "contact_m": contact_m,
                "mass_kg": mass_kg,
                "slides_at_n": slides_n,
                "robot_pushes_n": most_n,
                "theory": "moves" if slides_n < most_n else "blocked",
                "moved_m": moved_m,
                "largest_lean_deg": most_deg,
                "ended": ended,
            }


def largest_push_n(config: RobotConfig, contact_m: float) -> float:
    """Returns the largest force of the robot at a height.

    The push at a height h and the traction at the floor lift the wheels about the rear caster at a distance d: they
    carry m g - F h / d, and F is at most the friction times that. Below about 0.11 m the motors are the limit.
    """
    weight_n, arm = config.body.mass_kg * GRAVITY_M_S2, contact_m / config.wheels.caster_offset_m
    traction_n = FLOOR_FRICTION * weight_n / (1.0 + FLOOR_FRICTION * arm)
    return min(traction_n, config.drive.push_share * config.wheels.max_push_n)


def push_chair(contact_m: float, mass_kg: float) -> tuple[float, float, str]:
    """Returns how far the second of two forwards moves a chair, m, the robot's largest lean, deg, and how it ended."""
    spec = floor(FLOOR_FRICTION)
    chair = spec.worldbody.add_body(name="chair_00", pos=(0.18 + 0.05 + 0.5 * SEAT_M, 0.0, 0.0))
    chair.add_freejoint()
    half, leg = 0.5 * SEAT_M, 0.5 * SEAT_M - LEG_INSET_M
    parts = [((0.0, 0.0, contact_m), (half, half, 0.01), 0.6 * mass_kg)]
    middle_m = 0.5 * (contact_m - 0.01)
    parts += [((x, y, middle_m), (0.015, 0.015, middle_m), 0.1 * mass_kg) for x in (leg, -leg) for y in (leg, -leg)]
    for pos, size, mass in parts:
        geom = chair.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, pos=pos, size=size, mass=mass)
        geom.friction, geom.priority = (GLIDE_FRICTION, 0.005, 0.0001), 1
    world = World(House("chair", spec))
    world.reset(Pose(0.0, 0.0, 0.0))
    x = world.model.jnt_qposadr[world.model.body("chair_00").jntadr[0]]
    leans: list[float] = []

    def sample(model: mujoco.MjModel, data: mujoco.MjData) -> None:
        del model, data
        leans.append(math.hypot(*lean_deg(world)))

    mujoco.set_mjcb_control(sample)
    try:
        world.move(FORWARD)
        before_m = float(world.data.qpos[x])
        motion = world.move(FORWARD)
    finally:
        mujoco.set_mjcb_control(None)
    return float(world.data.qpos[x]) - before_m, max(leans), motion.ended


def slopes() -> Iterator[Row]:
    """Yields what the robot does on ramps: ten forwards, then two seconds at rest."""
    for angle_deg in (4.0, 8.0, 10.0, 12.0, 15.0):
        world = World(House("ramp", ramp(math.radians(angle_deg))))
        world.reset(Pose(0.0, 0.0, 0.0))
        motions = [world.move(FORWARD) for _ in range(10)]
        mujoco.mj_step(world.model, world.data, nstep=250)
        x_m = world.pose.x_m
        mujoco.mj_step(world.model, world.data, nstep=250)
        yield {
            "angle_deg": angle_deg,
            "climbs": "yes" if world.pose.x_m > 1.5 else "no",
            "creeps_mm_s": 1000.0 * (world.pose.x_m - x_m),
            "blocked": sum(motion.ended != "reached" for motion in motions),
            "of_them_collided": sum(motion.collided for motion in motions),
        }


def ledges() -> Iterator[Row]:
    """Yields the displacements of forwards over an edge down, from eight starts 3 cm apart."""
    for drop_m in (0.02, 0.03, 0.04, 0.05):
        spec = mujoco.MjSpec()
        add_box(spec, "floor_00", (0.0, 0.0, -0.5), (1.0, 1.0, 0.5))
        add_box(spec, "floor_01", (3.0, 0.0, -0.5 - drop_m), (2.0, 2.0, 0.5))
        world, longest = World(House("ledge", spec)), []
        for number in range(8):
            world.reset(Pose(0.03 * number, 0.0, 0.0))
            longest.append(max(world.move(FORWARD).displacement_m for _ in range(6)))
        yield {"drop_m": drop_m, "mean_m": float(np.mean(longest)), "largest_m": max(longest)}


def surfaces() -> Iterator[Row]:
    """Yields the distances of 40 forwards; half of the floors also with a box of 2 kg that is pushed all the way."""
    for name, friction, carpet in (
        ("very wet", 0.14, False), ("wet", 0.25, False), ("dry", 0.7, False), ("rubber", 1.0, False),
        ("carpet", 0.9, True),
    ):  # fmt: skip
        row: Row = {"floor": name, "friction": friction}
        for load in ("free", "pushing"):
            spec = carpet_floor(friction) if carpet else floor(friction)
            if load == "pushing":
                body = spec.worldbody.add_body(name="stool_00", pos=(0.42, 0.0, 0.2))
                body.add_freejoint()
                box = body.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=(0.2, 0.2, 0.2), mass=2.0)
                box.friction, box.priority = (0.3, 0.005, 0.0001), 1
            world = World(House("surface", spec))
            world.reset(Pose(0.0, 0.0, 0.0))
            for _ in range(40):
                world.move(FORWARD)
            true_m, measured_m = world.pose.x_m, world.odometry.x_m
            row |= {f"{load}_true_m": true_m, f"{load}_odometry_is_long_by_%": 100.0 * (measured_m / true_m - 1.0)}
        yield row


def carpet_floor(friction: float) -> mujoco.MjSpec:
    """Returns an endless floor with a texture of carpet."""
    spec, flat = floor(friction), mujoco.mjtBuiltin.mjBUILTIN_FLAT
    spec.add_texture(name="carpet_pile", type=mujoco.mjtTexture.mjTEXTURE_2D, builtin=flat, width=4, height=4)
    spec.add_material(name="pile").textures[int(mujoco.mjtTextureRole.mjTEXROLE_RGB)] = "carpet_pile"
    spec.geom("floor_00").material = "pile"
    return spec


def noise() -> Iterator[Row]:
    """Yields the mean absolute errors of forwards and turns with each noise preset, on a floor of friction 0.7, and the
    standard deviations within an episode."""
    world = World(House("floor", floor(0.7)))
    for name, preset in NOISE_PRESETS.items():
        errors: dict[str, list[list[float]]] = {key: [] for key in LOCOBOT}  # by episode
        for number in range(NOISE_EPISODES):
            world.reset(Pose(0.0, 0.0, 0.0), preset.actuation.draw(np.random.default_rng(number)))
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


def drift() -> Iterator[Row]:
    """Yields the distance between true pose and odometry after 10 and 50 forwards with as many turns."""
    world = World(House("floor", floor(FLOOR_FRICTION)))
    for name, noise in NOISE_PRESETS.items():
        errors: dict[int, list[tuple[float, float]]] = {10: [], 50: []}
        for number in range(DRIFT_EPISODES if name != "none" else 10):
            rng = np.random.default_rng(number)
            world.reset(Pose(0.0, 0.0, 0.0), noise.actuation.draw(rng))
            for forward in range(1, max(errors) + 1):
                world.move(FORWARD)
                world.move(LEFT if rng.random() < 0.5 else RIGHT)
                if forward in errors:
                    off = world.odometry.relative_to(world.pose)
                    errors[forward].append((math.hypot(off.x_m, off.y_m), abs(math.degrees(off.yaw_rad))))
        for forwards, values in errors.items():
            metres, degrees = np.array(values).T
            yield {
                "preset": name,
                "driven_m": forwards * FORWARD_M,
                "position_m": _with_interval(metres),
                "heading_deg": _with_interval(degrees),
            }


def _with_interval(values: np.ndarray) -> str:
    """Returns the mean with its 95 % interval."""
    half = 1.96 * float(np.std(values, ddof=1)) / math.sqrt(len(values))
    return f"{np.mean(values):.3g} [{np.mean(values) - half:.3g}, {np.mean(values) + half:.3g}]"


TABLES: Mapping[str, Callable[[], Iterator[Row]]] = {
    "rest": rest, "pushes": pushes, "slopes": slopes, "ledges": ledges, "surfaces": surfaces,
    "noise": noise, "drift": drift,
}  # fmt: skip


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
