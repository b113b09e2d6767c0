"""Makes assets with Infinigen's generators; runs in the user's environment, where `infinigen` and `bpy` are installed.

Each line on stdin is a request in JSON: `factory` ("seating.ChairFactory", below `infinigen.assets.objects`), `seed`,
`file` (a GLB file to write), `two_sided`, `upright`, `triangles` (largest number), `options` (arguments of the class)
and `dimensions_m` (None, or ranges of depth, width and height from which its argument `dimensions` is drawn). Each line
on stdout answers one request: `extent_m`, `triangles`, or `error`. A first line says that the worker is ready. All
other output goes to stderr.

Colours: every shader is replaced by an emission of its base colour, which Cycles bakes into the vertices; a material
gets the mean colour of its triangles. Patterns and roughness are lost. Colours in the file are sRGB values, as `rgba`
of MuJoCo, although glTF would have linear ones. The file has y up and the front of Infinigen's assets (+x) towards +z.
"""

# This script runs outside of the project: it must not import `sim`.
from __future__ import annotations

import importlib
import json
import os
import sys
import traceback
from collections.abc import Mapping
from typing import Any

import numpy as np

SEE_THROUGH = ("BSDF_GLASS", "BSDF_REFRACTION")
"""Shaders of glass."""
GLASS_RGBA = (0.75, 0.85, 0.9, 0.3)
OBJECTS = "infinigen.assets.objects"


def main() -> int:
    """Answers requests until stdin ends; returns 0."""
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # Blender prints to the stdout of the process
    bpy = importlib.import_module("bpy")
    print(json.dumps({"ready": bpy.app.version_string}), file=answers, flush=True)
    for line in sys.stdin:
        try:
            answer = make(bpy, json.loads(line))
        except Exception as error:  # a generator may raise anything
            traceback.print_exc()
            answer = {"error": f"{type(error).__name__}: {str(error)[:200]}"}
        print(json.dumps(answer), file=answers, flush=True)
    return 0


def make(bpy: Any, request: Mapping[str, Any]) -> dict[str, object]:
    """Makes and writes one asset; returns the answer."""
    butil = importlib.import_module("infinigen.core.util.blender")
    fixed_seed = importlib.import_module("infinigen.core.util.math").FixedSeed
    butil.clear_scene()
    module, _, name = request["factory"].rpartition(".")
    factory_type = getattr(importlib.import_module(f"{OBJECTS}.{module}"), name)
    options = dict(request["options"])
    if request["dimensions_m"]:
        low, high = np.array(request["dimensions_m"]).T
        options["dimensions"] = tuple(np.random.default_rng(request["seed"]).uniform(low, high).tolist())
    with fixed_seed(request["seed"]):
        factory = factory_type(request["seed"], **options)
        asset = factory.spawn_asset(request["seed"])
        factory.finalize_assets(asset)
    whole = joined(bpy, asset)
    reduce_triangles(bpy, whole, request["triangles"])
    turn_outwards(whole)
    vertices, faces, slots = arrays_of(whole)
    colours = colours_of(bpy, whole, vertices, faces, slots)
    if request["upright"]:
        vertices = vertices[:, [2, 0, 1]]
    write_glb(request["file"], vertices, faces, slots, colours, two_sided=request["two_sided"])
    extent = np.ptp(vertices[np.unique(faces)], axis=0)
    return {"extent_m": [round(float(side), 4) for side in extent], "triangles": len(faces)}


def joined(bpy: Any, asset: Any) -> Any:
    """Returns one mesh object in world coordinates of an asset, its children and its instances; removes the others."""
    family = {asset, *asset.children_recursive}
    bpy.context.view_layer.update()
    graph = bpy.context.evaluated_depsgraph_get()
    objects_found = []
    for instance in graph.object_instances:
        owner = instance.parent if instance.is_instance else instance.object
        if owner is None or owner.original not in family or instance.object.type not in ("MESH", "CURVE", "SURFACE"):
            continue
        if instance.object.original.hide_render and not instance.is_instance:
            continue
        mesh = bpy.data.meshes.new_from_object(instance.object, depsgraph=graph)
        if len(mesh.polygons):
            mesh.transform(instance.matrix_world.copy())
            objects_found.append(mesh)
    if not objects_found:
        raise ValueError("the asset has no triangles")
    for element in list(bpy.data.objects):
        bpy.data.objects.remove(element)
    objects = [bpy.data.objects.new(f"part_{n}", mesh) for n, mesh in enumerate(objects_found)]
    plain = bpy.data.materials.new("plain")
    plain.use_nodes = True
    for element in objects:
        bpy.context.scene.collection.objects.link(element)
        element.select_set(True)
        if not element.data.materials:
            element.data.materials.append(plain)
        for slot in element.material_slots:  # Cycles does not bake an empty slot
            slot.material = slot.material or plain
    bpy.context.view_layer.objects.active = objects[0]
    if len(objects) > 1:
        bpy.ops.object.join()
    return objects[0]


def reduce_triangles(bpy: Any, whole: Any, most: int) -> None:
    """Reduces an object to about a number of triangles."""
    whole.data.calc_loop_triangles()
    count = len(whole.data.loop_triangles)
    if count > most:
        whole.modifiers.new("fewer", "DECIMATE").ratio = most / count
        bpy.ops.object.modifier_apply(modifier="fewer")


def turn_outwards(whole: Any) -> None:
    """Turns the triangles of each connected piece outwards: some generators make tops that show their inside."""
    bmesh = importlib.import_module("bmesh")
    mesh = bmesh.new()
    mesh.from_mesh(whole.data)
    bmesh.ops.recalc_face_normals(mesh, faces=mesh.faces)
    mesh.to_mesh(whole.data)
    mesh.free()


def arrays_of(whole: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Returns vertices (n, 3) in metres, triangles (m, 3) and the material of each triangle (m,)."""
    mesh = whole.data
    mesh.calc_loop_triangles()
    vertices = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    mesh.vertices.foreach_get("co", vertices)
    faces = np.empty(3 * len(mesh.loop_triangles), dtype=np.int32)
    mesh.loop_triangles.foreach_get("vertices", faces)
    slots = np.empty(len(mesh.loop_triangles), dtype=np.int32)
    mesh.loop_triangles.foreach_get("material_index", slots)
    return vertices.reshape(-1, 3).astype(float), faces.reshape(-1, 3), slots


# ---- colours ---------------------------------------------------------------------------------------------------------


def colours_of(
    bpy: Any, whole: Any, vertices: np.ndarray, faces: np.ndarray, slots: np.ndarray
) -> dict[int, tuple[float, ...]]:
    """Returns the sRGB colour and the opacity of each material that has triangles."""
    materials = [slot.material for slot in whole.material_slots]
    glass = {n for n, material in enumerate(materials) if is_glass(material)}
    seen: set[int] = set()
    for material in materials:
        if material.use_nodes:
            emit_base_colours(material.node_tree, seen)
    baked = bake(bpy, whole)
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    weights = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1) + 1e-12
    of_face = np.clip(np.nan_to_num(baked[faces].mean(axis=1)), 0.0, 1.0)
    colours: dict[int, tuple[float, ...]] = {}
    for slot in np.unique(slots):
        mine = slots == slot
        linear = (of_face[mine] * weights[mine, None]).sum(axis=0) / weights[mine].sum()
        srgb = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
        colours[int(slot)] = GLASS_RGBA if slot in glass else (*(round(float(v), 3) for v in srgb), 1.0)
    return colours


def is_glass(material: Any) -> bool:
    """Returns whether one sees through most of a material."""
    if not material.use_nodes:
        return False
    nodes = list(material.node_tree.nodes)
    for node in nodes:
        if node.type == "GROUP" and node.node_tree:
            nodes += list(node.node_tree.nodes)
    through = [node for node in nodes if node.type == "BSDF_PRINCIPLED" and transmission(node) > 0.5]
    return bool(through) or any(node.type in SEE_THROUGH for node in nodes)


def transmission(node: Any) -> float:
    """Returns the transmission of a principled shader; 0 where it depends on other nodes."""
    socket = node.inputs.get("Transmission Weight")
    return 0.0 if socket is None or socket.is_linked else float(socket.default_value)


def emit_base_colours(tree: Any, seen: set[int]) -> None:
    """Replaces every shader in a tree of nodes, and in its groups, by an emission of its base colour."""
    if tree.as_pointer() in seen:  # trees of materials share one name
        return
    seen.add(tree.as_pointer())
    for node in list(tree.nodes):
        if node.type == "GROUP" and node.node_tree:
            emit_base_colours(node.node_tree, seen)
        elif node.type == "TEX_BRICK":
            node.inputs["Mortar Size"].default_value = 0.0  # without texture coordinates, all of it is black mortar
        elif node.type == "EMISSION":
            for link in list(node.inputs["Strength"].links):
                tree.links.remove(link)
            node.inputs["Strength"].default_value = 1.0
        elif node.type.startswith("BSDF_") or node.type == "SUBSURFACE_SCATTERING":
            socket = node.inputs.get("Base Color") or node.inputs.get("Color")
            if socket is None:
                continue
            emission = tree.nodes.new("ShaderNodeEmission")
            emission.inputs["Color"].default_value = tuple(socket.default_value)
            for link in list(socket.links):
                tree.links.new(link.from_socket, emission.inputs["Color"])
            for link in list(node.outputs[0].links):
                tree.links.new(emission.outputs[0], link.to_socket)


def bake(bpy: Any, whole: Any) -> np.ndarray:
    """Returns the linear colour that each vertex emits, (n, 3)."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.samples = 1
    scene.render.threads_mode, scene.render.threads = "FIXED", 1
    scene.render.bake.target = "VERTEX_COLORS"
    scene.render.bake.use_clear = True
    for attribute in list(whole.data.color_attributes):
        if attribute.name == "baked":
            whole.data.color_attributes.remove(attribute)
    made = whole.data.color_attributes.new("baked", "FLOAT_COLOR", "POINT")
    whole.data.color_attributes.active_color = made
    bpy.ops.object.select_all(action="DESELECT")
    whole.select_set(True)
    bpy.context.view_layer.objects.active = whole
    bpy.ops.object.bake(type="EMIT")
    values = np.empty(4 * len(whole.data.vertices), dtype=np.float32)
    whole.data.color_attributes["baked"].data.foreach_get("color", values)
    return values.reshape(-1, 4)[:, :3].astype(float)


def write_glb(
    file: str, vertices: np.ndarray, faces: np.ndarray, slots: np.ndarray, colours: dict[int, tuple[float, ...]], *,
    two_sided: bool,
) -> None:  # fmt: skip
    """Writes a GLB file with a mesh for each material."""
    trimesh = importlib.import_module("trimesh")
    scene = trimesh.Scene()
    for slot, rgba in colours.items():
        used, corners = np.unique(faces[slots == slot], return_inverse=True)
        material = trimesh.visual.material.PBRMaterial(
            baseColorFactor=rgba, doubleSided=two_sided, alphaMode="OPAQUE" if rgba[3] == 1.0 else "BLEND"
        )
        mesh = trimesh.Trimesh(vertices[used][:, [1, 2, 0]], corners.reshape(-1, 3), process=False)
        mesh.visual = trimesh.visual.TextureVisuals(uv=np.zeros((len(used), 2)), material=material)
        scene.add_geometry(mesh)
    temporary = f"{file}.part"
    with open(temporary, "wb") as stream:
        stream.write(scene.export(file_type="glb"))
    os.replace(temporary, file)


if __name__ == "__main__":
    sys.exit(main())
