"""The running episode: one thread that simulates, and gives the server what there is to show."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Protocol

from sim.cli import USAGE_ERRORS
from sim.composition.options import RunOptions
from sim.composition.runner import Parts, build_parts
from sim.composition.segmenters import KINDS
from sim.composition.setup import resolve
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.splits import Episode
from sim.errors import EpisodeError
from sim.evaluation.rollout import episode_seed, play_episode
from sim.interface import Action, Agent, Observation, Overridable, StatesTarget
from sim.task.explanations import ACTION_WORDS, explain_end, in_words, with_article
from sim.viewers.viewer import Moment
from sim.web.controls import Controls, Interrupted, Wish
from sim.web.pictures import Pictures, in_sight

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Frame:
    """Facts and pictures of one moment."""

    facts: Mapping[str, Any]
    """Step, action, metrics so far, categories in sight; JSON types."""
    pictures: Mapping[str, bytes]
    """JPEG files by name (`sim.web.pictures.NAMES`)."""


class Audience(Protocol):
    """The server, as the simulating thread sees it. Its methods are called in that thread."""

    def wanted(self) -> frozenset[str]:
        """Returns the names of the pictures that some client shows."""
        ...

    def show(self, frame: Frame) -> None:
        """Takes the newest frame."""
        ...

    def tell(self, state: Mapping[str, Any]) -> None:
        """Takes the newest state of the episode, JSON types."""
        ...


class Session:
    """Runs one episode after the other, as users ask for them; all users see the same one."""

    def __init__(self, audience: Audience, weights: Path | None = None, config: tuple[str, ...] = ()) -> None:
        """Makes a session; `start` starts it.

        Args:
            audience: receives what there is to show.
            weights: of the network of `rednet`; the shipped one when None.
            config: `detector.FIELD=VALUE`, options of segmentations that do not ship.
        """
        self.controls = Controls()
        self._audience, self._weights, self._config = audience, weights, config
        self._parts: Parts | None = None
        self._pictures: Pictures | None = None
        self._made_for: tuple[str, str, str] | None = None
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
        while (wish := self.controls.next_wish()) is not None:
            try:
                self._play(wish)
            except Interrupted:
                self._tell(wish, "idle", "The episode was ended.")
            except USAGE_ERRORS as error:
                self._tell(wish, "failed", " ".join(str(error).split()))
            except Exception:
                _log.exception("The episode broke.")
                self._tell(wish, "failed", "The episode broke; the terminal of sim.web shows why.")
        self._free()

    def _play(self, wish: Wish) -> None:
        self._tell(wish, "loading", f"Loading house {wish.house} and the agent {wish.agent} ...")
        parts, pictures = self._parts_for(wish)
        episode = choose_episode(parts.env, wish, self._turn)
        self._turn += 1
        shared = SharedAgent(parts, pictures, self.controls, self._audience)
        about: dict[str, Any] = {}

        def begun(env: ObjectNavEnv) -> None:
            about.update(episode_id=episode.episode_id, max_steps=env.task_config.max_steps, legends=pictures.legends())
            about.update(segmentation=parts.seen.name if parts.seen is not None else "")
            self._tell(wish, "playing", f"Looking for {with_article(wish.goal)}.", **about)

        watcher = _Watcher(begun, shared)
        seed = episode_seed(0, episode.episode_id)
        line = play_episode(parts.env, shared, episode, seed=seed, viewers=[watcher], name=wish.agent)
        shared.show_end()
        nearest_m = parts.env.scene.task.trajectory().nearest_instance_m
        detects = parts.seen is not None and not shared.stopped_by_person
        outcome = explain_end(line, wish.goal, parts.env.success_rule, nearest_m, detects=detects)
        self._tell(wish, "ended", outcome.headline, outcome=asdict(outcome), **about)

    def _parts_for(self, wish: Wish) -> tuple[Parts, Pictures]:
        """Returns environment, agent and pictures; those of the last episode where they fit."""
        key = (wish.split, wish.agent, wish.semantics)
        if self._parts is None or self._pictures is None or key != self._made_for:
            self._free()
            weights = self._weights if wish.semantics == "rednet" else None
            config = () if wish.semantics in KINDS else self._config
            options = RunOptions(
                agent=wish.agent, semantics=wish.semantics, weights=weights, split=wish.split, config=config
            )
            self._parts = build_parts(resolve(options), watched=True)
            self._pictures, self._made_for = Pictures(self._parts), key
        return self._parts, self._pictures

    def _free(self) -> None:
        if self._pictures is not None:
            self._pictures.close()
        if self._parts is not None:
            self._parts.env.close()
        self._parts = self._pictures = self._made_for = None

    def _tell(self, wish: Wish, phase: str, message: str, **more: Any) -> None:
        self._audience.tell({"phase": phase, "message": message, "wish": asdict(wish), **more})


class SharedAgent:
    """An `Agent` whose actions are the agent's own or those of a person, when the controls say so."""

    def __init__(self, parts: Parts, pictures: Pictures, controls: Controls, audience: Audience) -> None:
        self._parts, self._pictures, self._controls, self._audience = parts, pictures, controls, audience
        self._inner: Agent = parts.agent
        self._last: Action | None = None
        self.info: Mapping[str, Any] = {}
        self.stopped_by_person = False

    def reset(self, goal: str, seed: int) -> None:
        """Starts a new episode."""
        self._inner.reset(goal, seed)
        self._last = None

    def act(self, observation: Observation) -> Action:
        """Shows the observation, waits until an action is due and returns it.

        Raises:
            Interrupted: the episode is to end.
        """
        advised = Action(self._inner.act(observation))
        choice = None
        while choice is None:
            self._show(observation, advised)
            choice = self._controls.choose(advised)
        action, by_person = choice.action, choice.driver == "person"
        if action != advised and isinstance(self._inner, Overridable):
            self._inner.overridden(action)
        self._last, self.stopped_by_person = action, by_person and action == Action.STOP
        return action

    def stop_target_xy_m(self) -> tuple[float, float] | None:
        """Returns the place for which the agent stops; None where a person does, or where it states none."""
        inner = self._inner
        return inner.stop_target_xy_m() if isinstance(inner, StatesTarget) and not self.stopped_by_person else None

    def show_end(self) -> None:
        """Shows the world after the last action."""
        self._show({}, None)

    def _show(self, observation: Observation, advised: Action | None) -> None:
        env, painter = self._parts.env, self._parts.painter
        images, metrics = env.truth_images, env.scene.task.metrics()
        step, action = metrics["num_steps"], advised or Action.STOP
        moment = Moment(step=step, observation=observation, images=images, action=action)
        names = self._audience.wanted()
        if advised is None:  # after the end: what the agent perceives is that of the frame before
            names -= {"predicted", "score", "map"}
        facts = {
            "step": step,
            "ended": advised is None,
            "last": None if self._last is None else ACTION_WORDS[self._last],
            "advice": None if advised is None else ACTION_WORDS[advised],
            "doing": painter.words() if painter is not None and not self.stopped_by_person else "",
            "collided": bool(self.info.get("collided", False)),
            "collisions": int(metrics["collisions"]),
            "driven_m": float(metrics["path_length"]),
            "left_m": None if metrics["distance_to_goal"] is None else float(metrics["distance_to_goal"]),
            "shortest_m": None if metrics["shortest_path"] is None else float(metrics["shortest_path"]),
            "in_sight": in_sight(images["semantic"], env.episode.goal),
        }
        self._audience.show(Frame(facts, self._pictures.draw(names, moment) if names else {}))


class _Watcher:
    """A viewer that says when the episode has begun and keeps the outcome of the last action."""

    def __init__(self, begun: Callable[[ObjectNavEnv], None], shared: SharedAgent) -> None:
        self._begun, self._shared = begun, shared

    def begin(self, env: ObjectNavEnv) -> None:
        self._begun(env)

    def decided(self, moment: Moment) -> None:
        pass

    def moved(self, info: Mapping[str, Any]) -> None:
        self._shared.info = info

    def end(self, line: Mapping[str, Any]) -> None:
        pass

    def close(self) -> None:
        pass


def choose_episode(env: ObjectNavEnv, wish: Wish, turn: int) -> Episode:
    """Returns an episode of the split with this house and goal; turn after turn another one.

    Raises:
        EpisodeError: the split has no such episode.
    """
    fitting = [each for each in env.split.episodes if (each.house, each.goal) == (wish.house, wish.goal)]
    if not fitting:
        raise EpisodeError(f"Split '{wish.split}' has no episode with '{in_words(wish.goal)}' in house '{wish.house}'.")
    return fitting[turn % len(fitting)]
