import ctypes

import pytest

from sim.app.cli import Terminated
from sim.app.evaluation.watch import is_stop


@pytest.mark.parametrize(("raised", "stops"), [(Terminated, True), (KeyboardInterrupt, True), (ValueError, False)])
def test_a_signal_during_a_call_of_c_ends_the_run(raised: type[BaseException], stops: bool) -> None:
    """Such a call hides the type of the error; the episode was then recorded as one with an error."""

    class Number:
        @classmethod
        def from_param(cls, value: object) -> object:
            raise raised

    function = ctypes.CDLL(None).abs
    function.argtypes = [Number]  # pyright: ignore[reportAttributeAccessIssue]
    with pytest.raises(ctypes.ArgumentError) as caught:
        function(1)
    assert is_stop(caught.value) is stops
