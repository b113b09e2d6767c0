"""Parts (f) and (g): writing views to disk, and making houses from seeds."""

from __future__ import annotations

import functools
import math
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from sim.app.commands.bench.figures import Figure, Goal, timed
from sim.app.commands.bench.stages import Setting
from sim.core.interface import CameraModel
from sim.env.scene import Scene
from sim.episodes.house_list import copy_textures
from sim.episodes.splits import load_split
from sim.homes.housegen.generator import HouseConfig, generate_house
from sim.houses.house import House
from sim.houses.load import load_house
from sim.houses.writing import house_text
from sim.robot.config import RobotConfig
from sim.training.views.shards import write_shard
from sim.training.views.views import View, sample_views
from sim.world.world import World

VIEW_GOALS_PER_S = {"good": 15.0, "fast": 40.0}
"""Fewest views per second, by profile."""


def views_to_disk(setting: Setting) -> list[Figure]:
    """(f) Measures writing views as `stubborn views` does, against only rendering them."""
    count, split = setting.amount.views, load_split("val")
    figures = []
    with tempfile.TemporaryDirectory() as folder:
        for profile in ("good", "fast"):
            scene = Scene(split.load_house(split.houses[0]), robot=RobotConfig(), camera=CameraModel(), profile=profile)

            def views(scene: Scene = scene) -> Iterator[View]:
                return sample_views(scene, np.random.default_rng(0), count, stem="v", record={})

            for _ in views():  # builds the grid of the house and starts the renderer
                break
            drawn_ms = written_ms = math.inf
            for _ in range(2):
                drawn_ms = min(drawn_ms, timed(lambda views=views: list(views())))
                to_disk = functools.partial(write_shard, Path(folder), profile, house="h", config={})
                written_ms = min(written_ms, timed(lambda views=views, to_disk=to_disk: to_disk(views())))
            scene.close()
            rates = [1e3 * count / ms for ms in (written_ms, drawn_ms)]
            figures.append(
                Figure(part="f", what=f"views to disk, profile {profile}", value=rates[0], unit="/s",
                       against="only drawn", baseline=rates[1], ratio=rates[0] / rates[1],
                       goal=Goal(of="value", sign=">=", bound=VIEW_GOALS_PER_S[profile]), count=count)
            )  # fmt: skip
    return figures


def new_houses(setting: Setting) -> list[Figure]:
    """(g) Measures making, checking and writing a house, against reading and compiling the same house."""
    made_ms, read_ms = [], []
    with tempfile.TemporaryDirectory() as folder:
        copy_textures(Path(folder) / "textures")
        for seed in range(setting.amount.made_houses):
            file = Path(folder) / f"house_{seed}.xml"
            made_ms.append(timed(lambda seed=seed, file=file: write_house(file, seed, HouseConfig())))
            read_ms.append(timed(lambda file=file: World(load_house(file))))
    value, baseline = float(np.median(made_ms)), float(np.median(read_ms))
    return [
        Figure(part="g", what="a new house, checked, written", value=value, unit="ms", against="to read and compile it",
               baseline=baseline, ratio=value / baseline, count=len(made_ms))
    ]  # fmt: skip


def write_house(file: Path, seed: int, config: HouseConfig) -> House:
    """Generates a house and writes it to a file whose folder has the textures."""
    spec = generate_house(seed, config).spec
    file.write_text(house_text(spec, "textures"), encoding="utf-8")
    return House(file.stem, spec)
