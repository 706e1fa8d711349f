"""The second order of bodies in a few coordinates: what it satisfies, and what it is good for."""

import numpy as np
import pytest
from duhamel.preprocess import build
from duhamel.superelement import check, read, write
from scipy.spatial.transform import Rotation

from .steady import Steady, Support

FLAP = {3: (4.7973, 23.3203), 6: (7.3604, 26.8093)}
"""gamma -> the first two flap frequencies of a rotating cantilever, in units of sqrt(EI / m L^4)"""
STILL = 3.5160
"""the first at rest"""
UNIT = {
    "EA": 1e6,
    "EI_y": 1.0,
    "EI_z": 1.0,
    "GJ": 1.0,
    "mass_per_length": 1.0,
    "polar_inertia_per_length": 2e-6,
    "rotary_inertia_y": 1e-6,
    "rotary_inertia_z": 1e-6,
}
ROOT = {"modes": 4, "loaded": ["root"]}
BUCKLING = {
    "pinned": ([Support(0, (0, 1, 2, 3)), Support(1, (1, 2))], np.pi**2),
    "clamped, free": ([Support(0)], np.pi**2 / 4.0),
    "clamped, pinned": ([Support(0), Support(1, (1, 2))], 20.1907),
    "clamped, guided": ([Support(0), Support(1, (1, 2, 3, 4, 5))], 4.0 * np.pi**2),
}


@pytest.fixture
def unit_beam(beam, beam_body):
    """A beam of length, mass and bending stiffness 1, built with a [rotation]."""

    def make(elements=24, section=UNIT, length=1.0, **changes):
        values = {"rotation": ROOT, "impulse": {"step": 1e-3, "steps": 4}, **changes}
        return build(beam_body(beam(elements, length), section, **values))

    return make


def flap_and_lag(element, gamma):
    """The first two frequencies out of and in the plane of rotation of a clamped root."""
    steady = Steady(element, [Support(0)], [0, 0, gamma]).solve()
    frequencies, shapes = steady.frequencies()
    tip = element.modes.phi[6:9] @ shapes[6:] + shapes[:3]
    tip += np.cross(shapes[3:6], element.interfaces[1].X, axisa=0).T
    out = np.abs(tip[2]) > np.abs(tip[1])
    bending = frequencies < 40.0
    return np.array([frequencies[out & bending][:2], frequencies[~out & bending][:2]])


@pytest.mark.parametrize("gamma", FLAP)
def test_a_rotating_cantilever_stiffens(unit_beam, gamma):
    """Flap, and lag^2 = flap^2 - gamma^2, with twelve coordinates."""
    element = unit_beam()
    assert element.rotation.r <= 12
    flap = np.array(FLAP[gamma])
    expected = np.array([flap, np.sqrt(flap**2 - gamma**2)])
    np.testing.assert_allclose(flap_and_lag(element, gamma), expected, rtol=2e-4)


@pytest.mark.parametrize("method", ["krylov", "rubin"])
def test_any_method_stiffens_alike(unit_beam, method):
    """Krylov's to its tolerance; Rubin's modes, of which there are few, less."""
    impulse = {"step": 1e-3, "steps": 4, "method": method}
    found = unit_beam(impulse=impulse | ({"modes": 8} if method == "rubin" else {}))
    expected = flap_and_lag(unit_beam(), 6)
    tolerance = 1e-6 if method == "krylov" else 2e-4
    np.testing.assert_allclose(flap_and_lag(found, 6), expected, rtol=tolerance)


@pytest.mark.parametrize("case", BUCKLING)
def test_columns_buckle(unit_beam, case):
    """Euler's four, from the stiffness at nine tenths of the load and above."""
    supports, load = BUCKLING[case]
    element = unit_beam(16, rotation={"modes": 2})
    shares = np.array([0.9, 0.95, 0.98])
    stiffness = [
        Steady(element, supports, force=(-share * load, 0, 0)).solve().least_stiffness()
        for share in shares
    ]
    error = min(np.roots(np.polyfit(shares - 1.0, stiffness, 2)), key=abs)
    assert abs(error) < 5e-4


def test_a_free_bar_stretches_as_it_turns(unit_beam):
    """Each tip by m w^2 L^2 / (24 EA)."""
    element = unit_beam(rotation={"modes": 1, "soft": 0})
    compliance = element.modes.phi / element.modes.omega**2 @ element.rotation.phi_inertia.T
    spin = np.array([0.0, 0.0, 0.5, 0.0, 0.0, 0.0])
    np.testing.assert_allclose((compliance @ spin)[[0, 6]], [-1 / 24e6, 1 / 24e6], rtol=1e-6)


def test_krylov_finds_what_rotation_stretches_and_no_load_on_an_interface_does(unit_beam):
    """A bar held in the middle: the stretch is odd, all that the interface excites in it even."""
    middle = {"middle": {"node": [0.5, 0, 0]}}
    found = {}
    for method in ("modal", "krylov"):
        impulse = {"step": 1e-3, "steps": 50, "method": method, "band": 100.0}
        element = unit_beam(interfaces=middle, rotation={"modes": 2}, impulse=impulse)
        modes, phi = element.modes, element.rotation.phi_inertia
        slow = 0.5 * modes.omega.min()
        found[method] = [(phi / (modes.omega**2 - w**2)) @ phi.T for w in (0.0, slow)]
    scale = found["modal"][0].max()
    np.testing.assert_allclose(found["krylov"], found["modal"], atol=1e-6 * scale, rtol=0)
    assert scale > 1e-8


@pytest.fixture
def steel_bar(box, solid_body):
    """A bar of hexahedra of 1 m, 20 times as long as thick, with rigid ends."""

    def make(rotation):
        ends = {name: {"group": name, "kind": "rigid"} for name in ("root", "tip")}
        mesh = box("hexahedron27", (1.0, 0.05, 0.05), (8, 1, 1))
        impulse = {"step": 1e-5, "steps": 4}
        return build(solid_body(mesh, rotation=rotation, interfaces=ends, impulse=impulse))

    return make


def test_a_rotating_bar_of_solids_stiffens_as_a_beam(steel_bar):
    """Its clamped end cannot contract either, so the square gains what that of a beam does."""
    element = steel_bar(ROOT)
    unit = np.sqrt(2.1e11 * 0.05**2 / 12.0 / 7800.0)
    spin = 3.0 * unit
    frequencies = [
        Steady(element, [Support(0)], [0, 0, w]).solve().frequencies()[0][:2] / unit
        for w in (0.0, spin)
    ]
    still, (lag, flap) = frequencies[0][0], frequencies[1]
    assert still == pytest.approx(STILL, rel=0.01)
    assert flap == pytest.approx(np.sqrt(still**2 + FLAP[3][0] ** 2 - STILL**2), rel=2e-3)
    assert lag == pytest.approx(np.sqrt(flap**2 - 9.0), rel=2e-3)


def test_no_strain_energy_is_negative_at_level_2(steel_bar):
    """1/2 omega^2 q^2 + W, for any deflection however large; with the cubic alone it is."""
    element = steel_bar({"modes": 4, "loaded": ["root"], "level": 2})
    rotation = element.rotation
    squares = ((rotation.by_mass * element.modes.omega) ** 2).sum(axis=1)
    rng = np.random.default_rng(0)
    q = rng.normal(size=(4000, rotation.n_stiff)) / np.sqrt(squares)
    q *= 10.0 ** rng.uniform(-2.0, 8.0, (4000, 1))
    linear = 0.5 * (squares * q**2).sum(axis=1)
    cubic = np.einsum("klm,pk,pl,pm->p", rotation.cubic, q, q, q, optimize=True) / 6.0
    quartic = np.einsum("klmn,pk,pl,pm,pn->p", rotation.quartic, q, q, q, q, optimize=True) / 8.0
    assert ((linear + cubic + quartic) / linear).min() > 0.0


def test_coordinates_are_projections(unit_beam):
    """Rows by mass are orthonormal; those by stiffness give the same for the shapes themselves."""
    rotation = unit_beam(rotation={"modes": 4}).rotation
    n, by_mass = rotation.n_stiff, rotation.by_mass
    np.testing.assert_allclose(by_mass @ by_mass.T, np.eye(n), atol=1e-10)
    np.testing.assert_allclose(rotation.T[:n] @ by_mass.T, np.eye(n), atol=1e-10)


def test_stress_works_on_projections_by_stiffness_and_inertia_on_those_by_mass(unit_beam):
    rotation = unit_beam().rotation
    low, n, r = rotation.n_low, rotation.n_stiff, rotation.r
    assert (low, n, r) == (4, 8, 12)
    assert not rotation.A_interface[:, n:].any()
    assert rotation.A_interface[:, :n, :n].any()
    assert not rotation.A_inertia[:, low:n, n:].any()
    assert not rotation.gyroscopic[:, low:n].any()
    for A in (rotation.A_interface, rotation.A_inertia):
        np.testing.assert_array_equal(A, A.transpose(0, 2, 1))


def test_bending_of_a_long_beam_is_soft_and_nothing_else(beam, beam_body):
    """kappa of pairs of bending shapes; stretch and twist, at nothing, are left out."""
    section = {**UNIT, "EA": 2.1e7, "EI_y": 1.4e4, "EI_z": 1.4e4, "GJ": 1e4}
    mesh = beam(40, 10.0)
    body = beam_body(mesh, section, rotation={"modes": 12, "loaded": ["root"]})
    kappa = build(body).rotation.kappa
    expected = [1, 0.29, 0.13, 0.072, 0.046, 0.032, 0.031]  # the last but one: an attachment
    np.testing.assert_allclose(kappa[:14:2], expected, rtol=0.02)
    assert kappa[-1] < 1e-8


def test_a_number_of_soft_shapes_is_those_that_are_stiffened_most(unit_beam):
    every, two, none = (
        unit_beam(rotation={"modes": 2, "soft": soft}).rotation for soft in ("auto", 2, 0)
    )
    assert (two.n_soft, none.n_soft) == (2, 0)
    assert every.n_soft > 2
    np.testing.assert_array_equal(two.kappa, every.kappa)
    rows = every.T[2 : every.n_stiff]
    share = np.abs(rows @ two.T[4:].T).max(axis=0)
    np.testing.assert_allclose(share, 1.0, atol=0.3)


def test_where_no_interface_is_loaded_there_are_modes_alone(unit_beam):
    rotation = unit_beam(rotation={"modes": 3, "loaded": []}).rotation
    assert (rotation.n_low, rotation.n_soft) == (3, 0)


def test_the_coordinates_of_a_body_do_not_depend_on_its_axes(lines, beam_body):
    """A flat beam along x, and the same in other axes."""
    turn = Rotation.from_rotvec([0.5, -1.1, 0.8]).as_matrix()
    kappa = []
    for R in (np.eye(3), turn):
        section = {**UNIT, "EI_y": 1.7, "orientation": (R @ [0, 0, 1]).tolist()}
        points = np.linspace(0, 1, 13)[:, None] * R[:, 0]
        kappa.append(build(beam_body(lines(points), section, rotation={})).rotation.kappa)
    np.testing.assert_allclose(*kappa, atol=1e-6)


@pytest.fixture(params=["angle", "ring", "short bar", "points on a bar"])
def body_of(request, lines, beam_body, box, solid_body):
    """Bodies whose soft shapes carry all the stress of all loads, by the name of their keys."""
    legs = [[x, 0, 0] for x in (0, 0.2, 0.4, 0.6)] + [[0.6, y, 0] for y in (0.2, 0.4)]
    round_ = [[np.cos(a), np.sin(a), 0] for a in np.arange(24) * np.pi / 12]
    closed = np.stack([np.arange(24), (np.arange(24) + 1) % 24], axis=1)
    ends = {"root": {"node": [0, 0, 0]}, "tip": {"node": [0.1, 0, 0]}}

    def make(**rotation):
        if request.param == "angle":
            return beam_body(lines(legs), UNIT, rotation=rotation)
        if request.param == "ring":
            across = {"root": {"node": [1, 0, 0]}, "tip": {"node": [-1, 0, 0]}}
            return beam_body(lines(round_, closed), UNIT, rotation=rotation, interfaces=across)
        mesh = box("hexahedron20", (0.1, 0.02, 0.02), (4, 1, 1))
        given = {} if request.param == "short bar" else {"interfaces": ends}
        return solid_body(mesh, rotation=rotation, **given)

    return make


def test_soft_shapes_leave_the_stress_that_stiffens(body_of):
    """That of forces on the interfaces and of rotation, in the lowest modes."""
    with_shapes, modes_alone = (build(body_of(**keys)) for keys in ({}, {"soft": 0}))
    n = modes_alone.rotation.n_low
    forces = [with_shapes.rows(name).start + i for name in ("root", "tip") for i in range(3)]
    for name, rows in (("A_interface", forces), ("A_inertia", slice(None))):
        found, expected = (
            getattr(body.rotation, name)[rows, :n, :n] for body in (with_shapes, modes_alone)
        )
        assert np.abs(found - expected).max() < 0.1 * np.abs(expected).max()


def test_a_body_without_loaded_interfaces_has_modes_alone(unit_beam):
    rotation = unit_beam(rotation={"modes": 3, "loaded": []}).rotation
    assert (rotation.n_low, rotation.n_soft, rotation.r) == (3, 0, 3)


def test_inertia_stays_positive_where_a_beam_bends_far(beam, beam_body):
    """The mass matrix [[J, h q], [., 1]] of a slender beam of 10 m, bent by half a meter."""
    section = {**UNIT, "EA": 2.1e7, "EI_y": 1.4e4, "EI_z": 1.4e4}
    element = build(beam_body(beam(20, 10.0), section, rotation={"modes": 2}))
    rotation, modes = element.rotation, element.modes
    for mode in range(8):
        tip = np.abs(modes.phi[6:9, mode]).max()
        q = rotation.T[:, mode] * 0.5 / tip
        d = 0.5 * (rotation.A_inertia @ q) @ q + rotation.phi_inertia[:, mode] * 0.5 / tip
        J = element.J_rot + d[[[0, 5, 4], [5, 1, 3], [4, 3, 2]]]
        h = np.einsum("ikl,k->il", rotation.gyroscopic, q) @ rotation.T
        M = np.block([[J, h], [h.T, np.eye(len(modes.omega))]])
        assert np.linalg.eigvalsh(M)[0] > 0.0


def test_the_file_keeps_it_and_all_checks_hold(unit_beam, tmp_path):
    element = unit_beam()
    write(tmp_path / "beam.h5", element)
    again = read(tmp_path / "beam.h5").rotation
    for name in ("phi_inertia", "T", "A_interface", "A_inertia", "gyroscopic", "kappa"):
        np.testing.assert_array_equal(getattr(again, name), getattr(element.rotation, name))
    assert again.n_low == element.rotation.n_low
    assert all(fact.holds for fact in check(element))


def test_bodies_without_it_are_as_before(unit_beam):
    element = unit_beam(rotation=None)
    assert element.rotation is None
    assert len(element.modes.omega) == len(unit_beam().modes.omega)
