"""The libraries of a run share the processors with other processes."""

from __future__ import annotations

import subprocess
import sys

import pytest

SCRIPT = """
import os, sys
import sim.app.composition.runner
assert "torch" not in sys.modules
print(os.environ.get("GOMP_SPINCOUNT"), os.environ.get("LP_NUM_THREADS"))
"""


@pytest.mark.costly
def test_a_run_limits_the_spinning_of_threads_before_pytorch_is_imported() -> None:
    printed = subprocess.run([sys.executable, "-c", SCRIPT], capture_output=True, text=True, check=True, env={})
    assert printed.stdout.split() == ["30000", "1"]
