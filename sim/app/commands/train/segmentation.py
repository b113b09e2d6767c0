"""Trains a segmentation network on labelled views, or finetunes a published RedNet.

stubborn train segmentation --furniture runs/models --out runs/rednet
stubborn train segmentation --views runs/views/{reshaped,models,train,aimed} --val-views runs/views/selection \
    --init stubborn/segmentation/weights/rednet.safetensors --out runs/rednet --hours 20
stubborn train segmentation --size published --block-px 1 --init rednet_semmap_mp3d_40.pth --views runs/views \
    --val-views runs/views_val --out runs/finetuned --steps 20000

The first command makes the views as well (`stubborn views mix`) and trains by the recipe of
`sim.training.segmentation.recipe`: small windows, larger ones, then whole views; each sample is drawn by category,
style and object; rare categories and small objects weigh more; a step trains the finest output on one of the four
pixels of each 2 x 2 block.

The same command continues a killed run, with the same result; views that were added in the meantime are used as well.
`state.pt` holds weights, their average, optimiser and step; `step-*.safetensors` are the averaged weights of the last
evaluations. `train.csv` and `val.csv` hold the curves; `rednet.safetensors` is the network with the best calibrated
mIoU so far, `last.safetensors` that of the last evaluation.
"""

from __future__ import annotations

from dataclasses import replace

from sim.app.commands.views import mix
from sim.core.invocation import command
from sim.training.segmentation.options import Args as Args
from sim.training.segmentation.options import check
from sim.training.segmentation.trainer import Trainer
from sim.training.training_files import print_next_commands


def main(args: Args) -> int:
    """Makes the views if none are given, and trains; returns the exit status."""
    check(args)
    args = args if args.views else _with_views(args)
    trainer = Trainer(args)
    trainer.run()
    weights = args.out / "rednet.safetensors"
    if trainer.start_miou is not None:
        print(f"mIoU of goals, calibrated: {trainer.start_miou:.3f} at the start, {trainer.best:.3f} now")
    print_next_commands(
        weights,
        command("evaluate", "--views", *map(str, args.val_views), "--weights", str(weights), "--calibrate"),
        command("run", "--semantics", "rednet", "--weights", str(weights)),
    )
    return 0


def _with_views(args: Args) -> Args:
    """Makes the views of the recipe, or what is missing of them; returns the options with their folders."""
    views = mix.Args(out=args.out / "views", furniture=args.furniture, workers=max(1, args.workers), seed=args.seed)
    mix.main(views)
    folders = mix.folders(views.out, views.furniture)
    return replace(args, views=folders, val_views=(views.out / mix.SELECTION,), furniture=None)
