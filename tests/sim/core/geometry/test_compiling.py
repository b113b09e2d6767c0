"""Kernels are compiled at their first call and not before."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from sim.core.geometry.compiling import Kernel, must_compile, njit


@njit()
def add_twice(values, more):
    """Adds a number to all values, twice."""
    for i in range(values.size):
        values[i] += twice(more)


@njit()
def twice(value):
    """Returns two times a value."""
    return 2 * value


def test_a_kernel_that_calls_a_later_one_equals_its_function() -> None:
    values = np.arange(3.0)
    add_twice(values, 1.5)
    assert values.tolist() == [3.0, 4.0, 5.0]
    assert type(twice).__module__.startswith("numba.")


def test_a_kernel_keeps_its_docstring_and_is_the_same_function_at_each_call() -> None:
    kernel = njit()(lambda value: value + 1)
    assert isinstance(kernel, Kernel)
    assert (kernel(1), kernel(2)) == (2, 3)
    assert kernel.compiled() is kernel.compiled()
    assert add_twice.__doc__ == "Adds a number to all values, twice."


@pytest.mark.costly
def test_kernels_bring_numba_when_they_are_called_and_not_when_they_are_imported() -> None:
    code = """
import sys
import numpy as np
from stubborn.kernels.grids import distance_within
print("numba" in sys.modules, distance_within(np.ones((1, 1), np.bool_), 1)[0, 0], "numba" in sys.modules)
"""
    output = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert output.split() == ["False", "0.0", "True"]


def test_an_empty_cache_means_that_kernels_are_compiled_first(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sim.core.geometry.compiling.__file__", str(tmp_path / "a/sim/core/geometry/x.py"))
    for variable, caches in (("NUMBA_CACHE_DIR", tmp_path / "chosen"), ("XDG_CACHE_HOME", tmp_path / "home" / "numba")):
        monkeypatch.setenv("NUMBA_CACHE_DIR", "")
        monkeypatch.setenv(variable, str(caches if variable == "NUMBA_CACHE_DIR" else caches.parent))
        for name in ("geometry_0123", "kernels_4567"):
            assert must_compile()
            (caches / name).mkdir(parents=True)
            (caches / name / "kernel.nbi").touch()
        assert not must_compile()
