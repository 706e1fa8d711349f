"""The numbers of a superelement that do not depend on signs and order of its modes."""

import numpy as np


def observables(element):
    """Arrays by name: rigid and static ones, and what two static loads do to each field."""
    kernel, modes = element.complete_kernel, element.modes
    lags = min(10, kernel.steps)
    found = {
        "mass": element.mass,
        "inertia": element.J_rot,
        "compliance": element.complete_compliance,
        "accelerance": element.complete_accelerance,
        "band": kernel.band or 0.0,
        "g": kernel.g[:lags],
        "g_initial": kernel.g_initial[:lags],
    }
    if modes is None:
        return found
    found |= {"omega": np.sort(modes.omega), "zeta": np.sort(modes.zeta), "h_min": modes.h_min}
    if modes.chain is not None:
        found |= {"tau": modes.chain.tau, "amplitude": modes.chain.amplitude}
    loads = np.random.default_rng(0).normal(size=(len(modes.phi), 2))
    eta = modes.phi.T @ loads / modes.omega[:, None] ** 2
    found |= {f"fields: {name}": field @ eta for name, field in _fields(element)}
    if element.recovery is not None and element.recovery.rest is not None:
        found["rest"] = element.recovery.rest.displacement
        found["stress of rest"] = element.recovery.rest.stress
    if element.surfaces is not None:
        found["surfaces"] = element.surfaces.H
    if element.rotation is not None:
        found |= _second_order(element.rotation, eta)
    return found


def _fields(element):
    yield "interfaces", element.modes.phi
    if element.channels is not None:
        yield "channels", element.channels.phi
    if element.surfaces is not None:
        yield "surfaces", element.surfaces.phi
    if element.recovery is not None:
        for name in ("phi", "stress", "phi_rotation"):
            if (field := getattr(element.recovery, name)) is not None:
                yield name, field


def _second_order(rotation, eta):
    p, q = (rotation.T @ eta).T
    found = {"inertia by loads": rotation.phi_inertia @ eta, "kappa": rotation.kappa}
    for name in ("A_interface", "A_inertia", "gyroscopic"):
        found[name] = np.einsum("irs,r,s->i", getattr(rotation, name), p, q)
    if rotation.cubic is not None:
        k = len(rotation.cubic)
        found["cubic"] = np.einsum("abc,a,b,c", rotation.cubic, *[q[:k]] * 3)
        found["quartic"] = np.einsum("abcd,a,b,c,d", rotation.quartic, *[q[:k]] * 4)
    return found
