"""A house file reads only files of its own folder, textures that a split shares, and files that `--root` allows."""

from __future__ import annotations

import os
import zipfile
from pathlib import Path

import cv2
import numpy as np
import pytest

from sim.app.commands import run
from sim.core.errors import ConfigError, HouseError
from sim.houses.load import load_house
from sim.houses.references import files_of
from sim.robot.foreign import load_robot
from tests.helpers import wording
from tests.helpers.foreign import CUBE, ROBOT, write_robot

FLOOR = '<geom name="floor_00" type="plane" size="3 3 1"/>'
MESH = '<asset><mesh name="cube" file="{file}"/></asset>'
TEXTURE = '<asset><texture name="wood" type="{kind}" {file}/></asset>'
SOFA = '<mujoco><worldbody><geom name="sofa_00" size="0.2" pos="1 1 0.2"/></worldbody></mujoco>'


def write(folder: Path, more: str = "", *, world: str = "") -> Path:
    """Writes the scene of a package, `package/scenes/house.xml`, and its folders `common` and `textures`."""
    for name in ("scenes", "common", "textures", "scenes/parts"):
        (folder / "package" / name).mkdir(parents=True, exist_ok=True)
    (folder / "package" / "common" / "sofa.xml").write_text(SOFA)
    (folder / "package" / "common" / "cube.obj").write_text(CUBE)
    (folder / "package" / "scenes" / "parts" / "cube.obj").write_text(CUBE)
    for name in ("textures", "common"):
        cv2.imwrite(str(folder / "package" / name / "wood.png"), np.zeros((4, 4, 3), np.uint8))
    file = folder / "package" / "scenes" / "house.xml"
    file.write_text(f"<mujoco>{more}<worldbody>{FLOOR}{world}</worldbody></mujoco>")
    return file


OUTSIDE = {
    "an included file beside the folder": '<include file="../common/sofa.xml"/>',
    "an included system file": '<include file="/etc/passwd"/>',
    "a file that an included file includes": '<include file="parts/more.xml"/>',
    "a mesh": MESH.format(file="../common/cube.obj"),
    "a mesh by its whole path": MESH.format(file="/etc/passwd"),
    "a folder of meshes": '<compiler meshdir="../common"/>' + MESH.format(file="cube.obj"),
    "a folder of all assets": '<compiler assetdir="/etc"/>' + MESH.format(file="passwd"),
    "a texture": TEXTURE.format(kind="2d", file='file="../common/wood.png"'),
    "a side of a cube": TEXTURE.format(kind="cube", file='fileright="../common/wood.png"'),
    "a symbolic link": '<include file="parts/link.xml"/>',
    "a model": '<asset><model name="m" file="../common/sofa.xml"/></asset>',
    "a flexible body": '<worldbody><flexcomp name="f" type="mesh" file="../common/cube.obj"/></worldbody>',
    "folders separated by backslashes": '<include file="..\\common\\sofa.xml"/>',
    "a mesh behind backslashes": MESH.format(file="parts\\..\\..\\common\\cube.obj"),
    "a folder of meshes with a backslash": '<compiler meshdir="..\\common"/>' + MESH.format(file="cube.obj"),
    "a link that MuJoCo does not follow": '<include file="to_deeper/../../common/sofa.xml"/>',
    "a height field": '<asset><hfield name="h" size="1 1 1 1" file="../common/wood.png"/></asset>',
}


@pytest.mark.parametrize("more", OUTSIDE.values(), ids=OUTSIDE)
def test_a_file_outside_of_the_folder_of_the_house_is_refused(more: str, tmp_path: Path) -> None:
    file = write(tmp_path, more)
    (file.parent / "parts" / "more.xml").write_text('<mujoco><include file="../../common/sofa.xml"/></mujoco>')
    os.symlink(file.parent.parent / "common" / "sofa.xml", file.parent / "parts" / "link.xml")
    (file.parent / "common").mkdir()
    (file.parent / "common" / "sofa.xml").write_text(SOFA)  # where the file system leads
    os.symlink(file.parent / "parts", file.parent / "to_deeper")
    with pytest.raises(HouseError, match=wording.WHICH_IS_OUTSIDE_OF_ITS_FOLDER) as refused:
        load_house(file)
    assert "\n" not in str(refused.value)


def test_a_refusal_proposes_the_folder_that_holds_both_files_except_for_system_files(tmp_path: Path) -> None:
    with pytest.raises(HouseError, match=rf"--root '{tmp_path / 'package'}'\.$"):
        load_house(write(tmp_path, OUTSIDE["an included file beside the folder"]))
    with pytest.raises(HouseError, match=r"--root.*\.$"):
        load_house(write(tmp_path, OUTSIDE["an included system file"]))


def test_files_of_the_root_may_be_used_and_no_others(tmp_path: Path) -> None:
    file = write(tmp_path, '<include file="../common/sofa.xml"/>')
    house = load_house(file, root=tmp_path / "package")
    assert [geom.name for geom in house.spec.geoms] == ["sofa_00", "floor_00"]
    with pytest.raises(HouseError, match=r"'.*package'"):
        load_house(write(tmp_path, OUTSIDE["an included system file"]), root=tmp_path / "package")
    with pytest.raises(HouseError, match=r"--root.*'.*nowhere'"):
        load_house(file, root=tmp_path / "nowhere")


INSIDE = {
    "a mesh folder": '<compiler meshdir="parts"/>' + MESH.format(file="cube.obj"),
    "an asset folder": '<compiler assetdir="parts"/>' + MESH.format(file="cube.obj"),
    "a relative path": MESH.format(file="parts/../parts/cube.obj"),
    "a path that is stripped": '<compiler meshdir="parts" strippath="true"/>' + MESH.format(file="../../x/cube.obj"),
    "a texture that the split shares": TEXTURE.format(kind="2d", file='file="../textures/wood.png"'),
    "a file beside the included file": '<include file="parts/outer.xml"/>',
    "a file beside the house, from a folder": '<include file="parts/upward.xml"/>',
}


@pytest.mark.parametrize("more", INSIDE.values(), ids=INSIDE)
def test_includes_and_asset_folders_of_the_house_are_read(more: str, tmp_path: Path) -> None:
    use = '<geom name="chair_00" type="mesh" mesh="cube" pos="2 2 1"/>' if "cube" in more else ""
    file = write(tmp_path, more, world=use)
    (file.parent / "parts" / "inner.xml").write_text(SOFA)
    (file.parent / "parts" / "outer.xml").write_text('<mujoco><include file="inner.xml"/></mujoco>')
    (file.parent / "beside.xml").write_text(SOFA)
    (file.parent / "parts" / "upward.xml").write_text('<mujoco><include file="../beside.xml"/></mujoco>')
    assert load_house(file).spec.compile().ngeom == 1 + ("cube" in more) + ("include" in more)


def test_a_pipe_is_not_read(tmp_path: Path) -> None:
    file = write(tmp_path, '<include file="parts/pipe.xml"/>')
    os.mkfifo(file.parent / "parts" / "pipe.xml")
    with pytest.raises(HouseError, match=wording.NOT_A_REGULAR_FILE):
        load_house(file)


@pytest.mark.parametrize("name", ["parts/a\nb.xml", "parts/a&#10;b.xml", "parts/a\tb.xml", "parts/a&#x7f;b.xml"])
def test_a_control_character_in_the_name_of_an_included_file_is_refused(name: str, tmp_path: Path) -> None:
    file = write(tmp_path, f'<include file="{name}"/>')
    for harmless in ("a b.xml", "ab.xml"):  # expat reads a line break as a space
        (file.parent / "parts" / harmless).write_text(SOFA)
    with pytest.raises(HouseError, match=wording.CONTAINS_A_CONTROL_CHARACTER):
        load_house(file)


def test_a_robot_reads_no_file_outside_of_its_folder(tmp_path: Path) -> None:
    file = write_robot(tmp_path / "r", robot=ROBOT.replace('file="cube.obj"', 'file="../../cube.obj"'))
    (tmp_path / "cube.obj").write_text(CUBE)
    with pytest.raises(ConfigError, match="cube"):
        load_robot(file)


def test_a_run_with_a_root_works_and_one_without_names_the_missing_option(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    house = ["--house", str(write(tmp_path, '<include file="../common/sofa.xml"/>')), "--agent", "oracle"]
    few = ["--episodes", "1", "--out", str(tmp_path / "run")]
    assert run.entry([*house, *few]) == 2
    assert f"--root '{tmp_path / 'package'}'" in capsys.readouterr().err
    assert run.entry([*house, *few, "--root", str(tmp_path / "package")]) == 0
    assert run.entry(["--root", str(tmp_path), *few]) == 2
    assert "--root needs --house or --robot" in capsys.readouterr().err


ELSEWHERE = {
    "Include": '<Include file="../common/sofa.xml"/>',
    "a file in an archive": '<include file="parts/a.zip/sofa.xml"/>',
    "a mesh in an archive": MESH.format(file="parts/a.ZIP/cube.obj"),
    "a folder of meshes that is an archive": '<compiler meshdir="a.mjz"/>' + MESH.format(file="cube.obj"),
    "a drive": MESH.format(file="C:/cube.obj"),
    "a drive that two names make": '<compiler meshdir="C:"/>' + MESH.format(file="cube.obj"),
    "an address": '<include file="file:///etc/passwd"/>',
    "a backslash that is a root": MESH.format(file="\\cube.obj"),
    "a flexible body": '<worldbody><flexcomp name="f" type="mesh" file="parts/cube.obj"/></worldbody>',
    "an include in an include": '<include file="parts/inner.xml"><include file="/etc/passwd"/></include>',
}


@pytest.mark.parametrize("more", ELSEWHERE.values(), ids=ELSEWHERE)
def test_names_that_mujoco_would_open_elsewhere_are_refused(
    more: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = write(tmp_path, more)
    (file.parent / "parts" / "inner.xml").write_text(SOFA)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "C:").mkdir()
    (tmp_path / "C:" / "cube.obj").write_text(CUBE)
    for name in ("parts/a.zip", "parts/a.ZIP", "a.mjz"):
        with zipfile.ZipFile(file.parent / name, "w") as archive:
            archive.writestr("sofa.xml", SOFA)
            archive.writestr("cube.obj", CUBE)
    with pytest.raises(HouseError, match=wording.IS_NOT_READ_IS_WRITTEN_INCLUDE_READS_ANOTHER_FIL):
        load_house(file)


def test_limits_count_included_files_too(tmp_path: Path) -> None:
    file = write(tmp_path, '<include file="parts/inner.xml"/>')
    for content, message in (
        ("<mujoco><worldbody>" + "<body/>" * 100_001 + "</worldbody></mujoco>", "more than 100000 elements"),
        ("<mujoco><worldbody>" + "<body>" * 300 + "</body>" * 300 + "</worldbody></mujoco>", "nested more than 200"),
        ('<mujoco><include file="../house.xml"/></mujoco>', "included more than once"),
    ):
        (file.parent / "parts" / "inner.xml").write_text(content)
        with pytest.raises(HouseError, match=message):
            load_house(file)


@pytest.mark.parametrize(
    ("encoding", "declared"),
    [("utf-8-sig", ""), ("utf-16", "UTF-16"), ("utf-16-le", ""), ("utf-32", ""), ("cp1252", "Windows-1252"),
     ("gb18030", "GB18030"), ("utf-8", "utf-16")],
)  # fmt: skip
def test_houses_in_the_encodings_of_other_programs_are_read(encoding: str, declared: str, tmp_path: Path) -> None:
    file = write(tmp_path, '<include file="parts/é.xml"/>')
    text = file.read_text() if not declared else f'<?xml version="1.0" encoding="{declared}"?>{file.read_text()}'
    file.write_bytes(text.encode(encoding))
    (file.parent / "parts" / "é.xml").write_bytes(SOFA.encode(encoding))
    assert [geom.name for geom in load_house(file).spec.geoms] == ["sofa_00", "floor_00"]


@pytest.mark.parametrize("declared", ["UTF-7", "punycode", "rot13", "zlib", "EBCDIC-CP-US", "nonsense", "os", "cp037"])
def test_an_encoding_that_is_not_read_is_one_line(declared: str, tmp_path: Path) -> None:
    file = write(tmp_path)
    file.write_text(f'<?xml version="1.0" encoding="{declared}"?>{file.read_text()}')
    with pytest.raises(HouseError, match=wording.ENCODING_IS_NOT_READ_NOT_WELL_FORMED_NOT_AN_MJCF):
        load_house(file)


def test_attached_models_are_part_of_the_house_with_their_meshes_and_names(tmp_path: Path) -> None:
    world = "".join(
        f'<frame pos="{x} 0 1"><attach model="m" prefix="{prefix}"/></frame>' for x, prefix in ((1, ""), (2, "b/"))
    )
    file = write(tmp_path, '<asset><model name="m" file="parts/lamp.xml"/></asset>', world=world)
    lamp = MESH.format(file="cube.obj") + (
        '<compiler angle="degree"/><default><geom rgba="1 0 0 1"/></default><worldbody>'
        '<body name="lighting_00" euler="0 0 90"><geom name="lamp" type="mesh" mesh="cube"/></body></worldbody>'
    )
    (file.parent / "parts" / "lamp.xml").write_text(f"<mujoco>{lamp}</mujoco>")
    (tmp_path / "labels.json").write_text('{"lighting": "lighting"}')
    model = load_house(file, labels_path=tmp_path / "labels.json").spec.compile()
    assert [model.body(number).name for number in range(1, model.nbody)] == ["lighting_00", "b/lighting_00"]
    assert model.body("b/lighting_00").pos == pytest.approx([2, 0, 1])
    assert model.geom_rgba[model.geom("lamp").id] == pytest.approx([1, 0, 0, 1])
    assert file.parent / "parts" / "cube.obj" in files_of(file)


@pytest.mark.parametrize(
    ("lamp", "world", "message"),
    [
        ("<worldbody/>", '<attach model="none"/>', "'none'"),
        ("<worldbody/>", '<attach model="m" body="b"/>', "'b'"),
        ("<worldbody/>", '<replicate count="3"><attach model="m"/></replicate>', "outside of `replicate`"),
        ('<include file="../../common/sofa.xml"/>', '<attach model="m"/>', wording.OUTSIDE_OF_ITS_FOLDER),
        (MESH.format(file="../../common/cube.obj"), '<attach model="m"/>', wording.OUTSIDE_OF_ITS_FOLDER),
        ('<asset><model name="m" file="lamp.xml"/></asset><worldbody><attach model="m"/></worldbody>',
         '<attach model="m"/>', wording.INCLUDED_MORE_THAN_ONCE),
        ("<worldbody>" + '<body name="b"/>' * 2 + "</worldbody>", '<attach model="m"/>', "repeated name"),
        pytest.param(
            "<worldbody>" + "<geom/>" * 60_000 + "</worldbody>", '<attach model="m"/><attach model="m" prefix="b"/>',
            "more than 100000 elements", marks=pytest.mark.slow,
        ),
    ],
)  # fmt: skip
def test_attached_models_are_checked_like_the_house(lamp: str, world: str, message: str, tmp_path: Path) -> None:
    file = write(tmp_path, '<asset><model name="m" file="parts/lamp.xml"/></asset>', world=world)
    (file.parent / "parts" / "lamp.xml").write_text(f"<mujoco>{lamp}</mujoco>")
    with pytest.raises(HouseError, match=message) as refused:
        load_house(file)
    assert "\n" not in str(refused.value)
