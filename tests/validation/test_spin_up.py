"""The spin-up of Simo and Vu-Quoc: a beam turned about its end, as a chain of 1, 2, 4, 8, 16
superelements.

    psi(t) = 6/15 (t^2/2 + (15/(2 pi))^2 (cos(2 pi t/15) - 1)) until t = 15, then 6 t - 45

L = 10, EA = 2.8e7, GA = 1e7, EI = 1.4e4, mass per length 1.2, rotary inertia per length 6e-4. The
tip, seen from the driven root section, lags behind by up to 0.574 and comes back as centrifugal
forces stiffen the beam; at 6 rad/s it turns faster than its first frequency at rest, 3.8 rad/s.
Source: J. C. Simo and L. Vu-Quoc, On the dynamics of flexible beams under large overall motions:
the plane case, Part II, Journal of Applied Mechanics 53 (1986) 855-863.

A superelement is linear in its own frame: foreshortening and stiffening come from the relative
rotations of the bodies in a chain, so the error falls with the square of their number: one body is
17 % off, two 4 %, four 1 %. All bodies of a chain share one superelement. Tolerance: 0.574 is given
to three digits; 16 bodies reach it to 1 %, and the order is measured.

With [rotation] one body is enough: -0.574 and, once the speed is steady, the stretch of a bar in
rotation, 1.2 * 36 * 10^3 / (3 * 2.8e7) and the little that the stretch adds.
"""

import numpy as np
import pytest
from duhamel.solver import (
    Fixed,
    FlexibleBody,
    Model,
    Place,
    Revolute,
    Settings,
    SmoothFunction,
    Start,
    simulate,
)

from .beam_theory import stretch_of_spinning_bar
from .nonlinear_solid import SolidBox
from .solid_bar import solid_superelement
from .straight_beam import along, beam_superelement

L, REFERENCE = 10.0, -0.574
ELEMENTS = 64
SECTION = {
    "EA": 2.8e7,
    "GA_y": 1e7,
    "GA_z": 1e7,
    "EI_y": 1.4e4,
    "EI_z": 1.4e4,
    "GJ": 1.4e4,
    "mass_per_length": 1.2,
    "rotary_inertia_y": 6e-4,
    "rotary_inertia_z": 6e-4,
    "polar_inertia_per_length": 1.2e-3,
}
T = 15.0
w = 2.0 * np.pi / T
SPIN_UP = SmoothFunction(
    lambda t: 0.4 * (0.5 * t**2 + (np.cos(w * t) - 1.0) / w**2) if t < T else 6.0 * t - 45.0,
    lambda t: 0.4 * (t - np.sin(w * t) / w) if t < T else 6.0,
    lambda t: 0.4 * (1.0 - np.cos(w * t)) if t < T else 0.0,
)


def chain(folder, n, step=1e-2, **settings):
    """n bodies of equal length, the first driven at its root, each of the others fixed to the one
    before; settings: of the body file.
    """
    elements = ELEMENTS // n
    interfaces = {"root": 0, "tip": elements}
    link = beam_superelement(folder, along(L / n, elements), SECTION, interfaces, **settings)
    places = [
        Start(position=[0.5 * L / n, 0, 0]),
        *(Start(place=Place("root", f"b{i}.tip")) for i in range(n - 1)),
    ]
    return Model(
        bodies={f"b{i}": FlexibleBody(link, place) for i, place in enumerate(places)},
        joints=(
            Revolute("ground", "b0.root", [0, 0, 1], name="drive", angle=SPIN_UP),
            *(Fixed(f"b{i}.tip", f"b{i + 1}.root", name=f"j{i}") for i in range(n - 1)),
        ),
        settings=Settings(t_end=20.0, step=step, rho_inf=0.9),
    )


def deflection(results, n):
    """Of the tip, across the driven section (n_t,)."""
    psi = results.joint("drive").coordinates["angle"]
    tip = results.frame(f"b{n - 1}.tip").position
    return np.cos(psi) * tip[:, 1] - np.sin(psi) * tip[:, 0]


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    """The largest lag of the tip by number of bodies, and how far it is off the line at the end."""
    lags = {}
    for n in (1, 2, 4, 8, 16):
        results = simulate(chain(tmp_path_factory.mktemp(f"chain{n}"), n))
        lag = deflection(results, n)
        seconds, steps = results.solver["seconds"], results.solver["steps"]
        print(
            f"{n:2d} bodies: largest deflection {lag.min():.4f}, reference {REFERENCE}; "
            f"after 15 s within {np.abs(lag[results.time > 15.0]).max():.4f}; "
            f"{results.iterations.mean():.2f} iterations and {1e6 * seconds / steps:.0f} us "
            f"per step, {seconds:.2f} s"
        )
        lags[n] = lag.min()
    return lags


@pytest.mark.validation
def test_the_deflection_of_the_tip_is_that_of_simo_and_vu_quoc(found):
    assert abs(found[16] / REFERENCE - 1.0) < 0.01


@pytest.mark.validation
def test_the_error_falls_with_the_square_of_the_number_of_bodies(found):
    differences = np.abs(np.diff([found[n] for n in (2, 4, 8, 16)]))
    orders = np.log2(differences[:-1] / differences[1:])
    print(f"orders of convergence {orders}")
    assert (orders > 1.7).all()


@pytest.mark.validation
def test_one_superelement_of_first_order_is_not_enough(found):
    """It misses the stiffening: where deflections shorten a body noticeably, it takes several
    superelements.
    """
    assert abs(found[1] / REFERENCE - 1.0) > 0.1
    assert abs(found[4] / REFERENCE - 1.0) < 0.02


FROM_ROOT = {"modes": 4, "soft": "auto", "loaded": ["root"]}


@pytest.mark.parametrize(
    ("step", "tolerance"),
    [(2e-2, 2e-3), (1e-2, 1e-3)],
)
def test_one_body_with_its_second_order_is_enough(step, tolerance, tmp_path):
    """Centripetal accelerations err by (omega h)^2 / 12, a thousandth with the longer step."""
    results = simulate(chain(tmp_path, 1, step, rotation=FROM_ROOT))
    lag = deflection(results, 1)
    root, tip = (results.frame(f"b0.{name}").position for name in ("root", "tip"))
    stretch = np.linalg.norm(tip - root, axis=1)[results.time > 17.0] - L
    exact = stretch_of_spinning_bar(6.0, L, SECTION["EA"], SECTION["mass_per_length"])
    print(
        f"one body, step {step}: largest deflection {lag.min():.5f} at "
        f"{results.time[lag.argmin()]:.2f} s; stretch {stretch.mean():.5e}, exact {exact:.5e}; "
        f"{results.iterations.mean():.2f} iterations"
    )
    assert lag.min() == pytest.approx(REFERENCE, rel=tolerance)
    assert np.abs(lag[results.time > 16.0]).max() < 5e-3
    assert stretch.mean() == pytest.approx(exact, rel=tolerance)


SIDE, BOXES, MATERIAL = 0.04, (8, 1, 1), {"E": 1.0, "nu": 0.3, "rho": 1.0}
SLOWER = np.sqrt(SIDE**2 / 12.0) / np.sqrt(SECTION["EI_z"] / SECTION["mass_per_length"] / L**4)
"""how much slower a bar of 1 m of this material bends than the beam"""
OF_BAR = SmoothFunction(
    lambda t: SPIN_UP(SLOWER * t),
    lambda t: SLOWER * SPIN_UP.rate(SLOWER * t),
    lambda t: SLOWER**2 * SPIN_UP.acceleration(SLOWER * t),
)


def turned_bar(element, step, t_end):
    """The middle of the free end, of a superelement (n_t, 3)."""
    start = Start(-element.interface("root").X)
    model = Model(
        bodies={"bar": FlexibleBody(element, start)},
        joints=(Revolute("ground", "bar.root", [0, 0, 1], name="drive", angle=OF_BAR),),
        settings=Settings(t_end=t_end, step=step, rho_inf=0.9),
    )
    return simulate(model).frame("bar.tip").position


@pytest.mark.validation
def test_a_bar_of_solids_is_turned_as_its_nonlinear_mesh(tmp_path):
    """With the same steps, past the largest lag of its tip."""
    size, step, steps = (1.0, SIDE, SIDE), 0.04 / SLOWER, 200
    impulse = {"step": step, "steps": 1, "method": "modal"}
    mesh = SolidBox(size, BOXES, **MATERIAL)
    exact = mesh.turned_by(OF_BAR, step, steps)
    found = {}
    for name, rotation in (("second", FROM_ROOT), ("first", None)):
        element = solid_superelement(
            tmp_path, "hexahedron27", size, BOXES, MATERIAL, impulse, "rigid", rotation=rotation
        )
        path = turned_bar(element, step, steps * step)
        found[name] = np.linalg.norm(path - exact, axis=1).max()
    psi = np.array([OF_BAR(step * n) for n in range(steps + 1)])
    lag = np.cos(psi) * exact[:, 1] - np.sin(psi) * exact[:, 0]
    print(f"largest lag {lag.min():.4f}; distances from the mesh by order {found}, over the length")
    assert lag.min() < -0.05
    assert found["second"] < 1e-3
    assert found["first"] > 10.0 * found["second"]
