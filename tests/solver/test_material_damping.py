"""Material damping: exact against the unreduced model, passive, and the same whatever holds a body."""

import numpy as np
import pytest
from duhamel.preprocess.body.damping import Damping
from duhamel.solver import Constant, FlexibleBody, Function, Joint, Load, check, simulate
from scipy.linalg import eigh

from .conftest import line_mesh, make_beam
from .models import model_of
from .monolithic import Reference

H = 2e-4
PULSE = Function(lambda t: np.sin(np.pi * t / 0.05) ** 2 if t < 0.05 else 0.0)
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
        Load("torque", "hub", [0, 0, 0.2], PULSE),
        Load("force", "beam.tip", [0.3, 0.0, 1.0], Constant(0.5)),
    )
    settings = {"loads": loads, "t_end": 600 * H, "step": H, "rho_inf": rho_inf}
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
    "clamped": (range(6), [Joint("hold", "fixed", ("ground", "beam.root"))]),
    "pinned": ([0, 1, 2, 3, 4], [Joint("hold", "revolute", ("ground", "beam.root"), [0, 0, 1])]),
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
