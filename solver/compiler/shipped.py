"""The object files that wheels have, so that a first run compiles nothing."""

from functools import cache
from pathlib import Path

from .digests import checked_code, key
from .targets import COMPILED_TARGETS, HOST_TARGET, own_platform

SHIPPED_FOLDER = Path(__file__).with_name("shipped_steps")
"""made by tools/make_shipped_steps.py; empty in a checkout"""
FEATURES_OF_V3 = ("avx2", "bmi", "bmi2", "f16c", "fma", "lzcnt", "movbe")


def shipped_name(target: str) -> str:
    """The file of a target in wheels."""
    return f"step-{target.removeprefix('shipped-')}.o"


@cache
def shipped_code(wanted: str = HOST_TARGET) -> bytes | None:
    """The object file that the wheel has for this machine; None where it has none that fits.

    It fits where it was made of these sources, for this system, and the processor has what it uses.
    """
    target = f"shipped-{own_platform()}{'' if wanted == HOST_TARGET else f'-{wanted}'}"
    try:
        content = SHIPPED_FOLDER.joinpath(shipped_name(target)).read_bytes()
    except OSError:
        return None
    # The key of its sources stands before it: a checkout may have changed them since.
    own, _, rest = content.partition(b"\n")
    if target not in COMPILED_TARGETS or own != key(target).encode() or not _has_features(target):
        return None
    return checked_code(rest)


def _has_features(target: str) -> bool:
    if COMPILED_TARGETS[target].cpu != "x86-64-v3":
        return True
    import llvmlite.binding as llvm

    has = llvm.get_host_cpu_features()
    return all(has.get(feature, False) for feature in FEATURES_OF_V3)
