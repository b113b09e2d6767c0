"""Files of samples for a predictor of potentials (`sim.training.poni.potentials`), and batches of them.

One npz file holds the samples of one plan in sparse form, 5 KB each.
"""

from __future__ import annotations

import io
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import msgspec
import numpy as np
from jaxtyping import Bool, Float32, Int, UInt8
from numpy.typing import NDArray

from sim.core.errors import ConfigError
from sim.core.files import write_atomically
from sim.core.interface import GOAL_CATEGORIES
from sim.core.reading import parse_json, read_npz, reason_of
from sim.homes.plans.plan import house_of
from sim.training.plan_split import is_held_back
from sim.training.poni.potentials import Sample, SampleConfig
from stubborn.exploration.patches import LAYERS

GOALS = len(GOAL_CATEGORIES)
SYMMETRIES = 8
"""Turns by 90 degrees and mirror images of a square."""
HELD_BACK = 8
"""One of this number of houses is held back from training, selected by its name."""
MAX_FILE_BYTES = 256 << 20
_WHAT = "file of samples (`stubborn train poni` writes them)"
_OF_SAMPLES = ("masks", "robot", "seen_goals")
_OF_GOAL_CELLS = ("goal_cell", "goal_bits")
_OF_FRONTIERS = ("cell", "area", "objects", "part", "path_m")
_KINDS = {"robot": "i", "path_m": "f", "goal_start": "i", "start": "i"}
"""Kind of the numbers (`np.dtype.kind`) of the arrays that are not unsigned."""
_WITHOUT_SAMPLES = {"goal_start", "start"}
"""The arrays of a file without samples."""


@dataclass(frozen=True, eq=False)
class Batch:
    """Some samples as a network sees them."""

    channels: UInt8[np.ndarray, "n channels cells cells"]
    """The channels of `MapPatch.channels`."""
    sample: Int[np.ndarray, " m"]
    """Number within the batch that each frontier cell belongs to."""
    cell: Int[np.ndarray, " m"]
    """Row-major cell of the patch."""
    potentials: Float32[np.ndarray, "m maps"]
    """True potentials, the area first, then one for each goal category."""
    counts: Bool[np.ndarray, "m maps"]
    """False: the category was seen already, so that its potential does not matter."""
    part: Int[np.ndarray, " m"]
    """Number of the frontier within its sample."""
    path_m: Float32[np.ndarray, " m"]
    """Length of the path from the robot."""


def held_back(file: Path) -> bool:
    """Returns whether a plan is held back from training, given its file or that of its samples.

    It depends on the name of the house only, so that the storeys of a house stay together.
    """
    return is_held_back(house_of(file.stem.rsplit("-", 1)[-1]), HELD_BACK)


def plan_of(file: Path) -> str | None:
    """Returns the checksum of the plan that a file of samples was made from; None if the file does not have it."""
    arrays = read_npz(file, what=_WHAT, most_bytes=MAX_FILE_BYTES)
    checksum = _header(file, arrays).about.get("plan_sha256")
    return checksum if isinstance(checksum, str) else None


def write_samples(file: Path, samples: Iterable[Sample], config: SampleConfig, about: dict[str, object]) -> None:
    """Writes the samples of a plan, atomically.

    Args:
        file: the npz file.
        samples: of one plan.
        config: that of the samples; a file of another configuration is refused by `SampleSet.read`.
        about: JSON values that are written with it.
    """
    rows: dict[str, list[NDArray]] = {name: [] for name in (*_OF_SAMPLES, *_OF_GOAL_CELLS, *_OF_FRONTIERS)}
    ends = {"goal_start": [0], "start": [0]}
    for sample in samples:
        patch, potentials = sample.patch, sample.potentials
        layers = np.stack([patch.obstacle, patch.seen, patch.trail]).reshape(3, -1)
        goal_cell = np.flatnonzero(patch.goals)
        values = {
            "masks": np.packbits(layers, axis=1)[None],
            "robot": np.array([patch.robot], np.int16),
            "seen_goals": np.array([sample.seen_goals], np.uint32),
            "goal_cell": goal_cell.astype(np.uint16),
            "goal_bits": patch.goals.reshape(-1)[goal_cell],
            "cell": (potentials.rows * config.cells + potentials.cols).astype(np.uint16),
            "area": _as_bytes(potentials.area),
            "objects": _as_bytes(potentials.objects),
            "part": potentials.part.astype(np.uint16),
            "path_m": potentials.path_m.astype(np.float16),
        }
        for name, value in values.items():
            rows[name].append(value)
        ends["goal_start"].append(ends["goal_start"][-1] + goal_cell.size)
        ends["start"].append(ends["start"][-1] + potentials.rows.size)
    arrays: dict[str, object] = {name: np.concatenate(parts) for name, parts in rows.items() if parts}
    arrays |= {name: np.array(values, np.int64) for name, values in ends.items()}
    header = json.dumps({"config": asdict(config), "about": about})
    content = io.BytesIO()
    np.savez_compressed(content, header=np.array(header), **arrays)  # pyright: ignore[reportArgumentType] - arrays only
    write_atomically(file, content.getvalue())


class SampleSet:
    """The samples of some files in memory."""

    def __init__(self, arrays: dict[str, NDArray], cells: int) -> None:
        self._arrays, self.cells = arrays, cells
        order = np.arange(cells * cells).reshape(cells, cells)
        turned = [np.rot90(order, turns) for turns in range(4)]
        sources = [image.reshape(-1) for turn in turned for image in (turn, turn[:, ::-1])]
        self._sources = np.stack(sources)
        """(symmetries, cells) The cell from which each cell of a turned patch comes."""
        self._targets = np.argsort(self._sources, axis=1)

    @classmethod
    def read(cls, files: Sequence[Path], config: SampleConfig | None = None) -> SampleSet:
        """Returns the samples of some files; those without samples are skipped.

        Args:
            files: as `write_samples` writes them.
            config: the configuration that all must have; by default that of the first one.

        Raises:
            ConfigError: a file is broken, is of another configuration, or the files have no samples.
        """
        parts = []
        for file in files:
            stored, part = _read(file)
            if stored != (config := config or stored):
                changed = ", ".join(key for key, value in asdict(config).items() if asdict(stored)[key] != value)
                raise ConfigError(f"'{file}' was made with other options ({changed}); take another --samples folder.")
            parts += [part] if "masks" in part else []
        if not parts or config is None:
            raise ConfigError(f"{len(files)} files have no samples; at least one sample is needed.")
        names = (*_OF_SAMPLES, *_OF_GOAL_CELLS, *_OF_FRONTIERS)
        arrays = {name: np.concatenate([part[name] for part in parts]) for name in names}
        for name in ("goal_start", "start"):
            lengths = np.concatenate([np.diff(part[name]) for part in parts])
            arrays[name] = np.concatenate(([0], np.cumsum(lengths)))
        return cls(arrays, config.cells)

    def __len__(self) -> int:
        return len(self._arrays["seen_goals"])

    def batch(self, numbers: Sequence[int], symmetries: Sequence[int] | None = None) -> Batch:
        """Returns some samples.

        Args:
            numbers: of the samples.
            symmetries: the turn or mirror image of each, 0 to 7; by default none is turned.
        """
        a, cells = self._arrays, self.cells
        channels = np.zeros((len(numbers), len(LAYERS) + GOALS, cells * cells), np.uint8)
        frontiers, samples, places = [], [], []
        for i, number in enumerate(numbers):
            source, target = (
                table[0 if symmetries is None else symmetries[i]] for table in (self._sources, self._targets)
            )
            layers = np.unpackbits(a["masks"][number], axis=1, count=cells * cells)
            channels[i, :3] = layers[:, source]
            row, col = a["robot"][number]
            channels[i, 3, target[int(row) * cells + int(col)]] = 1
            goals = slice(a["goal_start"][number], a["goal_start"][number + 1])
            bits = a["goal_bits"][goals] >> np.arange(GOALS, dtype=np.uint32)[:, None] & np.uint32(1)
            channels[i, len(LAYERS) :, target[a["goal_cell"][goals]]] = bits.T
            cut = slice(a["start"][number], a["start"][number + 1])
            frontiers.append(np.arange(cut.start, cut.stop))
            samples.append(np.full(cut.stop - cut.start, i))
            places.append(target[a["cell"][cut]])
        at, sample = np.concatenate(frontiers), np.concatenate(samples)
        seen = a["seen_goals"][np.asarray(numbers)][sample]
        counts = np.ones((at.size, 1 + GOALS), np.bool_)
        counts[:, 1:] = seen[:, None] >> np.arange(GOALS, dtype=np.uint32) & np.uint32(1) == 0
        potentials = np.concatenate((a["area"][at, None], a["objects"][at]), axis=1).astype(np.float32) / 255.0
        return Batch(
            channels.reshape(len(numbers), -1, cells, cells),
            sample,
            np.concatenate(places),
            potentials,
            counts,
            a["part"][at].astype(np.int64),
            a["path_m"][at].astype(np.float32),
        )


class _Header(msgspec.Struct):
    """The JSON in `header`."""

    config: SampleConfig
    about: dict[str, object] = {}


def _read(file: Path) -> tuple[SampleConfig, dict[str, NDArray]]:
    """Returns the configuration and the arrays of a file; without samples it has no `masks`."""
    arrays = read_npz(file, what=_WHAT, most_bytes=MAX_FILE_BYTES)
    config = _header(file, arrays).config
    try:
        if set(arrays) - _WITHOUT_SAMPLES:
            _check(arrays, config.cells)
    except ValueError as error:
        raise ConfigError(f"'{file}' is not a {_WHAT}: {reason_of(error)}.") from None
    return config, arrays


def _header(file: Path, arrays: dict[str, NDArray]) -> _Header:
    """Takes the header out of the arrays of a file."""
    try:
        if "header" not in arrays:
            raise ValueError("it has no 'header'")
        return parse_json(str(arrays.pop("header")), _Header, where="its header")
    except ValueError as error:
        raise ConfigError(f"'{file}' is not a {_WHAT}: {reason_of(error)}.") from None


def _check(arrays: Mapping[str, NDArray], cells: int) -> None:
    """Raises ValueError if an array is missing, has another shape than the others need, or holds a wrong index.

    Args:
        arrays: of a file with samples.
        cells: edge of the patch.
    """
    samples, goal_cells, frontiers = (_size(arrays, name) for name in ("seen_goals", "goal_cell", "cell"))
    if cells < 1 or samples < 1:
        raise ValueError(f"it has {samples} samples of {cells} x {cells} cells")
    shapes = {
        "masks": (samples, 3, -(-cells * cells // 8)),
        "robot": (samples, 2),
        "seen_goals": (samples,),
        "goal_start": (samples + 1,),
        "start": (samples + 1,),
        **dict.fromkeys(_OF_GOAL_CELLS, (goal_cells,)),
        **dict.fromkeys(_OF_FRONTIERS, (frontiers,)),
        "objects": (frontiers, GOALS),
    }
    for name, shape in shapes.items():
        _size(arrays, name)
        kind, array = _KINDS.get(name, "u"), arrays[name]
        if array.dtype.kind != kind or array.shape != shape:
            raise ValueError(f"'{name}' is {array.dtype} {array.shape} for {samples} samples")
    for name, end in (("goal_start", goal_cells), ("start", frontiers)):
        if arrays[name][0] != 0 or arrays[name][-1] != end or bool((np.diff(arrays[name]) < 0).any()):
            raise ValueError(f"'{name}' does not count the cells of the samples")
    for name, end in (("robot", cells), ("goal_cell", cells**2), ("cell", cells**2)):
        if bool((arrays[name] < 0).any() or (arrays[name] >= end).any()):
            raise ValueError(f"'{name}' holds an index out of range")


def _size(arrays: Mapping[str, NDArray], name: str) -> int:
    """Returns the number of entries of an array; raises ValueError if the array is missing."""
    if name not in arrays:
        raise ValueError(f"it has no '{name}'")
    return arrays[name].size


def _as_bytes(share: Float32[np.ndarray, ...]) -> NDArray[np.uint8]:
    """Returns numbers in [0, 1] in units of 1/255."""
    return np.rint(np.clip(share, 0.0, 1.0) * 255.0).astype(np.uint8)
