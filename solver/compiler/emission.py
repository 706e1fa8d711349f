"""Object files of a typed module, by LLVM: on each processor vectors have lengths of their own."""

from typing import Any

from llvmlite import binding as llvm

from .targets import CodeTarget

# At 3 LLVM takes a second more, and a step as long as at 1.
LLVM_OPTIMIZATION = 1


def emitted(bitcode: bytes, target: CodeTarget) -> bytes:
    """The object file of a module, optimized for a target."""
    module, machine = llvm.parse_bitcode(bitcode), _machine(target)
    if not target.is_loaded:
        module.triple = target.triple or llvm.get_process_triple()
        module.data_layout = str(machine.target_data)
        for function in module.functions:
            if not function.is_declaration and function.linkage != llvm.Linkage.internal:
                # Two libraries in one process must not call each other's functions of this name.
                function.visibility = "hidden"
    _optimize(module, machine)
    return bytes(machine.emit_object(module))


def _optimize(module: Any, machine: Any) -> None:
    # straight code is not turned into vector instructions: it makes the step a tenth slower
    if hasattr(llvm, "create_pass_builder"):
        tuning = llvm.create_pipeline_tuning_options(speed_level=LLVM_OPTIMIZATION)
        tuning.loop_vectorization, tuning.slp_vectorization = True, False
        builder = llvm.create_pass_builder(machine, tuning)
        builder.getModulePassManager().run(module, builder)
        return
    older = llvm.create_pass_manager_builder()  # llvmlite 0.43
    older.opt_level = 3  # at 1 nothing is inlined: a step takes half as long again
    older.loop_vectorize, older.slp_vectorize = True, False
    older.inlining_threshold = 225
    manager = llvm.create_module_pass_manager()
    machine.add_analysis_passes(manager)
    older.populate(manager)
    manager.run(module)


def _machine(target: CodeTarget) -> Any:
    """What emits code for a target."""
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    chosen = llvm.Target.from_triple(target.triple or llvm.get_process_triple())
    own = "" if target.cpu else llvm.get_host_cpu_features().flatten()
    linking = {"reloc": "pic", "codemodel": "default"}
    loading = {"reloc": "static", "codemodel": "jitdefault", "jit": True}
    return chosen.create_target_machine(
        cpu=target.cpu or llvm.get_host_cpu_name(),
        features=own,
        opt=LLVM_OPTIMIZATION,
        **(loading if target.is_loaded else linking),
    )
