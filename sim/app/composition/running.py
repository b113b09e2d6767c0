"""Runs the episodes of a run that its folder does not hold yet, and writes their lines."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from rich.console import Console

from sim.app.analysis.progress import ProgressReport
from sim.app.composition import RUNNER
from sim.app.composition.agents import notes_on
from sim.app.composition.record import error_result, record_of
from sim.app.composition.seed_key import seed_key_of
from sim.app.composition.setup import Setup
from sim.app.evaluation.executors import make_executor
from sim.app.evaluation.processes import isolation_of
from sim.app.evaluation.results import RunDirectory, segmentation_of
from sim.app.evaluation.summary import summary_of
from sim.app.evaluation.workers import RunnerSpec
from sim.app.options import RunOptions
from sim.core.geometry.compiling import choose_cache, must_compile
from sim.core.vocabulary import counted
from sim.episodes.episode import Episode
from sim.episodes.replicates import with_replicates
from sim.episodes.splits import load_split
from sim.task.result import EpisodeResult


def run_missing(
    setup: Setup,
    episodes: Sequence[Episode],
    split: Mapping[str, str],
    console: Console,
    *,
    runner: str = f"{RUNNER}:EpisodeRunner",
) -> tuple[list[EpisodeResult], dict[str, Any]]:
    """Runs the episodes that the folder of the run, `--out`, does not hold yet.

    Args:
        setup: of the run; the folder may hold a run with the same options, except for the number of episodes.
        episodes: those of `episodes_of`, or some of them.
        split: identity of their source, from `episodes_of`.
        console: for progress.
        runner: what makes the runner of a worker from the setup, `module:function`.

    Returns:
        All lines of the folder, and their summary.

    Raises:
        ConfigError: the folder cannot be written, or holds a run with another configuration.
    """
    options = replace(setup.options, seed_key=seed_key_of(setup.options))
    assert options.out is not None
    setup = replace(setup, options=options, planned=split.get("sha256"))
    executor = make_executor(
        options.executor, workers=options.workers, address=options.address, isolation=isolation_of(options)
    )
    record = record_of(setup, split)
    versions = record.get("versions", {})
    run, code = RunDirectory(options.out, record, EpisodeResult), versions["code"]
    try:
        if run.healed:
            console.print(run.healed)
        _require_own_lines(options, run, episodes)
        again = run.errors([episode.episode_id for episode in episodes]) if options.retry_errors else set()
        done = {line.episode_id for line in run.lines} - again
        if not options.keep_results:
            run.require_own_code(code, done)
        if options.retry_errors:
            console.print(f"Episodes that ended with an error and are run again: {len(again)}.")
        todo = [episode for episode in episodes if episode.episode_id not in done]
        console.print(
            f"{options.agent}, {counted(len(episodes), 'episode')} of {split['name']} "
            f"(version {split['version']}), rendered by {versions['gl_renderer']}; "
            f"segmentation: {segmentation_of(record)}; results in {options.out}"
        )
        for note in _notes_on(setup):
            console.print(note, soft_wrap=True)
        _report_resumed(run, len(episodes), len(todo), code, console)
        for note in _notes_on_compilation() if todo else ():
            console.print(note)
        spec = RunnerSpec(runner, setup)
        longest = max((len(episode.specs) for episode in todo), default=1) * setup.config.task.max_steps
        progress = ProgressReport(console, total=len(todo), max_steps=longest)

        def lost(episode: Episode, reason: str) -> EpisodeResult:
            return error_result(setup, episode, reason)

        def written() -> Iterator[EpisodeResult]:
            for line in executor.run(spec, todo, on_death=lost, on_start=progress.started):
                run.append(line)  # before anything is printed, because printing may fail
                yield line

        for _ in progress.over(written()) if todo else ():
            pass
        summary = summary_of(record, run.lines)
        run.write_summary(summary)
        return run.lines, summary
    finally:
        run.discard_if_empty()
        run.close()


def _require_own_lines(options: RunOptions, run: RunDirectory[EpisodeResult], episodes: Sequence[Episode]) -> None:
    """Raises ConfigError if the folder holds a line of another split, or one that contradicts its episode."""
    known = {episode.episode_id: (episode.house, episode.goal) for episode in episodes}
    others = [line for line in run.lines if line.episode_id not in known]
    if others and options.house is None:  # of the same split, but not asked for now
        every = with_replicates(load_split(options.split).episodes, options.replicates)
        known |= {episode.episode_id: (episode.house, episode.goal) for episode in every}
    elif options.house is not None:
        stem = re.escape(options.house.stem)
        drawn = (line for line in others if re.fullmatch(rf"{stem}_\d{{4,}}(~\d+)?", line.episode_id))
        known |= {line.episode_id: (options.house.stem, options.goal or line.goal) for line in drawn}
    run.require_of(known)


def _notes_on(setup: Setup) -> Iterator[str]:
    """Yields sentences about the agent of a run and its segmentation."""
    yield from notes_on(setup.options.agent, setup.config.agent)
    yield from filter(None, (setup.borrowed_parameters, setup.missing_calibration))


def _notes_on_compilation() -> Iterator[str]:
    """Yields sentences about the code that numba has to compile; none if all is in its cache."""
    if must_compile():
        yield "This is the first run here: numba compiles the agent and the sensors, up to a minute."
        if (cache := choose_cache()) is not None:
            yield f"Neither the installation nor a home folder can be written: {cache} keeps the result."


def _report_resumed(run: RunDirectory[EpisodeResult], total: int, todo: int, code: str, console: Console) -> None:
    """Prints how many episodes the folder holds already, and whether other code ran them."""
    if todo < total:
        console.print(f"{total - todo} of them exist already, {todo} remain.")
    for name, (before, now) in (run.other_versions() if 0 < todo < total else {}).items():
        console.print(
            f"The run began with {name} {before}; these episodes run with {now}, and their results may differ.",
            soft_wrap=True,
        )
    others = run.record_code(code) if todo else []
    if others and todo < total:
        console.print(
            f"The existing episodes were run by other code ({', '.join(others)}) than these ({code}).",
            soft_wrap=True,
        )
