"""Loads files of triangles by trimesh, after checks of what they announce: numbers, nodes, loops, pictures, references.

Every use of trimesh's readers goes through `load_scene`, in the import of furniture as in that of homes.
"""

from __future__ import annotations

import importlib
import io
import logging
import posixpath
import struct
from collections import Counter
from collections.abc import Callable, Iterator
from typing import Annotated, Any
from urllib.parse import unquote

from msgspec import Meta, Struct

from sim.core.errors import ConfigError, HouseError, ObjectNavError
from sim.core.pictures import limited_pillow
from sim.core.reading import parse_json, printable, reason_of
from sim.homes.housegen.imported.sources import Skipped

MAX_NUMBERS = 200_000_000
"""Numbers that the accessors of a glTF file, and the parts of its meshes that use them, may have together."""
MAX_NUMBERS_PER_BYTE = 32
"""Their largest ratio to the bytes of the file: parts of a mesh may share bytes, but an accessor needs none at all."""
MAX_NODES = 20_000
MAX_CORNERS = 10_000
"""Vertices of one face."""
_LOST = {
    "KHR_texture_basisu": "A file has pictures in the Basis format, which cannot be read; they became plain colours.",
    "KHR_texture_transform": "A file moves or scales its pictures, which is not read; patterns have another size.",
    "EXT_texture_webp": "A file has pictures in the WebP format, which may have been left out.",
}
_REFUSED = {
    "KHR_draco_mesh_compression": "Draco", "EXT_meshopt_compression": "meshopt", "KHR_meshopt_compression": "meshopt",
}  # fmt: skip
_SILENT = logging.NullHandler()
_COMPONENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
_PLY_BYTES = {
    b"char": 1, b"uchar": 1, b"int8": 1, b"uint8": 1, b"short": 2, b"ushort": 2, b"int16": 2, b"uint16": 2,
    b"double": 8, b"float64": 8,
}  # fmt: skip
"""Bytes of the types that have other than four."""
_Index = Annotated[int, Meta(ge=0)]


def library(name: str, *, extra: str = "models") -> Any:
    """Returns a package of an extra; raises ConfigError if it is not installed."""
    try:
        return importlib.import_module(name)
    except ImportError:
        raise ConfigError(
            f"Reading models needs the package '{name}', which is not installed: pip install "
            f"'stubborn-objectnav[{extra}]'."
        ) from None


def load_scene(
    content: bytes, kind: str, *, where: str, most: int, read: Callable[[str], bytes], losses: Counter[str],
    extra: str = "models",
) -> Any:  # fmt: skip
    """Returns trimesh's scene of a file; `metadata["names"]` has the names of glTF nodes by trimesh's.

    Args:
        content: of the file.
        kind: its format, as trimesh names it.
        where: name of the file for the error message.
        most: largest number of triangles and of vertices; those of a mesh count for each node that shows it.
        read: returns the content of a file that this one names; raises Skipped if it is missing.
        losses: gets sentences on the losses, among them the pictures that were refused.
        extra: the extra of this project that contains trimesh.

    Raises:
        HouseError: the file cannot be read or announces too much; one line.
        ConfigError: trimesh is not installed.
    """
    trimesh, names = library("trimesh", extra=extra), dict[str, str]()
    if kind in ("glb", "gltf"):
        names = _node_names(content, kind, where, read, losses)
    elif kind == "ply":
        _require_sane_ply(content, where)
    logging.getLogger("trimesh").addHandler(_SILENT)  # else Python prints its tracebacks of pictures that are missing
    try:
        with limited_pillow(lambda sentence: losses.update([sentence])):
            scene = trimesh.load_scene(
                io.BytesIO(content), file_type=kind, resolver=_resolver(trimesh, read, ""), process=False
            )
        sizes = {name: _size(mesh) for name, mesh in scene.geometry.items()}
        total = sum(sizes[scene.graph[node][1]] for node in scene.graph.nodes_geometry)
    except ObjectNavError:
        raise
    except Exception as error:  # a reader meets any error in a broken file
        raise HouseError(
            f"{where} cannot be read ({type(error).__name__}: {printable(reason_of(error))[:100]})."
        ) from None
    if total > most:
        raise HouseError(f"{where} has more than {most:,} triangles or vertices.")
    scene.metadata["names"] = names
    return scene


def _size(mesh: Any) -> int:
    """Returns the number of triangles or of vertices, the larger one."""
    return max(len(getattr(mesh, "faces", ())), len(getattr(mesh, "vertices", ())))


def _resolver(trimesh: Any, read: Callable[[str], bytes], folder: str) -> Any:
    """Returns trimesh's access to the files that a model names: materials, textures, buffers."""

    class Inside(trimesh.resolvers.Resolver):
        def __init__(self) -> None: ...

        def get(self, name: str) -> bytes:
            try:
                return read(posixpath.join(folder, str(name).strip().replace("\\", "/")))
            except Skipped as error:  # trimesh goes without a material or a picture that is missing
                raise FileNotFoundError(str(error)) from None

        def write(self, name: str, data: object) -> None:
            raise PermissionError(name)

        def keys(self) -> list[str]:
            return []

        def namespaced(self, namespace: str) -> Any:
            return _resolver(trimesh, read, posixpath.join(folder, namespace))

    return Inside()


# ---- limits before decoding -----------------------------------------------------------------------------------------


class _Accessor(Struct):
    count: _Index = 0
    type: str = "MAT4"

    @property
    def numbers(self) -> int:
        return self.count * _COMPONENTS.get(self.type, 16)


class _Node(Struct):
    children: list[int] = []
    name: str = ""
    mesh: _Index | None = None


class _Primitive(Struct):
    attributes: dict[str, _Index] = {}
    indices: _Index | None = None


class _Mesh(Struct):
    primitives: list[_Primitive] = []
    name: str = ""


class _Part(Struct):
    uri: str = ""

    @property
    def file(self) -> str | None:
        """The file that it names; None if its bytes are in the glTF file."""
        return None if not self.uri or self.uri.startswith("data:") else unquote(self.uri)


class _Parts(Struct):
    buffers: list[_Part] = []
    images: list[_Part] = []


class _Gltf(_Parts):
    accessors: list[_Accessor] = []
    meshes: list[_Mesh] = []
    nodes: Annotated[list[_Node], Meta(max_length=MAX_NODES)] = []
    extensionsRequired: list[str] = []
    extensionsUsed: list[str] = []


def gltf_parts(content: bytes, where: str) -> Iterator[str]:
    """Yields the names of files of buffers and pictures in a .gltf file; raises HouseError if it cannot be read."""
    parts = parse_json(content, _Parts, where=where, error=HouseError)
    yield from filter(None, (part.file for part in (*parts.buffers, *parts.images)))


def _node_names(
    content: bytes, kind: str, where: str, read: Callable[[str], bytes], losses: Counter[str]
) -> dict[str, str]:
    """Returns the names of the nodes of a glTF file, by those that trimesh gives to them.

    A node without a name, which trimesh calls by its number, has the name of its mesh and that number.

    Raises HouseError if the file announces too much, is compressed, or has a loop of nodes.
    """
    text = content
    if kind == "glb":
        if len(content) < 20 or content[:4] != b"glTF":
            raise HouseError(f"{where} is not a GLB file.")
        length, chunk = struct.unpack("<I4s", content[12:20])
        if chunk != b"JSON" or length > len(content) - 20:
            raise HouseError(f"{where} is a damaged GLB file: its first part is incomplete.")
        text = content[20 : 20 + length].rstrip(b"\0 ")
    document = parse_json(text, _Gltf, where=where, error=HouseError)
    try:
        available = len(content) + sum(len(read(part.file)) for part in document.buffers if part.file)
    except Skipped as missing:
        raise HouseError(f"{where} cannot be read: {str(missing).rstrip('.')}.") from None
    most = min(MAX_NUMBERS, MAX_NUMBERS_PER_BYTE * available)
    if _numbers(document) > most:
        raise HouseError(f"{where} announces more than {most:,} numbers, the limit for {available:,} bytes.")
    for name in document.extensionsRequired:
        if name in _REFUSED:
            raise HouseError(f"{where} is compressed by {_REFUSED[name]}, which cannot be read; decompress it first.")
    for name in {*document.extensionsRequired, *document.extensionsUsed} & set(_LOST):
        losses[_LOST[name]] += 1
    _require_tree([node.children for node in document.nodes], where)
    meshes = document.meshes
    unnamed = {
        str(number): f"{meshes[node.mesh].name}_{number}"
        for number, node in enumerate(document.nodes)
        if not node.name and node.mesh is not None and node.mesh < len(meshes) and meshes[node.mesh].name
    }
    return unnamed | {node.name: node.name for node in document.nodes if node.name}


def _numbers(document: _Gltf) -> int:
    """Returns how many numbers trimesh would make of the accessors and of the parts of meshes, which copy them."""
    counts = [accessor.numbers for accessor in document.accessors]
    uses = (
        index
        for mesh in document.meshes
        for part in mesh.primitives
        for index in (*part.attributes.values(), part.indices)
        if index is not None and index < len(counts)
    )
    return sum(counts) + sum(counts[index] for index in uses)


def _require_tree(children: list[list[int]], where: str) -> None:
    """Raises HouseError if a node has two parents or is below itself, or names a node that does not exist."""
    named = Counter(child for nodes in children for child in nodes)
    if any(not 0 <= child < len(children) for child in named):
        raise HouseError(f"{where}: a node has a child that does not exist.")
    if any(count > 1 for count in named.values()):
        raise HouseError(f"{where}: a node is the child of several nodes.")
    seen, todo = 0, [n for n in range(len(children)) if n not in named]
    while todo:
        seen += 1
        todo += children[todo.pop()]
    if seen < len(children):  # each has one parent: those that are not reached are in a loop
        raise HouseError(f"{where}: its nodes form a loop.")


def _require_sane_ply(content: bytes, where: str) -> None:
    """Raises HouseError if a PLY file announces more elements than it has bytes, or has a polygon of many corners."""
    end = content.find(b"end_header") + 1 or 1 << 16
    element, count, faces, others = b"", 0, 1, 0  # `others`: bytes of the elements that are not faces
    for words in (line.split() for line in content[: min(end, 1 << 16)].splitlines()):
        if words[:1] == [b"element"] and len(words) == 3 and words[2].isdigit():
            element, count = words[1], int(words[2][:20])
            if count > len(content):
                raise HouseError(f"{where} announces {count} elements, but has {len(content)} bytes.")
            faces = max(1, count) if element == b"face" else faces
        elif words[:1] == [b"property"] and len(words) == 3 and element != b"face":
            others += count * _PLY_BYTES.get(words[1], 4)
    if b"format ascii" in content[:100]:
        face_bytes = max(map(len, content[end:].splitlines()), default=0)
    else:
        face_bytes = (len(content) - end - others) // faces
    if face_bytes > 16 * MAX_CORNERS:
        raise HouseError(f"{where} has a face with more than {MAX_CORNERS:,} vertices.")
