"""The everyday name of each style of furniture, finer than its mpcat40 category: fridge, desk, rocking chair.

A house file carries the name of each instance (`sim.houses.instances`), so that goals can be given in words. A name is
one that a person would use for the picture: a singular noun, lower case, without a colour, a material or a size.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from sim.homes.housegen.furniture.uses import USES

_BY_CATEGORY: Mapping[str, Mapping[str, str]] = {
    "appliances": {
        "fridge": "fridge retro_fridge two_door_fridge larder_fridge", "cooker": "stove range_cooker",
        "washing machine": "front_loader top_loader", "tumble dryer": "dryer",
        "dishwasher": "dishwasher dishwasher_panelled", "hob": "hob gas_hob", "microwave": "microwave",
        "toaster oven": "toaster_oven", "cooker hood": "hood_chimney hood_slanted",
        "coffee machine": "coffee_machine", "toaster": "toaster",
    },
    "chair": {
        "armchair": "club wingback lounge tub channel_chair egg_chair cane_chair", "rocking chair": "rocker",
        "office chair": "task_chair conference executive",
        "dining chair": "slat_back ladder_back shell parsons cantilever cafe_metal windsor cross_back",
    },
    "shower": {"shower": "corner_cabin curved_cabin walk_in curtained cubicle pentagon_cabin"},
    "bathtub": {"bathtub": "freestanding corner barrel clawfoot built_in with_screen"},
    "bed": {"bed": "panel platform upholstered metal_frame storage sleigh futon", "four-poster bed": "four_poster"},
    "cabinet": {
        "wardrobe": "wardrobe_doors wardrobe_sliding armoire sliding_wardrobe",
        "sideboard": "sideboard_legs tambour slatted_sideboard", "display cabinet": "display",
        "media cabinet": "media_low media_legs", "wall cabinet": "wall_unit wall_unit_glazed",
        "vanity cabinet": "vanity_doors vanity_floating",
    },
    "chest_of_drawers": {
        "chest of drawers": "dresser tallboy handleless campaign apothecary",
        "nightstand": "bedside_chest bedside_drum",
    },
    "clothes": {
        "clothes rack": "rack open_wardrobe", "valet stand": "valet", "coat rack": "hall_board coat_hooks on_pegs",
        "coat stand": "coat_tree", "pile of clothes": "folded_pile heap", "sweater": "sweater",
        "laundry basket": "laundry_basket", "drying rack": "winged_airer ladder_airer clothes_horse airer_frame",
    },
    "counter": {
        "kitchen counter": "kitchen_run open_run slab_run curtained_run", "kitchen island": "island waterfall",
        "breakfast bar": "breakfast_bar", "kitchen trolley": "trolley",
    },
    "cushion": {
        "cushion": "square lumbar round banded knot", "bolster": "bolster",
        "floor cushion": "floor_square floor_round",
    },
    "gym_equipment": {
        "treadmill": "treadmill", "weight bench": "bench_barbell", "exercise bike": "exercise_bike",
        "dumbbell rack": "dumbbell_rack", "punching bag": "punching_bag", "kettlebells": "kettlebells",
        "exercise ball": "mat_and_ball", "multi-gym": "multi_gym", "rowing machine": "rower",
        "aerobic step": "step_and_roller", "pull-up tower": "pull_up_tower",
    },
    "fireplace": {
        "fireplace": "mantel brick_breast linear rustic_stone electric suspended", "wood stove": "stove_iron",
        "tiled stove": "tiled_stove",
    },
    "lighting": {
        "pendant lamp": "pendant globe_pendant", "ceiling lamp": "ceiling_disc panel", "chandelier": "chandelier",
        "spotlights": "spot_rail", "floor lamp": "floor_lamp tripod_lamp arc reading",
        "table lamp": "table_lamp mushroom_lamp globe", "desk lamp": "desk", "wall lamp": "sconce swing_sconce",
    },
    "table": {
        "coffee table": "coffee_shelf coffee_drum coffee_glass coffee_hairpin coffee_blocks",
        "side table": "side_tripod side_cube drum_stool_table", "nightstand": "bedside_legs bedside_wire",
        "console table": "console console_arc console_drawers", "desk": "desk_pedestal desk_frame wing_desk secretary",
        "dining table": "farmhouse splayed round_pedestal industrial trestle glass_dining round_legs",
    },
    "mirror": {"mirror": "mirror_sunburst rectangular round arched", "standing mirror": "standing"},
    "objects": {
        "stack of books": "book_stack book_tower", "row of books": "book_row book_ends", "book": "open_book",
        "vase": "vase", "crate": "crate", "fruit bowl": "fruit_bowl fruit_plate", "kettle": "kettle", "clock": "clock",
        "photo frame": "photo_stand frames", "basket": "basket", "place setting": "place_setting",
        "bottles": "bottles pump_bottles", "bin": "waste_bin", "suitcase": "suitcase", "candles": "candles",
        "game console": "game_console", "jar with twigs": "twig_jar", "jewellery box": "jewel_box",
        "alarm clock": "alarm_clock", "key bowl": "key_bowl", "candlesticks": "candlesticks",
        "speaker": "speaker_remote", "perfume bottles": "perfumes", "glass of water": "water_and_phone",
        "hourglass": "hourglass_box", "sneakers": "sneakers", "pumps": "pumps", "boots": "boots",
        "slippers": "slippers", "tote bag": "tote_bag", "backpack": "backpack", "duffel bag": "duffel",
        "satchel": "satchel", "toy blocks": "toy_blocks", "ball": "toy_ball", "teddy bear": "teddy",
        "toy train": "toy_train", "power strip": "power_strip", "cable": "cable_coil",
        "magazines": "scattered_magazines magazine_fan", "drawings": "drawings", "cardboard boxes": "box_pile",
        "storage box": "storage_tub", "stack of dishes": "dish_pile", "pot": "pot_lid",
        "cutting board": "bread_board", "wine bottle": "wine", "jars": "jars", "table mats": "table_mats",
        "tea set": "tea_set", "frying pan": "frying_pan", "cheese board": "cheese_board", "spice rack": "spice_rack",
        "breakfast": "breakfast", "soap dispenser": "soap_and_brushes", "toilet paper": "paper_holder paper_niche",
        "bathroom shelf": "bottle_rack towel_ledge", "laptop": "laptop", "papers": "papers",
        "reading glasses": "book_and_glasses", "newspapers": "newspapers", "tablet": "tablet_keyboard",
        "folders": "folders",
    },
    "furniture": {"piano": "digital_piano upright_piano", "folding screen": "folding_screen shoji_screen"},
    "picture": {
        "picture": "framed_abstract canvas_landscape triptych photo_group still_life tondo", "portrait": "portrait",
        "wall scroll": "scroll",
    },
    "plant": {
        "potted plant": "broadleaf snake_plant rubber_tree topiary monstera table_fern", "potted tree": "tree palm",
        "flowers": "flower_pot", "cactus": "cactus", "bonsai": "bonsai",
    },
    "floor": {"rug": "rug_rectangle rug_round rug_runner rug_bordered rug_fringed"},
    "tv_monitor": {
        "television": "tv_stand tv_wall tv_easel tv_arm tv_pole soundbar_tv crt", "monitor": "monitor dual_monitor",
        "laptop": "laptop",
    },
    "seating": {
        "bench": "bench_wood storage_bench tufted_bench settle slab_bench", "bean bag": "beanbag",
        "footstool": "ottoman", "pouf": "pouf",
    },
    "shelving": {
        "bookcase": "bookcase ladder_shelf pipe_shelf etagere cubes", "wall shelf": "wall_boards niches",
        "laundry shelf": "wire_shelf_laundry slatted_shelf_laundry", "hamper": "hamper_tower",
        "drying cupboard": "drying_cupboard", "linen shelf": "wire_shelf_linen walk_in_case slatted_shelf_linen",
        "shoe rack": "shoe_bench",
    },
    "sink": {
        "washbasin": "pedestal wall_basin vessel_round vessel_square console trough",
        "kitchen sink": "inset_steel inset_stone double_steel", "utility sink": "utility",
    },
    "sofa": {
        "sofa": "block_arm rolled_arm wooden_frame chesterfield camelback", "corner sofa": "corner bubble",
        "daybed": "daybed",
    },
    "stool": {
        "bar stool": "bar_wood bar_swivel bar_steel saddle", "stool": "low_round vanity_stool stump folding",
        "step stool": "step_stool",
    },
    "column": {"column": "round brick_pier square"},
    "railing": {"railing": "balusters glass cables"},
    "toilet": {"toilet": "close_coupled wall_hung high_cistern low_level square_modern one_piece"},
    "towel": {
        "towel rail": "rail hooks ring swing_rail", "towel radiator": "radiator", "towel ladder": "ladder",
        "towel stand": "stand", "towels": "stack rolls",
    },
    "board_panel": {
        "pinboard": "cork_board", "whiteboard": "whiteboard", "chalkboard": "chalk_board", "wall planner": "planner",
    },
    "curtain": {"curtain": "single pair tied_back sheer cafe"},
    "blinds": {"blind": "roller slatted venetian roman"},
    "door": {"door": "leaf frame"},
    "window": {"window": "pane"},
}  # fmt: skip
_BY_STYLE: Mapping[tuple[str, str], str] = MappingProxyType({
    (category, style): name
    for category, of_category in _BY_CATEGORY.items()
    for name, styles in of_category.items()
    for style in styles.split()
})  # fmt: skip
CATEGORIES_OF_NAMES: Mapping[str, tuple[str, ...]] = MappingProxyType({
    name: tuple(category for category, of_category in _BY_CATEGORY.items() if name in of_category)
    for name in dict.fromkeys(_BY_STYLE.values())
})  # fmt: skip
"""The mpcat40 categories of each name."""
NAMES: tuple[str, ...] = tuple(CATEGORIES_OF_NAMES)
"""All names, each once."""
_BY_USE: Mapping[str, str] = MappingProxyType({
    "dining": "dining chair", "office": "office chair", "arm": "armchair", "bar": "bar stool", "low": "stool",
    "bench": "bench", "plain": "bench", "ottoman": "footstool", "coffee": "coffee table", "desk": "desk",
    "side": "side table", "nightstand": "nightstand", "console": "console table", "wardrobe": "wardrobe",
    "sideboard": "sideboard", "display": "display cabinet", "media": "media cabinet", "kitchen_wall": "wall cabinet",
    "vanity": "vanity cabinet", "bookcase": "bookcase", "fridge": "fridge", "stove": "cooker",
    "washing_machine": "washing machine", "dishwasher": "dishwasher", "microwave": "microwave",
})  # fmt: skip


def listed_name(category: str, style: str) -> str | None:
    """Returns the everyday name of a style of our own; None: the style is of an imported model or of a user."""
    return _BY_STYLE.get((category, style))


def name_of_style(category: str, style: str, uses: tuple[str, ...] = ()) -> str:
    """Returns the everyday name of a style.

    A style that the table does not know (of an imported model, of a user) has the name of its first use that has one;
    without such a use it has the words of its category.

    Args:
        category: mpcat40 name with underscores.
        style: name of the style.
        uses: the uses that it satisfies, as `sim.homes.housegen.furniture.uses` lists them.
    """
    known = listed_name(category, style)
    if known is not None:
        return known
    of_use = {"dining": "dining table"} if category == "table" else {}
    for use in uses if category in USES else ():
        if name := of_use.get(use) or _BY_USE.get(use):
            return name
    return category.replace("_", " ")
