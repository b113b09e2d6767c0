"""The progress of a run: which episodes run, at which step, how fast, and how long it takes."""

from __future__ import annotations

import io
import itertools
import re
import threading
import time
from collections.abc import Iterator

import pytest

from sim.app.analysis.display import PlainConsole
from sim.app.analysis.progress import ProgressReport
from sim.app.evaluation.watch import Steps
from sim.core.geometry.pose import Pose
from sim.episodes.episode import Episode
from sim.task.result import EpisodeResult
from tests.helpers.results import a_result

RESULT = a_result(episode_id="e0", goal="tv_monitor", num_steps=3, wall_time_s=1.0)


def episode(name: str) -> Episode:
    return Episode(name, "val_00", "tv_monitor", Pose(0.0, 0.0, 0.0))


def report(*running: tuple[str, Steps], ended: int = 0, total: int = 10, terminal: bool = False) -> list[str]:
    """Returns what is printed when some episodes have ended with 40 steps each and others run for 0.5 s."""
    stream = io.StringIO()
    console = PlainConsole(file=stream, width=200, force_terminal=terminal, color_system=None)
    progress = ProgressReport(console, total=total, max_steps=500, quiet_s=0.05)

    def lines() -> Iterator[EpisodeResult]:
        for number in range(ended):
            yield a_result(episode_id=f"e{number}", num_steps=40)
        for name, steps in running:
            progress.started(episode(name), steps)
        time.sleep(0.5 if not terminal else 0.7)

    assert len(list(progress.over(lines()))) == ended
    assert "progress" not in {thread.name for thread in threading.enumerate()}
    return re.split(r"[\r\n]+", stream.getvalue())


def test_the_progress_of_an_episode_with_brackets_in_its_id_is_shown() -> None:
    assert any("a[/b], step 7 of 500" in line for line in report(("a[/b]", lambda: 7), terminal=True))


def test_a_pipe_gets_a_line_when_an_episode_begins_while_it_runs_and_when_it_ends() -> None:
    stream = io.StringIO()
    progress = ProgressReport(PlainConsole(file=stream, width=100), total=1, max_steps=500, quiet_s=0.05)

    def lines() -> Iterator[EpisodeResult]:
        progress.started(episode("e0"), itertools.count(2).__next__)
        time.sleep(0.5)
        yield RESULT

    assert list(progress.over(lines())) == [RESULT]
    first, *running, last = stream.getvalue().splitlines()
    assert first == "e0 begins: looking for a television in house val_00"
    assert running
    pace = r"\d+\.\d steps/s, at most \d+ (s|min) left"
    assert all(re.fullmatch(rf"\[0/1\] running: e0, step \d+ of 500(; {pace})?", line) for line in running)
    assert re.search(pace, running[-1])
    assert last == "[1/1] e0: television found after 3 steps, 1 s"


def test_silences_grow_so_that_the_log_of_a_long_episode_stays_short() -> None:
    stream = io.StringIO()
    progress = ProgressReport(PlainConsole(file=stream, width=100), total=1, max_steps=500, quiet_s=0.02)

    def lines() -> Iterator[EpisodeResult]:
        progress.started(episode("e0"), lambda: 1)
        time.sleep(0.8)
        yield RESULT

    assert list(progress.over(lines())) == [RESULT]
    assert 3 < stream.getvalue().count("running") < 12


def test_the_time_left_follows_from_the_steps_of_ended_episodes() -> None:
    running = [line for line in report(("b0", itertools.count(10).__next__), ended=4) if "running" in line]
    numbers = re.findall(r"step (\d+) of 500; ([\d.]+) steps/s, about ([\d.]+) s left", running[-1])[0]
    step, rate, left_s = map(float, numbers)
    assert left_s == pytest.approx((5 * 40 + 40 - step) / rate, abs=1.0)


@pytest.mark.parametrize(
    "steps",
    [itertools.count(60).__next__, itertools.chain([30], itertools.repeat(39)).__next__],
    ids=["longer", "one step shorter"],
)
def test_no_time_left_is_named_where_the_last_episode_is_at_the_mean_of_those_before(steps: Steps) -> None:
    running = [line for line in report(("b0", steps), ended=4, total=5) if "running" in line]
    assert running
    assert not any("left" in line for line in running)


def test_many_running_episodes_are_counted_and_workers_elsewhere_have_no_steps() -> None:
    many = [line for line in report(*((f"b{i}", lambda: 1) for i in range(5))) if "running" in line]
    assert "b2, step 1 of 500 and 2 more" in many[-1]
    unknown = [line for line in report(("b0", lambda: None)) if "running" in line]
    assert re.search(r"running: b0 for \d+ s$", unknown[-1])
