"""Lays a drawn ground into the specification of a house."""

from __future__ import annotations

import numpy as np

from sim.gl import mujoco
from sim.homes.housegen.ground.draw import Ground, Piece
from sim.homes.housegen.ground.survey import axis_sizes, ground_slabs
from sim.houses.labels import COVER_MASK

WATER = "water"
"""Name of the material of wet spots."""
_COVER = "cover"
"""Default class of pieces that only wheels and casters touch."""
_WATER_RGBA = (0.72, 0.80, 0.84, 0.22)


def lay(spec: mujoco.MjSpec, ground: Ground) -> None:
    """Makes the floors of the rooms solid in place of the slab below them, and adds rugs and pieces; changes `spec`."""
    for slab in ground_slabs(spec):
        spec.delete(slab)
    for body, friction in ground.friction.items():
        for geom in spec.body(body).geoms:
            geom.contype = geom.conaffinity = 1
            geom.friction[0] = friction
    for body, scale in ground.rug_scale.items():
        for geom in spec.body(body).geoms:
            _scale(geom, scale)
    cover = spec.add_default(_COVER, spec.default)
    cover.geom.group = 3
    cover.geom.contype, cover.geom.conaffinity = COVER_MASK
    if any(piece.material == WATER for piece in ground.pieces):
        spec.add_material(name=WATER, rgba=_WATER_RGBA, specular=0.9, shininess=0.9)
    for piece in ground.pieces:
        _add(spec, piece, cover)


def _scale(geom: mujoco.MjsGeom, factor: float) -> None:
    """Changes the height of a part of a rug; a mesh keeps its own height and is moved."""
    geom.pos[2] = round(geom.pos[2] * factor, 5)
    if geom.type == mujoco.mjtGeom.mjGEOM_CYLINDER:
        geom.size[1] = round(geom.size[1] * factor, 5)
    elif geom.type == mujoco.mjtGeom.mjGEOM_BOX:
        upright = int(np.argmin(np.abs(geom.size - axis_sizes(geom)[2])))
        geom.size[upright] = round(geom.size[upright] * factor, 5)


def _add(spec: mujoco.MjSpec, piece: Piece, cover: mujoco.MjsDefault) -> None:
    kind = mujoco.mjtGeom.mjGEOM_CYLINDER if len(piece.size_m) == 2 else mujoco.mjtGeom.mjGEOM_BOX
    geom = spec.body(piece.body).add_geom(cover, type=kind)
    geom.pos, geom.quat = piece.pos_m, piece.quat
    geom.size = [*piece.size_m, 0.0][:3]
    geom.friction[0] = piece.friction
    if piece.material:
        geom.material, geom.group = piece.material, 0
