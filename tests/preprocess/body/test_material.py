"""Orthotropic materials: closed forms of the elasticity matrix, stresses of turned bars, and what
no material is.
"""

import numpy as np
import pytest
from duhamel.preprocess import assemble
from duhamel.preprocess.body.material import STRESS_ORDER, Material
from pydantic import ValidationError

STEEL = {"E": 2.1e11, "nu": 0.3, "rho": 7800.0}
WOOD = {"E": [12e9, 0.9e9, 0.5e9], "nu": [0.4, 0.5, 0.7], "G": [0.8e9, 0.7e9, 0.05e9], "rho": 450.0}
TURNED = {"axes": [[1.0, 2.0, 0.5], [-1.0, 1.0, 0.0]]}


def along(angle):
    """E in the plane of directions 1 and 2, at an angle from 1: 1/E = c^4/E1 + s^4/E2 + (1/G12 - 2
    nu12/E1) c^2 s^2.
    """
    E, nu, G = WOOD["E"], WOOD["nu"], WOOD["G"]
    c, s = np.cos(angle), np.sin(angle)
    return 1.0 / (c**4 / E[0] + s**4 / E[1] + (1.0 / G[0] - 2.0 * nu[0] / E[0]) * (c * s) ** 2)


def turned(angle):
    """Direction 1 below the x axis by an angle, so that x lies at that angle from it."""
    return WOOD | {
        "axes": [[np.cos(angle), -np.sin(angle), 0.0], [np.sin(angle), np.cos(angle), 0.0]]
    }


def test_isotropic_values_give_the_isotropic_material():
    E, nu = STEEL["E"], STEEL["nu"]
    lam, mu = E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))
    hooke = np.zeros((6, 6))
    hooke[:3, :3] = lam
    hooke += np.diag([2 * mu] * 3 + [mu] * 3)
    for values in (
        STEEL,
        STEEL | TURNED,
        STEEL | {"E": [E] * 3, "nu": [nu] * 3, "G": mu},
        STEEL | {"G": [mu] * 3},
    ):
        np.testing.assert_allclose(
            Material.model_validate(values).elasticity, hooke, rtol=0, atol=1e-14 * E
        )


def test_strains_under_single_stresses():
    """The inverse holds 1/E_i, 1/G_ij and -nu_ij / E_i, in the order xx, yy, zz, yz, xz, xy."""
    S = np.linalg.inv(Material.model_validate(WOOD).elasticity)
    E, nu, G = WOOD["E"], WOOD["nu"], WOOD["G"]
    np.testing.assert_allclose(1.0 / np.diag(S), [*E, *G[::-1]], rtol=1e-13)
    np.testing.assert_allclose(
        [S[1, 0], S[2, 0], S[2, 1]], [-nu[0] / E[0], -nu[1] / E[0], -nu[2] / E[1]], rtol=1e-13
    )


def test_a_quarter_turn_changes_places():
    """With direction 1 along y and 2 along z, 3 is along x."""
    C = Material.model_validate(WOOD | {"axes": [[0, 1, 0], [0, 0, 1]]}).elasticity
    own = Material.model_validate(WOOD).elasticity
    order = [2, 0, 1, 5, 3, 4]  # x is 3, y is 1, z is 2; yz is 12, xz is 13, xy is 23
    expected = own[np.ix_(order, order)]
    np.testing.assert_allclose(C, expected, rtol=0, atol=1e-14 * np.abs(C).max())


@pytest.mark.parametrize("angle", np.radians([0, 15, 30, 45, 70, 90]))
def test_stiffness_at_an_angle(angle):
    S = np.linalg.inv(Material.model_validate(turned(angle)).elasticity)
    assert 1.0 / S[0, 0] == pytest.approx(along(angle), rel=1e-12)


def test_the_matrix_and_the_tensor_give_the_same_stress():
    material = Material.model_validate(WOOD | TURNED)
    strain = np.random.default_rng(0).normal(size=(3, 3))
    strain += strain.T
    stress = np.einsum("ijkl,kl->ij", material.elasticity_tensor, strain)
    engineering = [strain[i, j] * (1 if i == j else 2) for i, j in STRESS_ORDER]
    np.testing.assert_allclose(
        material.elasticity @ engineering, [stress[i, j] for i, j in STRESS_ORDER], rtol=1e-12
    )


def test_a_patch_of_orthotropic_elements(solid_body, box, kind):
    """A constant strain has the energy epsilon C epsilon / 2 and leaves inner nodes unloaded."""
    structure = assemble(solid_body(box(kind), material=WOOD | TURNED))
    C = Material.model_validate(WOOD | TURNED).elasticity_tensor
    gradient = np.random.default_rng(3).normal(size=(3, 3))
    strain = 0.5 * (gradient + gradient.T)
    points = structure.nodes.points
    u = (points @ gradient.T).ravel()
    energy = 0.5 * np.einsum("ij,ijkl,kl", strain, C, strain)
    assert 0.5 * u @ (structure.K @ u) == pytest.approx(energy, rel=1e-12)
    inside = ((points > 1e-9) & (points < 1 - 1e-9)).all(axis=1)
    force = (structure.K @ u).reshape(-1, 3)
    assert np.abs(force[inside]).max() < 1e-12 * np.abs(force).max()


@pytest.mark.parametrize("angle", np.radians([0, 20, 45, 90]))
def test_a_turned_bar_in_tension(solid_body, box, kind, angle):
    """A uniform traction on both ends stretches the bar by F L / (E(angle) A), however its sections
    warp and shear.
    """
    L, A, F = 2.0, 0.02, 1000.0
    structure = assemble(solid_body(box(kind, size=(L, 0.2, 0.1)), material=turned(angle)))
    load = structure.P_C.T @ np.array([-F, 0, 0, 0, 0, 0, F, 0, 0, 0, 0, 0])
    K, MU = structure.K.toarray(), structure.M @ structure.U
    hold = MU @ MU.T  # of the rigid motion, which the load does not drive: any stiffness will do
    u = np.linalg.solve(K + np.trace(K) / np.trace(hold) * hold, load)
    ends = structure.P_C @ u
    assert ends[6] - ends[0] == pytest.approx(F * L / (along(angle) * A), rel=1e-9)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"G": None}, r"G: missing; only a material with one E and one nu is isotropic"),
        ({"E": [1e9, 1e9, 0.0]}, r"greater than 0"),
        (
            {"nu": [4.0, 0.5, 0.7]},
            r"positive definite elasticity matrix, found eigenvalues of -[\d.e+]+, .* Pa; nu_ij\^2",
        ),
        (
            {"axes": [[1, 0, 0], [-2, 0, 0]]},
            r"axes: expected two vectors that span a plane, found \[\(1.0, 0.0, 0.0\), ",
        ),
        ({"axes": [[1, 0, 0], [0, 0, 0]]}, r"axes: expected two vectors that span a plane"),
    ],
)
def test_what_no_material_is(changes, message):
    with pytest.raises(ValidationError, match=message):
        Material.model_validate(WOOD | changes)
