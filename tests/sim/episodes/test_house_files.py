"""A pointer of Git LFS in place of a file is named by every reader, since all open files by one function."""

from __future__ import annotations

from pathlib import Path

import pytest

from sim.core.errors import ConfigError, HouseError
from sim.core.reading import open_plain, read_bytes, read_json, sha256_of
from sim.episodes.splits import one_house
from sim.houses.load import load_house

POINTER = "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n"


def test_a_pointer_of_git_lfs_is_named(tmp_path: Path) -> None:
    file = tmp_path / "weights.safetensors"
    file.write_text(POINTER)
    for read in (read_bytes, sha256_of, open_plain):
        with pytest.raises(ConfigError, match="is a Git LFS pointer and not the file itself; run `git lfs pull`"):
            read(file, what="File")
    with pytest.raises(ConfigError, match="Git LFS pointer"):
        read_json(file, dict[str, str], what="File")
    with pytest.raises(HouseError, match="Git LFS pointer"):
        load_house(file)


def test_other_files_are_read_from_their_beginning(tmp_path: Path) -> None:
    for content in (b"", b"v", b"version 2", POINTER.encode()[:30]):
        (tmp_path / "x").write_bytes(content)
        assert read_bytes(tmp_path / "x", what="File") == content


def test_label_rules_beside_a_house_are_used(house: Path, tmp_path: Path) -> None:
    file = tmp_path / house.name
    file.write_text(house.read_text().replace("sofa_00", "couch"))
    with pytest.raises(HouseError, match="has no label"):
        one_house(file).load_house(file.stem)
    (tmp_path / "labels.json").write_text('{"^couch$": "sofa"}')
    split = one_house(file)
    assert "sofa" in {i.category for i in _instances(split.load_house(file.stem))}
    other = tmp_path / "other.json"
    other.write_text('{"^couch$": "bed"}')
    assert "bed" in {i.category for i in _instances(one_house(file, labels=other).load_house(file.stem))}


def _instances(house):  # type: ignore[no-untyped-def]
    from sim.world.world import World

    return World(house).labels.instances
