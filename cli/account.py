"""What `duhamel run` says of a run besides its speed: how it started, and what became of the energy."""

from collections.abc import Iterator

import numpy as np

from ..solver import Results
from ..superelement.validation import Array

NOTICEABLE = 1e-9
"""changes of given positions [m, rad] and velocities [m/s, rad/s] that are worth a line"""


def account(results: Results) -> Iterator[str]:
    """Lines of text: degrees of freedom, what was changed at the start, energies and momenta at the end."""
    solver = results.solver
    yield f"degrees of freedom (bodies as rigid): {solver['degrees_of_freedom']}"
    if solver["removed"]:
        yield f"redundant constraints removed: {solver['removed']}"
    if solver["moved"] > NOTICEABLE:
        yield f"closed the joints at the start: bodies moved by up to {solver['moved']:.3g} m or rad"
    if solver["velocity_correction"] > NOTICEABLE:
        yield f"fitted the velocities at the start: changed by up to {solver['velocity_correction']:.3g} m/s or rad/s"
    energy = results.energy
    names = ("kinetic", "elastic", "springs", "potential", "work", "dissipated")
    last = ", ".join(f"{name} {getattr(energy, name)[-1]:.4g}" for name in names if getattr(energy, name).any())
    largest = float(np.abs(energy.balance).max())
    yield f"energy at the end [J]: {last or 'none'}; balance within {largest:.2g}"
    linear, angular = results.momentum.linear[-1], results.momentum.angular[-1]
    yield f"momentum at the end [kg m/s]: {_vector(linear)}; angular, about the origin [kg m^2/s]: {_vector(angular)}"
    lowest, scale = float(energy.elastic.min()), float(np.abs(energy.elastic).max())
    if lowest < -1e-9 * scale and lowest < -10.0 * np.finfo(float).eps:
        yield f"elastic energy fell to {lowest:.3g} J: the convolution has created energy (rule {solver['rule']!r})"


def _vector(values: Array) -> str:
    return "(" + ", ".join(f"{value:.4g}" for value in values) + ")"
