"""The options of `stubborn train segmentation`, and their checks."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from sim.core.interface import CameraModel, ConfigError
from sim.core.option_types import Amount, Count, OutFolder, Positive, Seed, Share
from stubborn.segmentation.networks import NETWORKS

MAY_CHANGE = (
    "out", "views", "val_views", "steps", "hours", "stop_after_hours", "workers", "threads", "device", "precision",
    "evaluate_every",
)  # fmt: skip
"""Options in which a continued run may differ from its start. More views may be added; those for evaluation are
compared by their files."""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Train a segmentation network on labelled views."""

    out: OutFolder
    """Folder of the run; an existing run is continued."""
    views: tuple[Path, ...] = ()
    """Folders of training shards with --extras instances. By default `stubborn views mix` makes 100,000 views in the
    folder `views` of --out."""
    val_views: tuple[Path, ...] = ()
    """Folders of shards to evaluate on, and to choose the network by; needed with --views."""
    furniture: Path | None = None
    """Without --views: a folder of imported models (`stubborn import furniture`) for the houses of the views."""
    size: str | None = None
    """Network: compact, compact-geometry, compact-both, published. None: that of --init, else compact-both."""
    init: Path | None = None
    """Initial weights: `shipped`, a file of this tool, or a checkpoint of the published network. compact-both also
    takes those of compact, and starts with their output."""
    init_share: Share = 0.0
    """Share of the initial weights in the network that is evaluated and kept; the rest are the trained ones. With 0.5,
    a short training on new views keeps what the initial network knew of others (Wortsman et al. 2022)."""
    precision: str = "auto"
    """bf16, fp32, or auto: bf16 where the processor or the GPU computes with it."""
    block_px: Count = 4
    """Factor by which the network's images are smaller than 640 x 480; it is stored with the weights."""
    steps: Count = 100_000
    """Number of steps of the recipe."""
    hours: Positive | None = None
    """Time limit of the training, after the views are there, evaluations included; the recipe is fitted to it. None:
    --steps."""
    stop_after_hours: Positive | None = None
    """Stop earlier than --hours, without a change of the recipe; the same command with a larger value continues."""
    batch: Count = 16
    """Views per step; twice as many windows in the first phase."""
    rate: Positive = 1.2e-3
    """Peak learning rate of AdamW."""
    workers: Amount = 0
    """Number of processes that read views."""
    threads: Count | None = None
    """Number of threads of PyTorch; None does not change it."""
    device: str = "auto"
    """auto, cpu or cuda."""
    evaluate_every: Count = 1000
    """Steps between evaluations."""
    val_count: Amount = 400
    """Number of views of an evaluation; 0: all."""
    seed: Seed = 0
    """Seed of the initial weights, the order and the augmentation."""


def check(args: Args) -> None:
    """Raises ConfigError for arguments that are not allowed, or not together."""
    for name, known in (("precision", ("auto", "bf16", "fp32")), ("device", ("auto", "cpu", "cuda"))):
        if getattr(args, name) not in known:
            raise ConfigError(f"--{name} must be {', '.join(known)}, got '{getattr(args, name)}'.")
    if args.size is not None and args.size not in NETWORKS:
        raise ConfigError(f"--size must be one of {', '.join(NETWORKS)}, got '{args.size}'.")
    if args.batch < 2:
        raise ConfigError(f"--batch must be at least 2 for batch normalisation, got {args.batch}.")
    if bool(args.views) != bool(args.val_views):
        raise ConfigError("--views and --val-views are given together; without both, `stubborn views mix` makes them.")
    if args.init_share and args.init is None:
        raise ConfigError("--init-share needs --init: random weights have nothing to keep.")
    if args.views and args.furniture is not None:
        raise ConfigError("--furniture is for the views that this command makes; it excludes --views.")
    camera = CameraModel()
    if camera.width_px % args.block_px or camera.height_px % args.block_px:
        raise ConfigError(f"--block-px must divide {camera.width_px} and {camera.height_px}, got {args.block_px}.")
