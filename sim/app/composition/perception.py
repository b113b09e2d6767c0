"""Gives viewers the segmentation that an agent acts on: only the results that the agent has asked for."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sim.app.composition.own_segmentation import OwnSegmenter
from sim.app.composition.setup import Setup
from sim.app.evaluation.rollout import ask
from sim.app.viewers.viewer import SeesFrames
from sim.core.interface import (
    MPCAT40,
    Agent,
    GuessesNames,
    NamesCategories,
    Observation,
    Perceived,
    Scores,
    SeesObjects,
    Segmenter,
    SegmenterSpec,
    SegmentsPictures,
    StatesSegmentation,
    TakesWords,
)


class AskedSegmenter:
    """A segmenter that forwards each call to another one and remembers for which frame the agent called it.

    The scores of a frame are the same at each call, so that viewers change no result.
    """

    def __init__(self, inner: Segmenter, name: str) -> None:
        self.name = name
        self._inner = inner
        self._arrays: tuple[NDArray, ...] = ()
        """The arrays of the frame for which the agent called the segmenter last."""

    @property
    def names(self) -> bool:
        """True: the segmenter names the category of each pixel."""
        inner = self._inner
        return inner.names if isinstance(inner, OwnSegmenter) else isinstance(inner, NamesCategories)

    @property
    def spec(self) -> SegmenterSpec:
        """Returns the declaration of the segmenter."""
        return self._inner.spec

    def scores(self, observation: Observation, goal: str) -> Scores:
        """Returns the segmenter's scores."""
        self._remember(observation)
        return self._inner.scores(observation, goal)

    def posteriors(self, observation: Observation) -> NDArray[np.float32]:
        """Returns the segmenter's posteriors."""
        self._remember(observation)
        return self._inner.posteriors(observation)

    def objects(self, observation: Observation) -> tuple[NDArray[np.int32], Sequence[str]] | None:
        """Returns the segmenter's objects; None if it does not tell objects apart."""
        return self._inner.objects(observation) if isinstance(self._inner, SeesObjects) else None

    def named(self, observation: Observation) -> tuple[NDArray[np.float32], Sequence[str]] | None:
        """Returns the probabilities of everyday names; None if the segmenter does not know them."""
        return self._inner.named(observation) if isinstance(self._inner, GuessesNames) else None

    def picture_categories(self) -> NDArray[np.uint8] | None:
        """Returns what the picture of the goal shows; None: the segmenter does not know it."""
        return self._inner.picture_categories() if isinstance(self._inner, SegmentsPictures) else None

    def ask(self, word: str, names: frozenset[str]) -> None:
        """Forwards the words of the goal to a segmenter that takes them."""
        if isinstance(self._inner, TakesWords):
            self._inner.ask(word, names)

    def perceived(self, observation: Observation, goal: str) -> Perceived | None:
        """Returns scores and categories of a frame; None if the agent did not call the segmenter for it."""
        if not any(array is other for array in _arrays_of(observation) for other in self._arrays):
            return None
        inner = self._inner
        scores = inner.scores(observation, goal) if goal in MPCAT40 else None  # of a goal in words it has no scores
        return Perceived(scores, inner.categories(observation) if isinstance(inner, NamesCategories) else None)

    def _remember(self, observation: Observation) -> None:
        self._arrays = _arrays_of(observation)


class StatedByAgent:
    """The segmentation of an agent that has its own and states it (`StatesSegmentation`)."""

    def __init__(self, agent: StatesSegmentation, name: str, agent_name: str) -> None:
        self.name = name
        self.names = True
        self._agent, self._agent_name = agent, agent_name

    def perceived(self, observation: Observation, goal: str) -> Perceived | None:
        """Returns the segmentation that the agent states for the frame.

        Raises:
            AgentError: `stated_segmentation` failed, or returned another type or shape.
        """
        del observation, goal
        where = f"Agent '{self._agent_name}', stated_segmentation"
        stated = ask(where, self._agent.stated_segmentation)
        return None if stated is None else ask(where, lambda: _checked(stated))


def seen_by(setup: Setup, agent: Agent, segmenter: Segmenter | None) -> SeesFrames | None:
    """Returns the segmentation that viewers show; None: the agent has none, or does not state its own.

    Args:
        setup: the setup of the run.
        agent: the agent.
        segmenter: the segmenter that the agent got; None: it got none.
    """
    if isinstance(segmenter, AskedSegmenter):
        return segmenter
    if setup.spec.own_segmentation and isinstance(agent, StatesSegmentation):
        return StatedByAgent(agent, setup.spec.own_segmentation, setup.options.agent)
    return None


def _arrays_of(observation: Observation) -> tuple[NDArray, ...]:
    return tuple(observation.values())


def _checked(perceived: Perceived) -> Perceived:
    """Returns the segmentation that an agent states, as arrays; raises ValueError if a shape or value is wrong."""
    scores, categories = perceived
    if scores is not None:
        target, best_other = (np.asarray(score, np.float32) for score in scores)
        if any(score.ndim != 2 or not 0.0 <= score.min() <= score.max() <= 1.0 for score in (target, best_other)):
            raise ValueError("scores must be Scores(target, best_other), both (h, w) in [0, 1]")
        scores = Scores(target, best_other)
    if categories is not None:
        categories = np.asarray(categories)
        if (
            categories.ndim != 2
            or categories.dtype.kind not in "iu"
            or not (0 <= categories.min() <= categories.max() < len(MPCAT40))
        ):
            raise ValueError("categories must be mpcat40 ids 0 to 40, (h, w)")
        categories = categories.astype(np.uint8)
    return Perceived(scores, categories)
