"""A by a mesh that is a few per cent wrong, and by that mesh with frequencies and damping of a
hammer test of the part.
"""

import tempfile
from pathlib import Path

import numpy as np
from duhamel import preprocess
from duhamel.preprocess.measured.part import identified
from duhamel.preprocess.progress import Stages
from duhamel.superelement import Superelement

from .hammer import BAND, HammerTest, truth
from .parts import DAMPING, STEP, STEPS, wrong_angle


def mesh_alone() -> Superelement:
    """As it is before any test, with the damping that all steel has."""
    part = wrong_angle()
    part.damping(modal=DAMPING)
    return part.superelement(step=STEP, duration=STEPS * STEP, method="modal")


def mesh_and_test(test: HammerTest, weighed: bool = False) -> Superelement:
    """With the modes that a test shows in its band; and with the mass of the part."""
    part = wrong_angle()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_modes(test, folder)
        mass = truth().part.element.mass if weighed else None
        part.measured(folder / "modes.npz", folder / "channels.csv", mass=mass)
        return part.superelement(step=STEP, duration=STEPS * STEP, method="modal")


def write_modes(test: HammerTest, folder: Path) -> None:
    """modes.npz and channels.csv of what is identified without any mesh."""
    found = identified(preprocess.read_body(test.write(folder)), Stages())
    fit, frequency = found.found.fit, found.found.fit.frequencies
    within = frequency < BAND[1]
    shapes = found.measurement.outputs @ fit.shapes[:, within]
    np.savez(
        folder / "modes.npz",
        frequency=frequency[within],
        damping=fit.zeta[within],
        shapes=shapes.T,
    )
