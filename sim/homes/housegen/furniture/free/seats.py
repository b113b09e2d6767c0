"""Free-form chairs, stools, benches, ottomans and sofas of the pool `wide`: any base, seat, back and arms together."""

from __future__ import annotations

import math

from sim.homes.housegen.furniture import parts
from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.chairs import DINING_KG
from sim.homes.housegen.furniture.free.backs import Seat, add_arms, add_back, add_seat
from sim.homes.housegen.furniture.free.bases import LIGHT, LOW, add_base, frame_look, pedestal
from sim.homes.housegen.furniture.item import Look
from sim.homes.housegen.furniture.office_chairs import OFFICE_KG
from sim.homes.housegen.furniture.parts import BOTH_SIDES
from sim.homes.housegen.furniture.shapes import Ring, loft, pillow
from sim.homes.housegen.furniture.workbench import Workbench


def free_chair(w: Workbench) -> None:
    """Builds a dining chair of any base, seat and back, with or without arms."""
    w.mass_kg = DINING_KG
    _chair(w, w.length(0.38, 0.47), w.length(0.38, 0.54), w.length(0.43, 0.48), w.length(0.26, 0.58), arms=0.3)


def free_armchair(w: Workbench) -> None:
    """Builds an easy chair of any base, seat and back, with arms."""
    if w.chance(0.45):
        _upholstered(w, w.length(0.68, 0.98), w.length(0.70, 0.92), places=1)
        return
    _chair(w, w.length(0.48, 0.60), w.length(0.50, 0.66), w.length(0.36, 0.44), w.length(0.34, 0.66), arms=1.0)


def _chair(w: Workbench, deep: float, wide: float, high: float, back: float, *, arms: float) -> None:
    frame, cloth = frame_look(w), parts.upholstery_look(w)
    seat = Seat((-0.5 * deep, 0.5 * deep), 0.5 * wide, high, w.length(0.02, 0.11))
    add_seat(w, seat, frame, cloth)
    if w.chance(0.1):
        pedestal(w, (0.0, 0.0), min(deep, wide) + 0.06, seat.under, frame)
    else:
        add_base(w, seat.x, (-seat.half, seat.half), seat.under, LIGHT, frame)
    lean = w.length(0.02, 0.30) * back
    add_back(w, seat.x[0] + 0.025, w.length(0.8, 1.0) * seat.half, (high - 0.01, high + back), lean, frame, cloth)
    if w.chance(arms):
        add_arms(w, seat, seat.x[0] + 0.02, min(w.length(0.16, 0.25), 0.8 * back), frame, cloth)


def free_office_chair(w: Workbench) -> None:
    """Builds a swivel chair with any seat and back on a star base."""
    w.mass_kg = OFFICE_KG
    frame, cloth, high = w.look(w.choice(("dark", "chrome", "plastic"))), parts.upholstery_look(w), w.length(0.44, 0.52)
    deep, back = w.length(0.42, 0.52), w.length(0.28, 0.72)
    seat = Seat((-0.5 * deep, 0.5 * deep), 0.5 * w.length(0.42, 0.54), high, w.length(0.05, 0.11))
    parts.star_base(w, w.length(0.27, 0.35), w.choice((4, 5, 5)), frame, seat.under + 0.02, castors=w.chance(0.8))
    parts.pad(w, (deep, 2 * seat.half, seat.thick), (0.0, 0.0, high - 0.5 * seat.thick), cloth, 0.4 * seat.thick)
    x, raised = seat.x[0] - 0.01, w.choice((0.0, 0.08, 0.14))
    w.bar((x + 0.1, 0.0, seat.under + 0.01), (x, 0.0, seat.under + 0.01), 0.07, 0.02, frame)
    w.bar((x, 0.0, seat.under), (x - 0.01, 0.0, high + raised + 0.08), 0.07, 0.02, frame)
    for_back = (high + raised, high + raised + back)
    add_back(w, x + 0.012, w.length(0.75, 1.0) * seat.half, for_back, w.length(0.02, 0.2) * back, frame, cloth)
    w.box((x - 0.015, x + 0.03), (-0.9 * seat.half, 0.9 * seat.half), (for_back[0] - 0.03, for_back[0] + 0.02), frame)
    if w.chance(0.6):
        add_arms(w, seat, x + 0.08, w.length(0.18, 0.25), frame, cloth)


def free_bar_stool(w: Workbench) -> None:
    """Builds a bar stool of any base and seat, often with a low back and a foot rest."""
    _stool(w, w.length(0.62, 0.78), w.length(0.30, 0.46))


def free_low_stool(w: Workbench) -> None:
    """Builds a low stool of any base and seat."""
    _stool(w, w.length(0.42, 0.47), w.length(0.28, 0.46))


def _stool(w: Workbench, high: float, wide: float) -> None:
    w.mass_kg = 4.0
    frame, cloth, deep = frame_look(w), parts.upholstery_look(w), wide * w.choice((1.0, 1.0, w.length(0.65, 0.95)))
    seat = Seat((-0.5 * deep, 0.5 * deep), 0.5 * wide, high, w.length(0.02, 0.12))
    if w.chance(0.35):
        cover = w.choice((frame, cloth))
        w.cylinder((0.0, 0.0), (seat.under, high), min(0.5 * deep, seat.half), cover)
    else:
        add_seat(w, seat, frame, cloth)
    inner = 0.68 if w.chance(0.4) else 0.95
    if w.chance(0.25):
        pedestal(w, (0.0, 0.0), wide + 0.08, seat.under, frame)
    else:
        x, y = (inner * seat.x[0], inner * seat.x[1]), (-inner * seat.half, inner * seat.half)
        add_base(w, x, y, seat.under, LIGHT, frame)
    if high > 0.6 and w.chance(0.45):
        back = w.length(0.12, 0.36)
        add_back(w, seat.x[0] + 0.03, 0.85 * seat.half, (high - 0.01, high + back), w.length(0.0, 0.06), frame, cloth)


def free_bench(w: Workbench) -> None:
    """Builds a bench of any base and seat, without a back."""
    _bench(w, back=False)


def free_backed_bench(w: Workbench) -> None:
    """Builds a bench of any base, seat and back, often with arms."""
    _bench(w, back=True)


def _bench(w: Workbench, *, back: bool) -> None:
    frame, cloth = frame_look(w, 0.3), parts.upholstery_look(w)
    wide, deep, high = w.width(0.90, 1.45), w.depth(0.34, 0.46), w.length(0.42, 0.49)
    arm = back and w.chance(0.5)
    seat = Seat((-0.5 * deep, 0.5 * deep), 0.5 * wide - (0.035 if arm else 0.0), high, w.length(0.03, 0.14))
    add_seat(w, seat, frame, cloth)
    add_base(w, seat.x, (-seat.half, seat.half), seat.under, (*LIGHT, "plinth"), frame)
    if back:
        rise = w.length(0.3, 0.5)
        add_back(w, seat.x[0] + 0.03, seat.half, (high - 0.01, high + rise), w.length(0.02, 0.1), frame, cloth)
    if arm:
        add_arms(w, seat, seat.x[0] + 0.03, w.length(0.16, 0.24), frame, cloth)
    w.top((seat.x[0] + 0.08, seat.x[1]), (-0.9 * seat.half, 0.9 * seat.half), high, "seat")


def free_ottoman(w: Workbench) -> None:
    """Builds an ottoman or pouf: a stuffed body of any outline, on feet, a base or the floor."""
    wide, high, cloth = w.length(0.38, 0.72), w.length(0.32, 0.46), parts.upholstery_look(w, 0.3)
    deep = wide * w.choice((1.0, 1.0, w.length(0.6, 0.95)))
    foot = w.choice((0.0, w.length(0.04, 0.20)))
    if foot:
        add_base(w, (-0.42 * deep, 0.42 * deep), (-0.42 * wide, 0.42 * wide), foot, LOW, frame_look(w))
    power, bulge = w.choice((2.0, 2.5, 4.0, 10.0)), w.length(0.8, 1.15)
    levels = ((0.0, 0.85), (0.12, 1.0), (0.5, max(bulge, 0.85)), (0.88, 1.0), (1.0, w.length(0.6, 0.95)))
    tall = high - foot
    rings = [Ring(s * tall, 0.5 * g * deep, 0.5 * g * wide, power=power) for s, g in levels]
    w.mesh(loft(rings, 16, hull=bulge >= 1.0), (0.0, 0.0, foot), cloth)
    if w.chance(0.4):
        band, trim = w.length(0.2, 0.8) * tall, w.new_look("fabric")
        ring = [
            Ring(s, 0.5 * 1.02 * max(bulge, 1.0) * deep, 0.5 * 1.02 * max(bulge, 1.0) * wide, power=power)
            for s in (0.0, 0.02)
        ]
        w.mesh(loft(ring, 16, hull=True), (0.0, 0.0, foot + band), trim, solid=False)


def free_sofa(w: Workbench) -> None:
    """Builds a sofa of any arms, back, cushions and feet."""
    if w.chance(0.15):
        _settee(w)
    else:
        wide = w.width(1.40, 2.35)
        _upholstered(w, wide, w.depth(0.78, 1.02), places=max(1, min(4, round(wide / w.length(0.55, 1.1)))))


def _settee(w: Workbench) -> None:
    """Builds an open frame with a long seat, a back and arms."""
    frame, cloth, wide, deep = frame_look(w, 0.3), parts.upholstery_look(w), w.width(1.40, 1.95), w.depth(0.74, 0.90)
    seat = Seat((-0.5 * deep + 0.14, 0.5 * deep - 0.02), 0.5 * wide - 0.06, w.length(0.38, 0.45), w.length(0.10, 0.18))
    size = (seat.x[1] - seat.x[0], 2 * seat.half, seat.thick)
    parts.pad(w, size, (0.5 * sum(seat.x), 0.0, seat.z - 0.5 * seat.thick), cloth, 0.04)
    add_base(w, seat.x, (-seat.half, seat.half), seat.under, LIGHT, frame)
    back = w.length(0.32, 0.5)
    add_back(w, seat.x[0] + 0.03, seat.half, (seat.z - 0.01, seat.z + back), w.length(0.04, 0.12), frame, cloth)
    add_arms(w, seat, seat.x[0] + 0.03, w.length(0.16, 0.24), frame, cloth)
    w.top((seat.x[0] + 0.1, seat.x[1]), (-seat.half, seat.half), seat.z, "seat")


def _upholstered(w: Workbench, wide: float, deep: float, *, places: int) -> None:
    """Builds a padded body with arms, seat cushions and back cushions."""
    cover, z, foot = parts.upholstery_look(w), w.length(0.38, 0.46), w.choice((0.0, 0.03, w.length(0.06, 0.20)))
    x0, x1, half = -0.5 * deep, 0.5 * deep, 0.5 * wide
    high, arm_kind = w.length(0.66, 1.0), w.choice(("track", "track", "round", "slope", "wing", "none", "wood"))
    arm = {"none": 0.0, "wood": 0.05}.get(arm_kind, w.length(0.07, 0.26 if places > 1 else 0.16))
    inner, thick, back = wide - 2 * arm, w.length(0.10, min(0.22, z - foot - 0.06)), w.length(0.12, 0.26)
    w.box((x0 + 0.02, x1 - 0.02), (-half + 0.02, half - 0.02), (foot, z - thick + 0.01), cover)
    if foot:
        add_base(w, (x0 + 0.02, x1 - 0.04), (-half + 0.02, half - 0.02), foot, LOW, frame_look(w))
    _sofa_arms(w, arm_kind, (x0, x1), half, arm, (foot, z + w.length(0.10, 0.25)), cover)
    pads = w.choice((1, places, places))
    for i in range(pads):
        y = inner * ((i + 0.5) / pads - 0.5)
        size = (deep - back - 0.01, inner / pads - 0.005, thick)
        parts.pad(w, size, (0.5 * back, y, z - 0.5 * thick), cover, w.length(0.2, 0.48) * thick)
    face = _sofa_back(w, x0, inner, back, (foot, z, high), w.choice((1, places, 2 * places)), cover)
    w.top((face, x1), (-0.5 * inner, 0.5 * inner), z, "seat")
    if places > 1:
        parts.throw_cushions(w, face, inner, z, (0, 0, 1, 2, 3), margin=0.26, middle=0.05)


def _sofa_arms(
    w: Workbench, kind: str, x: tuple[float, float], half: float, arm: float, z: tuple[float, float], cover: Look
) -> None:
    low, top = max(0.0, z[0] - 0.02), z[1]
    deep, frame = x[1] - x[0], w.look("wood")
    for side in BOTH_SIDES:
        y = side * (half - 0.5 * arm)
        if kind in ("track", "wing"):
            parts.pad(w, (deep, arm, top - low), (0.0, y, 0.5 * (low + top)), cover, w.length(0.01, 0.05))
        if kind == "wing":
            parts.pad(w, (0.4 * deep, 0.7 * arm, 0.3), (x[0] + 0.22 * deep, y, top + 0.13), cover, 0.02)
        elif kind == "round":
            r = 0.5 * arm + 0.01
            w.box((x[0], x[1] - 0.02), parts.centred(y, 0.8 * arm), (low, top - r), cover)
            w.rod((x[0], y, top - r), (x[1], y, top - r), r, cover)
        elif kind == "slope":
            rings = [Ring(0.0, 0.5 * deep, 0.5 * arm, power=8), Ring(0.4 * (top - low), 0.5 * deep, 0.5 * arm, power=8)]
            rings.append(Ring(top - low, 0.36 * deep, 0.4 * arm, -0.12 * deep, power=5))
            w.mesh(loft(rings, 12, hull=True), (0.0, y, low), cover)
        elif kind == "wood":
            for px in (x[0] + 0.06, x[1] - 0.06):
                w.box(parts.centred(px, 0.04), parts.centred(y, 0.04), (0.0, top), frame)
            w.box((x[0] + 0.02, x[1] - 0.02), parts.centred(y, 0.05), (top - 0.03, top), frame)
            w.box((x[0] + 0.02, x[1] - 0.02), parts.centred(y, 0.04), (0.22, 0.28), frame)


def _sofa_back(
    w: Workbench, x0: float, inner: float, back: float, z: tuple[float, float, float], pads: int, cover: Look
) -> float:
    """Adds the back with its cushions and returns the x of its face."""
    foot, seat, high = z
    kind, lean = w.choice(("block", "cushions", "cushions", "pillows", "channels")), w.length(0.0, 0.14)
    thin = back if kind == "block" else 0.5 * back
    top = high if kind in ("block", "channels") else high - w.length(0.0, 0.12)
    parts.pad(w, (thin, inner, top - foot), (x0 + 0.5 * thin + 0.01, 0.0, 0.5 * (foot + top)), cover, 0.3 * thin)
    if kind == "channels":
        pads = min(12, max(4, round(inner / 0.18)))
    if kind == "block":
        return x0 + back
    for i in range(pads):
        y, each = inner * ((i + 0.5) / pads - 0.5), inner / pads
        tall = high - seat
        at = (x0 + 0.72 * back, y, seat + 0.5 * tall)
        if kind == "pillows":
            shape = pillow((round(tall, 3), round(each - 0.01, 3), round(0.9 * back, 3)), 5.0)
            w.mesh(shape, at, cover, tilt=0.5 * math.pi - lean)
        else:
            depth = 0.6 * back
            parts.pad(w, (depth, each - 0.004, tall + 0.02), at, cover, 0.4 * min(depth, each), tilt=-lean)
    return x0 + back + 0.03


STYLES: tuple[Style, ...] = (
    Style("chair", "free_dining", "wide", free_chair, ("dining",)),
    Style("chair", "free_easy", "wide", free_armchair, ("arm",)),
    Style("chair", "free_office", "wide", free_office_chair, ("office",)),
    Style("stool", "free_bar", "wide", free_bar_stool, ("bar",)),
    Style("stool", "free_low", "wide", free_low_stool, ("low",)),
    Style("seating", "free_plain_bench", "wide", free_bench, ("bench", "plain")),
    Style("seating", "free_backed_bench", "wide", free_backed_bench, ("bench",)),
    Style("seating", "free_ottoman", "wide", free_ottoman, ("ottoman",)),
    Style("sofa", "free_sofa", "wide", free_sofa),
)
