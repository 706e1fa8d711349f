"""Processors and systems that the time step is compiled for."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Target:
    """A system by its LLVM triple and a processor by its LLVM name; "": that of this machine.

    is_loaded: without a linker, into this process; all other code is position-independent.
    """

    triple: str = ""
    cpu: str = ""
    is_loaded: bool = False


LINUX, WINDOWS = "x86_64-unknown-linux-gnu", "x86_64-w64-windows-gnu"
HOST = "host"
TARGETS = {
    HOST: Target(is_loaded=True),
    "native": Target(),
    "x86_64-linux": Target(LINUX, "x86-64-v3"),
    "x86_64-linux-v2": Target(LINUX, "x86-64-v2"),
    "aarch64-linux": Target("aarch64-unknown-linux-gnu", "cortex-a72"),
    "x86_64-windows": Target(WINDOWS, "x86-64-v3"),
    "x86_64-windows-v2": Target(WINDOWS, "x86-64-v2"),
    "aarch64-darwin": Target("arm64-apple-macosx11.0.0", "apple-m1"),
}
"""by their platforms in FMI 3.0; v2: for x86-64 processors without AVX2 and FMA"""
