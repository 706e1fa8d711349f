"""The number of threads for numerical libraries."""

import os


def threads() -> int:
    """The processors that this process may run on, or OMP_NUM_THREADS if that is fewer."""
    affinity = getattr(os, "sched_getaffinity", None)
    processors = len(affinity(0)) if affinity is not None else os.cpu_count() or 1
    # A list sets the threads of nested regions, outermost first.
    asked = os.environ.get("OMP_NUM_THREADS", "").split(",")[0].strip()
    return min(processors, int(asked)) if asked.isdecimal() and int(asked) > 0 else processors
