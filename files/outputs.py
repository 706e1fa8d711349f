"""Files that appear whole or not at all, and never in the place of an input."""

import os
import re
import shutil
import tempfile
import zlib
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from platform import node
from typing import Any

# File systems end names at 255 bytes, and a temporary name is longer than that of its file.
MAX_KEPT_NAME = 50

IS_WINDOWS = os.name == "nt"
# Of processes, in the interface of Windows.
PROCESS_QUERY_LIMITED_INFORMATION, STILL_ACTIVE, ERROR_ACCESS_DENIED = 0x1000, 259, 5

AnyPath = str | os.PathLike[str]


def object_and_path(first: Any, second: Any) -> tuple[Any, AnyPath]:
    """What is to be written, and where: the order of earlier versions is understood too."""
    return (second, first) if isinstance(first, str | os.PathLike) else (first, second)


class OverwriteError(ValueError):
    """An output that would replace an input."""


def require_no_input(
    output: Path, inputs: Iterable[Path], role: str = "", what: str = "output"
) -> None:
    """`OverwriteError` if an output is one of the inputs, by another path or a link too.

    role: what the inputs are, "the results file"; what: the output is, "film".
    """
    if found := clash([output], {path: role or f"the input {path}" for path in inputs}):
        raise OverwriteError(f"{found}, which the {what} would replace")


@contextmanager
def renamed_when_whole(
    path: Path, durable: bool = False, failure: type[Exception] | None = None
) -> Iterator[Path]:
    """A temporary file beside `path` that replaces it when the block ends without an error.

    A link stays, and what it leads to is replaced. The file has the permissions of any new file.
    Temporary files of processes that have died meanwhile are removed. durable: see
    `replace_durably`. OSError where it cannot be written, or a `failure` that names it.
    """
    path, temporary = resolved(path), None
    try:
        remove_orphans(path)
        handle, name = tempfile.mkstemp(prefix=temporary_prefix(path), dir=path.parent)
        os.close(handle)
        temporary = Path(name)
        yield temporary
        umask = os.umask(0)
        os.umask(umask)
        temporary.chmod(0o666 & ~umask)
        if durable:
            replace_durably(temporary, path)
        else:
            temporary.replace(path)
    except OSError as error:
        if failure is None:
            raise
        raise failure(f"{path}: cannot be written: {in_words(error)}") from error
    finally:
        if temporary is not None:
            temporary.unlink(missing_ok=True)


def in_words(error: Exception) -> str:
    """Why a file cannot be written, in one line, without the name of its temporary file."""
    said = getattr(error, "strerror", None) or str(error).partition("\n")[0]
    return said or type(error).__name__


def replace_durably(source: Path, target: Path) -> None:
    """Rename a file, so that after a loss of power one or the other stands at the target whole."""
    # Windows writes out no file that is open for reading alone, and opens no folders.
    _write_out(source, os.O_RDWR)
    source.replace(target)
    if not IS_WINDOWS:
        _write_out(source.parent, os.O_RDONLY)


def _write_out(path: Path, flags: int) -> None:
    handle = os.open(path, flags)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def resolved(path: Path) -> Path:
    """Where a path leads to; OSError for links that lead to themselves."""
    try:
        return path.resolve()
    except RuntimeError as error:
        raise OSError(str(error)) from error


def temporary_prefix(path: Path) -> str:
    """What the temporary files and folders of `path` that this process makes begin with."""
    return f"{_prefix(path)}{os.getpid()}."


def remove_orphans(path: Path) -> None:
    """Remove temporary files and folders of `path` whose process has died on this machine."""
    pattern = re.compile(rf"{re.escape(_prefix(path))}(\d+)\.\w+")
    for entry in os.listdir(path.parent):
        match = pattern.fullmatch(entry)
        if match and not _alive(int(match[1])):
            _remove(path.with_name(entry))


def _remove(path: Path) -> None:
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)


def _prefix(path: Path) -> str:
    """What names of temporary files begin with: on a shared disk, by machine."""
    return f".{path.name[:MAX_KEPT_NAME]}.{zlib.crc32(node().encode()):08x}."


def _alive(process: int) -> bool:
    if IS_WINDOWS:  # where signal 0 is Ctrl-C
        return _is_running(process)
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:  # it belongs to somebody else
        return True
    return True


def _is_running(process: int) -> bool:
    """Whether Windows still knows a process that runs, or one of somebody else."""
    import ctypes

    windows: Any = ctypes  # of whose interface other systems know nothing
    kernel = windows.WinDLL("kernel32", use_last_error=True)
    kernel.OpenProcess.restype = ctypes.c_void_p  # by default half of a handle
    handle = ctypes.c_void_p(kernel.OpenProcess(PROCESS_QUERY_LIMITED_INFORMATION, False, process))
    if not handle:
        return bool(windows.get_last_error() == ERROR_ACCESS_DENIED)
    code = ctypes.c_ulong()
    is_known = kernel.GetExitCodeProcess(handle, ctypes.byref(code))
    kernel.CloseHandle(handle)
    return not is_known or code.value == STILL_ACTIVE


def clash(targets: Iterable[AnyPath], inputs: Mapping[AnyPath, str]) -> str:
    """Says which target is an input, as "TARGET is ROLE"; "" if none is.

    inputs: roles by path, as "the model file". The same file by another name, or through a link,
    is found too.
    """
    roles = {_identity(path): role for path, role in inputs.items()}
    for target in targets:
        identity = _identity(target)
        if identity is not None and (role := roles.get(identity)):
            return f"{os.fspath(target)} is {role}"
    return ""


def _identity(path: AnyPath) -> tuple[int, int] | None:
    """Device and number of a file; None where there is none."""
    try:
        status = os.stat(path)
    except (OSError, ValueError):
        return None
    return status.st_dev, status.st_ino
