"""Packs a scene from elsewhere into one folder: one MJCF file without includes, its meshes and its textures.

The result needs no `--root` and can be moved, as a split can (`stubborn episodes` `--house`, `stubborn import`). Files
are named by their content, so that the houses of a folder share them. Large textures can be reduced in size.
"""

from __future__ import annotations

import contextlib
import hashlib
import math
import os
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from sim.core.errors import HouseError
from sim.core.files import FILE_MODE
from sim.core.pictures import decode_picture, image_size_px
from sim.core.reading import read_bytes, reason_of
from sim.gl import mujoco
from sim.houses.house import House
from sim.houses.references import asset_path

MAX_FILE_BYTES = 512 << 20
FOLDER = "files"
"""Folder of meshes and textures next to the houses."""
_SUM_CHARACTERS, _NAME_CHARACTERS = 12, 60


@dataclass(frozen=True)
class PackedFile:
    """A mesh or a texture of a packed house."""

    content: bytes
    source: Path | None = None
    """The file with just this content; None if the content was changed."""


def packed(house: House, path: Path) -> dict[str, bytes | str]:
    """Returns the files of a house by their names in a folder: `<name>.xml`, and `files/<checksum>_<file>`.

    Args:
        house: a house that `load_house` returned; it is not changed.
        path: its file, to which the paths of its meshes and textures are relative.

    Raises:
        HouseError: a file cannot be read, or MuJoCo cannot write the house.
    """
    spec = house.spec.copy()
    files = gather_files(spec, path.resolve().parent)
    try:
        text = text_of(spec)
    except HouseError as error:
        raise HouseError(f"House '{path}': {error}") from None
    return {f"{house.name}.xml": text} | {name: file.content for name, file in files.items()}


def gather_files(spec: mujoco.MjSpec, folder: Path, *, texture_px: int | None = None) -> dict[str, PackedFile]:
    """Returns the meshes and the textures of a specification by their new names, which it then uses.

    Args:
        spec: it is changed: it names the files by their new names and holds their content.
        folder: that of its file, to which the paths are relative.
        texture_px: PNG textures with a longer side are reduced to this length; None: textures keep their size.

    Raises:
        HouseError: a file cannot be read, or is an image that cannot be reduced.
    """
    files: dict[str, PackedFile] = {}
    names: dict[tuple[Path, bool], str] = {}

    def put(name: str, *, texture: bool = False, square: bool = False) -> str:
        file = asset_path(spec, folder, name, texture=texture)
        if (file, square) not in names:
            content = read_bytes(file, what="Asset", error=HouseError, most=MAX_FILE_BYTES)
            reduced = content
            if texture and texture_px is not None:
                reduced = reduced_image(content, texture_px, cells=square, where=f"Texture '{file}'")
            checksum = hashlib.sha256(reduced).hexdigest()[:_SUM_CHARACTERS]
            packed = f"{FOLDER}/{checksum}_{file.name[-_NAME_CHARACTERS:]}"
            files[packed] = PackedFile(reduced, file if reduced is content else None)
            names[file, square] = packed
        return names[file, square]

    for asset in (*spec.meshes, *spec.hfields, *spec.skins):
        asset.file = put(asset.file) if asset.file else ""
    for texture in spec.textures:
        square = texture.type != mujoco.mjtTexture.mjTEXTURE_2D
        texture.file = put(texture.file, texture=True, square=square) if texture.file else ""
        for number, side in enumerate(list(texture.cubefiles)):
            texture.cubefiles[number] = put(side, texture=True, square=square) if side else ""
    spec.meshdir = spec.texturedir = ""
    spec.strippath = False
    spec.assets = {name: file.content for name, file in files.items()}
    return files


def text_of(spec: mujoco.MjSpec) -> str:
    """Returns the MJCF text of a specification; `gather_files` has gathered its files before.

    Raises:
        HouseError: MuJoCo cannot write it.
    """
    try:
        spec.compile()
        return spec.to_xml()
    except ValueError as error:
        raise HouseError(f"MuJoCo cannot write it as one file: {reason_of(error)}.") from None


def reduced_image(content: bytes, most_px: int, *, cells: bool, where: str) -> bytes:
    """Returns a PNG image with at most `most_px` pixels on its longer side; other files are returned unchanged.

    Args:
        content: of the file.
        most_px: the limit.
        cells: whether the sides keep their exact ratio, as a texture of several square cells needs.
        where: name of the file, for messages.

    Raises:
        HouseError: the image is broken, or too large.
    """
    width, height = image_size_px(content) or (0, 0)
    if max(width, height) <= most_px or not content.startswith(b"\x89PNG"):
        return content
    image = decode_picture(content, cv2.IMREAD_UNCHANGED, where=where, error=HouseError)
    if image.dtype == np.uint16:
        image = np.right_shift(np.asarray(image, np.uint16), 8).astype(np.uint8)
    factor = most_px / max(width, height)
    size = max(1, round(width * factor)), max(1, round(height * factor))
    if cells:
        unit = math.gcd(width, height)
        small = max(1, int(unit * factor))
        size = width // unit * small, height // unit * small
    done, written = cv2.imencode(".png", cv2.resize(image, size, interpolation=cv2.INTER_AREA))
    return written.tobytes() if done else content


def write_files(folder: Path, files: Mapping[str, PackedFile], *, pack: bool) -> None:
    """Writes the files of packed houses into a folder; a file that is there already is the same and stays.

    Args:
        folder: the folder of the houses.
        files: by their names in it.
        pack: whether to copy all files. Otherwise an unchanged file becomes a hard link to its source, which needs no
            space on the disk; it is copied where the file system cannot link it.

    Raises:
        OSError: a file cannot be written.
    """
    for name, file in files.items():
        path = folder / name
        if path.is_file() and path.stat().st_size == len(file.content):
            continue
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, part = tempfile.mkstemp(dir=path.parent, suffix=".part")
        os.close(handle)
        try:
            if pack or file.source is None or not _linked(file.source, Path(part)):
                Path(part).write_bytes(file.content)
                os.chmod(part, FILE_MODE)
            os.replace(part, path)
        finally:
            with contextlib.suppress(OSError):
                os.unlink(part)


def _linked(source: Path, part: Path) -> bool:
    """Replaces a file by a hard link to another one; returns False if that is not possible."""
    part.unlink()
    try:
        os.link(source.resolve(), part)
    except OSError:
        return False
    return True
