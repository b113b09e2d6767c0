"""The path of the shipped network, in a module without PyTorch."""

from __future__ import annotations

from pathlib import Path

SHIPPED_REDNET = Path(__file__).parent / "weights" / "rednet.safetensors"
"""The compact RedNet with depth and geometry, trained on generated houses; its model card is in the same folder."""
