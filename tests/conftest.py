"""There are two tiers: `make test` runs samples that change with each commit, `make test-all` runs all cases."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

import pytest
from hypothesis import settings

from tests.helpers import sampling, typechecking

os.environ.setdefault("STUBBORN_CACHE_DIR", str(Path(tempfile.gettempdir()) / "stubborn-test-houses"))  # not the user's
os.environ.setdefault("STUBBORN_CACHE_MB", "0")  # tests see the code, not what it prepared before
os.environ.setdefault("OMP_NUM_THREADS", "1")  # PyTorch's threads and the workers of xdist would fight for the cores
typechecking.install()
settings.register_profile("untimed", settings.default, deadline=None)  # the first call of a kernel compiles it
settings.load_profile("untimed")


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--all-cases", action="store_true", help="every case of every parametrised test, no samples")


def pytest_configure(config: pytest.Config) -> None:
    sampling.ALL_CASES = config.getoption("--all-cases")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leaves an eighth of the tests that are marked `costly`; a test named on the command line always runs."""
    if any("::" in argument for argument in config.args):
        return
    costly = [item for item in items if item.get_closest_marker("costly")]
    left_out = set(costly) - set(sampling.sample(costly, -(-len(costly) // 8)))
    config.hook.pytest_deselected(items=[item for item in items if item in left_out])
    items[:] = [item for item in items if item not in left_out]


def pytest_report_header() -> str:
    if sampling.ALL_CASES:
        return "cases: all"
    return f"cases: samples of commit {sampling.commit()[:12]}; `make test-all` runs all, as the daily workflow does"


@pytest.fixture(scope="module")
def house(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The file of a house of one room of 6 x 6 m with a sofa (`tests.helpers.worlds.sofa_room`)."""
    from tests.helpers.worlds import sofa_room

    file = tmp_path_factory.mktemp("house") / "sofa_room.xml"
    file.write_text(sofa_room().spec.to_xml())
    return file
