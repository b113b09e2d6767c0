"""Where the shipped network lies. Free of PyTorch, so that asking for the place costs nothing."""

from __future__ import annotations

from pathlib import Path

SHIPPED_REDNET = Path(__file__).parent / "weights" / "rednet.safetensors"
"""The compact RedNet trained on this repository's views; the model card lies beside it."""
