"""The benchmark's baseline renders what our camera renders, and its table has five figures."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from sim.app.commands import bench
from sim.app.commands.bench import Figure, PlainRenderer, free_poses
from sim.episodes.splits import load_split
from sim.gl import mujoco
from sim.renderer.camera import Camera
from sim.world.world import World


def test_a_figure_says_how_many_times_faster_it_is_than_the_plain_renderer() -> None:
    assert Figure(what="a frame", value=2.0, unit="ms", plain=10.0).times_faster == 5.0
    assert Figure(what="steps", value=20.0, unit="/s", plain=10.0).times_faster == 2.0
    assert Figure(what="a step", value=20.0, unit="ms").times_faster is None


@pytest.mark.costly
def test_the_baseline_renders_what_our_camera_renders() -> None:
    world = World(load_split("val").load_house("val_00"))
    mujoco.mj_forward(world.model, world.data)
    plain, camera = PlainRenderer(world), Camera(world.model, world.labels)
    try:
        for pose in free_poses(world, 2, np.random.default_rng(0)):
            theirs = plain.render(pose, ("depth", "semantic"))
            ours = camera.render(world.data, pose, ("depth", "geom"))
            seen = (ours["depth"] > 0.5) & (ours["depth"] < 5.0)
            assert (theirs["semantic"][..., 0] == ours["geom"]).mean() > 0.97
            assert np.abs(theirs["depth"] - ours["depth"])[seen].max() < 5.0  # an edge may belong to another object
            assert np.median(np.abs(theirs["depth"] - ours["depth"])[seen]) < 1e-3
    finally:
        plain.close()
        camera.close()


@pytest.mark.costly
def test_a_quick_run_prints_and_writes_five_figures(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert bench.main(bench.Args(quick=True, out=tmp_path / "bench.json")) == 0
    figures = json.loads((tmp_path / "bench.json").read_text())
    assert len(figures) == 5
    assert all(figure["value"] > 0.0 for figure in figures)
    assert [figure["plain"] is None for figure in figures] == [False, False, True, True, False]
    printed = capsys.readouterr().out
    assert all(figure["what"] in printed for figure in figures)
