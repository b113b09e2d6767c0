"""Towels of the pool `wide`."""

from __future__ import annotations

from sim.housegen.furniture import parts
from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.item import Look
from sim.housegen.furniture.parts import BOTH_SIDES
from sim.housegen.furniture.shapes import chamfered_box, drape
from sim.housegen.furniture.workbench import Workbench


def towel_look(w: Workbench) -> Look:
    """Returns a new look for a towel."""
    return w.new_look("towel") if w.chance(0.8) else w.new_look("linen")


def hotel_rack(w: Workbench) -> None:
    """Builds a high wall rack with folded towels on it and a towel over the rail below."""
    width, deep, metal = w.width(0.45, 0.75), w.length(0.20, 0.26), parts.fitting_look(w)
    tall = w.length(0.45, 0.75)
    w.mount_height_m = 1.65 - tall
    for i in range(w.whole(3, 5)):
        x = 0.03 + i * (deep - 0.03) / 4
        w.rod((x, -0.5 * width, tall), (x, 0.5 * width, tall), 0.006, metal)
    for side in BOTH_SIDES:
        y = side * (0.5 * width - 0.01)
        w.box((0.0, deep), (y - 0.006, y + 0.006), (tall - 0.01, tall + 0.02), metal)
        w.box((0.0, 0.012), (y - 0.02, y + 0.02), (tall - 0.12, tall + 0.04), metal)
        w.rod((0.0, y, tall - 0.09), (0.6 * deep, y, tall - 0.09), 0.007, metal)
    w.rod((0.6 * deep, -0.5 * width, tall - 0.09), (0.6 * deep, 0.5 * width, tall - 0.09), 0.008, metal)
    parts.towel_over_bar(
        w,
        0.6 * deep,
        0.0,
        tall - 0.09,
        w.length(0.5, 0.85) * width,
        tall - 0.11,
        w.length(0.5, 0.8) * tall,
        towel_look(w),
    )
    z, cloth = tall + 0.004, towel_look(w)
    for i in range(w.whole(1, 4)):
        thick = w.length(0.04, 0.07)
        size = (0.9 * deep, width * w.length(0.5, 0.85), thick)
        w.mesh(chamfered_box(size, 0.02), (0.03 + 0.45 * deep, 0.0, z + 0.5 * thick), cloth if i % 2 else towel_look(w))
        z += thick - 0.004


def hanging_rungs(w: Workbench) -> None:
    """Builds wooden bars on two cords below a wall rail, with towels over them."""
    width, wood, cord = w.width(0.40, 0.70), w.look("wood"), w.look(w.choice(("leather", "fabric", "metal")))
    count, gap = w.whole(2, 3), w.length(0.34, 0.42)
    tall = count * gap + 0.12
    w.mount_height_m = w.length(1.60, 1.85) - tall
    w.box((0.0, 0.02), (-0.5 * width, 0.5 * width), (tall - 0.05, tall), wood)
    for side in BOTH_SIDES:
        y = side * (0.5 * width - 0.04)
        w.rod((0.0, y, tall - 0.025), (0.07, y, tall - 0.025), 0.008, wood)
        w.box((0.062, 0.070), (y - 0.012, y + 0.012), (0.30, tall - 0.02), cord)
    for i in range(count):
        z = tall - 0.10 - i * gap
        w.rod((0.068, -0.5 * width, z), (0.068, 0.5 * width, z), 0.012, wood)
        if i == 0 or w.chance(0.75):
            wide = w.length(0.4, 0.75) * width
            parts.towel_over_bar(
                w, 0.068, w.length(-0.05, 0.05), z, wide, w.length(0.24, 0.36), w.length(0.15, 0.28), towel_look(w)
            )


def panel_radiator(w: Workbench) -> None:
    """Builds a flat, ribbed or columned upright radiator with one or two bars for towels."""
    width, high = w.width(0.35, 0.60), w.length(1.10, 1.75)
    look, metal = w.look(w.choice(("ceramic", "dark", "lacquer", "glass"))), w.look("chrome")
    w.mount_height_m = w.length(0.15, 0.35)
    kind, y = w.choice(("flat", "ribs", "columns")), 0.5 * width
    if kind == "flat":
        w.box((0.04, 0.06), (-y, y), (0.0, high), look)
    else:
        count = round(width / 0.075)
        for i in range(count):
            c = -y + (i + 0.5) * width / count
            if kind == "ribs":
                w.box((0.04, 0.055), (c - 0.032, c + 0.032), (0.0, high), look)
            else:
                w.rod((0.05, c, 0.0), (0.05, c, high), 0.02, look)
        for z in (0.06, high - 0.06):
            w.box((0.03, 0.05), (-y, y), (z - 0.02, z + 0.02), look)
    for z in (0.1, high - 0.1):
        w.box((0.0, 0.045), (-0.03, 0.03), (z - 0.03, z + 0.03), look)
    for i in range(w.whole(1, 2)):
        z = high * (0.72, 0.36)[i]
        w.rod((0.11, -y, z), (0.11, y, z), 0.010, metal)
        for side in BOTH_SIDES:
            w.rod((0.045, side * (y - 0.03), z), (0.11, side * (y - 0.03), z), 0.008, metal)
        drop = w.length(0.24, 0.32) * high
        parts.towel_over_bar(
            w, 0.11, 0.0, z, w.length(0.6, 0.9) * width, drop, w.length(0.5, 1.0) * drop, towel_look(w)
        )


def towel_line(w: Workbench) -> None:
    """Builds a cord between two wall arms with one to three towels pegged to it."""
    width, metal, count = w.width(0.60, 1.10), w.look("metal"), w.whole(1, 3)
    tall, out = w.length(0.55, 0.85), w.length(0.12, 0.25)
    w.mount_height_m = 1.65 - tall
    z = tall - 0.03
    for side in BOTH_SIDES:
        y = side * (0.5 * width - 0.015)
        w.box((0.0, 0.02), (y - 0.015, y + 0.015), (tall - 0.10, tall), metal)
        w.rod((0.0, y, z), (out, y, z), 0.009, metal)
    w.rod((out, -0.5 * width + 0.01, z), (out, 0.5 * width - 0.01, z), 0.004, w.look("linen"))
    each = (width - 0.08) / count
    low = w.whole(0, count - 1)
    for i in range(count):
        y, drop = -0.5 * width + 0.04 + (i + 0.5) * each, z if i == low else w.length(0.45, 0.95) * z
        wide = min(each - 0.03, w.length(0.3, 0.7))
        w.mesh(
            drape(wide, drop, w.length(0.03, 0.07), w.whole(1, 4)), (out - 0.015, y, z - drop + 0.004), towel_look(w)
        )
        for side in BOTH_SIDES:
            c = y + side * (0.5 * wide - 0.02)
            w.box((out - 0.012, out + 0.03), (c - 0.006, c + 0.006), (z - 0.04, z + 0.03), w.look("wood"), solid=False)


def towel_tiers(w: Workbench) -> None:
    """Builds two or three stepped bars between side plates, with a towel over each."""
    width, metal, count = w.width(0.45, 0.75), parts.fitting_look(w), w.whole(2, 3)
    tall, step = w.length(0.55, 0.80), w.length(0.06, 0.14)
    w.mount_height_m = 1.35 - tall
    top, last = tall - 0.015, 0.06 + 0.075 * (count - 1)
    for side in BOTH_SIDES:
        y = side * (0.5 * width - 0.008)
        w.box((0.0, 0.02), (y - 0.008, y + 0.008), (top - step * count, tall), metal)
        for i in range(count):
            z = top - i * step
            w.rod((0.0, y, z), (0.06 + 0.075 * i, y, z), 0.008, metal)
    for i in range(count):
        x, z = 0.06 + 0.075 * i, top - i * step
        w.rod((x, -0.5 * width, z), (x, 0.5 * width, z), 0.008, metal)
        wide = w.length(0.35, 0.85) * width
        drop = z if i == count - 1 else w.length(0.5, 0.95) * z
        shift = w.length(-0.5, 0.5) * (width - wide - 0.04)
        parts.towel_over_bar(w, x, shift, z, wide, drop, w.length(0.4, 0.9) * drop, towel_look(w))
    w.box((0.0, last), (-0.5 * width, -0.5 * width + 0.01), (top - 0.01, top + 0.01), metal)


def towel_airer(w: Workbench) -> None:
    """Builds a folding drying rack with towels over its wires."""
    width, high, metal = w.width(0.55, 0.95), w.length(0.85, 1.05), w.look(w.choice(("plastic", "steel", "ceramic")))
    y, half, spread = 0.5 * width, w.length(0.24, 0.32), w.length(0.22, 0.30)
    for side in BOTH_SIDES:
        for sign in BOTH_SIDES:
            w.rod((-sign * spread, side * (y - 0.02), 0.0), (sign * half, side * (y - 0.02), high), 0.011, metal)
    for sign in BOTH_SIDES:
        w.rod((sign * spread, -y, 0.012), (sign * spread, y, 0.012), 0.011, metal)
        w.rod((sign * half, -y, high), (sign * half, y, high), 0.011, metal)
    for side in BOTH_SIDES:
        w.rod((-half, side * (y - 0.02), high), (half, side * (y - 0.02), high), 0.010, metal)
    wires = [(-half + (i + 1) * 2 * half / 6, high) for i in range(5)]
    lift = w.length(0.0, 0.22)
    if w.chance(0.6):
        for sign in BOTH_SIDES:
            end = (sign * (half + 0.32), high + lift)
            for side in BOTH_SIDES:
                w.rod((sign * half, side * (y - 0.03), high), (end[0], side * (y - 0.03), end[1]), 0.009, metal)
            w.rod((end[0], -y, end[1]), (end[0], y, end[1]), 0.009, metal)
            wires.append((sign * (half + 0.16), high + 0.5 * lift))
            wires.append(end)
    for x, z in wires:
        w.rod((x, -y + 0.02, z), (x, y - 0.02, z), 0.004, metal)
    for i in w.rng.permutation(len(wires))[: w.whole(2, 4)]:
        x, z = wires[int(i)]
        wide = w.length(0.4, 0.9) * width
        parts.towel_over_bar(
            w, x, w.length(-0.4, 0.4) * (width - wide), z, wide, w.length(0.35, 0.6), w.length(0.3, 0.5), towel_look(w)
        )


def towel_cart(w: Workbench) -> None:
    """Builds a narrow open shelf on feet or castors with folded towels on every tier."""
    width, depth, high = w.width(0.35, 0.60), w.depth(0.28, 0.40), w.length(0.65, 1.30)
    frame, tiers = w.look(w.choice(("wood", "metal", "lacquer", "steel"))), w.whole(2, 4)
    x, y = parts.footprint(depth, width)
    wheels = w.chance(0.4)
    low = 0.06 if wheels else 0.0
    w.legs(x, y, (low, high), 0.022, frame)
    if wheels:
        for sx in BOTH_SIDES:
            for sy in BOTH_SIDES:
                cx, cy = sx * (0.5 * depth - 0.012), sy * (0.5 * width - 0.02)
                w.rod((cx, cy - 0.01, 0.03), (cx, cy + 0.01, 0.03), 0.03, w.look("dark"))
    for i in range(tiers):
        z = 0.14 + i * (high - 0.18 - 0.14) / (tiers - 1)
        w.box(x, y, (z - 0.015, z), frame)
        room = (high - 0.32) / (tiers - 1) if i < tiers - 1 else 0.25
        stacks = 2 if width > 0.48 and w.chance(0.6) else 1
        for k in range(stacks):
            c, base = (k - 0.5 * (stacks - 1)) * 0.5 * width, z
            for _ in range(w.whole(1, 3)):
                thick = w.length(0.05, 0.08)
                if base + thick > z + room - 0.02:
                    break
                size = (depth - w.length(0.04, 0.08), width * (0.80 if stacks == 1 else 0.42), thick)
                w.mesh(chamfered_box(size, 0.022), (0.0, c, base + 0.5 * thick), towel_look(w))
                base += thick - 0.003
    w.rod((x[1] - 0.01, y[0], high - 0.012), (x[1] - 0.01, y[1], high - 0.012), 0.01, frame)
    w.rod((x[0] + 0.01, y[0], high - 0.012), (x[0] + 0.01, y[1], high - 0.012), 0.01, frame)


def towel_dropped(w: Workbench) -> None:
    """Builds one to three crumpled towels on the floor, sometimes on a folded one."""
    z = 0.0
    if w.chance(0.4):
        w.mesh(
            chamfered_box((w.length(0.4, 0.6), 0.34, 0.04), 0.015),
            (0.0, 0.0, 0.02),
            towel_look(w),
            turn=w.length(0.0, 1.5),
        )
        z = 0.03
    for i in range(w.whole(1, 3)):
        shape = parts.crumpled_cloth(w, w.length(0.35, 0.85), w.length(0.3, 0.55), w.length(0.06, 0.22))
        at = (w.length(-0.1, 0.1), w.length(-0.1, 0.1), z)
        w.mesh(shape, at, towel_look(w), turn=w.length(0.0, 3.0), solid=i == 0)
        z += 0.02


def towel_tray(w: Workbench) -> None:
    """Builds towels in a low box, upright side by side or folded in a pile."""
    wide, deep, rim = w.length(0.26, 0.42), w.length(0.20, 0.28), w.length(0.06, 0.14)
    box = w.look(w.choice(("wicker", "wood", "metal", "plastic")))
    x, y = (-0.5 * deep, 0.5 * deep), (-0.5 * wide, 0.5 * wide)
    parts.basin(w, x, y, rim, rim, 0.012, box)
    upright = w.chance(0.6)
    if upright:
        count = w.whole(3, 5)
        each = (wide - 0.03) / count
        for i in range(count):
            c, tall = y[0] + 0.015 + (i + 0.5) * each, w.length(0.15, 0.24)
            size = (deep - 0.03, each - 0.003, tall)
            w.mesh(chamfered_box(size, 0.025), (0.0, c, 0.012 + 0.5 * tall), towel_look(w))
        return
    z = 0.012
    for i in range(w.whole(2, 4)):
        thick, s = w.length(0.04, 0.07), 1.0 - 0.1 * i
        w.mesh(
            chamfered_box((s * (deep - 0.03), s * (wide - 0.03), thick), 0.02),
            (0.0, 0.0, z + 0.5 * thick),
            towel_look(w),
        )
        z += thick - 0.004


STYLES: tuple[Style, ...] = (
    Style("towel", "hotel_rack", "wide", hotel_rack, ("rail",), "wall"),
    Style("towel", "hanging_rungs", "wide", hanging_rungs, ("rail",), "wall"),
    Style("towel", "panel_radiator", "wide", panel_radiator, ("rail",), "wall"),
    Style("towel", "line", "wide", towel_line, ("rail",), "wall"),
    Style("towel", "tiers", "wide", towel_tiers, ("rail",), "wall"),
    Style("towel", "airer", "wide", towel_airer, ("floor",)),
    Style("towel", "cart", "wide", towel_cart, ("floor",)),
    Style("towel", "dropped", "wide", towel_dropped, ("floor",)),
    Style("towel", "tray", "wide", towel_tray, ("top",), "top"),
)
