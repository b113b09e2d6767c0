"""Tests of house lists: houses are generated on first use, compared with their checksums, and cached."""

from __future__ import annotations

import hashlib
import json
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import pytest

from sim.core.errors import HouseError
from sim.core.geometry.pose import Pose
from sim.core.interface import ConfigError
from sim.core.paths import CACHE_VARIABLE, cache_dir
from sim.episodes.episode import Episode
from sim.episodes.house_list import house_maker, write_house_list
from sim.episodes.splits import Split, load_split, write_split
from sim.homes.housegen.splits.recipes import MAX_TRAIN_SEEDS, SPLITS, Recipe, train_recipe
from tests.helpers import wording
from tests.helpers.worlds import room, with_box

STUDIO = Recipe("tiny_00", 5, "train", "studio", 50.0)
EPISODES = (Episode("tiny_0000", "tiny_00", "bed", Pose(-1.25, 0.5, 2.0), 2.5),)


class Maker:
    """A replacement of the generator that returns a small house and counts its calls."""

    def __init__(self) -> None:
        self.text = with_box(room(8, 4), "bed_00", centre_m=(2.5, 0, 0.25), half_m=(0.5, 1, 0.25)).spec.to_xml()
        self.made = 0

    def __call__(self) -> bytes:
        self.made += 1
        return self.text.encode()


@pytest.fixture
def maker(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Maker:
    maker = Maker()
    monkeypatch.setattr(Recipe, "house_bytes", maker)
    monkeypatch.setenv(CACHE_VARIABLE, str(tmp_path / "cache"))
    return maker


def listed_split(folder: Path, content: bytes, *, version: str = "1.2.0") -> Split:
    """Returns a split of one listed house with the checksum of `content`."""
    folder.mkdir(exist_ok=True)
    write_house_list(folder, [(STUDIO, hashlib.sha256(content).hexdigest())], version=version)
    write_split(folder, EPISODES, {"tiny_00": {"bed": []}}, version=version)
    return load_split(folder)


@pytest.fixture
def split(tmp_path: Path, maker: Maker) -> Split:
    return listed_split(tmp_path / "tiny", maker.text.encode())


def test_a_listed_house_is_generated_on_first_use_and_then_read(split: Split, maker: Maker, tmp_path: Path) -> None:
    assert split.houses == ("tiny_00",)
    assert maker.made == 0
    assert split.load_house("tiny_00").name == "tiny_00"
    assert split.house_file("tiny_00") == tmp_path / "cache" / "1.2.0" / "tiny" / "tiny_00.xml"
    assert split.house_file("tiny_00").read_bytes() == maker.text.encode()
    assert maker.made == 1


def test_a_broken_file_in_the_cache_is_generated_again(split: Split, maker: Maker) -> None:
    path = split.house_file("tiny_00")
    path.write_bytes(path.read_bytes()[:100])
    assert split.load_house("tiny_00").name == "tiny_00"
    assert maker.made == 2


def test_concurrent_readers_get_complete_files(split: Split, maker: Maker) -> None:
    with ThreadPoolExecutor(8) as pool:
        contents = list(pool.map(lambda _: split.house_file("tiny_00").read_bytes(), range(24)))
    assert set(contents) == {maker.text.encode()}
    assert [file.name for file in split.house_file("tiny_00").parent.iterdir()] == ["tiny_00.xml"]


def test_a_house_that_differs_from_the_list_is_an_error_with_both_checksums(maker: Maker, tmp_path: Path) -> None:
    split = listed_split(tmp_path / "tiny", b"another house")
    assert split.house_list is not None
    with pytest.raises(HouseError) as refused:
        split.load_house("tiny_00")
    for part in ("'tiny_00'", hashlib.sha256(b"another house").hexdigest(), "the versions agree"):
        assert part in str(refused.value)
    assert hashlib.sha256(maker.text.encode()).hexdigest() in str(refused.value)
    assert not split.house_paths["tiny_00"].exists()
    old = replace(split.house_list, made_with=house_maker().versions() | {"mujoco": "3.9.9"})
    with pytest.raises(HouseError, match=r"3\.9\.9"):
        old.fetch("tiny_00")


def test_the_error_of_a_read_only_cache_names_the_variable(
    split: Split, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").write_text("no folder")
    monkeypatch.setenv(CACHE_VARIABLE, str(tmp_path / "file"))
    blocked = load_split(tmp_path / "tiny")
    with pytest.raises(HouseError, match=rf"'tiny_00' cannot be kept in .*file.*Set {CACHE_VARIABLE} to"):
        blocked.load_house("tiny_00")


def test_the_hash_covers_checksums_and_episodes_but_not_the_cache(split: Split, tmp_path: Path) -> None:
    before = split.sha256
    split.house_file("tiny_00")
    assert load_split(tmp_path / "tiny").sha256 == before
    changed = listed_split(tmp_path / "tiny", b"another house").sha256
    write_split(tmp_path / "tiny", [replace(EPISODES[0], goal="sofa")], {"tiny_00": {}}, version="1.2.0")
    assert len({before, changed, load_split(tmp_path / "tiny").sha256}) == 3


def test_houses_and_episodes_of_different_versions_are_an_error(split: Split, tmp_path: Path) -> None:
    write_split(tmp_path / "tiny", EPISODES, {"tiny_00": {}}, version="1.3.0")
    with pytest.raises(ConfigError, match=r"1\.3\.0.*1\.2\.0"):
        load_split(tmp_path / "tiny")


@pytest.mark.parametrize("content", ["{", "[]", '{"version": "1", "made_with": {}, "houses": [{"name": "x"}]}'])
def test_the_error_of_a_broken_list_names_the_file(split: Split, tmp_path: Path, content: str) -> None:
    (tmp_path / "tiny" / "houses.json").write_text(content)
    with pytest.raises(ConfigError, match=r"houses\.json"):
        load_split(tmp_path / "tiny")


@pytest.mark.parametrize("version", ["../../outside", "/tmp/outside", "..", "."])
def test_a_version_that_leads_out_of_the_cache_is_refused_and_nothing_is_written(
    version: str, maker: Maker, tmp_path: Path
) -> None:
    with pytest.raises(ConfigError, match=wording.LEADS_OUT_OF_ITS_FOLDER):
        listed_split(tmp_path / "tiny", maker.text.encode(), version=version)
    assert not (tmp_path / "outside").exists()
    assert not (tmp_path / "cache").exists()


def test_a_house_name_that_leads_out_of_the_cache_is_refused(split: Split, tmp_path: Path) -> None:
    file = tmp_path / "tiny" / "houses.json"
    file.write_text(file.read_text().replace('"tiny_00"', '"../../../outside"'))
    with pytest.raises(ConfigError, match=r"houses\.json.*leads"):
        load_split(tmp_path / "tiny")


def test_a_recipe_to_json_and_back_is_identity() -> None:
    for recipe in (STUDIO, train_recipe(7), *SPLITS["val"]):
        assert house_maker().recipe(json.loads(json.dumps(recipe.to_json())), "here") == recipe


def test_the_cache_folder_follows_the_variable_then_xdg(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(CACHE_VARIABLE, "/mine")
    monkeypatch.setenv("XDG_CACHE_HOME", "/xdg")
    assert cache_dir() == Path("/mine")
    monkeypatch.delenv(CACHE_VARIABLE)
    assert cache_dir() == Path("/xdg/stubborn-objectnav")
    monkeypatch.setenv("XDG_CACHE_HOME", "not/absolute")
    assert cache_dir() == Path.home() / ".cache" / "stubborn-objectnav"


@pytest.mark.costly
def test_a_generated_house_loads_its_textures_from_the_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(CACHE_VARIABLE, str(tmp_path / "cache"))
    split = listed_split(tmp_path / "tiny", STUDIO.house_bytes())
    model = split.load_house("tiny_00").spec.copy().compile()
    assert model.ntex > 0
    assert STUDIO.house_bytes() == split.house_file("tiny_00").read_bytes()


def test_a_quarter_of_the_train_houses_is_large_and_a_third_has_movables() -> None:
    recipes = [train_recipe(seed) for seed in range(200)]
    assert sum(recipe.area_m2 > 250.0 for recipe in recipes) == 50
    assert 60 <= sum(recipe.movable for recipe in recipes) <= 70
    assert {recipe.pool for recipe in recipes} == {"train"}
    assert len({recipe.name for recipe in map(train_recipe, range(MAX_TRAIN_SEEDS))}) == MAX_TRAIN_SEEDS
    assert min(recipe.seed for split in SPLITS.values() for recipe in split) >= MAX_TRAIN_SEEDS
