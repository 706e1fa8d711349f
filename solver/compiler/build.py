"""Machine code of all compiled functions in seconds, by numba's internals.

numba types and lowers each function, and no more, with records and arrays of `numba_types`; all
functions then become one module, which LLVM optimizes and emits once. If anything of numba used
here or there has changed, `object_file` takes the stock compiler instead.

Used of numba (tried with 0.60, 0.61, 0.63 and 0.68): the typing and target contexts of the CPU,
type models, attribute and operator templates, `CPUDispatcher`, the default pipeline and
`JITCodeLibrary`.
"""

import gc
import inspect
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Set
from contextlib import contextmanager
from functools import cache
from typing import Any

from llvmlite import binding as llvm
from llvmlite import ir
from numba import types
from numba.core import cgutils, sigutils
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.registry import CPUDispatcher, cpu_target
from numba.core.typed_passes import InlineOverloads, NopythonRewrites
from numba.core.untyped_passes import InlineClosureLikes, InlineInlinables

from . import dual
from .calls import call_intrinsic
from .dual import DOUBLE, Dual
from .emission import emitted
from .foreign import call_by_address
from .marks import (
    COMPILED_ENTRIES,
    COMPILED_FUNCTIONS,
    DIFFERENTIABLE_ENTRIES,
    OBJECT_MARK,
    SURFACE_FUNCTIONS,
    Entry,
)
from .memory import copy
from .numba_types import WORD, address_and_length, copy_view, numba_type, packed_view
from .struct import ArrayField
from .targets import COMPILED_TARGETS, CodeTarget
from .typed import keep_module, kept_module

NUMBA_OPTIONS = {
    "nopython": True,
    "error_model": "numpy",
    "fastmath": {"reassoc", "contract"},
    "boundscheck": False,
    "_nrt": False,
}
"""sums may be reordered, for vector instructions; nothing else is relaxed"""
NEEDLESS_PASSES = frozenset(
    {InlineClosureLikes, InlineInlinables, InlineOverloads, NopythonRewrites}
)
"""passes over what compiled functions have not: closures, inlined functions, array expressions"""
KNOWN_FUNCTIONS = frozenset(
    {"atan2", "cos", "exp", "log", "pow", "sin", "sincos", "sqrt", "memcpy", "memset"}
)
"""functions of the C library that compiled code may call"""

BYTE_POINTER = ir.IntType(8).as_pointer()


def main() -> None:
    """Write the object files of the targets that the arguments name to standard output.

    Each after `OBJECT_MARK`. What numba or others print goes to standard error.
    """
    from .. import step as step  # all compiled functions are registered now

    with os.fdopen(os.dup(1), "wb") as output:
        os.dup2(2, 1)
        for code in build([COMPILED_TARGETS[name] for name in sys.argv[1:]], kept=True):
            output.write(OBJECT_MARK + code)


def build(targets: Iterable[CodeTarget], kept: bool = False) -> list[bytes]:
    """An object file of all entries for each target; any exception where numba is not as expected.

    kept: typed modules may be those of earlier builds, and are left for later ones. One serves all
    targets that have as many derivatives, and contacts of surfaces or none.
    """
    typed = cache(_kept_or_typed if kept else _typed)
    with _fewer_collections():
        return [emitted(typed(target.derivatives, target.surfaces), target) for target in targets]


def _kept_or_typed(k: int, surfaces: bool) -> bytes:
    if (module := kept_module(k, surfaces)) is None:
        module = _typed(k, surfaces)
        keep_module(k, surfaces, module)
    return module


def _typed(k: int, surfaces: bool) -> bytes:
    """All entries, of numbers with k derivatives, and what they call, as LLVM's bitcode."""
    libraries: list[Any] = []
    dispatchers = _dispatchers(libraries, k, SURFACE_FUNCTIONS if k and not surfaces else set())
    module = _linked(_entry_module(dispatchers, k), libraries)
    return bytes(module.as_bitcode())


@contextmanager
def _fewer_collections() -> Iterator[None]:
    """Typing makes millions of objects that live to the end: to look through them takes as long."""
    threshold = gc.get_threshold()
    # Objects that are there already are not looked at again.
    gc.freeze()
    gc.set_threshold(100_000, 20, 100)
    try:
        yield
    finally:
        gc.set_threshold(*threshold)
        gc.unfreeze()


def _dispatchers(
    libraries: list[Any], k: int, skipped: Set[Callable[..., Any]]
) -> dict[Callable[..., Any], "_Inner"]:
    """A dispatcher for every compiled function, by which the others and entries know it.

    skipped: those that do nothing.
    """
    # Before the contexts look for what is registered.
    intrinsics = QUICK_INTRINSICS | (_intrinsics_of_derivatives() if k else {})
    typing, target = cpu_target.typing_context, cpu_target.target_context
    typing.refresh()
    target.refresh()
    pipeline = type("Pipeline", (_Pipeline,), {"libraries": libraries})
    dispatchers = {}
    for function in COMPILED_FUNCTIONS:
        if function in intrinsics:
            _make_known(typing, function, typing.resolve_value_type(intrinsics[function]))
            continue
        compiled = _doing_nothing(function) if function in skipped else function
        dispatchers[function] = _Inner(compiled, {}, dict(NUMBA_OPTIONS), pipeline_class=pipeline)
        # By its dispatcher a function is known to the others before it is compiled itself.
        _make_known(typing, function, types.Dispatcher(dispatchers[function]))
    for entry in COMPILED_ENTRIES.values():
        _make_known(typing, entry, types.Dispatcher(dispatchers[entry.function]))
    return dispatchers


def _make_known(typing: Any, function: Any, kind: Any) -> None:
    """Let compiled code know a function, in place of what an earlier build of this process made."""
    if typing._lookup_global(function) is not None:
        typing._remove_global(function)
    typing.insert_global(function, kind)


def _doing_nothing(function: Callable[..., Any]) -> Callable[..., Any]:
    """A function of the same arguments that returns nothing, or False."""
    arguments = inspect.signature(function)
    names: dict[str, Any] = {}
    returned = None if arguments.return_annotation is None else False
    exec(f"def nothing({', '.join(arguments.parameters)}):\n    return {returned}", names)
    return names["nothing"]  # type: ignore[no-any-return]


def _entry_module(dispatchers: dict[Callable[..., Any], "_Inner"], k: int) -> Any:
    """Compile all entries, and with them what they call; a module of functions of words."""
    target = cpu_target.target_context
    module = ir.Module("entries")
    module.triple = llvm.get_process_triple()
    module.data_layout = target.codegen()._data_layout
    for entry in (DIFFERENTIABLE_ENTRIES if k else COMPILED_ENTRIES).values():
        dispatcher = dispatchers[entry.function]
        arguments = tuple(numba_type(kind, k) for kind in entry.arguments.values())
        dispatcher.compile(arguments)
        _write_entry(target, module, entry, dispatcher.overloads[arguments])
    return module


def _linked(module: Any, libraries: list[Any]) -> Any:
    """One module out of all; nothing but the entries can be seen from outside."""
    final = llvm.parse_assembly(cgutils.normalize_ir_text(str(module)))
    final.name = "duhamel"
    for library in _with_linked(libraries):
        # preserve: numba still reads these modules while others are linked.
        final.link_in(library._get_module_for_linking(), preserve=True)
    for function in final.functions:
        if not function.is_declaration and function.name not in COMPILED_ENTRIES:
            # What nothing outside can call may be inlined, merged and removed.
            function.linkage = "internal"
    for variable in final.global_variables:
        if not variable.is_declaration:
            variable.linkage = "internal"
        if variable.name.startswith("numba.dynamic.globals"):
            # An address of this process has no meaning in the next.
            raise NotImplementedError("a compiled function reads a large array by its address")
    # The object file is loaded without a linker: what is not known here would crash at its first
    # call.
    missing = {f.name for f in final.functions if f.is_declaration} - KNOWN_FUNCTIONS
    if strange := [name for name in missing if not name.startswith("llvm.")]:
        raise LookupError(f"undefined functions: {sorted(strange)}")
    return final


def _with_linked(libraries: list[Any]) -> list[Any]:
    """Those of the compiled functions, and those of numba's own that they use, such as max."""
    waiting, found = list(libraries), {}
    while waiting:
        library = waiting.pop(0)
        if id(library) not in found:
            found[id(library)] = library
            waiting += library._linking_libraries
    return list(found.values())


class _Library(JITCodeLibrary):  # type: ignore[misc]
    """Keeps the module of a function, with the cheap passes done: it is emitted with all others."""

    def add_ir_module(self, ir_module: Any) -> None:
        module = llvm.parse_assembly(cgutils.normalize_ir_text(str(ir_module)))
        module.name = ir_module.name
        self._optimize_functions(module)
        self._final_module.link_in(module)

    def finalize(self) -> None:
        self._finalized = True

    def _get_module_for_linking(self) -> Any:
        return self._final_module


class _Pipeline(CompilerBase):  # type: ignore[misc]
    """numba's own passes as far as LLVM code; nothing for callers from Python or C."""

    libraries: list[Any]

    def define_pipelines(self) -> list[Any]:
        flags = self.state.flags
        # Wrappers for Python and C take most of numba's time, and only entries are called from
        # outside.
        flags.no_compile = flags.no_cpython_wrapper = flags.no_cfunc_wrapper = True
        name = self.state.func_id.func_qualname
        self.state.library = _Library(self.state.targetctx.codegen(), name)
        self.libraries.append(self.state.library)
        manager = DefaultPassBuilder.define_nopython_pipeline(self.state)
        manager.passes = [each for each in manager.passes if each[0] not in NEEDLESS_PASSES]
        manager.finalize()
        return [manager]


class _Inner(CPUDispatcher):  # type: ignore[misc]
    """A function that others call: known to them by its symbol, not by an address."""

    def add_overload(self, result: Any) -> None:
        arguments = tuple(result.signature.args)
        self.overloads[arguments] = result
        key = self.py_func, arguments
        result.target_context.insert_user_function(key, result.fndesc, [result.library])

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """Integers in the source are numbers like others, not a type each."""
        return super().get_call_template(tuple(map(types.unliteral, args)), kws)

    def get_overload(self, sig: Any) -> Any:
        arguments, _ = sigutils.normalize_signature(sig)
        return self.py_func, tuple(arguments)


QUICK_INTRINSICS = {copy: copy_view, call_by_address: call_intrinsic(address_and_length)}
"""what stands for functions that are not compiled as they are written"""


def _intrinsics_of_derivatives() -> dict[Callable[..., Any], Any]:
    """What does beside these where numbers have derivatives."""
    # Without them numba need not look at dual numbers in each operation.
    from .dual_arithmetic import DUAL_INTRINSICS
    from .dual_calls import call_with_derivatives

    return {call_by_address: call_with_derivatives, **DUAL_INTRINSICS}


def _write_entry(context: Any, module: Any, entry: Entry, result: Any) -> None:
    """void symbol(double *results, words...), which calls a compiled function."""
    words: list[Any] = []
    for kind in entry.arguments.values():
        is_array = isinstance(kind, ArrayField)
        words += [WORD] * kind.n_words if is_array else [DOUBLE if kind is float else WORD]
    function_type = ir.FunctionType(ir.VoidType(), [DOUBLE.as_pointer(), *words])
    function = ir.Function(module, function_type, entry.symbol)
    builder = ir.IRBuilder(function.append_basic_block("entry"))
    given, arguments = iter(function.args[1:]), []
    for kind, type_ in zip(entry.arguments.values(), result.signature.args, strict=True):
        if kind in (float, int, bool):
            arguments.append(next(given))
        elif isinstance(kind, ArrayField):
            pointer = context.get_value_type(types.CPointer(type_.dtype))
            data = builder.inttoptr(next(given), pointer)
            shape = [WORD(dim) if isinstance(dim, int) else next(given) for dim in kind.dims]
            arguments.append(packed_view(context, builder, type_, data, shape))
        else:
            arguments.append(builder.inttoptr(next(given), BYTE_POINTER))
    callee = context.declare_function(module, result.fndesc)
    returned = result.signature.return_type
    _, out = context.call_conv.call_function(
        builder, callee, returned, result.signature.args, arguments
    )
    parts = [(out, returned)]
    if isinstance(returned, types.BaseTuple):
        parts = [(builder.extract_value(out, i), kind) for i, kind in enumerate(returned)]
    for i, (value, kind) in enumerate(parts):
        if kind != types.none:
            if isinstance(kind, Dual):
                number, _ = dual.split(builder, value)
            else:
                number = context.cast(builder, value, kind, types.float64)
            builder.store(number, builder.gep(function.args[0], [WORD(i)]))
    builder.ret_void()
