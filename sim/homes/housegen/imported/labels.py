"""The table that decides which category and uses an installed model has, by its name, its group and its size.

The first rule that matches decides. Models that no rule matches are left out: outdoor objects, vehicles, people, models
that show objects of several categories (a vanity with its basin and its mirror), racks and rails without the clothes
and towels that give them their name, and names that say too little.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from sim.core.interface import MPCAT40_ID
from sim.homes.housegen.furniture.item import Mount

Size = tuple[float, float, float]
"""Depth along x, width along y and height along z, in metres."""

INDOORS = frozenset(("Bathroom", "Bedroom", "Kitchen", "Lights", "Living room", "Miscellaneous", "Office", ""))
"""A rule may match the models of these groups of a source unless the rule names groups itself."""


@dataclass(frozen=True)
class Label:
    """The category and the uses of a model."""

    category: str
    uses: tuple[str, ...] = ()
    mount: Mount = "floor"


@dataclass(frozen=True)
class _Rule:
    """Models with a name, a group and a size have a label."""

    names: str
    """Regular expression that matches the whole name in lower case."""
    label: Label | None
    """None: the model is left out."""
    groups: frozenset[str] = INDOORS
    width_m: tuple[float, float] = (0.0, 9.0)
    depth_m: tuple[float, float] = (0.0, 9.0)
    height_m: tuple[float, float] = (0.0, 9.0)
    elevated: bool | None = None
    """Whether the model hangs above the floor; None: either."""

    def matches(self, name: str, group: str, size_m: Size, elevation_m: float) -> bool:
        """Returns whether the rule is for such a model."""
        limits = zip((self.depth_m, self.width_m, self.height_m), size_m, strict=True)
        return (
            group in self.groups
            and (self.elevated is None or self.elevated == (elevation_m > 0.0))
            and all(low <= value < high for (low, high), value in limits)
            and re.fullmatch(self.names, name.lower()) is not None
        )


def _label(category: str, *uses: str, mount: Mount = "floor") -> Label:
    return Label(category, uses, mount)


_OUTDOOR_SEATS = frozenset(("Exterior",))
_PLANTS = r"(little |decorative |indoor |succulent |spider )?plant|ficus|yucca|spathiphyllum|bamboo|cactus|bonsai tree"
_CUT_FLOWERS = r"orchids|flowers|tulips|white lily"
_TABLES = r"(oak |round |glass |black |wooden |wooden alder |wooden teak |folding |white )*table|table with tablecloth"
_SOFAS = r"((winchester|clear|leather|burlap|futon|corner|rattan) )?(sofa|couch)( [23] seats)?|convertible sofa bz"
_RULES: tuple[_Rule, ...] = (
    # seats
    _Rule(r"(child|children|baby high|relax|deck|beach) chair|wheelchair|armchair ottoman", None),
    _Rule(r"arm-?chair|chair", _label("chair", "office"), frozenset(("Office",)), width_m=(0.0, 0.75)),
    _Rule(r"(winchester |modern |mid-century |rattan )?armchair", _label("chair", "arm"), INDOORS | _OUTDOOR_SEATS),
    _Rule(r"chair|osaka chair", _label("chair", "arm"), width_m=(0.64, 9.0)),
    _Rule(r"(oak |plastic |folding |kitchen |osaka )?chair|chair with cushion", _label("chair", "dining"),
          height_m=(0.7, 1.25)),
    _Rule(r"(cafe|teck) chair", _label("chair", "dining"), _OUTDOOR_SEATS),
    _Rule(r"(bar )?stool|bar chair", _label("stool", "bar"), height_m=(0.62, 1.25)),
    _Rule(r"stool", _label("stool", "low"), height_m=(0.35, 0.55)),
    _Rule(r"bench|piano bench", _label("seating", "plain", "bench"), INDOORS | _OUTDOOR_SEATS, height_m=(0.35, 0.6)),
    _Rule(r"puff|ottoman", _label("seating", "ottoman")),
    _Rule(_SOFAS, _label("sofa"), INDOORS | _OUTDOOR_SEATS, width_m=(1.2, 3.6)),
    # beds
    _Rule(r"baby bed|crib|mezzanine bed|air mattress|sleeping bag", None),
    _Rule(r"(iron |child |bunk |captain's |hospital )?bed", _label("bed"), width_m=(0.8, 2.3), height_m=(0.3, 1.7)),
    # tables
    _Rule(r"bedside table", _label("chest_of_drawers", "nightstand")),
    _Rule(r"coffee table|rattan table", _label("table", "coffee"), INDOORS | _OUTDOOR_SEATS, height_m=(0.25, 0.6)),
    _Rule(r"table", _label("table", "coffee"), width_m=(0.7, 9.0), height_m=(0.25, 0.6)),
    _Rule(r"(wooden )?desk( table)?", _label("table", "desk"), width_m=(0.9, 2.0), height_m=(0.68, 1.2)),
    _Rule(r"table on trestles", _label("table", "dining", "desk")),
    _Rule(_TABLES, _label("table", "dining", "desk"), frozenset(("Office",)), height_m=(0.65, 0.82)),
    _Rule(r"table|round table", _label("table", "side"), width_m=(0.0, 0.7), height_m=(0.4, 0.76)),
    _Rule(_TABLES, _label("table", "dining"), width_m=(0.75, 2.6), height_m=(0.65, 0.85)),
    _Rule(r"cafe table", _label("table", "dining"), _OUTDOOR_SEATS),
    # cabinets, chests, shelves, counters
    _Rule(r"wardrobe|cupboard", _label("cabinet", "wardrobe"), width_m=(0.8, 2.4), height_m=(1.4, 2.4)),
    _Rule(r"tv stand", _label("cabinet", "media", "sideboard")),
    _Rule(r"dresser( with drawers)?", _label("chest_of_drawers", "dresser")),
    _Rule(r"(full )?bookcase|(vertical )?shelves", _label("shelving", "bookcase"), width_m=(0.0, 1.7),
          height_m=(0.7, 2.4)),
    _Rule(r"island", _label("counter", "island"), height_m=(0.8, 1.0)),
    # bathrooms
    _Rule(r"washbasin|small lavatory", _label("sink", "standing"), height_m=(0.7, 1.1), elevated=False),
    _Rule(r"washbasin|small lavatory", _label("sink", "standing", mount="wall"), height_m=(0.15, 0.7), elevated=True),
    _Rule(r"toilets unit", _label("toilet")),
    _Rule(r"shower stall", _label("shower")),
    _Rule(r"bath|bathtub|(corner|island) bath(tub)?", _label("bathtub"), height_m=(0.4, 1.2)),
    _Rule(r"towel rack", _label("towel", "rail", mount="wall"), height_m=(0.3, 1.0), elevated=True),
    # plants, fires, training
    _Rule(_CUT_FLOWERS, _label("plant", "top", mount="top"), width_m=(0.0, 0.6), height_m=(0.0, 0.65)),
    _Rule(_PLANTS, _label("plant", "floor"), height_m=(0.55, 2.2)),
    _Rule(_PLANTS, _label("plant", "top", mount="top"), width_m=(0.0, 0.6), height_m=(0.0, 0.55)),
    _Rule(r"fireplace", _label("fireplace"), height_m=(0.8, 2.6)),
    _Rule(r"treadmill|indoor bike|fitness tower", _label("gym_equipment", "machine")),
    _Rule(r"abdominal bench|punching ball", _label("gym_equipment", "weights")),
    # screens and lamps
    _Rule(r"wall flat tv", _label("tv_monitor", "tv_wall", mount="wall")),
    _Rule(r"tv( 16:9)?|flat tv", _label("tv_monitor", "tv", mount="top"), elevated=False),
    _Rule(r"apple imac.*|laptop|apple ibook", _label("tv_monitor", "monitor", mount="top")),
    _Rule(r"(hanging|ceiling|pendant|chandelier) (light|lamp)", _label("lighting", "ceiling", mount="ceiling"),
          height_m=(0.0, 0.9), elevated=True),
    _Rule(r"wall light", _label("lighting", "wall", mount="wall"), elevated=True),
    _Rule(r"(floor )?lamp", _label("lighting", "floor"), height_m=(1.1, 2.1), elevated=False),
    _Rule(r"(desk |little |pedestal vase )?lamp", _label("lighting", "table", mount="top"), height_m=(0.2, 0.85),
          elevated=False),
    # kitchens and laundries
    _Rule(r"fridge|refrigerator|large fridge", _label("appliances", "fridge"), height_m=(1.1, 2.0)),
    _Rule(r"large stove", _label("appliances", "stove"), height_m=(0.8, 1.0)),
    _Rule(r"(clothes )?washing machine|dryer machine", _label("appliances", "washing_machine")),
    _Rule(r"microwave", _label("appliances", "microwave", mount="top")),
    _Rule(r"toaster|coffee (maker|brewer|machine)|mixer|blender", _label("appliances", "small", mount="top"),
          width_m=(0.0, 0.45)),
    # clothes and small objects
    _Rule(r"folded clothes", _label("clothes", "top", mount="top")),
    _Rule(r"upright piano", _label("furniture", "piano")),
    _Rule(r"screen", _label("furniture", "screen"), height_m=(1.2, 2.2)),
    _Rule(r"vase", _label("objects", "top", "shelf", "table", mount="top"), height_m=(0.1, 0.55)),
    _Rule(r"bowl|bowl with fruits|apples|teapot|kettle|boiler|espresso kettle|coffee press",
          _label("objects", "kitchen", "table", mount="top"), width_m=(0.0, 0.46)),
    _Rule(r"speaker|radio|stereo amplifier", _label("objects", "media", "low", mount="top"), height_m=(0.0, 0.4)),
    _Rule(r"slippers|sneakers|woman shoes|mocassin", _label("objects", "shoes")),
    _Rule(r"backpack|handbag|briefcase", _label("objects", "bag")),
    _Rule(r"teddy bear|rocking horse|toy train", _label("objects", "toy")),
    _Rule(r"suitcase|box|crate|cardboard box", _label("objects", "floor", "box"), width_m=(0.25, 1.01),
          height_m=(0.2, 0.8)),
    _Rule(r"dustbin|bullet trash can", _label("objects", "floor", "bin")),
)  # fmt: skip


def label_of(name: str, group: str, size_m: Size, elevation_m: float = 0.0) -> Label | None:
    """Returns the label of a model, or None for one that is left out."""
    for rule in _RULES:
        if rule.matches(name, group, size_m, elevation_m):
            return rule.label
    return None


def label_of_category(category: str, uses: tuple[str, ...], mount: Mount) -> Label | None:
    """Returns the label that a table of models gives; None for a category that mpcat40 does not have."""
    return Label(category, uses, mount) if category in MPCAT40_ID else None
