"""The machine code of the compiled functions: where it is kept, how it is found, made and loaded.

An object file in the user's cache is named by the content of all that it depends on (digests.py):
it serves all environments of a user, survives reinstallations, and is never stale. A file is code
that runs with the rights of the user who loads it: `cache` reads none that somebody else owns or
may write to. Where there is none, that of the wheel is taken (shipped.py), and else one is built.

In the environment, `DUHAMEL_CACHE` names another folder; `DUHAMEL_COMPILER=stock` compiles by
numba's public interface alone, which takes minutes, and `DUHAMEL_COMPILER=quick` never does;
`NUMBA_DISABLE_JIT=1` runs everything as Python.
"""

import os
import re
import subprocess
import sys
import threading
from collections.abc import Iterable, Sequence
from contextlib import suppress
from importlib import metadata
from pathlib import Path
from typing import Any

from . import marks
from .cache import cache_folder, is_private, kept_content, opened_cache
from .digests import key, with_digest
from .shipped import shipped_code
from .targets import COMPILED_TARGETS, HOST_TARGET, CodeTarget
from .typed import kept_module

MAX_OBJECT_FILES = 16
"""object files that stay in the cache, the newest ones"""
KEPT_STOCK = 2
"""folders of the stock compiler that stay, some 20 MB each"""
BUILD_SECONDS = {(False, False): (40, 12), (True, False): (30, 8), (True, True): (50, 13)}
"""to type functions, and to emit them for each target, on a virtual server of 2026; by whether
numbers have derivatives, and contacts surfaces"""

_lock = threading.RLock()
_engines: list[Any] = []
"""of llvmlite; machine code lives as long as its engine"""


def _renew_lock() -> None:
    global _lock
    _lock = threading.RLock()


if hasattr(os, "register_at_fork"):
    # a thread that loads while another forks does not exist in the child, which would wait for it
    os.register_at_fork(after_in_child=_renew_lock)


def load() -> None:
    """Bind all entries to machine code: what is cached, or what is built now.

    Where numba's internals are not as `build` expects them, the stock compiler takes over, also in
    later processes: `build` is not tried again.
    """
    with _lock:
        if all(entry.is_bound for entry in marks.COMPILED_ENTRIES.values()):
            return
        if _is_plain():
            for entry in marks.COMPILED_ENTRIES.values():
                entry.call = entry.function
            return
        compiler = os.environ.get("DUHAMEL_COMPILER", "")
        if compiler != "stock" and (code := _quick_code(required=compiler == "quick")):
            _bind(code)
        else:
            _load_stock()


def compiler() -> str:
    """What makes machine code of the time step: "quick" (`build`), "stock", "none" in plain Python.

    Or "shipped" where the wheel has it. Their results differ by rounding.
    """
    if _is_plain():
        return "none"
    wanted = os.environ.get("DUHAMEL_COMPILER", "")
    if not wanted and _cached_code() is None and shipped_code() is not None:
        return "shipped"
    if wanted != "quick" and (wanted == "stock" or (_cached_code() is None and _stock_is_kept())):
        return "stock"
    return "quick"


def _is_plain() -> bool:
    return os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0")


class BuildError(Exception):
    """`build` fails: numba's internals are not as it expects."""


# The cache


def _name(target: str = HOST_TARGET) -> str:
    return f"step-{key(target)}.o"


def object_files(targets: Sequence[str]) -> dict[str, bytes]:
    """The object files for targets by name; `BuildError` where `build` fails.

    They are kept, or in the wheel, or made now. Those that are missing are made together: most of
    the time is that of the first.
    """
    of_wheel = not os.environ.get("DUHAMEL_COMPILER")
    kept = {
        target: _cached_code(target) or (shipped_code(target) if of_wheel else None)
        for target in targets
    }
    missing = [target for target, code in kept.items() if code is None]
    found = {target: code for target, code in kept.items() if code is not None}
    return found | (_new_codes(missing) if missing else {})


def _cached_code(target: str = HOST_TARGET) -> bytes | None:
    """The object file in the cache; None where there is none to use."""
    return kept_content(_name(target))


def _new_code() -> bytes:
    """The object file for this machine made now; `BuildError` where `build` fails."""
    return _new_codes([HOST_TARGET])[HOST_TARGET]


def _new_codes(targets: Sequence[str]) -> dict[str, bytes]:
    """The object files for targets made now, and kept if that can be.

    Of several processes that start at once one builds, while the others wait.
    """
    codes: dict[str, bytes] = {}
    try:
        with opened_cache(make=True) as folder, folder.locked():
            # Within the lock: of many processes that start at once one compiles, and the others
            # find what it has made.
            kept = {target: _cached_code(target) for target in targets}
            codes = {target: code for target, code in kept.items() if code is not None}
            codes |= _built(target for target in targets if target not in codes)
            for target, code in codes.items():
                if kept[target] is None:
                    folder.write(_name(target), with_digest(code))
            folder.remove_oldest("step-*.o", MAX_OBJECT_FILES)
            folder.remove_oldest("step-*.part", MAX_OBJECT_FILES)
    except OSError as error:
        _announce(f"compiled code cannot be kept (DUHAMEL_CACHE names a folder): {error}")
    return codes | _built(target for target in targets if target not in codes)


def _built(targets: Iterable[str]) -> dict[str, bytes]:
    names = list(targets)
    return dict(zip(names, _built_codes(names), strict=True)) if names else {}


# Building


def _quick_code(required: bool) -> bytes | None:
    """The object file, kept or made now; None where the stock compiler is to take over.

    required: `BuildError` rather than None.
    """
    code = _cached_code() or (None if required else shipped_code())
    if code is not None or (_stock_is_kept() and not required):
        return code
    try:
        return _new_code()
    except BuildError as error:
        if required:
            raise
        _announce(f"the quick compiler does not know this numba: {error}")
        return None


def _built_codes(targets: Sequence[str]) -> list[bytes]:
    """The object files for targets made now, in a process of its own; `BuildError` where it fails.

    The process leaves nothing behind, neither of numba's 200 MB nor of a failure. Where Python is
    embedded in another program there is none to be started, and they are made in this one.
    """
    chosen = [COMPILED_TARGETS[target] for target in targets]
    more = ", with derivatives" if any(target.derivatives for target in chosen) else ""
    _announce(
        f"compiling the time step, about {_expected_seconds(chosen)} seconds{more}; later runs "
        f"find it compiled"
    )
    if not sys.executable or hasattr(sys, "frozen"):
        return _built_here(targets)
    try:
        process = subprocess.run(
            # -P: without it Python imports first what lies in the folder that the user is in
            [sys.executable, "-P", "-c", f"from {__package__}.build import main; main()", *targets],
            env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
            stdin=subprocess.DEVNULL,
            capture_output=True,
        )
    except OSError:
        return _built_here(targets)
    # Libraries may print while they are imported: the code begins after the mark.
    _, *codes = process.stdout.split(marks.OBJECT_MARK)
    if process.returncode or len(codes) != len(targets):
        report = process.stderr.decode(errors="replace")
        if os.environ.get("DUHAMEL_COMPILER") == "quick":
            raise BuildError(report)
        raise BuildError(_reason(report) or f"its process ended with {process.returncode}")
    return codes


def _expected_seconds(targets: Sequence[CodeTarget]) -> int:
    kinds = [(target.derivatives, target.surfaces) for target in targets]
    typing = sum(BUILD_SECONDS[k > 0, s][0] for k, s in set(kinds) if kept_module(k, s) is None)
    return typing + sum(BUILD_SECONDS[k > 0, s][1] for k, s in kinds)


def _built_here(targets: Sequence[str]) -> list[bytes]:
    try:
        from .build import build

        return build([COMPILED_TARGETS[target] for target in targets])
    except Exception as error:
        raise BuildError(f"{type(error).__name__}: {error}") from error


def _reason(report: str) -> str:
    """The exception, with the first line of its message, at the end of a traceback."""
    lines = report.strip().splitlines()
    named = [line for line in lines if re.match(r"[\w.]*(Error|Exception)\b", line)]
    version = metadata.version("numba")
    return f"numba {version}, {named[-1]}" if named else ""


def _bind(code: bytes) -> None:
    """Load an object file and give every entry its function."""
    engine = engine_of(code)
    for entry in marks.COMPILED_ENTRIES.values():
        address = engine.get_function_address(entry.symbol)
        if not address:
            raise LookupError(f"{entry.symbol} was registered after the object file was named")
        entry.bind(address)


def engine_of(code: bytes) -> Any:
    """Load an object file, for as long as Python runs: where its functions stand, by name."""
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    target = llvm.Target.from_triple(llvm.get_process_triple())
    engine = llvm.create_mcjit_compiler(
        # An engine needs a module; the object file is added to it.
        llvm.parse_assembly(""),
        target.create_target_machine(jit=True),
    )
    engine.add_object_file(llvm.ObjectFileRef.from_data(code))
    engine.finalize_object()
    _engines.append(engine)
    return engine


def _load_stock() -> None:
    """Bind all entries to what the stock compiler has kept, or compiles at their first call."""
    from . import stock

    if not _stock_is_kept():
        _announce("numba's public interface compiles now: three to four minutes, kept for later")
    stock.bind(_made_stock_folder())
    with suppress(OSError), opened_cache() as folder:
        folder.remove_oldest("stock-*", KEPT_STOCK)


def _made_stock_folder() -> Path | None:
    """The folder in which numba keeps its code, made where it is not; None where that cannot be."""
    try:
        with opened_cache(make=True) as folder:
            stock_folder = folder.path / _stock_name()
        stock_folder.mkdir(exist_ok=True, mode=0o700)
        return stock_folder if is_private(stock_folder.lstat()) else None
    except OSError:
        return None


def _stock_is_kept() -> bool:
    """True where the stock compiler has been here with these sources and versions."""
    try:
        folder = cache_folder() / _stock_name()
        return is_private(folder.lstat()) and any(folder.rglob("*.nbi"))
    except OSError:
        return False


def _stock_name() -> str:
    return f"stock-{key()}"


def _announce(message: str) -> None:
    print(f"duhamel: {message}", file=sys.stderr, flush=True)
