"""Conformance tests of every furniture style, in the pool that shows it."""

from __future__ import annotations

import itertools
from functools import cache

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.core.interface import GOAL_CATEGORIES, MPCAT40
from sim.core.paths import assets_dir
from sim.gl import mujoco
from sim.homes.housegen.furniture import CATALOGUE
from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.item import Child, Geom, Item, Look, Pool
from sim.homes.housegen.furniture.shapes import MAX_VERTICES
from sim.homes.housegen.furniture.transforms import euler_from_matrix, geom_bounds, matrix_from_euler
from sim.homes.housegen.surfaces import materials
from sim.homes.housegen.surfaces.textures import TEXTURES
from tests.helpers.sampling import sample

STYLES = CATALOGUE.all_styles
SEEDS = (0, 1, 2)
TOUCH_M = 0.01
FAR_M = 0.05
"""Largest distance that is measured."""
EXACT_WIDTHS = (
    "curtain", "blinds", "counter", "railing", "floor", "picture", "mirror", "board_panel", "shelving",
)  # fmt: skip
SHAPES = {
    "box": mujoco.mjtGeom.mjGEOM_BOX,
    "cylinder": mujoco.mjtGeom.mjGEOM_CYLINDER,
    "sphere": mujoco.mjtGeom.mjGEOM_SPHERE,
    "capsule": mujoco.mjtGeom.mjGEOM_CAPSULE,
    "ellipsoid": mujoco.mjtGeom.mjGEOM_ELLIPSOID,
    "mesh": mujoco.mjtGeom.mjGEOM_MESH,
}
every_style = pytest.mark.parametrize("style", sample(STYLES, 100), ids=lambda s: f"{s.category}-{s.name}")


@cache
def items(style: Style) -> tuple[Item, ...]:
    """Returns some items of a style, which need not be in the shipped catalogue."""
    return tuple(item_of(style, seed) for seed in SEEDS)


def item_of(style: Style, seed: int) -> Item:
    catalogue = CATALOGUE.replacing(style.category, style)
    return catalogue.make_item(style.category, np.random.default_rng(seed), pool=style.pool, style=style.name)


def names(category: str, pool: Pool, use: str | None = None) -> list[str]:
    return [style.name for style in CATALOGUE.styles(category, pool, use)]


def with_children(item: Item) -> list[Item]:
    return [item, *itertools.chain.from_iterable(with_children(child.item) for child in item.children)]


def all_geoms(item: Item) -> list[Geom]:
    return [geom for part in with_children(item) for geom in part.geoms]


def add_body(spec: mujoco.MjSpec, parent: mujoco.MjsBody, item: Item, seen: set[str]) -> None:
    for geom in item.geoms:
        matrix = matrix_from_euler(*geom.euler_rad)
        quat = np.zeros(4)
        mujoco.mju_mat2Quat(quat, matrix.ravel())
        made = parent.add_geom(type=SHAPES[geom.shape], pos=geom.pos_m, quat=quat)
        if geom.mesh is None:
            made.size = [*geom.size_m, 0.0, 0.0][:3]
            continue
        made.meshname = geom.mesh.name
        if geom.mesh.name not in seen:
            seen.add(geom.mesh.name)
            mesh = spec.add_mesh(name=geom.mesh.name, uservert=geom.mesh.vertices_m.ravel().tolist())
            if len(geom.mesh.faces):
                mesh.userface = geom.mesh.faces.ravel().tolist()
    for child in item.children:
        add_child(spec, parent, child, seen)


def add_child(spec: mujoco.MjSpec, parent: mujoco.MjsBody, child: Child, seen: set[str]) -> None:
    half = 0.5 * child.yaw_rad
    body = parent.add_body(pos=child.pos_m, quat=[np.cos(half), 0.0, 0.0, np.sin(half)])
    add_body(spec, body, child.item, seen)


def compiled(item: Item) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """Compiles the geoms of the item, followed by six slabs at the faces of its bounding box (low and high x, y, z)."""
    spec = mujoco.MjSpec()
    add_body(spec, spec.worldbody, item, set())
    dx, dy, dz = item.size_m
    low = np.array([0.0 if item.mount == "wall" else -0.5 * dx, -0.5 * dy, -dz if item.mount == "ceiling" else 0.0])
    high = low + item.size_m
    for axis in range(3):
        for edge, sign in ((low[axis], -1.0), (high[axis], 1.0)):
            pos = 0.5 * (low + high)
            pos[axis] = edge + sign * 0.5
            size = np.full(3, 20.0)
            size[axis] = 0.5
            spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, pos=pos, size=size)
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


def distance(model: mujoco.MjModel, data: mujoco.MjData, a: int, b: int) -> float:
    return mujoco.mj_geomDistance(model, data, a, b, FAR_M, None)


def slab_ids(model: mujoco.MjModel) -> dict[str, int]:
    world = [i for i in range(model.ngeom) if model.geom_bodyid[i] == 0]
    return dict(zip(("x-", "x+", "y-", "y+", "z-", "z+"), world[-6:], strict=True))


@every_style
def test_item_keeps_the_conventions(style):
    for item in items(style):
        assert item.category == style.category
        assert item.style == style.name
        assert item.mount == style.mount
        for part in with_children(item):
            assert part.category in MPCAT40
            assert part.geoms
        for geom in all_geoms(item):
            assert np.isfinite([*geom.pos_m, *geom.euler_rad, *geom.size_m]).all()
            assert geom.look.texture is None or TEXTURES[geom.look.texture].pool == style.pool
            assert geom.mesh is None or 4 <= len(geom.mesh.vertices_m) <= MAX_VERTICES
        for surface in item.surfaces:
            assert min(surface.half_size_m) > 0.0, "a surface has a size"
        assert len(all_geoms(item)) <= 48


@every_style
def test_bounding_box_holds_every_geom_and_fits(style):
    for item in items(style):
        model, data = compiled(item)
        slabs = slab_ids(model)
        own = [i for i in range(model.ngeom) if i not in slabs.values()]
        for name, slab in slabs.items():
            nearest = min(distance(model, data, slab, i) for i in own)
            assert abs(nearest) < 0.01, (
                f"{name}: the nearest geom is {nearest:.3f} m from that face of the bounding box"
            )


@every_style
def test_no_part_floats(style):
    support = {"floor": "z-", "top": "z-", "wall": "x-", "ceiling": "z+"}[style.mount]
    for item in items(style):
        model, data = compiled(item)
        slabs = slab_ids(model)
        own = [i for i in range(model.ngeom) if i not in slabs.values()]
        roots = (
            [slabs[support], slabs["z-"]] if item.mount == "wall" and item.mount_height_m == 0.0 else [slabs[support]]
        )
        held = {i for i in own if any(distance(model, data, root, i) <= TOUCH_M for root in roots)}
        fresh = set(held)
        while fresh:
            rest = [i for i in own if i not in held]
            fresh = {i for i in rest if any(distance(model, data, i, j) <= TOUCH_M for j in fresh)}
            held |= fresh
        floating = [i for i in own if i not in held]
        assert not floating, f"floats: {[(model.geom(i).type[0], data.geom_xpos[i].round(3)) for i in floating]}"


@every_style
def test_meshes_are_closed_and_face_outwards(style):
    shapes = {g.mesh.name: g.mesh for item in items(style) for g in all_geoms(item) if g.mesh}
    for shape in shapes.values():
        if not len(shape.faces):
            continue
        edges = {(int(a), int(b)) for f in shape.faces for a, b in zip(f, np.roll(f, -1), strict=True)}
        assert len(edges) == 3 * len(shape.faces), f"{shape.name}: an edge is used twice in one direction"
        assert all((b, a) in edges for a, b in edges), f"{shape.name} is not closed"
        a, b, c = (shape.vertices_m[shape.faces[:, i]] for i in range(3))
        assert np.einsum("ij,ij->", a, np.cross(b, c)) > 0.0, f"{shape.name} is inside out"


@pytest.mark.parametrize("width_m", [1.0, 1.2, 2.4])
@pytest.mark.parametrize("style", CATALOGUE.styles("counter", use="run"), ids=lambda style: style.name)
def test_a_unit_with_a_sink_stands_on_the_floor_and_has_no_masonry(style, width_m):
    rng = np.random.default_rng(0)
    unit = CATALOGUE.make_item(
        "counter", rng, pool=style.pool, style=style.name, width_m=width_m, with_sink=True, with_hob=False
    )
    (sink,) = unit.children
    bounds = [geom_bounds(geom) for geom in unit.geoms]
    assert min(low[2] for low, high in bounds if low[1] < sink.pos_m[1] < high[1]) < 0.01
    assert "masonry" not in {geom.look.material for geom in unit.geoms}


def test_every_goal_has_enough_styles_in_both_pools():
    for category in GOAL_CATEGORIES:
        assert len(CATALOGUE.styles(category, "train")) >= 4, category
        assert len(CATALOGUE.styles(category, "heldout")) >= 2, category


@pytest.mark.slow
def test_train_never_shows_a_look_of_the_heldout_pool():
    looks: dict[str, set[tuple]] = {"train": set(), "heldout": set()}
    for style in STYLES:
        for item in items(style):
            looks[style.pool] |= {(g.look.rgba, g.look.texture) for g in all_geoms(item)}
    for material in materials.MATERIALS:
        for pool, of_pool in looks.items():
            rng = np.random.default_rng(0)
            drawn = [materials.look(material, rng, pool) for _ in range(40)]  # type: ignore[arg-type]
            of_pool |= {(look.rgba, look.texture) for look in drawn}
    assert not looks["train"] & looks["heldout"]


@pytest.mark.parametrize("category", EXACT_WIDTHS)
@pytest.mark.parametrize("pool", ["train", "heldout"])
def test_width_hint_is_kept(category, pool):
    for name in names(category, pool):
        item = CATALOGUE.make_item(category, np.random.default_rng(3), pool=pool, style=name, width_m=1.23)
        assert item.size_m[1] == pytest.approx(1.23, abs=0.03), name


@pytest.mark.parametrize(
    ("width_m", "equipped"), [(0.2, False), (0.4, False), (0.9, False), (0.4, True), (1.0, True), (2.0, True)]
)
@pytest.mark.parametrize("style", CATALOGUE.styles("counter", use="run"), ids=lambda style: style.name)
def test_a_worktop_is_as_wide_as_asked_and_keeps_its_hob_from_its_sink(style, width_m, equipped):
    """Kitchens have worktops of 0.2 m between two appliances."""
    for seed in SEEDS:
        item = CATALOGUE.make_item(
            "counter", np.random.default_rng(seed), pool=style.pool, style=style.name, width_m=width_m,
            with_sink=equipped, with_hob=equipped,
        )  # fmt: skip
        assert item.size_m[1] == pytest.approx(width_m, abs=0.02)
        at = {child.item.category: (child.pos_m[1], 0.5 * child.item.size_m[1]) for child in item.children}
        if width_m == 2.0:
            assert abs(at["sink"][0] - at["appliances"][0]) > at["sink"][1] + at["appliances"][1] + 0.29


@pytest.mark.parametrize("pool", ["train", "heldout"])
@pytest.mark.parametrize("use", ["run", "island"])
def test_sink_of_a_counter_is_a_child_only_when_asked_for(pool, use):
    for wanted, style in itertools.product((True, False), names("counter", pool, use)):
        if use == "island" and wanted:
            continue
        rng = np.random.default_rng(0)
        item = CATALOGUE.make_item("counter", rng, pool=pool, style=style, use=use, width_m=2.4, with_sink=wanted)
        assert ("sink" in {child.item.category for child in item.children}) == wanted


def test_the_hint_looks_replaces_sampled_looks():
    red = Look((1.0, 0.0, 0.0, 1.0))
    item = CATALOGUE.make_item("table", np.random.default_rng(0), pool="train", style="farmhouse", looks={"wood": red})
    assert red in {geom.look for geom in item.geoms}


def test_committed_textures_equal_the_generated_ones():
    for texture in TEXTURES.values():
        path = assets_dir() / "textures" / materials.texture_file(texture.name)
        stored = cv2.imread(str(path))
        assert stored is not None, f"{path} is missing: run tools/maintenance/make_textures.py"
        # FFTs differ in the last bit between machines, which may move a pixel by one grey level.
        assert np.abs(stored[:, :, ::-1].astype(int) - texture.pixels()).max() <= 12


@given(angles=st.tuples(*[st.floats(-1.5, 1.5)] * 3))
def test_euler_angles_to_matrix_and_back_is_identity(angles):
    assert euler_from_matrix(matrix_from_euler(*angles)) == pytest.approx(angles, abs=2e-4)


def test_euler_angles_of_a_vertical_pitch_give_the_same_rotation():
    matrix = matrix_from_euler(0.4, 0.5 * np.pi, 0.3)
    assert matrix_from_euler(*euler_from_matrix(matrix)) == pytest.approx(matrix, abs=2e-4)


@pytest.mark.parametrize("name", [name for name, texture in TEXTURES.items() if texture.tile_m > 0.0])
def test_textures_that_repeat_have_no_seam(name):
    image = TEXTURES[name].pixels().astype(float)
    inside = np.abs(np.diff(image, axis=0)).mean(), np.abs(np.diff(image, axis=1)).mean()
    across = np.abs(image[0] - image[-1]).mean(), np.abs(image[:, 0] - image[:, -1]).mean()
    for seam, usual in zip(across, inside, strict=True):
        assert seam <= 6.0 * usual + 60.0
