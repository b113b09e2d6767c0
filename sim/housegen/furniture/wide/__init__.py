"""Styles that no split shows: houses of the pool `wide` have them beside train's, to train perception on more shapes.

They were designed without a look at the held-out ones, which stay what a network has never seen.

Sizes follow, as train's, Neufert, Architects' Data, Panero & Zelnik, Human Dimension and Interior Space, the European
kitchen grid (EN 1116), usual mattress sizes (EN 1334) and retail ranges, but with a wider spread.
"""

from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.wide import (
    armchairs,
    baths,
    beds,
    chairs,
    chests,
    clothes,
    counters,
    cushions,
    desks,
    displays,
    floor_plants,
    gym,
    hearths,
    pictures,
    screens,
    seats,
    side_tables,
    sideboards,
    sinks,
    sofas,
    stools,
    table_plants,
    tables,
    toilets,
    towels,
    vanities,
    wall_units,
    wardrobes,
)

STYLES: tuple[Style, ...] = (
    *sinks.STYLES,
    *toilets.STYLES,
    *towels.STYLES,
    *clothes.STYLES,
    *baths.STYLES,
    *hearths.STYLES,
    *gym.STYLES,
    *counters.STYLES,
    *beds.STYLES,
    *tables.STYLES,
    *desks.STYLES,
    *side_tables.STYLES,
    *chairs.STYLES,
    *armchairs.STYLES,
    *seats.STYLES,
    *sofas.STYLES,
    *stools.STYLES,
    *cushions.STYLES,
    *chests.STYLES,
    *wardrobes.STYLES,
    *sideboards.STYLES,
    *displays.STYLES,
    *wall_units.STYLES,
    *vanities.STYLES,
    *screens.STYLES,
    *floor_plants.STYLES,
    *table_plants.STYLES,
    *pictures.STYLES,
)
