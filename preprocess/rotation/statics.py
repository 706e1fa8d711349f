"""Fields at rest under loads on interfaces and loads of rotation, and what their stress does."""

from dataclasses import dataclass

import numpy as np

from ...superelement.validation import Array
from ..assembly.second_order import SecondOrder
from ..assembly.structure import Structure
from ..responses.static import static_shapes


@dataclass(frozen=True, eq=False)
class Statics:
    """u = P K^+ P^T f (n_u, n_c + 6) under unit loads f = [P_C^T, F] (n_u, n_c + 6).

    scale (n_c + 6,): the root of u^T K u; for all six loads of rotation, which come together, that
    of the softest.
    """

    f: Array
    u: Array
    scale: Array

    def stiffening(self, second: SecondOrder, Psi: Array, squares: Array) -> Array:
        """kappa (n,) [1/sqrt(J)] of shapes Psi (n_u, n) with squared frequencies (n,).

            kappa_k = max_c |D3(u_c; psi_k, psi_k)| / (omega_k^2 scale_c)

        The most by which a load changes the stiffness of a shape, relative to that, for the energy
        that it stores: so forces, moments and rotation compare.
        """
        stiffness = np.abs(np.diagonal(second.third(self.u, Psi), axis1=1, axis2=2))
        kappa: Array = (stiffness / self.scale[:, None]).max(axis=0) / squares
        return kappa


def statics(structure: Structure) -> Statics:
    """The fields of a structure with loads of rotation."""
    f = np.hstack([structure.loads, structure.inertia_loads])
    u = static_shapes(structure)
    scale = np.sqrt(np.einsum("ik,ik->k", f, u))
    rotation = slice(structure.P_C.shape[0], None)
    scale[rotation] = scale[rotation].max()
    return Statics(f, u, scale)
