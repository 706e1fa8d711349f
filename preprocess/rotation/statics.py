"""Fields at rest under loads on interfaces and loads of rotation, and what their stress does."""

from dataclasses import dataclass

import numpy as np

from ...superelement.validation import Array
from ..assembly.second_order import SecondOrder
from ..assembly.structure import Structure
from ..responses.static import static_shapes

NOTHING = 1e-8
"""Size of a field, relative to the largest of its kind, that is rounding: its strain energy is the
square.
"""


@dataclass(frozen=True, eq=False)
class Statics:
    """u = P K^+ P^T f (n_u, n_c + 6) under unit loads f = [P_C^T, F] (n_u, n_c + 6).

    scale (n_c + 6,): the square root of twice the strain energy of each; infinite where only
    rounding is.
    """

    f: Array
    u: Array
    scale: Array

    def stiffening(self, second: SecondOrder, Psi: Array, squares: Array) -> Array:
        """kappa (n,) of shapes Psi (n_u, n) with squared frequencies (n,), in 1/sqrt(J).

            kappa_k = max_c |D3(u_c; psi_k, psi_k)| / (omega_k^2 sqrt(u_c^T K u_c))

        The most by which a load changes the stiffness of a shape, relative to that, for the energy
        that it stores: so forces, moments and rotations compare.
        """
        stiffness = np.abs(np.diagonal(second.third(self.u, Psi), axis1=1, axis2=2))
        kappa: Array = (stiffness / self.scale[:, None]).max(axis=0) / squares
        return kappa


def statics(structure: Structure) -> Statics:
    """The fields of a structure with loads of rotation."""
    f = np.hstack([structure.loads, structure.inertia_loads])
    u = static_shapes(structure)
    energy = np.einsum("ik,ik->k", f, u)
    scale = np.sqrt(np.maximum(energy, 0.0))
    n_c = structure.P_C.shape[0]
    for kind in (slice(n_c), slice(n_c, None)):
        scale[kind][scale[kind] <= NOTHING * scale[kind].max(initial=0.0)] = np.inf
    return Statics(f, u, scale)
