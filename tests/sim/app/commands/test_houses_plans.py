"""Plans of generated houses: existing plans are kept, and plans of other options are not reused."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import ModuleType

import pytest

from sim.app.commands.houses import generate
from sim.app.commands.houses import plans as export_plans
from sim.core.interface import ConfigError
from sim.homes.plans.plan import read_plan, write_plan


@pytest.mark.costly
def test_a_plan_that_exists_is_kept_and_one_of_other_options_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    args = export_plans.Args(out=tmp_path, kind="studio", area_m2=52.0)
    assert export_plans.main(args) == 0
    (file,) = tmp_path.glob("*.npz")
    assert read_plan(file).source["area_m2"] == 52.0
    written = file.stat().st_mtime_ns
    capsys.readouterr()
    assert export_plans.main(args) == 0
    assert "train_studio_000000: exists" in capsys.readouterr().out
    assert file.stat().st_mtime_ns == written
    plan = read_plan(file)
    write_plan(file, replace(plan, source={key: plan.source[key] for key in ("pool", "kind", "area_m2", "seed")}))
    assert export_plans.main(args) == 0  # an older version did not name the generator
    with pytest.raises(ConfigError, match="--out"):
        export_plans.main(replace(args, area_m2=55.0))


@pytest.mark.parametrize("option", [{"pool": "heldout"}, {"first_seed": 4}, {"kind": "studio"}, {"area_m2": 60.0}])
def test_an_option_of_generated_houses_is_refused_for_those_of_a_split(tmp_path: Path, option: dict):
    with pytest.raises(ConfigError, match=f"--{next(iter(option)).replace('_', '-')} is for generated houses"):
        export_plans.main(export_plans.Args(out=tmp_path / "plans", split="val", houses=1, **option))
    assert not (tmp_path / "plans").exists()


@pytest.mark.parametrize("command", [export_plans, generate])
def test_more_houses_than_the_split_has_are_refused(tmp_path: Path, command: ModuleType):
    with pytest.raises(ConfigError, match=r"--houses must be at most \d+, all of split 'val', got 1000\."):
        command.main(command.Args(out=tmp_path / "houses", split="val", houses=1000))
    assert not (tmp_path / "houses").exists()
