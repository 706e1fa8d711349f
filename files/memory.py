"""Memory that this process may still take."""

import os
import shutil
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

FILE_SYSTEM_ROOT = Path("/")


def gigabytes(size: float) -> str:
    """Bytes as text, in GB with three digits."""
    return f"{size / 1e9:.3g} GB"


def shortage(size: float) -> str:
    """The text of an error where so many bytes are more than there are; "" where they are not."""
    free = available()
    if size <= free:
        return ""
    return f"needs {gigabytes(size)} of memory, {gigabytes(free)} are available"


def available(root: Path = FILE_SYSTEM_ROOT) -> int:
    """Bytes that this process may still take: of the machine, of the control groups that it runs
    in, and of its limit of address space.

    Where the system does not say what is free, all the memory of the machine; where it does not say
    even that, no limit at all. Source: proc(5), cgroups(7).
    """
    return min(_machine(root), *_control_groups(root), _address_space(root), sys.maxsize)


def peak() -> int:
    """The most memory that this process has had [bytes]; 0 where the system does not say."""
    try:
        from resource import RUSAGE_SELF, getrusage
    except ImportError:
        return 0
    unit = 1 if sys.platform == "darwin" else 1024
    return unit * getrusage(RUSAGE_SELF).ru_maxrss


def scratch() -> int:
    """Bytes that temporary files may still take (TMPDIR)."""
    return shutil.disk_usage(tempfile.gettempdir()).free


def _machine(root: Path) -> int:
    path = root / "proc/meminfo"
    if path.exists():
        values = dict(line.split(":", 1) for line in path.read_text().splitlines() if ":" in line)
        return int(values["MemAvailable"].split()[0]) * 1024
    if "SC_PHYS_PAGES" in getattr(os, "sysconf_names", {}):
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    return sys.maxsize


def _address_space(root: Path) -> int:
    """Bytes left of what `ulimit -v` allows, where there is such a limit."""
    try:
        from resource import RLIM_INFINITY, RLIMIT_AS, getrlimit
    except ImportError:
        return sys.maxsize
    limit, status = getrlimit(RLIMIT_AS)[0], root / "proc/self/statm"
    if limit == RLIM_INFINITY or not status.exists():
        return sys.maxsize
    return max(0, limit - int(status.read_text().split()[0]) * os.sysconf("SC_PAGE_SIZE"))


class _Controller(NamedTuple):
    """A memory controller: its folder, and its files of the limit, the use, and the cached part."""

    top: str
    limit: str
    used: str
    cache: str


CGROUP_V1 = _Controller(
    "sys/fs/cgroup/memory", "memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"
)
CGROUP_V2 = _Controller("sys/fs/cgroup", "memory.max", "memory.current", "inactive_file")


def _control_groups(root: Path) -> Iterator[int]:
    """Bytes left in each control group of the process, and in the groups that contain it."""
    path = root / "proc/self/cgroup"
    for line in path.read_text().splitlines() if path.exists() else ():
        _, controllers, group = line.split(":", 2)
        if not controllers:
            controller = CGROUP_V2
        elif "memory" in controllers.split(","):
            controller = CGROUP_V1
        else:
            continue
        top = root / controller.top
        inside = top / group.lstrip("/")
        for folder in (inside, *inside.parents):
            if folder.is_relative_to(top):
                yield from _left(folder, controller)


def _left(folder: Path, controller: _Controller) -> Iterator[int]:
    """Bytes left in one group, if it has a limit."""
    limit, used = folder / controller.limit, folder / controller.used
    if not (limit.exists() and used.exists()):
        return
    most = limit.read_text().strip()
    if most != "max":
        # Files that are cached but not in use give way to whoever asks for memory.
        cached = _entry(folder / "memory.stat", controller.cache)
        yield int(most) - int(used.read_text()) + cached


def _entry(path: Path, key: str) -> int:
    entries = dict(line.split() for line in path.read_text().splitlines())
    return int(entries.get(key, 0))
