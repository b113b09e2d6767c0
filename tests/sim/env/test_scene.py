"""Scenes from the cache of prepared houses: equal to the bit, and made again when a file of theirs changes."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from sim.core.errors import HouseError
from sim.core.interface import CameraModel
from sim.core.paths import CACHE_VARIABLE
from sim.core.store import SIZE_VARIABLE
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.house_list import copy_textures
from sim.episodes.splits import load_split
from sim.gl import mujoco
from sim.houses.load import load_house
from sim.world.world import World
from tests.helpers.sampling import sample

ACTIONS = (1, 2, 1, 3, 1, 1, 2, 2, 1, 0)


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv(CACHE_VARIABLE, str(tmp_path / "cache"))
    monkeypatch.setenv(SIZE_VARIABLE, "1000")
    return tmp_path / "cache" / "prepared"


@pytest.mark.costly
@pytest.mark.parametrize("split", ["val", "hazards", "large"])
def test_a_prepared_house_gives_the_same_episode_to_the_bit(
    split: str, cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    house = sample(load_split(split).houses, 1)[0]
    kept = [list(_frames(split, house)) for _ in range(2)]
    assert any(cache.iterdir())
    monkeypatch.setenv(SIZE_VARIABLE, "0")
    plain = list(_frames(split, house))
    assert kept[0] == plain
    assert kept[1] == plain


def _frames(split: str, house: str) -> Iterator[tuple[object, ...]]:
    """Yields the bytes of observations, the metrics and the distances of two episodes in a house."""
    camera = CameraModel(width_px=64, height_px=48)
    with_images = ("rgb", "depth", "semantic")
    env = ObjectNavEnv(split=split, houses=(house,), sensors=with_images, camera=camera)
    for episode in env.split.episodes[:2]:
        observation, info = env.reset(seed=0, options={"episode": episode})
        truth = env.scene.task.truth
        target = truth.target(episode.goal, episode.start.floor_z_m)
        yield target.distance_m.tobytes(), target.reached.tobytes(), info["shortest_path"]
        for action in ACTIONS:
            observation, _, _, _, info = env.step(action)
            yield *(value.tobytes() for value in observation.values()), repr(info)
    env.close()


def test_a_house_that_changed_is_read_again(house: Path, cache: Path, tmp_path: Path) -> None:
    file = tmp_path / "own" / house.name
    file.parent.mkdir()
    shutil.copy(house, file)
    before = World(load_house(file))
    files = set(cache.iterdir())
    assert World(load_house(file)).key == before.key
    assert set(cache.iterdir()) == files
    file.write_text(file.read_text().replace("sofa_00", "bed_00"))
    assert {i.category for i in World(load_house(file)).labels.instances} >= {"bed"}


def test_a_house_that_changed_after_it_was_loaded_is_not_kept_as_the_loaded_one(
    house: Path, cache: Path, tmp_path: Path
) -> None:
    file = tmp_path / house.name
    shutil.copy(house, file)
    load_house(file)
    checked = load_house(file)  # its specification is not read
    file.write_text(file.read_text().replace("sofa_00", "bed_00"))
    with pytest.raises(HouseError, match="was changed after it was loaded"):
        World(checked)
    assert {i.category for i in World(load_house(file)).labels.instances} >= {"bed"}


def test_a_house_with_a_texture_that_changed_is_another_one(cache: Path, tmp_path: Path) -> None:
    split = load_split("val")
    file = tmp_path / "own" / "house.xml"
    file.parent.mkdir()
    shutil.copy(split.house_file(split.houses[0]), file)
    copy_textures(tmp_path / "textures")
    checksum = load_house(file).checksum
    texture = next(t for t in sorted((tmp_path / "textures").iterdir()) if t.name in file.read_text())
    texture.write_bytes(texture.read_bytes() + b" ")
    assert load_house(file).checksum not in (None, checksum)


def test_a_house_with_more_files_than_are_searched_is_not_kept(cache: Path, tmp_path: Path) -> None:
    for number in range(25):
        folder = tmp_path / f"object_{number}"
        folder.mkdir()
        (folder / "model.xml").write_text('<mujoco><include file="parts.xml"/></mujoco>')
        (folder / "parts.xml").write_text("<mujocoinclude/>")
    models = "".join(f'<model name="m{k}" file="object_{k}/model.xml"/>' for k in range(25))
    room = '<geom name="floor_00" type="box" size="2 2 0.05" pos="0 0 -0.05"/>'
    file = tmp_path / "house.xml"
    file.write_text(f"<mujoco><asset>{models}</asset><worldbody>{room}</worldbody></mujoco>")
    assert World(load_house(file)).key is None
    assert not cache.exists()


def test_the_model_of_a_prepared_house_is_that_of_its_specification(house: Path, cache: Path) -> None:
    World(load_house(house))
    kept, house_kept = World(load_house(house)), load_house(house)
    assert callable(house_kept.source)  # it was not read
    compiled = [np.empty(mujoco.mj_sizeModel(model), np.uint8) for model in (kept.model, _plain(house).model)]
    mujoco.mj_saveModel(kept.model, None, compiled[0])
    mujoco.mj_saveModel(_plain(house).model, None, compiled[1])
    assert np.array_equal(compiled[0], compiled[1])
    assert house_kept.spec.compile().ngeom > 0


def _plain(house: Path) -> World:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(SIZE_VARIABLE, "0")
        return World(load_house(house))
