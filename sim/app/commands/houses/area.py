"""The type of the option --area-m2: one floor area, or a range."""

from __future__ import annotations

from typing import Annotated

import tyro

from sim.homes.housegen.config import AreaM2, parse_area, shown_area

Area = Annotated[
    AreaM2 | None,
    tyro.constructors.PrimitiveConstructorSpec(
        nargs=1,
        metavar="M2|M2:M2",
        instance_from_str=lambda words: parse_area(words[0]),
        is_instance=lambda value: value is None or isinstance(value, int | float | tuple),
        str_from_instance=lambda value: [shown_area(value) or "None"],
    ),
]
"""A floor area such as 90, or a range such as 80:120, square metres; None when not given."""
