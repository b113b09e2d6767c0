import ctypes
from dataclasses import dataclass

import pytest

from sim.app import cli
from sim.app.cli import Terminated
from sim.app.evaluation.watch import is_stop


@dataclass(frozen=True)
class _NoOptions:
    """A command without options."""


def call_of_c(raised: type[BaseException]) -> int:
    """Calls a function of C; converting its argument raises an error, as the handler of a signal does."""

    class Number:
        @classmethod
        def from_param(cls, value: object) -> object:
            raise raised

    function = ctypes.CDLL(None).abs
    function.argtypes = [Number]  # pyright: ignore[reportAttributeAccessIssue]
    return function(1)


@pytest.mark.parametrize(("raised", "status"), [(Terminated, 143), (KeyboardInterrupt, 130)])
def test_a_signal_during_a_call_of_c_ends_the_run(raised: type[BaseException], status: int) -> None:
    """Such a call hides the type of the error; the episode was then recorded as one with an error."""
    with pytest.raises(ctypes.ArgumentError) as caught:
        call_of_c(raised)
    assert is_stop(caught.value)
    assert cli.run(_NoOptions, lambda _: call_of_c(raised), []) == status


def test_another_error_during_a_call_of_c_is_none_of_a_signal() -> None:
    with pytest.raises(ctypes.ArgumentError) as caught:
        cli.run(_NoOptions, lambda _: call_of_c(ValueError), [])
    assert not is_stop(caught.value)
