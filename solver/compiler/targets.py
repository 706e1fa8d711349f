"""Processors and systems that the time step is compiled for."""

import platform
from dataclasses import dataclass, replace


@dataclass(frozen=True)
class CodeTarget:
    """A system by its LLVM triple and a processor by its LLVM name; "": that of this machine.

    is_loaded: without a linker, into this process; all other code is position-independent.
    derivatives: of each number, beside its value; 0: the time step as runs take it; surfaces:
    whether there are contacts of surfaces where numbers have derivatives.
    """

    triple: str = ""
    cpu: str = ""
    is_loaded: bool = False
    derivatives: int = 0
    surfaces: bool = False


def target_with_derivatives(k: int, surfaces: bool) -> str:
    """The name of the target for this process of numbers with k derivatives."""
    return f"derivatives-{k}{'-surfaces' if surfaces else ''}"


LINUX_TRIPLE, WINDOWS_TRIPLE = "x86_64-unknown-linux-gnu", "x86_64-w64-windows-gnu"
HOST_TARGET = "host"
SHIPPED_TARGETS = {
    "shipped-x86_64-linux": CodeTarget(LINUX_TRIPLE, "x86-64-v3", is_loaded=True),
    "shipped-aarch64-linux": CodeTarget("aarch64-unknown-linux-gnu", "cortex-a72", is_loaded=True),
    "shipped-x86_64-windows": CodeTarget("x86_64-pc-windows-msvc", "x86-64-v3", is_loaded=True),
    "shipped-aarch64-darwin": CodeTarget("arm64-apple-macosx11.0.0", "apple-m1", is_loaded=True),
}
"""those whose code is in wheels, by SYSTEM and processor"""
DERIVATIVE_COUNTS = (1, 4, 8, 16)
"""derivatives that a number may have: one, or vectors as processors have them"""
SHIPPED_WITH_DERIVATIVES = {
    f"{name}-derivatives-{k}": replace(target, derivatives=k)
    for name, target in SHIPPED_TARGETS.items()
    for k in DERIVATIVE_COUNTS[:3]
}
"""those that wheels of releases have beside these"""
COMPILED_TARGETS = {
    HOST_TARGET: CodeTarget(is_loaded=True),
    **{
        target_with_derivatives(k, surfaces): CodeTarget("", "", True, k, surfaces)
        for k in DERIVATIVE_COUNTS
        for surfaces in (False, True)
    },
    "native": CodeTarget(),
    "x86_64-linux": CodeTarget(LINUX_TRIPLE, "x86-64-v3"),
    "x86_64-linux-v2": CodeTarget(LINUX_TRIPLE, "x86-64-v2"),
    "aarch64-linux": CodeTarget("aarch64-unknown-linux-gnu", "cortex-a72"),
    "x86_64-windows": CodeTarget(WINDOWS_TRIPLE, "x86-64-v3"),
    "x86_64-windows-v2": CodeTarget(WINDOWS_TRIPLE, "x86-64-v2"),
    "aarch64-darwin": CodeTarget("arm64-apple-macosx11.0.0", "apple-m1"),
    **SHIPPED_TARGETS,
    **SHIPPED_WITH_DERIVATIVES,
}
"""by their platforms in FMI 3.0; v2: for x86-64 processors without AVX2 and FMA"""


def own_platform() -> str:
    """This machine, as FMI 3.0 names it."""
    machine = platform.machine().lower()
    processor = {"amd64": "x86_64", "arm64": "aarch64"}.get(machine, machine)
    return f"{processor}-{platform.system().lower()}"
