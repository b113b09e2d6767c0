"""Trains the predictor of `--agent poni` on house plans, without an agent that acts in them.

    stubborn train poni --plans runs/plans/train runs/plans/large_train --minutes 30 --out runs/poni

First the samples are made, partial maps with the true potentials of their frontiers (`sim.training.poni.potentials`),
one file for each plan in --samples; then the network is trained on them for --minutes. One plan in eight is held back
for `val.csv`: the loss, and how often the best predicted frontier is truly the best one. The same command continues a
killed run: `state.pt` holds weights, their average, optimiser and step. `poni.safetensors` is the averaged network of
the best evaluation so far, `curve.png` the picture of the two curves.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Float, Int
from torch import Tensor
from torch.nn import functional

from sim.core.interface import ConfigError
from sim.core.invocation import command
from sim.core.option_types import Amount, Count, NotNegative, OutFolder, Positive, Seed
from sim.core.reading import sha256_of
from sim.homes.plans.plan import read_plan
from sim.training.figures import empty_figure, require_packages
from sim.training.poni.potential_files import HELD_BACK, SYMMETRIES, Batch, SampleSet, held_back, plan_of, write_samples
from sim.training.poni.potentials import SampleConfig, samples_of
from sim.training.timed_training import PRINT_EVERY_S, TimedTraining, stride
from sim.training.training_files import print_next_runs, read_columns
from stubborn.exploration.poni_net import FILES, MAPS, PoniNet, PoniNetConfig

OBJECT_WEIGHT = 5.0
"""Weight of the mean loss over the goal categories; the loss of the area has weight 1."""
SMOOTHED_ROWS = 8
"""Rows of `train.csv` of a running mean in the picture."""
TIE = 0.02
"""A frontier is as good as the best one if its true potential is less than this below."""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Train the predictor of the explorer poni on house plans."""

    plans: tuple[Path, ...]
    """Folders of plans (`stubborn houses plans`)."""
    out: OutFolder
    """Folder of the run; an existing run is continued."""
    samples: OutFolder | None = None
    """Folder of the samples, which runs may share; None: OUT/samples."""
    minutes: Positive = 30.0
    """Time of the training, to which the learning rate is fitted, without the time to make the samples."""
    walks: Count = 6
    """Walks in each plan."""
    maps: Count = 8
    """Samples of each walk."""
    most_steps: Count = 300
    """Actions of a walk."""
    batch: Count = 16
    """Samples per step."""
    rate: Positive = 2e-3
    """Peak learning rate of AdamW."""
    weight_decay: NotNegative = 0.02
    """Weight decay of AdamW."""
    threads: Count = 1
    """Number of threads of PyTorch."""
    val_count: Amount = 900
    """Largest number of held-back samples in an evaluation; 0: all."""
    seed: Seed = 0
    """Seed of the initial weights and of the order and rotations of the samples; the samples have another seed."""


def main(args: Args) -> int:
    """Makes the samples and trains; returns the exit status."""
    require_packages("matplotlib")
    torch.set_num_threads(args.threads)
    config = SampleConfig(walks=args.walks, maps=args.maps, most_steps=args.most_steps)
    files = make_samples(args, config)
    Trainer(args, config, files).run()
    draw_curve(args.out)
    print_next_runs(args.out / "poni.safetensors", "poni", "agent.explorer.weights")
    return 0


def make_samples(args: Args, config: SampleConfig) -> list[Path]:
    """Writes the missing samples of plans, and returns the files of all samples."""
    plans = [file for folder in args.plans for file in sorted(folder.glob("*.npz"))]
    if not plans:
        raise ConfigError(f"No plan in {', '.join(map(str, args.plans))}: `{command('houses', 'plans')}` writes them.")
    folder = args.samples or args.out / "samples"
    files = [folder / f"{plan.parent.name}-{plan.name}" for plan in plans]
    if len(set(files)) < len(files):
        raise ConfigError(
            "--plans has two folders of one name with plans of one name; give one of the folders another."
        )
    of_val = sum(held_back(plan) for plan in plans)
    if of_val in (0, len(plans)):
        raise ConfigError(
            f"{len(plans) - of_val} plans to train on and {of_val} held back: both are needed. One house in "
            f"{HELD_BACK} is held back; export more."
        )
    printed_s = start_s = time.monotonic()
    sums = {plan: sha256_of(plan, what="Plan") for plan in plans}
    for plan, file in zip(plans, files, strict=True):
        if file.exists() and plan_of(file) != sums[plan]:
            raise ConfigError(
                f"'{file}' has samples of another plan than '{plan}'; delete it, or give another --samples."
            )
    todo = [(plan, file) for plan, file in zip(plans, files, strict=True) if not file.exists()]
    for done, (plan, file) in enumerate(todo):
        if time.monotonic() - printed_s >= PRINT_EVERY_S:
            printed_s = time.monotonic()
            print(f"samples of {done} of {len(todo)} plans, {(printed_s - start_s) / 60:.1f} min", flush=True)
        house = read_plan(plan)
        write_samples(file, samples_of(house, config, seed=0), config, {"plan": house.name, "plan_sha256": sums[plan]})
    print(f"samples of {len(files)} plans, {len(todo)} made in {(time.monotonic() - start_s) / 60:.1f} min", flush=True)
    return files


def loss_of(logits: Tensor, potentials: Tensor, counts: Tensor) -> tuple[Tensor, Tensor]:
    """Returns the cross entropy of the area potential and the mean one of the object potentials that count.

    Args:
        logits: (m, maps) at frontier cells.
        potentials: (m, maps) the true ones, in [0, 1].
        counts: (m, maps) False: the potential does not matter.
    """
    losses = functional.binary_cross_entropy_with_logits(logits, potentials, reduction="none") * counts
    return losses[:, 0].mean(), losses[:, 1:].sum() / counts[:, 1:].sum().clamp(min=1)


class Trainer(TimedTraining):
    """The network, the optimiser, the samples and the progress of one run."""

    may_change = TimedTraining.may_change | {"samples"}  # the files of the samples are compared in place of the plans

    def __init__(self, args: Args, config: SampleConfig, files: Sequence[Path]) -> None:
        self.train = SampleSet.read([file for file in files if not held_back(file)], config)
        self.val = SampleSet.read([file for file in files if held_back(file)], config)
        self.plans = len(files)
        torch.manual_seed(args.seed)
        model = PoniNet(PoniNetConfig(cells=config.cells, pool=config.pool))
        model.to(memory_format=torch.channels_last)  # pyright: ignore[reportCallIssue] - its stub lacks it
        super().__init__(args, FILES, model, max_gradient_norm=5.0, samples_per_step=args.batch, files={"plans": files})
        print(f"{len(self.train)} samples, {len(self.val)} held back", flush=True)

    def losses(self) -> tuple[Tensor, Mapping[str, Tensor]]:
        """See `TimedTraining.losses`; the samples of a step depend on seed and step only."""
        rng = np.random.default_rng([self.args.seed, self.progress.step])
        numbers = rng.integers(len(self.train), size=self.args.batch)
        batch = self.train.batch(numbers.tolist(), rng.integers(SYMMETRIES, size=self.args.batch).tolist())
        area, objects = loss_of(self._logits(self.model, batch), *_targets(batch))
        return area + OBJECT_WEIGHT * objects, {"area": area, "objects": objects}

    def evaluate(self, model: torch.nn.Module) -> tuple[float, Mapping[str, object], str]:
        """See `TimedTraining.evaluate`."""
        numbers = range(len(self.val))[:: stride(len(self.val), self.args.val_count)]
        area, objects, losses = Choices(), Choices(), []
        for first in range(0, len(numbers), self.args.batch):
            batch = self.val.batch(numbers[first : first + self.args.batch])
            logits = self._logits(model, batch)
            losses.append([float(loss) for loss in loss_of(logits, *_targets(batch))])
            add_choices(batch, torch.sigmoid(logits).numpy(), area, objects)
        mean = np.mean(losses, axis=0)
        row: dict[str, object] = {"samples": len(numbers), "area": float(mean[0]), "objects": float(mean[1])}
        for name, choices in (("area", area), ("objects", objects)):
            row |= {f"{name}_choices": choices.count}
            row |= {f"{name}_{key}": value for key, value in choices.shares().items()}
        message = (
            f"area {mean[0]:.4f}, objects {mean[1]:.4f}; best frontier chosen: area {row['area_predicted_best']:.3f}, "
            f"objects {row['objects_predicted_best']:.3f} (random {row['objects_random_best']:.3f}, "
            f"nearest {row['objects_nearest_best']:.3f})"
        )
        return float(mean[0] + OBJECT_WEIGHT * mean[1]), row, message

    def about(self) -> Mapping[str, object]:
        """See `TimedTraining.about`."""
        return {"plans": self.plans}

    def _logits(self, model: torch.nn.Module, batch: Batch) -> Tensor:
        """Returns the logits (m, maps) at the frontier cells of a batch."""
        images = torch.from_numpy(batch.channels).to(torch.float32, memory_format=torch.channels_last)
        with torch.autocast("cpu", dtype=torch.bfloat16, enabled=self.bf16):
            maps: Tensor = model(images)
        at = torch.from_numpy(batch.sample), slice(None), torch.from_numpy(batch.cell)
        return maps.float().flatten(2)[at].reshape(-1, MAPS)


def draw_curve(out: Path) -> None:
    """Draws the losses of `train.csv` and `val.csv`, and the share of best choices, as `curve.png`.

    Nothing is drawn if `val.csv` has no rows.
    """
    train, val = (read_columns(out / name) for name in ("train.csv", "val.csv"))
    if not val:
        return
    figure = empty_figure(11.0, 3.2)
    axes = figure.subplots(1, 3)
    for axis, name in zip(axes, ("area", "objects"), strict=False):
        if train:
            kernel = np.ones(min(SMOOTHED_ROWS, len(train[name])))
            mean = np.convolve(train[name], kernel / kernel.size, mode="valid")
            axis.plot(train["minutes"][kernel.size - 1 :], mean, color="0.6", label="training, running mean")
        axis.plot(val["minutes"], val[name], color="C0", label="held-back plans")
        axis.set_title(f"cross entropy of the {name.removesuffix('s')} potential", fontsize=9)
        axis.set_xlabel("minutes")
        axis.legend(fontsize=8)
    for number, name in enumerate(("area", "objects")):
        for kind, style in (("predicted", "-"), ("nearest", "--"), ("random", ":")):
            label = f"{name.removesuffix('s')}: {kind}"
            axes[2].plot(val["minutes"], val[f"{name}_{kind}_best"], style, color=f"C{number}", label=label)
    axes[2].set_title("share of maps in which the best frontier is chosen", fontsize=9)
    axes[2].set_xlabel("minutes")
    axes[2].set_ylim(0.0, 1.0)
    axes[2].legend(fontsize=7, ncol=2)
    figure.savefig(out / "curve.png", dpi=80)


def _targets(batch: Batch) -> tuple[Tensor, Tensor]:
    """Returns the true potentials of a batch and which of them count."""
    return torch.from_numpy(batch.potentials), torch.from_numpy(batch.counts)


@dataclass
class Choices:
    """Sums over maps in which there is something to choose: two frontiers or more, of different potential."""

    count: int = 0
    hits: dict[str, float] = field(default_factory=lambda: dict.fromkeys(("predicted", "random", "nearest"), 0.0))
    """Number of maps in which the choice is the best one; for `random` its expectation."""
    gained: dict[str, float] = field(default_factory=lambda: dict.fromkeys(("predicted", "random", "nearest"), 0.0))
    """Sum of the true potentials of the choices."""
    most: float = 0.0
    """Sum of the true potentials of the best frontiers."""

    def add(
        self, true: Float[np.ndarray, " n"], predicted: Float[np.ndarray, " n"], path_m: Float[np.ndarray, " n"]
    ) -> None:
        """Counts the choice among the frontiers of a map; nothing if all are equally good."""
        best = true >= true.max() - TIE
        if best.all():
            return
        self.count += 1
        self.most += float(true.max())
        for name, number in (("predicted", np.argmax(predicted)), ("nearest", np.argmin(path_m))):
            self.hits[name] += float(best[number])
            self.gained[name] += float(true[number])
        self.hits["random"] += float(best.mean())
        self.gained["random"] += float(true.mean())

    def shares(self) -> dict[str, float]:
        """Returns the share of best choices, and the potential of the choices as a share of the best ones."""
        shares = {f"{name}_best": value / max(self.count, 1) for name, value in self.hits.items()}
        return shares | {f"{name}_potential": value / max(self.most, 1e-9) for name, value in self.gained.items()}


def add_choices(batch: Batch, predicted: Float[np.ndarray, "m maps"], area: Choices, objects: Choices) -> None:
    """Counts the choices in the maps of a batch, by the area potential and by each object potential that counts.

    Args:
        batch: the samples.
        predicted: potentials at the batch's frontier cells.
        area: is changed.
        objects: is changed.
    """
    for sample in range(int(batch.sample.max(initial=-1)) + 1):
        cells = np.flatnonzero(batch.sample == sample)
        part = np.unique(batch.part[cells], return_inverse=True)[1]
        true, guess = (_highest(values[cells], part) for values in (batch.potentials, predicted))
        path_m = -_highest(-batch.path_m[cells, None], part)[:, 0]
        area.add(true[:, 0], guess[:, 0], path_m)
        for goal in np.flatnonzero(batch.counts[cells[0], 1:]) + 1:
            objects.add(true[:, goal], guess[:, goal], path_m)


def _highest(values: Float[np.ndarray, "m maps"], part: Int[np.ndarray, " m"]) -> Float[np.ndarray, "parts maps"]:
    """Returns the highest value of each frontier."""
    highest = np.full((int(part.max()) + 1, values.shape[1]), -np.inf)
    np.maximum.at(highest, part, values)
    return highest
