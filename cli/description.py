"""A superelement as a table."""

from collections.abc import Iterator

import numpy as np
from rich.table import Table

from ..superelement import (
    Chain,
    Interface,
    Kernel,
    MeasuredModes,
    Modes,
    Provenance,
    Rotation,
    Superelement,
)
from .tables import Row, components, sectioned

SHOWN_FREQUENCIES = 10
# Of which the stiffening is shown: the softest come first.
STIFFENED_SHAPES = 20
SHOWN_COMPLEXITY = 0.1
"""per cent of a measured shape out of phase from which on it is shown"""
UNKNOWN_STIFFENING = (
    "none, for [matrices] know none: slender bodies, as blades, soften as they turn where they "
    "would stiffen"
)


def describe(element: Superelement) -> Table:
    """Mass properties, interfaces, surfaces, frequencies, kernel and provenance, a section each."""
    sections = (
        _rigid(element),
        _interfaces(element.interfaces),
        _surfaces(element),
        _channels(element),
        _frequencies(element.modes),
        _measured(element.measured),
        _rotation(element.rotation),
        _derivatives(element),
        _kernel(element.kernel),
        _provenance(element.provenance),
    )
    return sectioned(element.name, sections)


def _rigid(element: Superelement) -> Iterator[Row]:
    principal = np.linalg.eigvalsh(element.J_rot).astype(np.float64)
    yield "mass [kg]", f"{element.mass:.6g}"
    yield "center of mass [m]", components(element.center)
    yield "principal inertia [kg m^2]", components(principal)
    yield "inertia [kg m^2]", "\n".join(components(row) for row in element.J_rot)
    if element.outline is not None:
        yield "outline", f"{element.outline.n_facets} facets, {len(element.outline.points)} points"


def _interfaces(interfaces: tuple[Interface, ...]) -> Iterator[Row]:
    yield "interfaces", f"{len(interfaces)}, positions [m] from the center of mass"
    for interface in interfaces:
        yield f"  {interface.name}", f"{components(interface.X)}   {interface.n_dofs} dofs"


def _surfaces(element: Superelement) -> Iterator[Row]:
    if element.surfaces is None:
        return
    patches, H = element.surfaces.patches, element.surfaces.H
    yield "surfaces", f"{len(patches)}, a compliance of {len(H)} rows, {H.nbytes / 1e6:.3g} MB"
    for patch in patches:
        facets = f"{len(patch.facets)} {patch.facet_type} facets"
        yield f"  {patch.name}", f"{patch.n} nodes, {facets}, {patch.area:.4g} m^2"


def _channels(element: Superelement) -> Iterator[Row]:
    if element.patterns:
        yield "load patterns", f"{len(element.patterns)}, resultants at the amplitude 1"
    for pattern in element.patterns:
        force, moment = components(pattern.force), components(pattern.moment)
        yield f"  {pattern.name}", f"{force} N   {moment} N m about the center of mass"
    if element.sensors:
        yield "sensors", f"{len(element.sensors)}, positions [m] from the center of mass"
    for sensor in element.sensors:
        yield f"  {sensor.name}", f"{components(sensor.X)}   {sensor.kind}"


def _frequencies(modes: Modes | None) -> Iterator[Row]:
    if modes is None:
        # Another step or rho_inf is made from modes; a kernel alone is what it was sampled as.
        yield "modes", "none, so the step and rho_inf of the kernel are fixed"
        return
    first = np.sort(modes.resonances)[:SHOWN_FREQUENCIES] / (2.0 * np.pi)
    yield (
        "modes",
        str(len(modes.omega)) + (f", for steps down to {modes.h_min:.6g} s" if modes.h_min else ""),
    )
    yield f"first {len(first)} [Hz]", ", ".join(f"{frequency:.5g}" for frequency in first)
    if modes.chain is not None:
        yield "loss factor", loss_in_words(modes, modes.chain)
    if modes.zeta.any():
        low, high = float(modes.zeta.min()), float(modes.zeta.max())
        ratios = f"{low:.3g}" if low == high else f"{low:.3g} to {high:.3g}"
        bound = f"{high:.3g} f / {first[0]:.5g} Hz"
        yield (
            "damping ratios, free",
            f"{ratios}; at a joint, or clamped, a mode at f: up to {bound}",
        )


def _derivatives(element: Superelement) -> Iterator[Row]:
    if element.derivatives:
        yield "derivatives", f"{len(element.derivatives)}, for [bodies.NAME.design] of models"
    for name, tangent in element.derivatives.items():
        reach = f"{tangent.value:.6g}, {tangent.reach:.3g} up or down"
        yield f"  {name}", f"{reach}; error of the compliance by the modes {tangent.error:.1e}"


def loss_in_words(modes: Modes, chain: Chain) -> str:
    """What the material takes, and within which limits."""
    low, high = chain.band
    fit = f"{low:g} to {high:g} Hz within {100.0 * chain.ripple:.2g} %"
    if chain.loss_factor:
        middle = np.sqrt(low * high)
        stiffer = 100.0 * float(chain.factor(np.array([2.0 * np.pi * middle]), 1)[0, 0].real - 1.0)
        moduli = chain.given_moduli or (
            f"moduli given at rest; at {middle:.3g} Hz they are {stiffer:.2g} % higher"
        )
        return (
            f"{chain.loss_factor:g} from {fit}, {len(chain.tau)} Maxwell elements: damping ratio "
            f"{0.5 * chain.loss_factor:g}, free or held; {moduli}"
        )
    resonances = modes.resonances / (2.0 * np.pi)
    losses = modes.loss_factors[(low <= resonances) & (resonances <= high)]
    found = f"{losses.min():.3g} to {losses.max():.3g}, " if len(losses) else ""
    moduli = f"; {chain.given_moduli}" if chain.given_moduli else ""
    return (
        f"{found}by the strain energy that modes of the free body have in each material, those of "
        f"the materials from {fit}{moduli}"
    )


def _measured(measured: MeasuredModes | None) -> Iterator[Row]:
    if measured is None:
        return
    used = int(measured.matched.sum())
    yield (
        "measured",
        f"{used} of {len(measured.frequency)} modes: frequencies and damping of a test",
    )
    yield from measured_pairs(measured)


def measured_pairs(measured: MeasuredModes) -> Iterator[Row]:
    """A row for each measured mode: damping, and the mode of the model that it is."""
    for i, frequency in enumerate(measured.frequency):
        calculated, pair = measured.calculated[i], f"not used, largest MAC {measured.mac[i]:.3f}"
        if measured.matched[i]:
            change = 100.0 * (frequency / calculated - 1.0)
            pair = f"{calculated:.5g} Hz of the mesh ({change:+.2f} %), MAC {measured.mac[i]:.3f}"
        complexity = 100.0 * measured.complexity[i]
        phase = f", {complexity:.1f} % out of phase" if complexity >= SHOWN_COMPLEXITY else ""
        yield f"  {frequency:.5g} Hz", f"{100.0 * measured.damping[i]:.3g} %; {pair}{phase}"


def _rotation(rotation: Rotation | None) -> Iterator[Row]:
    if rotation is None:
        yield "rotation", "none: stiffness and inertia do not depend on rotation and deflection"
        return
    energy = "" if rotation.cubic is None else ", and the energy of the fourth order"
    yield (
        "rotation",
        f"r = {rotation.r}: {rotation.n_low} modes, {rotation.n_soft} soft shapes{energy}",
    )
    kappa = ", ".join(f"{value:.2g}" for value in rotation.kappa[:STIFFENED_SHAPES])
    yield "  stiffening, relative", kappa if rotation.stiffens else UNKNOWN_STIFFENING


def _kernel(kernel: Kernel) -> Iterator[Row]:
    yield "kernel step [s]", f"{kernel.h:.6g}"
    yield "kernel length [s]", f"{kernel.length:.6g}, {kernel.steps} steps"
    yield "kernel rho_inf", f"{kernel.scheme.rho_inf:.6g}"
    yield (
        "kernel error",
        f"{kernel.error:.3g}" + (f" up to {kernel.band:.5g} Hz" if kernel.band else ""),
    )
    yield "kernel n_c", str(kernel.n_c)


def _provenance(source: Provenance) -> Iterator[Row]:
    origin = "test" if source.tested else "mesh"
    yield origin, source.mesh
    yield f"{origin} SHA-256", source.mesh_sha256
    yield "method", f"{source.method}, tolerance {source.tolerance:.3g}"
    yield "versions", ", ".join(f"{name} {version}" for name, version in source.versions.items())
    yield (
        "timings [s]",
        ", ".join(f"{stage} {seconds:.3g}" for stage, seconds in source.timings.items()),
    )
