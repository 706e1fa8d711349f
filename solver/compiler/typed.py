"""Modules of typed functions, kept beside object files: typing is most of a build, for any target.

They are LLVM's bitcode, before it is optimized for a processor.
"""

from contextlib import suppress

from .cache import kept_content, opened_cache
from .digests import key, with_digest
from .targets import HOST_TARGET, target_with_derivatives

MAX_TYPED_MODULES = 4
"""modules that stay in the cache, the newest ones, 1.3 to 2.1 MB each"""


def kept_module(k: int, surfaces: bool) -> bytes | None:
    """The module of numbers with k derivatives that an earlier build has left; None without one."""
    return kept_content(_name(k, surfaces))


def keep_module(k: int, surfaces: bool, module: bytes) -> None:
    """Leave a module for later builds, where that can be."""
    with suppress(OSError), opened_cache(make=True) as folder:
        folder.write(_name(k, surfaces), with_digest(module))
        folder.remove_oldest("typed-*.bc", MAX_TYPED_MODULES)


def _name(k: int, surfaces: bool) -> str:
    """By all that the code of this process depends on: functions are typed by its numba."""
    return f"typed-{key(target_with_derivatives(k, surfaces) if k else HOST_TARGET)}.bc"
