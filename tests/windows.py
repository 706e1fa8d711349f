"""What differs on Windows, on this machine: functions that are missing, open files that stay.

Windows has no `fcntl` and `resource`, and no functions by which a file is read at a place. It opens
no folders, writes out no file that is open for reading alone, and neither removes nor replaces a
file that is open. It ends lines of files that are opened without O_BINARY by two bytes, which
cannot be shown here.
"""

import os
import shutil
import stat
import sys
from pathlib import Path
from typing import Any

import pytest

MISSING = (
    *("fork", "forkpty", "pread", "preadv", "pwrite", "pwritev", "sched_getaffinity", "geteuid"),
    *("getuid", "sysconf_names", "sysconf", "O_DIRECTORY", "O_NOFOLLOW", "O_NONBLOCK", "killpg"),
)


def behave_like_windows(monkeypatch: pytest.MonkeyPatch) -> None:
    """Take away from `os` what Windows does not have, and refuse what it refuses."""
    for module in ("fcntl", "resource", "pwd", "grp", "termios"):
        monkeypatch.setitem(sys.modules, module, None)
    for name in MISSING:
        monkeypatch.delattr(os, name, raising=False)
    monkeypatch.setattr("duhamel.files.outputs.IS_WINDOWS", True)
    monkeypatch.setattr("duhamel.files.outputs._is_running", lambda process: process == os.getpid())
    monkeypatch.setattr("duhamel.solver.compiler.cache.BY_FOLDER", False)
    monkeypatch.setattr(shutil, "_use_fd_functions", False)
    functions = {name: getattr(os, name) for name in ("open", "kill", "fsync")}

    def opened(path: Any, flags: int, mode: int = 0o777, *, dir_fd: int | None = None) -> int:
        if dir_fd is not None:
            raise NotImplementedError("dir_fd unavailable on this platform")
        if Path(path).is_dir():
            raise PermissionError(13, "Permission denied", str(path))
        return int(functions["open"](path, flags, mode))

    def killed(process: int, number: int) -> None:
        if number == 0:
            raise AssertionError("a Ctrl-C for the whole console")
        functions["kill"](process, number)

    def written_out(handle: int) -> None:
        flags = Path(f"/proc/self/fdinfo/{handle}").read_text().split("flags:")[1].split()[0]
        if int(flags, 8) & os.O_ACCMODE == os.O_RDONLY:
            raise OSError(9, "Bad file descriptor")
        functions["fsync"](handle)

    monkeypatch.setattr(os, "open", opened)
    monkeypatch.setattr(os, "kill", killed)
    monkeypatch.setattr(os, "fsync", written_out)
    for name in ("unlink", "remove", "rename", "replace"):
        monkeypatch.setattr(os, name, _unless_open(getattr(os, name)))


def _unless_open(function: Any) -> Any:
    """A function of paths that refuses files that this process has open."""

    def refusing(*paths: Any, **options: Any) -> None:
        opened = set(_open_files())
        for path in paths:
            try:
                status = os.stat(path)
            except (OSError, TypeError):
                continue
            if stat.S_ISREG(status.st_mode) and (status.st_dev, status.st_ino) in opened:
                raise PermissionError(13, "The process cannot access the file", str(path))
        function(*paths, **options)

    return refusing


def _open_files() -> Any:
    for handle in Path("/proc/self/fd").iterdir():
        try:
            status = os.fstat(int(handle.name))
        except OSError:
            continue
        yield status.st_dev, status.st_ino
