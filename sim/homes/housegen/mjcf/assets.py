"""Writes materials, textures and meshes into an `MjSpec`, equal ones once."""

from __future__ import annotations

import numpy as np

from sim.gl import mujoco
from sim.homes.housegen.furniture.item import Look, MeshShape
from sim.homes.housegen.surfaces.materials import texture_file, texture_mapping

MESH_UNIT_M = 1e-3
"""Mesh vertices are written as whole multiples of this length, which takes half the bytes of metres."""


class AssetTable:
    """The materials, textures and meshes of one specification."""

    def __init__(self, spec: mujoco.MjSpec) -> None:
        self._spec = spec
        self._materials: dict[Look, str] = {}
        self._textures: set[str] = set()
        self._meshes: dict[str, str] = {}

    def material(self, look: Look) -> str:
        """Returns the name of the material of a look."""
        if look in self._materials:
            return self._materials[look]
        name = f"m{len(self._materials):02d}"
        self._materials[look] = name
        material = self._spec.add_material(
            name=name, rgba=[round(v, 3) for v in look.rgba], specular=look.specular, shininess=look.shininess,
            emission=look.emission,
        )  # fmt: skip
        if look.texture is not None:
            textures = list(material.textures)
            textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = self._texture(look.texture)
            material.textures = textures
            uniform, repeat = texture_mapping(look)
            material.texuniform = uniform
            material.texrepeat = [repeat, repeat]
        return name

    def _texture(self, name: str) -> str:
        if name not in self._textures:
            self._textures.add(name)
            self._spec.add_texture(name=name, type=mujoco.mjtTexture.mjTEXTURE_2D, file=texture_file(name))
        return name

    def mesh(self, mesh: MeshShape) -> str:
        """Returns the name of a mesh in the file; it is short, because each geom of the mesh repeats it."""
        if mesh.name not in self._meshes:
            name = f"{mesh.name.split('_')[0]}{len(self._meshes)}"
            self._meshes[mesh.name] = name
            made = self._spec.add_mesh(name=name)
            made.uservert = np.rint(mesh.vertices_m / MESH_UNIT_M).ravel().tolist()
            if len(mesh.faces):
                made.userface = mesh.faces.astype(int).ravel().tolist()
            if mesh.texture_uv is not None:
                made.usertexcoord = mesh.texture_uv.ravel().tolist()
        return self._meshes[mesh.name]
