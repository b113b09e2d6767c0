"""Palettes of real materials, split into a train pool and a held-out pool that share nothing.

A look (texture and colour together) of a train house never appears in a held-out house, and vice versa; the textures
are disjoint too. Colours are drawn from fixed lists, not jittered, so that this can be tested exactly; light, shadow
and distance vary them in the picture.

A `Look` is written to MJCF as a texture of type 2d from `texture_file(look.texture)` and a material with `texuniform`
and `texrepeat` from `texture_mapping(look)` and rgba `look.rgba`. MuJoCo 4 then repeats the picture at its true size
on planes and on the z faces of a box. The other faces are stretched by the ratio of the box's sides; therefore the
thinnest side of every textured box is along its local z, for furniture as well as for walls.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sim.core.errors import ConfigError
from sim.homes.housegen.furniture.item import Look, Pool
from sim.homes.housegen.surfaces.textures import TEXTURES


@dataclass(frozen=True)
class Swatches:
    """The colours and textures of one material in one pool."""

    colours: tuple[str, ...]
    """Hexadecimal RGB or RGBA."""
    textures: tuple[str | None, ...] = (None,)


@dataclass(frozen=True)
class Material:
    """A material: two palettes and its reflectance."""

    train: Swatches
    heldout: Swatches
    specular: float = 0.1
    shininess: float = 0.1
    emission: float = 0.0

    def swatches(self, pool: Pool) -> Swatches:
        """Returns the swatches of a pool."""
        return self.heldout if pool == "heldout" else self.train


_WOOD = (("wood_fine", "wood_bold"), ("wood_straight", "wood_cloud"))
_CLOTH = (("weave_plain", "weave_twill"), ("weave_linen", "weave_chevron"))
_PLAIN: tuple[tuple[str, ...], tuple[str, ...]] = ((), ())


def _material(
    train: str, heldout: str, textures: tuple[tuple[str, ...], tuple[str, ...]] = _PLAIN, *, specular: float = 0.1,
    shininess: float = 0.1, emission: float = 0.0,
) -> Material:  # fmt: skip
    """Returns a material from the hexadecimal colours, and the textures, of the train and the held-out pool."""
    return Material(
        Swatches(tuple(train.split()), textures[0] or (None,)),
        Swatches(tuple(heldout.split()), textures[1] or (None,)),
        specular,
        shininess,
        emission,
    )


MATERIALS: dict[str, Material] = {
    # oak, walnut, pine, beech, cherry, chestnut, dark oak; teak, mahogany, wenge, ash, driftwood
    "wood": _material(
        "c69c6d 6f4a2f d9b27c cfa476 9c5a36 825a3a 4b3426",
        "a8713c 6a2f22 3a2c29 dcc7a6 9a8e80",
        specular=0.15,
        textures=_WOOD,
    ),
    "lacquer": _material(
        "f2f1ec e4e0d6 d5d8d8 3d4a55 5c7268", "fbf3e2 c9d2dc 2a3640 7a8f86 a3433b", specular=0.3, shininess=0.3
    ),
    "fabric": _material(
        "8d8a84 5c6670 2f6f73 b9a78c 3a4a6b 7b3b3b 6b7a5a c7b9a5 444448 a86a3d",
        "8b9dae d6c9b4 9a4f6a 5a4a78 c29a3c 3f5a48 bcbcb4",
        textures=_CLOTH,
    ),
    "leather": _material(
        "5a3a28 2c2523 8b5a36 b08a60 e2ddd2", "7a2f24 454b52 c49a6c 3f4a3a", specular=0.35, shininess=0.3
    ),
    "bright": _material(
        "c8452f e0a52c 2f7f8f 4f8a4a e9e2d2 2b3a60 d77f5a", "d86a9a 7fb2d6 8f6fb8 b7c94a f0c9b0 5f2338"
    ),
    "linen": _material("f3f1ea e3e6ea dcd3c3 c9d3dd", "efe4d8 d9e4d6 e9dbe2"),
    "bedding": _material(
        "3f5f9f b9545a 6f8f7f d8cfbf 54565c 8fa3bf c99a4a", "7a4f8a 2f6a6a d9a9a0 a9b88a 304050", textures=_CLOTH
    ),
    "towel": _material("e9e6df 2f8f9a c0594a 8aa6c0 5b6f5a d9b34a", "d9a6b4 6a5a8a 3f4f5f a9cfc0 b98a5a"),
    "curtain": _material("d8cfbd 2f6f78 8a9aa5 a85a4a e8e6e0 6b705c", "c9a95a 5a4a6a cfd9d0 3f4f6a b07a8a"),
    "skin": _material("e3b98f b98560 8a5a3e", "f0cdb0 a06a48"),
    "sheer": _material("f4f1ea90 e6ebee90", "efe6d690 e9e4f090"),
    "cardboard": _material("c2a077 b08c60", "a9906f cdb596"),
    "chrome": _material("c9ccd0 b4b7bb", "d8d4cc a4a9b0", specular=0.9, shininess=0.8),
    "metal": _material("8d9094 a9abac 2b2c2e 5a5d60", "b08d57 3a3330 7a828a dcdcd6", specular=0.5, shininess=0.5),
    "dark": _material("1f2022 2b2b2d 26282c", "161a20 302a28 20262a", specular=0.3, shininess=0.3),
    "brass": _material("b8954f a98244", "c98f5f 8f7a3f", specular=0.7, shininess=0.6),
    "iron": _material("34363a 45474b", "2a2624 4f4a46", specular=0.3, shininess=0.3),
    "ceramic": _material("f7f7f4 eeeeea", "f3ead8 e4ebee d9d5cf", specular=0.6, shininess=0.7),
    "steel": _material("b9bcbf a7abae", "c8c6c0 989ea4", specular=0.7, shininess=0.6),
    "appliance": _material("f1f1ee c3c6c8 2e3033", "e9dfc9 aebcc4 43484d d9dcd2", specular=0.4, shininess=0.5),
    "plastic": _material(
        "f0efe9 2f3134 c8452f 3f6f8f e0b040", "dfe8ea 4a3f5f 6fae9a d9776a", specular=0.3, shininess=0.4
    ),
    "glass": _material("a8cfd640 b9d3cf48", "c6d9ee3a a6bfb050", specular=0.9, shininess=0.9),
    "screen": _material("0c0e12 11161f", "090b0e 171a1c", specular=0.6, shininess=0.8),
    "glow": _material("fff3d6 fdf6e6", "ffe9bd f4f7ff", emission=0.7),
    "shade": _material("efe4cc e8e6e2 c9b48f 3f4a55", "d9c1a0 f4efe8 8f4f3a 5f7a70"),
    "rubber": _material("232427 2d2e30", "1b1e22 363234"),
    "paper": _material("f0ece0 e4ddcc", "f4efe6 d9d2c6"),
    "paint": _material(
        "c8452f e0a52c 2f5f8f 3f7f5a 1f2328 d8b08a 7f9fb5 8a3f4f",
        "d86a9a 6fb7c9 7f5fa8 a9b84a 3a2a3a f0c9a0 4f6f7a",
    ),
    "book": _material(
        "8a2f2a 2f4a6f 3f6a4a c9a24a 4a3a2f d8d2c2 6f3f5f 2a2c30", "b5563a 4f7f8f 7f8f4f 9f7fae 5f5f6a e2c9a2 1f3f3a"
    ),
    "books": _material(
        "ffffff f2ece0", "fffaf4 e6e2e8", textures=(("books_classic", "books_paperback"), ("books_pastel",))
    ),
    "small": _material(
        "ffffff",
        "ffffff",
        textures=(
            ("small_red", "small_blue", "small_green", "small_sand"),
            ("small_plum", "small_teal", "small_rose", "small_moss"),
        ),
        specular=0.2,
        shininess=0.3,
    ),
    "pot": _material("b5653f e6e2d8 4a4c50 8a9a94 c9a987", "8f4a3a d9cfe0 2f4a4f a3a08f", specular=0.2),
    "soil": _material("3a2a20", "42342a"),
    "foliage": _material("3f7a3a 2f6232 5a8f42 4a7f55 79983f", "35664f 6a9a5f 8aa05a 27503a"),
    "hedge": _material(
        "5a9a50 4f8a4a 7aa858",
        "4f8a6a 86b06a 5f7a48",
        textures=(("foliage_small",), ("foliage_large",)),
    ),
    "flower": _material("d9483f e8b03a e9e2e6 b0507f", "e27fae 8f6fd0 f2d36a"),
    "stone": _material(
        "e8e4dc 8a8a8c 3d3e42 cbbfae",
        "d9d2d6 6f7a7a 55504a e6d8c0",
        textures=(("granite", "marble_vein"), ("quartz", "marble_cloud")),
        specular=0.4,
        shininess=0.5,
    ),
    "masonry": _material(
        "ffffff e9ddd2 c9c4bc",
        "ffffff e2e2da bdb5b0",
        textures=(("brick_red", "stone_rubble"), ("brick_yellow", "stone_ashlar")),
    ),
    "wicker": _material("c9a36a 9a7446 e0cba5", "b58a5a 7a5a3c 8f8a80", textures=(("cane_plain",), ("cane_broad",))),
    "denim": _material("3a4f75 2b3548 7f8fa8", "4a5f6a 1f2a44 95a0a8", textures=_CLOTH),
    "rug": _material(
        "ffffff",
        "ffffff",
        textures=(("rug_stripes", "rug_diamonds", "rug_lattice", "rug_kilim"), ("rug_medallion", "rug_rings")),
    ),
    "mirror": _material(
        "e8f2f6 dfeaf0", "f0f5f5 dbe4ec", textures=(("mirror_hall",), ("mirror_room",)), specular=0.9, shininess=0.9
    ),
    "fire": _material("f08a2a e8641f", "f2a33c d94f2a", emission=0.6),
    "char": _material("17151a 1d1a19", "121416 221d1a"),
}
"""The materials of furniture. The colours were chosen by eye from the usual range of retail photographs."""

_WALLS = _material(
    "efe9dc e6e3db dfe4e2 e9dccb d3dbd9 cdd6c8 e4d2c6 bccad2",
    "f2ecdf dcd6e0 d8c9b0 c2d2c4 e8d9dc b0b9b2",
    textures=(("plaster_soft", "plaster_grain", "paper_stripe"), ("plaster_trowel", "paper_flower")),
)
_WALL_TILES = _material(
    "efece4 dfe4e2 d3dbd9 cdd6c8 bccad2 e9dccb",
    "f2ecdf dcd6e0 c2d2c4 b0b9b2 e8d9dc",
    textures=(("tiles_subway", "tiles_small", "tiles_square"), ("tiles_plank", "tiles_mosaic", "tiles_large")),
    specular=0.3,
    shininess=0.4,
)
_CEILINGS = _material("f4f3ef ecebe6", "f7f4ea e6e8ea", textures=(("plaster_soft",), ("plaster_trowel",)))

_FLOORS: dict[str, Material] = {
    "boards": _material(
        "c69c6d 9a6a42 d9b98c 7a5236 b5885a",
        "a8713c dcc7a6 5a4034 b59f86",
        textures=(
            ("planks_wide", "planks_medium", "parquet_basket"),
            ("planks_rustic", "planks_narrow", "parquet_herringbone"),
        ),
        specular=0.2,
        shininess=0.3,
    ),
    "tiles": _material(
        "d8d6d0 b5683f 9aa5ab e9e4da 6f7478",
        "c9b8a2 8f9f98 d9dde2 5c5450",
        textures=(
            ("tiles_square", "tiles_checker", "terrazzo_fine"),
            ("tiles_large", "tiles_plank", "tiles_harlequin", "terrazzo_coarse"),
        ),
        specular=0.3,
        shininess=0.4,
    ),
    "wet": _material(
        "e4e6e4 b9c9cf 8fa3a0 d5cbbb",
        "dcd3c6 a5b5c4 c4d4c8 7f8488",
        textures=(("tiles_square", "tiles_small", "tiles_checker"), ("tiles_mosaic", "tiles_large", "tiles_harlequin")),
        specular=0.3,
        shininess=0.4,
    ),
    "carpet": _material(
        "6f7f9a 9a8f80 b8aa96 5f6a5c 8a5a52 74767a",
        "8f7a94 a3a88f c4b0a0 4f5a66",
        textures=(("carpet_loop", "carpet_fleck"), ("carpet_pile",)),
    ),
    "stone": _material(
        "e6e0d6 c9c4bb a8a49c",
        "ded6cf b4bab8",
        textures=(("marble_vein",), ("marble_cloud",)),
        specular=0.4,
        shininess=0.5,
    ),
    "rubber": _material("4a4b4f 3a3c42", "33383a 524c4c", textures=(("carpet_fleck",), ("carpet_pile",))),
}

_FLOORS_OF_ROOM: dict[str, tuple[str, ...]] = {
    "living_room": ("boards", "boards", "boards", "carpet", "stone"),
    "bedroom": ("boards", "boards", "carpet", "carpet"),
    "kitchen": ("tiles", "tiles", "stone"),
    "bathroom": ("wet",),
    "hallway": ("boards", "tiles", "stone"),
    "office": ("boards", "carpet"),
    "gym": ("rubber", "boards"),
    "laundry": ("tiles", "wet"),
}
_ANY_ROOM = ("boards", "tiles", "carpet")


def look(material: str, rng: np.random.Generator, pool: Pool) -> Look:
    """Returns a random look of a material from the pool.

    Raises:
        ConfigError: the material is unknown.
    """
    if material not in MATERIALS:
        raise ConfigError(f"Unknown material '{material}'. Available: {', '.join(sorted(MATERIALS))}.")
    return replace(_draw(MATERIALS[material], rng, pool), material=material)


def palettes(pool: Pool) -> tuple[str | None, ...]:
    """Returns the names of the palettes of small objects of a pool (`furniture.parts.palette_mesh`)."""
    return MATERIALS["small"].swatches(pool).textures


def wall_look(rng: np.random.Generator, pool: Pool, room_kind: str) -> Look:
    """Returns the look of a wall: paint or wallpaper, mostly tiles in wet rooms."""
    tiled = room_kind in ("bathroom", "laundry") and rng.random() < 0.7
    return _draw(_WALL_TILES if tiled else _WALLS, rng, pool)


def floor_look(room_kind: str, rng: np.random.Generator, pool: Pool) -> Look:
    """Returns the look of a floor that suits the kind of room: boards, carpet, tiles, stone, rubber."""
    kinds = _FLOORS_OF_ROOM.get(room_kind, _ANY_ROOM)
    return _draw(_FLOORS[kinds[int(rng.integers(len(kinds)))]], rng, pool)


def floor_look_of(kind: str, rng: np.random.Generator, pool: Pool) -> Look:
    """Returns the look of a floor of boards, tiles, wet (small tiles), carpet, stone or rubber."""
    return _draw(_FLOORS[kind], rng, pool)


def ceiling_look(rng: np.random.Generator, pool: Pool) -> Look:
    """Returns the look of a ceiling: light plaster."""
    return _draw(_CEILINGS, rng, pool)


def texture_file(name: str) -> str:
    """Returns the file name of a texture inside assets/mjcf_houses/textures/.

    Raises:
        ConfigError: the texture is unknown.
    """
    if name not in TEXTURES:
        raise ConfigError(f"Unknown texture '{name}'. Available: {', '.join(sorted(TEXTURES))}.")
    return f"{name}.png"


def texture_mapping(look: Look) -> tuple[bool, float]:
    """Returns MuJoCo's `texuniform` and `texrepeat` (the same in both directions) of a textured look.

    Measured with 4.0.0: with `texuniform`, a `texrepeat` of 2 shows the picture once per metre.
    """
    return (False, 1.0) if look.repeat_m == 0 else (True, round(2.0 / look.repeat_m, 4))


def _draw(material: Material, rng: np.random.Generator, pool: Pool) -> Look:
    swatches = material.swatches(pool)
    colour = swatches.colours[int(rng.integers(len(swatches.colours)))]
    texture = swatches.textures[int(rng.integers(len(swatches.textures)))]
    red, green, blue, *alpha = (round(part / 255, 3) for part in bytes.fromhex(colour))
    repeat_m = TEXTURES[texture].tile_m if texture else 1.0
    rgba = (red, green, blue, alpha[0] if alpha else 1.0)
    return Look(rgba, texture, repeat_m, material.specular, material.shininess, material.emission)
