"""There are two tiers: `make test` runs samples that change with each commit, `make test-all` runs all cases."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

import pytest

from tests.helpers import sampling, typechecking

os.environ.setdefault("STUBBORN_CACHE_DIR", str(Path(tempfile.gettempdir()) / "stubborn-test-houses"))  # not the user's
os.environ.setdefault("OMP_NUM_THREADS", "1")  # PyTorch's threads and the workers of xdist would fight for the cores
typechecking.install()


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--all-cases", action="store_true", help="every case of every parametrised test, no samples")


def pytest_configure(config: pytest.Config) -> None:
    sampling.ALL_CASES = config.getoption("--all-cases")


def pytest_report_header() -> str:
    return f"cases: {'all' if sampling.ALL_CASES else f'samples of commit {sampling.commit()[:12]}'}"


@pytest.fixture(scope="module")
def house(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The file of a house of one room of 6 x 6 m with a sofa (`tests.helpers.worlds.sofa_room`)."""
    from tests.helpers.worlds import sofa_room

    file = tmp_path_factory.mktemp("house") / "sofa_room.xml"
    file.write_text(sofa_room().spec.to_xml())
    return file
