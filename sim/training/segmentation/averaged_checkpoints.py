"""The weights of the last evaluations of a training, as files, and the network with their mean."""

from __future__ import annotations

from pathlib import Path

from stubborn.segmentation.checkpoints import load_network, mean_of, save_network
from stubborn.segmentation.networks import Network

PREFIX = "step-"


class AveragedCheckpoints:
    """Keeps the networks of the last evaluations in the folder of a run, `step-0001000.safetensors` and so on.

    Args:
        folder: folder of the run.
        most: number of networks that are kept.
        share: only networks of this last share of the steps are averaged: earlier ones had a higher learning rate.
    """

    def __init__(self, folder: Path, most: int, share: float = 1.0) -> None:
        self._folder, self._most, self._share = folder, most, share

    def add(self, network: Network, step: int) -> Network:
        """Stores the network of a step and returns a new one with the mean weights of the last networks."""
        save_network(self._folder / f"{PREFIX}{step:07d}.safetensors", network)
        files = self._files()
        for file in files[: -self._most]:
            file.unlink()
        late = [file for file in files[-self._most :] if _step(file) >= (1.0 - self._share) * step]
        return mean_of([load_network(file)[0] for file in late])

    def cut(self, step: int) -> None:
        """Removes the networks of later steps, which a killed process stored after its last state."""
        for file in self._files():
            if _step(file) > step:
                file.unlink()

    def _files(self) -> list[Path]:
        """Returns the files, that of the earliest step first."""
        return sorted(self._folder.glob(f"{PREFIX}*.safetensors"))


def _step(file: Path) -> int:
    return int(file.stem.removeprefix(PREFIX))
