"""Sofas, with loose cushions on them.

Sizes follow Panero & Zelnik (sofa depth 0.81-1.02 m, seat 0.38-0.45 m high, 0.55-0.70 m of width per seat, arms
0.10-0.25 m) and usual retail dimensions (two seats 1.40-1.80 m wide, three seats 1.90-2.40 m).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from sim.homes.housegen.furniture import parts
from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.item import Look
from sim.homes.housegen.furniture.parts import BOTH_SIDES, around, centred, inset
from sim.homes.housegen.furniture.shapes import Ring, chamfered_box, loft, named_mesh
from sim.homes.housegen.furniture.workbench import Workbench


@dataclass(frozen=True)
class _Sofa:
    """The main dimensions of a sofa; x from -depth/2 (back) to depth/2, y from -width/2 to width/2."""

    width: float
    depth: float
    height: float
    seat: float
    arm: float
    back: float

    @property
    def inner(self) -> float:
        """The width between the arms."""
        return self.width - 2 * self.arm

    @property
    def seats(self) -> int:
        """The number of seats side by side."""
        return max(1, round(self.inner / 0.68))


def _measure(w: Workbench, arm: tuple[float, float], height: tuple[float, float] = (0.76, 0.88)) -> _Sofa:
    width, depth, seat = w.width(1.45, 2.30), w.depth(0.84, 0.98), w.length(0.41, 0.45)
    return _Sofa(width, depth, w.length(*height), seat, w.length(*arm), w.length(0.16, 0.22))


def _seat_cushions(w: Workbench, s: _Sofa, look: Look, thick: float) -> None:
    """Adds a row of seat cushions in front of the back."""
    pitch = s.inner / s.seats
    shape = chamfered_box((s.depth - s.back, pitch - 0.006, thick), 0.03)
    for i in range(s.seats):
        w.mesh(shape, (0.5 * s.back, (i + 0.5) * pitch - 0.5 * s.inner, s.seat - 0.5 * thick), look)
    w.top((-0.5 * s.depth + s.back, 0.5 * s.depth), centred(s.inner), s.seat, "seat")


def _back_cushions(w: Workbench, s: _Sofa, look: Look, thick: float = 0.14) -> None:
    """Adds a row of loose back cushions that lean on the back."""
    pitch = s.inner / s.seats
    high = s.height - s.seat + 0.02
    shape = chamfered_box((thick, pitch - 0.01, high), 0.04)
    for i in range(s.seats):
        w.mesh(
            shape,
            (-0.5 * s.depth + s.back + 0.4 * thick, (i + 0.5) * pitch - 0.5 * s.inner, s.seat + 0.5 * high - 0.01),
            look,
            tilt=-0.12,
        )


def _loose_cushions(w: Workbench, s: _Sofa, front_of_back: float) -> None:
    """Adds up to three throw cushions against the back, the outer ones first; hint `cushions` sets their number."""
    hinted = w.hints.get("cushions")
    count = int(hinted) if hinted is not None else w.choice((0, 1, 2, 2, 3))
    places = (0.5 * s.inner - 0.24, -0.5 * s.inner + 0.24, 0.08)
    for y in places[: min(count, 3 if s.inner > 1.5 else 2)]:
        cushion = w.make("cushion", use="throw")
        x = -0.5 * s.depth + front_of_back + 0.5 * cushion.size_m[0] - 0.02
        w.put(cushion, (x, y, s.seat - 0.015), w.length(-0.15, 0.15))


def block_arm(w: Workbench) -> None:
    """Builds a square modern sofa with block arms down to the feet, and seat and back cushions."""
    s, cloth = _measure(w, (0.12, 0.20)), w.look("fabric")
    w.box(centred(s.depth, 0.02), centred(s.inner), (0.10, s.seat - 0.15), cloth)
    w.mesh(
        chamfered_box((s.back, s.inner + 0.02, s.height - 0.16), 0.03),
        (-0.5 * (s.depth - s.back), 0.0, 0.5 * (s.height + 0.04)),
        cloth,
    )
    top = w.length(0.54, 0.64)
    for side in BOTH_SIDES:
        w.mesh(
            chamfered_box((s.depth, s.arm, top - 0.10), 0.025),
            (0.0, side * 0.5 * (s.width - s.arm), 0.5 * (top + 0.10)),
            cloth,
        )
    _seat_cushions(w, s, cloth, 0.15)
    _back_cushions(w, s, cloth)
    w.legs(centred(s.depth, 0.04), centred(s.width, 0.04), (0.0, 0.11), 0.05, w.look("dark"))
    _loose_cushions(w, s, s.back + 0.17)


def rolled_arm(w: Workbench) -> None:
    """Builds a traditional sofa with scrolled arms, one long back and turned feet."""
    s, cloth, wood = _measure(w, (0.18, 0.22), (0.84, 0.94)), w.look("fabric"), w.look("wood")
    w.box(centred(s.depth, 0.03, 0.02), (-0.5 * s.inner - 0.05, 0.5 * s.inner + 0.05), (0.10, s.seat - 0.14), cloth)
    w.mesh(
        chamfered_box((s.back, s.inner + 0.10, s.height - 0.14), 0.05),
        (-0.5 * (s.depth - s.back) + 0.02, 0.0, 0.5 * (s.height + 0.10)),
        cloth,
        tilt=-0.08,
    )
    r = 0.5 * s.arm
    for side in BOTH_SIDES:
        y = side * (0.5 * s.width - r)
        w.box(centred(s.depth, 0.04, 0.03), around(y, 0.7 * r), (0.10, 0.60), cloth)
        w.rod_x((y, 0.60), (-0.5 * s.depth + 0.03, 0.5 * s.depth), r, cloth)
        w.rod_x((y, 0.60), (0.5 * s.depth, 0.5 * s.depth + 0.01), 0.7 * r, wood, solid=False)
    _seat_cushions(w, s, cloth, 0.16)
    for sx in centred(s.depth, 0.08, 0.07):
        for side in BOTH_SIDES:
            w.cylinder((sx, side * (0.5 * s.width - 0.09)), (0.0, 0.11), 0.028, wood)
    _loose_cushions(w, s, s.back + 0.05)


def wooden_frame(w: Workbench) -> None:
    """Builds a slim Scandinavian sofa with open wooden arms and legs and loose cushions."""
    s, cloth, wood = _measure(w, (0.06, 0.08), (0.76, 0.84)), w.look("fabric"), w.look("wood")
    half = 0.5 * s.width - 0.025
    for y in (-half, half):
        w.bar((0.5 * s.depth - 0.06, y, 0.0), (0.5 * s.depth - 0.10, y, 0.58), 0.04, 0.04, wood)
        w.bar((-0.5 * s.depth + 0.08, y, 0.0), (-0.5 * s.depth + 0.14, y, 0.58), 0.04, 0.04, wood)
        w.box(centred(s.depth, 0.06, 0.04), around(y, 0.025), (0.57, 0.60), wood)
    for x in (0.5 * s.depth - 0.10, -0.5 * s.depth + 0.12):
        w.box(around(x, 0.015), (-half, half), (s.seat - 0.24, s.seat - 0.16), wood)
    w.box(centred(s.depth, 0.12, 0.10), (-half + 0.02, half - 0.02), (s.seat - 0.18, s.seat - 0.15), wood)
    w.bar(
        (-0.5 * s.depth + 0.12, 0.0, s.seat - 0.18),
        (-0.5 * s.depth + 0.02, 0.0, s.height - 0.06),
        2 * half - 0.04,
        0.025,
        wood,
    )
    _seat_cushions(w, s, cloth, 0.16)
    _back_cushions(w, s, cloth, 0.15)
    _loose_cushions(w, s, s.back + 0.16)


def chesterfield(w: Workbench) -> None:
    """Builds a leather sofa with arms as high as the back, all three rolled, and rows of buttons."""
    s, hide = _measure(w, (0.20, 0.24), (0.70, 0.76)), w.look("leather")
    r = 0.5 * s.arm
    w.box(centred(s.depth, 0.05, 0.03), centred(s.width, 0.05), (0.09, s.seat - 0.14), hide)
    w.box((-0.5 * s.depth + 0.05, -0.5 * s.depth + 0.19), centred(s.width, 0.05), (0.2, s.height - r), hide)
    w.rod_y((-0.5 * s.depth + r, s.height - r), centred(s.width, r), r, hide)
    for side in BOTH_SIDES:
        y = side * (0.5 * s.width - r)
        w.rod_x((y, s.height - r), centred(s.depth, r, 0.02), r, hide)
        w.ball((-0.5 * s.depth + r, y, s.height - r), r, hide)
        w.box(centred(s.depth, 0.05, 0.03), around(y, 0.6 * r), (0.2, s.height - r), hide)
    _seat_cushions(w, s, hide, 0.15)
    for i in range(4):
        w.ellipsoid(
            (-0.5 * s.depth + 0.195, (i - 1.5) * s.inner / 4, 0.5 * (s.seat + s.height) - 0.02),
            (0.012, 0.018, 0.018),
            w.look("brass"),
            solid=False,
        )
    w.legs(centred(s.depth, 0.06, 0.05), centred(s.width, 0.06), (0.0, 0.10), 0.06, w.look("wood"))
    _loose_cushions(w, s, 2 * r)


def corner(w: Workbench) -> None:
    """Builds an L-shaped sofa with a long seat (chaise) at one end."""
    width, depth, chaise = w.width(2.20, 2.80), 0.92, w.depth(1.45, 1.65)
    s = _Sofa(width, depth, w.length(0.78, 0.86), w.length(0.41, 0.44), w.length(0.14, 0.20), 0.18)
    cloth, side = w.look("fabric"), w.choice(BOTH_SIDES)
    far = side * 0.5 * width  # outer edge of the chaise
    wide = 0.80
    x0, inner = -0.5 * depth, 0.5 * width - wide
    w.box((x0, x0 + chaise - 0.02), parts.on_side(side, inner, 0.5 * width), (0.10, s.seat - 0.14), cloth)
    w.box((x0, 0.5 * depth - 0.02), parts.on_side(side, -0.5 * width, inner), (0.10, s.seat - 0.14), cloth)
    w.mesh(
        chamfered_box((s.back, width, s.height - 0.10), 0.03), (x0 + 0.5 * s.back, 0.0, 0.5 * (s.height + 0.10)), cloth
    )
    w.mesh(chamfered_box((depth, s.arm, 0.52), 0.03), (0.0, -far + side * 0.5 * s.arm, 0.36), cloth)
    w.mesh(
        chamfered_box((chaise - s.back, wide - 0.006, 0.15), 0.03),
        (x0 + 0.5 * (chaise + s.back), far - side * 0.5 * wide, s.seat - 0.075),
        cloth,
    )
    rest = width - wide - s.arm
    seats = max(1, round(rest / 0.72))
    for i in range(seats):
        y = -far + side * (s.arm + (i + 0.5) * rest / seats)
        w.mesh(
            chamfered_box((depth - s.back, round(rest / seats - 0.006, 3), 0.15), 0.03),
            (0.5 * s.back, y, s.seat - 0.075),
            cloth,
        )
    total, pitch = width - s.arm, (width - s.arm) / (seats + 1)
    for i in range(seats + 1):
        y = -far + side * (s.arm + (i + 0.5) * pitch)
        w.mesh(
            chamfered_box((0.14, round(pitch - 0.01, 3), s.height - s.seat + 0.02), 0.04),
            (x0 + s.back + 0.055, y, 0.5 * (s.height + s.seat)),
            cloth,
            tilt=-0.12,
        )
    for x, y in (
        (x0 + 0.05, -far + side * 0.05),
        (x0 + 0.05, far - side * 0.05),
        (0.5 * depth - 0.07, -far + side * 0.05),
        (x0 + chaise - 0.07, far - side * 0.05),
        (x0 + chaise - 0.07, far - side * (wide - 0.05)),
    ):
        w.cylinder((x, y), (0.0, 0.11), 0.022, w.look("dark"))
    w.top((x0 + s.back + 0.1, 0.5 * depth), centred(total, 0.3), s.seat, "seat")
    moved = _Sofa(width, depth, s.height, s.seat, s.arm + 0.08, s.back)
    _loose_cushions(w, moved, s.back + 0.16)


def daybed(w: Workbench) -> None:
    """Builds a couch without a back: slatted metal ends, one mattress, and bolsters along the wall."""
    width, depth, seat = w.width(1.85, 2.05), w.depth(0.80, 0.95), w.length(0.42, 0.46)
    metal, cloth = w.look("iron"), w.look("fabric")
    half, x0, x1 = 0.5 * width, -0.5 * depth, 0.5 * depth
    w.box((x0 + 0.02, x1 - 0.02), (-half + 0.02, half - 0.02), (seat - 0.22, seat - 0.16), metal)
    w.mesh(chamfered_box((depth - 0.05, width - 0.06, 0.17), 0.04), (0.0, 0.0, seat - 0.085), cloth)
    top = w.length(0.74, 0.86)
    for y in inset((-half, half), 0.015):
        for x in (x0 + 0.015, x1 - 0.015):
            w.cylinder((x, y), (0.0, top), 0.015, metal)
        w.rod_x((y, top - 0.01), (x0 + 0.015, x1 - 0.015), 0.012, metal)
        for i in range(3):
            x = x0 + depth * (i + 1) / 4
            w.cylinder((x, y), (seat - 0.2, top - 0.01), 0.008, metal)
    w.rod_y((x0 + 0.015, top - 0.01), (-half + 0.015, half - 0.015), 0.012, metal)
    for i in range(3):
        pitch = (width - 0.08) / 3
        w.mesh(
            chamfered_box((0.18, round(pitch - 0.01, 3), 0.38), 0.06),
            (x0 + 0.14, (i - 1) * pitch, seat + 0.18),
            w.look("bedding"),
            tilt=-0.12,
        )
    w.top((x0 + 0.25, x1), (-half + 0.1, half - 0.1), seat, "seat")
    _loose_cushions(w, _Sofa(width, depth, top, seat, 0.05, 0.2), 0.26)


def camelback(w: Workbench) -> None:
    """Builds a sofa with a curved wooden crest that rises in the middle, slender legs and thin arms."""
    s, cloth, wood = _measure(w, (0.10, 0.13), (0.86, 0.96)), w.look("fabric"), w.look("wood")
    x0, half = -0.5 * s.depth, 0.5 * s.width
    w.mesh(chamfered_box((s.depth - 0.04, s.width - 0.04, 0.18), 0.03), (0.0, 0.0, s.seat - 0.20), cloth)
    crest = [(half * t, s.height - 0.03 - 0.20 * t * t) for t in (-1.0, -0.72, -0.4, 0.0, 0.4, 0.72, 1.0)]
    back = [(x, y, z) for x in (0.0, 0.12) for y, z in (*crest, (-half, s.seat - 0.2), (half, s.seat - 0.2))]
    w.mesh(named_mesh("crest", back), (x0, 0.0, 0.0), cloth)
    w.bent_rod([(x0 + 0.06, y, z) for y, z in crest], 0.025, wood)
    for y in inset((-half, half), 0.5 * s.arm):
        w.box((x0 + 0.06, 0.5 * s.depth - 0.05), around(y, 0.05), (s.seat - 0.22, 0.60), cloth)
        w.rod((x0 + 0.08, y, 0.61), (0.5 * s.depth - 0.06, y, 0.60), 0.075, cloth, round_ends=True)
    _seat_cushions(w, s, cloth, 0.14)
    _back_cushions(w, replace(s, height=s.height - 0.06), cloth, 0.12)  # below the crest
    w.legs((x0 + 0.03, 0.5 * s.depth - 0.05), (-half + 0.05, half - 0.05), (0.0, s.seat - 0.22), 0.045, wood)
    _loose_cushions(w, s, s.back)


def bubble(w: Workbench) -> None:
    """Builds a low, round-ended modern sofa with a thick oval seat, one curved back and no arms."""
    width, depth, seat, height = w.width(1.70, 2.30), w.depth(0.90, 1.0), w.length(0.40, 0.43), w.length(0.70, 0.78)
    cloth = w.look("fabric")
    r, half = 0.5 * depth, 0.5 * width
    w.mesh(
        loft(
            [Ring(0.0, r - 0.10, half - 0.12, power=3.5), Ring(0.07, r - 0.08, half - 0.10, power=3.5)], 16, hull=True
        ),
        (0.0, 0.0, 0.0),
        w.look("dark"),
    )
    rings = [
        Ring(0.06, 0.95 * r, 0.97 * half, power=3.5),
        Ring(0.16, r, half, power=3.5),
        Ring(seat - 0.08, r, half, power=3.5),
        Ring(seat, 0.90 * r, 0.95 * half, power=3.5),
    ]
    w.mesh(loft(rings, 20, hull=True), (0.0, 0.0, 0.0), cloth)
    w.top((-r + 0.28, r - 0.10), (-half + 0.4, half - 0.4), seat, "seat")
    thick = 0.13
    arc = [
        (0.05, half - thick),
        (-0.45 * r, half - thick - 0.04),
        (-r + thick + 0.05, half - 0.42),
        (-r + thick, 0.45 * half - 0.05),
    ]
    spine = [*arc, *[(x, -y) for x, y in reversed(arc)]]
    ends = (spine[0], spine[-1])
    w.bent_rod([(x, y, height - thick - (0.16 if (x, y) in ends else 0.0)) for x, y in spine], thick, cloth)
    w.bent_rod([(x, y, seat) for x, y in spine[1:-1]], thick - 0.01, cloth)
    _loose_cushions(w, _Sofa(width, depth, height, seat, 0.45, 0.26), 0.28)


STYLES = (
    Style("sofa", "block_arm", "train", block_arm),
    Style("sofa", "rolled_arm", "train", rolled_arm),
    Style("sofa", "wooden_frame", "train", wooden_frame),
    Style("sofa", "chesterfield", "train", chesterfield),
    Style("sofa", "corner", "train", corner, ("corner",)),
    Style("sofa", "daybed", "heldout", daybed),
    Style("sofa", "camelback", "heldout", camelback),
    Style("sofa", "bubble", "heldout", bubble, ("corner",)),
)
