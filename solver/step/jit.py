"""The compiler of the time loop: numba, cached on disk, so that a machine compiles once.

With NUMBA_DISABLE_JIT=1 in the environment everything here runs as plain Python, for debugging and
coverage.
"""

import os
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any, TypeVar, cast

import numba

Function = TypeVar("Function", bound=Callable[..., Any])

FOLDER = Path(__file__).parent


def compiled(function: Function) -> Function:
    """Compile on first call, into the caller, without reference counts: what allocates does not
    compile.

    Sums may be reordered (for vector instructions), nothing else is relaxed. Reference counting and
    calls that pass dozens of arrays would take two thirds of the time of a step.
    """
    return _compile(function, forceinline=True)


def compiled_apart(function: Function) -> Function:
    """The same for what is called rarely, and not into the caller: code inside code is optimised
    once more.
    """
    return _compile(function, forceinline=False)


def _compile(function: Function, forceinline: bool) -> Function:
    options: dict[str, Any] = {
        "cache": True,
        "error_model": "numpy",
        "forceinline": forceinline,
        "_nrt": False,
    }
    jitted: Any = numba.njit(function, fastmath={"reassoc", "contract"}, **options)
    return cast(Function, jitted)


def is_cached() -> bool:
    """Whether this machine holds compiled code for the present sources."""
    if os.environ.get("NUMBA_DISABLE_JIT", "0") != "0":
        return True
    return any(_cache_folder().glob("loop.advance-*.nbi"))


def discard_stale_cache() -> None:
    """Delete compiled code older than any source file of the solver.

    numba looks at the file of a function alone, not at those of the functions that it calls.
    """
    newest = max(path.stat().st_mtime for path in FOLDER.glob("*.py"))
    for index in _cache_folder().glob("*.nbi"):
        with suppress(FileNotFoundError):  # another process may be quicker
            if index.stat().st_mtime < newest:
                index.unlink()


def _cache_folder() -> Path:
    return FOLDER / "__pycache__"


discard_stale_cache()
