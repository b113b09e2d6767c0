"""Tests of the trap scenes: format, determinism, sidecars and episodes."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from sim.core.errors import HouseError
from sim.core.geometry.pose import Pose
from sim.core.interface import MPCAT40_ID
from sim.core.paths import assets_dir
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.recipes import START_TURNS_RAD
from sim.episodes.splits import load_split, one_house
from sim.houses.sidecar import EMPTY_SIDECAR, Sidecar, TrapFacts, read_sidecar, write_sidecar
from tests.helpers.sampling import sample

SHIPPED = assets_dir() / "traps"
TRAPS = sorted(file.stem for file in SHIPPED.glob("*.xml"))


def test_there_are_at_least_twelve_traps_and_each_is_shipped_with_episodes():
    split = load_split("traps")
    assert set(split.houses) == set(TRAPS)
    assert len(TRAPS) >= 12
    for name in TRAPS:
        assert sum(episode.house == name for episode in split.episodes) == len(START_TURNS_RAD)


def test_the_first_episodes_of_the_split_are_one_for_each_trap():
    assert sorted(episode.house for episode in load_split("traps").episodes[: len(TRAPS)]) == TRAPS


@pytest.mark.parametrize("name", sample(TRAPS, 6))
def test_a_shipped_trap_has_start_goal_zone_and_reason(name):
    sidecar = read_sidecar(SHIPPED / f"{name}.xml")
    assert sidecar.start is not None
    assert sidecar.goal is not None
    assert sidecar.zone_m is not None
    assert 20 < len(sidecar.reason) < 130
    episode = load_split("traps").episode(f"{name}_0")
    assert (episode.start.x_m, episode.start.y_m, episode.goal) == (
        pytest.approx(sidecar.start.x_m),
        pytest.approx(sidecar.start.y_m),
        sidecar.goal,
    )


def test_the_traps_together_stay_below_a_megabyte():
    assert sum(file.stat().st_size for file in SHIPPED.rglob("*") if file.is_file()) < 1_000_000


def test_writing_and_reading_a_sidecar_is_identity(tmp_path):
    sidecar = Sidecar(
        start=Pose(1.0, -2.0, 0.5, 3.0),
        goal="bed",
        noise={"depth": {"hole_share": 1.0}},
        reason="why",
        zone_m=(0.0, 1.0, 2.0, 3.0),
        trap=TrapFacts(
            family="pane_gap",
            difficulty="hard",
            seed=3,
            parameters={"gap_m": 0.5, "rows": 2},
            gap_m=0.5,
            hidden_length_m=3.0,
            hidden_objects=2,
            shortest_path_m=5.0,
            open_path_m=4.0,
            fewest_actions=20,
        ),
    )
    write_sidecar(tmp_path / "a.xml", sidecar)
    assert read_sidecar(tmp_path / "a.xml") == sidecar
    assert read_sidecar(tmp_path / "b.xml") == EMPTY_SIDECAR


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ({"gaol": "bed"}, "gaol"),
        ({"goal": "spoon"}, "spoon"),
        ({"start": {"x_m": 1.0}}, "y_m"),
        ({"start": {"x_m": 1.0, "y_m": float("inf"), "yaw_rad": 0.0}}, "not JSON"),
        ({"start": {"x_m": 1.0, "y_m": 1e308, "yaw_rad": 0.0}}, "field 'start.y_m'"),
        ({"zone_m": [1.0, 2.0]}, "zone_m"),
        ([1], "a.json"),
    ],
)
def test_the_error_of_a_bad_sidecar_names_the_field(content, message, tmp_path):
    (tmp_path / "a.json").write_text(json.dumps(content))
    with pytest.raises(HouseError, match=message):
        read_sidecar(tmp_path / "a.xml")


def copy_of_glass_pane(folder: Path) -> Path:
    """Copies a shipped trap with its sidecar; returns its house file."""
    for name in ("glass_pane.json", "glass_pane.xml"):
        shutil.copy(SHIPPED / name, folder)
    return folder / "glass_pane.xml"


def test_the_sidecar_is_part_of_the_hash(tmp_path: Path):
    house = copy_of_glass_pane(tmp_path)
    before = one_house(house).sha256
    write_sidecar(house, Sidecar(goal="bed", noise={"preset": "harsh"}))
    assert one_house(house).sha256 != before


def test_label_rules_named_like_the_house_are_not_a_sidecar(tmp_path: Path):
    house = copy_of_glass_pane(tmp_path)
    (tmp_path / "glass_pane.json").write_text('{"sofa.*": "bed"}')
    split = one_house(house, labels=tmp_path / "glass_pane.json")
    assert split.sidecar("glass_pane") == EMPTY_SIDECAR


def test_a_house_with_a_sidecar_uses_its_start_and_goal():
    env = ObjectNavEnv(house=SHIPPED / "chair_legs.xml", sensors=())
    try:
        drawn = env.draw_episode(np.random.default_rng(3))
        fixed = read_sidecar(SHIPPED / "chair_legs.xml")
        assert (drawn.start, drawn.goal) == (fixed.start, fixed.goal)
    finally:
        env.close()


def test_the_noise_of_a_sidecar_affects_its_own_scene_only():
    env = ObjectNavEnv(split="traps", sensors=("depth", "semantic"))
    try:
        holes = {}
        for name in ("mirror_holes", "glass_pane", "mirror_holes"):
            observation, _ = env.reset(seed=0, options={"episode_id": f"{name}_0"})
            holes[name] = observation["depth"] == 0.0
            mirror = observation["semantic"] == MPCAT40_ID["mirror"]
            if name == "mirror_holes":
                assert mirror.sum() > 5000
                assert holes[name][mirror].mean() > 0.99
                assert holes[name][~mirror].mean() < 0.1
        assert not holes["glass_pane"].any()
    finally:
        env.close()
