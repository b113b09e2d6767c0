"""The training of semexp on tiny plans, its files and refused arguments; and the comparison of explorers."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import pytest

from sim.app.commands.train import semexp as train_semexp
from sim.core.interface import ConfigError
from sim.homes.plans.export import export_plans
from sim.homes.plans.plan import write_plan
from sim.training.plan_split import split_plans
from sim.training.semexp.trainer import Run
from stubborn.exploration.semexp import SemExpConfig
from stubborn.exploration.semexp_net import FILES
from tests.helpers import wording
from tests.helpers.gridworld import SMALL_CAMERA
from tests.helpers.results import rows
from tests.helpers.worlds import room, with_box


@pytest.fixture(scope="module")
def plans(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Writes plans of two rooms with a bed in one, under twelve names, some of which are held back."""
    folder = tmp_path_factory.mktemp("plans")
    house = with_box(room(9, 5), "bed_00", centre_m=(3.4, 1.2, 0.3), half_m=(0.9, 0.9, 0.3))
    (plan,) = export_plans(with_box(house, "wall_10", centre_m=(0.5, 1.2, 1.25), half_m=(0.05, 1.3, 1.25)), {})
    for number in range(12):
        write_plan(folder / f"flat_{number:02d}.npz", plan)
        write_plan(folder / f"flat_{number:02d}_storey_1.npz", plan)
    return folder


def options(plans: Path, out: Path, **changes: object) -> train_semexp.Args:
    small = {"envs": 2, "rollout": 4, "batch": 4, "epochs": 1, "print_s": 0.0, "goals": 17, **changes}
    return train_semexp.Args(plans=(plans,), out=out, **small)  # type: ignore[arg-type]


@pytest.mark.costly
def test_a_training_writes_curve_and_weights_and_is_continued(
    plans: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    out = tmp_path / "run"
    assert train_semexp.main(options(plans, out)) == 0
    first = rows(out / "train.csv")
    assert int(first[-1]["goals"]) >= 8
    assert int(first[-1]["steps"]) >= int(first[-1]["goals"])
    before, start = (FILES.load(out / f"{name}.safetensors")[0].state_dict() for name in ("semexp", "start"))
    assert any((before[name] != start[name]).any() for name in before)
    assert "goals 8" in capsys.readouterr().out
    with (out / "train.csv").open("a") as stream:  # a row that was written after the state
        stream.write(",".join("9999" for _ in first[0]) + "\n")
    assert train_semexp.main(options(plans, out, goals=33)) == 0
    again = rows(out / "train.csv")
    assert again[: len(first)] == first
    assert int(again[len(first)]["goals"]) > int(first[-1]["goals"])
    assert "continues from" in capsys.readouterr().out
    after = FILES.load(out / "semexp.safetensors")[0].state_dict()
    assert any((after[name] != before[name]).any() for name in before)
    assert SemExpConfig(weights=str(out / "semexp.safetensors")).make(SMALL_CAMERA).cells == 120
    assert train_semexp.main(options(plans, out, goals=33)) == 0
    assert rows(out / "train.csv") == again
    assert (out / "curve.png").read_bytes()[:4] == b"\x89PNG"


@pytest.mark.costly
def test_other_options_and_other_plans_do_not_continue_a_run(plans: Path, tmp_path: Path):
    out = tmp_path / "run"
    assert train_semexp.main(options(plans, out, goals=8)) == 0
    with pytest.raises(ConfigError, match=r"--rate.*0\.0004.*0\.003"):
        train_semexp.main(options(plans, out, rate=0.003))
    fewer = tmp_path / plans.name
    shutil.copytree(plans, fewer)
    assert train_semexp.main(options(fewer, out, goals=8)) == 0  # the same files
    split_plans([fewer])[0][0].unlink()
    with pytest.raises(ConfigError, match=r"--plans.*\d+.*\(hash.*\w+\).*\d+"):
        train_semexp.main(options(fewer, out, goals=8))


def test_a_broken_state_and_a_folder_without_plans_are_refused(plans: Path, tmp_path: Path):
    with pytest.raises(ConfigError, match="No plan in"):
        train_semexp.main(options(tmp_path / "none", tmp_path / "run"))
    (tmp_path / "run").mkdir(exist_ok=True)
    (tmp_path / "run/state.pt").write_bytes(b"nothing")
    with pytest.raises(ConfigError, match=wording.CANNOT_BE_READ):
        train_semexp.main(options(plans, tmp_path / "run"))


def test_storeys_of_a_house_are_held_back_together_and_stay_so_when_houses_are_added(plans: Path, tmp_path: Path):
    trained, held_back = split_plans([plans])
    assert 0 < len(held_back) < len(trained)
    houses = [{file.stem[:7] for file in part} for part in (trained, held_back)]
    assert not houses[0] & houses[1]
    for file in held_back:
        (tmp_path / file.name).write_bytes(file.read_bytes())
    assert [file.name for file in split_plans([tmp_path])[1]] == [file.name for file in held_back]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"batch": 1}, "must be >= 2, got 1 and 240"),
        ({"envs": 1, "rollout": 1}, "must be >= 2, got 60 and 1"),
    ],
)
def test_options_that_would_fail_later_are_refused(
    plans: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, options: dict[str, Any], message: str
):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ConfigError, match=message):
        train_semexp.main(train_semexp.Args(plans=(plans,), out=tmp_path / "out", minutes=0.01, **options))


def test_plans_that_are_all_held_back_are_refused(plans: Path, tmp_path: Path):
    (tmp_path / "plans").mkdir()
    for file in split_plans([plans])[1]:
        (tmp_path / "plans" / file.name).write_bytes(file.read_bytes())
    with pytest.raises(ConfigError, match=r"\d+.*10"):
        train_semexp.main(train_semexp.Args(plans=(tmp_path / "plans",), out=tmp_path / "out", minutes=0.01))


@pytest.mark.costly
def test_a_state_counts_goals_only_after_the_update_with_them(
    plans: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    saved, save = [], Run.save

    def watched(run: Run) -> None:
        saved.append((run.goals, len(run.policy.optimizer.state)))
        save(run)

    monkeypatch.setattr(Run, "save", watched)
    train_semexp.main(options(plans, tmp_path / "run", save_s=0.0))
    trained = dict(reversed(saved))  # the first state with this number of goals
    assert trained[0] == 0
    assert trained[8] > 0
