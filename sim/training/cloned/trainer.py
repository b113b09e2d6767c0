"""Trains the policy of `--agent cloned` on demonstrations: it learns to choose the same actions.

    stubborn train cloned --demonstrations runs/demonstrations --minutes 60 --out runs/cloned

The demonstrations are files of `tools.training.render_demonstrations` and `tools.training.plan_demonstrations`. One
house in ten, by its name, is held back for `val.csv`: the cross entropy, and how many actions are those of the
demonstrator. The same command continues a killed run: `state.pt` holds weights, their average, optimiser and step.
`cloned.safetensors` is the averaged network of the best evaluation so far, `curve.png` the picture of the curves.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Bool, Float32, UInt8
from torch import Tensor
from torch.nn import functional

from sim.core.interface import GOAL_CATEGORIES, Action, ConfigError
from sim.core.option_types import Amount, Count, NotNegative, OutFolder, Positive, Seed
from sim.training.cloned.demonstrations import Demonstration, list_demonstrations, read_demonstration
from sim.training.figures import empty_figure, require_packages
from sim.training.plan_split import HELD_BACK, is_held_back
from sim.training.timed_training import PRINT_EVERY_S, TimedTraining, stride
from sim.training.training_files import print_next_runs, read_columns
from stubborn.baselines.cloned_input import (
    HEIGHT_PX,
    MOTION,
    NO_ACTION,
    WIDTH_PX,
    Steps,
    depth_levels,
    mirrored_actions,
    motions,
)
from stubborn.baselines.cloned_net import FILES, ClonedNet


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


@dataclass(frozen=True, kw_only=True)
class Args:
    """Train the policy of the agent cloned on demonstrations."""

    demonstrations: tuple[Path, ...]
    """Folders of demonstrations; folders in them count."""
    out: OutFolder
    """Folder of the run; an existing run is continued."""
    minutes: Positive = 60.0
    """Time of the training, to which the learning rate is fitted."""
    streams: Count = 24
    """Number of demonstrations in a batch."""
    length: Count = 32
    """Steps of each demonstration in a step of the training; gradients do not pass to earlier steps."""
    rate: Positive = 1.5e-3
    """Peak learning rate of AdamW."""
    weight_decay: NotNegative = 0.01
    """Weight decay of AdamW."""
    threads: Count = 1
    """Number of threads of PyTorch."""
    val_count: Amount = 150
    """Largest number of held-back demonstrations in an evaluation; 0: all."""
    seed: Seed = 0
    """Seed of the initial weights and of the order."""


def main(args: Args) -> int:
    """Trains; returns the exit status."""
    require_packages("matplotlib")
    torch.set_num_threads(args.threads)
    files = list_demonstrations(args.demonstrations)
    train, val = read_all(files)
    Trainer(args, train, val, files).run()
    draw_curve(args.out)
    print_next_runs(args.out / "cloned.safetensors", "cloned", "agent.weights")
    return 0


def read_all(files: Sequence[Path]) -> tuple[list[LabelledSteps], list[LabelledSteps]]:
    """Returns the demonstrations to train on, and those in houses that are held back."""
    train: list[LabelledSteps] = []
    val: list[LabelledSteps] = []
    printed_s = time.monotonic()
    for number, file in enumerate(files):
        if time.monotonic() - printed_s >= PRINT_EVERY_S:
            printed_s = time.monotonic()
            print(f"{number} of {len(files)} demonstrations read", flush=True)
        demonstration = read_demonstration(file)
        (val if is_held_back(demonstration.house) else train).append(labelled_steps_of(demonstration, file))
    if not train or not val:
        raise ConfigError(
            f"{len(train)} demonstrations to train on and {len(val)} held back: both are needed. One house in "
            f"{HELD_BACK} is held back; render more houses."
        )
    return train, val


def labelled_steps_of(demonstration: Demonstration, file: Path) -> LabelledSteps:
    """Returns a demonstration in the form that the policy reads.

    Raises:
        ConfigError: its images have another size.
    """
    if demonstration.depth_mm.shape[1:] != (HEIGHT_PX, WIDTH_PX):
        height, width = demonstration.depth_mm.shape[1:]
        raise ConfigError(f"'{file}' has images of {width} x {height}, the policy takes {WIDTH_PX} x {HEIGHT_PX}.")
    before = np.concatenate((np.array([NO_ACTION], np.uint8), demonstration.actions[:-1]))
    steps = Steps(
        depth_levels(demonstration.depth_mm.astype(np.float32) / 1000.0),
        demonstration.semantic,
        motions(demonstration.poses),
        before,
        GOAL_CATEGORIES.index(demonstration.goal),
    )
    return LabelledSteps(steps, demonstration.actions)


class Trainer(TimedTraining):
    """The network, the optimiser, the demonstrations and the progress of one run."""

    def __init__(
        self, args: Args, train: Sequence[LabelledSteps], val: Sequence[LabelledSteps], files: Sequence[Path]
    ) -> None:
        self.val = val[:: stride(len(val), args.val_count)]
        self.counts = {"demonstrations": len(train), "frames": sum(len(steps.actions) for steps in train)}
        torch.manual_seed(args.seed)
        samples = args.streams * args.length
        super().__init__(
            args,
            FILES,
            ClonedNet(),
            max_gradient_norm=1.0,
            samples_per_step=samples,
            files={"demonstrations": files},
        )
        self.streams = Streams(train, width=args.streams, length=args.length, seed=args.seed + self.progress.step)
        self.state: Tensor | None = None
        """The memory of the policy in each stream."""
        words = ", ".join(f"{value} {name}" for name, value in self.counts.items())
        print(f"{words}, {len(self.val)} of {len(val)} held-back demonstrations to evaluate on", flush=True)

    def losses(self) -> tuple[Tensor, Mapping[str, Tensor]]:
        """See `TimedTraining.losses`: the weighted cross entropy of the next piece."""
        piece = self.streams.next_piece()
        if self.state is not None:
            self.state = self.state.detach() * torch.from_numpy(~piece.begins).float()[None, :, None]
        logits, self.state = self._logits(self.model, piece, self.state)
        losses = functional.cross_entropy(
            logits.flatten(0, 1), torch.from_numpy(piece.actions).long().flatten(), reduction="none"
        )
        weight = torch.from_numpy(piece.weight).flatten()
        loss = (losses * weight).sum() / weight.sum()
        return loss, {"cross_entropy": loss}

    def evaluate(self, model: torch.nn.Module) -> tuple[float, Mapping[str, object], str]:
        """See `TimedTraining.evaluate`."""
        predicted, true, changes, losses = [], [], [], []
        for one in self.val:
            logits = self._logits(model, one.steps, None)[0][:, 0]
            actions = torch.from_numpy(one.actions).long()
            losses.append(functional.cross_entropy(logits, actions, reduction="none").numpy())
            predicted.append(logits.argmax(1).numpy())
            true.append(one.actions)
            changes.append(one.changes)
        row = agreement(*(np.concatenate(parts) for parts in (predicted, true, changes, losses)))
        loss = row["cross_entropy"]
        assert loss is not None
        return loss, row, ", ".join(f"{key.replace('_', ' ')} {value}" for key, value in row.items())

    def about(self) -> Mapping[str, object]:
        """See `TimedTraining.about`."""
        return self.counts

    def _logits(self, model: torch.nn.Module, piece: Piece | Steps, state: Tensor | None) -> tuple[Tensor, Tensor]:
        """Returns the logits of the actions and the state after the last step; `Steps` are one stream."""
        arrays = (piece.depth, piece.categories, piece.motion, piece.before)
        tensors = [torch.from_numpy(np.ascontiguousarray(array)) for array in arrays]
        if isinstance(piece, Steps):
            tensors = [tensor[:, None] for tensor in tensors]
        with torch.autocast("cpu", dtype=torch.bfloat16, enabled=self.bf16):
            logits, after = model(*tensors, torch.as_tensor(piece.goal).reshape(-1), state)
        return logits.float(), after.float()


def agreement(
    predicted: np.ndarray, true: np.ndarray, changes: np.ndarray, losses: np.ndarray
) -> dict[str, float | int | None]:
    """Returns how often the most probable actions are those of the demonstrator.

    Args:
        predicted: (n,) the most probable actions.
        true: (n,) the actions of the demonstrator.
        changes: (n,) whether the demonstrator's action differs from the previous one.
        losses: (n,) cross entropies.
    """
    right = predicted == true

    def share(among: np.ndarray) -> float | None:
        return round(float(right[among].mean()), 4) if among.any() else None

    return {
        "frames": len(true),
        "cross_entropy": round(float(losses.mean()), 4),
        "right": share(np.ones(len(true), np.bool_)),
        "right_at_changes": share(changes),
        "stops_found": share(true == Action.STOP),
        "stops_right": share(predicted == Action.STOP),
    }


def draw_curve(out: Path) -> None:
    """Draws the columns of `train.csv` and `val.csv` as `curve.png`, if `val.csv` has rows."""
    train, val = (read_columns(out / name) for name in ("train.csv", "val.csv"))
    if not val:
        return
    figure = empty_figure(9.0, 3.2)
    axes = figure.subplots(1, 2)
    if train:
        axes[0].plot(train["minutes"], train["cross_entropy"], color="0.6", label="training, changes count more")
    axes[0].plot(val["minutes"], val["cross_entropy"], color="C0", label="held-back houses")
    axes[0].set_title("cross entropy of the action", fontsize=9)
    for name, label in (("right", "all actions"), ("right_at_changes", "changes"), ("stops_found", "STOPs")):
        axes[1].plot(val["minutes"], val[name], label=label)
    axes[1].set_title("share of actions that are the demonstrator's, held-back houses", fontsize=9)
    axes[1].set_ylim(0.0, 1.0)
    for axis in axes:
        axis.set_xlabel("minutes")
        axis.legend(fontsize=8)
    figure.savefig(out / "curve.png", dpi=80)
