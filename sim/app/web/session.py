"""Runs the episodes of the page in one thread, and gives their pictures and their state to the server."""

from __future__ import annotations

import re
import threading
import traceback
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from typing import Protocol

from sim.app.composition.agents import free_agent
from sim.app.composition.driven import HUMAN
from sim.app.composition.environments import drawn_episodes
from sim.app.composition.record import record_of
from sim.app.composition.runner import Parts, build_parts
from sim.app.composition.setup import Setup, resolve
from sim.app.evaluation.config_fields import run_differences
from sim.app.evaluation.own_code import text_of
from sim.app.evaluation.results import HUMAN_NAME, RunRecord, is_driven
from sim.app.evaluation.rollout import give_next_goal, next_action, play_episode
from sim.app.viewers.overlay import goal_marks
from sim.app.viewers.viewer import Moment
from sim.app.web.choices import WISH, number_of_wish
from sim.app.web.controls import Controls, EpisodeRequest, Interrupted
from sim.app.web.driven import DrivenRuns
from sim.app.web.hints import Hints
from sim.app.web.pictures import Pictures, in_sight
from sim.core.errors import EpisodeError, ObjectNavError, debug
from sim.core.goals import NO_GOAL, GoalSpec
from sim.core.interface import GOAL_CATEGORIES, Action, Agent, Observation, Overridable, StatesTarget
from sim.core.reading import printable
from sim.core.vocabulary import counted, in_words, with_article
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.episode import Episode
from sim.episodes.replicates import with_replicates
from sim.episodes.seeds import drawing_generator, episode_seeds
from sim.task.explanations import ACTION_WORDS, explain_end
from sim.task.result import RolloutResult

_NAMED_DIFFERENCES = 4


@dataclass(frozen=True)
class Frame:
    """Numbers and pictures of one moment."""

    facts: Mapping[str, object]
    """The step, the last action, the metrics so far and the categories in sight; JSON types."""
    pictures: Mapping[str, bytes]
    """JPEG files by name (`sim.app.web.pictures.NAMES`)."""


class Display(Protocol):
    """Receives the frames and states of a session, and sends them to the clients.

    The thread that simulates calls the methods.
    """

    def wanted(self) -> frozenset[str]:
        """Returns the names of the pictures that at least one client shows."""
        ...

    def show(self, frame: Frame) -> None:
        """Receives the newest frame."""
        ...

    def show_state(self, state: Mapping[str, object]) -> None:
        """Receives the newest state of the episode, JSON types."""
        ...


@dataclass(frozen=True)
class _Made:
    """Environment, agent and pictures, and the setup from which they were made."""

    setup: Setup
    parts: Parts
    pictures: Pictures


class Session:
    """Runs the episodes that users request, one after the other; all users see the same one."""

    def __init__(self, display: Display, driven: DrivenRuns) -> None:
        """Makes a session; `start` starts it.

        Args:
            display: receives frames and states.
            driven: records the episodes that a person drives.
        """
        self.controls = Controls()
        self._display, self._driven = display, driven
        self._made: _Made | None = None
        self._turn = 0
        self._thread = threading.Thread(target=self._run, daemon=True, name="simulation")

    def start(self) -> None:
        """Starts the thread."""
        self._thread.start()

    def close(self, wait_s: float = 5.0) -> None:
        """Ends the thread."""
        self.controls.close()
        self._thread.join(wait_s)

    def _run(self) -> None:
        while (request := self.controls.next_request()) is not None:
            try:
                self._run_episode(request)
            except Interrupted:
                self._show_state(request, "idle", "The episode was ended; nothing was recorded.")
            except ObjectNavError as error:
                self._show_state(request, "failed", str(error))
            except BaseException as error:  # a user's code may raise anything, and this thread must continue
                if debug():
                    traceback.print_exc()
                self._free()
                reason = f"{type(error).__name__}: {text_of(error)} (unexpected; --debug shows where)"
                self._show_state(request, "failed", f"The episode failed: {reason}")
        self._free()

    def _run_episode(self, request: EpisodeRequest) -> None:
        self._show_state(request, "loading", f"Loading house {request.house} and the agent {request.options.agent} ...")
        made = self._made_for(request)
        parts, pictures = made.parts, made.pictures
        episode = choose_episode(parts.env, request, self._turn, made.setup)
        self._turn += 1
        shared = SharedAgent(parts, pictures, self.controls, self._display)
        about: dict[str, object] = {"note": unlike_the_run(made.setup, parts.env, request.record)}

        def begun(env: ObjectNavEnv) -> None:
            about.update(episode_id=episode.episode_id, max_steps=env.task_config.max_steps, legends=pictures.legends())
            about.update(segmentation=parts.seen.name if parts.seen is not None else "")
            self._show_state(request, "running", _looking_for(episode.specs[0]), **about)

        watcher = _Watcher(begun, shared)
        options = request.options
        seeds = episode_seeds(options.seed, episode.episode_id, options.seed_key)
        result = play_episode(
            parts.env,
            shared,
            episode,
            seed=seeds.environment,
            seed_of_agent=seeds.agent,
            viewers=[watcher],
            name=options.agent,
        )
        shared.show_end()
        if not request.goal:
            steps = counted(result.num_steps, "step")
            self._show_state(request, "ended", f"The drive ended after {steps}; nothing was recorded.", **about)
            return
        nearest_m = parts.env.scene.task.trajectory().nearest_instance_m
        detects = parts.seen is not None and not shared.stopped_by_person
        outcome = explain_end(result, request.goal, parts.env.success_rule, nearest_m, detects=detects)
        recorded = self._record(made, episode, result, shared)
        self._show_state(request, "ended", outcome.headline, outcome=asdict(outcome) | {"recorded": recorded}, **about)

    def _record(self, made: _Made, episode: Episode, result: RolloutResult, shared: SharedAgent) -> str:
        """Records an episode in which a person drove; returns a sentence about it, "" where no person did."""
        if shared.person_steps == 0 or result.is_error:
            return ""
        counts = {"person_steps": shared.person_steps, "hint_steps": shared.hint_steps}
        try:
            folder = self._driven.write(made.setup, made.parts.env, episode, result, **counts)
        except (ObjectNavError, OSError) as error:
            return f"It could not be recorded: {error}"
        return f"Recorded in {folder}."

    def _made_for(self, request: EpisodeRequest) -> _Made:
        """Returns environment, agent and pictures; those of the last episode if the options are the same."""
        if self._made is None or self._made.setup.options != request.options:
            self._free()
            setup = resolve(request.options, HUMAN if request.options.agent == HUMAN_NAME else None)
            parts = build_parts(setup, watched=True)
            self._made = _Made(setup, parts, Pictures(parts))
        return self._made

    def _free(self) -> None:
        made, self._made = self._made, None
        if made is None:
            return
        free_agent(made.parts.agent)
        made.pictures.close()
        made.parts.env.close()

    def _show_state(self, request: EpisodeRequest, phase: str, message: str, **more: object) -> None:
        text = printable(" ".join(message.split()))
        self._display.show_state({"phase": phase, "message": text, "request": request.as_json(), **more})


class SharedAgent:
    """An `Agent` that forwards the actions of another agent, or those of a person while a person drives."""

    def __init__(self, parts: Parts, pictures: Pictures, controls: Controls, display: Display) -> None:
        self._parts, self._pictures, self._controls, self._display = parts, pictures, controls, display
        self._inner: Agent = parts.agent
        self._last: Action | None = None
        self.info: Mapping[str, object] = {}
        self.stopped_by_person = False
        self.person_steps = self.hint_steps = 0
        self._hints: Hints | None = None

    def reset(self, goal: str, seed: int) -> None:
        """Starts a new episode."""
        self._inner.reset(goal, seed)
        self._last, self._seed = None, seed
        self._hints = Hints(self._parts.env, goal)
        self.person_steps = self.hint_steps = 0

    def next_goal(self, goal: str) -> None:
        """Gives the other agent the next goal of a chain."""
        give_next_goal(self._inner, goal, self._seed, f"Agent '{type(self._inner).__name__}', next goal")
        self._hints = Hints(self._parts.env, goal)

    def act(self, observation: Observation) -> Action:
        """Shows the observation, waits until an action is due and returns it.

        Raises:
            Interrupted: the episode must end.
        """
        where = f"Agent '{type(self._inner).__name__}'"
        advised = next_action(self._inner, observation, where, self._parts.env.actions)
        choice = None
        while choice is None:
            self._show(observation, advised)
            choice = self._controls.choose(advised)
        action, by_person = choice.action, choice.driver == "person"
        self.person_steps += by_person
        self.hint_steps += by_person and self._controls.hints
        if action != advised and isinstance(self._inner, Overridable):
            self._inner.overridden(action)
        self._last, self.stopped_by_person = action, by_person and action == Action.STOP
        return action

    def stop_target_xy_m(self) -> tuple[float, float] | None:
        """Returns the place for which the agent stops; None if a person stops, or if the agent states none."""
        inner = self._inner
        return inner.stop_target_xy_m() if isinstance(inner, StatesTarget) and not self.stopped_by_person else None

    def show_end(self) -> None:
        """Shows the world after the last action."""
        self._show({}, None)

    def _show(self, observation: Observation, advised: Action | None) -> None:
        env, painter = self._parts.env, self._parts.painter
        task = env.scene.task
        images, metrics = env.truth_images, task.goal_metrics()
        step, action = task.num_steps, advised or Action.STOP
        moment = Moment(step=step, observation=observation, images=images, action=action)
        names = self._display.wanted()
        if advised is None:  # after the end, the agent's pictures are those of the previous frame
            names -= {"predicted", "score", "map"}
        hint = None
        if advised is not None and self._hints is not None and self._controls.hints:
            hint = self._hints.at(step, self._last)
        facts = {
            "step": step,
            "ended": advised is None,
            "last": None if self._last is None else ACTION_WORDS[self._last],
            "advice": None if advised is None or not task.goal else ACTION_WORDS[advised],
            "hint": None if hint is None else {"action": int(hint), "words": ACTION_WORDS[hint]},
            "doing": painter.words() if painter is not None and not self.stopped_by_person else "",
            "collided": bool(self.info.get("collided", False)),
            "collisions": metrics.collisions,
            "driven_m": metrics.path_length,
            "left_m": metrics.distance_to_goal,
            "shortest_m": metrics.shortest_path,
            "in_sight": in_sight(images["semantic"], task.goal, task.goal_mask(images)),
            "looking": _looking_for(task.goals[task.goal_number]),
            "goals": [asdict(mark) for mark in goal_marks(task)],
        }
        self._display.show(Frame(facts, self._pictures.draw(names, moment) if names else {}))


def _looking_for(goal: GoalSpec) -> str:
    """Returns a sentence about the goal of a running episode."""
    if goal == NO_GOAL:
        return "You drive, without a goal."
    return f"Looking for {'the object in the picture' if goal.camera is not None else with_article(goal.text)}."


class _Watcher:
    """A viewer that calls `begun` when the episode has begun, and stores the outcome of each action."""

    def __init__(self, begun: Callable[[ObjectNavEnv], None], shared: SharedAgent) -> None:
        self._begun, self._shared = begun, shared

    def begin(self, env: ObjectNavEnv) -> None:
        self._begun(env)

    def decided(self, moment: Moment) -> None:
        pass

    def moved(self, info: Mapping[str, object]) -> None:
        self._shared.info = info

    def end(self, result: RolloutResult) -> None:
        pass

    def close(self) -> None:
        pass


def choose_episode(env: ObjectNavEnv, request: EpisodeRequest, turn: int, setup: Setup) -> Episode:
    """Returns the episode of a request; without an id, the episodes of its house and goal in turn.

    To draw an episode of a finished run in a house file again, all episodes of that run are drawn; one that a person
    drove was drawn alone.

    Raises:
        EpisodeError: there is no such episode, or none can be drawn in a house file.
    """
    if request.options.house is not None and request.record is not None and not is_driven(request.record):
        drawn = with_replicates(drawn_episodes(env, setup), setup.options.replicates)
        again = {episode.episode_id: episode for episode in drawn}
        if request.episode_id not in again:
            raise EpisodeError(
                f"The run has no episode '{request.episode_id}'. It has: {', '.join(list(again)[:5])}, ..."
            )
        return again[request.episode_id]
    if request.options.house is not None:
        return _draw_episode(env, request, turn)
    if (number := number_of_wish(request.episode_id, request.house)) is not None:
        return _wished_episode(env, request, number)
    if request.episode_id is not None:
        return env.split.episode(request.episode_id)
    fitting = [
        episode for episode in env.split.episodes if (episode.house, episode.goal) == (request.house, request.goal)
    ]
    if not fitting and request.goal not in GOAL_CATEGORIES:
        return _wished_episode(env, request, turn)
    if not fitting:
        raise EpisodeError(
            f"Split '{request.split}' has no episode with '{in_words(request.goal)}' in house '{request.house}'."
        )
    return fitting[turn % len(fitting)]


def _wished_episode(env: ObjectNavEnv, request: EpisodeRequest, turn: int) -> Episode:
    """Returns a new episode with a goal in words; its start differs from turn to turn and is not at the goal."""
    rng, episode_id = drawing_generator(request.options.seed, turn), f"{request.house}{WISH}{turn:04d}"
    return env.draw_episode(rng, episode_id=episode_id, house=request.house, goal=request.goal)


def _draw_episode(env: ObjectNavEnv, request: EpisodeRequest, turn: int) -> Episode:
    """Returns a new episode in a house file, with the goal and start that the options fix."""
    number = re.fullmatch(
        rf"{re.escape(request.house)}_(\d{{4,9}})", request.episode_id or f"{request.house}_{turn:04d}"
    )
    if number is None:
        raise EpisodeError(
            f"Episodes of house '{request.house}' are {request.house}_0000 and so on, not {request.episode_id}."
        )
    draw = env.draw_episode if request.goal else env.draw_drive
    return draw(drawing_generator(request.options.seed, int(number[1])), episode_id=number[0])


def unlike_the_run(setup: Setup, env: ObjectNavEnv, record: RunRecord | None) -> str:
    """Returns a sentence that names the differences from the run whose episode is shown; "" if there are none.

    Args:
        setup: the setup of the episode.
        env: its environment.
        record: the run's `config.json`; None: the episode belongs to no run.
    """
    if record is None:
        return ""
    now = record_of(setup, env.split.identity)
    fields = [path.removeprefix("config.") for path, _, _ in run_differences(record, now) if path.startswith("config.")]
    if (record.get("split_identity") or {}).get("sha256") != env.split.sha256:
        fields.append("the houses")
    if (record.get("versions") or {}).get("code") != now.get("versions", {})["code"]:
        fields.append("the code")
    more = [f"{len(fields) - _NAMED_DIFFERENCES} more"] if len(fields) > _NAMED_DIFFERENCES else []
    return f"Not as in the run: {', '.join(fields[:_NAMED_DIFFERENCES] + more)}." if fields else ""
