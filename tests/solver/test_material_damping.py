"""Material damping: exact against the unreduced model, and the same whatever holds a body."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.preprocess import read_body
from duhamel.preprocess.body.damping import Damping
from duhamel.solver import (
    Constant,
    Fixed,
    FlexibleBody,
    Force,
    Frame,
    Function,
    MaxwellLaw,
    Motor,
    Prismatic,
    Revolute,
    RigidBody,
    Spring,
    Start,
    Table,
    Torque,
    check,
    simulate,
)
from duhamel.solver.linear.linearize import linearize
from duhamel.solver.start.damping import damping_in_words
from scipy.linalg import eigh

from .conftest import BEAM, line_mesh, make_beam
from .models import model_of
from .monolithic import Reference
from .test_recovery import watched
from .test_restart import assert_same, in_parts, machine

H = 2e-4
PULSE = Function(lambda t: np.sin(np.pi * t / 0.05) ** 2 if t < 0.05 else 0.0)
EI = read_body(BEAM).section.EI_z
Z = [0, 0, 1]
LOSS = {"loss_factor": 0.1, "band": (10.0, 4000.0)}


@pytest.fixture(scope="session")
def lossy(tmp_path_factory):
    """Three elements with a loss factor of 0.1."""
    mesh = line_mesh(tmp_path_factory.mktemp("lossy") / "lossy.msh", 3)
    return make_beam(mesh=mesh, damping=Damping.model_validate(LOSS))


@pytest.mark.parametrize("rho_inf", [0.9, 0.0])
def test_a_lossy_beam_swings_like_its_unreduced_model_with_a_chain_at_every_node(
    lossy, hub_and_beam, rho_inf
):
    loads = (
        Torque("hub", [0, 0, 0.2], PULSE),
        Force("beam.tip", [0.3, 0.0, 1.0], Constant(0.5)),
    )
    settings = {"loads": loads, "t_end": 250 * H, "step": H, "rho_inf": rho_inf}
    model = hub_and_beam(lossy, 0.5, "spherical", (1.0, 2.0, 5.0), **settings)
    hub, chain = model.bodies["hub"], lossy.element.modes.chain
    reference = Reference(
        lossy.structure,
        hub.inertia,
        hub.mass,
        hub.frames["rim"].position,
        H,
        rho_inf,
        revolute=False,
        tau=tuple(chain.tau),
        amplitude=tuple(chain.amplitude),
    )
    results = simulate(model)
    samples = [np.outer(x.signal.samples(results.time, H), x.direction) for x in loads]
    _, u, v, _ = reference.run(samples[0][:, 2], samples[1], spin=hub.start.angular_velocity)
    found = np.hstack([results.frame("beam.root").u, results.frame("beam.tip").u])
    assert np.abs(u).max() > 1e-4
    for here, there in ((found, u), (results.body("beam").v[:, :3], v[:, 6:9])):
        assert np.abs(here - there).max() < 1e-11 * np.abs(there).max()


def poles_of_the_mesh(lossy, held):
    """Eigenvalues (n,) of the whole mesh with a chain at every dof, of which some are held.

    (s^2 M + K (1 + sum a_k s tau_k / (1 + s tau_k))) u = 0 is one equation for each undamped
    frequency of the held mesh, whatever holds it.
    """
    structure, chain = lossy.structure, lossy.element.modes.chain
    K, M = structure.K.toarray(), structure.M.toarray()
    free = np.delete(np.eye(len(K)), held, axis=1)
    squares = eigh(free.T @ K @ free, free.T @ M @ free, eigvals_only=True)
    return np.array([pole_of(square, chain) for square in squares if square > 1e-3])


def pole_of(square, chain):
    """The root of s^2 + square c(s) that vibrates, of the polynomial that it makes."""
    denominators = [np.array([tau, 1.0]) for tau in chain.tau]
    product = np.array([1.0])
    for factor in denominators:
        product = np.polymul(product, factor)
    total = np.polymul([1.0, 0.0, square], product)
    for k, (a, tau) in enumerate(zip(chain.amplitude, chain.tau, strict=True)):
        others = np.array([square * a * tau, 0.0])
        for j, factor in enumerate(denominators):
            others = others if j == k else np.polymul(others, factor)
        total = np.polyadd(total, others)
    roots = np.roots(total)
    return roots[np.argmax(roots.imag)]


HOLDS = {
    "free": ([], []),
    "clamped": (range(6), [Fixed("ground", "beam.root", name="hold")]),
    "pinned": ([0, 1, 2, 3, 4], [Revolute("ground", "beam.root", [0, 0, 1], name="hold")]),
}


@pytest.mark.parametrize("held", HOLDS)
def test_every_mode_has_half_the_loss_factor_whatever_holds_the_body(lossy, held):
    dofs, joints = HOLDS[held]
    model = model_of(
        bodies={"beam": FlexibleBody(lossy.element)}, joints=joints, t_end=0.01, step=1e-4
    )
    found = check(model).damping
    poles = poles_of_the_mesh(lossy, list(dofs))
    poles = poles[np.argsort(poles.imag)][: len(found)]
    np.testing.assert_allclose(
        [motion.frequency for motion in found], poles.imag / (2 * np.pi), rtol=1e-9
    )
    ratios = np.array([motion.ratio for motion in found])
    np.testing.assert_allclose(ratios, -poles.real / np.abs(poles), rtol=1e-8)
    inside = poles.imag < 2 * np.pi * 4000
    # The fit is one of undamped vibrations: what decays sees the chain elsewhere, by its loss.
    ripple = lossy.element.modes.chain.ripple
    np.testing.assert_allclose(2 * ratios[inside], 0.1, rtol=ripple + 0.1 / 2)


def test_modal_ratios_of_the_free_body_are_less_where_it_is_clamped():
    """docs/validity.md has the numbers."""
    beam = make_beam(damping=Damping.model_validate({"modal": 0.02}))
    model = model_of(
        bodies={"beam": FlexibleBody(beam.element)},
        joints=[Fixed("ground", "beam.root", name="hold")],
        t_end=0.01,
        step=1e-4,
    )
    found = check(model)
    ratios = [100 * motion.ratio for motion in found.damping]
    np.testing.assert_allclose(ratios[:2], 0.14, atol=0.005)
    np.testing.assert_allclose(ratios[2:], [1.3, 1.3, 1.6, 1.6], atol=0.05)
    line = f"damping ratios about the initial state: {damping_in_words(found.damping)}"
    assert line in str(found).splitlines()
    assert simulate(model).solver["damping"] == damping_in_words(found.damping)


def test_dampers_are_in_the_damping_of_the_assembled_model():
    """A mass on a spring, and nothing without one."""
    spring = Spring("coil", "point", ("ground.post", "block"), stiffness=400.0, rest=[1.0])
    for coefficient, expected in ((2.0, 0.05), (0.0, None)):
        model = model_of(
            bodies={"block": RigidBody(1.0, [1.0, 1.0, 1.0])},
            joints=[Prismatic("ground", "block", [1, 0, 0], name="guide")],
            springs=[replace(spring, damping=coefficient)],
            ground_frames={"post": Frame([-1.0, 0, 0])},
            t_end=0.01,
            step=1e-3,
        )
        found = check(model).damping
        if expected is None:
            assert found == ()
        else:
            assert found[0].ratio == pytest.approx(expected, rel=1e-9)
            assert found[0].frequency == pytest.approx(20 * np.sqrt(1 - 0.05**2) / (2 * np.pi))


def test_the_damping_of_a_long_chain_of_masses_is_that_of_the_formula():
    """omega_k = 2 omega_0 sin((2 k - 1) pi / (4 n + 2)), zeta_k = d omega_k / (2 c).

    Of n masses m, one after the other by springs c and dampers d, omega_0^2 = c / m.
    """
    n, m, c, d = 60, 2.0, 3e4, 4.0
    names = ["ground", *(f"m{k}" for k in range(n))]
    model = model_of(
        bodies={name: RigidBody(m, [1.0, 1.0, 1.0]) for name in names[1:]},
        joints=[Prismatic(names[k], names[k + 1], [1, 0, 0], name=f"j{k}") for k in range(n)],
        motors=[Motor(f"s{k}", f"j{k}", "distance", stiffness=c, damping=d) for k in range(n)],
        t_end=0.01,
        step=1e-3,
    )
    omega = 2.0 * np.sqrt(c / m) * np.sin((2.0 * np.arange(1, 7) - 1.0) * np.pi / (4 * n + 2))
    ratio = d * omega / (2.0 * c)
    found = check(model).damping
    np.testing.assert_allclose([motion.ratio for motion in found], ratio, rtol=1e-8)
    damped = omega * np.sqrt(1.0 - ratio**2) / (2.0 * np.pi)
    np.testing.assert_allclose([motion.frequency for motion in found], damped, rtol=1e-8)


def test_an_overdamped_motion_is_no_vibration():
    """The mass behind a stiff damper swings as if it held the first one, which creeps back."""
    joints = [
        Prismatic(a, b, [1, 0, 0], name=b) for a, b in (("ground", "first"), ("first", "last"))
    ]
    model = model_of(
        bodies={name: RigidBody(1.0, [1.0, 1.0, 1.0]) for name in ("first", "last")},
        joints=joints,
        motors=[
            Motor("damper", "first", "distance", stiffness=400.0, damping=1e4),
            Motor("coil", "last", "distance", stiffness=800.0, damping=0.1),
        ],
        t_end=0.01,
        step=1e-3,
    )
    (swing,) = check(model).damping
    assert 2.0 * np.pi * swing.frequency == pytest.approx(np.sqrt(800.0), rel=1e-3)


COMPLIANT = {
    "damping": Motor("servo", "hinge", "angle", stiffness=40.0, damping=2.0),
    "integral": Motor("servo", "hinge", "angle", stiffness=40.0, damping=2.0, integral=25.0),
    "growing": Motor("servo", "hinge", "angle", stiffness=40.0, integral=25.0),
    "relaxing": Spring(
        "coil", "torsion", ("ground", "arm"), Z, stiffness=40.0, law=MaxwellLaw([0.2], [70.0])
    ),
}


@pytest.mark.parametrize("kind", COMPLIANT)
@pytest.mark.parametrize("has_beam", [False, True], ids=["rigid", "lossy"])
def test_the_damping_of_servos_and_springs_is_that_of_the_linear_equations(lossy, kind, has_beam):
    bodies = {"arm": RigidBody(1.0, [0.5, 0.5, 0.5])}
    joints = [Revolute("ground", "arm", Z, name="hinge")]
    if has_beam:
        bodies["beam"] = FlexibleBody(lossy.element, Start([0.25, 0, 0]))
        joints.append(Fixed("arm", "beam.root", name="clamp"))
    part = COMPLIANT[kind]
    parts = {"motors": [part]} if isinstance(part, Motor) else {"springs": [part]}
    model = model_of(bodies=bodies, joints=joints, t_end=0.01, step=1e-3, **parts)
    found, linear = check(model).damping, linearize(model).modes()
    assert len(found) == (6 if has_beam else 1)
    for motion in found:
        nearest = np.argmin(np.abs(linear.frequencies - motion.frequency))
        assert motion.frequency == pytest.approx(linear.frequencies[nearest], rel=1e-7)
        # an error of an eigenvalue, relative to its size, is that of the ratio
        assert motion.ratio == pytest.approx(linear.ratios[nearest], abs=1e-7)


def pushed(element, joints=(), **settings):
    """A beam in space, pushed at random."""
    noise = np.random.default_rng(0).standard_normal((2, 201))
    t = np.linspace(0.0, 0.04, 201)
    loads = [
        Force(f"beam.{name}", [0.3, 1, -0.5], Table(t, values))
        for name, values in zip(("root", "tip"), noise, strict=True)
    ]
    return model_of(bodies={"beam": FlexibleBody(element)}, joints=joints, loads=loads, **settings)


def test_what_a_free_body_is_given_is_kept_or_dissipated(lossy):
    """At rho_inf = 1 nothing else takes energy, and the springs of the chain never give any."""
    energy = simulate(pushed(lossy.element, t_end=0.04, step=1e-5, rho_inf=1.0)).energy
    scale = energy.work.max()
    assert energy.dissipated[-1] > 0.3 * scale
    assert np.diff(energy.dissipated).min() >= 0.0
    assert np.abs(energy.numerical).max() < 1e-13 * scale
    assert np.abs(energy.balance).max() < 1e-6 * scale


@pytest.mark.parametrize("history", ["direct", "fft"])
def test_kernels_have_the_chain_too(lossy, history):
    settings = {"t_end": 0.04, "step": 1e-4, "rho_inf": 0.9}
    by_modes, by_kernel = (
        simulate(pushed(lossy.element, history=form, **settings)).frame("beam.tip").u
        for form in ("recursive", history)
    )
    assert np.abs(by_kernel - by_modes).max() < 1e-11 * np.abs(by_modes).max()


@pytest.mark.filterwarnings("ignore::duhamel.solver.ValidityWarning")
def test_the_memory_of_a_kernel_is_that_of_its_motions(lossy):
    """The error that is stated for a kernel that is cut off bounds what it does."""
    joints = [Fixed("ground", "beam.root", name="hold")]
    settings = {"t_end": 0.8, "step": 2e-4, "rho_inf": 0.9}
    whole = simulate(pushed(lossy.element, joints, **settings))
    cut = simulate(pushed(lossy.element, joints, history="direct", kernel_length=0.3, **settings))
    u, error = whole.frame("beam.tip").u, cut.solver["truncation"]
    assert 1e-6 < error < 0.1
    assert np.abs(cut.frame("beam.tip").u - u).max() < error * np.abs(u).max()


def test_a_body_at_rest_under_its_load_stays_there(lossy):
    """With the static stiffness, which is that of the body file: the chain has relaxed."""
    model = model_of(
        bodies={"beam": FlexibleBody(lossy.element)},
        joints=[Fixed("ground", "beam.root", name="hold")],
        loads=[Force("beam.tip", [0, 1e-3, 0], Constant(1.0))],
        t_end=0.02,
        step=1e-4,
        start="equilibrium",
    )
    results = simulate(model)
    u, tip = results.frame("beam.tip").u, results.frame("beam.tip").position
    root = results.frame("beam.root").position
    assert tip[0, 1] - root[0, 1] == pytest.approx(1e-3 * 0.5**3 / (3 * EI), rel=1e-6)
    assert np.abs(u - u[0]).max() < 1e-9 * np.abs(u).max()


def test_a_run_in_parts_is_that_in_one_to_the_bit(lossy, tmp_path):
    model = machine(lossy.element)
    simulate(model, output=tmp_path / "whole.h5")
    in_parts(model, tmp_path / "parts.h5", 13, 80)
    assert_same(tmp_path / "parts.h5", tmp_path / "whole.h5")


def test_a_model_goes_on_from_the_springs_of_another_run(lossy, tmp_path):
    model = machine(lossy.element)
    whole = simulate(model).frame("beam.tip").u[37:]
    simulate(model.with_settings(t_end=37 * 5e-4, checkpoint=1e3), output=tmp_path / "first.h5")
    start = {"from": str(tmp_path / "first.h5")}
    second = simulate(model.with_settings(start=start)).frame("beam.tip").u
    assert np.abs(second - whole).max() < 1e-8 * np.abs(whole).max()


def test_stresses_follow_the_springs_of_the_chain(lossy):
    """S (eta + sum a_k q_k), with springs that are integrated exactly for modes that are linear in
    time; the "stresses" are the rotations of the interfaces that modes have.
    """
    element = watched(lossy.element)
    model = pushed(element, t_end=0.01, step=2e-6)
    results = simulate(model)
    chain = element.modes.chain
    u = np.stack([results.frame(f"beam.{name}").u[:, 3:] for name in ("root", "tip")], axis=1)
    q = np.zeros((len(chain.tau), *u.shape))
    kept = np.exp(-2e-6 / chain.tau)[:, None, None]
    gain = (1.0 - kept) * (chain.tau / 2e-6)[:, None, None]
    for n in range(1, len(u)):
        q[:, n] = kept * q[:, n - 1] + gain * (u[n] - u[n - 1])
    expected = u + np.tensordot(chain.amplitude, q, 1)
    found = results.stress("beam", results.time)[:, :, :3]
    assert np.abs(found - expected).max() < 1e-4 * np.abs(expected).max()
    assert np.abs(found - u).max() > 0.05 * np.abs(u).max()


def test_the_linear_model_has_the_springs_of_the_chain(lossy):
    """Modes and frequency responses, against the mesh."""
    joints = [Fixed("ground", "beam.root", name="hold")]
    model = model_of(
        bodies={"beam": FlexibleBody(lossy.element)}, joints=joints, t_end=0.01, step=1e-4
    )
    linear = linearize(model)
    values = linear.modes().values
    expected = poles_of_the_mesh(lossy, range(6))
    for pole in expected[:6]:
        assert np.abs(values - pole).min() < 1e-8 * abs(pole)
    structure, chain = lossy.structure, lossy.element.modes.chain
    K, M = structure.K.toarray()[6:, 6:], structure.M.toarray()[6:, 6:]
    f = np.array([5.0, 20.0, 300.0, 2000.0])
    found = linear.frf(["force:beam.tip:y"], ["position:beam.tip:y"], f)
    P = structure.P_C.toarray()[:, 6:]
    for k, w in enumerate(2 * np.pi * f):
        c = chain.factor(np.array([w]), 1)[0, 0]
        G = (P @ np.linalg.solve(c * K - w**2 * M, P.T))[7, 7]
        assert found.values[k, 0, 0] == pytest.approx(G, rel=1e-7)


def response(space, f):
    """Of a state space at frequencies f (n,) [Hz]: (n, n_out, n_in)."""
    away = [2j * np.pi * frequency * np.eye(len(space.A)) - space.A for frequency in f]
    return np.array([space.C @ np.linalg.solve(A, space.B) + space.D for A in away])


@pytest.mark.parametrize("held", HOLDS)
@pytest.mark.parametrize("damping", [LOSS, {"modal": 0.02}], ids=["chain", "modal"])
def test_a_state_space_is_right_where_eigenvalues_coincide(lossy, damping, held):
    """The beam bends alike in two planes, and its fast modes relax alike."""
    element = (
        lossy.element
        if damping is LOSS
        else make_beam(damping=Damping.model_validate(damping)).element
    )
    joints = HOLDS[held][1]
    model = model_of(bodies={"beam": FlexibleBody(element)}, joints=joints, t_end=0.01, step=1e-4)
    linear, f = linearize(model), np.array([5.0, 20.0, 300.0, 2000.0, 5000.0])
    loads = ["force:beam.tip:y", "force:beam.tip:z"]
    sought = ["position:beam.tip:y", "position:beam.tip:z"]
    expected = linear.frf(loads, sought, f).values
    found = response(linear.state_space(loads, sought), f)
    assert (np.abs(found - expected).max((1, 2)) < 1e-8 * np.abs(expected).max((1, 2))).all()
