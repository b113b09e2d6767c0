"""Televisions, monitors and computers of the pool `wide`."""

from __future__ import annotations

import math

from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.item import Look, MeshShape
from sim.housegen.furniture.parts import BOTH_SIDES
from sim.housegen.furniture.shapes import Ring, chamfered_box, frustum, loft, named_mesh
from sim.housegen.furniture.workbench import Range, Workbench


def _curved_slab(width: float, sag: float, thick: float, high: float) -> MeshShape:
    """Returns a slab from z = 0 whose ends come forward by `sag`, with its middle at x = 0."""
    front = [(sag * (i / 5 - 1) ** 2, 0.5 * width * (i / 5 - 1)) for i in range(11)]
    outline = [*front, *[(px - thick, py) for px, py in reversed(front)]]
    n = len(outline)
    vertices = [(*p, z) for z in (0.0, high) for p in outline]
    faces = []
    for i in range(n):
        j = (i + 1) % n
        faces += [(i, j, n + j), (i, n + j, n + i)]
    for i in range(10):
        a, b, c, d = i, i + 1, n - 2 - i, n - 1 - i
        faces += [(a, c, b), (a, d, c), (n + a, n + b, n + c), (n + a, n + c, n + d)]
    return named_mesh("curved", vertices, faces)


def _framed_screen(
    w: Workbench, x: float, y: Range, z: Range, shell: Look, bezel: float, thick: float, chin: float = 0.0
) -> None:
    """Adds a flat screen in a frame with its face at x; `chin` is the extra height of the frame below."""
    w.box((x - thick, x), y, z, shell)
    inner = (y[0] + bezel, y[1] - bezel), (z[0] + bezel + chin, z[1] - bezel)
    w.box((x - 0.002, x + 0.003), *inner, w.look("screen"), solid=False)


def tv_speakers(w: Workbench) -> None:
    """Builds an early flat television with a thick bezel, visible speakers and a round or square foot."""
    width = w.width(0.65, 1.25)
    shell = w.look(w.choice(("metal", "dark", "plastic", "dark")))
    beside = w.chance(0.6)
    panel = 0.86 * width if beside else width
    lift, chin = w.length(0.05, 0.14), 0.0 if beside else w.length(0.04, 0.11)
    high = w.choice((0.575, 0.62, 0.75)) * panel + chin
    bezel = w.length(0.025, 0.06)
    w.box((-0.03, 0.06), (-0.5 * panel, 0.5 * panel), (lift, lift + high), shell)
    w.box(
        (0.05, 0.063),
        (-0.5 * panel + bezel, 0.5 * panel - bezel),
        (lift + bezel + chin, lift + high - bezel),
        w.look("screen"),
        solid=False,
    )
    cloth = w.look("iron")
    for s in BOTH_SIDES:
        if beside:
            low, top = sorted((s * 0.5 * panel, s * 0.5 * width))
            w.box((-0.02, 0.05), (low, top), (lift + 0.01, lift + high - 0.01), cloth)
        elif chin > 0.05:
            low, top = sorted((s * 0.1 * width, s * 0.46 * width))
            w.box((0.05, 0.064), (low, top), (lift + 0.015, lift + chin), cloth, solid=False)
    hump = frustum((0.6 * high, 0.7 * panel), (0.35 * high, 0.4 * panel), w.length(0.04, 0.1))
    w.mesh(hump, (-0.029, 0.0, lift + 0.5 * high), shell, tilt=-0.5 * math.pi)
    w.box((-0.03, 0.02), (-0.12, 0.12), (0.01, lift + 0.02), shell)
    if w.chance(0.5):
        w.mesh(loft([Ring(0.0, 0.15, 0.24), Ring(0.015, 0.14, 0.23)], 20, hull=True), (0.0, 0.0, 0.0), shell)
    else:
        w.mesh(chamfered_box((0.26, 0.45, 0.024), 0.01), (0.0, 0.0, 0.012), shell)


def tv_serif(w: Workbench) -> None:
    """Builds a television whose frame widens to a ledge above and below, with or without legs."""
    width = w.width(0.70, 1.20)
    shell = w.look(w.choice(("lacquer", "wood", "dark", "plastic")))
    high, ledge = 0.60 * width, w.length(0.06, 0.14)
    legs = w.length(0.10, 0.28) if w.chance(0.6) else 0.0
    y = (-0.5 * width, 0.5 * width)
    _framed_screen(w, 0.02, y, (legs + 0.02, legs + high), shell, w.length(0.02, 0.035), 0.05)
    for z in (legs, legs + high - 0.01):
        w.box((-0.5 * ledge - 0.02, 0.5 * ledge + 0.02), y, (z, z + 0.02), shell)
    if legs:
        wood = w.look("wood")
        for sx in BOTH_SIDES:
            for sy in BOTH_SIDES:
                top = (sx * 0.4 * ledge, sy * 0.36 * width, legs + 0.005)
                w.rod((sx * (0.4 * ledge + 0.4 * legs), sy * 0.44 * width, 0.0), top, 0.012, wood)


def tv_curved(w: Workbench) -> None:
    """Builds a television with a curved screen on a wide foot or two blades."""
    width = w.width(0.95, 1.45)
    dark, lift = w.look(w.choice(("dark", "metal"))), w.length(0.05, 0.12)
    high, sag = 0.575 * width, w.length(0.05, 0.12)
    w.mesh(_curved_slab(width, sag, 0.035, high), (0.0, 0.0, lift), dark)
    w.mesh(
        _curved_slab(width - 0.024, sag * 0.95, 0.01, high - 0.03),
        (0.004, 0.0, lift + 0.018),
        w.look("screen"),
        solid=False,
    )
    if w.chance(0.5):
        w.mesh(_curved_slab(0.6 * width, 0.12, 0.05, 0.016), (0.02, 0.0, 0.0), dark)
        w.box((-0.035, 0.0), (-0.10, 0.10), (0.005, lift + 0.05), dark)
    else:
        for s in BOTH_SIDES:
            at = s * 0.3 * width
            w.bar((-0.13, at, 0.008), (0.15, at + s * 0.03, 0.008), 0.025, 0.016, dark)
            w.box((-0.01, 0.02), (at - 0.015, at + 0.015), (0.005, lift + 0.03), dark)


def tv_wall_framed(w: Workbench) -> None:
    """Builds a wall television, framed like a picture or tilted on a bracket, often with a sound bar."""
    width = w.width(0.80, 1.50)
    w.mount_height_m = 0.95
    shell = w.look(w.choice(("wood", "lacquer", "dark", "metal")))
    bezel, high = w.length(0.015, 0.05), 0.57 * width
    bar = w.chance(0.6)
    z0 = w.length(0.10, 0.17) if bar else 0.0
    y = (-0.5 * width, 0.5 * width)
    tilt = w.length(0.04, 0.12) if w.chance(0.35) else 0.0
    if tilt:
        x = 0.06 + 0.5 * high * math.sin(tilt)
        w.box((x - 0.02, x + 0.02), y, (z0, z0 + high), w.look("dark"), tilt=tilt)
        w.box(
            (x + 0.015, x + 0.023),
            (y[0] + bezel, y[1] - bezel),
            (z0 + bezel, z0 + high - bezel),
            w.look("screen"),
            tilt=tilt,
            solid=False,
        )
        w.box((0.0, x), (-0.15, 0.15), (z0 + 0.4 * high, z0 + 0.6 * high), w.look("iron"))
    else:
        w.box((0.0, 0.02), (-0.4 * width, 0.4 * width), (z0 + 0.1, z0 + high - 0.1), w.look("dark"))
        _framed_screen(w, 0.045, y, (z0, z0 + high), shell, bezel, 0.03)
    if bar:
        half = w.choice((0.25, 0.35, 0.48)) * width
        w.mesh(
            chamfered_box((0.08, round(2 * half, 2), 0.065), 0.015),
            (0.04, 0.0, 0.035),
            w.look(w.choice(("fabric", "dark"))),
        )


def monitor_curved(w: Workbench) -> None:
    """Builds a very wide curved monitor with keyboard and mouse, and sometimes speakers."""
    width, dark = w.length(0.70, 1.10), w.look(w.choice(("dark", "dark", "plastic", "metal")))
    lift, high, sag = w.length(0.08, 0.16), w.length(0.32, 0.40), w.length(0.04, 0.10)
    w.mesh(_curved_slab(width, sag, 0.03, high), (0.0, 0.0, lift), dark)
    w.mesh(
        _curved_slab(width - 0.02, 0.95 * sag, 0.01, high - 0.03),
        (0.004, 0.0, lift + 0.02),
        w.look("screen"),
        solid=False,
    )
    w.box((-0.09, -0.05), (-0.03, 0.03), (0.005, lift + 0.65 * high), dark)
    w.box((-0.06, -0.02), (-0.05, 0.05), (lift + 0.4 * high, lift + 0.65 * high), dark)
    for s in BOTH_SIDES:
        w.bar((-0.08, 0.0, 0.008), (0.14, s * 0.24, 0.008), 0.03, 0.016, dark)
    w.box((0.20, 0.33), (-0.21, w.choice((0.08, 0.21))), (0.0, 0.018), w.look("dark"), solid=False)
    w.ellipsoid((0.26, 0.3, 0.014), (0.055, 0.032, 0.016), w.look("dark"), solid=False)
    if w.chance(0.3):
        for s in BOTH_SIDES:
            at = s * (0.5 * width + 0.08)
            w.box((-0.06, 0.06), (at - 0.05, at + 0.05), (0.0, w.length(0.15, 0.26)), w.look("iron"))


def all_in_one(w: Workbench) -> None:
    """Builds an all-in-one computer on a bent foot with keyboard and mouse."""
    width = w.length(0.50, 0.66)
    metal = w.look(w.choice(("metal", "plastic", "steel", "bright")))
    high, chin, lift = 0.66 * width, w.length(0.0, 0.07), w.length(0.08, 0.12)
    lean = -w.length(0.0, 0.12)
    x = 0.5 * high * math.sin(lean)
    w.box((x - 0.022, x), (-0.5 * width, 0.5 * width), (lift, lift + high), metal, tilt=lean)
    z = (lift + 0.012 + chin, lift + high - 0.012)
    shift = math.sin(lean) * 0.5 * chin
    w.box(
        (x + shift - 0.003, x + shift + 0.004),
        (-0.5 * width + 0.012, 0.5 * width - 0.012),
        z,
        w.look("screen"),
        tilt=lean,
        solid=False,
    )
    foot = w.length(0.16, 0.22)
    w.box((-0.5 * foot, 0.5 * foot), (-0.11, 0.11), (0.0, 0.012), metal)
    w.bar((-0.5 * foot + 0.01, 0.0, 0.006), (x - 0.02, 0.0, lift + 0.4 * high), 0.2, 0.01, metal)
    w.mesh(frustum((0.13, 0.42), (0.12, 0.41), 0.014), (0.24, -0.03, 0.0), metal, solid=False)
    w.box((0.19, 0.29), (-0.22, 0.16), (0.012, 0.017), w.look("appliance"), solid=False)
    w.ellipsoid((0.24, 0.27, 0.012), (0.055, 0.03, 0.014), w.look("appliance"), solid=False)


def desktop_tower(w: Workbench) -> None:
    """Builds a monitor on a riser, on a flat computer case or beside a tower, with keyboard and mouse."""
    shell = w.look(w.choice(("dark", "appliance", "plastic", "metal")))
    wide = w.choice((True, False))
    width = w.length(0.48, 0.60) if wide else w.length(0.36, 0.46)
    high, bezel = (0.60 if wide else 0.80) * width, w.length(0.012, 0.035)
    place = w.choice(("tower", "case", "riser"))
    base = 0.0
    if place == "case":
        base = w.length(0.08, 0.15)
        w.box((-0.2, 0.14), (-0.21, 0.21), (0.0, base), shell)
        w.box((0.139, 0.144), (0.0, 0.17), (0.55 * base, 0.75 * base), w.look("dark"), solid=False)
    elif place == "riser":
        base, wood = w.length(0.08, 0.13), w.look("wood")
        w.box((-0.14, 0.12), (-0.3, 0.3), (base - 0.018, base), wood)
        for s in BOTH_SIDES:
            w.box((-0.13, 0.11), (s * 0.28 - 0.01, s * 0.28 + 0.01), (0.0, base - 0.018), wood)
    else:
        s, tall = w.choice(BOTH_SIDES), w.length(0.34, 0.46)
        near = s * (0.5 * width + 0.06)
        low, top = sorted((near, near + s * w.length(0.16, 0.21)))
        w.box((-0.24, 0.16), (low, top), (0.0, tall), shell)
        w.box((0.158, 0.164), (low + 0.02, top - 0.02), (0.6 * tall, 0.9 * tall), w.look("dark"), solid=False)
    lift = base + w.length(0.07, 0.13)
    _framed_screen(
        w,
        0.03,
        (-0.5 * width, 0.5 * width),
        (lift, lift + high),
        shell,
        bezel,
        w.length(0.03, 0.06),
        w.length(0.0, 0.03),
    )
    w.box((-0.05, 0.0), (-0.035, 0.035), (base + 0.005, lift + 0.4 * high), shell)
    w.mesh(loft([Ring(0.0, 0.11, 0.13), Ring(0.016, 0.10, 0.12)], 16, hull=True), (0.0, 0.0, base), shell)
    w.box((0.19, 0.33), (-0.22, 0.22), (0.0, 0.022), shell, solid=False)
    w.ellipsoid((0.26, 0.29, 0.014), (0.055, 0.032, 0.016), shell, solid=False)


def tv_trolley(w: Workbench) -> None:
    """Builds a screen on a trolley with castors and one or two shelves."""
    width, metal = w.width(0.85, 1.35), w.look(w.choice(("metal", "dark", "bright", "iron")))
    high, z0, half = 0.575 * width, w.length(0.75, 1.05), w.length(0.28, 0.42)
    _framed_screen(w, 0.03, (-0.5 * width, 0.5 * width), (z0, z0 + high), w.look("dark"), w.length(0.01, 0.025), 0.04)
    single = w.chance(0.4)
    tops = z0 + 0.65 * high
    for s in BOTH_SIDES:
        at = s * half
        w.box((-0.28, 0.28), (at - 0.02, at + 0.02), (0.065, 0.095), metal)
        for px in (-0.26, 0.26):
            w.rod((px, at - 0.012, 0.034), (px, at + 0.012, 0.034), 0.034, w.look("rubber"))
            w.box((px - 0.012, px + 0.012), (at - 0.016, at + 0.016), (0.04, 0.07), metal)
        if not single:
            w.rod((-0.05, at, 0.08), (-0.05, 0.5 * at, tops), 0.02, metal)
    w.box((-0.07, -0.03), (-half, half), (0.065, 0.095), metal)
    if single:
        w.box((-0.075, -0.025), (-0.045, 0.045), (0.08, tops), metal)
    w.box((-0.03, 0.0), (-0.5 * half - 0.02, 0.5 * half + 0.02), (z0 + 0.35 * high, tops), metal)
    w.box((-0.06, -0.02), (-0.5 * half - 0.02, 0.5 * half + 0.02), (z0 + 0.35 * high, tops), metal)
    for z in (w.length(0.35, 0.45), z0 - 0.16)[: w.whole(1, 2)]:
        w.box((-0.2, 0.18), (-half - 0.01, half + 0.01), (z, z + 0.018), w.look(w.choice(("dark", "wood"))))
        w.box((-0.05, 0.14), (-0.16, 0.1), (z + 0.018, z + 0.07), w.look("dark"), solid=False)


def tv_column(w: Workbench) -> None:
    """Builds a screen on a tall board or a column with a foot plate and sometimes shelves."""
    width = w.width(0.90, 1.40)
    wood = w.look(w.choice(("wood", "lacquer", "dark")))
    high, z0 = 0.575 * width, w.length(0.55, 0.90)
    _framed_screen(w, 0.03, (-0.5 * width, 0.5 * width), (z0, z0 + high), w.look("dark"), w.length(0.008, 0.02), 0.035)
    top = z0 + w.choice((0.6, 1.12)) * high
    if w.chance(0.5):
        half = w.length(0.12, 0.32)
        w.box((-0.05, 0.0), (-half, half), (0.02, top), wood)
    else:
        half = 0.1
        w.cylinder((-0.045, 0.0), (0.02, z0 + 0.6 * high), 0.04, w.look("metal"))
        w.box((-0.05, 0.0), (-0.16, 0.16), (z0 + 0.3 * high, z0 + 0.6 * high), w.look("metal"))
    if w.chance(0.5):
        w.cylinder((0.0, 0.0), (0.0, 0.022), w.length(0.25, 0.34), wood)
    else:
        w.mesh(chamfered_box((0.46, round(max(2 * half, 0.5), 2), 0.03), 0.008), (0.0, 0.0, 0.015), wood)
    for i in range(w.whole(0, 2)):
        z = 0.26 + 0.2 * i
        if z < z0 - 0.1:
            w.box((-0.04, 0.2), (-0.24, 0.24), (z, z + 0.018), wood)
            w.box((0.02, 0.16), (-0.15, 0.1), (z + 0.018, z + 0.065), w.look("dark"), solid=False)


STYLES: tuple[Style, ...] = (
    Style("tv_monitor", "tv_speakers", "wide", tv_speakers, ("tv",), "top"),
    Style("tv_monitor", "tv_serif", "wide", tv_serif, ("tv",), "top"),
    Style("tv_monitor", "tv_curved", "wide", tv_curved, ("tv",), "top"),
    Style("tv_monitor", "tv_wall_framed", "wide", tv_wall_framed, ("tv_wall",), "wall"),
    Style("tv_monitor", "monitor_curved", "wide", monitor_curved, ("monitor",), "top"),
    Style("tv_monitor", "all_in_one", "wide", all_in_one, ("monitor",), "top"),
    Style("tv_monitor", "desktop_tower", "wide", desktop_tower, ("monitor",), "top"),
    Style("tv_monitor", "tv_trolley", "wide", tv_trolley, ("tv_floor",)),
    Style("tv_monitor", "tv_column", "wide", tv_column, ("tv_floor",)),
)
