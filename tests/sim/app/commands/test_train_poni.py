"""The training of the predictor of potentials on two tiny plans: its files, and a run that continues."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from sim.core.interface import ConfigError
from sim.homes.plans.export import export_plans
from sim.homes.plans.plan import read_plan, write_plan
from sim.training.poni.potential_files import held_back
from sim.training.poni.trainer import Args, loss_of, main
from stubborn.exploration.poni_net import CHANNELS, FILES, Predictor
from tests.helpers import wording
from tests.helpers.results import rows
from tests.helpers.worlds import room, with_box


@pytest.fixture
def plans(tmp_path: Path) -> Path:
    """Returns two plans of the same three rooms, of which one is held back."""
    house = with_box(room(14, 5), "toilet_00", centre_m=(6.3, 1.8, 0.3), half_m=(0.3, 0.3, 0.3))
    house = with_box(house, "wall_10", centre_m=(-1.5, 1.2, 1.25), half_m=(0.05, 1.3, 1.25))
    house = with_box(house, "wall_11", centre_m=(3.0, -1.2, 1.25), half_m=(0.05, 1.3, 1.25))
    (plan,) = export_plans(house, {})
    names = [f"house_{number}" for number in range(40)]
    chosen = [next(name for name in names if held_back(Path(f"{name}.npz")) == back) for back in (False, True)]
    for name in chosen:
        write_plan(tmp_path / "plans" / f"{name}.npz", replace(plan, name=name))
    return tmp_path / "plans"


@pytest.mark.costly
def test_training_makes_samples_curves_and_weights_and_continues_a_run(
    tmp_path: Path, plans: Path, capsys: pytest.CaptureFixture[str]
):
    options = {"plans": (plans,), "out": tmp_path / "out", "walks": 2, "maps": 3, "most_steps": 30, "batch": 2}
    assert main(Args(**options, minutes=0.005)) == 0  # type: ignore[arg-type]
    out = tmp_path / "out"
    model, metadata = FILES.load(out / "poni.safetensors")
    assert metadata["plans"] == 2
    maps = Predictor(model).predict(np.zeros((CHANNELS, 128, 128), np.uint8))
    assert np.isfinite(maps).all()
    first = rows(out / "val.csv")
    assert {"step", "area", "objects", "objects_predicted_best", "objects_nearest_best"} <= set(first[0])
    assert (out / "curve.png").stat().st_size > 1000
    samples = {file.name: file.stat().st_mtime_ns for file in (out / "samples").iterdir()}
    assert len(samples) == 2

    capsys.readouterr()
    assert main(Args(**options, minutes=0.05)) == 0  # type: ignore[arg-type]
    printed = capsys.readouterr().out
    assert "2 plans, 0 made" in printed
    assert f"continues from step {first[-1]['step']}," in printed
    assert int(rows(out / "val.csv")[-1]["step"]) > int(first[-1]["step"])
    assert {file.name: file.stat().st_mtime_ns for file in (out / "samples").iterdir()} == samples

    plan = next(plans.iterdir())
    write_plan(plan, replace(read_plan(plan), name="another"))
    with pytest.raises(ConfigError, match=f"plans-{plan.name}' has samples of another plan than '.*{plan.name}'"):
        main(Args(**options, minutes=0.05))  # type: ignore[arg-type]
    write_plan(plan, replace(read_plan(plan), name=plan.stem))

    with pytest.raises(ConfigError, match=r"--seed.*0.*1"):
        main(Args(**options, seed=1))  # type: ignore[arg-type]
    progress = torch.load(out / "state.pt")["progress"]
    torch.save({"progress": progress}, out / "state.pt")
    with pytest.raises(ConfigError, match=wording.IS_OF_ANOTHER_NETWORK):
        main(Args(**options, minutes=0.01))  # type: ignore[arg-type]
    del progress["options"]  # as older versions wrote it
    torch.save({"progress": progress}, out / "state.pt")
    with pytest.raises(ConfigError, match=wording.IS_OF_ANOTHER_VERSION_OF_THIS_COMMAND):
        main(Args(**options, minutes=0.01))  # type: ignore[arg-type]


def test_categories_seen_already_have_no_loss():
    logits, potentials = torch.zeros(2, 3), torch.tensor([[1.0, 0.0, 0.5], [0.0, 1.0, 0.5]])
    potentials[0, 1] = 0.7
    counts = torch.tensor([[True, False, True], [True, True, False]])
    with torch.no_grad():
        logits[0, 1] = 9.0
    area, objects = loss_of(logits, potentials, counts)
    assert float(area) == pytest.approx(np.log(2.0), rel=1e-5)
    assert float(objects) == pytest.approx(np.log(2.0), rel=1e-5)


def test_a_plan_is_held_back_by_its_name_alone():
    files = [Path(f"train_any_{number:06d}.npz") for number in range(240)]
    back = [held_back(file) for file in files]
    assert 15 <= sum(back) <= 45
    assert back == [held_back(Path("samples") / f"train-{file.name}") for file in files]


def test_without_plans_the_folder_is_named(tmp_path: Path):
    with pytest.raises(ConfigError, match="No plan in"):
        main(Args(plans=(tmp_path / "nowhere",), out=tmp_path / "out"))


def test_two_folders_of_one_name_are_refused_and_not_taken_for_one(tmp_path: Path):
    for parent in ("a", "b"):
        (tmp_path / parent / "train").mkdir(parents=True)
        (tmp_path / parent / "train" / "house.npz").touch()
    args = Args(plans=(tmp_path / "a" / "train", tmp_path / "b" / "train"), out=tmp_path / "out")
    with pytest.raises(ConfigError, match=wording.TWO_FOLDERS_OF_ONE_NAME):
        main(args)
