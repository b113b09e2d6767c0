"""Serves detectors in the forms of VLFM's four model servers, from the simulator's truth or from the shipped network.

    stubborn serve detectors --source noisy

GroundingDINO, BLIP-2, MobileSAM and YOLOv7 have ports 12181 to 12184, as in VLFM and ApexNav; each port answers all
forms. A simulator registers its frames there (docs/habitat.md).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from msgspec import Meta

from sim.app.services.detectors import Source, make_detector
from sim.app.services.hosting import in_address, listen, require_web, serve

PORTS = 4


@dataclass(frozen=True, kw_only=True)
class Args:
    """Serve detectors in the forms of VLFM's model servers."""

    source: Source = "truth"
    """truth: exact boxes and masks; noisy: the truth with the errors of a network; network: the shipped network."""
    port: Annotated[int, Meta(ge=1, le=65535 - PORTS + 1)] = 12181
    """First of the four ports."""
    host: str = "127.0.0.1"
    """Address to listen on. There is no password."""


def main(args: Args) -> int:
    """Serves until it is interrupted; returns the exit status."""
    require_web()
    sockets = [listen(args.host, args.port + number) for number in range(PORTS)]
    from sim.app.services.server import make_app

    ports = f"ports {args.port} to {args.port + PORTS - 1}"
    where = f"Detectors ({args.source}) on http://{in_address(args.host)}, {ports}."
    serve(make_app(make_detector(args.source)), sockets, where)
    return 0
