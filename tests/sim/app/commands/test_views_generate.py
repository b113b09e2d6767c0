"""Generation of views: any process gives the same bytes, a stopped run continues, broken shards are replaced."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from sim.app.commands import episodes as make_episodes
from sim.app.commands.views import generate as generate_views
from sim.app.commands.views.generate import FRESH_SEEDS_FROM, Args, ShardTask, main, make_shard, plan
from sim.core.errors import HouseError
from sim.core.interface import ConfigError
from sim.episodes.splits import load_split
from sim.training.segmentation.dataset import list_shards, read_shard
from tests.helpers import wording
from tests.helpers.worlds import room, with_box


@pytest.fixture(scope="module")
def split(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("splits") / "tiny"
    folder.mkdir()
    for name, width in (("first", 5.0), ("second", 6.0)):
        house = with_box(room(width, 4), "bed_00", centre_m=(1.5, 0, 0.3), half_m=(0.5, 0.9, 0.3))
        (folder / f"{name}.xml").write_text(house.spec.to_xml())
    make_episodes.main(make_episodes.Args(split=folder, episodes=2))
    return folder


def options(folder: Path, out: Path, **changes: object) -> Args:
    few = Args(split=str(folder), out=out, views=9, views_per_shard=3, shrink=4, profile="fast")
    return replace(few, **changes)  # pyright: ignore[reportArgumentType]


def sums(out: Path) -> dict[str, str]:
    return {entry["shard"]: entry["sha256"] for entry in json.loads((out / "index.json").read_text())["shards"]}


@pytest.mark.costly
def test_workers_and_machines_write_the_same_shards_as_one_process(split: Path, tmp_path: Path) -> None:
    assert main(options(split, tmp_path / "one")) == 0
    command = [
        sys.executable,
        "-m",
        "sim.app.commands.main",
        "views",
        "--split",
        str(split),
        "--out",
        str(tmp_path / "two"),
    ]
    command += ["--views", "9", "--views-per-shard", "3", "--shrink", "4", "--profile", "fast", "--workers", "2"]
    subprocess.run(command, check=True, capture_output=True)
    main(options(split, tmp_path / "three", shard="2/2"))
    assert list(sums(tmp_path / "three")) == ["views-000001.tar"]
    main(options(split, tmp_path / "three", shard="1/2"))
    assert len(sums(tmp_path / "one")) == 3
    assert sums(tmp_path / "one") == sums(tmp_path / "two") == sums(tmp_path / "three")


def test_complete_shards_are_kept_and_broken_ones_generated_again(split: Path, tmp_path: Path) -> None:
    main(options(split, tmp_path))
    before = sums(tmp_path)
    first, second, third = list_shards(tmp_path)
    kept = first.stat().st_mtime_ns
    second.write_bytes(second.read_bytes()[:1000])
    third.unlink()
    main(options(split, tmp_path))
    assert first.stat().st_mtime_ns == kept
    assert sums(tmp_path) == before
    assert [len(list(read_shard(shard))) for shard in list_shards(tmp_path)] == [3, 3, 3]


def test_a_flipped_byte_is_found_when_checksums_are_compared(split: Path, tmp_path: Path) -> None:
    main(options(split, tmp_path, views=3))
    (shard,) = list_shards(tmp_path)
    whole = shard.read_bytes()
    shard.write_bytes(whole[:600] + bytes([whole[600] ^ 1]) + whole[601:])
    main(options(split, tmp_path, views=3, check=True))
    assert shard.read_bytes() == whole


def test_shards_of_other_options_are_never_mixed(split: Path, tmp_path: Path) -> None:
    main(options(split, tmp_path, views=3))
    with pytest.raises(ConfigError, match=wording.HOLDS_SHARDS_WITH_SEED_0_THIS_RUN_HAS_1):
        main(options(split, tmp_path, views=3, seed=1))


def test_train_continues_with_new_houses_and_no_other_split_does() -> None:
    splits = {name: load_split(name) for name in ("train", "val")}
    train, val = (
        plan(Args(split=name, out=Path("x"), views=230, views_per_shard=1), split) for name, split in splits.items()
    )
    assert {task.house for task in train[:200]} == set(splits["train"].houses)
    fresh = [task.fresh_seed for task in train[200:]]
    assert len(set(fresh)) == 30
    assert min(seed for seed in fresh if seed is not None) >= FRESH_SEEDS_FROM
    assert {task.house for task in val[:30]} == {task.house for task in val[30:60]} == set(splits["val"].houses)
    assert all(task.fresh_seed is None for task in val)


@pytest.mark.parametrize(("views", "houses", "shards"), [(60, 20, 20), (7, 7, 7), (5000, 20, 20), (6000, 24, 24)])
def test_few_views_are_of_many_houses_and_many_views_in_shards_of_250(views: int, houses: int, shards: int) -> None:
    tasks = plan(Args(split="val", out=Path("x"), views=views), load_split("val"))
    assert (len({task.house for task in tasks}), len(tasks)) == (houses, shards)
    assert sum(task.views for task in tasks) == views
    assert max(task.views for task in tasks) == min(250, -(-views // 20))


def test_objects_and_sequences_are_options_that_a_folder_keeps(split: Path, tmp_path: Path) -> None:
    few = {"views": 4, "views_per_shard": 4, "extras": ("instances", "poses")}
    main(options(split, tmp_path, sequence=2, **few))
    index = json.loads((tmp_path / "index.json").read_text())
    assert index["command"].endswith("--sequence 2 --extras instances poses --out DIR")
    (view, *_) = read_shard(tmp_path / "views-000000.tar")
    assert view.annotations is not None
    assert view.record["frame"] == 0
    with pytest.raises(ConfigError, match=wording.HOLDS_SHARDS_WITH_SEQUENCE_2_THIS_RUN_HAS_NONE):
        main(options(split, tmp_path, **few))


@pytest.mark.slow
def test_reshaped_houses_are_new_ones(tmp_path: Path) -> None:
    options = Args(pool="train", reshape=True, views=2, views_per_shard=2, shrink=8, profile="fast", out=tmp_path)
    main(options)
    index = json.loads((tmp_path / "index.json").read_text())
    assert [entry["house"] for entry in index["shards"]] == [f"reshaped_{FRESH_SEEDS_FROM}"]
    assert "--pool train --reshape" in index["command"]
    with pytest.raises(ConfigError, match=wording.HOLDS_SHARDS_WITH_RESHAPE_TRUE):
        main(replace(options, reshape=False))


def test_a_new_house_without_views_is_replaced_by_that_of_another_fixed_seed(monkeypatch: pytest.MonkeyPatch) -> None:
    tried: list[int | None] = []

    def shard_of(args: Args, config: object, task: ShardTask, seed: int | None) -> int:
        tried.append(seed)
        if len(tried) == 1:
            raise HouseError("it shows too little")
        return task.number

    monkeypatch.setattr(generate_views, "_shard_of", shard_of)
    args = Args(pool="train", out=Path("x"))
    assert make_shard(args, {}, ShardTask(3, 40, "reshaped", FRESH_SEEDS_FROM)) == 3
    assert tried == [FRESH_SEEDS_FROM, FRESH_SEEDS_FROM + FRESH_SEEDS_FROM // 2]
    tried.clear()
    with pytest.raises(HouseError, match=wording.SHOWS_TOO_LITTLE):
        make_shard(args, {}, ShardTask(0, 40, "val_00", None))
    assert tried == [None]


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"extras": ("poses", "poses")}, r"--extras.*'poses poses'"),
        ({"sequence": 2}, r"--sequence.*--views.*--views-per-shard.*2"),
        ({"reshape": True}, "--reshape needs --pool or --furniture"),
        ({"pool": "train", "split": "val"}, r"--pool.*--split train.*'val'"),
    ],
)
def test_a_wrong_option_is_refused(split: Path, tmp_path: Path, changes: dict, sentence: str) -> None:
    with pytest.raises(ConfigError, match=sentence):
        main(options(split, tmp_path, **changes))


@pytest.mark.parametrize("extras", [(), ("poses",), ("instances",)])
def test_what_training_needs_is_said_before_the_first_view_is_made(
    extras: tuple[str, ...], split: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    main(options(split, tmp_path, views=2, views_per_shard=2, extras=extras))
    said, shards = capsys.readouterr().out.split("1 shard, 0 complete")
    assert ("which `train segmentation` needs" in said) == ("instances" not in extras)
    assert "views-000000: 2 views" in shards
