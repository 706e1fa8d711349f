"""The damping of a body file: none, of modes, Rayleigh's, or of the material."""

from itertools import pairwise
from typing import Annotated, Any

import numpy as np
from pydantic import BeforeValidator, Field, NonNegativeFloat, PositiveFloat

from ...inputs import Also, Table, rule
from ...superelement import Chain
from ...superelement.chain import LARGEST_LOSS
from ...superelement.relaxation import MAX_ELEMENTS, MAX_LOSS_RIPPLE, fit

MAX_BAND_RATIO = 1e9  # of the ends of a band
LossFactor = Annotated[float, Field(ge=0.0, le=LARGEST_LOSS)]


class Ratios(Table):
    """Modal damping ratios over frequency [Hz]: linear between the points, constant outside."""

    frequencies: tuple[NonNegativeFloat, ...]
    ratios: tuple[NonNegativeFloat, ...]

    @rule
    def _a_table(self) -> None:
        if len(self.frequencies) != len(self.ratios) or not self.frequencies:
            raise ValueError(
                "expected a ratio for every frequency, "
                f"found {len(self.frequencies)} frequencies and {len(self.ratios)} ratios"
            )
        if any(b <= a for a, b in pairwise(self.frequencies)):
            raise ValueError(
                f"frequencies: expected increasing values, found {list(self.frequencies)}"
            )


Two = tuple[PositiveFloat, PositiveFloat]


class Rayleigh(Table):
    """C = mass M + stiffness K, with `mass` [1/s] and `stiffness` [s].

    Or from the ratios at two frequencies [Hz]: zeta = (mass / omega + stiffness omega) / 2.
    """

    mass: NonNegativeFloat = 0.0
    stiffness: NonNegativeFloat = 0.0
    frequencies: Two | None = None
    ratios: Two | None = None

    @rule
    def _one_form(self) -> None:
        given = self.model_fields_set
        if given & {"mass", "stiffness"} and given & {"frequencies", "ratios"}:
            raise ValueError(
                "expected mass and stiffness, or frequencies and ratios, found both forms"
            )
        if (self.frequencies is None) != (self.ratios is None):
            raise ValueError("expected frequencies and ratios together, found one of them")
        if self.frequencies is not None and self.frequencies[0] >= self.frequencies[1]:
            raise ValueError(
                f"frequencies: expected increasing values, found {list(self.frequencies)}"
            )
        # A negative coefficient feeds energy into modes outside of the two frequencies.
        if min(self.coefficients) < 0.0 and self.frequencies is not None:
            low, high = self.frequencies
            assert self.ratios is not None
            raise ValueError(
                f"ratios: expected the second {low / high:.4g} to {high / low:.4g} times the "
                f"first, that neither coefficient is negative, found {list(self.ratios)}"
            )

    @property
    def coefficients(self) -> tuple[float, float]:
        """Those of M [1/s] and of K [s]."""
        if self.frequencies is None or self.ratios is None:
            return self.mass, self.stiffness
        (a, b), (low, high) = self.ratios, (2.0 * np.pi * f for f in self.frequencies)
        span = high * high - low * low
        mass = 2.0 * low * high * (a * high - b * low) / span
        return mass, 2.0 * (b * high - a * low) / span


def _as_table(value: Any) -> Any:
    """One ratio is a table of one point."""
    return {"frequencies": [0.0], "ratios": [value]} if isinstance(value, int | float) else value


class Damping(Table):
    """None, a ratio for every mode of the free body, Rayleigh's, or a loss factor of the material.

    modal: zeta f / f_free of it is left to a mode that joints or clamps have brought from f_free
    down to f. loss_factor, that of all frequencies in `band` [Hz], is left whatever holds the body:
    every mode has the ratio loss_factor / 2. A material that loses energy stiffens with frequency:
    the moduli of the body file are those at rest, or those at reference_frequency [Hz].
    """

    modal: Annotated[Ratios | None, BeforeValidator(_as_table), Also(float)] = None
    rayleigh: Rayleigh | None = None
    loss_factor: LossFactor | None = None
    band: tuple[PositiveFloat, PositiveFloat] | None = None
    reference_frequency: NonNegativeFloat | None = None

    @rule
    def _one_kind(self) -> None:
        found = list(self.given("modal", "rayleigh", "loss_factor"))
        if len(found) > 1:
            raise ValueError(
                f"expected one of modal, rayleigh and loss_factor, found {' and '.join(found)}"
            )
        if self.band is None and (self.loss_factor or self.reference_frequency is not None):
            raise ValueError(
                "band: missing, the lowest and the highest frequency [Hz] of the loss factor"
            )
        if self.band is not None and found in (["modal"], ["rayleigh"]):
            raise ValueError(f"band: belongs to loss_factor, found it with {found[0]}")

    @rule
    def _can_be_fitted(self) -> None:
        if self.band is None:
            return
        low, high = self.band
        if not 1.0 < high / low <= MAX_BAND_RATIO:
            raise ValueError(
                f"band: expected two increasing frequencies, the second {MAX_BAND_RATIO:g} times "
                f"the first at most, found {[low, high]}"
            )
        check_fit(self.loss_factor or 0.0, self.band)

    @property
    def reference(self) -> float:
        """The frequency [Hz] at which moduli are those of the body file; 0: at rest."""
        return self.reference_frequency or 0.0

    @property
    def chain(self) -> Chain | None:
        """The Maxwell elements of the loss factor; None without one."""
        if not self.loss_factor or self.band is None:
            return None
        found = fit(self.loss_factor, self.band)
        assert found is not None
        ends = found.tau, found.amplitude, self.loss_factor, self.band
        return Chain(*ends, self.reference, found.ripple)


def check_fit(loss_factor: float, band: tuple[float, float]) -> None:
    """ValueError for a loss factor that no chain keeps over the band."""
    if loss_factor and fit(loss_factor, band) is None:
        raise ValueError(
            f"band: a loss factor of {loss_factor:g} from {band[0]:g} to {band[1]:g} Hz takes more "
            f"than {MAX_ELEMENTS} Maxwell elements to {MAX_LOSS_RIPPLE:.0%}: expected a "
            "narrower band"
        )
