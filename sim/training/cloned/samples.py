"""Streams of demonstrations for the training of the cloned policy: parallel sequences, read in pieces."""

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
        """Returns whether each action differs from the previous one."""
        return self.actions != self.steps.before

    def mirrored(self) -> LabelledSteps:
        """Returns the demonstration in the mirrored house (left and right are exchanged)."""
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
    """True: the piece begins an episode, so the policy must not remember an earlier one."""


class Streams:
    """Demonstrations in random order, `width` side by side, in pieces of `length` steps.

    Each stream reads one demonstration to its end, half of them mirrored, then samples another; the state of the policy
    is carried from piece to piece. Most actions repeat the previous one. An action that differs from it has a weight
    that is larger, the rarer such actions are (inflection weighting; Wijmans et al. 2019, arXiv:1904.03461).

    Args:
        shown: the demonstrations; at least one.
        width: number of demonstrations side by side.
        length: steps of a piece.
        seed: seeds the order and the mirroring.
    """

    def __init__(self, shown: Sequence[LabelledSteps], *, width: int, length: int, seed: int) -> None:
        self._shown, self._length = shown, length
        self._rng = np.random.default_rng(seed)
        changes = sum(int(np.count_nonzero(steps.changes)) for steps in shown)
        self.inflection = sum(len(steps.actions) for steps in shown) / max(changes, 1)
        """Weight of an action that differs from the previous one."""
        self._now = [self._draw() for _ in range(width)]
        # Each stream begins in the middle of an episode, so that the streams do not all end at once.
        self._at = [int(self._rng.integers(len(steps.actions))) // length * length for steps in self._now]

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
