"""Bars that turn steadily, free or about an end: how far they stretch, and their stress.

    free, about its middle:   tip u = m spin^2 L^2 / (24 EA) from it
    about its clamped end:    u = tan(k L) / k - L,   k^2 = mass per length spin^2 / EA
    stress at the root:       rho spin^2 L^2 / 2

A body stretches by its own rotation: to first order in spin^2 for a free one, whose motion from
there on is not counted as a source of more; so for the clamped one, whose ends a joint holds, the
difference k^2 L^2 2/5 is allowed for.
"""

import numpy as np
import pytest
from duhamel.preprocess import assemble, build
from duhamel.solver import (
    FlexibleBody,
    Model,
    Polynomial,
    Revolute,
    Settings,
    Start,
    SteadyRotation,
    simulate,
)

from ..preprocess.given.test_matrices import export, given
from .beam_theory import stretch_of_spinning_bar
from .solid_bar import solid_body
from .straight_beam import along, beam_superelement

Z = np.array([0.0, 0.0, 1.0])
L, EA, LINE_DENSITY = 2.0, 3e6, 0.7
SECTION = {
    "EA": EA,
    "EI_y": 20.0,
    "EI_z": 30.0,
    "GJ": 10.0,
    "mass_per_length": LINE_DENSITY,
    "polar_inertia_per_length": 1e-4,
}
FREE = {"modes": 4, "soft": 0}
FROM_ROOT = {"modes": 2, "loaded": ["root"]}
SIDE, MATERIAL = 0.05, {"E": EA / 0.05**2, "nu": 0.0, "rho": LINE_DENSITY / 0.05**2}


def beam(folder, rotation):
    return beam_superelement(
        folder, along(L, 12), SECTION, {"root": 0, "tip": 12}, rotation=rotation
    )


def bar(folder, rotation):
    """Of hexahedra that do not contract across; with stresses on its surface."""
    return build(bar_body(folder, rotation=rotation, recovery={"stress": True}))


def bar_body(folder, **settings):
    impulse = {"step": 1e-4, "method": "modal", "steps": 1}
    divisions = (16, 1, 1)
    size = (L, SIDE, SIDE)
    return solid_body(
        folder, "hexahedron20", size, divisions, MATERIAL, impulse, "rigid", **settings
    )


def bar_of_matrices(folder, rotation):
    """The same from its matrices, which know no stress."""
    model = export(assemble(bar_body(folder, interfaces={"root": {"node": [0, 0, 0]}})))
    x = model.points[:, 0]
    ends = {
        name: {"nodes": model.labels[np.isclose(x, place)].tolist(), "kind": "rigid"}
        for name, place in (("root", 0.0), ("tip", L))
    }
    impulse = {"step": 1e-4, "steps": 1}
    return build(given(model.write(folder), interfaces=ends, impulse=impulse, rotation=rotation))


MAKERS = pytest.mark.parametrize("make", [beam, bar, bar_of_matrices])


def turning(element, spin, joints=(), start=None):
    """Results of a few steps of steady rotation about the origin."""
    return simulate(
        Model(
            bodies={"bar": FlexibleBody(element, start or Start())},
            joints=joints,
            settings=Settings(
                t_end=0.01,
                step=1e-3,
                rho_inf=0.9,
                start="equilibrium",
                steady_rotation=SteadyRotation(spin * Z),
            ),
        )
    )


def clamped(element, spin):
    drive = Revolute("ground", "bar.root", Z, name="drive", angle=Polynomial((0.0, spin)))
    start = Start(-element.interface("root").X)
    return turning(element, spin, (drive,), start)


def stretches(results):
    """Of the bar between root and tip (n_t,)."""
    root, tip = (results.frame(f"bar.{name}").position for name in ("root", "tip"))
    return np.linalg.norm(tip - root, axis=1) - L


@MAKERS
@pytest.mark.parametrize("spin", [20.0, 60.0])
def test_a_free_bar_stretches_about_its_middle(make, spin, tmp_path):
    element = make(tmp_path, FREE)
    exact = 2.0 * element.mass * spin**2 * L**2 / (24.0 * EA)
    stretch = stretches(turning(element, spin))
    print(f"free, {spin} rad/s: stretch over that of theory {stretch[[0, -1]] / exact}")
    np.testing.assert_allclose(stretch, exact, rtol=1e-3)


@MAKERS
@pytest.mark.parametrize("spin", [20.0, 60.0])
def test_a_bar_stretches_about_its_clamped_end(make, spin, tmp_path):
    element = make(tmp_path, FROM_ROOT)
    exact = stretch_of_spinning_bar(spin, L, EA, LINE_DENSITY)
    stretch = stretches(clamped(element, spin))
    print(f"clamped, {spin} rad/s: stretch over that of theory {stretch[[0, -1]] / exact}")
    np.testing.assert_allclose(stretch, exact, rtol=1e-3)


def test_the_stress_at_the_root_of_a_spinning_bar(tmp_path):
    """And its parabola along the bar, within a hundredth of that."""
    spin, element = 60.0, bar(tmp_path, FROM_ROOT)
    results = clamped(element, spin)
    x = element.recovery.points[:, 0] - element.interface("root").X[0]
    stress = results.stress("bar", results.time[-1])[:, 0]
    at_root = 0.5 * MATERIAL["rho"] * spin**2 * L**2
    found = stress[np.abs(x) < 1e-9].mean()
    print(f"stress at the root over rho spin^2 L^2 / 2: {found / at_root:.5f}")
    assert found == pytest.approx(at_root, rel=0.01)
    np.testing.assert_allclose(stress, at_root * (1.0 - (x / L) ** 2), rtol=0, atol=0.01 * at_root)


def test_the_stress_in_the_middle_of_a_free_bar(tmp_path):
    spin, element = 60.0, bar(tmp_path, FREE)
    results = turning(element, spin)
    x = element.recovery.points[:, 0]
    stress = results.stress("bar", results.time[-1])[:, 0]
    in_middle = MATERIAL["rho"] * spin**2 * L**2 / 8.0
    np.testing.assert_allclose(
        stress, in_middle * (1.0 - (2.0 * x / L) ** 2), rtol=0, atol=0.01 * in_middle
    )
