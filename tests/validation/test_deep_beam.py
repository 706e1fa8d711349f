"""The deep simply supported beam of NAFEMS: natural frequencies (FV5) and the response to a
suddenly applied load (5T).

Length 10 m, section 2 x 2 m, E = 200 GPa, nu = 0.3, rho = 8000 kg/m^3. One end is held along x, y,
z and about x, the other along y and z. 5T: a load of 1e6 N/m along y acts from t = 0 on; damping 2
% in the first mode.

Sources: NAFEMS, The standard NAFEMS benchmarks (TNSB Rev. 3, 1990), test FV5; NAFEMS, Selected
benchmarks for forced vibration (R0016), test 5T. Frequencies of FV5: 42.649 (two of bending),
77.542 (torsion), 125.00 (axial), 148.31 (two of bending), 233.10 (torsion), 284.55 (bending). 5T:
peak deflection at mid-span 1.043 mm at 0.0117 s, static 0.538 mm. The closed form of Timoshenko's
beam is beside them:

    omega^4 - (k^2 (kappa G + E) / rho + kappa G A / (rho I_A)) omega^2 + k^4 kappa G E / rho^2 = 0

with k = n pi / L and kappa = 5/6. The polar moment of area serves as torsion constant, as 77.542 Hz
implies.

One superelement of 20 elements with an interface at every node: the uniform load is made of forces
on nodes. The frequencies are those of the spectrum of a free vibration, so that they come from the
solver's own steps. Damping is proportional to stiffness, for which the supported beam is damped as
the free one: 2 % in the first mode. Tolerances: 0.5 % for frequencies (of a mesh of 20 elements), 1
% for the deflections, 2 % for the time of the peak.
"""

import numpy as np
import pytest
from duhamel.solver import (
    Constant,
    FlexibleBody,
    Force,
    Impulse,
    Model,
    PrescribedDisplacement,
    Settings,
    Start,
    Torque,
    Universal,
    simulate,
)

from .straight_beam import along, beam_superelement

pytestmark = pytest.mark.validation

L, SIDE, E, nu, rho = 10.0, 2.0, 2e11, 0.3, 8000.0
A, I_A, G, kappa = SIDE**2, SIDE**4 / 12, E / (2 * (1 + nu)), 5 / 6
ELEMENTS = 20
MIDDLE = ELEMENTS // 2
SECTION = {
    "EA": E * A,
    "GA_y": kappa * G * A,
    "GA_z": kappa * G * A,
    "EI_y": E * I_A,
    "EI_z": E * I_A,
    "GJ": 2 * G * I_A,
    "mass_per_length": rho * A,
    "rotary_inertia_y": rho * I_A,
    "rotary_inertia_z": rho * I_A,
    "polar_inertia_per_length": 2 * rho * I_A,
}
BENDING, TORSION, AXIAL = (42.649, 148.31, 284.55), (77.542, 233.10), (125.00,)
PEAK, PEAK_TIME, STATIC = 1.043e-3, 0.0117, 0.538e-3
FORCE = 1e6


def bending_frequency(n):
    """The lower root of the frequency equation [Hz]."""
    k = n * np.pi / L
    sum_of_squares = k**2 * (kappa * G + E) / rho + kappa * G * A / (rho * I_A)
    product = k**4 * kappa * G * E / rho**2
    lower = 0.5 * (sum_of_squares - np.sqrt(sum_of_squares**2 - 4.0 * product))
    return np.sqrt(lower) / (2.0 * np.pi)


def superelement(folder, **settings):
    interfaces = {f"n{i}": i for i in range(ELEMENTS + 1)}
    return beam_superelement(folder, along(L, ELEMENTS), SECTION, interfaces, **settings)


def supported(beam, loads, **settings):
    """The beam on its supports; the rotation about x is held at the first end alone."""
    first, last = "beam.n0", f"beam.n{ELEMENTS}"
    return Model(
        bodies={"beam": FlexibleBody(beam, Start(position=[0.5 * L, 0, 0]))},
        joints=(Universal("ground", first, [0, 1, 0], [0, 0, 1], name="support"),),
        motions=(
            PrescribedDisplacement("across", last, [0, 1, 0], Constant(0.0)),
            PrescribedDisplacement("up", last, [0, 0, 1], Constant(0.0)),
        ),
        loads=loads,
        settings=Settings(**settings),
    )


def spectrum_peaks(signal, h, near):
    """The frequencies [Hz] where the spectrum of a signal peaks, within 5 % of those given."""
    n = 16 * len(signal)  # zeros behind the signal draw the spectrum finely
    size = np.abs(np.fft.rfft(signal * np.hanning(len(signal)), n))
    frequency = np.fft.rfftfreq(n, h)
    return [frequency[np.argmax(size * (np.abs(frequency / f - 1.0) < 0.05))] for f in near]


def test_the_frequencies_are_those_of_fv5(tmp_path):
    # Off the symmetries, so that every mode takes part.
    blow = Impulse(1.0, 0.0)
    loads = (
        Force("beam.n3", [0, 1e3, 1e3], blow),
        Torque("beam.n9", [1e3, 0, 0], blow),
        Force(f"beam.n{ELEMENTS}", [1e3, 0, 0], blow),
    )
    h = 4e-5
    results = simulate(supported(superelement(tmp_path), loads, t_end=1.0, step=h, rho_inf=0.99))
    sensor = results.frame("beam.n17").velocity
    axial = results.frame(f"beam.n{ELEMENTS}").velocity[:, 0]
    found = {
        "bending along y": (spectrum_peaks(sensor[:, 1], h, BENDING), BENDING),
        "bending along z": (spectrum_peaks(sensor[:, 2], h, BENDING), BENDING),
        "torsion": (spectrum_peaks(sensor[:, 3], h, TORSION), TORSION),
        "axial": (spectrum_peaks(axial, h, AXIAL), AXIAL),
    }
    print(f"closed form of bending {np.round([bending_frequency(n) for n in (1, 2, 3)], 3)} Hz")
    print(f"{results.iterations.mean():.2f} iterations per step, {results.solver['seconds']:.2f} s")
    for name, (frequencies, reference) in found.items():
        print(f"{name}: {np.round(frequencies, 3)} Hz, reference {reference}")
    for frequencies, reference in found.values():
        np.testing.assert_allclose(frequencies, reference, rtol=5e-3)


def uniform_load(signal):
    """Along y; the end nodes bear half an element."""
    share = FORCE * L / ELEMENTS
    return tuple(
        Force(f"beam.n{i}", [0, share if 0 < i < ELEMENTS else 0.5 * share, 0], signal)
        for i in range(ELEMENTS + 1)
    )


def test_the_response_to_a_sudden_load_is_that_of_5t(tmp_path):
    stiffness = 2.0 * 0.02 / (2.0 * np.pi * bending_frequency(1))
    beam = superelement(tmp_path, damping={"rayleigh": {"stiffness": stiffness}})
    loads = uniform_load(Constant(1.0))
    results = simulate(supported(beam, loads, t_end=0.02, step=5e-5))
    deflection = results.frame(f"beam.n{MIDDLE}").position[:, 1]
    peak, peak_time = deflection.max(), results.time[np.argmax(deflection)]
    resting = simulate(supported(beam, loads, t_end=1e-3, step=5e-5, start="equilibrium"))
    static = resting.frame(f"beam.n{MIDDLE}").position[0, 1]
    closed = 5 * FORCE * L**4 / (384 * E * I_A) + FORCE * L**2 / (8 * kappa * G * A)
    # Between the nodes the moment runs straight, below the parabola by q dx^2 / 12 in the mean.
    lumped = closed - FORCE * (L / ELEMENTS) ** 2 * L**2 / (96 * E * I_A)
    print(
        f"peak {1e3 * peak:.4f} mm at {peak_time:.5f} s, reference {1e3 * PEAK:.3f} mm at "
        f"{PEAK_TIME} s"
    )
    print(
        f"static {1e3 * static:.5f} mm, reference {1e3 * STATIC:.3f} mm, closed form "
        f"{1e3 * closed:.5f} mm, "
        f"with forces on nodes {1e3 * lumped:.5f} mm"
    )
    print(f"{results.iterations.mean():.2f} iterations per step, {results.solver['seconds']:.2f} s")
    assert abs(peak / PEAK - 1.0) < 0.01
    assert abs(peak_time / PEAK_TIME - 1.0) < 0.02
    assert abs(static / STATIC - 1.0) < 0.01
    assert abs(static / lumped - 1.0) < 1e-9
