"""The machine code of the compiled functions: where it is kept, how it is found, made and loaded.

An object file in the user's cache is named by the content of all that it depends on: the sources of
the compiled functions and of the compiler, the versions of Python, numba and llvmlite, and the
processor. So it serves all environments of a user, survives reinstallations, and is never stale.
`DUHAMEL_CACHE` names another folder; `DUHAMEL_COMPILER=stock` compiles by numba's public interface
alone, which is slower; `NUMBA_DISABLE_JIT=1` runs everything as Python.
"""

import ctypes
import hashlib
import os
import subprocess
import sys
import tempfile
import threading
from contextlib import suppress
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Any

from . import marks

KEPT = 8
"""object files that stay in the cache, the newest ones"""
DIGEST = 32
"""bytes at the end of a file: the SHA-256 of all before it"""

_lock = threading.RLock()
_engines: list[Any] = []


def load() -> None:
    """Bind all entries to machine code: what is cached, or what is built now.

    Where numba's internals are not as `build` expects them, the stock compiler takes over.
    """
    with _lock:
        if any(entry.is_bound for entry in marks.ENTRIES.values()):
            return
        if runs_as_python():
            for entry in marks.ENTRIES.values():
                entry.direct = entry.function
            return
        if os.environ.get("DUHAMEL_COMPILER", "") != "stock":
            code = _cached_code() or _built_code()
            if code is not None:
                _bind(code)
                return
        from . import stock

        _announce("compiling the time step by numba's public interface: about three minutes")
        stock.bind(cache_folder() / f"stock-{key()}")


def is_ready() -> bool:
    """True where the next call of an entry compiles nothing."""
    return runs_as_python() or _cached_code() is not None


def runs_as_python() -> bool:
    return os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0")


def cache_folder() -> Path:
    """The folder of the user's compiled code."""
    if given := os.environ.get("DUHAMEL_CACHE"):
        return Path(given)
    import platformdirs

    return Path(platformdirs.user_cache_dir("duhamel", appauthor=False))


@cache
def key() -> str:
    """A digest of all that the machine code depends on (16 hexadecimal digits)."""
    import llvmlite.binding as llvm

    digest = hashlib.sha256()
    modules = {function.__module__ for function in marks.COMPILED}
    sources = {Path(str(sys.modules[module].__file__)) for module in modules}
    for source in sorted({*sources, *Path(__file__).parent.glob("*.py")}):
        digest.update(source.read_bytes())
    kinds = {kind for entry in marks.ENTRIES.values() for kind in entry.kinds}
    records = sorted(kind.description() for kind in kinds if hasattr(kind, "description"))
    features = llvm.get_host_cpu_features().flatten()
    versions = [sys.version_info[:2], metadata.version("numba"), metadata.version("llvmlite")]
    machine = [llvm.get_process_triple(), llvm.get_host_cpu_name(), features]
    digest.update(repr((records, versions, machine)).encode())
    return digest.hexdigest()[:16]


def _path() -> Path:
    return cache_folder() / f"step-{key()}.o"


def _cached_code() -> bytes | None:
    """The object file in the cache; None if there is none, or not a whole one."""
    try:
        content = _path().read_bytes()
    except OSError:
        return None
    code, digest = content[:-DIGEST], content[-DIGEST:]
    return code if hashlib.sha256(code).digest() == digest else None


def _built_code() -> bytes | None:
    """The object file made now and kept; None where numba is not as `build` expects it.

    It is made in a process of its own, which leaves nothing behind, neither of numba's 200 MB nor
    of a failure.
    """
    _announce("compiling the time step, once for this processor: 10 to 20 seconds")
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "step.o"
        program = f"from {__package__}.build import main; main({str(target)!r})"
        paths = os.pathsep.join(filter(None, sys.path))
        process = subprocess.run(
            [sys.executable, "-c", program],
            env={**os.environ, "PYTHONPATH": paths},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
        )
        if process.returncode or not target.exists():
            reason = (process.stderr.strip().splitlines() or ["no reason given"])[-1]
            _announce(f"numba {metadata.version('numba')} is not as expected: {reason}")
            return None
        code = target.read_bytes()
    try:
        _keep(code)
    except OSError as error:
        _announce(f"the compiled code cannot be kept, the next run compiles again: {error}")
    return code


def _keep(code: bytes) -> None:
    """Write the object file, whole or not at all, and remove the oldest ones."""
    path = _path()
    path.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
    handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=path.stem)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(code + hashlib.sha256(code).digest())
        Path(temporary).replace(path)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise
    by_age = sorted(path.parent.glob("step-*.o"), key=lambda other: other.stat().st_mtime)
    for old in by_age[:-KEPT]:
        with suppress(OSError):  # another process may be quicker
            old.unlink()


def _bind(code: bytes) -> None:
    """Load an object file and give every entry its function."""
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    target = llvm.Target.from_triple(llvm.get_process_triple())
    engine = llvm.create_mcjit_compiler(
        llvm.parse_assembly(""), target.create_target_machine(jit=True)
    )
    engine.add_object_file(llvm.ObjectFileRef.from_data(code))
    engine.finalize_object()
    _engines.append(engine)  # the code lives as long as its engine
    for entry in marks.ENTRIES.values():
        address = engine.get_function_address(entry.symbol)
        entry.call = ctypes.CFUNCTYPE(None, *entry.argument_types)(address)


def _announce(message: str) -> None:
    print(f"duhamel: {message}", file=sys.stderr, flush=True)
