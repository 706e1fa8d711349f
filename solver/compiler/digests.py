"""Digests of machine code: of all that it depends on, and of files of it.

It depends on the sources of the compiled functions and of the compiler, the layout of records, the
versions of Python, numba and llvmlite, and the processor. Code in wheels was made elsewhere, and
depends on no versions.
"""

import hashlib
import sys
from collections.abc import Iterator
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

from . import marks
from .targets import COMPILED_TARGETS, HOST_TARGET

COMPILER_FILES = (
    *("build", "calls", "dispatch", "emission", "marks", "numba_types", "struct", "targets"),
)
"""the files of this folder that machine code depends on"""
DERIVATIVE_FILES = ("dual", "dual_arithmetic", "dual_calls")
"""those that it depends on beside these where numbers have derivatives"""
OBJECT_DIGEST_BYTES = 32
"""bytes at the end of a file: the SHA-256 of all before it"""


@cache
def key(target: str = HOST_TARGET) -> str:
    """A digest of all that the machine code for a target depends on (16 hexadecimal digits)."""
    kinds = [*marks.COMPILED_FUNCTIONS, *marks.records()]
    sources = {Path(str(sys.modules[kind.__module__].__file__)) for kind in kinds}
    chosen = COMPILED_TARGETS[target]
    names = (*COMPILER_FILES, *(DERIVATIVE_FILES if chosen.derivatives else ()))
    compiler = [Path(__file__).with_name(f"{name}.py") for name in names]
    digest = hashlib.sha256()
    # Sorted, so that the digest does not depend on the order of imports.
    for source in sorted({*sources, *compiler}):
        digest.update(source.read_bytes())
    layouts = sorted(record.description() for record in marks.records())
    digest.update(repr(sorted(map(repr, _constants()))).encode())
    # Code that is shipped was made elsewhere: it is the same whatever is installed here.
    versions = [] if target.startswith("shipped-") else _versions()
    digest.update(repr((layouts, versions, *_machine(target))).encode())
    digest.update(bytes([chosen.derivatives, chosen.surfaces] if chosen.derivatives else []))
    return digest.hexdigest()[:16]


def _versions() -> list[Any]:
    return [sys.version_info[:2], metadata.version("numba"), metadata.version("llvmlite")]


def _machine(target: str) -> tuple[str, str]:
    """The system and the processor of a target."""
    chosen = COMPILED_TARGETS[target]
    if chosen.triple and chosen.cpu:
        return f"{chosen.triple}{' loaded' if chosen.is_loaded else ''}", chosen.cpu
    import llvmlite.binding as llvm

    triple = chosen.triple or llvm.get_process_triple()
    return f"{triple}{' loaded' if chosen.is_loaded else ''}", chosen.cpu or processor()


@cache
def processor() -> str:
    """The name of the processor, and a digest of what it can do."""
    import llvmlite.binding as llvm

    features = llvm.get_host_cpu_features().flatten()
    return f"{llvm.get_host_cpu_name()} {hashlib.sha256(features.encode()).hexdigest()[:8]}"


def _constants() -> Iterator[tuple[str, Any]]:
    """Numbers and arrays that compiled functions read, in whichever module they are written."""
    for function in marks.COMPILED_FUNCTIONS:
        for name in function.__code__.co_names:
            value = function.__globals__.get(name)
            if isinstance(value, (int, float, tuple)):
                yield name, value
            elif isinstance(value, np.ndarray):
                yield name, value.tolist()


def checked_code(content: bytes) -> bytes | None:
    """The object file of a content, which its digest follows; None where they do not fit."""
    code, digest = content[:-OBJECT_DIGEST_BYTES], content[-OBJECT_DIGEST_BYTES:]
    return code if hashlib.sha256(code).digest() == digest else None


def with_digest(code: bytes) -> bytes:
    """An object file as it is kept."""
    return code + hashlib.sha256(code).digest()
