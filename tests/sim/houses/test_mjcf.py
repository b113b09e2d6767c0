"""Files that ask for too much, or hold numbers without meaning, are refused at once and by name."""

from __future__ import annotations

import struct
import time
import zlib
from pathlib import Path

import pytest

from sim.core.errors import HouseError
from sim.core.paths import CACHE_VARIABLE
from sim.core.store import SIZE_VARIABLE
from sim.houses.load import load_house
from sim.houses.mjcf import read_spec
from sim.task.ground_truth import GroundTruth
from sim.world.world import World
from tests.helpers import wording
from tests.helpers.worlds import room, with_box

FLOOR = '<geom name="floor_00" type="plane" size="3 3 1"/>'
BOX = '<geom name="{name}" type="box" size="{size}" pos="{pos}"/>'


def house(world: str = "", assets: str = "", more: str = "") -> str:
    return f"<mujoco>{more}<asset>{assets}</asset><worldbody>{FLOOR}{world}</worldbody></mujoco>"


def box(name: str = "wall_00", size: str = "1 1 1", pos: str = "0 0 1") -> str:
    return BOX.format(name=name, size=size, pos=pos)


def replicate(count: int, inner: str) -> str:
    return f'<replicate count="{count}" offset="0 0 0.001">{inner}</replicate>'


def png(width: int, height: int) -> bytes:
    """Returns a PNG file of 1 bit per pixel, all 0: 50 KB for 20,000 x 20,000 pixels."""

    def chunk(kind: bytes, content: bytes) -> bytes:
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    header = struct.pack(">IIBBBBB", width, height, 1, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(b"")) + chunk(b"IEND", b"")


TOO_MUCH = {
    "replicate": (house(replicate(10**9, box("chair_00"))), "replicate|chair_00.*more than 100000 elements"),
    "replicate in replicate": (house(replicate(999, replicate(999, replicate(999, box())))), "more than 100000"),
    "composite": (house('<body><composite type="cable" count="99999 99999 1" size="1"/></body>'), "more than 100000"),
    "a mesh of any resolution": (
        house(assets='<mesh name="m" builtin="supersphere" params="100000 100000 1 1"/>'),
        "more than 100000",
    ),
    "a texture that is drawn": (
        house(assets='<texture name="t" type="2d" builtin="flat" width="60000" height="60000"/>'),
        "textures have .* MB; at most 512 MB",
    ),
    "a texture in a file": (house(assets='<texture name="t" type="2d" file="bomb.png"/>'), "textures have .* MB"),
    "a height field": (
        house(assets='<hfield name="h" nrow="99999" ncol="99999" size="1 1 1 1"/>'),
        "hfield 'h' asks for 9",
    ),
    "a height field in a file": (
        house(assets='<hfield name="h" size="1 1 1 1" file="bomb.png"/>'),
        "meshes have .* MB",
    ),
    "a custom array": (house(more='<custom><numeric name="n" size="2000000000"/></custom>'), "numeric 'n' asks for"),
    "user data": (house(more='<size nuserdata="2000000000"/>'), "size asks for 2e.09"),
    "a document type": ("<!DOCTYPE a [<!ENTITY b 'c'>]>" + house(), "a document type is not allowed"),
    "itself": (house(more='<include file="house.xml"/>'), "'house.xml' is included more than once"),
}
NO_NUMBERS = {
    "a nan with a payload": (house(box(pos="0 nan(1) 0")), r"geom 'wall_00': pos = '0 nan\(1\) 0' is not finite"),
    "a nan with letters": (house(box(size="-NaN(x) 1 1")), r"size = '-NaN\(x\) 1 1' is not finite"),
    "nan": (house(box(pos="nan 0 0")), r"geom 'wall_00': pos = 'nan 0 0' is not finite"),
    "an infinite size": (house(box(size="inf 1 1")), r"geom 'wall_00': size = 'inf 1 1' is not finite"),
    "a huge position": (house(box(pos="0 0 1e308")), r"geom 'wall_00': pos = '0 0 1e308' is too large"),
    "a huge hexadecimal number": (house(box(pos="0 0 0x1p500")), "pos = '0 0 0x1p500' is too large"),
    "a far position": (house(box(pos="0 0 20000")), r"geom 'wall_00': pos is 0 0 20000; at most 10000 m"),
    "a name with escapes": (house(box(name="\x9b31m", pos="nan 0 0")), r"geom '\\x9b31m'"),
}


@pytest.mark.parametrize(("text", "message"), (TOO_MUCH | NO_NUMBERS).values(), ids=TOO_MUCH | NO_NUMBERS)
def test_a_file_that_asks_for_too_much_or_has_no_numbers_is_refused_soon(
    text: str, message: str, tmp_path: Path
) -> None:
    (tmp_path / "house.xml").write_text(text)
    (tmp_path / "bomb.png").write_bytes(png(60_000, 60_000))
    began_s = time.process_time()
    with pytest.raises(HouseError, match=message) as refused:
        load_house(tmp_path / "house.xml")
    assert "house.xml" in str(refused.value)
    assert time.process_time() - began_s < 5.0


@pytest.mark.parametrize("copies", [24, 6])
def test_sensors_that_replicate_doubles_are_counted(copies: int, tmp_path: Path) -> None:
    replicated = f'<replicate count="{copies}" offset="0.1 0 0"><geom name="chair_00" size="0.1"/></replicate>'
    text = house(replicated).replace("</mujoco>", "<sensor><clock/></sensor></mujoco>")
    (tmp_path / "house.xml").write_text(text)
    began_s = time.process_time()
    if copies == 24:
        with pytest.raises(HouseError, match="100000"):
            read_spec(tmp_path / "house.xml")
    else:
        assert len(read_spec(tmp_path / "house.xml").sensors) == 2**copies
    assert time.process_time() - began_s < 5.0


def test_names_that_look_like_numbers_without_meaning_are_names(tmp_path: Path) -> None:
    (tmp_path / "house.xml").write_text(house(f'<body name="inf">{box()}</body>'))
    assert load_house(tmp_path / "house.xml").name == "house"


def test_a_house_of_kilometres_has_no_free_space_grid() -> None:
    far = with_box(room(6, 6), "sofa_00", centre_m=(2, 0, 0.4), half_m=(0.4, 0.8, 0.4))
    far.spec.worldbody.sites[0].size = (2000, 2000, 1)
    truth = GroundTruth(World(far))
    with pytest.raises(HouseError, match=r"4000.*4000.*large.*at.*15625.*m2"):
        truth.space(0.0)


def test_a_label_rule_that_never_ends_is_stopped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sim.houses.labels.RULES_S", 0.2)
    (tmp_path / "house.xml").write_text(house(box(name="a" * 60 + "b")))
    (tmp_path / "rules.json").write_text('{"(?:a|aa)+$": "wall", "b": "wall"}')
    with pytest.raises(HouseError, match=wording.TAKES_TOO_LONG_ON_AAA):
        load_house(tmp_path / "house.xml", labels_path=tmp_path / "rules.json")


@pytest.mark.parametrize(
    ("rule", "message"),
    [("(" * 900, wording.NOT_A_REGULAR), ("a{1,99999}" * 150, "1500 characters"), ("[", wording.NOT_A_REGULAR)],
)
def test_an_invalid_or_too_long_label_rule_is_refused(rule: str, message: str, tmp_path: Path) -> None:
    (tmp_path / "house.xml").write_text(house(box()))
    (tmp_path / "rules.json").write_text(f'{{"{rule}": "wall"}}')
    with pytest.raises(HouseError, match=message):
        load_house(tmp_path / "house.xml", labels_path=tmp_path / "rules.json")


CHAIR = '<body name="chair_{:03}" pos="{} 0 1"><freejoint/><geom type="box" size="0.1 0.1 0.1"/></body>'


@pytest.mark.parametrize(
    ("count", "apart_m", "message"), [(60, 0.0, r"overlap in .* contacts"), (800, 0.3, r"joints need .* MB")]
)
def test_free_bodies_that_need_all_memory_are_refused(count: int, apart_m: float, message: str, tmp_path: Path) -> None:
    (tmp_path / "house.xml").write_text(house("".join(CHAIR.format(i, i * apart_m) for i in range(count))))
    with pytest.raises(HouseError, match=message):
        load_house(tmp_path / "house.xml")


@pytest.mark.parametrize("cache_mb", [0, 10])
def test_the_limit_of_textures_is_a_variable_of_the_environment(
    cache_mb: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(CACHE_VARIABLE, str(tmp_path / "cache"))
    monkeypatch.setenv(SIZE_VARIABLE, str(cache_mb))
    drawn = '<texture name="t" type="2d" builtin="flat" width="1000" height="1000"/>'
    (tmp_path / "house.xml").write_text(house(assets=drawn))
    monkeypatch.setenv("STUBBORN_TEXTURE_MB", "20")
    assert load_house(tmp_path / "house.xml").name == "house"
    for limit, message in (("1", "at most 1 MB are allowed.*STUBBORN_TEXTURE_MB"), ("many", "must be a number of MB")):
        monkeypatch.setenv("STUBBORN_TEXTURE_MB", limit)
        with pytest.raises(HouseError, match=message):
            load_house(tmp_path / "house.xml")
