"""Packs a scene from elsewhere into one folder: one MJCF file without includes, its meshes and its textures.

The result needs no `--root` and can be moved, as a split can (`stubborn episodes` `--house`).
"""

from __future__ import annotations

from pathlib import Path

from sim.errors import HouseError
from sim.houses.house import House
from sim.houses.references import asset_path
from sim.reading import read_bytes, reason_of

MAX_FILE_BYTES = 512 << 20


def packed(house: House, path: Path) -> dict[str, bytes | str]:
    """Returns the files of a house by their names in a folder: `<name>.xml`, and `<name>_files/<number>_<file>`.

    Args:
        house: a house that `load_house` returned; it is not changed.
        path: its file, to which the paths of its meshes and textures are relative.

    Raises:
        HouseError: a file cannot be read, or MuJoCo cannot write the house.
    """
    spec, folder = house.spec.copy(), path.resolve().parent
    files: dict[str, bytes | str] = {}

    def put(name: str, *, texture: bool = False) -> str:
        file = asset_path(spec, folder, name, texture=texture)
        there = f"{house.name}_files/{len(files):03d}_{file.name}"
        files[there] = read_bytes(file, what="Asset", error=HouseError, most=MAX_FILE_BYTES)
        return there

    for asset in (*spec.meshes, *spec.hfields, *spec.skins):
        asset.file = put(asset.file) if asset.file else ""
    for texture in spec.textures:
        texture.file = put(texture.file, texture=True) if texture.file else ""
        sides = [put(side, texture=True) if side else "" for side in texture.cubefiles]
        for number, side in enumerate(sides):
            texture.cubefiles[number] = side
    spec.meshdir = spec.texturedir = ""
    spec.strippath = False
    spec.assets = {name: content for name, content in files.items() if isinstance(content, bytes)}
    try:
        spec.compile()
        text = spec.to_xml()
    except ValueError as error:
        raise HouseError(f"House '{path}': MuJoCo cannot write it as one file: {reason_of(error)}.") from None
    return {f"{house.name}.xml": text} | files
