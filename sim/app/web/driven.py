"""Records the episodes that users drive on the page, as runs in the folder of the runs."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path

import msgspec

from sim.app.composition.driven import record_driven, setup_of_person
from sim.app.composition.record import record_of
from sim.app.composition.setup import Setup
from sim.app.evaluation.results import RunDirectory
from sim.app.evaluation.summary import summary_of
from sim.app.options import RunOptions
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.episode import Episode
from sim.task.result import EpisodeResult, RolloutResult


class DrivenRuns:
    """The runs that this server writes. Episodes with equal options share a run, which has each one at most once."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._run: Path | None = None
        self._options: RunOptions | None = None
        self._done: set[str] = set()

    def write(
        self,
        setup: Setup,
        env: ObjectNavEnv,
        episode: Episode,
        result: RolloutResult,
        *,
        person_steps: int,
        hint_steps: int,
    ) -> Path:
        """Records the episode that has just ended; returns the folder of its run.

        Args:
            setup: the setup of the agent, which may have driven a part of the episode.
            env: the environment of the episode.
            episode: the episode.
            result: what `play_episode` returned.
            person_steps: number of actions that a person chose.
            hint_steps: number of these actions for which a hint was shown.

        Raises:
            ConfigError: the folder is not writable.
        """
        with_agent = person_steps < result.num_steps
        person = setup_of_person(setup, with_agent=with_agent)
        run = self._run
        if run is None or person.options != self._options or episode.episode_id in self._done:
            run, done = self._new_run(), set[str]()
        else:
            done = self._done
        options = person.options
        person = replace(person, options=replace(person.options, out=run))
        split = env.split.identity
        content = record_of(person, split)
        directory = RunDirectory(run, content, EpisodeResult)
        try:
            driven = record_driven(person, env, episode, result, content.get("versions", {}))
            other = setup.options.agent if with_agent else None
            directory.append(
                msgspec.structs.replace(driven, person_steps=person_steps, hint_steps=hint_steps, other_driver=other)
            )
            directory.write_summary(summary_of(content, directory.lines))
        finally:
            directory.discard_if_empty()
            directory.close()
        self._run, self._options, self._done = run, options, done | {episode.episode_id}
        return run

    def _new_run(self) -> Path:
        """Returns a folder that does not exist yet."""
        name = time.strftime("driven_%Y-%m-%d_%H-%M-%S")
        names = [name, *(f"{name}_{number}" for number in range(2, 100))]
        return next(self._folder / free for free in names if not (self._folder / free).exists())
