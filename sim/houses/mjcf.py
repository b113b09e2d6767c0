"""Reads MJCF files from any source: the memory that a file requires is estimated before MuJoCo builds its model.

A few lines of MJCF can require any amount of memory: `replicate` in `replicate`, a texture of 60,000 x 60,000 pixels, a
custom array of a given size. `read_spec` refuses such files and numbers that are not finite, and names the element.
Included files, meshes and textures must be in the folders of `sim.houses.references`.
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Mapping
from pathlib import Path
from typing import NoReturn
from xml.parsers import expat

import numpy as np

from sim.core.errors import HouseError, ObjectNavError
from sim.core.pictures import image_size_px
from sim.core.reading import FARTHEST_M, MAX_BYTES, open_plain, printable, read_bytes, reason_of
from sim.gl import mujoco
from sim.houses.attachments import Attachment, attach, attachment_of, use_absolute_paths
from sim.houses.geoms import data_at_rest
from sim.houses.mjcf_text import Composition, as_utf8
from sim.houses.references import Allowed, Reference, asset_path, asset_references, path_as_read

MAX_ELEMENTS = 100_000
"""Largest number of elements of a file, with all copies by `replicate`; the largest shipped house has 6,000."""
MAX_FILES = 100
"""Largest number of files that are read for one house: the file itself and the files that it includes."""
MAX_ATTACHED = 10
"""Largest depth of models that are attached in each other."""
MAX_DEPTH = 200
"""Largest depth of nested elements; MuJoCo itself reads 500."""
MAX_TEXTURE_BYTES = 512 << 20
"""Largest size of all textures of a file together; those that ship have 10 MB."""
TEXTURE_VARIABLE = "STUBBORN_TEXTURE_MB"
"""Environment variable that sets another limit for textures, MB."""
MAX_ASSET_BYTES = 512 << 20
"""Largest size of the files of all meshes and other assets together."""
MAX_ARRAY = 1_000_000
"""Largest custom array, buffer or count of a file."""
MAX_PHYSICS_BYTES = 1 << 30
"""Largest memory for contacts and constraints, enough for about 700 free bodies; the largest shipped house needs
20 MB."""
MAX_CONTACTS = 5000
"""Largest number of contacts of a house in its initial state; more do not fit the memory that MuJoCo reserves."""
LARGEST = 1e15
"""Largest magnitude of a number in a file."""
_SUSPECT = re.compile(r"(?=\s*[-+.\dnNiI])[^nNeExX]*?(?:[nNxX]|[eE]\+?\d{2}|\d{16})", re.DOTALL)
"""Matches a list of numbers if one of them may be nan, inf or beyond `LARGEST`. The test is fast: most names fail at
the first character."""
_LENGTHS: Mapping[str, tuple[str, ...]] = {
    "hfield": ("nrow", "ncol"),
    "numeric": ("size",),
    "size": (
        "nuserdata", "nkey", "nuser_body", "nuser_jnt", "nuser_geom", "nuser_site", "nuser_cam", "nuser_tendon",
        "nuser_actuator", "nuser_sensor",
    ),
    "user": ("dim",),
}  # fmt: skip
"""Attributes by element; the length of the element's array is their product."""
_SENSOR_TARGETS = frozenset((
    "site", "joint", "tendon", "actuator", "body", "body1", "body2", "geom1", "geom2", "subtree1", "subtree2",
    "objname",
))  # fmt: skip
"""Attributes by which a sensor names the element that it belongs to."""
_LENGTHS_ANYWHERE = ("nsample",)
_NAMES = frozenset((
    "name", "class", "childclass", "material", "mesh", "texture", "hfield", "file", "target", "body", "body1", "body2",
    "geom", "geom1", "geom2", "joint", "joint1", "joint2", "site", "model", "prefix", "data",
))  # fmt: skip
"""Attributes with a name as their value."""
_NOT_FINITE = re.compile(r"[-+]?(?:nan(?:\(\w*\))?|inf(?:inity)?)", re.IGNORECASE)
"""A word that C reads as a number that is not finite, such as `nan(1)`."""
_READ_AT_ONCE = ("include", "model", "flexcomp")
"""Elements with a file that MuJoCo opens while it parses the text; it looks for files of `model` and `flexcomp` in the
current folder first."""
_FILE_NAME = re.compile(rb"""\bfile\s*=\s*(?:"[^"]*"|'[^']*')""")
"""The attribute `file` of an element, in the bytes of a file."""
_CONTROL = re.compile(rb"[\x00-\x1f\x7f]")


def read_spec(
    path: Path,
    *,
    root: Path | None = None,
    error: type[ObjectNavError] = HouseError,
    texture_px: int | None = None,
) -> mujoco.MjSpec:
    """Returns the specification of an MJCF file.

    Args:
        path: the file.
        root: a folder that the file may use in addition to its own.
        error: class of the error; only in a house may other models be attached.
        texture_px: the caller reduces textures with a longer side to this length, so that they count with this size.

    Raises:
        ObjectNavError: of class `error`; the file cannot be read, is not MJCF, requires too much memory, uses a file of
            another folder, or has a number that is not finite. The message names element and attribute but not the
            file.
    """
    path = path.resolve()
    spec = _read_spec(path, _Scan(Allowed(path, root, error)))
    _require_small_assets(spec, path.parent, error, texture_px)
    return spec


def _read_spec(path: Path, scan: _Scan, depth: int = 0) -> mujoco.MjSpec:
    """Returns the specification of a file, with the models that it attaches."""
    error, allowed = scan.allowed.error, scan.allowed
    if depth > MAX_ATTACHED:
        raise error(f"its models are attached in each other more than {MAX_ATTACHED} deep.")
    text, models, attachments = scan.read(path)
    try:
        spec = mujoco.MjSpec.from_string(text.decode("utf-8"))
    except (ValueError, OSError, RecursionError) as fault:
        raise error(f"it is not an MJCF file that MuJoCo can read: {reason_of(fault)}") from None
    spec.modelfiledir = f"{path.parent}{os.sep}"  # assets are relative to it
    spec.memory = spec.nconmax = spec.njmax = spec.nstack = -1  # as much as the model needs
    orient_by_quaternions(spec)
    for reference in asset_references(spec, path.parent):
        allowed.require(reference)
    if attachments:
        use_absolute_paths(spec, path.parent)
    read: dict[Path, tuple[mujoco.MjSpec, float]] = {}
    for attachment in attachments:
        file = models.get(attachment.model)
        if file is None:
            raise error(f"attach: model '{printable(attachment.model)}' must be declared with a file.")
        if file in read:
            scan.count(read[file][1], f"attach of model '{attachment.model}'")
        else:
            before = scan.elements
            model = _read_spec(file, scan, depth + 1)
            use_absolute_paths(model, file.parent)
            read[file] = model, scan.elements - before
        attach(spec, read[file][0], attachment)
    return spec


def orient_by_quaternions(spec: mujoco.MjSpec) -> None:
    """Replaces Euler angles, axis-angle pairs and axes of a specification by quaternions.

    `fusestatic` reads the angles of an attached model with the angle settings of the model to which it is attached.
    Quaternions do not depend on these settings.
    """
    for element in (*spec.bodies, *spec.geoms, *spec.sites, *spec.cameras, *spec.frames):
        if element.alt.type != mujoco.mjtOrientation.mjORIENTATION_QUAT:
            element.quat = _quaternion(spec, element.alt)
            element.alt.type = mujoco.mjtOrientation.mjORIENTATION_QUAT
    for body in spec.bodies:
        if body.ialt.type != mujoco.mjtOrientation.mjORIENTATION_QUAT:
            body.iquat = _quaternion(spec, body.ialt)
            body.ialt.type = mujoco.mjtOrientation.mjORIENTATION_QUAT


def _quaternion(spec: mujoco.MjSpec, orientation: mujoco.MjsOrientation) -> list[float]:
    """Returns an orientation as the quaternion w, x, y, z."""
    compiler = spec.compiler
    return mujoco.MjSpec.resolve_orientation(
        degree=bool(compiler.degree), sequence=compiler.eulerseq, orientation=orientation
    )


def require_sizes(model: mujoco.MjModel, *, error: type[ObjectNavError] = HouseError) -> None:
    """Raises an error if a compiled model has a position or a size that is not finite or beyond `FARTHEST_M`."""
    for kind, field in (("body", "pos"), ("geom", "pos"), ("geom", "size"), ("site", "pos"), ("site", "size")):
        values = getattr(model, f"{kind}_{field}")
        bad = np.flatnonzero(~(np.abs(values) <= FARTHEST_M).all(axis=1))
        if bad.size:
            name = getattr(model, kind)(int(bad[0])).name or f"number {bad[0]}"
            numbers = " ".join(f"{value:g}" for value in values[bad[0]])
            raise error(f"{kind} '{name}': {field} is {numbers}; at most {FARTHEST_M:g} m are allowed.")
    if not bool((np.abs(model.mesh_vert) <= FARTHEST_M).all()):
        raise error(f"a mesh has a vertex that is not finite or beyond {FARTHEST_M:g} m.")


def require_few_contacts(model: mujoco.MjModel) -> None:
    """Raises HouseError if a compiled model has too many moving bodies or contacts for the memory of the physics.

    The memory of MuJoCo grows with the square of the number of moving bodies.
    """
    if model.narena > MAX_PHYSICS_BYTES:
        raise HouseError(
            f"its {model.njnt} joints need {model.narena >> 20} MB, at most {MAX_PHYSICS_BYTES >> 20} MB are "
            "allowed; let fewer bodies move."
        )
    if model.nv == 0:
        return
    data = data_at_rest(model)
    mujoco.mj_comPos(model, data)
    mujoco.mj_collision(model, data)
    if data.ncon > MAX_CONTACTS:
        raise HouseError(
            f"its moving bodies overlap in {data.ncon} contacts at the start; at most {MAX_CONTACTS} are allowed."
        )


class _Scan:
    """Counts the elements of a file and of the files that it includes, and joins the files to one text."""

    def __init__(self, allowed: Allowed) -> None:
        self.allowed = allowed
        self._error = allowed.error
        self._files = dict[Path, None]()
        self._bytes = 0
        self.elements = 0.0
        self._factors = [1.0]
        self._tags: list[str] = []
        self._copies = self._loose_sensors = 0.0
        self._models = dict[str, Path]()
        self._attachments: list[Attachment] = []
        self._attached = 0

    def read(self, path: Path) -> tuple[bytes, dict[str, Path], list[Attachment]]:
        """Returns the text of a file, UTF-8, the files of the models in it, and its attachments."""
        self._models, self._attachments = {}, []
        text = self.text_of(path)
        return text, self._models, self._attachments

    def count(self, elements: float, where: str) -> None:
        """Counts further elements; raises an error if there are too many."""
        self.elements += elements
        # For each copy that `replicate` makes, MuJoCo doubles the number of sensors that belong to no element.
        if self.elements + self._loose_sensors * 2.0 ** min(self._copies, 60.0) > MAX_ELEMENTS:
            self._refuse(f"{printable(where)}: the file has more than {MAX_ELEMENTS} elements with all copies.")

    def text_of(self, path: Path, *, inner: bool = False) -> bytes:
        """Returns a file with the files that it includes as one text, UTF-8; raises an error if it is too large.

        Args:
            path: the file.
            inner: whether to return only the content of the root element, as for an included file.
        """
        if path in self._files:
            self._refuse(f"'{path.name}' is included more than once, which MuJoCo does not allow.")
        self._files[path] = None
        if len(self._files) > MAX_FILES:
            self._refuse(f"it includes more than {MAX_FILES} files.")
        content = read_bytes(path, what="its file", error=self._error, most=MAX_BYTES - self._bytes)
        self._bytes += len(content)
        depth = len(self._tags)
        parser = expat.ParserCreate("utf-8")
        try:
            text = Composition(as_utf8(content))
        except UnicodeDecodeError as fault:
            line = fault.object.count(b"\n", 0, fault.start) + 1
            self._refuse(f"'{path.name}', line {line}, is not text in {fault.encoding}; save it as UTF-8.")
        except ValueError as fault:
            self._refuse(f"'{path.name}' cannot be read: {reason_of(fault)}.")
        try:
            parser.StartElementHandler = lambda tag, values: self._start(path, tag, values, text, parser, depth)
            parser.EndElementHandler = lambda tag: self._end(text, parser, depth)
            parser.StartDoctypeDeclHandler = lambda *_: self._refuse("a document type is not allowed in MJCF.")
            parser.Parse(text.content, True)
        except expat.ExpatError as fault:
            self._refuse(f"it is not an MJCF file that MuJoCo can read: {reason_of(fault)} ('{path.name}').")
        return text.text(inner=inner)

    def _end(self, text: Composition, parser: expat.XMLParserType, depth: int) -> None:
        self._factors.pop()
        self._tags.pop()
        if len(self._tags) == depth:
            text.close_root(parser.CurrentByteIndex)

    def _start(
        self, path: Path, tag: str, values: Mapping[str, str], text: Composition, parser: expat.XMLParserType,
        depth: int,
    ) -> None:  # fmt: skip
        self._require_tag(tag, is_root=len(self._tags) == depth, included=depth > 0)
        if len(self._tags) == depth:
            text.open_root(parser.CurrentByteIndex)
        if len(self._tags) > MAX_DEPTH:
            self._refuse(f"its elements are nested more than {MAX_DEPTH} deep.")
        where = f"{tag} '{values['name']}'" if "name" in values else tag
        for key, value in values.items():
            if key not in _NAMES and _SUSPECT.match(value):
                self._require_finite(f"{printable(where)}: {key}", value)
        self._require_small_arrays(where, tag, values)
        factor = self._factors[-1]
        self.elements += factor
        if tag in ("replicate", "composite", "flexcomp"):
            factor *= math.prod(max(1.0, number) for number in _numbers(values.get("count", "1")))
        if tag == "mesh" and "builtin" in values:
            factor *= max(1.0, math.prod(max(1.0, number) for number in _numbers(values.get("params", ""))) / 1000.0)
        self.elements += factor - self._factors[-1]
        self._copies += factor if tag == "replicate" else 0.0
        self._loose_sensors += self._tags[-1:] == ["sensor"] and _SENSOR_TARGETS.isdisjoint(values)
        self._factors.append(factor)
        self._tags.append(tag)
        self.count(0.0, where)
        if self._attaches(path, tag, values, text, parser.CurrentByteIndex):
            return
        if tag in _READ_AT_ONCE and values.get("file"):
            self._require_name(values["file"], text.content, parser.CurrentByteIndex)
            file = self._found(path, values["file"])
            if tag != "include":
                self._refuse(f"{printable(where)} reads another file; only include, meshes and textures may do that.")
            end, is_whole = text.end_of_tag(parser.CurrentByteIndex)
            if not is_whole:
                self._refuse(f"include '{printable(values['file'])}' has content; it must end with '/>'.")
            text.replace(parser.CurrentByteIndex, end, self.text_of(file, inner=True))
        elif tag == "include":
            self._refuse("an include names no file.")

    def _attaches(self, path: Path, tag: str, values: Mapping[str, str], text: Composition, start: int) -> bool:
        """Records a model or an attachment and returns whether it is one; MuJoCo reads nothing or a frame instead."""
        if tag == "attach":
            if not issubclass(self._error, HouseError) or "replicate" in self._tags:
                self._refuse("attach is allowed in a house only, outside of `replicate`.")
            new = attachment_of(self._attached, values)
            self._attachments.append(new)
            replacement = f'<frame name="{new.frame}"/>'.encode()
        elif tag == "model" and values.get("file") and "asset" in self._tags and issubclass(self._error, HouseError):
            self._require_name(values["file"], text.content, start)
            self._models[values.get("name", "")] = self._found(path, values["file"])
            replacement = b""
        else:
            return False
        self._attached += tag == "attach"
        end, is_whole = text.end_of_tag(start)
        if not is_whole:
            self._refuse(f"{tag} has content; it must end with '/>'.")
        text.replace(start, end, replacement)
        return True

    def _require_tag(self, tag: str, *, is_root: bool, included: bool) -> None:
        """Refuses a wrong root element, and capital letters in a tag that MuJoCo reads in any case."""
        if is_root and not included and tag == "robot":
            self._refuse("it is not an MJCF file that MuJoCo can read here but URDF: MuJoCo's `compile` converts it.")
        if is_root and (tag in _READ_AT_ONCE or (not included and tag != "mujoco")):
            self._refuse(f"it is not an MJCF file that MuJoCo can read: its root element is '{printable(tag)}'.")
        if tag.lower() in _READ_AT_ONCE and tag not in _READ_AT_ONCE:
            self._refuse(f"it is not an MJCF file that MuJoCo can read: '{tag}' is written '{tag.lower()}'.")

    def _require_name(self, name: str, content: bytes, start: int) -> None:
        """Refuses a control character in the name of a file: expat reads a line break as a space, but MuJoCo does not.

        Args:
            name: the name as expat reads it.
            content: the content of the file that has the element.
            start: first byte of the element in the content.
        """
        written = _FILE_NAME.search(content, start)
        if printable(name) != name or "\n" in name or "\t" in name or (written and _CONTROL.search(written[0])):
            self._refuse(f"the file name '{printable(name)}' contains a control character.")

    def _found(self, path: Path, name: str) -> Path:
        """Returns the path of a named file: in the folder of the house file, as in MuJoCo, else in that of `path`.

        Raises HouseError if it does not exist or must not be read.
        """
        for folder in dict.fromkeys((self.allowed.file.parent, path.parent)):
            file = path_as_read(folder, name)
            if os.path.lexists(file) or folder == path.parent:
                self.allowed.require(Reference(name, file))
                if file.is_file():
                    return file.resolve()
        return self._refuse(f"it includes '{printable(name)}', but this file does not exist.")

    def _require_small_arrays(self, where: str, tag: str, values: Mapping[str, str]) -> None:
        """Refuses an element with a large array, which MuJoCo would allocate while it reads the file."""
        keys = _LENGTHS.get(tag, ()) + tuple(key for key in values if key in _LENGTHS_ANYWHERE)
        asked = math.prod(max(1.0, number) for key in keys for number in _numbers(values.get(key, "")))
        if asked > MAX_ARRAY:
            self._refuse(f"{printable(where)} asks for {asked:g} numbers; at most {MAX_ARRAY:g} are allowed.")

    def _require_finite(self, where: str, text: str) -> None:
        """Refuses a list of numbers if one of them is not finite or too large."""
        words = text.split()
        others = [word for word in words if not _NOT_FINITE.fullmatch(word)]
        if len(others) < len(words) and _all_numbers(others):
            self._refuse(f"{where} = '{printable(text)}' is not finite.")
        if any(abs(number) > LARGEST for number in _numbers(text)):
            self._refuse(f"{where} = '{printable(text)}' is too large; at most {LARGEST:g} is allowed.")

    def _refuse(self, message: str) -> NoReturn:
        raise self._error(message)


def _require_small_assets(
    spec: mujoco.MjSpec, folder: Path, error: type[ObjectNavError], texture_px: int | None
) -> None:
    """Raises an error if the textures or the files of meshes of a specification are too large."""
    size = sum(_texture_bytes(spec, texture, folder, texture_px) for texture in spec.textures)
    most = _most_texture_bytes(error)
    if size > most:
        raise error(
            f"its textures have {size >> 20} MB; at most {most >> 20} MB are allowed. To allow more, set the "
            f"environment variable {TEXTURE_VARIABLE} to their number."
        )
    assets = (*spec.meshes, *spec.hfields, *spec.skins)
    size = sum(_bytes_of_asset(asset_path(spec, folder, asset.file), 4) for asset in assets if asset.file)
    if size > MAX_ASSET_BYTES:
        raise error(f"its meshes have {size >> 20} MB; at most {MAX_ASSET_BYTES >> 20} MB are allowed.")


def _texture_bytes(spec: mujoco.MjSpec, texture: mujoco.MjsTexture, folder: Path, most_px: int | None) -> int:
    """Returns the bytes of a texture in memory after its images were reduced to `most_px`."""
    channels = max(1, int(texture.nchannel))
    size = max(0, texture.width) * max(0, texture.height) * channels * (6 if texture.type else 1)
    for name in filter(None, (texture.file, *texture.cubefiles)):
        file = asset_path(spec, folder, name, texture=True)
        size += _bytes_of_asset(file, channels if texture.nchannel > 0 else 4, most_px)
    return size


def _most_texture_bytes(error: type[ObjectNavError]) -> int:
    setting = os.environ.get(TEXTURE_VARIABLE, "")
    if setting and not (setting.isascii() and setting.isdigit() and len(setting) < 9):
        raise error(f"{TEXTURE_VARIABLE} must be a number of MB, got '{printable(setting)}'.")
    return int(setting) << 20 if setting else MAX_TEXTURE_BYTES


def _bytes_of_asset(file: Path, bytes_per_pixel: int, most_px: int | None = None) -> int:
    """Returns the bytes of an image in memory, or the size of another file; 0 if it is missing (MuJoCo reports it)."""
    if not file.is_file():
        return 0
    with open_plain(file, what="Asset") as stream:
        width, height = image_size_px(stream.read(1 << 16)) or (0, 0)
    if most_px is not None and max(width, height) > most_px:
        return most_px * most_px * bytes_per_pixel
    return max(width * height * bytes_per_pixel, file.stat().st_size)


def _numbers(text: str) -> list[float]:
    """Returns the numbers of a text, decimal or hexadecimal as in C; an empty list if a word is not a number."""
    try:
        return [float.fromhex(word) if "x" in word.lower() else float(word) for word in text.split()]
    except OverflowError:
        return [math.inf]
    except ValueError:
        return []


def _all_numbers(words: list[str]) -> bool:
    return len(_numbers(" ".join(words))) == len(words)
