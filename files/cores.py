"""The processors of the machine."""

import os


def usable_cores() -> int:
    """Those that this process may use, where the system says it, else all."""
    affinity = getattr(os, "sched_getaffinity", None)
    return len(affinity(0)) if affinity is not None else os.cpu_count() or 1
