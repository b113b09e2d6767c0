"""Every tool starts in both ways, and what makes the shipped houses makes them again to the byte."""

from __future__ import annotations

import hashlib
import subprocess
import sys
from pathlib import Path

import pytest

from sim.episodes import load_split, shipped_splits
from sim.house_list import house_bytes
from sim.houses.splits import SPLIT_VERSION, SPLITS
from tests.helpers.sampling import sample
from tools.generate_houses import Args, main

ROOT = Path(__file__).resolve().parents[2]
TOOLS = sorted(file.stem for file in (ROOT / "tools").glob("*.py") if '__name__ == "__main__"' in file.read_text())
WAYS = [(tool, way) for tool in TOOLS for way in ("file", "module")]
SHIPPED = [(split, recipe.name) for split, recipes in SPLITS.items() for recipe in recipes]


@pytest.mark.parametrize(("tool", "way"), sample(WAYS, 2))
def test_a_tool_starts_as_a_file_and_as_a_module(tool: str, way: str) -> None:
    command = [f"tools/{tool}.py"] if way == "file" else ["-m", f"tools.{tool}"]
    ended = subprocess.run(
        [sys.executable, *command, "--help"], cwd=ROOT, capture_output=True, text=True, check=False, timeout=120
    )
    assert ended.returncode == 0, ended.stderr
    assert "usage" in ended.stdout


@pytest.mark.parametrize(("split", "name"), sample(SHIPPED, 2))
def test_a_house_made_again_is_the_shipped_file_to_the_byte(split: str, name: str) -> None:
    recipe = next(recipe for recipe in SPLITS[split] if recipe.name == name)
    made, shipped = house_bytes(recipe), load_split(split).house_paths[name].read_bytes()
    assert hashlib.sha256(made).hexdigest() == hashlib.sha256(shipped).hexdigest()


def test_the_tool_writes_what_is_shipped(tmp_path: Path) -> None:
    assert main(Args(split="val", houses=1, out=tmp_path / "val")) == 0
    written = (tmp_path / "val" / "val_00.xml").read_bytes()
    assert written == load_split("val").house_paths["val_00"].read_bytes()
    assert (tmp_path / "textures").is_dir()


@pytest.mark.parametrize("number", sample(range(200), 1))
def test_a_listed_train_house_comes_out_as_listed(number: int) -> None:
    houses = load_split("train").house_list
    assert houses is not None
    name = list(houses.recipes)[number]
    assert hashlib.sha256(house_bytes(houses.recipes[name])).hexdigest() == houses.sha256[name]


@pytest.mark.parametrize("split", ["val", "test", "train"])
def test_a_shipped_split_carries_the_one_version(split: str) -> None:
    assert split in shipped_splits()
    assert load_split(split).version == SPLIT_VERSION


def test_the_tool_lists_train_houses_that_pass_and_leaves_their_files_in_the_cache(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("STUBBORN_CACHE_DIR", str(tmp_path / "cache"))
    assert main(Args(split="train", houses=1, out=tmp_path / "train")) == 0
    assert [file.name for file in (tmp_path / "train").iterdir()] == ["houses.json"]
    assert [file.name for file in tmp_path.rglob("*.xml")] == ["train_000.xml"]
