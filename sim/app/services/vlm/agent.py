"""The agent `vlm`: `stubborn-plus` in which a vision-language model chooses where to explore and checks each STOP.

The agent maps, plans, avoids collisions and tracks objects as before. At each new tour the model chooses among the
stops of the tour, from the map, from camera views, or from both. Before a STOP it sees the candidate; if it takes it
for something else, the candidate counts no longer. A question without a valid reply leaves the decision to the agent
itself; after `max_failures` of them in an episode the model is asked no more in it.
"""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any, Literal

import msgspec
import numpy as np
from msgspec import Meta
from numpy.typing import NDArray

from sim.app.services.vlm import prompts as texts
from sim.app.services.vlm.chat import Chat, ChatConfig
from sim.app.services.vlm.pictures import Views, directions, map_picture, outlined, write_transcript
from sim.core.errors import AgentError, ConfigError
from sim.core.geometry.pose import Pose
from sim.core.interface import GOAL_CATEGORIES, Action, AgentSpec, Observation
from sim.core.reading import printable
from sim.core.vocabulary import in_words
from stubborn.agent import AgentConfig, StubbornAgent, read_pose
from stubborn.agents import PLUS, SENSORS
from stubborn.detection.seeker import SeekerConfig
from stubborn.drawing.map_painter import make_painter
from stubborn.exploration.explorer import ExplorerConfig, Ground
from stubborn.exploration.tour import INFORMED_TOUR, TourExplorer
from stubborn.mapping.felt import FeelConfig
from stubborn.mapping.mapper import Sighting
from stubborn.planning.untrap import UntrapConfig

_log = logging.getLogger(__name__)
Reason = Annotated[str, Meta(max_length=2000)]


def place_reply(count: int) -> type[Any]:
    """Returns the type of the reply to the question where to go: `choice`, 1 to `count`, and `reason`."""
    choice = Annotated[int, Meta(ge=1, le=count)]
    return msgspec.defstruct("PlaceReply", [("choice", choice), ("reason", Reason, "")], forbid_unknown_fields=True)


class StopReply(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The reply to the question whether a candidate is the goal."""

    found: bool
    reason: Reason = ""


@dataclass(frozen=True, kw_only=True)
class VlmConfig(ChatConfig, AgentConfig):
    """All parameters: those of the service, those of the questions, and those of `stubborn-plus`."""

    asked: tuple[Literal["place", "stop"], ...] = ("place", "stop")
    """place: the model chooses where to explore; stop: it checks each STOP."""
    shown: tuple[Literal["map", "views"], ...] = ("map", "views")
    """Pictures of the question where to go."""
    max_places: int = 6
    """Places among which the model chooses: the nearest ones and the one that the tour would choose."""
    max_failures: int = 3
    """After this many questions without a valid reply the model is not asked any more in the episode."""
    prompts: Path = texts.FILE
    """File of the texts."""
    transcripts: Path | None = None
    """Folder to which each question with its pictures and the reply are written; None: they are not."""
    explorer: ExplorerConfig = field(default_factory=lambda: replace(INFORMED_TOUR, replan_steps=25))
    """A tour. The model is asked again on arrival, and after `replan_steps` steps that showed new ground."""
    seeker: SeekerConfig = PLUS.seeker
    feel: FeelConfig | None = PLUS.feel
    untrap: UntrapConfig = PLUS.untrap

    def __post_init__(self) -> None:
        ChatConfig.__post_init__(self)
        AgentConfig.__post_init__(self)
        if self.max_places < 2 or self.max_failures < 1:
            raise ConfigError(
                f"VlmConfig needs max_places >= 2 and max_failures >= 1, got {self.max_places} and {self.max_failures}."
            )
        if not self.shown:
            raise ConfigError('VlmConfig.shown must have "map", "views" or both.')


class VlmAgent(StubbornAgent):
    """A `StubbornAgent` that asks a model; see the module.

    Raises:
        ConfigError: no model is named, the explorer is not a tour, the prompts cannot be read, or the server does not
            answer a first question.
    """

    def __init__(self, *, config: VlmConfig, **parts: Any) -> None:
        if not config.model:
            raise ConfigError("Agent 'vlm' needs a model: --config agent.url=http://HOST:PORT/v1 agent.model=NAME.")
        self.options = config
        self.texts = texts.Prompts.read(config.prompts)
        self.chat = Chat(config, self.texts.system)
        self.views = Views(parts["camera"], parts["robot"].camera_forward_m)
        super().__init__(config=config, **parts)
        if "place" in config.asked:
            if not isinstance(self.explorer, TourExplorer):
                raise ConfigError(
                    "Agent 'vlm' chooses among the stops of a tour: --explorer tour or informed-tour, or "
                    "--config 'agent.asked=[\"stop\"]'."
                )
            self.explorer.chooser = self._choose
        try:
            self.chat.ask(self.texts.ready.strip(), (), place_reply(1))
        except AgentError as error:
            raise ConfigError(f"Agent 'vlm': {error}") from None

    def reset(self, goal: str, seed: int) -> None:
        """Starts a new episode; see `StubbornAgent.reset`."""
        self.fell_back_step: int | None = None
        """Step from which the model was not asked any more; None: it is asked."""
        self.chat.begin()
        self.views.forget()
        super().reset(goal, seed)

    def _look_for(self, goal: str) -> None:
        super()._look_for(goal)
        self.words = in_words(goal) if goal in GOAL_CATEGORIES else goal
        self._asked_step = -1

    def act(self, observation: Observation) -> Action:
        """Returns the next action."""
        if "views" in self.options.shown and "place" in self.options.asked:
            self.views.add(read_pose(observation), observation["rgb"], observation["depth"])
        return super().act(observation)

    def model_use(self) -> Mapping[str, object]:
        """See `sim.core.interface.StatesModelUse`."""
        chat, config = self.chat, self.options
        priced = config.input_price > 0.0 or config.output_price > 0.0
        return {
            "model": config.model,
            "questions": chat.questions,
            "failed_questions": chat.failed,
            "prompt_tokens": chat.prompt_tokens,
            "completion_tokens": chat.completion_tokens,
            "cost": round(chat.cost, 6) if priced else None,
            "wait_s": round(chat.wait_s, 3),
            "fell_back_step": self.fell_back_step,
        }

    def _decide(self, pose: Pose, sighting: Sighting) -> Action:
        action = super()._decide(pose, sighting)
        may_err = self.segmenter.spec.needs_verification
        if action is not Action.STOP or "stop" not in self.options.asked or not may_err or self._confirmed():
            return action
        self.seeker.refuse(self.navmap)
        return Action.TURN_LEFT

    def _confirmed(self) -> bool:
        """Returns whether the model takes the candidate of a STOP for the goal; True if there is no valid reply."""
        seen = self.levelling.raw  # the picture is not levelled
        rgb, mask = seen["rgb"], self.wished.scores(seen, self.goal).target > self.config.mapping.candidate_score
        picture = outlined(rgb, mask) if mask.any() else rgb
        text = texts.filled(self.texts.stop, goal=self.words, outlined=self.texts.shown.outlined if mask.any() else "")
        reply = self._ask("stop", text, [picture], StopReply)
        return reply is None or reply.found

    def _choose(self, ground: Ground, places_xy_m: NDArray[np.float64], own: int) -> int:
        """Returns the number of the stop that the model chooses, or that of the tour; see `tour.Chooser`."""
        if self.fell_back_step is not None or self._asked_step == self.step:  # the chosen stop could not be reached
            return own
        self._asked_step = self.step
        away_m = np.hypot(*(places_xy_m - np.array(ground.pose.xy_m)).T)
        away_m[own] = 0.0
        offered = np.sort(np.argsort(away_m, kind="stable")[: self.options.max_places])
        places_xy_m, pictures, view_of = places_xy_m[offered], list[NDArray[np.uint8]](), None
        if "map" in self.options.shown:
            pictures.append(map_picture(self, places_xy_m, ground.pose))
        if "views" in self.options.shown:
            views, view_of = self.views.with_numbers(places_xy_m)
            pictures += views
        text = texts.filled(
            self.texts.place,
            goal=self.words,
            places=directions(places_xy_m, ground.pose, view_of),
            count=str(len(offered)),
            pictures=" ".join(getattr(self.texts.shown, name) for name in self.options.shown),
        )
        reply = self._ask("place", text, pictures, place_reply(len(offered)))
        return own if reply is None else int(offered[reply.choice - 1])

    def _ask(self, what: str, text: str, pictures: Sequence[NDArray[np.uint8]], kind: type[Any]) -> Any | None:
        """Returns the reply to a question; None: there is no valid one, or the model is not asked any more."""
        if self.fell_back_step is not None:
            return None
        where = f"Model '{self.options.model}', goal '{self.words}', step {self.step}"
        try:
            reply = self.chat.ask(text, pictures, kind)
        except AgentError as error:
            _log.warning("%s: %s The agent decides itself.", printable(where), printable(str(error)))
            reply, answer = None, str(error)
            if self.chat.failed >= self.options.max_failures:
                self.fell_back_step = self.step
                _log.warning("%s: %d failures: it is not asked again.", printable(where), self.chat.failed)
        else:
            answer = repr(reply)
        if self.options.transcripts is not None:
            name = f"{self.words}_{self._seed}_{self.step:03d}_{what}"
            write_transcript(self.options.transcripts, name, f"{text}\n\n-> {answer}\n", pictures)
        return reply


SPEC = AgentSpec(
    make=VlmAgent,
    description="stubborn-plus; a language model over HTTP chooses places and checks each STOP",
    config=VlmConfig(),
    sensors=(*SENSORS, "rgb"),
    painter=make_painter,
    words=("rgb", "goal"),
)
