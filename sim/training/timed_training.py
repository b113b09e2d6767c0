"""A training that lasts for a number of minutes: its loop, learning rate, curves, best network and state."""

from __future__ import annotations

import math
import time
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, ClassVar

import msgspec
import numpy as np
import torch
from torch import Tensor, nn
from torch.optim.swa_utils import AveragedModel

from sim.core.reading import Count, Number
from sim.training.segmentation.steps import exponential_average
from sim.training.training_files import (
    HasState,
    append_row,
    cut_rows,
    load_state,
    options_of,
    require_options,
    save_state,
)
from stubborn.network_files import Family

LOG_EVERY_STEPS = 20
PRINT_EVERY_S = 10.0
"""Shortest time between two lines of progress."""
SAVE_EVERY_S = 60.0
"""Shortest time between two writes of the state."""
EVALUATE_EVERY = 0.05
"""Share of the time between two evaluations."""
AVERAGE = 0.998
"""Decay per step of the average of the weights."""
WARM_UP_STEPS = 100


def stride(count: int, most: int) -> int:
    """Returns the smallest stride, at least 1, that takes at most `most` of `count` items; `most` 0: all of them."""
    return max(1, -(-count // most)) if most else 1


class Progress(msgspec.Struct):
    """The progress of a run, as `state.pt` holds it."""

    step: Count
    spent_s: Number
    best: float
    """Smallest loss of an evaluation; inf before the first."""
    evaluated_s: Number
    options: dict[str, str]
    """See `options_of`."""


class TimedTraining(ABC):
    """Trains a network by AdamW with a cosine schedule for some minutes, evaluations included; a killed run continues.

    A subclass makes the losses of a step and evaluates the averaged network. `train.csv` and `val.csv` in the folder of
    the run hold the curves, `<family>.safetensors` the averaged network of the best evaluation.

    Args:
        args: options with `out`, `minutes`, `rate` and `weight_decay`; they are written into the file of weights, and a
            run is continued with the same ones only (`may_change`).
        family: kind of the network.
        model: the network with its initial weights.
        max_gradient_norm: gradients are scaled down to this norm.
        samples_per_step: samples of one step, for the rate in `train.csv`.
        files: of the training and of the evaluation, by the option that names their folders.

    Raises:
        ConfigError: the folder holds a run with other options or files, or of another network, or a broken state.
    """

    may_change: ClassVar[frozenset[str]] = frozenset({"out", "minutes", "threads"})
    """Options in which a continued run may differ from its start."""

    def __init__(
        self,
        args: Any,
        family: Family[Any, Any],
        model: nn.Module,
        *,
        max_gradient_norm: float,
        samples_per_step: int,
        files: Mapping[str, Sequence[Path]],
    ) -> None:
        self.args, self.family, self.model = args, family, model
        self.average = AveragedModel(model, multi_avg_fn=exponential_average(AVERAGE), use_buffers=True)
        self.optimiser = torch.optim.AdamW(model.parameters(), lr=args.rate, weight_decay=args.weight_decay)
        self.bf16 = bool(torch.cpu.get_capabilities().get("avx512_bf16"))
        options = options_of(args, may_change=self.may_change, files=files)
        self.progress = Progress(0, 0.0, math.inf, 0.0, options)
        self._evaluation_s = 0.0
        """Duration of the last evaluation, which is part of the time."""
        self._max_gradient_norm, self._samples_per_step = max_gradient_norm, samples_per_step
        self.out: Path = args.out
        self.out.mkdir(parents=True, exist_ok=True)
        self._resume()

    @abstractmethod
    def losses(self) -> tuple[Tensor, Mapping[str, Tensor]]:
        """Returns the loss of the next step, with its gradient, and the parts of it for `train.csv`."""

    @abstractmethod
    def evaluate(self, model: nn.Module) -> tuple[float, Mapping[str, object], str]:
        """Returns the loss of the averaged network, a row for `val.csv`, and the words to print."""

    @abstractmethod
    def about(self) -> Mapping[str, object]:
        """Returns the description of the data in the file of weights."""

    def save(self, file: Path, model: Any, card: Mapping[str, object]) -> None:
        """Writes the averaged network, with a description of its training in the file's header."""
        self.family.save(file, model, card)

    def run(self) -> None:
        """Trains until the time is up."""
        progress, limit_s = self.progress, 60.0 * self.args.minutes
        if progress.spent_s >= limit_s:
            print("the time was up before: nothing to do", flush=True)
            return
        start_s, saved_s = time.perf_counter() - progress.spent_s, time.perf_counter()
        printed_s = saved_s
        parts: list[dict[str, float]] = []
        first_step = progress.step
        while progress.step == first_step or progress.spent_s + self._evaluation_s < limit_s:
            parts.append(self.train_once())
            progress.spent_s = time.perf_counter() - start_s
            if len(parts) == LOG_EVERY_STEPS:
                message = self._log(parts)
                parts = []
                if time.perf_counter() - printed_s >= PRINT_EVERY_S:
                    printed_s = time.perf_counter()
                    left = f"{max(0.0, limit_s - progress.spent_s) / 60:.1f} of {self.args.minutes:g} min left"
                    print(f"step {progress.step}, {left}: {message}", flush=True)
            if progress.spent_s - progress.evaluated_s > max(EVALUATE_EVERY * limit_s, 10.0 * self._evaluation_s):
                self._evaluate()
            if time.perf_counter() - saved_s > SAVE_EVERY_S:
                self._save_state()
                saved_s = time.perf_counter()
        self._evaluate()
        progress.spent_s = max(progress.spent_s, limit_s)
        self._save_state()

    def train_once(self) -> dict[str, float]:
        """Makes one step of the optimiser; returns the parts of the loss."""
        progress = self.progress
        done = progress.spent_s / (60.0 * self.args.minutes)
        warm = min(1.0, (progress.step + 1) / WARM_UP_STEPS)
        for group in self.optimiser.param_groups:
            group["lr"] = self.args.rate * warm * 0.5 * (1.0 + math.cos(math.pi * done))
        self.model.train()
        self.optimiser.zero_grad(set_to_none=True)
        loss, parts = self.losses()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(self.model.parameters(), self._max_gradient_norm)
        self.optimiser.step()
        self.average.update_parameters(self.model)
        progress.step += 1
        return {name: float(part.detach()) for name, part in parts.items()}

    @torch.no_grad()
    def _evaluate(self) -> None:
        """Evaluates the averaged network, writes a row, and saves it if it is the best so far."""
        progress, began_s = self.progress, time.perf_counter()
        progress.evaluated_s = progress.spent_s
        model: Any = self.average.module.eval()
        loss, result, message = self.evaluate(model)
        row = {"step": progress.step, "minutes": round(progress.spent_s / 60, 2), **result}
        row = {key: round(value, 4) if isinstance(value, float) else value for key, value in row.items()}
        append_row(self.out / "val.csv", row)
        print(f"held back, step {progress.step}: {message}", flush=True)
        if loss < progress.best:
            progress.best = loss
            options = {key: str(value) for key, value in asdict(self.args).items()}
            card = {"val": row, "options": options, "torch": torch.__version__, **self.about()}
            self.save(self.out / f"{self.family.name}.safetensors", model, card)
            self._save_state()  # so that a continued run knows the best
        self._evaluation_s = time.perf_counter() - began_s

    def _log(self, parts: list[dict[str, float]]) -> str:
        """Writes a row of the training curve; returns its losses in words."""
        progress = self.progress
        means = {name: round(float(np.mean([part[name] for part in parts])), 4) for name in parts[0]}
        row = {"step": progress.step, "minutes": round(progress.spent_s / 60, 3), **means}
        per_s = round(self._samples_per_step * progress.step / max(progress.spent_s, 1e-9), 1)
        append_row(self.out / "train.csv", row | {"samples_per_s": per_s})
        return ", ".join(f"{name.replace('_', ' ')} {value}" for name, value in means.items())

    def _resume(self) -> None:
        """Loads the state of the run, if there is one, and removes the rows of the curves that are later."""
        now = self.progress.options
        done = load_state(
            self.out / "state.pt",
            self._parts(),
            Progress,
            check=lambda progress: require_options(self.out, progress.options, now),
        )
        if done is not None:
            self.progress = done
            print(f"continues from step {done.step}, {done.spent_s / 60:.1f} min", flush=True)
        for name in ("train.csv", "val.csv"):  # also of a run that was killed before it wrote a state
            cut_rows(self.out / name, "step", self.progress.step)

    def _parts(self) -> dict[str, HasState]:
        """Returns the content of `state.pt` apart from the progress."""
        return {"model": self.model, "average": self.average, "optimiser": self.optimiser}

    def _save_state(self) -> None:
        save_state(self.out / "state.pt", self._parts(), msgspec.to_builtins(self.progress))
