"""Memory of the machine: what a run may take at most."""

from __future__ import annotations

import os


def installed_memory() -> int | None:
    """Bytes that are installed; ``None`` where the system does not say."""
    if not hasattr(os, "sysconf") or "SC_PHYS_PAGES" not in os.sysconf_names:
        return None
    return os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
