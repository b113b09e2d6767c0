"""The options of `stubborn train semexp`."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from sim.core.option_types import Count, NotNegative, OutFolder, Positive, Seed, Share


@dataclass(frozen=True, kw_only=True)
class Args:
    """Train the global policy of the explorer semexp in house plans."""

    plans: tuple[Path, ...]
    """Folders of plans (`stubborn houses plans`)."""
    minutes: Positive = 90.0
    """Time of the training; that of earlier runs of the same folder counts."""
    goals: Count = 10_000_000
    """Largest number of long-term goals of the training, all environments together."""
    seed: Seed = 0
    """Seed of the network, of its exploration and of the episodes."""
    out: OutFolder = Path("runs/semexp")
    """Folder of the run; an existing run is continued."""
    envs: Count = 8
    """Number of environments, all in this process."""
    rollout: Count = 30
    """Long-term goals of each environment between two updates."""
    batch: Count = 60
    """Long-term goals in a minibatch."""
    epochs: Count = 2
    """Passes over the goals of an update; the published number is 4. A pass costs more time than new goals do."""
    rate: Positive = 4e-4
    """Learning rate of Adam at the start; it falls to a tenth. The published one is 2.5e-5."""
    discount: Share = 0.99
    """Discount from one long-term goal to the next."""
    entropy: NotNegative = 0.001
    """Weight of the entropy of the policy in the loss."""
    print_s: NotNegative = 20.0
    """Shortest time between two printed lines."""
    save_s: NotNegative = 120.0
    """Shortest time between two writes of the state."""
