"""The fit of the context, from plans of houses to the file that the agent reads."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sim.app.commands.train.context import Args, around, main
from sim.core.interface import ConfigError
from sim.homes.plans.export import export_plans
from sim.homes.plans.plan import Plan, write_plan
from sim.training.plan_split import split_plans
from stubborn.detection.context import OBJECTS, read_context
from tests.helpers.worlds import room, with_box

SINK, TOWEL, BED, CLOTHES = (OBJECTS.index(name) for name in ("sink", "towel", "bed", "clothes"))


@pytest.fixture(scope="module")
def plan() -> Plan:
    """Returns a room with a sink and a towel at one end, and a bed and clothes at the other."""
    house = with_box(room(14, 5), "sink_00", centre_m=(6.3, 1.8, 0.5), half_m=(0.3, 0.3, 0.3))
    house = with_box(house, "towel_00", centre_m=(6.8, 0.5, 1.2), half_m=(0.03, 0.3, 0.3))
    house = with_box(house, "bed_00", centre_m=(-5.5, 1.2, 0.25), half_m=(1.0, 0.8, 0.25))
    house = with_box(house, "clothes_00", centre_m=(-6.8, -0.8, 1.25), half_m=(0.1, 0.3, 0.3))
    (result,) = export_plans(house, {})
    return result


def test_objects_of_a_plan_are_near_others_within_the_radius(plan: Plan):
    seen = [around(plan, 2.5, np.random.default_rng(seed)) for seed in range(40)]
    nearby, category = np.max([scores for scores, _ in seen], axis=0), seen[0][1]
    assert sorted(category.tolist()) == sorted((SINK, TOWEL, BED, CLOTHES))
    for one, other in ((SINK, TOWEL), (TOWEL, SINK), (BED, CLOTHES), (CLOTHES, BED)):
        assert np.flatnonzero(nearby[category == one][0]).tolist() == [other]
    assert not around(plan, 0.5, np.random.default_rng(0))[0].any()


def test_objects_above_the_ceiling_belong_to_the_next_storey(plan: Plan):
    lower = replace(plan, ceiling_m=0.85)  # below the towel and the clothes
    _, category = around(lower, 2.5, np.random.default_rng(0))
    assert sorted(category.tolist()) == sorted((SINK, BED))


def test_it_writes_what_the_agent_reads_and_judges_plans_that_it_held_back(
    plan: Plan, tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    for number in range(60):
        write_plan(tmp_path / "plans" / f"house_{number}.npz", replace(plan, name=f"house_{number}"))
    fitted, held_back = split_plans([tmp_path / "plans"])
    out = tmp_path / "context.json"
    assert main(Args(plans=(tmp_path / "plans",), out=out)) == 0
    content = json.loads(out.read_text())
    assert (content["plans"], content["held_back"]) == (len(fitted), len(held_back))
    assert content["objects"] == 4 * len(fitted)
    assert content["log_loss"] < content["log_loss_of_frequency"] - 0.2
    assert content["command"].endswith(f"--plans {tmp_path / 'plans'} --radius-m 2.5 --seed 0")
    context = read_context(out)
    by_sink = np.zeros((1, len(OBJECTS)), np.float32)
    by_sink[0, SINK] = 1.0
    assert context.log_ratios(by_sink)[0, TOWEL] > context.log_ratios(by_sink)[0, CLOTHES] + 1.0
    assert f"written: {out}" in capsys.readouterr().out


def test_without_plans_it_says_what_to_give(tmp_path: Path):
    with pytest.raises(ConfigError, match="No plan in"):
        main(Args(plans=(tmp_path,), out=tmp_path / "x.json"))
