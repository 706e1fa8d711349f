"""Changes of inertia, foreshortening and geometric stiffness of a body, in the coordinates q."""

import numpy as np
import scipy.sparse as sp

from ...superelement import Modes, Rotation
from ...superelement.rotation import N_INERTIA_CHANGES
from ...superelement.validation import Array
from ..assembly.rigid import relieve
from ..assembly.second_order import SecondOrder
from ..assembly.structure import Structure
from ..body.body import NonlinearCoordinates
from ..mesh.mesh import NO_NODES, IntArray
from ..responses.shapes import Shapes
from ..responses.static import refined, static_solver
from ..responses.surfaces import COLUMNS_AT_ONCE
from ..solving.factor import Solve
from .coordinates import Coordinates, choose, lowest
from .statics import Statics, Stiffening, statics


def reduced_rotation(
    structure: Structure,
    second: SecondOrder,
    modes: Modes,
    shapes: Shapes,
    asked: NonlinearCoordinates,
) -> Rotation:
    """The second order of a structure with loads of rotation, in coordinates q of its modes.

    What comes from stress is on the projections by stiffness, what comes from inertia on those by
    mass: one of them for both makes a body that bends far lose its positive inertia, or its
    accuracy. Where the strain energy is unknown, only inertia, and how interfaces are measured, are
    of second order. Source: docs/theory.md, Fast rotation.
    """
    fields = statics(structure) if second.elements.strain_energy else None
    q = _chosen(second, fields, modes, shapes, asked)
    Psi = shapes.combined(q.Y)
    # Of interfaces and of the six changes of inertia, which respond to the same stress.
    stress = _foreshortening(second, fields, Psi, q.squares)
    n_c, nodes = len(modes.phi), _of_surfaces(structure, second, Psi, q.squares)
    cubic, quartic = (
        _energy(structure, second, Psi, q.squares) if asked.level == 2 else (None, None)
    )
    return Rotation(
        phi_inertia=shapes(sp.csr_array(structure.inertia_loads.T)),
        T=q.projections(modes.omega),
        A_interface=q.placed(stress[:n_c], q.by_stiffness),
        A_inertia=q.placed(stress[n_c:], q.by_stiffness)
        + q.placed(_symmetric(second.inertia(Psi)), q.by_mass),
        gyroscopic=q.placed(second.gyroscopic(Psi), q.by_mass),
        A_surface=None if nodes is None else q.placed(nodes, q.by_stiffness),
        kappa=q.kappa,
        n_low=q.n_low,
        cubic=cubic,
        quartic=quartic,
    )


def _chosen(
    second: SecondOrder,
    fields: Statics | None,
    modes: Modes,
    shapes: Shapes,
    asked: NonlinearCoordinates,
) -> Coordinates:
    """The coordinates that loads stiffen most; without the fields of loads, the softest."""
    loaded = _loaded(second.structure, asked)
    if fields is None:
        return lowest(modes, asked, loaded)
    return choose(modes, asked, loaded, Stiffening(fields, second, shapes))


def _loaded(structure: Structure, asked: NonlinearCoordinates) -> IntArray:
    """The rows of the interfaces whose loads soft shapes are made for."""
    rows, start = [NO_NODES], 0
    for interface in structure.interfaces:
        if asked.loaded is None or interface.name in asked.loaded:
            rows.append(np.arange(start, start + interface.n_dofs))
        start += interface.n_dofs
    return np.concatenate(rows)


def _foreshortening(
    second: SecondOrder, fields: Statics | None, Psi: Array, squares: Array
) -> Array:
    """A (n_c + 6, n, n): the second derivative of interfaces and inertia by shapes Psi (n_u, n).

        A_c = -D3(u_c; Psi, Psi),   u_c = K_w^+ f_c,   K_w^+ = K^+ - Psi (Psi^T K Psi)^-1 Psi^T

    and of averaged interfaces what their own measure adds, which is all that is known without
    fields. The same numbers, times a load, are the stiffness that its stress takes away. K_w^+ and
    not K^+: stress that the shapes carry themselves counts once.
    """
    own = second.interfaces(Psi)
    A = np.concatenate([own, np.zeros((N_INERTIA_CHANGES, *own.shape[1:]))])
    if fields is not None:
        u = fields.u - Psi @ ((Psi.T @ fields.f) / squares[:, None])
        A -= second.third(u, Psi)
    return _symmetric(A)


def _of_surfaces(
    structure: Structure, second: SecondOrder, Psi: Array, squares: Array
) -> Array | None:
    """As `_foreshortening`, of the displacements (3 n, n, n) of the nodes of surfaces."""
    if structure.surfaces is None:
        return None
    rows = structure.surfaces.rows
    A = second.nodes(rows, Psi)
    if second.elements.strain_energy:
        solve = static_solver(structure)
        # In panels, as their compliance: the fields of all nodes take more memory than the factor.
        for start in range(0, len(A), COLUMNS_AT_ONCE):
            some = slice(start, start + COLUMNS_AT_ONCE)
            A[some] -= second.third(
                _rest(structure, solve, rows[some].T.toarray(), Psi, squares), Psi
            )
    return _symmetric(A)


def _rest(structure: Structure, solve: Solve, f: Array, Psi: Array, squares: Array) -> Array:
    """K_w^+ P^T f, for loads (n_u, k)."""
    balanced = relieve(f, structure.U, structure.M)
    u = refined(structure, solve, balanced)
    return np.asarray(u - Psi @ ((Psi.T @ balanced) / squares[:, None]))


def _energy(
    structure: Structure, second: SecondOrder, Psi: Array, squares: Array
) -> tuple[Array, Array]:
    """cubic (n, n, n) and quartic (n, n, n, n): with both, the strain energy is never negative."""
    solve = static_solver(structure)
    return second.cubic(Psi), second.quartic(
        Psi, lambda f: _rest(structure, solve, f, Psi, squares)
    )


def _symmetric(A: Array) -> Array:
    """A (k, n, n), of each matrix the mean with its transpose."""
    return np.asarray(0.5 * (A + A.transpose(0, 2, 1)))
