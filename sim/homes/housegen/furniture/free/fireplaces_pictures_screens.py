"""Free-form fireplaces, pictures and televisions of the pool `wide`."""

from __future__ import annotations

import math

from sim.homes.housegen.furniture import parts
from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.free.bases import LIGHT, add_base
from sim.homes.housegen.furniture.free.details import logs, painting, wall_above_arch
from sim.homes.housegen.furniture.item import Look
from sim.homes.housegen.furniture.parts import BOTH_SIDES
from sim.homes.housegen.furniture.shapes import Ring, chamfered_box, frustum, loft
from sim.homes.housegen.furniture.workbench import Range, Workbench


def free_fireplace(w: Workbench) -> None:
    """Builds a fireplace of any surround, opening, mantelpiece, hearth and chimney."""
    half, deep, top = 0.5 * w.width(1.0, 1.6), w.length(0.24, 0.45), w.length(0.85, 1.25)
    look = w.look(w.choice(("stone", "masonry", "wood", "lacquer", "ceramic", "metal")))
    mouth, base = w.length(0.42, 0.72) * half, w.choice((0.0, 0.04, w.length(0.08, 0.4)))
    opening = base + w.length(0.45, 0.7)
    top = max(top, opening + 0.14)
    w.box((0.0, 0.04), (-half, half), (0.0, top), w.look("char"))
    w.box((0.04, deep), (-mouth, mouth), (base, base + 0.02), w.look("char"))
    for side in BOTH_SIDES:
        w.box((0.0, deep), parts.on_side(side, mouth, half), (0.0, top), look)
    if w.chance(0.35):
        spring = base + w.length(0.5, 0.8) * (opening - base)
        w.mesh(wall_above_arch((0.03, deep), mouth + 0.002, spring, opening - spring, top), (0.0, 0.0, 0.0), look)
    else:
        w.box((0.0, deep), (-mouth, mouth), (opening, top), look)
    if base:
        w.box((0.0, deep), (-mouth, mouth), (0.0, base), look)
    _dress(w, half, deep, top, mouth, opening, look)
    reach = deep + w.length(0.15, 0.45)
    if w.chance(0.75):
        slab = w.length(0.9, 1.12) * half
        w.box((0.0, reach), (-slab, slab), (0.0, w.choice((0.025, 0.05, max(0.05, base)))), w.look("stone"))
    _chimney(w, half, deep, top + 0.05, look)
    _fire(w, deep, mouth, base + 0.02, opening)


def _dress(w: Workbench, half: float, deep: float, top: float, mouth: float, opening: float, look: Look) -> None:
    """Adds columns, a rim round the opening and a mantelpiece."""
    trim = look if w.chance(0.4) else w.look(w.choice(("stone", "wood", "lacquer", "brass", "dark")))
    kind, out = w.choice(("none", "flat", "round", "rim", "flat")), w.length(0.02, 0.08)
    for side in BOTH_SIDES:
        if kind == "flat":
            w.box((deep, deep + out), parts.on_side(side, half - w.length(0.1, 0.2), half), (0.0, top), trim)
        elif kind == "round":
            w.cylinder((deep + 0.03, side * (half - 0.07)), (0.0, top), 0.05, trim)
        elif kind == "rim":
            w.box((deep - 0.01, deep + 0.02), parts.on_side(side, mouth, mouth + 0.06), (0.0, opening + 0.06), trim)
    if kind == "rim":
        w.box((deep - 0.01, deep + 0.02), (-mouth, mouth), (opening, opening + 0.06), trim)
    if w.chance(0.85):
        over, thick = w.length(0.0, 0.12), w.length(0.03, 0.12)
        w.box((0.0, deep + over + 0.02), (-half - over, half + over), (top, top + thick), trim)
        w.top((0.05, deep), (-half, half), top + thick)


def _chimney(w: Workbench, half: float, deep: float, low: float, look: Look) -> None:
    """Adds a chimney breast, a tapered hood, a flue or nothing above the mantelpiece."""
    kind, high = w.choice(("none", "none", "breast", "hood", "flue")), w.height(2.2, 2.35)
    if kind == "breast":
        w.box((0.0, 0.85 * deep), parts.centred(0.0, 2 * half * w.length(0.55, 0.95)), (low - 0.05, high), look)
    elif kind == "hood":
        wide, back = w.length(0.3, 0.6), 0.5 * deep
        shape = frustum((0.95 * deep, 1.7 * half), (0.5 * deep, wide), high - low + 0.05, (-0.22 * deep, 0.0))
        w.mesh(shape, (back, 0.0, low - 0.05), w.choice((look, w.look("lacquer"))))
    elif kind == "flue":
        w.cylinder((0.5 * deep, 0.0), (low - 0.05, high), w.length(0.06, 0.1), w.look(w.choice(("dark", "metal"))))


def _fire(w: Workbench, deep: float, mouth: float, z: float, opening: float) -> None:
    """Adds a log fire, an iron stove, a glass front or an empty grate in the opening."""
    kind, dark = w.choice(("logs", "logs", "stove", "glass", "grate")), w.look("dark")
    if kind == "stove":
        w.box((0.04, deep + 0.03), (-0.92 * mouth, 0.92 * mouth), (z, z + 0.85 * (opening - z)), dark)
        face = (z + 0.15 * (opening - z), z + 0.7 * (opening - z))
        w.box((deep + 0.025, deep + 0.036), (-0.7 * mouth, 0.7 * mouth), face, w.look("char"), solid=False)
        w.box(
            (deep + 0.03, deep + 0.038),
            (-0.5 * mouth, 0.5 * mouth),
            (face[0], face[0] + 0.06),
            w.look("fire"),
            solid=False,
        )
        return
    logs(w, (0.55 * deep, 0.0, z), 0.6 * mouth, burning=0.0 if kind == "grate" else 0.8)
    if kind == "glass":
        w.box((deep - 0.02, deep - 0.012), (-mouth, mouth), (z - 0.02, opening), w.look("glass"))
    elif kind == "grate":
        for i in range(5):
            y = mouth * (0.3 * i - 0.6)
            w.rod((deep - 0.03, y, z), (deep - 0.03, y, z + 0.18), 0.008, dark, solid=False)
        w.rod((deep - 0.03, -0.7 * mouth, z + 0.18), (deep - 0.03, 0.7 * mouth, z + 0.18), 0.008, dark, solid=False)


def free_picture(w: Workbench) -> None:
    """Builds one to seven pictures of any format in frames, as a group without overlaps."""
    hinted = w.hints.get("width_m") is not None
    wide = w.width(0.30, 1.4)
    high = w.height(0.30, 1.0) if wide < 1.0 or hinted else w.height(0.30, 0.8)
    w.mount_height_m = 1.52 - 0.5 * high
    fields = [((-0.5 * wide, 0.5 * wide), (0.0, high))]
    for _ in range(w.choice((0, 0, 0, 1, 2, 3, 6)) if wide > 0.45 else 0):
        fields.sort(key=lambda f: (f[0][1] - f[0][0]) * (f[1][1] - f[1][0]))
        y, z = fields.pop()
        share, gap = w.length(0.35, 0.65), w.length(0.015, 0.03)
        if y[1] - y[0] > z[1] - z[0]:
            cut = y[0] + share * (y[1] - y[0])
            fields += [((y[0], cut - gap), z), ((cut + gap, y[1]), z)]
        else:
            cut = z[0] + share * (z[1] - z[0])
            fields += [(y, (z[0], cut - gap)), (y, (cut + gap, z[1]))]
    look, border = w.look(w.choice(("wood", "dark", "lacquer", "brass", "metal", "ceramic"))), w.length(0.0, 0.06)
    oval, thick, mat = len(fields) == 1 and w.chance(0.15), w.length(0.012, 0.045), w.length(0.0, 0.1)
    for y, z in fields:
        if oval:
            _oval_picture(w, y, z, thick, border + 0.01, look)
        else:
            _framed(w, y, z, thick, border, mat, look, detailed=len(fields) < 3)


def _framed(
    w: Workbench, y: Range, z: Range, thick: float, border: float, mat: float, look: Look, *, detailed: bool
) -> None:
    small = min(y[1] - y[0], z[1] - z[0])
    b, m = min(border, 0.15 * small), min(mat, 0.2 * small)
    w.box((0.0, thick), y, z, look)
    inner = ((y[0] + b, y[1] - b), (z[0] + b, z[1] - b))
    w.box((0.0, thick + 0.002), *inner, w.look("paper") if m > 0.01 else w.new_look("paint"), solid=False)
    art = ((inner[0][0] + m, inner[0][1] - m), (inner[1][0] + m, inner[1][1] - m))
    ground = w.new_look("paint")
    w.box((0.0, thick + 0.004), *art, ground, solid=False)
    if detailed:
        painting(w, thick + 0.009, *art)
    else:
        cut = art[1][0] + w.length(0.25, 0.7) * (art[1][1] - art[1][0])
        w.box((0.0, thick + 0.006), art[0], (art[1][0], cut), w.new_look("paint"), solid=False)


def _oval_picture(w: Workbench, y: Range, z: Range, thick: float, border: float, look: Look) -> None:
    """Adds an elliptical picture."""
    ry, rz = 0.5 * (y[1] - y[0]), 0.5 * (z[1] - z[0])
    for i, colour in enumerate((look, w.look("paper"), w.new_look("paint"))):
        s = 1.0 - i * border / min(ry, rz)
        rings = [Ring(x, s * rz, s * ry) for x in (0.0, thick + 0.003 * i)]
        w.mesh(loft(rings, 20, hull=True), (0.0, 0.0, 0.5 * (z[0] + z[1])), colour, tilt=0.5 * math.pi, solid=i == 0)


def _screen(w: Workbench, width: float, low: float, x: float) -> float:
    """Adds a panel of any shape and bezel with its lower edge at `low`, and returns its height."""
    high = w.choice((0.57, 0.575, 0.60, 0.66, 0.75)) * width
    bezel, chin, thick = w.length(0.006, 0.05) * min(1.0, width), w.length(0.0, 0.07) * width, w.length(0.02, 0.07)
    shell = w.look(w.choice(("dark", "dark", "plastic", "metal", "lacquer", "wood")))
    y, z = 0.5 * width, (low, low + high + chin)
    if w.chance(0.5):
        w.mesh(chamfered_box((thick, width, z[1] - z[0]), 0.3 * thick), (x, 0.0, 0.5 * (z[0] + z[1])), shell)
    else:
        w.box(parts.centred(x, thick), (-y, y), z, shell)
    face, shown = x + 0.5 * thick, w.look("screen")
    w.box((face - 0.004, face + 0.003), (-y + bezel, y - bezel), (low + bezel + chin, z[1] - bezel), shown, solid=False)
    if w.chance(0.4):
        hump = frustum((0.6 * high, 0.7 * width), (0.3 * high, 0.4 * width), w.length(0.03, 0.25))
        w.mesh(hump, (x - 0.5 * thick + 0.002, 0.0, low + 0.5 * high), shell, tilt=-0.5 * math.pi)
    return z[1] - z[0]


def _foot(w: Workbench, width: float, lift: float, look: Look) -> None:
    """Adds a foot of any kind that holds a panel at the height `lift`."""
    kind = w.choice(("plate", "oval", "blades", "v", "block", "legs"))
    if kind in ("plate", "oval"):
        size = (w.length(0.16, 0.28), width * w.length(0.25, 0.7))
        if kind == "plate":
            w.mesh(chamfered_box((*size, 0.02), 0.008), (0.0, 0.0, 0.01), look)
        else:
            rings = [Ring(0.0, 0.5 * size[0], 0.5 * size[1]), Ring(0.018, 0.45 * size[0], 0.47 * size[1])]
            w.mesh(loft(rings, 18, hull=True), (0.0, 0.0, 0.0), look)
        half = w.length(0.02, 0.15) * width
        w.box((-0.03, 0.0), (-half, half), (0.01, lift + 0.12 * width), look)
    elif kind == "block":
        w.box((-0.09, 0.07), (-0.35 * width, 0.35 * width), (0.0, lift + 0.004), look)
    else:
        reach, at = w.length(0.1, 0.16), w.length(0.2, 0.45) * width
        for side in BOTH_SIDES:
            if kind == "blades":
                w.bar((-reach, side * at, 0.006), (reach, side * at, 0.006), 0.03, 0.012, look)
                w.box((-0.012, 0.012), parts.centred(side * at, 0.03), (0.006, lift + 0.01), look)
            else:
                for sign in BOTH_SIDES:
                    w.rod((sign * reach, side * (at + 0.03), 0.005), (0.0, side * at, lift + 0.01), 0.009, look)


def free_tv(w: Workbench) -> None:
    """Builds a television of any format, bezel and foot."""
    width, lift = w.width(0.70, 1.45), w.length(0.04, 0.14)
    _foot(w, width, lift, w.look(w.choice(("dark", "metal", "plastic", "chrome", "wood"))))
    _screen(w, width, lift, 0.0)


def free_wall_tv(w: Workbench) -> None:
    """Builds a television of any format and bezel on a wall."""
    width = w.width(0.75, 1.5)
    w.mount_height_m = w.length(0.85, 1.15)
    gap = w.length(0.03, 0.09)
    w.box((0.0, gap + 0.03), (-0.15 * width, 0.15 * width), (0.1 * width, 0.4 * width), w.look("dark"))
    high, thick = w.choice((0.56, 0.58, 0.62)) * width, w.length(0.02, 0.06)
    x, bezel = gap + 0.02, w.length(0.004, 0.03)
    w.box(
        (x, x + thick), (-0.5 * width, 0.5 * width), (0.0, high), w.look(w.choice(("dark", "metal", "wood", "lacquer")))
    )
    inner = (-0.5 * width + bezel, 0.5 * width - bezel), (bezel + w.choice((0.0, 0.03)), high - bezel)
    w.box((x + thick - 0.003, x + thick + 0.003), *inner, w.look("screen"), solid=False)
    if w.chance(0.3):
        bar = w.length(0.5, 0.95) * width
        w.box((0.0, x + thick), parts.centred(0.0, bar), (-0.14, -0.06), w.look("dark"))
        w.box((0.0, 0.02), (-0.03, 0.03), (-0.08, 0.12 * width), w.look("dark"))


def free_monitor(w: Workbench) -> None:
    """Builds a monitor of any format and foot, or two of them, often with a keyboard."""
    width, lift = w.length(0.38, 0.85), w.length(0.06, 0.15)
    _foot(w, width, lift, w.look(w.choice(("dark", "metal", "appliance", "chrome"))))
    _screen(w, width, lift, 0.0)
    if w.chance(0.6):
        keys = w.length(0.28, 0.44)
        w.box((0.2, w.length(0.29, 0.34)), parts.centred(0.0, keys), (0.0, 0.02), w.look("appliance"), solid=False)
        w.ellipsoid((0.26, -0.5 * keys - 0.07, 0.014), (0.05, 0.03, 0.015), w.look("dark"), solid=False)


def free_stand_tv(w: Workbench) -> None:
    """Builds a television on its own stand of any base."""
    width, low = w.width(0.85, 1.35), w.length(0.65, 0.95)
    look = w.look(w.choice(("wood", "dark", "metal", "lacquer")))
    table, deep = w.length(0.3, 0.6), w.length(0.34, 0.46)
    x, y = parts.footprint(deep, w.length(0.5, 0.8) * width)
    add_base(w, x, y, table, LIGHT, look)
    w.box(x, y, (table, table + 0.025), look)
    post = w.length(0.025, 0.06)
    w.box((-0.5 * post, 0.5 * post), (-2 * post, 2 * post), (table + 0.02, low + 0.2 * width), look)
    _screen(w, width, low, 0.02 + 0.5 * post)


STYLES: tuple[Style, ...] = (
    Style("fireplace", "free_fireplace", "wide", free_fireplace),
    Style("picture", "free_picture", "wide", free_picture, (), "wall"),
    Style("tv_monitor", "free_tv", "wide", free_tv, ("tv",), "top"),
    Style("tv_monitor", "free_wall", "wide", free_wall_tv, ("tv_wall",), "wall"),
    Style("tv_monitor", "free_monitor", "wide", free_monitor, ("monitor",), "top"),
    Style("tv_monitor", "free_stand", "wide", free_stand_tv, ("tv_floor",)),
)
