"""Typed reading: a message names the file, the line, the field, the value found and the type expected."""

from __future__ import annotations

import gzip
import io
import os
import tracemalloc
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import msgspec
import numpy as np
import pytest

from sim.core import pictures, reading
from sim.core.errors import HouseError
from sim.core.interface import ConfigError
from tests.helpers import wording


class Row(msgspec.Struct):
    """A row of a file."""

    name: reading.Name
    at: list[reading.Metres]
    seed: int = 0


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", "is empty"),
        ("\0\0\0\0", "is empty"),
        ("{", "not JSON"),
        ('{"name": "a"}', wording.MISSING_REQUIRED_FIELD_AT),
        ('{"name": 5, "at": []}', "'name'"),
        ('{"name": "a", "at": [0.5, "b"]}', r"'at\[1\]'"),
        ('{"name": "a", "at": [NaN]}', "not JSON"),
        ('{"name": "a", "at": [Infinity]}', "not JSON"),
        ('{"name": "a", "at": [1e308]}', r"field 'at\[0\]': expected float <= 10000"),
        ('{"name": "a", "at": [1e999]}', wording.OUT_OF_RANGE),
        ('{"name": "\\u001b[31m", "at": []}', "field 'name'"),
        ('{"name": "\\ud800", "at": []}', "not JSON"),
        ('{"name": "a", "at": [], "more": ' + "[" * 100_000, wording.NESTED_TOO_DEEPLY_NOT_JSON),
        ("7", wording.EXPECTED_OBJECT_GOT_INT),
        ("1" * 10_000, "rows.json"),
    ],
)
def test_content_of_another_type_is_one_line_that_names_the_field(content: str, message: str, tmp_path: Path) -> None:
    file = tmp_path / "rows.json"
    file.write_text(content)
    with pytest.raises(HouseError, match=message) as caught:
        reading.read_json(file, Row, what="Rows", error=HouseError)
    assert str(file) in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b'{"name": "a", "at": []}\n\n{"name": "b", "at": []}\n', "line 2 is empty"),
        (b'{"name": "a", "at": []}\n\0\0\0\0\n', "line 2 is empty"),
        (b'{"name": "a", "at": []}\n{"name": "b"}\n', wording.LINE_2_OBJECT_MISSING_REQUIRED_FIELD_AT),
        (b'{"name": "a", "at": []}\n[]\n', wording.LINE_2_EXPECTED_OBJECT_GOT_ARRAY),
    ],
)
def test_a_broken_line_is_named_by_its_number(content: bytes, message: str, tmp_path: Path) -> None:
    (tmp_path / "rows.jsonl").write_bytes(content)
    with pytest.raises(ConfigError, match=message):
        reading.read_lines(tmp_path / "rows.jsonl", Row, what="Rows")


@pytest.mark.parametrize("torn", [b'{"name": "b"', b"\0\0\0\0", b"\xff"])
def test_an_incomplete_last_line_is_left_out_and_reported(torn: bytes, tmp_path: Path) -> None:
    file = tmp_path / "rows.jsonl"
    whole = b'{"name": "a", "at": [], "more": 1}\n'
    file.write_bytes(whole + torn)
    lines = reading.read_lines(file, Row, what="Rows")
    assert lines.values == [Row("a", [])]
    assert lines.whole_bytes == len(whole)
    assert "line 2" in lines.torn
    file.write_bytes(whole)
    assert reading.read_lines(file, Row, what="Rows").torn == ""


def test_a_file_that_expands_without_end_is_refused_soon(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reading, "MAX_BYTES", 1 << 20)
    (tmp_path / "bomb.gz").write_bytes(gzip.compress(b"[" + b" " * (4 << 20), compresslevel=1))
    with pytest.raises(ConfigError, match=r"bomb\.gz.* 1 MB"):
        reading.read_gzip_json(tmp_path / "bomb.gz", list[Any], what="Rows")
    with zipfile.ZipFile(tmp_path / "bomb.npz", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("a.npy", b"\0" * (8 << 20))
    with pytest.raises(ConfigError, match="expands to 8 MB; at most 1 MB"):
        reading.require_small_zip(tmp_path / "bomb.npz", what="Rows", most=1 << 20)


def damaged_zip(change: Callable[[bytearray], None]) -> bytes:
    """Returns an `.npz` file of one compressed array `a`, damaged."""
    content = io.BytesIO()
    np.savez_compressed(content, a=np.arange(1000))
    damaged = bytearray(content.getvalue())
    change(damaged)
    return bytes(damaged)


def put(place: bytes, offset: int, value: int) -> Callable[[bytearray], None]:
    """Returns a function that sets a byte behind the last occurrence of `place`."""

    def change(content: bytearray) -> None:
        content[content.rindex(place) + offset] = value

    return change


def member(header: str) -> bytes:
    """Returns an `.npz` file whose array `a` has this text as its header."""
    content = io.BytesIO()
    text = header.encode()
    with zipfile.ZipFile(content, "w") as archive:
        archive.writestr("a.npy", b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text)
    return content.getvalue()


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"no archive",
        damaged_zip(put(b"PK\x01\x02", 16, 0xAA)),  # the checksum
        damaged_zip(put(b"PK\x01\x02", 10, 99)),  # a compression method that does not exist
        damaged_zip(put(b"PK\x01\x02", 10, 14)),  # LZMA
        damaged_zip(put(b"PK\x01\x02", 8, 1)),  # encrypted
        damaged_zip(lambda content: content.__setitem__(slice(40, 60), b"\xff" * 20)),
        damaged_zip(lambda content: content.__delitem__(slice(50, 70))),
        member("{'descr': '<i8', 'fortran_order': False, 'shape': (3,)}\n"),
        member("{'descr': '<i8', 'fortran_order': False, 'shape': (1 << 60,)}\n"),
        member("{'descr': '<i8', 'fortran_order': False, 'shape': (1000000000000000,)}\n"),
        member("{'descr': 'q9', 'fortran_order': False, 'shape': (3,)}\n"),
        member("{'descr': '|O', 'fortran_order': False, 'shape': (1,)}\n"),
        member("((((((("),
        member("{'descr': " + "[" * 5000),
    ],
)
def test_a_damaged_npz_is_named_in_a_message(content: bytes, tmp_path: Path) -> None:
    file = tmp_path / "rows.npz"
    file.write_bytes(content)
    for names in (None, ("a",)):
        with pytest.raises(ConfigError, match=r"rows\.npz.*\S"):
            reading.read_npz(file, names, what="table", most_bytes=1 << 20)


def test_the_arrays_of_an_npz_are_read_by_name(tmp_path: Path) -> None:
    file = tmp_path / "rows.npz"
    with pytest.raises(HouseError, match=r"rows\.npz"):
        reading.read_npz(file, what="table", most_bytes=1 << 20, error=HouseError)
    np.savez(file, a=np.arange(3), b=np.array("text"), c=np.asfortranarray(np.eye(3)))
    whole = reading.read_npz(file, what="table", most_bytes=1 << 20)
    assert list(whole) == ["a", "b", "c"]
    assert str(whole["b"]) == "text"
    np.testing.assert_array_equal(whole["c"], np.eye(3))
    assert list(reading.read_npz(file, ("b", "a"), what="table", most_bytes=1 << 20)) == ["b", "a"]
    with pytest.raises(ConfigError, match="'d'"):
        reading.read_npz(file, ("a", "d"), what="table", most_bytes=1 << 20)
    np.savez_compressed(file, a=np.zeros(1 << 20))
    with pytest.raises(ConfigError, match=r"8.*MB.*1.*MB"):
        reading.read_npz(file, what="table", most_bytes=1 << 20)


@pytest.mark.parametrize("kind", ["bytes", "JSON", "gzipped JSON", "zip", "npz"])
def test_a_pipe_in_place_of_a_file_is_refused_and_not_waited_for(kind: str, tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    readers = {
        "bytes": lambda: reading.read_bytes(pipe, what="Table"),
        "JSON": lambda: reading.read_json(pipe, dict, what="Table"),
        "gzipped JSON": lambda: reading.read_gzip_json(pipe, dict, what="Table"),
        "zip": lambda: reading.require_small_zip(pipe, what="Table", most=1),
        "npz": lambda: reading.read_npz(pipe, what="table", most_bytes=1),
    }
    with pytest.raises(ConfigError, match=wording.NOT_A_PLAIN_FILE):
        readers[kind]()
    with pytest.raises(ConfigError, match=wording.A_PLAIN_FILE_DIRECTORY):
        reading.read_bytes(tmp_path, what="Table")


@pytest.mark.parametrize("suffix", [".png", ".jpg"])
def test_the_size_of_an_image_is_read_from_its_header(suffix: str) -> None:
    content = cv2.imencode(suffix, np.zeros((30, 50, 3), np.uint8))[1].tobytes()
    assert pictures.image_size_px(content) == (50, 30)
    pictures.require_small_image(content, where="Image")
    with pytest.raises(ConfigError, match="unsupported format"):
        pictures.require_small_image(content[:10], where="Image")
    bomb = content[:16] + (60_000).to_bytes(4, "big") * 2 + content[24:]
    if suffix == ".png":
        with pytest.raises(ConfigError, match="60000 x 60000"):
            pictures.require_small_image(bomb, where="Image")


def test_control_characters_and_lone_surrogates_are_written_as_escapes() -> None:
    assert reading.printable("a\x1b[31mb\u009bc\udcff [d] é") == "a\\x1b[31mb\\x9bc\\udcff [d] é"
    assert reading.first_unprintable(["a b", "ü"]) is None
    assert reading.first_unprintable(["a", "b\x1b[0m"]) == "b\x1b[0m"


def test_a_file_of_empty_lines_ends_soon(tmp_path: Path) -> None:
    file = tmp_path / "lines.gz"
    file.write_bytes(gzip.compress(b"{}\n" + b"\n" * 300_000))
    with pytest.raises(ConfigError, match="line 10002: more than 10,000 lines are empty"):
        list(reading.json_lines(file, what="Scenes"))


def test_the_memory_for_a_file_depends_on_its_size_and_not_on_the_limit(tmp_path: Path) -> None:
    file = tmp_path / "small.json"
    file.write_bytes(b"[]")
    tracemalloc.start()
    try:
        assert reading.read_bytes(file, what="File", most=1 << 30) == b"[]"
        assert tracemalloc.get_traced_memory()[1] < 4 << 20
    finally:
        tracemalloc.stop()
    with pytest.raises(ConfigError, match="too large"):
        reading.read_bytes(file, what="File", most=1)


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_a_cell_of_a_table_may_hold_any_character(end: str, tmp_path: Path) -> None:
    file = tmp_path / "table.csv"
    rows = ["name,size", '"a,b",1', "c\u2028d\x0ce,2", "short"]
    file.write_bytes(end.join(rows).encode())
    expected = [("a,b", "1"), ("c\u2028d\x0ce", "2"), ("short", "")]
    assert [(row["name"], row["size"]) for row in reading.read_csv(file, what="Table")] == expected
    file.write_bytes(f'name,size{end}"a{end}b",1{end}'.encode())
    assert reading.read_csv(file, what="Table")[0]["name"].splitlines() == ["a", "b"]
