"""Trains the policy of `--agent cloned` on demonstrations: it learns to do what they did.

    python tools/train_cloned.py --demonstrations runs/demonstrations --minutes 60 --out runs/cloned

The demonstrations are files of tools/render_demonstrations.py and tools/twin_demonstrations.py. One house in ten, by
its name, is held back for `val.csv`: the cross entropy, and how many actions are those of the demonstrator. The same
command continues a killed run: `state.pt` holds weights, their average, optimiser and step. `cloned.safetensors` is the
averaged network of the best evaluation so far, `curve.png` the picture of the curves.
"""

from __future__ import annotations

import math
import sys
import time
import zlib
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import torch
from torch import Tensor
from torch.nn import functional
from torch.optim.swa_utils import AveragedModel

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # a script does not find the package `tools` otherwise

from sim import cli
from sim.datasets.demonstrations import Demonstration, list_demonstrations, read_demonstration
from sim.interface import GOAL_CATEGORIES, Action, ConfigError
from sim.reading import Count as ReadCount
from sim.reading import Number
from stubborn.baselines.cloned_data import Piece, Shown, Streams
from stubborn.baselines.cloned_input import HEIGHT_PX, NO_ACTION, WIDTH_PX, Steps, depth_levels, motions
from stubborn.baselines.cloned_net import FILES, ClonedNet
from stubborn.segmentation.training import exponential_average
from tools.training_files import append_row, cut_rows, load_state, read_columns, save_state

LOG_EVERY_STEPS = 20
PRINT_EVERY_S = 10.0
"""Shortest time between two lines of progress."""
SAVE_EVERY_S = 60.0
"""Shortest time between two writes of the state."""
EVALUATE_EVERY = 0.05
"""Share of the time between two evaluations."""
HELD_BACK = 10
"""One house in so many is held back."""
AVERAGE = 0.998
"""Decay per step of the average of the weights."""
MAX_GRADIENT_NORM = 1.0


@dataclass(frozen=True, kw_only=True)
class Args:
    """Trains the cloned policy."""

    demonstrations: tuple[Path, ...]
    """Folders of demonstrations; folders in them count."""
    out: cli.OutFolder
    """Folder of the run; an existing run is continued."""
    minutes: cli.Positive = 60.0
    """Time of the training, to which the learning rate is fitted."""
    streams: cli.Count = 24
    """Demonstrations side by side."""
    length: cli.Count = 32
    """Steps of each stream in a step of the training; gradients do not pass to earlier ones."""
    rate: cli.Positive = 1.5e-3
    """Peak learning rate of AdamW."""
    weight_decay: cli.NotNegative = 0.01
    """Weight decay of AdamW."""
    threads: cli.Count = 1
    """Number of threads of PyTorch."""
    val_count: cli.Amount = 150
    """Number of held-back demonstrations of an evaluation; 0: all."""
    seed: cli.Seed = 0
    """Seed of the initial weights and of the order."""


class _Progress(msgspec.Struct):
    """How far a run is, as `state.pt` holds it."""

    step: ReadCount
    spent_s: Number
    best: float
    evaluated_s: Number


def main(args: Args) -> int:
    """Trains; returns the exit status."""
    torch.set_num_threads(args.threads)
    files = list_demonstrations(args.demonstrations)
    train, val = read_all(files)
    Trainer(args, train, val).run()
    return 0


def read_all(files: Sequence[Path]) -> tuple[list[Shown], list[Shown]]:
    """Returns the demonstrations to train on, and those in houses that are held back."""
    train: list[Shown] = []
    val: list[Shown] = []
    printed_s = time.monotonic()
    for number, file in enumerate(files):
        if time.monotonic() - printed_s >= PRINT_EVERY_S:
            printed_s = time.monotonic()
            print(f"{number} of {len(files)} demonstrations read", flush=True)
        given = read_demonstration(file)
        held_back = zlib.crc32(given.house.encode()) % HELD_BACK == 0
        (val if held_back else train).append(shown_of(given, file))
    if not train or not val:
        raise ConfigError(
            f"{len(train)} demonstrations to train on and {len(val)} held back: both are needed. One house in "
            f"{HELD_BACK} is held back; render more houses."
        )
    return train, val


def shown_of(given: Demonstration, file: Path) -> Shown:
    """Returns a demonstration as the policy sees it.

    Raises:
        ConfigError: its images have another size.
    """
    if given.depth_mm.shape[1:] != (HEIGHT_PX, WIDTH_PX):
        height, width = given.depth_mm.shape[1:]
        raise ConfigError(f"'{file}' has images of {width} x {height}, the policy takes {WIDTH_PX} x {HEIGHT_PX}.")
    before = np.concatenate((np.array([NO_ACTION], np.uint8), given.actions[:-1]))
    steps = Steps(
        depth_levels(given.depth_mm.astype(np.float32) / 1000.0),
        given.semantic,
        motions(given.poses),
        before,
        GOAL_CATEGORIES.index(given.goal),
    )
    return Shown(steps, given.actions)


class Trainer:
    """The network, the optimiser, the demonstrations and the progress of one run."""

    def __init__(self, args: Args, train: Sequence[Shown], val: Sequence[Shown]) -> None:
        self.args = args
        every = max(1, len(val) // args.val_count) if args.val_count else 1
        self.val = val[::every]
        self.counts = {"demonstrations": len(train), "frames": sum(len(each.actions) for each in train)}
        torch.manual_seed(args.seed)
        self.model = ClonedNet()
        self.average = AveragedModel(self.model, multi_avg_fn=exponential_average(AVERAGE))
        self.optimiser = torch.optim.AdamW(self.model.parameters(), lr=args.rate, weight_decay=args.weight_decay)
        self.bf16 = bool(torch.cpu.get_capabilities().get("avx512_bf16"))
        self.progress = _Progress(0, 0.0, math.inf, 0.0)
        args.out.mkdir(parents=True, exist_ok=True)
        done = load_state(args.out / "state.pt", self._parts(), _Progress)
        if done is not None:
            self.progress = done
            for name in ("train.csv", "val.csv"):
                cut_rows(args.out / name, "step", done.step)
            print(f"continues from step {done.step}, {done.spent_s / 60:.1f} min", flush=True)
        self.streams = Streams(train, width=args.streams, length=args.length, seed=args.seed + self.progress.step)
        self.state: Tensor | None = None
        """The memory of the policy in each stream."""
        words = ", ".join(f"{value} {name}" for name, value in self.counts.items())
        print(f"{words}, {len(self.val)} of {len(val)} held-back demonstrations to evaluate on", flush=True)

    def run(self) -> None:
        """Trains until the time is up."""
        progress, limit_s = self.progress, 60.0 * self.args.minutes
        if progress.spent_s >= limit_s:
            print("the time was up before: nothing to do", flush=True)
            return
        start_s, saved_s = time.perf_counter() - progress.spent_s, time.perf_counter()
        printed_s, losses = saved_s, []
        while progress.spent_s < limit_s:
            losses.append(self._train_on(self.streams.next(), progress.spent_s / limit_s))
            progress.step += 1
            progress.spent_s = time.perf_counter() - start_s
            if len(losses) == LOG_EVERY_STEPS:
                loss = float(np.mean(losses))
                self._log(loss)
                losses = []
                if time.perf_counter() - printed_s >= PRINT_EVERY_S:
                    printed_s = time.perf_counter()
                    minutes = f"{progress.spent_s / 60:.1f} of {self.args.minutes:g} min"
                    print(f"step {progress.step}, {minutes}: cross entropy {loss:.4f}", flush=True)
            if progress.spent_s - progress.evaluated_s > EVALUATE_EVERY * limit_s:
                self._evaluate()
                start_s = time.perf_counter() - progress.spent_s  # an evaluation is not training
            if time.perf_counter() - saved_s > SAVE_EVERY_S:
                self._save_state()
                saved_s = time.perf_counter()
        self._evaluate()
        self._save_state()
        draw_curve(self.args.out)

    def _train_on(self, piece: Piece, done: float) -> float:
        """Makes one step of the optimiser; returns the weighted cross entropy."""
        rate = self.args.rate * min(1.0, (self.progress.step + 1) / 100) * 0.5 * (1.0 + math.cos(math.pi * done))
        for group in self.optimiser.param_groups:
            group["lr"] = rate
        self.model.train()
        self.optimiser.zero_grad(set_to_none=True)
        if self.state is not None:
            self.state = self.state.detach() * torch.from_numpy(~piece.begins).float()[None, :, None]
        logits, self.state = self._logits(self.model, piece, self.state)
        losses = functional.cross_entropy(
            logits.flatten(0, 1), torch.from_numpy(piece.actions).long().flatten(), reduction="none"
        )
        weight = torch.from_numpy(piece.weight).flatten()
        loss = (losses * weight).sum() / weight.sum()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(self.model.parameters(), MAX_GRADIENT_NORM)
        self.optimiser.step()
        self.average.update_parameters(self.model)
        return float(loss.detach())

    def _logits(self, model: torch.nn.Module, piece: Piece | Steps, state: Tensor | None) -> tuple[Tensor, Tensor]:
        """Returns the logits of the actions and the state after the last step; `Steps` are one stream."""
        arrays = (piece.depth, piece.categories, piece.motion, piece.before)
        tensors = [torch.from_numpy(np.ascontiguousarray(array)) for array in arrays]
        if isinstance(piece, Steps):
            tensors = [tensor[:, None] for tensor in tensors]
        with torch.autocast("cpu", dtype=torch.bfloat16, enabled=self.bf16):
            logits, after = model(*tensors, torch.as_tensor(piece.goal).reshape(-1), state)
        return logits.float(), after.float()

    @torch.no_grad()
    def _evaluate(self) -> None:
        """Evaluates the averaged network, writes a row, and saves it if it is the best so far."""
        progress = self.progress
        progress.evaluated_s = progress.spent_s
        model: ClonedNet = self.average.module.eval()  # pyright: ignore[reportAssignmentType] - the same class
        found, true, changes, losses = [], [], [], []
        for one in self.val:
            logits = self._logits(model, one.steps, None)[0][:, 0]
            actions = torch.from_numpy(one.actions).long()
            losses.append(functional.cross_entropy(logits, actions, reduction="none").numpy())
            found.append(logits.argmax(1).numpy())
            true.append(one.actions)
            changes.append(one.changes)
        row: dict[str, Any] = {"step": progress.step, "minutes": round(progress.spent_s / 60, 2)}
        row |= agreement(*(np.concatenate(each) for each in (found, true, changes, losses)))
        append_row(self.args.out / "val.csv", row)
        print("held back: " + ", ".join(f"{key} {value}" for key, value in row.items()), flush=True)
        if row["cross_entropy"] < progress.best:
            progress.best = row["cross_entropy"]
            options = {key: str(value) for key, value in asdict(self.args).items()}
            card = {"val": row, "options": options, "torch": torch.__version__, **self.counts}
            FILES.save(self.args.out / "cloned.safetensors", model, card)
            self._save_state()  # so that a continued run knows the best

    def _log(self, loss: float) -> None:
        """Writes a row of the training curve."""
        progress, args = self.progress, self.args
        per_s = args.streams * args.length * progress.step / max(progress.spent_s, 1e-9)
        row = {"step": progress.step, "minutes": round(progress.spent_s / 60, 3), "cross_entropy": round(loss, 4)}
        append_row(args.out / "train.csv", row | {"frames_per_s": round(per_s)})

    def _parts(self) -> dict[str, Any]:
        """Returns what `state.pt` holds besides the progress."""
        return {"model": self.model, "average": self.average, "optimiser": self.optimiser}

    def _save_state(self) -> None:
        save_state(self.args.out / "state.pt", self._parts(), msgspec.to_builtins(self.progress))


def agreement(
    found: np.ndarray, true: np.ndarray, changes: np.ndarray, losses: np.ndarray
) -> dict[str, float | int | None]:
    """Returns how far the most probable actions are those of the demonstrator.

    Args:
        found: (n,) the most probable actions.
        true: (n,) those of the demonstrator.
        changes: (n,) whether the true one differs from the one before.
        losses: (n,) cross entropies.
    """
    right = found == true

    def share(among: np.ndarray) -> float | None:
        return round(float(right[among].mean()), 4) if among.any() else None

    return {
        "frames": len(true),
        "cross_entropy": round(float(losses.mean()), 4),
        "right": share(np.ones(len(true), np.bool_)),
        "right_at_changes": share(changes),
        "stops_found": share(true == Action.STOP),
        "stops_right": share(found == Action.STOP),
    }


def draw_curve(out: Path) -> None:
    """Draws the columns of `train.csv` and `val.csv` as `curve.png`."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    train, val = (read_columns(out / name) for name in ("train.csv", "val.csv"))
    figure, axes = pyplot.subplots(1, 2, figsize=(9, 3.2))
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
    figure.tight_layout()
    figure.savefig(out / "curve.png", dpi=80)
    pyplot.close(figure)


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
