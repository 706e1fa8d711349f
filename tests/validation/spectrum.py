"""Frequencies of what a run has recorded."""

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar
from scipy.signal.windows import blackmanharris

Array = NDArray[np.float64]


def frequency(
    signal: NDArray[np.float64] | NDArray[np.complex128], step: float, near: float
) -> float:
    """The frequency [rad/s] of the strongest peak within a tenth of `near`.

    signal (n,), real or complex, at equal steps [s]; a complex one tells the sign. The peak of the
    Fourier integral under a window is found between the frequencies of a discrete transform: what
    is left of an error is the leakage of other peaks, 1e-9 of them where they are eight of its
    lines away.
    """
    window = blackmanharris(len(signal)) * (signal - signal.mean())
    time = step * np.arange(len(signal))

    def height(omega: float) -> float:
        return -float(np.abs(np.exp(-1j * omega * time) @ window))

    spacing = 2.0 * np.pi / (step * len(signal))
    lines = np.arange(-0.1, 0.1, 0.5 * spacing / abs(near)) * abs(near) + near
    best = lines[np.argmin([height(omega) for omega in lines])]
    found = minimize_scalar(
        height, bounds=(best - spacing, best + spacing), method="bounded", options={"xatol": 1e-9}
    )
    return float(found.x)
