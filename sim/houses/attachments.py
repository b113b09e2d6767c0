"""Attaches the models that an MJCF file names by `<model file>` and places by `<attach>`.

The text that MuJoCo reads has neither element, because MuJoCo would open the files by itself. Each `<attach>` is
replaced by an empty frame, to which the model is attached after its file has been checked like any other.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from sim.core.errors import HouseError
from sim.core.reading import printable
from sim.gl import mujoco
from sim.houses.references import asset_path

FRAME = "stubborn_attach_"
"""Beginning of the names of the frames to which models are attached."""


@dataclass(frozen=True)
class Attachment:
    """One element `<attach>`."""

    number: int
    """The number of the file among all files of a house."""
    model: str
    """Name of the model in the same file."""
    body: str
    """Name of the body that is attached; "": the whole model."""
    prefix: str

    @property
    def frame(self) -> str:
        """Name of the frame in its place."""
        return f"{FRAME}{self.number}"


def attachment_of(number: int, values: Mapping[str, str]) -> Attachment:
    """Returns an attachment from the attributes of its element."""
    return Attachment(number, values.get("model", ""), values.get("body", ""), values.get("prefix", ""))


def use_absolute_paths(spec: mujoco.MjSpec, folder: Path) -> None:
    """Names the files of a specification by absolute paths, so that another one can hold its elements.

    Args:
        spec: of a file in `folder`; it is changed.
        folder: relative paths are relative to it.
    """
    for asset in (*spec.meshes, *spec.hfields, *spec.skins):
        asset.file = str(asset_path(spec, folder, asset.file)) if asset.file else ""
    for texture in spec.textures:
        texture.file = str(asset_path(spec, folder, texture.file, texture=True)) if texture.file else ""
        for number, side in enumerate(list(texture.cubefiles)):
            texture.cubefiles[number] = str(asset_path(spec, folder, side, texture=True)) if side else ""
    spec.meshdir = spec.texturedir = ""
    spec.strippath = False


def attach(spec: mujoco.MjSpec, model: mujoco.MjSpec, attachment: Attachment) -> None:
    """Attaches a copy of a model to the frame of an attachment.

    Args:
        spec: it is changed.
        model: the attached model; its files have absolute paths.
        attachment: where and under which names.

    Raises:
        HouseError: the model has no such body, or a name is there twice.
    """
    own = model.copy()
    # MuJoCo cannot write models without a prefix: their default classes would have the names of the others.
    prefix = attachment.prefix or f"{attachment.frame}/"
    frame = spec.frame(attachment.frame)
    try:
        if attachment.body:
            body = own.body(attachment.body)
            if body is None:
                raise HouseError(
                    f"attach: model '{printable(attachment.model)}' has no body '{printable(attachment.body)}'."
                )
            frame.attach_body(body, prefix, "")
        else:
            spec.attach(own, prefix=prefix, frame=frame)
        if not attachment.prefix:
            _remove_prefix(spec, prefix)
    except ValueError as fault:
        raise HouseError(f"attach: model '{printable(attachment.model)}': {printable(str(fault))}.") from None


def _remove_prefix(spec: mujoco.MjSpec, prefix: str) -> None:
    """Gives bodies and geoms their own names back, where they and contact pairs name them."""
    for element in (*spec.bodies, *spec.geoms):
        element.name = element.name.removeprefix(prefix)
    for exclude in spec.excludes:
        exclude.bodyname1, exclude.bodyname2 = (
            name.removeprefix(prefix) for name in (exclude.bodyname1, exclude.bodyname2)
        )
    for pair in spec.pairs:
        pair.geomname1, pair.geomname2 = (name.removeprefix(prefix) for name in (pair.geomname1, pair.geomname2))
