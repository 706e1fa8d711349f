"""Beam elements against scikit-fem's Hermite element, Timoshenko's closed forms, and their orders
of convergence.
"""

import numpy as np
import pytest
from duhamel.preprocess import MeshError, assemble
from duhamel.preprocess.assembly.structure import Structure
from duhamel.preprocess.body.body import Damping
from duhamel.preprocess.body.material import Section
from duhamel.preprocess.elements.beam import beam_matrices
from duhamel.preprocess.mesh.reading import read_mesh
from duhamel.preprocess.responses.modal import elastic_shapes
from scipy.linalg import eigh
from scipy.spatial.transform import Rotation

ALONG_Y, ALONG_Z = [1, 5], [2, 4]


def frequencies(structure: Structure) -> np.ndarray:
    return elastic_shapes(structure, Damping())[0].frequencies


def plane(structure: Structure, dofs: list[int]) -> tuple[np.ndarray, np.ndarray]:
    """K and M of one bending plane of a beam along x."""
    rows = (6 * np.arange(structure.n_u // 6)[:, None] + dofs).ravel()
    return structure.K.toarray()[np.ix_(rows, rows)], structure.M.toarray()[np.ix_(rows, rows)]


@pytest.mark.parametrize(("dofs", "sign"), [(ALONG_Y, 1.0), (ALONG_Z, -1.0)])
def test_bending_is_the_hermite_element_of_scikit_fem(beam_body, beam, section, dofs, sign):
    from skfem import Basis, BilinearForm, ElementLineHermite, MeshLine
    from skfem.helpers import dd, ddot

    K, M = plane(assemble(beam_body(beam(7))), dofs)
    basis = Basis(MeshLine(np.linspace(0.0, 0.5, 8)), ElementLineHermite(), intorder=6)
    stiffness = (
        BilinearForm(lambda u, v, w: section["EI_y"] * ddot(dd(u), dd(v))).assemble(basis).toarray()
    )
    mass = (
        BilinearForm(lambda u, v, w: section["mass_per_length"] * u * v).assemble(basis).toarray()
    )
    signs = np.tile([1.0, sign], 8)  # the slope is the rotation about z, or minus that about y
    np.testing.assert_allclose(
        K, stiffness * np.outer(signs, signs), rtol=0, atol=1e-12 * np.abs(stiffness).max()
    )
    np.testing.assert_allclose(
        M, mass * np.outer(signs, signs), rtol=0, atol=1e-12 * np.abs(mass).max()
    )


def test_free_free_frequencies_of_the_paper(beam_body, beam):
    """(beta L)^2 / (2 pi L^2) sqrt(EI / m), both bending planes."""
    np.testing.assert_allclose(
        frequencies(assemble(beam_body(beam(10))))[:4],
        [114.041, 114.041, 314.43, 314.43],
        rtol=2e-5,
    )
    fine = frequencies(assemble(beam_body(beam(40))))[:6:2]
    np.testing.assert_allclose(fine, [114.037, 314.35, 616.25], rtol=1e-5)


def test_bending_frequencies_converge_with_the_fourth_power(beam_body, beam, section):
    beta_L = np.array([4.730040744862704, 7.853204624095838])
    exact = beta_L**2 / (2 * np.pi * 0.5**2) * np.sqrt(section["EI_y"] / section["mass_per_length"])
    error = [frequencies(assemble(beam_body(beam(n))))[[0, 2]] / exact - 1 for n in (8, 16, 32)]
    orders = np.log2(np.array(error[:-1]) / np.array(error[1:]))
    np.testing.assert_allclose(orders, 4.0, atol=0.12)


def test_stretch_and_twist_err_as_linear_bars_do(beam_body, beam, section):
    """relative frequency error (n pi / N)^2 / 24 to its leading term; exact discrete frequencies to
    rounding
    """
    N, Le = 20, 0.5 / 20
    structure = assemble(beam_body(beam(N)))
    for stiffness, inertia, dof in (
        ("EA", "mass_per_length", 0),
        ("GJ", "polar_inertia_per_length", 3),
    ):
        K, M = plane(structure, [dof])
        omega = np.sqrt(eigh(K, M, eigvals_only=True)[1:4])
        mode = np.arange(1, 4)
        c = np.sqrt(section[stiffness] / section[inertia])
        np.testing.assert_allclose(
            omega / (mode * np.pi * c / 0.5) - 1, (mode * np.pi / N) ** 2 / 24, rtol=0.02
        )
        theta = mode * np.pi / N
        exact = c / Le * np.sqrt(6 * (1 - np.cos(theta)) / (2 + np.cos(theta)))
        np.testing.assert_allclose(omega, exact, rtol=1e-9)


def test_timoshenko_deflection_is_exact_with_one_element(beam_body, beam, section):
    """clamped at the root, force at the tip: L^3 / 3EI + L / GA, and slope L^2 / 2EI"""
    L, EI, GA = 0.5, section["EI_z"], 30.0
    K, _ = plane(assemble(beam_body(beam(1), section | {"GA_y": GA})), ALONG_Y)
    deflection, slope = np.linalg.solve(K[2:, 2:], [1.0, 0.0])
    assert deflection == pytest.approx(L**3 / (3 * EI) + L / GA, rel=1e-12)
    assert slope == pytest.approx(L**2 / (2 * EI), rel=1e-12)


FLAT = {"polar_inertia_per_length": 1e-4}
"""of a section that has as much inertia about its axis as about the others"""


def test_timoshenko_frequencies_converge_to_the_closed_form(beam_body, beam, section):
    """simply supported, w = sin kx and theta = cos kx: (GA k^2 - m w^2)(EI k^2 + GA - r w^2) = (GA
    k)^2

    Second order, for the shear strain is constant within an element.
    """
    L, EI, GA, m, r = 0.5, section["EI_y"], 2.0e3, section["mass_per_length"], 1e-5
    k = np.pi / L
    quadratic = [m * r, -(GA * k**2 * r + m * (EI * k**2 + GA)), GA * EI * k**4]
    exact = np.sqrt(np.roots(quadratic).min())
    errors = []
    for n in (4, 8, 16):
        body = beam_body(beam(n, L), section | {"GA_z": GA, "rotary_inertia_y": r} | FLAT)
        K, M = plane(assemble(body), ALONG_Z)
        free = np.setdiff1d(np.arange(len(K)), [0, len(K) - 2])
        omega = np.sqrt(eigh(K[np.ix_(free, free)], M[np.ix_(free, free)], eigvals_only=True)[0])
        errors.append(omega / exact - 1)
    np.testing.assert_allclose(np.log2(np.array(errors[:-1]) / errors[1:]), 2.0, atol=0.1)


def test_shear_brings_the_rotary_inertia_of_a_homogeneous_section(beam_body, beam, section):
    """mass EI / EA about y goes with GA_z: the inertia grows by that times the length."""
    thick = section | {"EA": 2.16e4} | FLAT
    plain = assemble(beam_body(beam(4), thick)).rigid.J_rot
    sheared = assemble(beam_body(beam(4), thick | {"GA_z": 1e4})).rigid.J_rot
    added = 0.5 * thick["mass_per_length"] * thick["EI_y"] / thick["EA"]
    np.testing.assert_allclose(
        sheared - plain, np.diag([0.0, added, 0.0]), rtol=0, atol=1e-12 * added + 1e-18
    )


def test_a_turned_frame_is_the_same_body(beam_body, lines, section):
    """A bent frame with different bending stiffnesses, turned at random with its orientation
    vectors.
    """
    corner = np.array(
        [[0, 0, 0], [0.1, 0, 0.05], [0.2, 0.05, 0.1], [0.2, 0.2, 0.1], [0.1, 0.3, 0.3]], dtype=float
    )
    R = Rotation.random(random_state=7).as_matrix()
    y = np.array([0.3, 0.5, 1.0])
    unequal = section | {"EI_z": 20.0, "GA_y": 1e5, "rotary_inertia_y": 1e-7}
    original = assemble(beam_body(lines(corner), unequal | {"orientation": y.tolist()}))
    turned = assemble(beam_body(lines(corner @ R.T), unequal | {"orientation": (R @ y).tolist()}))
    np.testing.assert_allclose(frequencies(turned), frequencies(original), rtol=1e-8)
    np.testing.assert_allclose(
        turned.rigid.J_rot, R @ original.rigid.J_rot @ R.T, rtol=0, atol=1e-16
    )
    np.testing.assert_allclose(turned.rigid.center, R @ original.rigid.center, rtol=0, atol=1e-15)


def test_orientation_turns_the_bending_planes(beam_body, beam, section):
    """Local y along z gives the stiffness about z to the deflection along z."""
    unequal = section | {"EI_z": 20.0}
    turned = assemble(beam_body(beam(3), unequal | {"orientation": [0, 0, 1]}))
    swapped = assemble(beam_body(beam(3), section | {"EI_y": 20.0}))
    np.testing.assert_allclose(turned.K.toarray(), swapped.K.toarray(), rtol=0, atol=1e-9)


def test_local_y_is_horizontal_unless_the_beam_is_vertical(beam_body, beam, section):
    unequal = section | {"EI_z": 20.0}
    for along, y in (([0, 1, 0], [-1, 0, 0]), ([0, 0, 1], [0, 1, 0])):
        default = assemble(beam_body(beam(2, 0.5, along), unequal))
        given = assemble(beam_body(beam(2, 0.5, along), unequal | {"orientation": y}))
        np.testing.assert_allclose(default.K.toarray(), given.K.toarray(), rtol=0, atol=1e-9)


def test_sections_by_group(beam_body, lines, section):
    mesh = lines([[0, 0, 0], [0.1, 0, 0], [0.2, 0, 0]])
    mesh.cells[2:] = [type(mesh.cells[2])("line", mesh.cells[2].data[[i]]) for i in (1, 0)]
    mesh.cell_data = {
        key: [*data[:2], np.array([11]), np.array([12])] for key, data in mesh.cell_data.items()
    }
    mesh.field_data = {**mesh.field_data, "outer": np.array([11, 1]), "inner": np.array([12, 1])}
    heavy = section | {"mass_per_length": 1.0}
    structure = assemble(beam_body(mesh, None, sections={"inner": section, "outer": heavy}))
    m1, m2 = 0.1 * section["mass_per_length"], 0.1
    assert structure.rigid.mass == pytest.approx(m1 + m2, rel=1e-14)
    assert structure.rigid.center[0] == pytest.approx(
        (m1 * 0.05 + m2 * 0.15) / (m1 + m2), rel=1e-14
    )


def test_a_line_without_length_and_a_parallel_orientation(beam_body, lines, section):
    with pytest.raises(
        MeshError, match=r"line 1 has no length: both ends are at \[0.1, 0.0, 0.0\]"
    ):
        assemble(beam_body(lines([[0, 0, 0], [0.1, 0, 0], [0.1, 0, 0], [0.2, 0, 0]])))
    with pytest.raises(
        MeshError, match=r"line 0 runs along \[1.0, 0.0, 0.0\].*parallel.*\(2.0, 0.0, 0.0\)"
    ):
        assemble(beam_body(lines([[0, 0, 0], [0.1, 0, 0]]), section | {"orientation": [2, 0, 0]}))


def test_element_matrices_are_symmetric_with_six_rigid_motions(save, beam, section):
    mesh = read_mesh(save(beam(1, 0.3, (0.6, 0.0, 0.8))))
    K, M = beam_matrices(mesh, [Section(**section, GA_y=1e3, GA_z=2e3)])
    np.testing.assert_allclose(K, K.transpose(0, 2, 1), rtol=0, atol=1e-10 * K.max())
    assert (np.linalg.eigvalsh(M) > 0).all()
    assert np.linalg.matrix_rank(K[0], tol=1e-10 * K.max()) == 6
