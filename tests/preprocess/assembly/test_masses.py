"""Lumped masses: mass properties by Steiner's theorem, frequencies of a beam with a tip mass, and
where masses go.
"""

import numpy as np
import pytest
from duhamel.preprocess import Body, InterfaceError, MeshError, assemble, build
from pydantic import ValidationError
from scipy.linalg import eigh
from scipy.optimize import brentq

L, EI, m, a = 0.5, 5.5, 0.0858, 0.05
TIP_MASS, HUB_MASS, HUB_INERTIA = 0.0021, 0.01, 0.00238
J = [[3e-5, 1e-6, 2e-6], [1e-6, 4e-5, -1e-6], [2e-6, -1e-6, 5e-5]]


def steiner(mass, inertia, offset):
    """The inertia about a point `offset` away from the center of mass."""
    offset = np.asarray(offset)
    return inertia + mass * (offset @ offset * np.eye(3) - np.outer(offset, offset))


def check_mass_properties(bare, heavy, mass, inertia, place):
    """`heavy` is `bare` and a rigid piece: mass, center of mass, and inertia about it."""
    total = bare.mass + mass
    center = (bare.mass * bare.center + mass * np.asarray(place)) / total
    expected = steiner(bare.mass, bare.J_rot, bare.center - center) + steiner(
        mass, inertia, place - center
    )
    assert heavy.mass == pytest.approx(total, rel=1e-12)
    np.testing.assert_allclose(heavy.center, center, rtol=0, atol=1e-12)
    np.testing.assert_allclose(heavy.J_rot, expected, rtol=0, atol=1e-12 * np.abs(expected).max())


PLACES = {"interface": {"interface": "tip"}, "node": {"node": [L, 0, 0]}, "group": {"group": "tip"}}


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize(
    "inertia", [[0, 0, 0], [1e-5, 2e-5, 3e-5], J], ids=["point", "principal", "full"]
)
def test_mass_properties_of_a_beam_with_a_tip_mass(beam_body, beam, place, inertia):
    bare = assemble(beam_body(beam(4))).rigid
    masses = {"tip": {**PLACES[place], "mass": TIP_MASS, "inertia": inertia}}
    heavy = assemble(beam_body(beam(4), masses=masses))
    inertia = np.diag(inertia) if np.ndim(inertia) == 1 else np.array(inertia)
    check_mass_properties(bare, heavy.rigid, TIP_MASS, inertia, [L, 0, 0])
    np.testing.assert_allclose(
        heavy.interfaces[1].X, [L, 0, 0] - heavy.rigid.center, rtol=0, atol=1e-14
    )


@pytest.mark.parametrize(
    "interface", [{}, {"kind": "rigid"}, {"at": [1.2, 0.1, 0]}], ids=["average", "rigid", "at"]
)
def test_mass_properties_of_a_solid_with_a_mass_on_an_interface(solid_body, box, kind, interface):
    """An interface follows rigid motion exactly, so the mass acts where its frame is."""
    mesh = box(kind, size=(1.0, 0.2, 0.1), divisions=(3, 2, 2))
    interfaces = {"root": {"group": "root"}, "tip": {"group": "tip", **interface}}
    bare = assemble(solid_body(mesh, interfaces=interfaces))
    masses = {"motor": {"interface": "tip", "mass": 30.0, "inertia": [0.1, 0.2, 0.3]}}
    heavy = assemble(solid_body(mesh, interfaces=interfaces, masses=masses))
    place = bare.interfaces[1].X + bare.rigid.center
    check_mass_properties(bare.rigid, heavy.rigid, 30.0, np.diag([0.1, 0.2, 0.3]), place)


def test_a_mass_on_a_node_and_on_a_face_of_a_solid(solid_body, box, kind):
    mesh = box(kind, size=(1.0, 0.2, 0.1), divisions=(3, 2, 2))
    bare = assemble(solid_body(mesh)).rigid
    corner = assemble(solid_body(mesh, masses={"bolt": {"node": [1, 0.2, 0.1], "mass": 2.0}})).rigid
    check_mass_properties(bare, corner, 2.0, np.zeros((3, 3)), [1.0, 0.2, 0.1])
    face = assemble(
        solid_body(mesh, masses={"plate": {"group": "root", "mass": 2.0, "inertia": J}})
    ).rigid
    check_mass_properties(bare, face, 2.0, np.array(J), [0.0, 0.1, 0.05])


def test_a_node_that_follows_a_rigid_interface_takes_its_mass_along(solid_body, box):
    mesh = box("hexahedron", size=(1.0, 0.2, 0.1))
    interfaces = {"tip": {"group": "tip", "kind": "rigid"}}
    bare = assemble(solid_body(mesh, interfaces=interfaces)).rigid
    masses = {"bolt": {"node": [1, 0.2, 0.1], "mass": 2.0}}
    heavy = assemble(solid_body(mesh, interfaces=interfaces, masses=masses)).rigid
    check_mass_properties(bare, heavy, 2.0, np.zeros((3, 3)), [1.0, 0.2, 0.1])


def test_several_masses_add_up(beam_body, beam):
    masses = {
        "one": {"interface": "tip", "mass": 0.001},
        "two": {"node": [L, 0, 0], "mass": 0.002, "inertia": J},
    }
    two = assemble(beam_body(beam(4), masses=masses)).M
    one = assemble(
        beam_body(beam(4), masses={"both": {"group": "tip", "mass": 0.003, "inertia": J}})
    ).M
    assert abs(two - one).max() < 1e-18


def test_the_mean_motion_of_a_face_meets_the_mass_alone(solid_body, box, kind):
    """x^T (M - M_bare) x = m |D x|^2 + ...: motion of the face with no mean moves no mass."""
    mesh = box(kind, divisions=(2, 2, 2))
    bare = assemble(solid_body(mesh))
    heavy = assemble(
        solid_body(mesh, masses={"plate": {"group": "tip", "mass": 5.0, "inertia": [1, 2, 3]}})
    )
    added = (heavy.M - bare.M).toarray()
    x = np.random.default_rng(2).normal(size=bare.n_u)
    mean = (bare.P_C @ x)[6:]
    assert x @ added @ x == pytest.approx(
        5.0 * mean[:3] @ mean[:3] + [1, 2, 3] @ mean[3:] ** 2, rel=1e-10
    )
    assert np.linalg.matrix_rank(added, tol=1e-9) == 6


def shapes(beta, x, derivative):
    """Derivatives of cosh, sinh, cos and sin of beta x."""
    c, s = np.cos(beta * x), np.sin(beta * x)
    trigonometric = [(c, s), (-s, c), (-c, -s), (s, -c)][derivative]
    hyperbolic = (np.cosh(beta * x), np.sinh(beta * x))
    return beta**derivative * np.array(
        [*hyperbolic[:: -1 if derivative % 2 else 1], *trigonometric]
    )


def hinged_determinant(beta, tip_mass):
    """Of y'''' = beta^4 y on a hub that turns: y(0) = a y'(0), EI (y'' - a y''')(0) + omega^2 I_R
    y'(0) = 0; y''(L) = 0, EI y'''(L) + omega^2 M_p y(L) = 0.
    """
    squared = beta**4 * EI / m
    start = [shapes(beta, 0.0, k) for k in range(4)]
    end = [shapes(beta, L, k) for k in range(4)]
    rows = [
        start[0] - a * start[1],
        EI * (start[2] - a * start[3]) + squared * HUB_INERTIA * start[1],
        end[2],
        EI * end[3] + squared * tip_mass * end[0],
    ]
    return np.linalg.det([row / np.abs(row).max() for row in rows])


def sliding_determinant(beta, tip_mass):
    """On a hub that slides: y'(0) = 0, EI y'''(0) - omega^2 M_h y(0) = 0; the tip as above."""
    squared = beta**4 * EI / m
    start = [shapes(beta, 0.0, k) for k in range(4)]
    end = [shapes(beta, L, k) for k in range(4)]
    rows = [
        start[1],
        EI * start[3] - squared * HUB_MASS * start[0],
        end[2],
        EI * end[3] + squared * tip_mass * end[0],
    ]
    return np.linalg.det([row / np.abs(row).max() for row in rows])


def closed_form(determinant, tip_mass, near):
    """Frequencies [Hz] within 1 % of those given."""

    def beta(frequency):
        return ((2 * np.pi * frequency) ** 2 * m / EI) ** 0.25

    roots = [
        brentq(determinant, beta(0.99 * f), beta(1.01 * f), args=(tip_mass,), xtol=1e-12)
        for f in near
    ]
    return np.array(roots) ** 2 * np.sqrt(EI / m) / (2 * np.pi)


HUBS = {
    "turning": (hinged_determinant, 0.0, [29.40, 116.8, 316.8]),
    "turning with a tip mass": (hinged_determinant, TIP_MASS, [27.895, 108.557, 296.04]),
    "sliding": (sliding_determinant, 0.0, [25.169, 134.335, 341.52]),
    "sliding with a tip mass": (sliding_determinant, TIP_MASS, [23.160, 124.843, 319.70]),
}


@pytest.mark.parametrize("hub", HUBS)
def test_frequencies_with_a_hub_and_a_tip_mass(beam_body, beam, hub):
    """The beam clamped to a hub of one dof, against the roots of the frequency equation."""
    determinant, tip_mass, near = HUBS[hub]
    masses = {"tip": {"interface": "tip", "mass": tip_mass}} if tip_mass else {}
    structure = assemble(beam_body(beam(40), masses=masses))
    # Motion in the plane x, y: the hub moves the root by (a theta, theta), or by y alone.
    turning = determinant is hinged_determinant
    free = np.array([6 * node + dof for node in range(1, 41) for dof in (1, 5)])
    T = np.zeros((structure.n_u, len(free) + 1))
    T[1, 0], T[5, 0] = (a, 1.0) if turning else (1.0, 0.0)
    T[free, 1 + np.arange(len(free))] = 1.0
    K, M = T.T @ (structure.K @ T), T.T @ (structure.M @ T)
    M[0, 0] += HUB_INERTIA if turning else HUB_MASS
    found = np.sqrt(eigh(K, M, eigvals_only=True)[1:4]) / (2 * np.pi)
    exact = closed_form(determinant, tip_mass, near)
    np.testing.assert_allclose(exact, near, rtol=5e-4)
    np.testing.assert_allclose(found, exact, rtol=2e-6)


def test_the_march_knows_the_masses_too(beam_body, beam):
    """Modes and time stepping of the full model give one kernel."""
    masses = {"tip": {"interface": "tip", "mass": TIP_MASS, "inertia": [1e-7, 2e-7, 3e-7]}}
    modal, march = (
        build(
            beam_body(beam(3), masses=masses, impulse={"step": 1e-4, "steps": 30, "method": method})
        )
        for method in ("modal", "march")
    )
    scale = np.sqrt(np.abs(modal.kernel.g).max(axis=0).diagonal())
    error = np.abs(modal.kernel.g - march.kernel.g).max(axis=0) / np.outer(scale, scale)
    assert error.max() < 1e-9


@pytest.mark.parametrize(
    ("mass", "error", "message"),
    [
        (
            {"node": [0.3, 0, 0], "mass": 1},
            InterfaceError,
            r"mesh.msh: masses.lump: no node at \[0.3, 0.0, 0.0\]",
        ),
        (
            {"group": "beam", "mass": 1},
            InterfaceError,
            "masses.lump: expected one node of the lines",
        ),
        (
            {"group": "end", "mass": 1},
            MeshError,
            "no group 'end'; the groups of the mesh are: beam, root, tip",
        ),
    ],
)
def test_masses_that_find_no_place(beam_body, beam, mass, error, message):
    with pytest.raises(error, match=message):
        assemble(beam_body(beam(4), masses={"lump": mass}))


def test_a_node_of_a_solid_carries_no_inertia(solid_body, box):
    masses = {"lump": {"node": [0, 0, 0], "mass": 1, "inertia": [1, 1, 1]}}
    message = "mesh.msh: masses.lump: the node of a solid has three dofs and carries no inertia"
    with pytest.raises(InterfaceError, match=message):
        assemble(solid_body(box("hexahedron"), masses=masses))


@pytest.mark.parametrize(
    ("mass", "message"),
    [
        ({"interface": "tpi", "mass": 1}, "masses.lump: no interface 'tpi'; there are: root, tip"),
        ({"mass": 1}, "expected interface, or what it selects on the mesh"),
        (
            {"interface": "tip", "group": "tip", "mass": 1},
            "interface stands alone, found it with group",
        ),
        ({"interface": "tip"}, "Field required"),
        ({"interface": "tip", "mass": -1}, "greater than or equal to 0"),
        ({"interface": "tip", "mass": 0}, "expected a mass or an inertia, found neither"),
        ({"interface": "tip", "mass": 1, "inertia": [1, -1, 1]}, "none of them negative, found"),
        (
            {"interface": "tip", "mass": 1, "inertia": [[1, 2, 0], [0, 1, 0], [0, 0, 1]]},
            "a symmetric matrix",
        ),
        ({"interface": "tip", "weight": 1}, "unknown key 'weight'"),
    ],
)
def test_mistakes(beam_body, beam, mass, message):
    with pytest.raises(ValidationError, match=message):
        beam_body(beam(4), masses={"lump": mass})


def test_the_text_of_a_body_with_masses_gives_it_back(beam_body, beam):
    body = beam_body(
        beam(4), masses={"tip": {"interface": "tip", "mass": 1.0, "inertia": [1, 2, 3]}}
    )
    assert Body.model_validate_json(body.text) == body
