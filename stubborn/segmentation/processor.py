"""Whether the processor computes in bf16, in a module without PyTorch."""

from __future__ import annotations

import functools
from pathlib import Path

BF16_FLAGS = frozenset(("avx512_bf16", "amx_bf16"))
"""Flags of Linux for processors with instructions for bf16; on others it is slower than fp32."""
_PROCESSOR = Path("/proc/cpuinfo")


@functools.cache
def computes_bf16() -> bool:
    """Returns whether the processor has instructions for bf16; False if the system does not say so."""
    try:
        lines = _PROCESSOR.read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        return False
    flags = next((line.partition(":")[2] for line in lines if line.startswith("flags")), "")
    return not BF16_FLAGS.isdisjoint(flags.split())
