"""Superelements at other parameters than those of their files, without a rebuild."""

from collections.abc import Callable, Mapping
from dataclasses import replace

from .design import design_arrays
from .scaling import scale_arrays
from .superelement import Superelement, SuperelementVariation
from .validation import SuperelementError, check_positive

SCALE_FACTORS = ("stiffness", "density", "damping")


def scaled(
    superelement: Superelement,
    *,
    stiffness: float = 1.0,
    density: float = 1.0,
    damping: float = 1.0,
) -> Superelement:
    """The superelement of the same body with all its stiffness, mass or damping multiplied.

        K -> stiffness K,   M -> density M,   loss factor, zeta or Rayleigh's C -> damping times it

    That is exact: every number is that of a rebuild with other moduli or another density, to
    rounding. Modes that a method has chosen for a band stay the same, and are right to a band that
    moves with their frequencies. The kernel of a body with modes has its first lags only.

    Parameters
    ----------
    superelement : Superelement
        One that was scaled already is scaled on.
    stiffness : float
        Of all moduli of all materials and sections, or of a given stiffness matrix. At a fixed
        Poisson's ratio that is Young's modulus.
    density : float
        Of all materials and sections, or of a given mass matrix.
    damping : float
        Of the loss factor of a material, 0 to 1; of all modal ratios; or of both coefficients of
        Rayleigh's damping. What is undamped stays so.

    Returns
    -------
    Superelement
        With a `variation` that says what it was made from.

    Raises
    ------
    SuperelementError
        For factors that are not positive, and bodies for which the superelement does not hold what
        is needed: those of tests or updated by one; point masses, which no density has; a kernel
        without modes, whose step would change; ratios over frequency, which are not Rayleigh's;
        loss factors of several materials.

    Examples
    --------
    A beam of steel as one of aluminum:

    >>> import duhamel as du
    >>> steel = du.Material(E=210e9, nu=0.3, rho=7800.0)
    >>> section = du.Section.rectangle(steel, 0.02, 0.01, orientation=(0.0, 1.0, 0.0))
    >>> beam = du.Beam([(0.0, 0.0, 0.0), (0.5, 0.0, 0.0), (1.0, 0.0, 0.0)], section=section)
    >>> beam.interface("tip", (1.0, 0.0, 0.0))
    >>> element = beam.superelement(step=1e-4)
    >>> lighter = scaled(element, stiffness=1 / 3, density=1 / 3)
    >>> ratio = lighter.modes.omega / element.modes.omega
    >>> round(lighter.mass / element.mass, 9), round(float(ratio.min()), 9)
    (0.333333333, 1.0)
    >>> dict(scaled(lighter, density=3.0).variation.scale)
    {'stiffness': 0.3333333333333333, 'density': 1.0, 'damping': 1.0}
    """
    before = {} if superelement.variation is None else superelement.variation.scale
    factors = {"stiffness": stiffness, "density": density, "damping": damping}
    scale = {key: factor * before.get(key, 1.0) for key, factor in factors.items()}
    design = {} if superelement.variation is None else superelement.variation.design
    return _varied(superelement.base, design, scale)


def redesigned(superelement: Superelement, values: Mapping[str, float]) -> Superelement:
    """The superelement at other values of its design parameters, to first order.

        K(p) = diag(omega^2) + sum dp K_p,   M(p) = 1 + sum dp M_p,   phi(p) = phi + sum dp phi_p

    in the basis of its modes, from which the new modes follow. It has exact derivatives by p, and
    is for them: beyond the reach of a derivative it is refused. Fields are left out.

    Parameters
    ----------
    superelement : Superelement
        One whose body file has [derivatives].
    values : mapping of float
        Values of parameters by the names of their derivatives; others stay.

    Returns
    -------
    Superelement
        With a `variation` that says what it was made from.

    Raises
    ------
    SuperelementError
        For names that have no derivative, and values out of reach. Source: docs/theory.md, Design
        parameters of superelements.

    Examples
    --------
    >>> import duhamel as du
    >>> steel = du.Material(E=210e9, nu=0.3, rho=7800.0)
    >>> section = du.Section.rectangle(steel, 0.02, 0.01, orientation=(0.0, 1.0, 0.0))
    >>> beam = du.Beam([(0.0, 0.0, 0.0), (0.5, 0.0, 0.0), (1.0, 0.0, 0.0)], section=section)
    >>> beam.interface("tip", (1.0, 0.0, 0.0))
    >>> beam.derivative("bending", key="section.EI_z")
    >>> element = beam.superelement(step=1e-4)
    >>> stiffer = redesigned(element, {"bending": 1.001 * section.EI_z})
    >>> rotation = element.rows("tip").start + 5
    >>> change = stiffer.compliance[rotation, rotation] / element.compliance[rotation, rotation]
    >>> round(float(change), 6)
    0.999001
    """
    before = superelement.variation
    design = {**({} if before is None else before.design), **values}
    return _varied(superelement.base, design, {} if before is None else before.scale)


def with_parameters(base: Superelement, tables: Mapping[str, Mapping[str, float]]) -> Superelement:
    """The superelement of a file at the parameters that a body of a model has.

    Parameters
    ----------
    base : Superelement
    tables : mapping
        As `SuperelementVariation.tables`: "scale" and "design", by key.

    Returns
    -------
    Superelement
        Itself without any. See `scaled` and `redesigned` for an example.

    Raises
    ------
    SuperelementError
        As they do.
    """
    return _varied(base, tables.get("design", {}), tables.get("scale", {}))


def _varied(
    base: Superelement, design: Mapping[str, float], scale: Mapping[str, float]
) -> Superelement:
    for key, factor in scale.items():
        check_positive(f"scale: {key}", factor)
    found = base
    if design:
        found = _named("design", lambda: design_arrays(base, design))
    if any(factor != 1.0 for factor in scale.values()):
        factors = dict.fromkeys(SCALE_FACTORS, 1.0) | dict(scale)
        found = _named("scale", lambda: scale_arrays(found, factors))
    if found is base:
        return base
    variation = SuperelementVariation(base, scale, design)
    provenance = replace(base.provenance, method=f"{base.provenance.method}, {variation}")
    return replace(found, provenance=provenance, variation=variation)


def _named(table: str, make: Callable[[], Superelement]) -> Superelement:
    """What is made, with the table of a body in its errors."""
    try:
        return make()
    except SuperelementError as error:
        raise SuperelementError(f"{table}: {error}") from error
