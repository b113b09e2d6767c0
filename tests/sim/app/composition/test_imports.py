"""Imports of the user's modules that options name."""

from __future__ import annotations

import signal
from pathlib import Path

import pytest

from sim.app.composition import imports
from sim.app.composition.imports import import_attribute
from sim.core.errors import ConfigError

HANGING = """
import time
while True:
    try:
        time.sleep(60)
    except Exception:
        pass
"""


def test_an_import_that_does_not_end_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(imports, "FACTORY_S", 0.2)
    Path("hanging_module_of_a_test.py").write_text(HANGING)
    before = signal.getsignal(signal.SIGALRM)
    with pytest.raises(ConfigError, match=r"0.2.*s.*line.*5"):
        import_attribute("hanging_module_of_a_test:A")
    assert signal.getsignal(signal.SIGALRM) is before
    assert signal.getitimer(signal.ITIMER_REAL)[0] == 0.0
