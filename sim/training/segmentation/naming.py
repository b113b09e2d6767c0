"""Trains the second head of a segmentation network, for everyday names: a fridge or a cooker among the appliances.

    stubborn train names --views runs/views/reshaped --val-views runs/views/selection --minutes 30 --out runs/names

The network itself is not changed; `rednet.safetensors` in --out is the network with the head, of the best evaluation so
far. Agents ask it where goals are in words. The same command continues a killed run.
"""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Int64
from torch import Tensor, nn

from sim.core.interface import CameraModel, ConfigError
from sim.core.invocation import command
from sim.core.option_types import Count, NotNegative, OutFolder, Positive, Seed
from sim.core.vocabulary import NO_OBJECTS, UNSEEN, vocabulary
from sim.homes.housegen.furniture.names import listed_name
from sim.training.segmentation.balanced import Annotation, ShownObject, ViewIndex, one_of
from sim.training.segmentation.dataset import list_shards, stored_block_px
from sim.training.segmentation.samples import IGNORED, NONE, Augmentation, Sampler
from sim.training.timed_training import TimedTraining, stride
from sim.training.training_files import print_next_commands
from stubborn.network_files import Family
from stubborn.segmentation.checkpoints import load_network, save_network
from stubborn.segmentation.names import NameGroups
from stubborn.segmentation.network import block_px_of
from stubborn.segmentation.rednet import RedNet, RedNetConfig
from stubborn.segmentation.shipped import SHIPPED_REDNET

MIN_OBJECTS = 20
"""A name that fewer objects of the views have is not learned."""
_QUARTER = 4
"""Edge of the pixels of the network's input that one logit of a name is for."""
FILES = Family("rednet", RedNetConfig, RedNet, "`stubborn train segmentation`")


@dataclass(frozen=True, kw_only=True)
class Args:
    """Train the head of a segmentation network that tells everyday names apart."""

    views: tuple[Path, ...]
    """Folders of training shards with --extras instances (`stubborn views mix`)."""
    val_views: tuple[Path, ...]
    """Folders of shards to evaluate on."""
    out: OutFolder
    """Folder of the run; an existing run is continued."""
    weights: Path | None = None
    """The network, a RedNet; None: the shipped one. A head that it has is trained further, with the same names."""
    minutes: Positive = 30.0
    """Time of the training, to which the learning rate is fitted."""
    batch: Count = 16
    """Views per step."""
    rate: Positive = 2e-3
    """Peak learning rate of AdamW."""
    weight_decay: NotNegative = 0.02
    """Weight decay of AdamW."""
    threads: Count = 1
    """Number of threads of PyTorch."""
    val_count: Count = 1500
    """Largest number of objects in an evaluation."""
    seed: Seed = 0
    """Seed of the initial weights, the order and the augmentation."""


def main(args: Args) -> int:
    """Trains; returns the exit status."""
    torch.set_num_threads(args.threads)
    Trainer(args).run()
    weights = args.out / "rednet.safetensors"
    chosen = ("--agent", "stubborn-plus", "--split", "words-seen", "--weights", str(weights))
    print_next_commands(weights, command("run", *chosen, "--episodes", "2"))
    return 0


def known_name(category: str, annotation: Annotation) -> str | None:
    """Returns the name that is learned for an object; None: it has none, or no training may use it.

    Views of earlier versions have no names; there it is that of the style.
    """
    name = annotation.everyday_name or listed_name(category, annotation.style) or ""
    is_known = name in vocabulary().categories and category in vocabulary().categories[name]
    return name if is_known and name not in UNSEEN and category not in NO_OBJECTS else None


class NamedViews:
    """Views as training samples whose labels are names.

    Args:
        index: the views, and the objects of each name.
        names: the names; others are not labelled.
        sampler: makes samples.
    """

    def __init__(self, index: ViewIndex, names: Sequence[str], sampler: Sampler) -> None:
        self.index, self.sampler = index, sampler
        self.objects: list[tuple[int, ShownObject]] = []
        """Every object, with the number of its name."""
        self._numbers: dict[int, dict[int, int]] = {}
        for number, name in enumerate(names):
            for shown in (one for of_style in index.objects.get(name, {}).values() for one in of_style):
                self.objects.append((number, shown))
                self._numbers.setdefault(shown.view, {})[shown.number] = number

    def sample(self, shown: ShownObject, rng: np.random.Generator) -> tuple[Tensor, ...]:
        """Returns colour, the second input and the number of the name at each pixel, or `IGNORED`."""
        view = self.index.views[shown.view].read()
        if view.instances is None:
            raise ConfigError(f"View '{view.key}' has no instances; `stubborn views --extras instances` stores them.")
        table = np.zeros(int(view.instances.max()) + 1, np.uint8)
        for instance, name in self._numbers[shown.view].items():
            if instance < len(table):
                table[instance] = name + 1  # `labels` takes 1 away, and ignores 0
        return self.sampler(replace(view, semantic=table[view.instances]), rng, instance=shown.number)


class Trainer(TimedTraining):
    """The head, the frozen network, the views and the progress of one run."""

    may_change = TimedTraining.may_change | {"val_count"}

    def __init__(self, args: Args) -> None:
        shards, val_shards = ([file for folder in folders for file in list_shards(folder)] for folders in
                              (args.views, args.val_views))  # fmt: skip
        network, self._metadata = load_network(args.weights or SHIPPED_REDNET)
        index, val_index = (ViewIndex.of(files, label_of=known_name) for files in (shards, val_shards))
        counts = {name: sum(map(len, styles.values())) for name, styles in index.objects.items()}
        often = tuple(sorted(name for name, count in counts.items() if count >= MIN_OBJECTS))
        self.names = network.config.names or often
        self._sampled = [name for name in self.names if index.objects.get(name)]
        if len(self._sampled) < 2:
            raise ConfigError(
                f"The views show {len(self._sampled)} names with {MIN_OBJECTS} objects; at least 2 are needed."
            )
        torch.manual_seed(args.seed)
        self.network = RedNet(replace(network.config, names=self.names))
        self.network.load_state_dict(network.state_dict(), strict=False)
        self.network.requires_grad_(False).eval()
        head: nn.Module = self.network.names_head  # type: ignore[assignment]
        self.groups = NameGroups.of(self.names)
        together = self.groups.members.T.astype(np.float32) @ self.groups.members.astype(np.float32) > 0.0
        self._apart = torch.from_numpy(np.where(together, 0.0, -1e4).astype(np.float32))
        """For each name, 0 for names of the same category, and a large negative number for others."""
        stored_px = stored_block_px([*shards, *val_shards])
        block_px = block_px_of(network, self._metadata)
        if block_px % stored_px:
            raise ConfigError(f"The network takes blocks of {block_px} pixels, no multiple of the views' {stored_px}.")
        used = block_px // stored_px
        width_px = CameraModel().width_px // (used * stored_px)
        sampler = Sampler(CameraModel(), 1, Augmentation(), width_px, 0.5, network.config.second, used)
        self.train = NamedViews(index, self.names, sampler)
        whole = replace(sampler, block_px=used, augmentation=NONE, window_px=None)
        self.val = NamedViews(val_index, self.names, whole)
        if not self.val.objects:
            raise ConfigError("--val-views show no object with one of the names that are learned.")
        super().__init__(args, FILES, head.requires_grad_(True), max_gradient_norm=5.0, samples_per_step=args.batch,
                         files={"views": shards, "val_views": val_shards})  # fmt: skip
        print(
            f"{len(self.names)} names, {len(self.train.objects)} objects, {len(self.val.objects)} for evaluation",
            flush=True,
        )

    def losses(self) -> tuple[Tensor, Mapping[str, Tensor]]:
        """See `TimedTraining.losses`; the samples of a step depend on seed and step only."""
        rng = np.random.default_rng([self.args.seed, self.progress.step])
        names = [self._sampled[number] for number in rng.integers(len(self._sampled), size=self.args.batch)]
        drawn = [one_of(one_of(list(self.train.index.objects[name].values()), rng), rng) for name in names]
        rgb, second, target = (
            torch.stack(part) for part in zip(*(self.train.sample(one, rng) for one in drawn), strict=True)
        )
        logits, target = self._logits(self.model, rgb, second, target)
        loss = nn.functional.cross_entropy(logits + self._apart[target], target)
        return loss, {"loss": loss}

    def _logits(
        self, head: nn.Module, rgb: Tensor, second: Tensor, target: Int64[Tensor, "n h w"]
    ) -> tuple[Tensor, Tensor]:
        """Returns the logits (m, names) and the names (m,) of the pixels with a label."""
        with torch.autocast("cpu", torch.bfloat16, enabled=self.bf16):
            with torch.no_grad():
                stages, _ = self.network.features(
                    rgb.contiguous(memory_format=torch.channels_last),
                    second.contiguous(memory_format=torch.channels_last),
                )
            logits = head(stages)
        small = target[:, _QUARTER // 2 :: _QUARTER, _QUARTER // 2 :: _QUARTER]
        labelled = small != IGNORED
        return logits.permute(0, 2, 3, 1)[labelled].float(), small[labelled]

    def evaluate(self, model: nn.Module) -> tuple[float, Mapping[str, object], str]:
        """See `TimedTraining.evaluate`: the share of right pixels of each name, for all views that show an object."""
        objects = self.val.objects[:: stride(len(self.val.objects), self.args.val_count)]
        right, count, losses = np.zeros(len(self.names)), np.zeros(len(self.names)), []
        for number, shown in objects:
            rgb, second, target = (part[None] for part in self.val.sample(shown, np.random.default_rng(0)))
            target = torch.where(target == number, target, IGNORED)
            logits, names = self._logits(model, rgb, second, target)
            if len(names):
                judged = logits + self._apart[names]
                losses.append(float(nn.functional.cross_entropy(judged, names).detach()))
                right[number] += float((judged.argmax(dim=1) == names).float().mean())
                count[number] += 1
        several = self.groups.members.sum(axis=1) > 1
        among = self.groups.members[several].any(axis=0) & (count > 0)  # names that share a category with another
        shares = right[among] / count[among]
        row: dict[str, object] = {"objects": int(count.sum()), "loss": float(np.mean(losses))}
        row |= {"names": int(among.sum()), "right": float(shares.mean()) if len(shares) else ""}
        row |= {name: round(float(right[i] / count[i]), 3) if count[i] else "" for i, name in enumerate(self.names)}
        right_text = f", right {row['right']:.3f} as a mean of {row['names']} names" if len(shares) else ""
        return float(np.mean(losses)), row, f"loss {row['loss']:.3f}{right_text}"

    def about(self) -> Mapping[str, object]:
        """See `TimedTraining.about`."""
        return {"names_trained_on": [str(folder) for folder in self.args.views]}

    def save(self, file: Path, model: nn.Module, card: Mapping[str, object]) -> None:
        """Writes the network with the head; its own metadata stay, and those of the head are in `names`."""
        saved = copy.copy(self.network)  # the network's own head is the one that is trained; `model` is its average
        saved._modules = self.network._modules | {"names_head": model}
        save_network(file, saved, self._metadata | {"names": card})
