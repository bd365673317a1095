"""Memory of a process: what it took at most, and what it keeps when it frees.

By default glibc hands freed memory back to the system as soon as a few arrays of 100 KiB are gone, and gets
it again page by page in the next step: up to a sixth of the time of a long run. How much it keeps follows the
largest block that it has seen freed (M_MMAP_THRESHOLD in mallopt(3)). Without effect in other C libraries.
"""

from __future__ import annotations

import re
from pathlib import Path

STATUS = Path("/proc/self/status")
LARGE = 2**25 - 2**16
"""Bytes; glibc ignores freed blocks beyond 32 MiB."""


def keep_freed() -> None:
    """Show the allocator a large block that is freed; its pages are never touched."""
    block = bytes(LARGE)
    del block


def peak_memory() -> int | None:
    """Most bytes that this process has held in memory at a time; ``None`` where the system does not say.

    Not from ``getrusage``: on Linux a process begins there with what its parent held.
    """
    try:
        found = re.search(r"^VmHWM:\s+(\d+) kB$", STATUS.read_text(encoding="ascii"), re.MULTILINE)
    except OSError:
        return None
    return None if found is None else 1024 * int(found[1])
