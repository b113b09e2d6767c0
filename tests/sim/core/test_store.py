"""The cache of prepared results: what was kept is equal to the bit, damage counts as missing, its size is bounded."""

from __future__ import annotations

import multiprocessing
import os
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from sim.core.errors import ConfigError
from sim.core.geometry.convex import ConvexPolygon, PolygonTable
from sim.core.paths import CACHE_VARIABLE
from sim.core.store import SIZE_VARIABLE, kept, key_of


@dataclass(frozen=True)
class Result:
    name: str
    length_m: float
    cells: NDArray[np.float32]


def made(seed: int = 0, size: int = 1000) -> Result:
    return Result("x", -0.0, np.random.default_rng(seed).random((size, 2)).astype(np.float32))


def never() -> Result:
    raise AssertionError("it was kept")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv(CACHE_VARIABLE, str(tmp_path))
    monkeypatch.setenv(SIZE_VARIABLE, "10")
    return tmp_path / "prepared"


def test_a_kept_result_is_equal_to_the_bit_and_shares_no_memory(folder: Path) -> None:
    first, second, third = (kept(key_of("a"), Result, make) for make in (made, never, never))
    assert (second.name, str(second.length_m)) == ("x", "-0.0")
    assert second.cells.dtype == np.float32
    assert second.cells.tobytes() == first.cells.tobytes()
    second.cells[:] = 0.0
    assert third.cells.tobytes() == first.cells.tobytes()


def test_polygons_survive_their_table() -> None:
    rng = np.random.default_rng(0)
    polygons = [ConvexPolygon.around(rng.random((n, 2))) for n in (3, 9, 5)]
    for before, after in zip(polygons, PolygonTable.of([p for p in polygons if p]).polygons, strict=True):
        assert before is not None
        assert before.bounds_m == after.bounds_m
        for name in ("vertices_m", "normals", "offsets_m"):
            assert np.array_equal(getattr(before, name), getattr(after, name)), name
    assert PolygonTable.of([]).polygons == ()


@pytest.mark.parametrize(
    "damage",
    [lambda b: b[:-1], lambda b: b"", lambda b: b[:500] + bytes([b[500] ^ 1]) + b[501:], lambda b: b[:4]],
    ids=["cut", "empty", "bit", "head"],
)
def test_a_damaged_file_is_made_again(folder: Path, damage: Callable[[bytes], bytes]) -> None:
    kept(key_of("a"), Result, made)
    (file,) = folder.iterdir()
    whole = file.read_bytes()
    file.write_bytes(damage(whole))
    assert kept(key_of("a"), Result, made).length_m == 0.0
    assert file.read_bytes() == whole


def test_a_result_of_another_form_is_made_again(folder: Path) -> None:
    kept(key_of("a"), tuple[str, ...], lambda: ("x",))
    assert kept(key_of("a"), Result, made).name == "x"


def test_the_results_unused_for_longest_are_removed(folder: Path) -> None:
    for number in range(4):  # 4 MB each
        kept(key_of(number), Result, lambda: made(size=500_000))
        os.utime(folder / f"{key_of(number)}.bin", (number, number))
        if number == 1:
            kept(key_of(0), Result, never)  # used now
    assert {file.stem for file in folder.iterdir()} == {key_of(0), key_of(3)}


@pytest.mark.parametrize("folder_exists", [True, False])
def test_a_cache_that_cannot_be_written_changes_nothing(
    folder: Path, folder_exists: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    if folder_exists:
        folder.mkdir()
        monkeypatch.setattr("sim.core.store.write_atomically", _full)
    else:
        folder.parent.joinpath("prepared").write_text("a file")
    assert kept(key_of("a"), Result, made).name == "x"
    assert not folder_exists or not any(folder.iterdir())


def test_a_cache_that_is_only_read_is_used(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    kept(key_of("a"), Result, made)
    monkeypatch.setattr("os.utime", _full)
    assert kept(key_of("a"), Result, never).name == "x"


def test_without_a_home_folder_nothing_is_kept(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(CACHE_VARIABLE, "~no-such-user/cache")
    assert kept(key_of("a"), Result, made).name == "x"


def _full(*_: object) -> None:
    raise OSError(28, "No space left on device")


def test_nothing_is_kept_with_a_size_of_zero_or_without_a_key(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    kept(None, Result, made)
    monkeypatch.setenv(SIZE_VARIABLE, "0")
    kept(key_of("a"), Result, made)
    assert not folder.exists()
    monkeypatch.setenv(SIZE_VARIABLE, "much")
    with pytest.raises(ConfigError, match=f"{SIZE_VARIABLE} must be a whole number of megabytes"):
        kept(key_of("a"), Result, made)


@pytest.mark.costly
def test_two_writers_and_readers_never_see_half_a_file(folder: Path) -> None:
    with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")) as pool:
        counts = list(pool.map(_write_and_read, (0, 1)))
    assert min(counts) > 0  # both found a result of the other or of their own


def _write_and_read(seed: int) -> int:
    """Writes, reads and removes one result in turns with another process; returns how often it was found."""
    whole, found = made(size=50_000).cells.tobytes(), 0
    file = Path(os.environ[CACHE_VARIABLE]) / "prepared" / f"{key_of('a')}.bin"
    for turn in range(60):
        was_made: list[bool] = []
        result = kept(key_of("a"), Result, lambda w=was_made: w.append(True) or made(size=50_000))
        assert result.cells.tobytes() == whole
        found += not was_made
        if (turn + seed) % 2:
            file.unlink(missing_ok=True)
    return found
