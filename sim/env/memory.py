"""Keeps the memory of a long run small with options of glibc's `malloc`; no effect with other C libraries."""

from __future__ import annotations

import contextlib
import ctypes

_M_TRIM_THRESHOLD, _M_MMAP_THRESHOLD = -1, -3  # malloc.h
_APART_BYTES = 4_000_000
"""Blocks from this size on get pages of their own: layers of maps, activations of a network. With 1 MB the images of
a frame would get them too, and new pages for them cost 8 ms per step."""
_KEPT_BYTES = 16_000_000
"""Amount of freed memory at the end of the heap that is kept for the next blocks."""


def give_large_blocks_pages_of_their_own() -> None:
    """Makes `malloc` return each large block to the system as soon as it is freed.

    By default glibc does so for the first large block only: it then puts blocks of up to 32 MB on the heap, where
    smaller blocks between them prevent the return of freed ones (docs/performance.md has the difference).
    """
    with contextlib.suppress(OSError, AttributeError):  # not glibc
        libc = ctypes.CDLL(None)
        libc.mallopt(_M_MMAP_THRESHOLD, _APART_BYTES)
        libc.mallopt(_M_TRIM_THRESHOLD, _KEPT_BYTES)


def return_freed_memory() -> None:
    """Returns freed memory to the system; glibc would keep tens of megabytes, in ever smaller pieces.

    The memory that it keeps grows with each house, and with a network by about 10 MB with each episode.
    """
    with contextlib.suppress(OSError, AttributeError):
        ctypes.CDLL(None).malloc_trim(0)
