"""What any content of a file may give: a result, or a message of one line that names the file."""

from __future__ import annotations

from collections.abc import Callable

from sim.core.errors import HouseError


def require_result_or_one_line(read: Callable[[], object], named: str) -> None:
    """Requires that a reader returns, or raises a `HouseError` of one line that contains `named`."""
    fault = ""
    try:
        read()
    except HouseError as error:
        fault = str(error)
    assert "\n" not in fault
    assert named in fault or not fault
