"""Freed memory stays with the process, for the next array.

By default glibc hands freed memory back to the system as soon as a few arrays of 100 KiB are gone, and gets
it again page by page in the next step: up to a sixth of the time of a long run. How much it keeps follows the
largest block that it has seen freed (M_MMAP_THRESHOLD in mallopt(3)). Without effect in other C libraries.
"""

from __future__ import annotations

LARGE = 2**25 - 2**16
"""Bytes; glibc ignores freed blocks beyond 32 MiB."""


def keep_freed() -> None:
    """Show the allocator a large block that is freed; its pages are never touched."""
    block = bytes(LARGE)
    del block
