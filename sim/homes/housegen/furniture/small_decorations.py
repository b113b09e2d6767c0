"""Small objects of living rooms and bedrooms: candles, jars, clocks, frames, bottles; one palette mesh each."""

from __future__ import annotations

import math

from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.parts import around, polar
from sim.homes.housegen.furniture.parts.palette_mesh import (
    ACCENTS,
    BROWN,
    CARD,
    CREAM,
    DARK,
    GREEN,
    METAL,
    TINT,
    WHITE,
    WOOD,
    PaletteMesh,
    in_one_mesh,
)
from sim.homes.housegen.furniture.workbench import Workbench


def candles(w: Workbench, m: PaletteMesh) -> None:
    """Builds three thick candles on a tray."""
    wax = w.choice((WHITE, CREAM, ACCENTS[0]))
    m.box((-0.07, 0.07), (-0.16, 0.16), (0.0, 0.012), w.choice((WOOD, DARK, METAL)))
    for y, high in ((-0.10, 0.16), (0.0, 0.11), (0.09, 0.08)):
        m.round((0.0, y), [(0.012, 0.036), (high, 0.034)], wax, sides=7)


def candlesticks(w: Workbench, m: PaletteMesh) -> None:
    """Builds two candlesticks of different heights."""
    foot = w.choice((METAL, DARK, WOOD))
    for y, high in ((-0.05, 0.16), (0.06, 0.11)):
        m.round((0.0, y), [(0.0, 0.045), (0.015, 0.014), (high, 0.012), (high + 0.015, 0.028)], foot, sides=6)
        m.round((0.0, y), [(high + 0.015, 0.011), (high + 0.15, 0.009)], w.choice((WHITE, *ACCENTS)), sides=5)


def game_console(w: Workbench, m: PaletteMesh) -> None:
    """Builds a game console with two controllers."""
    m.box((-0.12, 0.10), (-0.16, 0.10), (0.0, 0.055), w.choice((DARK, WHITE)))
    m.box((0.10, 0.104), (-0.14, 0.02), (0.02, 0.032), w.choice(ACCENTS))
    for x, turn in ((-0.05, 0.4), (0.07, -0.3)):
        m.box(around(x, 0.03), (0.15, 0.28), (0.0, 0.035), w.choice((DARK, WHITE, *ACCENTS)), turn=turn)


def speaker_remote(w: Workbench, m: PaletteMesh) -> None:
    """Builds a round speaker and a remote control."""
    m.round((0.0, 0.0), [(0.0, 0.05), (0.18, 0.05)], w.choice((DARK, *ACCENTS)), sides=8)
    m.round((0.0, 0.0), [(0.10, 0.0515), (0.112, 0.0515)], METAL, sides=8)
    m.box((-0.08, 0.08), (0.10, 0.145), (0.0, 0.02), DARK, turn=0.3)


def twig_jar(w: Workbench, m: PaletteMesh) -> None:
    """Builds a jar with twigs and leaves."""
    r = w.length(0.05, 0.075)
    m.round(
        (0.0, 0.0), [(0.0, 0.6 * r), (0.10, r), (0.19, 0.5 * r), (0.21, 0.6 * r)], w.choice((WHITE, TINT, *ACCENTS))
    )
    for n in range(4):
        lean, turn = 0.16 + 0.05 * n, math.tau * n / 4
        x, y = polar(0.06, turn)
        roll, tilt = -lean * math.sin(turn), lean * math.cos(turn)
        m.box(around(x, 0.004), around(y, 0.004), (0.16, 0.44), BROWN, roll=roll, tilt=tilt)
        m.box(around(1.6 * x, 0.03), around(1.6 * y, 0.014), (0.38, 0.40), GREEN, turn=turn)


def jewel_box(w: Workbench, m: PaletteMesh) -> None:
    """Builds an open jewel box and a perfume bottle."""
    m.box((-0.07, 0.07), (-0.10, 0.10), (0.0, 0.07), w.choice((WOOD, BROWN, ACCENTS[4])))
    m.box((-0.085, -0.07), (-0.10, 0.10), (0.065, 0.165), w.choice((WOOD, BROWN)), tilt=-0.2)
    m.box((-0.06, 0.06), (-0.09, 0.09), (0.062, 0.0715), ACCENTS[0])
    m.box((-0.02, 0.02), (0.15, 0.20), (0.0, 0.07), TINT)
    m.round((0.0, 0.175), [(0.07, 0.012), (0.095, 0.012)], METAL, sides=6)


def perfumes(w: Workbench, m: PaletteMesh) -> None:
    """Builds three perfume bottles and a brush."""
    for y, high in ((-0.08, 0.09), (0.0, 0.12), (0.075, 0.07)):
        m.round((0.0, y), [(0.0, 0.03), (0.75 * high, 0.028)], w.choice((TINT, *ACCENTS)), sides=5)
        m.round((0.0, y), [(0.75 * high, 0.012), (high, 0.012)], w.choice((METAL, DARK)), sides=5)
    m.box((0.05, 0.09), (-0.12, 0.02), (0.0, 0.02), WOOD, turn=0.3)


def alarm_clock(w: Workbench, m: PaletteMesh) -> None:
    """Builds an alarm clock with two bells."""
    body = w.choice((*ACCENTS, METAL))
    m.box((-0.025, 0.025), (-0.055, 0.055), (0.01, 0.12), body)
    m.box((0.024, 0.028), (-0.045, 0.045), (0.02, 0.11), WHITE)
    m.box((0.027, 0.03), (-0.003, 0.003), (0.06, 0.10), DARK)
    for y in (-0.035, 0.035):
        m.round((0.0, y), [(0.118, 0.024), (0.135, 0.014)], METAL, sides=6)
        m.box((-0.01, 0.01), around(y, 0.006), (0.0, 0.02), DARK)


def water_and_phone(w: Workbench, m: PaletteMesh) -> None:
    """Builds a glass of water and a phone."""
    m.cup((0.0, 0.0), (0.0, 0.13), 0.036, TINT)
    m.box((-0.05, 0.10), (0.08, 0.155), (0.0, 0.009), DARK, turn=0.2)


def frames(w: Workbench, m: PaletteMesh) -> None:
    """Builds two standing picture frames."""
    for y, wide, high in ((-0.10, 0.075, 0.22), (0.09, 0.06, 0.16)):
        m.box((-0.01, 0.006), around(y, wide), (0.004, high), w.choice((WOOD, DARK, METAL)), tilt=-0.2)
        m.box((0.0, 0.009), (y - wide + 0.015, y + wide - 0.015), (0.02, high - 0.015), w.choice(ACCENTS), tilt=-0.2)
        m.box((-0.075, -0.02), around(y, 0.02), (0.0, 0.012), DARK)


def key_bowl(w: Workbench, m: PaletteMesh) -> None:
    """Builds a bowl for keys with mail next to it."""
    m.cup((0.0, 0.0), (0.0, 0.05), 0.085, w.choice((*ACCENTS, WOOD)), sides=8)
    m.box((-0.03, 0.03), (-0.02, 0.0), (0.008, 0.016), METAL)
    for n in range(2):
        m.box((-0.11, 0.0), (0.10, 0.32), (0.003 * n, 0.003 * n + 0.003), (WHITE, CARD)[n], turn=0.3 * n)


def hourglass_box(w: Workbench, m: PaletteMesh) -> None:
    """Builds an hourglass on a closed wooden box."""
    m.box((-0.08, 0.08), (-0.13, 0.13), (0.0, 0.08), w.choice((WOOD, BROWN)))
    m.box((-0.082, 0.082), (-0.132, 0.132), (0.052, 0.058), METAL)
    for z in (0.08, 0.20):
        m.round((0.0, 0.03), [(z, 0.04), (z + 0.012, 0.04)], BROWN, sides=6)
    m.round((0.0, 0.03), [(0.092, 0.032), (0.14, 0.008), (0.148, 0.008), (0.20, 0.032)], TINT, sides=6)


STYLES = (
    Style("objects", "candles", "train", in_one_mesh(candles), ("top", "low", "shelf"), "top"),
    Style("objects", "game_console", "train", in_one_mesh(game_console), ("media", "low"), "top"),
    Style("objects", "twig_jar", "train", in_one_mesh(twig_jar), ("top", "shelf", "table"), "top"),
    Style("objects", "jewel_box", "train", in_one_mesh(jewel_box), ("dresser",), "top"),
    Style("objects", "alarm_clock", "train", in_one_mesh(alarm_clock), ("bedside", "dresser"), "top"),
    Style("objects", "key_bowl", "train", in_one_mesh(key_bowl), ("entry", "media"), "top"),
    Style("objects", "candlesticks", "heldout", in_one_mesh(candlesticks), ("top", "shelf", "table"), "top"),
    Style("objects", "speaker_remote", "heldout", in_one_mesh(speaker_remote), ("media", "low"), "top"),
    Style("objects", "perfumes", "heldout", in_one_mesh(perfumes), ("dresser",), "top"),
    Style("objects", "water_and_phone", "heldout", in_one_mesh(water_and_phone), ("bedside",), "top"),
    Style("objects", "frames", "heldout", in_one_mesh(frames), ("top", "dresser", "entry", "media"), "top"),
    Style("objects", "hourglass_box", "heldout", in_one_mesh(hourglass_box), ("top", "entry", "shelf"), "top"),
)
