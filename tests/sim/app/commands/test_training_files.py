"""The curves of a training: their state after a killed process, and the options that a continued run must keep."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import pytest

from sim.core.interface import ConfigError
from sim.training.timed_training import stride
from sim.training.training_files import append_row, cut_rows, options_of, read_columns, require_options


@pytest.mark.parametrize(
    ("stored", "kept"),
    [
        ("", ""),
        ("step,lo", ""),
        ("step,loss\r\n", "step,loss\n"),
        ("step,loss\r\n1,0.5\r\n2,0.25\r\n", "step,loss\n1,0.5\n2,0.25\n"),
        ("step,loss\r\n1,0.5\r\n2", "step,loss\n1,0.5\n"),
        ("step,loss\r\n1,0.5\r\n2,0.2", "step,loss\n1,0.5\n"),
        ("step,loss\r\n1,0.5\r\n2\r\n", "step,loss\n1,0.5\n"),
        ("step,loss\r\n1,0.5\r\n2,3e-\r\n-,0.2\r\n", "step,loss\n1,0.5\n"),
        ("step,loss\r\n1,0.5\r\n2,0.23,0.2\r\n3,\r\n4,nan\r\n", "step,loss\n1,0.5\n3,\n"),
    ],
)
def test_a_curve_keeps_its_whole_rows_up_to_the_state(tmp_path: Path, stored: str, kept: str) -> None:
    file = tmp_path / "train.csv"
    file.write_bytes(stored.encode())
    cut_rows(file, "step", 3)
    assert file.read_bytes() == kept.encode()
    append_row(file, {"step": 9, "loss": 0.125})
    assert read_columns(file)["step"][-1] == 9


def test_a_missing_curve_stays_missing_and_a_foreign_table_is_refused(tmp_path: Path) -> None:
    cut_rows(tmp_path / "train.csv", "step", 0)
    assert list(tmp_path.iterdir()) == []
    file = tmp_path / "val.csv"
    file.write_text("name,price\nbed,100\n")
    with pytest.raises(ConfigError, match=r"val\.csv.*'step'"):
        cut_rows(file, "step", 0)
    assert file.read_text() == "name,price\nbed,100\n"


@dataclass(frozen=True)
class Options:
    views: tuple[Path, ...]
    rate: float = 0.1
    minutes: float = 1.0


def test_a_run_is_the_same_in_another_folder_with_the_same_files(tmp_path: Path) -> None:
    def kept(folder: Path, content: str, **others: float) -> dict[str, str]:
        (folder / "views").mkdir(parents=True, exist_ok=True)
        (folder / "views" / "a.tar").write_text(content)
        args = Options((folder / "views",), **others)
        return options_of(args, may_change=("minutes",), files={"views": [folder / "views" / "a.tar"]})

    before = kept(tmp_path / "one", "abc")
    require_options(tmp_path, before, kept(tmp_path / "two", "abc", minutes=2.0))
    with pytest.raises(ConfigError, match=r"--views.*1.*\(hash.*\w+\).*1"):
        require_options(tmp_path, before, kept(tmp_path / "two", "abcd"))
    with pytest.raises(ConfigError, match=r"--rate.*0\.1.*0\.2"):
        require_options(tmp_path, before, kept(tmp_path / "one", "abc", rate=0.2))
    with pytest.raises(ConfigError, match=r"--batch-size.*\(absent\).*4"):
        require_options(tmp_path, before, before | {"batch_size": "4"})


@pytest.mark.parametrize(("count", "most", "taken"), [(8, 4, 4), (7, 4, 4), (7, 3, 3), (9, 5, 5), (5, 9, 5), (5, 0, 5)])
def test_a_stride_takes_at_most_so_many(count: int, most: int, taken: int) -> None:
    assert len(range(count)[:: stride(count, most)]) == taken
