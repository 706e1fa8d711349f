"""What is identified of a test, and what frequency-based substructuring makes of it, beside the
truth.
"""

import tempfile
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from duhamel import preprocess
from duhamel.superelement import Superelement
from numpy.typing import NDArray

from . import assembly
from .hammer import HammerTest, truth
from .parts import INTERFACES, Array, ComplexArray, FreePart, Motion, plate
from .substructuring import coupled, virtual_points

BANDS = (20.0, 1000.0), (1000.0, 3000.0), (3000.0, np.inf)
"""[Hz]; the last ends with the lines that are compared"""
HIGHEST = 4500.0
"""[Hz] up to which identified parts claim to be right"""
HIGHEST_OF_TEST = 5000.0
"""[Hz]"""


def lines_to(highest: float) -> Array:
    """Frequencies [Hz] at which responses are compared, all of them lines of the test."""
    return np.arange(20.0, highest, 4.0)


LINES = lines_to(HIGHEST)
SMALL = 0.02
"""of a response, over the mean of its driving points: valleys below it are noise in dB"""
MODES, MODES_OF_ASSEMBLY = 9, 10
"""of A in its band, and of A and B"""
TRANSLATIONS = [0, 1, 2, 6, 7, 8]
"""of top and tip among the nine coordinates of the coupled part"""


@dataclass(frozen=True, eq=False)
class Differences:
    """From the truth: responses of the interfaces of A, rms (3,) by bands over that of the truth;
    of the assembly, mean (3,) by bands [dB].
    """

    interfaces: Array
    assembly: Array


@dataclass(frozen=True, eq=False)
class OfSuperelement(Differences):
    """Largest errors of frequencies and damping of A, relative; of frequencies of the assembly,
    (10,).
    """

    frequencies: float
    damping: float
    of_assembly: Array
    element: Superelement

    @property
    def misfit(self) -> float:
        """Of the identification, for a part that is known from its test alone."""
        return self.element.kernel.error


@dataclass(frozen=True)
class Motions:
    """Differences of displacements after a blow, over those of the truth; of the ball: force and
    speed, relative.
    """

    displacement: float
    peak: float
    speed: float


def identified(test: HammerTest) -> OfSuperelement:
    """Of the measured superelement, in a model with B."""
    with tempfile.TemporaryDirectory() as folder:
        element = preprocess.build(preprocess.read_body(test.write(Path(folder))))
    return of_superelement(element)


def of_superelement(element: Superelement, highest: float = HIGHEST) -> OfSuperelement:
    """Of whatever stands for A, in a model with B, up to a frequency [Hz]."""
    modes, true = element.modes, truth().part.element.modes
    assert modes is not None
    assert true is not None
    nearest = np.abs(modes.omega[:, None] - true.omega[:MODES]).argmin(axis=0)
    found = assembly.frequencies(element, MODES_OF_ASSEMBLY)
    return OfSuperelement(
        _relative(_accelerances(FreePart(element), INTERFACES, highest), true_interfaces(highest)),
        _decibels(assembly.responses(element, lines_to(highest)), true_assembly(highest)),
        float(np.abs(modes.omega[nearest] / true.omega[:MODES] - 1.0).max()),
        float(np.abs(modes.zeta[nearest] / true.zeta[:MODES] - 1.0).max()),
        found / true_frequencies() - 1.0,
        element,
    )


def substructured(test: HammerTest) -> Differences:
    """Of virtual points of the measured responses, coupled to those of B at each line."""
    Y_A = virtual_points(test)[np.searchsorted(test.f, LINES)]
    Y = coupled(Y_A, _accelerances(plate(), ("root", "tip")))
    return Differences(
        _relative(Y_A, true_interfaces()),
        _decibels(Y[:, TRANSLATIONS][:, :, TRANSLATIONS], true_assembly()),
    )


def motions(element: Superelement) -> Motions:
    """After a blow on A alone, and of a ball that hits the assembly."""
    u, true = assembly.blown(element), true_blown()
    norms = [np.linalg.norm(x, axis=(1, 2)) for x in (u - true, true)]
    ball, true_ball = assembly.struck(element), true_struck()
    return Motions(
        float((norms[0] / norms[1]).max()),
        ball.peak / true_ball.peak - 1.0,
        ball.speed / true_ball.speed - 1.0,
    )


@cache
def true_interfaces(highest: float = HIGHEST) -> ComplexArray:
    return _accelerances(truth().part, INTERFACES, highest)


@cache
def true_assembly(highest: float = HIGHEST) -> ComplexArray:
    return assembly.responses(truth().part.element, lines_to(highest))


@cache
def true_frequencies() -> Array:
    return assembly.frequencies(truth().part.element, MODES_OF_ASSEMBLY)


@cache
def true_blown() -> Array:
    return assembly.blown(truth().part.element)


@cache
def true_struck() -> assembly.Blow:
    return assembly.struck(truth().part.element)


def _accelerances(part: FreePart, names: tuple[str, ...], highest: float = HIGHEST) -> ComplexArray:
    own = Motion.all_of([part.motion(name) for name in names])
    return part.accelerance(2j * np.pi * lines_to(highest), own, own)


def _relative(Y: ComplexArray, true: ComplexArray) -> Array:
    """Rms by bands, each coordinate in the size of its driving point."""
    size = np.sqrt(np.abs(np.einsum("kaa->ka", true)).mean(axis=0))
    parts = [np.abs(x / np.outer(size, size)) ** 2 for x in (Y - true, true)]
    off, whole = ([part[k].sum() for k in _in_bands(len(Y))] for part in parts)
    return np.sqrt(np.divide(off, whole))


def _decibels(Y: ComplexArray, true: ComplexArray) -> Array:
    """Mean by bands of the absolute difference [dB], without valleys."""
    driving = np.sqrt(np.abs(np.einsum("kaa->ka", true)))
    counts = np.abs(true) > SMALL * driving[:, :, None] * driving[:, None, :]
    off = np.abs(20.0 * np.log10(np.abs(Y) / np.abs(true)))
    return np.array([off[k][counts[k]].mean() for k in _in_bands(len(Y))])


def _in_bands(count: int) -> list[NDArray[np.bool_]]:
    """Of the first lines."""
    f = lines_to(HIGHEST_OF_TEST)[:count]
    return [(low <= f) & (high > f) for low, high in BANDS]
