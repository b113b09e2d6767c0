"""Streams of demonstrations for the training of the cloned policy: sequences side by side, piece by piece."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float32, UInt8

from stubborn.baselines.cloned_input import MOTION, NO_ACTION, Steps, mirrored_actions


@dataclass(frozen=True, eq=False)
class LabelledSteps:
    """One demonstration: the inputs of the policy, and the action of each step."""

    steps: Steps
    actions: UInt8[np.ndarray, " n"]

    @property
    def changes(self) -> Bool[np.ndarray, " n"]:
        """Whether each action differs from the one before."""
        return self.actions != self.steps.before

    def mirrored(self) -> LabelledSteps:
        """Returns it in a house whose left and right are exchanged."""
        return LabelledSteps(self.steps.mirrored(), mirrored_actions(self.actions))


@dataclass(frozen=True, eq=False)
class Piece:
    """The next steps of several demonstrations side by side, padded at the ends of episodes."""

    depth: UInt8[np.ndarray, "steps n h w"]
    categories: UInt8[np.ndarray, "steps n h w"]
    motion: Float32[np.ndarray, "steps n motion"]
    before: UInt8[np.ndarray, "steps n"]
    goal: np.ndarray
    """(n,) index of the goal category."""
    actions: UInt8[np.ndarray, "steps n"]
    weight: Float32[np.ndarray, "steps n"]
    """Weight of each step in the loss; 0: padding."""
    begins: Bool[np.ndarray, " n"]
    """True: the piece begins an episode, so that nothing of an earlier one may be remembered."""


class Streams:
    """Demonstrations in random order, `width` side by side, in pieces of `length` steps.

    Each stream reads one demonstration to its end, half of them mirrored, then draws another; the state of the policy
    is carried from piece to piece. An action that differs from the one before counts as often as such actions are
    rare (inflection weighting; Wijmans et al. 2019, arXiv:1904.03461), since most actions repeat the one before.

    Args:
        shown: the demonstrations; at least one.
        width: number of demonstrations side by side.
        length: steps of a piece.
        seed: of the order and of the mirroring.
    """

    def __init__(self, shown: Sequence[LabelledSteps], *, width: int, length: int, seed: int) -> None:
        self._shown, self._length = shown, length
        self._rng = np.random.default_rng(seed)
        changes = sum(int(np.count_nonzero(each.changes)) for each in shown)
        self.inflection = sum(len(each.actions) for each in shown) / max(changes, 1)
        """Weight of an action that differs from the one before."""
        self._now = [self._draw() for _ in range(width)]
        # In the middle of an episode at the beginning, so that the streams do not end together.
        self._at = [int(self._rng.integers(len(each.actions))) // length * length for each in self._now]

    def next_piece(self) -> Piece:
        """Returns the next piece."""
        height, width_px = self._now[0].steps.depth.shape[1:]
        images = (self._length, len(self._now), height, width_px)
        depth, categories = np.zeros(images, np.uint8), np.zeros(images, np.uint8)
        motion = np.zeros((*images[:2], len(MOTION)), np.float32)
        before, actions = np.full(images[:2], NO_ACTION, np.uint8), np.zeros(images[:2], np.uint8)
        weight = np.zeros(images[:2], np.float32)
        begins = np.array([at == 0 for at in self._at])
        goal = np.array([one.steps.goal for one in self._now])
        for number, (one, at) in enumerate(zip(self._now, self._at, strict=True)):
            part = slice(at, at + self._length)
            place = slice(0, len(one.actions[part])), number
            depth[place], categories[place] = one.steps.depth[part], one.steps.categories[part]
            motion[place], before[place] = one.steps.motion[part], one.steps.before[part]
            actions[place] = one.actions[part]
            weight[place] = np.where(one.changes[part], self.inflection, 1.0)
            self._at[number] += self._length
            if self._at[number] >= len(one.actions):
                self._now[number], self._at[number] = self._draw(), 0
        return Piece(depth, categories, motion, before, goal, actions, weight, begins)

    def _draw(self) -> LabelledSteps:
        """Returns a random demonstration, mirrored or not."""
        one = self._shown[int(self._rng.integers(len(self._shown)))]
        return one.mirrored() if self._rng.random() < 0.5 else one
