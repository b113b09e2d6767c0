"""The hash of the code depends on its modules and parameters and not on its location."""

from __future__ import annotations

from pathlib import Path

import pytest

from sim.core.errors import ConfigError
from sim.core.paths import CACHE_VARIABLE, cache_dir, hash_of_packages


@pytest.fixture
def package(tmp_path: Path) -> Path:
    for file, text in (("sim/run.py", "pass"), ("sim/sensors/noise.py", "1"), ("sim/verifiers/noisy.json", "{}")):
        (tmp_path / file).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / file).write_text(text)
    return tmp_path / "sim"


def test_the_houses_in_a_wheel_do_not_change_the_hash(package: Path) -> None:
    before = hash_of_packages(package)
    (package / "assets" / "mjcf_houses" / "train").mkdir(parents=True)
    (package / "assets" / "mjcf_houses" / "train" / "houses.json").write_text("[]")
    assert hash_of_packages(package) == before


@pytest.mark.parametrize("file", ["run.py", "sensors/noise.py", "verifiers/noisy.json"])
def test_every_module_and_every_parameter_changes_the_hash(package: Path, file: str) -> None:
    before = hash_of_packages(package)
    (package / file).write_text("2")
    assert hash_of_packages(package) != before


def test_a_module_under_another_name_changes_the_hash(package: Path) -> None:
    before = hash_of_packages(package)
    (package / "run.py").rename(package / "ran.py")
    assert hash_of_packages(package) != before


def test_parameters_can_be_excluded(package: Path) -> None:
    before = hash_of_packages(package, parameters=False)
    (package / "verifiers" / "noisy.json").write_text("2")
    assert hash_of_packages(package, parameters=False) == before
    (package / "run.py").write_text("2")
    assert hash_of_packages(package, parameters=False) != before


def test_without_a_home_folder_the_variable_of_the_cache_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(CACHE_VARIABLE, "~no-such-user/cache")
    with pytest.raises(ConfigError, match=f"no folder for the cache.*Set {CACHE_VARIABLE} to one"):
        cache_dir()
