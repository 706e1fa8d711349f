"""The criteria of validity: what is measured of a run, and the limits of the method for it.

Up to `good` of its criterion a value costs about 1 % of accuracy in what it affects; beyond `limit`
a run warns of it. Sources of the limits: docs/validity.md.
"""

import math
from dataclasses import KW_ONLY, dataclass


@dataclass(frozen=True)
class Criterion:
    """A measure of validity.

    name: as in files; quantity: what is measured, in a few words; owner: the kind of object that
    has a value each, unless a check names another kind; good: the recommended range ends here;
    limit: values beyond are warned of; least: both are lower bounds, not upper ones; advice: what
    to do beyond the limit; measures: what the value is, exactly. How each is measured:
    solver/output/measures.py.
    """

    name: str
    owner: str
    quantity: str
    unit: str
    good: float
    limit: float
    advice: str
    _: KW_ONLY
    measures: str
    least: bool = False

    def verdict(self, value: float) -> str:
        """ "good", "fair", "poor" beyond the limit; "unknown" for what is no number."""
        if math.isnan(value):
            return "unknown"
        sign = -1.0 if self.least else 1.0
        if sign * value <= sign * self.good:
            return "good"
        return "fair" if sign * value <= sign * self.limit else "poor"

    def measured(self, value: float) -> str:
        """A value with its unit."""
        return f"{value:.3g} {self.unit}".rstrip()

    @property
    def explanation(self) -> str:
        """What it measures, its bounds, and what to do beyond them, in a few lines."""
        of = f", for each {self.owner}" if self.owner != "model" else ""
        return (
            f"{self.name}: {self.quantity}\n"
            f"  measures: {self.measures}\n"
            f"  recommended {self.bound(self.good)}, limit {self.bound(self.limit)}{of}\n"
            f"  beyond the limit: {self.advice}"
        )

    def bound(self, value: float) -> str:
        """A bound as tables write it, "< 0.1 rad"."""
        return f"{'>' if self.least else '<'} {self.measured(value)}"


_DIVIDE_BODY = "divide the body into several superelements"
MEND_DEFORMATION = f"{_DIVIDE_BODY}, or check loads and units"
_ADD_ROTATION = "add [rotation] to its body file, or part.rotation() in Python, with the mesh"
_CRITERIA_IN_ORDER = (
    Criterion(
        "elastic_rotation",
        "interface",
        "elastic rotation",
        "rad",
        0.1,
        0.3,
        f"elasticity is linear: {MEND_DEFORMATION}",
        measures=(
            "the largest elastic rotation of an interface in the floating frame, of a body "
            "without terms of second order"
        ),
    ),
    Criterion(
        "elastic_displacement",
        "interface",
        "elastic displacement / body size",
        "",
        0.015,
        0.045,
        f"elasticity is linear: {MEND_DEFORMATION}",
        measures=(
            "the largest elastic displacement of an interface over the size of its body, of "
            "a body without terms of second order"
        ),
    ),
    Criterion(
        "second_order_rotation",
        "interface",
        "elastic rotation, second-order body",
        "rad",
        0.2,
        0.4,
        f"elasticity is of second order: {MEND_DEFORMATION}",
        measures=(
            "the largest elastic rotation of an interface in the floating frame, of a body "
            "with terms of second order"
        ),
    ),
    Criterion(
        "second_order_displacement",
        "interface",
        "elastic displacement / body size, second-order body",
        "",
        0.03,
        0.06,
        f"elasticity is of second order: {MEND_DEFORMATION}",
        measures=(
            "the largest elastic displacement of an interface over the size of its body, of "
            "a body with terms of second order"
        ),
    ),
    Criterion(
        "axial_load",
        "body",
        "axial force / Euler load",
        "",
        0.02,
        0.05,
        "the force changes its bending stiffness, which linear elasticity does not see, nor "
        f"buckling: {_ADD_ROTATION}",
        measures=(
            "the largest mean axial force, tension or compression, over Euler's load of the "
            "body hinged at both ends; blows count by their impulse"
        ),
    ),
    Criterion(
        "spin",
        "body",
        "spin / first elastic frequency",
        "",
        0.03,
        0.05,
        f"centrifugal stiffening is missing: {_ADD_ROTATION}",
        measures=(
            "the largest angular velocity of a body without terms of second order over its "
            "first frequency when free"
        ),
    ),
    Criterion(
        "missing_stress",
        "body",
        "centrifugal stress not computed",
        "Pa",
        1e5,
        1e6,
        f"its stresses and strains do not include those of spin: {_ADD_ROTATION}",
        measures=(
            "an estimate of the centrifugal stress that is not computed, rho Omega^2 r^2 "
            "with the mean density and the farthest point"
        ),
    ),
    Criterion(
        "spin_turn",
        "body",
        "rotation per step, second-order body",
        "rad",
        0.12,
        0.15,
        "its motion may become unstable: take a smaller step or rho_inf in [simulation]",
        measures="the largest turn in a step of a body with terms of second order",
    ),
    Criterion(
        "inertia_taken",
        "body",
        "inertia lost to elastic motion / inertia",
        "",
        0.5,
        0.9,
        f"nothing resists its rotation where all is lost: {_DIVIDE_BODY}",
        measures=(
            "the part of a moment of inertia that the elastic motion of a body with terms of "
            "second order takes"
        ),
    ),
    Criterion(
        "joint_turn",
        "jointed body",
        "rotation per step / joint limit",
        "",
        0.8,
        1.0,
        "forces of its joints may alternate and grow: take a smaller step or rho_inf in "
        "[simulation]",
        measures=(
            "the largest turn in a step of a body on joints over 0.7 (1 - rho_inf) rad, if a "
            "joint is off the axis of its spin"
        ),
    ),
    Criterion(
        "angular_momentum",
        "free body",
        "angular momentum error",
        "",
        5e-3,
        2e-2,
        "its rotation is not resolved by the step: take a smaller step in [simulation]",
        measures=(
            "the part of the angular momentum of a body that nothing holds, over its "
            "largest, that the moments on it do not explain"
        ),
    ),
    Criterion(
        "steps_per_period",
        "body",
        "time steps per period of the fastest vibration",
        "",
        20.0,
        8.0,
        "its period is wrong by several per cent: take a smaller step in [simulation]",
        least=True,
        measures=(
            "time steps per period of the highest frequency that carries energy, of the "
            "body's vibration and of its motion as a whole"
        ),
    ),
    Criterion(
        "kernel_error",
        "body",
        "error of impulse responses",
        "",
        0.01,
        0.05,
        "request a smaller error or more modes in the body file, or a longer memory",
        measures="the error that the superelement of a body states, and that of a memory cut off",
    ),
    Criterion(
        "test_misfit",
        "body",
        "misfit to the test of the body",
        "",
        0.1,
        0.3,
        "see `duhamel preprocess --dry-run` for the worst channels and hits",
        measures=(
            "the difference of the responses of a part that is known from its test alone from "
            "those that were measured, noise included"
        ),
    ),
    Criterion(
        "kernel_band",
        "body",
        "fastest vibration / band of the superelement",
        "",
        0.8,
        1.0,
        "make the superelement anew, with a smaller step or a wider band in [impulse]",
        measures=(
            "the highest frequency that carries energy over the one up to which the "
            "superelement is right"
        ),
    ),
    Criterion(
        "energy_balance",
        "model",
        "energy balance error / total energy",
        "",
        1e-3,
        1e-2,
        "take a smaller step in [simulation]",
        measures="the largest error of the energy balance over the energy that moves",
    ),
    Criterion(
        "created_energy",
        "spring",
        "energy created by the force law / total energy",
        "",
        1e-3,
        1e-2,
        "the step is too large for so stiff a law: take a smaller step in [simulation]",
        measures="what a law gave back of what it took, over the energy that moves",
    ),
    Criterion(
        "contact_steps",
        "contact",
        "time steps of the shortest contact",
        "",
        40.0,
        20.0,
        "peak forces need 20 for 1 %: take a smaller step in [simulation]",
        least=True,
        measures=(
            "steps of the shortest contact from closing to opening, of those whose peak is 5 "
            "% of the largest or more; with a restitution e below 0.46 times 2 e^0.9"
        ),
    ),
    Criterion(
        "surface_steps",
        "contact",
        "time steps of the shortest contact of surfaces",
        "",
        20.0,
        8.0,
        "take a smaller step in [simulation], and a superelement with a band for it",
        least=True,
        measures=(
            "steps of the shortest contact of surfaces from closing to opening, of those whose "
            "peak is 5 % of the largest or more"
        ),
    ),
    Criterion(
        "set_changes",
        "model",
        "energy by closing and opening of rows / total energy",
        "",
        1e-2,
        1e-1,
        "rows of contacts of surfaces close and open within steps: take a smaller step in "
        "[simulation]",
        measures=(
            "the work that forces of contacts of surfaces do on gaps which close or open within a "
            "step, where exact contacts do none, over the energy that moves"
        ),
    ),
    Criterion(
        "contact_arm",
        "contact",
        "distance of the contact force from its frame / body size",
        "",
        0.1,
        0.2,
        "the body does not bend between the frame and the contact: attach the contact to a nearer "
        "interface",
        measures=(
            "the largest arm of the normal force about the interface that carries the shape, "
            "over the size of the body"
        ),
    ),
    Criterion(
        "contact_depth",
        "contact",
        "penetration / ball radius",
        "",
        0.3,
        1.0,
        "the center of the ball is beyond the surface: take a stiffer contact, a smaller step in "
        "[simulation] or a larger ball",
        measures="the largest penetration over the radius of the ball",
    ),
    Criterion(
        "hertz_radius",
        "contact",
        "contact patch semi-axis / surface radius",
        "",
        0.17,
        1.0 / 3.0,
        "Hertz's law holds for small patches: give a table, `law`",
        measures=(
            "the largest semi-axis of the patch over the smaller radius of the surfaces along it"
        ),
    ),
    Criterion(
        "numerical_dissipation",
        "model",
        "numerical dissipation / total energy",
        "",
        1e-2,
        1e-1,
        "take a smaller step, or rho_inf nearer to 1, in [simulation]",
        measures="energy that time stepping dissipates in the modes, over the energy that moves",
    ),
    Criterion(
        "joint_opening",
        "joint",
        "joint constraint violation, rad or / model size",
        "",
        1e-8,
        1e-6,
        "take a smaller tolerance or more max_iterations in [simulation]",
        measures=(
            "by how much the constraints of a joint are open: angles in rad, lengths over "
            "the size of the model"
        ),
    ),
    Criterion(
        "force_noise",
        "joint",
        "rounding of its force / largest force",
        "",
        1e-2,
        1e-1,
        "forces of joints are rounding of positions over the square of the step: take a larger "
        "step, a smaller rho_inf, or an origin nearer to the model",
        measures=(
            "an estimate of what the rounding of positions makes of the force of a joint, over the "
            "largest force of all joints, or the energy that moves over the size of the model if "
            "that is more"
        ),
    ),
    Criterion(
        "motor_steps",
        "motor",
        "time steps per period of the servo, at the start",
        "",
        20.0,
        8.0,
        "the servo is too fast for the step: take smaller gains, or a smaller step in [simulation]",
        least=True,
        measures=(
            "time steps in a period of the fastest pole of the servo's loop at the start, "
            "all bodies rigid"
        ),
    ),
    Criterion(
        "missed_turn",
        "angle",
        "joint angle increment minus rate prediction",
        "rad",
        0.25 * math.pi,
        0.5 * math.pi,
        "its full turns may be miscounted: take a smaller step in [simulation]",
        measures="by how much the rate of an angle missed it over a step",
    ),
)
# By name, in the order of the tables.
CRITERIA = {criterion.name: criterion for criterion in _CRITERIA_IN_ORDER}
