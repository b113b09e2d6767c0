"""The loop of `stubborn train segmentation`: steps, evaluations, curves and the state that continues a run."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path

import msgspec
import numpy as np
import torch
from torch import Tensor
from torch.optim.swa_utils import AveragedModel
from torch.utils.data import DataLoader, Subset

from sim.core.interface import CameraModel, ConfigError
from sim.core.paths import code_hash
from sim.core.reading import Count, Number
from sim.training.segmentation.balanced import Batches, ViewIndex
from sim.training.segmentation.dataset import (
    GOAL_IDS,
    LabelledView,
    list_shards,
    pixel_counts,
    spread_views,
    stored_block_px,
    stored_views,
)
from sim.training.segmentation.device_batches import DeviceBatches, room_for
from sim.training.segmentation.evaluation import Iou, evaluate
from sim.training.segmentation.options import MAY_CHANGE, Args, check
from sim.training.segmentation.recipe import PROGRESSIVE
from sim.training.segmentation.samples import Augmentation, Sampler, Samples
from sim.training.segmentation.steps import (
    AveragedCheckpoints,
    exponential_average,
    pyramid_loss,
    root_class_weights,
    set_normalisation,
)
from sim.training.segmentation.trained_network import device_of, precision_of, start_network
from sim.training.training_files import (
    HasState,
    append_row,
    cut_rows,
    load_state,
    options_of,
    require_options,
    save_state,
)
from stubborn.segmentation.checkpoints import save_network
from stubborn.segmentation.rednet import RedNet

RECIPE = PROGRESSIVE
LOG_EVERY_STEPS = 20
EVALUATION_SHARE = 0.1
"""Largest share of the time that an evaluation takes with --hours; if necessary, fewer views are evaluated."""
PRINT_EVERY_S = 10.0
"""Shortest time between two lines that print the loss."""
NORMALISATION_VIEWS = 320
"""Number of whole views that give mean and variance of the normalisations of an evaluated network."""
MAX_GRADIENT_NORM = 5.0
SAVE_EVERY_S = 300.0
"""Shortest time between two writes of the state, 150 MB."""


class _Progress(msgspec.Struct):
    """The progress of a run, as `state.pt` holds it."""

    size: str
    step: Count
    spent_s: Number
    best: float
    """-inf before the first evaluation."""
    total: Count
    evaluated_step: Count
    """Step of the last evaluation."""
    options: dict[str, str]
    """See `options_of`."""
    hours: float | None = None
    """The time limit, --hours."""
    val_stride: Count = 1
    """One of this many views is evaluated."""
    evaluation_s: Number = 0.0
    """Duration of the last evaluation."""


class Trainer:
    """The network, the optimiser, the data and the progress of one run."""

    def __init__(self, args: Args) -> None:
        self._began_s = time.perf_counter()
        check(args)
        self.args = args
        self.device = device_of(args.device)
        if args.threads is not None:
            torch.set_num_threads(args.threads)
        torch.manual_seed(args.seed)
        shards, val_shards = _all_shards(args.views), _all_shards(args.val_views)
        if (known := stored_views(shards)) is not None and known < args.batch:
            folders = ", ".join(map(str, args.views))
            raise ConfigError(f"--views {folders}: fewer views than one batch of {args.batch} (--batch).")
        self.size, model, self.started_from = start_network(args.size, args.init)
        self.model = model.to(self.device)
        self._initial = [parameter.detach().clone() for parameter in self.model.parameters()]
        self.model.to(memory_format=torch.channels_last)  # pyright: ignore[reportCallIssue] - its stub lacks it
        self.average = AveragedModel(self.model, multi_avg_fn=exponential_average(RECIPE.average), use_buffers=True)
        self.precision = precision_of(args.precision, self.device)
        self.optimiser = torch.optim.AdamW(self.model.parameters(), lr=args.rate, weight_decay=RECIPE.weight_decay)
        self.options = options_of(args, may_change=MAY_CHANGE, files={"val_views": val_shards})
        self.weights = root_class_weights(pixel_counts(shards)).to(self.device)
        self._make_data(shards, val_shards)
        self.start_miou: float | None = None
        """Calibrated mIoU over the goal categories before the first step; None: not measured by this process."""
        self._val_stride, self._evaluation_s = 1, 0.0
        """See `_Progress`."""
        self.step, self.spent_s, self.best = 0, 0.0, -math.inf
        self.evaluated_step = 0
        self.loading_s = 0.0
        """Time since the start of this process in which the step waited for views."""
        self.first_step = 0
        self._printed_s = 0.0
        self.total = args.steps
        self.checkpoints = AveragedCheckpoints(args.out, RECIPE.checkpoints, RECIPE.checkpoint_share)
        args.out.mkdir(parents=True, exist_ok=True)
        self._resume()

    def _make_data(self, shards: Sequence[Path], val_shards: Sequence[Path]) -> None:
        """Reads the index of the views for training, the views for evaluation, and those for the normalisation."""
        stored_px = stored_block_px([*shards, *val_shards])
        if self.args.block_px % stored_px:
            raise ConfigError(f"--block-px {self.args.block_px} is not a multiple of {stored_px}, that of the views.")
        camera, second, used = CameraModel(), self.model.config.second, self.args.block_px // stored_px
        index = ViewIndex.of(shards, workers=self.args.workers)
        counts = ", ".join(f"{name} {n} of {styles}" for name, (n, styles) in index.counts().items())
        print(f"{len(index.views)} views; objects and styles: {counts}", flush=True)
        sampler = Sampler(camera, 1, Augmentation(), second=second, used_block_px=used, area_weights=True)
        views, whole = spread_views(val_shards, self.args.val_count), spread_views(shards, NORMALISATION_VIEWS)
        _require_usable(views, whole)
        self.data = self._make_batches(index, sampler)
        self.val: Samples | Subset = Samples(views, Sampler(camera, used, second=second))
        self.whole = Samples(whole, Sampler(camera, used, Augmentation(), second=second))

    def _make_batches(self, index: ViewIndex, sampler: Sampler) -> Batches | DeviceBatches:
        """Returns the batches, on a GPU computed there if its memory has room for the views."""
        made, count = {"batch": self.args.batch, "seed": self.args.seed}, len(index.views)
        if self.device.type != "cuda":
            return Batches(index, sampler, RECIPE, **made)
        if (most := room_for(index.views, self.device)) < count:
            print(f"The GPU's memory has room for {most} of {count} views: --workers processes make the samples.")
            return Batches(index, sampler, RECIPE, **made)
        began_s = time.perf_counter()
        batches = DeviceBatches(index, sampler, RECIPE, **made, device=self.device, workers=self.args.workers)
        print(f"{count} views on the GPU after {time.perf_counter() - began_s:.0f} s", flush=True)
        return batches

    def run(self) -> None:
        """Trains until the steps are done or the time is up."""
        start_s, last_saved_s = self._began_s - self.spent_s, time.perf_counter()
        losses: list[Tensor] = []
        self.first_step = self.step
        if self.step == 0:
            self._evaluate_start()
        self._printed_s = train_s = time.perf_counter()
        for batch in self._batches():
            losses.append(self._train_on(*batch))
            self.step += 1
            self.spent_s = time.perf_counter() - start_s
            made = self.step - self.first_step
            is_due = made < LOG_EVERY_STEPS or self.step % LOG_EVERY_STEPS == 0
            if self.args.hours is not None and (is_due or self._left_s() <= 0.0):  # steps take longer under load
                per_step_s = (time.perf_counter() - train_s) / made
                self.total = self.step + max(0, int(self._left_s() / per_step_s))
            if time.perf_counter() - self._printed_s >= PRINT_EVERY_S:
                self._print_loss(_mean(losses))
            if self.step % LOG_EVERY_STEPS == 0:
                self._log(_mean(losses))
                losses.clear()
            if self.step % self.args.evaluate_every == 0:
                self._evaluate()
                last_saved_s = time.perf_counter()
            elif time.perf_counter() - last_saved_s > SAVE_EVERY_S:
                self._save_state()
                last_saved_s = time.perf_counter()
        if losses:  # of the last steps, or of a training shorter than one row
            self._log(_mean(losses))
            self._print_loss(_mean(losses))
        if self.step > self.evaluated_step:
            self._evaluate()
        self._save_state()

    def _time_is_up(self) -> bool:
        limit = self.args.stop_after_hours
        return limit is not None and self.spent_s >= 3600 * limit

    def _left_s(self) -> float:
        """Returns the time for further steps, without the evaluation at the end; without --hours an estimate."""
        if self.args.hours is None:
            return (self.total - self.step) * self.spent_s / max(1, self.step)
        return 3600 * self.args.hours - self.spent_s - 1.1 * self._evaluation_s

    def _evaluate_start(self) -> None:
        """Prints the quality of the network before the first step; with --hours chooses how many views are used."""
        if self.args.hours is not None:
            few = Subset(self.val, range(min(8, len(self.val))))
            evaluate(self.model, DataLoader(few, batch_size=8), device=self.device)  # the first one starts a GPU
            began_s = time.perf_counter()
            evaluate(self.model, DataLoader(few, batch_size=8), device=self.device)
            most = int(EVALUATION_SHARE * 3600 * self.args.hours * len(few) / (time.perf_counter() - began_s))
            if most < len(self.val):
                count = len(self.val)
                self._evaluate_every_nth_view(-(-count // max(most, 8)))
                print(f"evaluations use {len(self.val)} of {count} views, to meet the time limit", flush=True)
        began_s = time.perf_counter()
        iou, _, calibrated = evaluate(self.model, DataLoader(self.val, batch_size=8), device=self.device)
        self._evaluation_s, self.start_miou = time.perf_counter() - began_s, calibrated.goals
        name = "random weights" if self.args.init is None else f"weights of {self.args.init}"
        print(f"start, {name}: mIoU of goals {iou.goals:.3f}, calibrated {calibrated.goals:.3f}", flush=True)

    def _evaluate_every_nth_view(self, n: int) -> None:
        """Leaves out views of the evaluations, so that one in `n` stays."""
        self.val = Subset(self.val, range(0, len(self.val), n))
        self._val_stride *= n

    def _batches(self) -> Iterator[Sequence[Tensor]]:
        """Yields the batch of each step until the steps are done or the time is up; measures how long each takes."""
        workers = self.args.workers if isinstance(self.data, Batches) else 0  # the GPU makes the batches of the others
        loader = DataLoader(self.data, batch_size=None, sampler=_Steps(self), num_workers=workers)
        batches = iter(loader)
        while self.step < self.total and not self._time_is_up():
            start_s = time.perf_counter()
            batch = next(batches)
            self.loading_s += time.perf_counter() - start_s
            yield batch

    def _train_on(self, rgb: Tensor, second: Tensor, target: Tensor, pixels: Tensor) -> Tensor:
        """Makes one step of the optimiser and returns the loss; a GPU may still be computing it."""
        rate = self.args.rate * RECIPE.relative_rate(self.step, self.total)
        for group in self.optimiser.param_groups:
            group["lr"] = rate
        self.model.train()
        self.optimiser.zero_grad(set_to_none=True)
        with torch.autocast(self.device.type, dtype=torch.bfloat16, enabled=self.precision == "bf16"):
            rgb = rgb.to(self.device).contiguous(memory_format=torch.channels_last)
            second = second.to(self.device).contiguous(memory_format=torch.channels_last)
            loss = self._loss(rgb, second, target.to(self.device), pixels.to(self.device))
        loss.backward()
        torch.nn.utils.clip_grad_norm_(self.model.parameters(), MAX_GRADIENT_NORM)
        self.optimiser.step()
        self.average.update_parameters(self.model)
        return loss.detach()

    def _loss(self, rgb: Tensor, second: Tensor, target: Tensor, pixels: Tensor) -> Tensor:
        """Returns the loss; the finest output is trained on one random pixel of each 2 x 2 block."""
        row, column = divmod(int(np.random.default_rng([self.args.seed, 2, self.step]).integers(4)), 2)
        outputs = self.model.pyramid(rgb, second, subpixel=(row, column))
        return pyramid_loss(outputs, target, self.weights, subpixel=(row, column), pixels=pixels)

    def _evaluate(self) -> None:
        """Evaluates, writes a row, saves the network, as the best one if it is that, and then the state."""
        began_s = time.perf_counter()
        self.evaluated_step = self.step
        print(f"step {self.step} of {self.total}: evaluating on {len(self.val)} views", flush=True)
        averaged = self._usable()
        iou, reliability, calibrated = evaluate(averaged, DataLoader(self.val, batch_size=8), device=self.device)
        row = {"step": self.step, "hours": round(self.spent_s / 3600, 4), "miou_goals": iou.goals}
        row |= {"miou_calibrated": calibrated.goals, "views": len(self.data.index.views)}
        row |= {"miou_all": iou.everything, "accuracy": iou.accuracy, "calibration_error": reliability.error}
        append_row(self.args.out / "val.csv", row | iou.by_category)
        print(f"step {self.step}: mIoU of goals {iou.goals:.3f}, calibrated {calibrated.goals:.3f}", flush=True)
        save_network(self.args.out / "last.safetensors", averaged, self._card(iou, calibrated))
        if calibrated.goals > self.best:
            self.best = calibrated.goals
            save_network(self.args.out / "rednet.safetensors", averaged, self._card(iou, calibrated))
        self._evaluation_s = time.perf_counter() - began_s
        self._save_state()

    def _usable(self) -> RedNet:
        """Returns the mean of the averaged weights at this and the last evaluations, normalised for whole views.

        The initial weights have the share `--init-share` in it.
        """
        now: RedNet = self.average.module  # pyright: ignore[reportAssignmentType] - the same class
        network = self.checkpoints.add(now, self.step).to(self.device)
        with torch.no_grad():
            for trained, initial in zip(network.parameters(), self._initial, strict=True):
                trained.lerp_(initial, self.args.init_share)
        loader = DataLoader(self.whole, batch_size=16)
        set_normalisation(network, ((rgb.to(self.device), second.to(self.device)) for rgb, second, _ in loader))
        return network

    def _card(self, iou: Iou, calibrated: Iou) -> Mapping[str, object]:
        """Returns the metadata of the file of weights."""
        options: dict[str, object] = {
            key: None if value is None else str(value) for key, value in asdict(self.args).items()
        }
        options |= {key: [str(folder) for folder in getattr(self.args, key)] for key in ("views", "val_views")}
        earlier: dict[str, object] = {"started_from": self.started_from} if self.started_from else {}
        earlier |= {"averaged": True} if self.args.init_share else {}
        return earlier | {
            "block_px": self.args.block_px,
            "step": self.step,
            "hours": round(self.spent_s / 3600, 3),
            "miou_goals": round(iou.goals, 4),
            "miou_calibrated": round(calibrated.goals, 4),
            "options": options,
            "recipe": asdict(RECIPE),
            "torch": torch.__version__,
            "code": f"code {code_hash()}",
        }

    def _log(self, loss: float) -> None:
        """Writes a row of the training curve."""
        rate = max(group["lr"] for group in self.optimiser.param_groups)
        made = max(1, self.step - self.first_step)
        row = {"step": self.step, "of": self.total, "hours": round(self.spent_s / 3600, 4), "loss": round(loss, 4)}
        row |= {"rate": f"{rate:.2e}", "steps_per_s": round(self.step / max(self.spent_s, 1e-9), 3)}
        append_row(self.args.out / "train.csv", row | {"loading_s_per_step": round(self.loading_s / made, 3)})

    def _print_loss(self, loss: float) -> None:
        self._printed_s = time.perf_counter()
        rate = self.step / max(self.spent_s, 1e-9)
        left = f"{max(0.0, self._left_s()) / 60:.1f} min left"
        print(f"step {self.step} of {self.total}: loss {loss:.3f}, {rate:.2f} steps/s, {left}", flush=True)

    def _parts(self) -> dict[str, HasState]:
        """Returns the content of `state.pt` apart from the progress."""
        return {"model": self.model, "average": self.average, "optimiser": self.optimiser}

    def _save_state(self) -> None:
        progress = {"size": self.size, "step": self.step, "spent_s": self.spent_s, "best": self.best}
        progress |= {"total": self.total, "evaluated_step": self.evaluated_step}
        progress |= {"hours": self.args.hours, "options": self.options}
        progress |= {"val_stride": self._val_stride, "evaluation_s": self._evaluation_s}
        save_state(self.args.out / "state.pt", self._parts(), progress)

    def _resume(self) -> None:
        """Loads the state of the run, if it exists, and removes lines that a killed process wrote after it.

        Raises:
            ConfigError: the run is of another size or had other options, or its state is broken.
        """
        done = load_state(
            self.args.out / "state.pt", self._parts(), _Progress, device=self.device, check=self._require_same
        )
        if done is not None:
            self.step, self.spent_s, self.best = done.step, done.spent_s, done.best
            self.evaluated_step, self._evaluation_s = done.evaluated_step, done.evaluation_s
            self._evaluate_every_nth_view(done.val_stride)
            if self.args.hours is not None:
                longer = self.spent_s > 0 and done.hours is not None and self.args.hours > done.hours
                total = int(self.step * 3600 * self.args.hours / self.spent_s) if longer else done.total
                self.total = max(total, self.step)
            print(f"continues from step {self.step}, {self.spent_s / 3600:.2f} h", flush=True)
        for name in ("train.csv", "val.csv"):  # also of a run that was killed before it wrote a state
            cut_rows(self.args.out / name, "step", self.step)
        self.checkpoints.cut(self.step)

    def _require_same(self, done: _Progress) -> None:
        if done.size != self.size:
            raise ConfigError(f"--out '{self.args.out}' holds a run of size '{done.size}'; take another folder.")
        require_options(self.args.out, done.options, self.options)


class _Steps:
    """The keys of `Batches` from the next step on: the number of a step, and the share of all steps before it."""

    def __init__(self, trainer: Trainer) -> None:
        self._trainer = trainer

    def __iter__(self) -> Iterator[tuple[int, float]]:
        step = self._trainer.step
        while True:
            yield step, step / max(1, self._trainer.total)
            step += 1


def _mean(losses: Sequence[Tensor]) -> float:
    return float(torch.stack(list(losses)).mean())


def _require_usable(val: Sequence[LabelledView], whole: Sequence[LabelledView]) -> None:
    """Raises ConfigError if views have different sizes, or if those for the evaluation show no goal category."""
    sizes = sorted({view.semantic.shape[::-1] for view in (*val, *whole)})
    if len(sizes) > 1:
        texts = ", ".join(f"{width} x {height}" for width, height in sizes)
        raise ConfigError(f"--views and --val-views must have one size, got views of {texts} pixels.")
    if not any(np.isin(view.semantic, GOAL_IDS).any() for view in val):
        raise ConfigError("--val-views show no goal category, by which the best network is chosen: give other views.")


def _all_shards(folders: Sequence[Path]) -> list[Path]:
    return [shard for folder in folders for shard in list_shards(folder)]
