"""Demonstrations are rendered from runs and from plans, and a policy learns from them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sim.app.commands.run import entry
from sim.core.interface import MPCAT40_ID, Action, ConfigError
from sim.training.cloned import trainer
from sim.training.cloned import trainer as train_cloned
from sim.training.cloned.demonstrations import (
    Demonstration,
    list_demonstrations,
    read_demonstration,
    write_demonstration,
)
from stubborn.baselines.cloned_net import FILES
from tests.helpers import wording
from tests.helpers.results import rows
from tools.training import plan_demonstrations, render_demonstrations


def rule(house: str, *, seed: int) -> Demonstration:
    """Returns an episode with a rule: turn to the side of the bed, drive on if there is no bed, stop at the end."""
    rng = np.random.default_rng(seed)
    n = 12
    actions = rng.integers(1, 4, n).astype(np.uint8)
    actions[-1] = Action.STOP
    semantic = np.full((n, 48, 64), MPCAT40_ID["wall"], np.uint8)
    for step, action in enumerate(actions.tolist()):
        if action in (Action.TURN_LEFT, Action.TURN_RIGHT):
            semantic[step, 20:, slice(0, 24) if action == Action.TURN_LEFT else slice(40, 64)] = MPCAT40_ID["bed"]
        elif action == Action.STOP:
            semantic[step, 20:] = MPCAT40_ID["bed"]
    return Demonstration(
        depth_mm=np.full((n, 48, 64), 2000, np.uint16),
        semantic=semantic,
        poses=np.zeros((n, 3), np.float32),
        actions=actions,
        goal="bed",
        house=house,
        success=True,
    )


@pytest.mark.slow
def test_a_training_learns_a_rule_and_is_continued(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    for number in range(60):  # house_0 is held back
        write_demonstration(tmp_path / "shown" / f"{number}.npz", rule(f"house_{number % 5}", seed=number))
    args = train_cloned.Args(
        demonstrations=(tmp_path,), out=tmp_path / "out", minutes=0.05, streams=6, length=12, rate=5e-3
    )
    assert train_cloned.main(args) == 0
    first = rows(tmp_path / "out" / "val.csv")
    assert (tmp_path / "out" / "curve.png").stat().st_size > 1000
    _, card = FILES.load(tmp_path / "out" / "cloned.safetensors")
    assert card["demonstrations"] == 48
    assert card["frames"] == 48 * 12

    capsys.readouterr()
    assert train_cloned.main(args) == 0
    assert "nothing to do" in capsys.readouterr().out
    assert rows(tmp_path / "out" / "val.csv") == first
    with (tmp_path / "out" / "val.csv").open("a") as stream:  # as if the process was killed after an evaluation
        stream.write(",".join(["999999", *list(first[-1].values())[1:]]) + "\n")
    assert train_cloned.main(replace(args, minutes=0.4)) == 0
    assert f"continues from step {first[-1]['step']}," in capsys.readouterr().out
    steps = [int(row["step"]) for row in rows(tmp_path / "out" / "val.csv")]
    assert steps == sorted(steps)
    assert 999999 not in steps


@pytest.mark.costly
def test_training_lowers_the_loss_on_the_demonstrated_actions(tmp_path: Path):
    shown = [trainer.labelled_steps_of(rule("house_1", seed=seed), Path("a")) for seed in range(20)]
    args = train_cloned.Args(demonstrations=(), out=tmp_path, streams=6, length=12, rate=5e-3)
    training = trainer.Trainer(args, shown, shown[:4], [])
    losses = []
    for _ in range(30):
        losses.append(training.train_once()["cross_entropy"])
    assert np.mean(losses[-5:]) < 0.5 * np.mean(losses[:5])


def test_an_evaluation_takes_at_most_the_given_number(tmp_path: Path):
    shown = [trainer.labelled_steps_of(rule("house_0", seed=seed), Path("a")) for seed in range(7)]
    args = train_cloned.Args(demonstrations=(), out=tmp_path, val_count=4)
    assert len(trainer.Trainer(args, shown, shown, []).val) == 4


def test_other_options_and_other_demonstrations_do_not_continue_a_run(tmp_path: Path):
    for number in range(8):  # house_0 is held back
        write_demonstration(tmp_path / "shown" / f"{number}.npz", rule(f"house_{number % 4}", seed=number))
    args = train_cloned.Args(
        demonstrations=(tmp_path / "shown",), out=tmp_path / "out", minutes=1e-4, streams=2, length=4
    )
    assert train_cloned.main(args) == 0
    assert train_cloned.main(replace(args, minutes=2e-4, threads=2)) == 0
    with pytest.raises(ConfigError, match=r"--rate.*0\.0015.*0\.003"):
        train_cloned.main(replace(args, rate=3e-3))
    write_demonstration(tmp_path / "shown" / "9.npz", rule("house_0", seed=9))
    with pytest.raises(ConfigError, match=r"--demonstrations.*8.*\(hash.*\w+\).*9"):
        train_cloned.main(args)


def test_demonstrations_of_too_few_houses_and_another_size_are_refused(tmp_path: Path):
    args = train_cloned.Args(demonstrations=(tmp_path / "shown",), out=tmp_path / "out")
    write_demonstration(tmp_path / "shown" / "a.npz", rule("house_1", seed=0))
    with pytest.raises(ConfigError, match=wording.N_1_DEMONSTRATIONS_TO_TRAIN_ON_AND_0_HELD_BACK):
        train_cloned.main(args)
    small = rule("house_0", seed=0)
    write_demonstration(
        tmp_path / "shown" / "b.npz",
        replace(small, semantic=small.semantic[:, ::2, ::2], depth_mm=small.depth_mm[:, ::2, ::2]),
    )
    with pytest.raises(ConfigError, match=r"b\.npz.*32.*24.*64.*48"):
        train_cloned.main(args)


@pytest.mark.costly
def test_searches_in_plans_are_rendered_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    args = plan_demonstrations.Args(out=tmp_path, houses=1, episodes=2, kind="studio")
    assert plan_demonstrations.main(args) == 0
    files = list_demonstrations([tmp_path])
    assert f"{len(files)} episodes with" in capsys.readouterr().out
    shown = read_demonstration(files[0])
    assert shown.actions[-1] == Action.STOP
    assert (shown.semantic[-4:] == MPCAT40_ID[shown.goal]).any()
    times = [file.stat().st_mtime_ns for file in files]
    assert plan_demonstrations.main(args) == 0
    assert [file.stat().st_mtime_ns for file in files] == times
    with pytest.raises(ConfigError, match=wording.TAKE_ANOTHER_FOLDER):
        plan_demonstrations.main(replace(args, episodes=3))


@pytest.mark.costly
def test_the_episodes_of_a_run_are_rendered_at_their_poses(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    run = tmp_path / "oracle"
    words = ["--agent", "oracle", "--split", "val", "--episodes", "1", "--record", "--out", str(run)]
    assert entry(words) == 0
    args = render_demonstrations.Args(runs=(run,), out=tmp_path / "shown")
    assert render_demonstrations.main(args) == 0
    (file,) = list_demonstrations([tmp_path / "shown"])
    assert file.parent.name == "oracle"
    shown = read_demonstration(file)
    assert shown.actions[-1] == Action.STOP
    assert (shown.semantic[-1] == MPCAT40_ID[shown.goal]).any()
    capsys.readouterr()
    assert render_demonstrations.main(args) == 0
    assert "0 episodes to render" in capsys.readouterr().out
    with pytest.raises(ConfigError, match="'oracle'"):
        render_demonstrations.main(replace(args, runs=(run, run)))
    (run / "trajectories" / f"{file.stem}.npz").unlink()
    with pytest.raises(ConfigError, match=wording.HAS_NO_TRAJECTORY_OF_AN_EPISODE_THAT_SUCCEEDED):
        render_demonstrations.main(args)
