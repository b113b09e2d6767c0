"""Writes a house as compact XML, the output of MuJoCo without redundant digits, together with its textures."""

from __future__ import annotations

import html
import re
from pathlib import Path

from sim.core.errors import HouseError
from sim.core.files import inside, write_together
from sim.core.reading import read_bytes, reason_of
from sim.gl import mujoco
from sim.houses.house import House
from sim.houses.load import load_house, validate_house
from sim.houses.references import SHARED_TEXTURES, asset_path

_IDENTITY_QUAT = ' quat="1 0 0 0"'
_QUAT = re.compile(r' quat="([^"]*)"')
_TEXTURE_DIR = re.compile(r'texturedir="[^"]*"')
_LEADING_ZERO = re.compile(r'(?<=[" -])0\.')
_INDENT = re.compile(r"\n\s+")
_QUAT_DIGITS = 4


def house_text(spec: mujoco.MjSpec, textures: str | None = None) -> str:
    """Returns the XML of a specification, a tenth shorter than `to_xml`; rotations are equal to within 0.1 mrad.

    Args:
        spec: a house.
        textures: folder of the texture files, relative to the folder of the XML file; unchanged when None.
    """
    text = spec.to_xml()
    if textures is not None:
        text = _TEXTURE_DIR.sub(lambda _: f'texturedir="{html.escape(textures)}"', text, count=1)
    text = _QUAT.sub(_short_quat, text.replace(_IDENTITY_QUAT, ""))
    return _INDENT.sub("\n", _LEADING_ZERO.sub(".", text))


def write_house(spec: mujoco.MjSpec, folder: str | Path, name: str | None = None) -> Path:
    """Writes a generated house with its textures into a folder; returns the file `<name>.xml`, for `--house`.

    Several houses share the subfolder `textures`. `stubborn episodes --split` makes the folder a split.

    Args:
        spec: the specification that `sim.generate` returned; you may have changed it.
        folder: it is created if it does not exist.
        name: name of the house; None: the name of the model.

    Raises:
        HouseError: the specification has files other than textures, or violates the house format.
        ConfigError: the name is not that of a file, or the folder cannot be written.
    """
    folder, name = Path(folder), str(name or spec.modelname)
    if any(asset.file for asset in (*spec.meshes, *spec.hfields, *spec.skins)):
        raise HouseError(f"House '{name}' has meshes in files, which write_house does not copy.")
    path = inside(folder, f"{name}.xml", what="name of a house")
    try:
        model = spec.compile()
    except ValueError as error:
        raise HouseError(f"House '{name}' does not compile: {reason_of(error)}.") from None
    try:
        validate_house(House(name, spec), model)
    except HouseError as error:
        raise HouseError(f"House '{name}': {error}") from None
    files: dict[Path, bytes | str] = {path: house_text(spec, SHARED_TEXTURES)}
    for texture in spec.textures:
        for file in (name for name in (texture.file, *texture.cubefiles) if name):
            if Path(file).name != file:
                raise HouseError(f"House '{name}': texture '{file}' must be a file name without a folder.")
            source = asset_path(spec, Path(spec.modelfiledir), file, texture=True)
            files[folder / SHARED_TEXTURES / file] = read_bytes(source, what="Texture", error=HouseError)
    write_together(files)
    load_house(path)
    return path


def _short_quat(match: re.Match[str]) -> str:
    """Returns a quaternion in few digits, quarter turns in integers; MuJoCo normalizes it when reading."""
    values = [float(number) for number in match[1].split()]
    largest = max(abs(value) for value in values)
    if all(abs(value) in (0.0, largest) for value in values):
        values = [value / largest for value in values]
    return ' quat="' + " ".join(f"{round(value, _QUAT_DIGITS) + 0.0:g}" for value in values) + '"'
