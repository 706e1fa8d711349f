"""A superelement at another stiffness, density or damping of the whole body, without a rebuild.

    K -> e K,   M -> r M:     omega -> sqrt(e / r) omega,   phi -> phi / sqrt(r)

Source: docs/theory.md, Scaled superelements.
"""

from collections.abc import Mapping
from dataclasses import replace
from math import isclose, sqrt

import numpy as np

from .chain import LARGEST_LOSS, Chain
from .channels import Channels
from .kernel import Kernel
from .modes import Modes
from .other_modes import first_lags, ratios_at
from .recovery import Recovery, SurfaceRest
from .rotation import Rotation
from .superelement import Superelement
from .surfaces import Surfaces
from .validation import SuperelementError

MAX_REFITTED_RIPPLE = 0.04
"""of a loss factor by relaxation times that were chosen for another one: twice that of files"""


def scale_arrays(base: Superelement, factors: Mapping[str, float]) -> Superelement:
    """A superelement with factors of stiffness, density and damping; see `scaled`."""
    _refuse(base, factors)
    e, r = factors["stiffness"], factors["density"]
    modes = base.modes
    if modes is not None:
        chain, softer = _damped_more(modes.chain, factors["damping"])
        # What the moduli of a file are at the reference they are no longer at rest.
        e = e * softer
        s = sqrt(e / r)
        modes = Modes(
            s * modes.omega,
            factors["damping"] * ratios_at(base, s * modes.omega),
            modes.phi / sqrt(r),
            modes.h_min / s,
            chain,
        )
    return replace(
        base,
        mass=r * base.mass,
        J_rot=r * base.J_rot,
        kernel=_kernel(base.kernel, modes, sqrt(e / r), e),
        modes=modes,
        compliance=base.compliance / e,
        accelerance=base.accelerance / r,
        recovery=None if base.recovery is None else _recovery(base.recovery, e, r),
        rotation=None if base.rotation is None else _rotation(base.rotation, e, r),
        channels=None if base.channels is None else _channels(base.channels, e, r),
        surfaces=None if base.surfaces is None else _surfaces(base.surfaces, e, r),
        # Those of the base are asked for.
        derivatives={},
    )


def _refuse(base: Superelement, factors: Mapping[str, float]) -> None:
    """`SuperelementError` where the superelement does not tell how the body is at these factors."""
    if base.provenance.tested or base.measured is not None:
        raise SuperelementError(
            f"{base.name} has modes of a test, which hold for the part that was tested: expected a "
            "superelement of a mesh alone"
        )
    if factors["density"] != 1.0 and (masses := base.provenance.tables.get("masses")):
        raise SuperelementError(
            f"density: {base.name} has point masses ({', '.join(masses)}), which do not change "
            "with the density of the materials: make it again with another rho"
        )
    if base.modes is None:
        for key in ("stiffness", "damping"):
            expected = factors["density"] if key == "stiffness" else 1.0
            if not isclose(factors[key], expected, rel_tol=1e-12):
                raise SuperelementError(
                    f"{key}: {base.name} has no modes, and its kernel holds for one step: expected "
                    "stiffness and density by the same factor, which leave its frequencies, found "
                    f"stiffness {factors['stiffness']:g}, density {factors['density']:g}, damping "
                    f"{factors['damping']:g}: make it again with impulse.method auto"
                )


def _damped_more(chain: Chain | None, damping: float) -> tuple[Chain | None, float]:
    """A chain for `damping` times its loss factor, and the factor of the stiffness at rest."""
    if chain is None or damping == 1.0:
        return chain, 1.0
    if chain.loss_factor == 0.0:
        raise SuperelementError(
            "damping: materials of different loss factors, whose shares the modes do not keep "
            "apart: expected one loss factor; change those of the body file"
        )
    loss_factor = damping * chain.loss_factor
    if loss_factor > LARGEST_LOSS:
        raise SuperelementError(
            f"damping: expected a loss factor up to {LARGEST_LOSS:g}, found {loss_factor:g}: "
            f"{damping:g} times {chain.loss_factor:g}"
        )
    # Here: scipy takes a while to load, and no run without this factor needs it.
    from .relaxation import fitted, stiffening

    found = fitted(loss_factor, chain.band, chain.tau)
    if found.ripple > MAX_REFITTED_RIPPLE:
        raise SuperelementError(
            f"damping: its relaxation times keep a loss factor of {loss_factor:g} to "
            f"{found.ripple:.1%} only, expected {MAX_REFITTED_RIPPLE:.0%}: change that of the body "
            "file"
        )
    before = stiffening(chain.tau, chain.amplitude, chain.reference)
    after = stiffening(found.tau, found.amplitude, chain.reference)
    changed = replace(
        chain, amplitude=found.amplitude, loss_factor=loss_factor, ripple=found.ripple
    )
    return changed, before / after


def _kernel(stored: Kernel, modes: Modes | None, s: float, e: float) -> Kernel:
    """The kernel of the same step; without modes s is 1."""
    if modes is None:
        return replace(stored, g=stored.g / e, g_initial=stored.g_initial / e)
    return first_lags(modes, stored, None if stored.band is None else s * stored.band)


def _recovery(recovery: Recovery, e: float, r: float) -> Recovery:
    """Displacements by phi, stresses by E times that; a static rest by 1 / E, its stresses kept."""
    rest, turns, stress = recovery.rest, recovery.phi_rotation, recovery.stress
    return replace(
        recovery,
        phi=recovery.phi / sqrt(r),
        stress=None if stress is None else stress * (e / sqrt(r)),
        phi_rotation=None if turns is None else turns / sqrt(r),
        rest=None if rest is None else SurfaceRest(rest.displacement / e, rest.stress),
    )


def _rotation(rotation: Rotation, e: float, r: float) -> Rotation:
    """q [sqrt(kg) m] grows as sqrt(r): each tensor by its powers of q, of mass and of energy."""
    A_surface, cubic, quartic = rotation.A_surface, rotation.cubic, rotation.quartic
    return replace(
        rotation,
        phi_inertia=rotation.phi_inertia * sqrt(r),
        A_interface=rotation.A_interface / r,
        A_surface=None if A_surface is None else A_surface / r,
        cubic=None if cubic is None else cubic * (e / r**1.5),
        quartic=None if quartic is None else quartic * (e / r**2),
    )


def _surfaces(surfaces: Surfaces, e: float, r: float) -> Surfaces:
    return replace(surfaces, phi=surfaces.phi / sqrt(r), H=surfaces.H / e)


def _channels(channels: Channels, e: float, r: float) -> Channels:
    """Patterns and readings by phi, those of stress by E times that."""
    rows = np.ones(channels.n)
    of_sensors = channels.rows_of_sensors()
    for sensor in channels.sensors:
        if sensor.kind == "stress":
            rows[of_sensors[sensor.name]] = e
    if channels.phi is not None:
        return replace(channels, phi=rows[:, None] * channels.phi / sqrt(r))
    kernel, H, B = channels.kernel, channels.compliance, channels.accelerance
    assert kernel is not None
    assert H is not None
    assert B is not None
    every = np.concatenate([np.ones(len(H) - channels.n), rows])
    both = np.outer(every, every)
    return replace(
        channels,
        kernel=replace(kernel, g=both * kernel.g / e, g_initial=both * kernel.g_initial / e),
        compliance=both * H / e,
        accelerance=both * B / r,
    )
