"""The step size and the scheme of a run: given by the settings, or common to the superelements."""

import numpy as np

from ...superelement import GeneralizedAlpha, Superelement
from ..errors import ModelError
from ..history.layout import Horizon, Stepping
from ..model.bodies import RigidSuperelement
from ..model.model import Model
from ..step.records.scheme import Newton, Scheme

MOST_STEPS = 1e15
"""of a run: they are counted, and times are multiples of the step, in double precision"""
# of a step that is a whole fraction of another: decimal numbers are rounded
WHOLE_FRACTION_TOLERANCE = 1e-9
# ratio of successive corrections above which the matrix is made anew: the cheapest in trials
MAX_CONTRACTION = 1e-2
LARGEST_WITH_CONSTRAINTS = 0.99
"""rho_inf up to which multipliers forget their rounding: they carry it on as k^2 rho_inf^k"""


def stepping_of(model: Model, earlier: Horizon | None = None) -> Stepping:
    """Step size, scheme, number of steps and weight of the convolution.

    earlier: the horizon of the run that this one continues. `ModelError` for superelements that
    differ in step or scheme where the settings give none, and for a scheme under which constraint
    forces grow without bound.
    """
    settings = model.settings
    kernels = {name: element.kernel for name, element in _superelements(model).items()}
    steps = {name: kernel.h for name, kernel in kernels.items()}
    radii = {name: kernel.scheme.rho_inf for name, kernel in kernels.items()}
    h = _chosen_or_common("step", settings.step, steps)
    rho_inf = _chosen_or_common("rho_inf", settings.rho_inf, radii, default=0.9)
    _check_damps_multipliers(model, rho_inf)
    shortest = min(h, settings.contact_step or h)
    if not settings.t_end / shortest < MOST_STEPS:
        raise ModelError(
            f"simulation: t_end: expected less than {MOST_STEPS:g} steps, got {settings.t_end:g} s "
            f"in steps of {shortest:g} s"
        )
    ratio = _ratio(model, h)
    n_steps = ratio * round_up(settings.t_end / h)
    return Stepping(
        h=h / ratio,
        scheme=GeneralizedAlpha(rho_inf),
        # A kernel is cut at the end of a run: one that goes on needs those of the longer run.
        n_steps=max(n_steps, earlier.steps if earlier else 0),
        weight=1.0 if settings.rule == "consistent" else 0.5,
        planned=earlier.planned if earlier else n_steps,
        ratio=ratio,
    )


def _superelements(model: Model) -> dict[str, Superelement]:
    """The superelements whose step and scheme count: of flexible bodies, else of rigid ones.

    So that a model keeps its step where its only flexible body is made rigid.
    """
    flexible = {name: body.superelement for name, body in model.flexible_bodies.items()}
    return flexible or {
        name: body.superelement
        for name, body in model.bodies.items()
        if isinstance(body, RigidSuperelement)
    }


def _ratio(model: Model, h: float) -> int:
    """Steps in contact to a step h in flight; 1 where all are the same."""
    short = model.settings.contact_step
    if short is None:
        return 1
    if not (model.contacts or model.stops or model.surface_contacts):
        raise ModelError("simulation: contact_step: the model has no contacts or stops")
    ratio = round(h / short)
    if ratio < 2 or abs(ratio * short - h) > WHOLE_FRACTION_TOLERANCE * h:
        raise ModelError(
            "simulation: contact_step: expected a half, a third, or another whole fraction of the "
            f"step, {h:.9g} s, got {short:.9g}; the nearest is {h / max(ratio, 2):.9g}"
        )
    return ratio


def round_up(steps: float) -> int:
    """A whole number of steps; one that is whole to rounding stays."""
    return int(np.ceil(steps - 1e-6))


def lay_out_scheme(stepping: Stepping) -> Scheme:
    h, scheme = stepping.h, stepping.scheme
    return Scheme(
        h=h,
        alpha_m=scheme.alpha_m,
        alpha_f=scheme.alpha_f,
        beta=scheme.beta,
        gamma=scheme.gamma,
        beta_prime=scheme.beta_prime(h),
        gamma_prime=scheme.gamma_prime(h),
        inertia_ratio=scheme.inertia_ratio,
        weight=stepping.weight,
        stride=stepping.stride,
        ratio=stepping.ratio,
    )


def lay_out_newton(model: Model) -> Newton:
    fixed_iterations = model.settings.fixed_iterations
    return Newton(
        tolerance=model.settings.tolerance,
        max_iterations=model.settings.max_iterations,
        fixed_iterations=fixed_iterations or 0,
        reuse=np.inf if fixed_iterations else MAX_CONTRACTION,
    )


def _check_damps_multipliers(model: Model, rho_inf: float) -> None:
    """ModelError for a model with constraints and next to no numerical dissipation."""
    constrained = next((c.owner for c in (*model.joints, *model.motions)), None)
    if constrained and rho_inf > LARGEST_WITH_CONSTRAINTS:
        raise ModelError(
            f"simulation: rho_inf: expected at most {LARGEST_WITH_CONSTRAINTS} in a model with "
            f"joints or motions ({constrained}), whose forces would grow from rounding, "
            f"got {rho_inf:.9g}"
        )


def _chosen_or_common(
    key: str, chosen: float | None, stored: dict[str, float], default: float | None = None
) -> float:
    """The value of a setting, or the one that all superelements share; `stored`: theirs by body."""
    if chosen is not None:
        return chosen
    values = sorted(set(stored.values()))
    if len(values) == 1:
        return values[0]
    if not values and default is not None:
        return default
    if not values:
        raise ModelError(f"simulation: {key}: required in a model without superelements")
    listed = ", ".join(f"{name}: {value}" for name, value in stored.items())
    raise ModelError(
        f"simulation: {key}: the superelements differ ({listed}), so the model must give one"
    )
