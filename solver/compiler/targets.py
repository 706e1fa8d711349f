"""Processors and systems that the time step is compiled for."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Target:
    """A system by its LLVM triple and a processor by its LLVM name; without, this machine.

    Code for this machine is loaded without a linker, that for others is position-independent.
    """

    triple: str = ""
    cpu: str = ""

    @property
    def is_host(self) -> bool:
        return not self.triple


LINUX, WINDOWS = "x86_64-unknown-linux-gnu", "x86_64-w64-windows-gnu"
HOST = "host"
TARGETS = {
    HOST: Target(),
    "x86_64-linux": Target(LINUX, "x86-64-v3"),
    "x86_64-linux-v2": Target(LINUX, "x86-64-v2"),
    "aarch64-linux": Target("aarch64-unknown-linux-gnu", "cortex-a72"),
    "x86_64-windows": Target(WINDOWS, "x86-64-v3"),
    "x86_64-windows-v2": Target(WINDOWS, "x86-64-v2"),
    "aarch64-darwin": Target("arm64-apple-macosx11.0.0", "apple-m1"),
}
"""by their platforms in FMI 3.0; v2: for x86-64 processors without AVX2 and FMA"""
