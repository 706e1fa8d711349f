"""A superelement in a few rows, for notebooks."""

from collections.abc import Iterator

import numpy as np

from ..files.html import Row, listed
from .interface import Interface
from .kernel import Kernel
from .modes import Modes

MAX_SHOWN_FREQUENCIES = 6


def rows(
    mass: float, interfaces: tuple[Interface, ...], modes: Modes | None, kernel: Kernel, method: str
) -> Iterator[Row]:
    """Mass, interfaces, frequencies, impulse responses and how they were made."""
    yield "mass", f"{mass:.6g} kg"
    yield "interfaces", listed(interface.name for interface in interfaces)
    if modes is None:
        yield "modes", "none: its step is fixed"
    else:
        first = np.sort(modes.resonances)[:MAX_SHOWN_FREQUENCIES] / (2.0 * np.pi)
        yield "modes", str(len(modes.omega))
        yield "first frequencies, free", f"{listed(f'{f:.5g}' for f in first)} Hz"
    yield "impulse responses", f"{len(kernel.g)} samples, {kernel.h:.6g} s apart"
    yield "method", method or "not stated"
    band = "all frequencies" if kernel.band is None else f"{kernel.band:.5g} Hz"
    yield "error", f"{kernel.error:.2g} up to {band}" if kernel.error else "rounding only"
