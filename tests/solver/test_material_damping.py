"""Material damping: exact against the unreduced model, passive, and the same whatever holds a body."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.preprocess.body.damping import Damping
from duhamel.solver import Constant, FlexibleBody, Function, Joint, Load, Settings, simulate

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
