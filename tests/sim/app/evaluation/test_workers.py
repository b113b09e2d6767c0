"""Many items on several processes: each gives one line, even if workers die."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from sim.app.evaluation.processes import Isolation, Processes
from sim.app.evaluation.watch import Steps
from sim.app.evaluation.workers import MAX_TRIES, RunnerSpec
from tests.helpers import wording
from tests.helpers.runners import Job

SPEC = RunnerSpec("tests.helpers.runners:make_runner", None)


def jobs(count: int, houses: int = 3) -> list[Job]:
    return [Job(f"job_{i}", f"house_{i % houses}") for i in range(count)]


def never(item: object, reason: str) -> dict:
    raise AssertionError(f"{item} was given up: {reason}")


@pytest.mark.costly
@pytest.mark.parametrize("workers", [1, 2])
def test_each_item_gives_one_line(workers: int) -> None:
    lines = list(Processes(workers).run(SPEC, jobs(12), on_death=never))
    assert sorted(line["episode_id"] for line in lines) == sorted(item.episode_id for item in jobs(12))


@pytest.mark.parametrize("workers", [1, 2])
def test_the_steps_of_an_item_are_seen_where_it_was_started(workers: int) -> None:
    counts: list[Steps] = []
    executor = Processes(workers)
    for line in executor.run(
        SPEC, [Job("seven_7", "h")], on_death=never, on_start=lambda _, steps: counts.append(steps)
    ):
        assert line["episode_id"] == "seven_7"
        assert [steps() for steps in counts] == [7]


def test_one_worker_is_this_process() -> None:
    assert {line["pid"] for line in Processes(1).run(SPEC, jobs(3), on_death=never)} == {os.getpid()}


def test_houses_are_not_changed_more_often_than_needed() -> None:
    for workers in (1, 2):
        lines = list(Processes(workers).run(SPEC, jobs(12, houses=2), on_death=never))
        changes = {line["pid"]: line["changes"] for line in sorted(lines, key=lambda line: line["changes"])}
        assert sum(changes.values()) <= 2 + (workers - 1)


def test_a_killed_worker_costs_its_item_one_more_try(tmp_path: Path) -> None:
    items = [*jobs(6), Job("deadly", "house_0", kill=tmp_path / "died")]
    lines = list(Processes(2).run(SPEC, items, on_death=never))
    assert (tmp_path / "died").exists()
    assert sorted(line["episode_id"] for line in lines) == sorted(item.episode_id for item in items)


@pytest.mark.costly
@pytest.mark.parametrize("executor", [Processes(2), Processes(1, Isolation(needed=True))], ids=["two", "isolated"])
def test_an_item_that_kills_every_worker_becomes_an_error_line(executor: Processes, tmp_path: Path) -> None:
    items = [*jobs(4), Job("deadly", "house_0", kill=tmp_path / "died", always=True)]
    lines = list(executor.run(SPEC, items, on_death=lambda item, why: {"episode_id": item.episode_id, "why": why}))
    assert len(lines) == 5
    assert [(line["episode_id"], line["why"]) for line in lines if "why" in line] == [
        ("deadly", "The process of the worker ended with status -9; 2 workers were lost in this episode.")
    ]
    assert len((tmp_path / "died").read_text()) == MAX_TRIES


@pytest.mark.parametrize("workers", [1, 2])
def test_an_exception_of_the_runner_reaches_the_caller(workers: int) -> None:
    items = [*jobs(3), Job("bad", "house_0", fail=True)]
    with pytest.raises(ValueError, match=wording.BAD_CANNOT_BE_DONE):
        list(Processes(workers).run(SPEC, items, on_death=never))
