"""Checks which other files an MJCF file may read: those of its own folder, and of folders that the user allows.

MuJoCo opens every path that a file names: of an included file, a mesh or a texture. A file from another source is data
and must not choose paths: `<include file="../../x.xml"/>` and `<mesh file="/home/me/x.obj"/>` are refused, also if they
are symbolic links. Textures may also be in `../textures`, which the houses of a split share, and in the shipped folder.
The user allows one more folder with `--root FOLDER`, for packages that consist of several folders.
"""

from __future__ import annotations

import functools
import hashlib
import html
import os
import re
import stat
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from sim.core.errors import HouseError, ObjectNavError
from sim.core.paths import assets_dir
from sim.core.reading import printable, read_bytes, sha256_of
from sim.gl import mujoco
from sim.houses.mjcf_text import as_utf8

if TYPE_CHECKING:
    from hashlib import _Hash as Hash

SHARED_TEXTURES = "textures"
"""Name of the folder, next to a split's folder, that all its houses may use."""
MAX_FILES = 10_000
"""Largest number of files of a house for which checksums are computed."""
_MAX_FOLDERS = 20
_MAX_BYTES = 64 << 20
_VALUE = rb"""\s*=\s*(?P<value>"[^"]*"|'[^']*')"""
_FILE = re.compile(rb"file\w*" + _VALUE)
_FOLDER = re.compile(rb"dir" + _VALUE)
_FOLDER_STEMS = (b"mesh", b"texture", b"asset")
_WORD = re.compile(rb"\w")
_ASSETS = frozenset((".png", ".jpg", ".jpeg", ".obj", ".stl", ".msh", ".ktx", ".bin", ".skn"))
"""Suffixes of files that name no other files."""
_ELSEWHERE = re.compile(r":[/\\]|^\\|\.(?:zip|mjz)(?:[/\\]|$)", re.IGNORECASE)
"""Names that are absolute for MuJoCo but not for the operating system, and names of MuJoCo's archives."""
MAX_LEVELS_UP = 3
"""A folder that a refusal proposes for `--root` is at most this many levels above the file."""


@dataclass(frozen=True)
class Reference:
    """A path that a file of a house names."""

    name: str
    """The path as the file writes it."""
    path: Path
    """The path at which MuJoCo looks for it."""
    folder: str = ""
    """The folder that the file gives for it, for example by `meshdir`."""


@dataclass(frozen=True)
class Allowed:
    """The folders from which one MJCF file may read."""

    file: Path
    """The MJCF file, as an absolute path without symbolic links."""
    root: Path | None
    """The additional folder that the user allows; None: no other."""
    error: type[ObjectNavError]
    """Class of the error; only a HouseError concerns a house, for which `--root` exists."""

    @property
    def folders(self) -> list[Path]:
        """The folders, without symbolic links; all files below them are allowed."""
        folder = self.file.parent
        textures = [folder.parent / SHARED_TEXTURES, (assets_dir() / SHARED_TEXTURES).resolve()]
        return [folder, *textures, *([] if self.root is None else [self.root.resolve()])]

    def require(self, reference: Reference) -> None:
        """Raises an error if another file must not be read.

        Args:
            reference: the other file, which need not exist.

        Raises:
            ObjectNavError: of class `error`; the path leads out of the allowed folders or is not a regular file.
        """
        name = printable(reference.name)
        joined = f"{reference.folder}/{reference.name}" if reference.folder else reference.name
        if _ELSEWHERE.search(joined) or reference.name.startswith("\\"):
            raise self.error(
                f"it uses '{printable(joined)}': a drive, an address or a file in an archive is not read; unpack the "
                "archive, and name files by paths relative to this one."
            )
        try:
            target = reference.path.resolve()
            is_special = target.exists() and not target.is_file()
        except (OSError, ValueError, RuntimeError):
            raise self.error(f"it uses '{name}', which is not the name of a file.") from None
        if not any(target.is_relative_to(folder) for folder in self.folders):
            where = "its folder" if self.root is None else f"its folder and '{self.root}'"
            raise self.error(f"it uses '{name}', which is outside of {where}. {self._remedy(target)}")
        if is_special:
            raise self.error(f"it uses '{name}', which is not a regular file.")

    def _remedy(self, target: Path) -> str:
        """Returns a sentence on how the user can allow the file if it is near the house file, else the rule."""
        if not issubclass(self.error, HouseError):
            return "Copy all files of a robot into one folder, or allow the folder of both with --root."
        common = Path(os.path.commonpath((target, self.file)))
        levels = len(self.file.parent.relative_to(common).parts)
        if levels <= MAX_LEVELS_UP and len(common.parts) > 1:
            return f"If you trust this file, give it by --house and allow the folder of both: --root '{common}'."
        return "A house may use files of its own folder, and those of the folder given with --root."


def asset_references(spec: mujoco.MjSpec, folder: Path) -> Iterator[Reference]:
    """Yields the files of meshes, height fields, skins and textures of a specification.

    Args:
        spec: of a file in `folder`.
        folder: paths are relative to it.
    """
    for asset in (*spec.meshes, *spec.hfields, *spec.skins):
        if asset.file:
            yield Reference(asset.file, asset_path(spec, folder, asset.file), spec.meshdir or "")
    for texture in spec.textures:
        for name in (texture.file, *texture.cubefiles):
            if name:
                yield Reference(name, asset_path(spec, folder, name, texture=True), spec.texturedir or "")


def asset_path(spec: mujoco.MjSpec, folder: Path, name: str, *, texture: bool = False) -> Path:
    """Returns where MuJoCo looks for the file of a mesh or of a texture."""
    if spec.strippath:
        name = name.replace("\\", "/").rpartition("/")[2]
    return path_as_read(folder, (spec.texturedir if texture else spec.meshdir) or "", name)


def path_as_read(folder: Path, *names: str) -> Path:
    """Returns the path that MuJoCo opens for names in a file of a folder.

    MuJoCo also separates folders by backslashes, and it removes `..` before the file system follows symbolic links:
    `link/../x.xml` is `x.xml`.
    """
    return Path(os.path.normpath(os.path.join(folder, *(name.replace("\\", "/") for name in names))))


def require_root(root: Path | None) -> None:
    """Raises a HouseError if the folder of `--root` does not exist."""
    if root is not None and not root.is_dir():
        raise HouseError(f"--root '{root}' must be an existing folder.")


def files_of(house_file: Path, root: Path | None = None, *, require_all: bool = False) -> list[Path]:
    """Returns the files that an MJCF file and its included files use, sorted; shipped files do not count.

    The text is searched for names of files without MuJoCo. The result may therefore contain a file that is not used.
    Files that it may not read (`Allowed`) are left out and are not opened.

    Args:
        house_file: the MJCF file.
        root: another folder that the house may use.
        require_all: whether it is an error that there are too many names and folders to try them all.

    Raises:
        HouseError: there are too many, and all are required.
    """
    shipped, house_file = assets_dir().resolve(), house_file.resolve()
    allowed = Allowed(house_file, root, HouseError).folders
    read: set[Path] = set()
    files = {house_file}
    names: dict[str, None] = {}
    folders: dict[str, None] = {"": None}
    bases: dict[Path, None] = {}
    while waiting := [file for file in sorted(files - read) if file.suffix.lower() not in _ASSETS]:
        for file in waiting:
            read.add(file)
            bases[file.parent] = None
            text = _content(file)
            names.update(dict.fromkeys(_values(_FILE, text, (b"",))))
            folders.update(dict.fromkeys(_values(_FOLDER, text, _FOLDER_STEMS)))
        for base in list(bases)[:_MAX_FOLDERS]:  # in the folder of the house file, or of the file that names it
            for folder in list(folders)[:_MAX_FOLDERS]:
                for name in list(names)[:MAX_FILES]:
                    for spelling in {name, name.replace("\\", "/").rpartition("/")[2]}:
                        path = path_as_read(base, folder, spelling)
                        if _is_plain(path) and not path.is_relative_to(shipped) and _is_below(path, allowed):
                            files.add(path)
    if require_all and (max(len(bases), len(folders)) > _MAX_FOLDERS or len(names) > MAX_FILES):
        raise HouseError(f"its files are in more than {_MAX_FOLDERS} folders, or are more than {MAX_FILES}.")
    return sorted(files - {house_file})


def add_files(digest: Hash, house_file: Path, root: Path | None = None) -> None:
    """Adds the names and the contents of the files that an MJCF file uses to a checksum.

    Raises:
        HouseError: a file cannot be read, or there are too many to find them all.
    """
    for file in files_of(house_file, root, require_all=True):
        digest.update(os.path.relpath(file, house_file.resolve().parent).encode(errors="replace"))
        digest.update(bytes.fromhex(sha256_of(file, what="File of a house", error=HouseError)))


@functools.cache
def shipped_textures_sum() -> str:
    """Returns a checksum of the shipped textures, which do not count as files of a house."""
    digest = hashlib.sha256()
    for file in sorted((assets_dir() / SHARED_TEXTURES).iterdir()):
        digest.update(file.name.encode() + file.read_bytes())
    return digest.hexdigest()


def _is_below(path: Path, folders: list[Path]) -> bool:
    target = path.resolve()
    return any(target.is_relative_to(folder) for folder in folders)


def _content(file: Path) -> bytes:
    try:
        return as_utf8(read_bytes(file, what="File", most=_MAX_BYTES))
    except (ObjectNavError, ValueError):
        return b""  # `read_spec` reports the fault


def _values(attribute: re.Pattern[bytes], text: bytes, stems: tuple[bytes, ...]) -> list[str]:
    """Returns the values of the attributes that begin with one of some stems, followed by a pattern.

    The pattern itself begins with letters, so that it is found several times as fast as one that begins with a stem.
    """
    return [
        html.unescape(match["value"][1:-1].decode(errors="replace"))
        for match in attribute.finditer(text)
        if any(_begins(text, match.start(), stem) for stem in stems)
    ]


def _begins(text: bytes, end: int, stem: bytes) -> bool:
    """Returns whether a word of a text begins with a stem that ends at this index."""
    start = end - len(stem)
    return text[max(start, 0) : end] == stem and not _WORD.match(text, max(start - 1, 0), start)


def _is_plain(path: Path) -> bool:
    try:
        return stat.S_ISREG(path.stat().st_mode)
    except (OSError, ValueError):
        return False
