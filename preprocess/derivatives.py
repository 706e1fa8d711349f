"""Derivatives of a superelement by parameters of its body, in the basis of its modes.

    K_p = Phi^T dK/dp Phi,    M_p = Phi^T dM/dp Phi,    phi_p = d/dp (P_C P) Phi

dK/dp and all else that is assembled are central differences with three steps, extrapolated: they
are of sixth order, and matrices are polynomials or nearly so. Modes are held. Source:
docs/theory.md, Design parameters of superelements.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from ..inputs import InputError
from ..superelement import DesignDerivative, Modes
from ..superelement.checks import deviation
from ..superelement.validation import Array
from .assembly.structure import Structure, assemble_on
from .body.body import Body
from .body.derivative import Derivative, number_at, with_numbers
from .errors import BodyError, MemoryShortageError, MeshError, MethodError, PreprocessError
from .memory import require
from .mesh.mesh import Mesh
from .progress import Warn
from .responses.impulse import ImpulseResponses
from .responses.static import attachment_modes, compliance
from .sources.reading import mesh_of_body, read_source

RELATIVE_STEPS = np.array([2e-2, 1e-2, 5e-3])
"""of the scale of a parameter"""
TOLERATED_ERROR = 1e-2
"""of compliance and mass properties within the reach of a derivative"""
MAX_REACH = 0.1
"""of the scale of a parameter"""
COPIES_OF_SHAPES = 3
"""that are in memory at a time: the shapes, beside statics, and times a matrix"""
MAX_MODAL_ERROR = 1e-3
"""of the compliance by the modes, at the end of the reach, above which too many are left out"""


def design_derivatives(
    body: Body, structure: Structure, responses: ImpulseResponses, warn: Warn
) -> dict[str, DesignDerivative]:
    """The derivatives that a body file asks for, by name.

    `PreprocessError` names a derivative whose body cannot be made beside its value, and warns of
    one that the modes have not.
    """
    modes, shapes = responses.modes, responses.shapes
    if modes is None or shapes is None:
        raise MethodError("derivatives: need modes, found a method without")
    m, n = len(modes.omega), structure.n_u
    vectors = 8.0 * n * (COPIES_OF_SHAPES * m + structure.n_c)
    require({f"derivatives: {m} shapes of {n} unknowns": vectors}, "fewer modes would do")
    Phi = shapes.combined(np.eye(m))
    static = attachment_modes(structure)
    # In memory, in meters and of its order: it is read once.
    mesh = None if body.mesh is None else mesh_of_body(body, body.mesh)
    held = body.model_copy(update={"mesh": mesh, "order": 1, "derivatives": {}})
    found = {}
    for name, derivative in body.derivatives.items():
        try:
            family = _Family(held, derivative, _morph(body, mesh, derivative), structure.n_u)
            found[name] = _tangent(family, structure, modes, Phi, static)
        except MemoryShortageError:
            raise
        except InputError as error:
            raise BodyError(f"derivatives.{name}: beside the value of the body: {error}") from error
        except PreprocessError as error:
            raise type(error)(f"derivatives.{name}: {error}") from error
        if found[name].error > MAX_MODAL_ERROR:
            warn(
                f"derivatives.{name}: the modes miss {found[name].error:.1e} of the compliance at "
                "the end of its reach: more modes, or a lower tolerance, would do"
            )
    return found


@dataclass(frozen=True, eq=False)
class _Family:
    """A body by its parameter; moves (n, 3): of the points of its mesh, by a derivative of that."""

    body: Body
    derivative: Derivative
    moves: Array | None
    n_u: int

    @property
    def value(self) -> float:
        return self.derivative.value(self.body)

    @property
    def scale(self) -> float:
        return self.derivative.scale(self.body)

    def at(self, p: float) -> Structure:
        """The structure at a value of the parameter."""
        body = self.body
        if self.moves is not None:
            assert isinstance(body.mesh, Mesh)
            points = body.mesh.points + p * self.moves
            body = body.model_copy(update={"mesh": replace(body.mesh, points=points)})
        elif self.derivative.key is not None:
            body = with_numbers(body, {self.derivative.key: p})
        else:
            keys = self.derivative.keys
            body = with_numbers(body, {k: number_at(self.body, k) * p**n for k, n in keys.items()})
        made = assemble_on(body, read_source(body))
        if made.n_u != self.n_u:
            raise MeshError(f"expected {self.n_u} unknowns beside its value, found {made.n_u}")
        return made

    def samples(self) -> Iterator[tuple[float, float, Structure]]:
        """Changes of the parameter, the weights in the derivative, and the structures there."""
        squares = RELATIVE_STEPS**2
        for i, step in enumerate(RELATIVE_STEPS):
            others = np.delete(squares, i)
            weight = np.prod(others / (others - squares[i])) / (2.0 * step * self.scale)
            for side in (1.0, -1.0):
                dp = side * float(step) * self.scale
                yield dp, side * float(weight), self.at(self.value + dp)


def _morph(body: Body, mesh: Mesh | None, derivative: Derivative) -> Array | None:
    """How points move by the parameter (n, 3) [m]; `BodyError` for a mesh of other cells."""
    if derivative.mesh is None or mesh is None:
        return None
    other = mesh_of_body(body, derivative.mesh)
    same = other.points.shape == mesh.points.shape and other.cells.keys() == mesh.cells.keys()
    if not (same and all(np.array_equal(other.cells[k], mesh.cells[k]) for k in mesh.cells)):
        raise BodyError(
            f"mesh: expected the cells and the number of points of {mesh.name}, found others in "
            f"{other.name}"
        )
    return other.points - mesh.points


def _tangent(
    family: _Family, structure: Structure, modes: Modes, Phi: Array, static: Array
) -> DesignDerivative:
    """Derivatives, and how far they hold."""
    m = len(modes.omega)
    both = np.hstack([Phi, static])
    zero: Any = 0.0
    K, M, rows, mass, J, center, X = [zero] * 7
    widest: dict[float, _Figures] = {}
    for dp, weight, one in family.samples():
        K, M = K + weight * one.K, M + weight * one.M
        rows = rows + weight * (one.loads.T @ both)
        mass = mass + weight * one.rigid.mass
        J, center = J + weight * one.rigid.J_rot, center + weight * one.rigid.center
        X = X + weight * _positions(one)
        if len(widest) < 2:
            widest[dp] = _Figures.of(one)
    phi, work = rows[:, :m], rows[:, m:]
    H = structure.P_C @ static
    by_statics = _symmetric(work + work.T - static.T @ (K @ static))
    found = DesignDerivative(
        value=family.value,
        reach=MAX_REACH * family.scale,
        error=0.0,
        K=_symmetric(Phi.T @ (K @ Phi)),
        M=_symmetric(Phi.T @ (M @ Phi)),
        phi=phi,
        mass=float(mass),
        J_rot=_symmetric(J),
        center=center,
        X=X,
        compliance=by_statics,
    )
    eta = modes.phi / modes.omega**2
    by_modes = _symmetric(phi @ eta.T + eta @ phi.T - eta @ found.K @ eta.T)
    here = _Figures(H, structure.rigid.mass, structure.rigid.J_rot, _positions(structure))
    reach = _reach(found, here, widest)
    error = reach * deviation(by_modes, by_statics, np.sqrt(H.diagonal()))
    return replace(found, reach=reach, error=error)


class _Figures(NamedTuple):
    """What is to be right of a body in first order."""

    compliance: Array
    mass: float
    J_rot: Array
    X: Array

    @classmethod
    def of(cls, one: Structure) -> "_Figures":
        return cls(compliance(one), one.rigid.mass, one.rigid.J_rot, _positions(one))


def _reach(tangent: DesignDerivative, here: _Figures, widest: Mapping[float, _Figures]) -> float:
    """The change up to which the first order is right to `TOLERATED_ERROR`, but no more than now.

    By the bodies at the widest changes: its error grows with the square of the change.
    """
    scales = np.sqrt(here.compliance.diagonal())
    # Not by the positions themselves: the only interface may be at the center.
    size = np.sqrt(np.trace(here.J_rot) / here.mass)
    errors = []
    for dp, one in widest.items():
        J_rot, X = here.J_rot + dp * tangent.J_rot, here.X + dp * tangent.X
        errors += [
            deviation(one.compliance, here.compliance + dp * tangent.compliance, scales),
            abs(one.mass / (here.mass + dp * tangent.mass) - 1.0),
            float(np.abs(one.J_rot - J_rot).max() / np.abs(J_rot).max()),
            float(np.abs(one.X - X).max()) / size,
        ]
    wide = np.sqrt(TOLERATED_ERROR / max(errors)) if max(errors) > 0.0 else np.inf
    return float(min(wide * max(widest), tangent.reach))


def _positions(structure: Structure) -> Array:
    return np.array([interface.X for interface in structure.interfaces])


def _symmetric(matrix: Any) -> Array:
    return np.asarray(0.5 * (matrix + matrix.T))
