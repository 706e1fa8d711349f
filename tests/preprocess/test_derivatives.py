"""Superelements by coupled tangents of their modes, beside rebuilds at other parameters."""

from dataclasses import replace
from pathlib import Path

import duhamel as du
import h5py
import meshio
import numpy as np
import pytest
import skfem
from duhamel.cli import app
from duhamel.preprocess import BodyError, PlausibilityWarning, build, files_of, read_body
from duhamel.preprocess.body.derivative import with_numbers
from duhamel.superelement import (
    GeneralizedAlpha,
    SuperelementError,
    read,
    redesigned,
    respond,
    scaled,
    write,
)
from typer.testing import CliRunner

STEP, STEPS = 5e-5, 400
RAMP_STEPS = 80
SMALL = 1e-5
"""of a parameter, for differences"""


def rod(bending=1.0):
    """A rod of ten beam elements."""
    steel = du.Material(E=2e11, nu=0.3, rho=7800.0)
    section = du.Section.rectangle(steel, 0.02, 0.01, orientation=(0.0, 1.0, 0.0))
    section = section.model_copy(update={"EI_z": bending * section.EI_z})
    made = du.Beam(np.linspace([0.0, 0.0, 0.0], [0.5, 0.0, 0.0], 11), section=section, name="rod")
    made.interface("root", (0.0, 0.0, 0.0))
    made.interface("tip", (0.5, 0.0, 0.0))
    return made


def block(p=0.0):
    """A bar of twelve hexahedra that grows longer, thicker and skew with p."""
    x, y, z = np.linspace(0, 0.3, 4), np.linspace(0, 0.04, 3), np.linspace(0, 0.05, 3)
    mesh = skfem.MeshHex.init_tensor(x, y, z)
    mesh = mesh.with_boundaries(
        {"left": lambda at: at[0] < 1e-9, "right": lambda at: at[0] > 0.3 - 1e-9}
    )
    moved = mesh.p.copy()
    moved[0] += p * (0.3 * mesh.p[0] + 0.2 * mesh.p[2])
    moved[1] *= 1.0 + p * mesh.p[0]
    moved[2] += p * 0.5 * mesh.p[0]
    return replace(mesh, doflocs=moved)


def bar(p=0.0, **options):
    made = du.Part(block(p), du.Material(E=2e11, nu=0.3, rho=7800.0), name="bar", **options)
    made.interface("root", "left", kind="rigid")
    made.interface("tip", "right")
    return made


def plate(thickness=2e-3):
    mesh = skfem.MeshQuad.init_tensor(np.linspace(0, 0.3, 7), np.linspace(0, 0.1, 3))
    points = np.vstack([mesh.p, np.zeros(mesh.p.shape[1])]).T
    made = du.Part(
        meshio.Mesh(points, [("quad", mesh.t.T)]),
        du.Material(E=7e10, nu=0.3, rho=2700.0),
        shell={"thickness": thickness},
        name="plate",
    )
    made.interface("root", (0.0, 0.0, 0.0))
    made.interface("tip", (0.3, 0.1, 0.0))
    return made


def responses(element, size):
    """Displacements of all interfaces under a load on each, which rises smoothly.

    size (n_c,): the unit of each row, so that all count the same.
    """
    ramp = np.ones(STEPS)
    ramp[:RAMP_STEPS] = 0.5 - 0.5 * np.cos(np.pi * np.arange(1, RAMP_STEPS + 1) / RAMP_STEPS)
    modes = element.modes
    eta = respond(modes, STEP, GeneralizedAlpha(0.9), [modes.phi.T @ (a / size) for a in ramp])
    return np.array([modes.phi @ one / size for one in eta])


def slope(function, at, step):
    return (function(at + step) - function(at - step)) / (2.0 * step)


def assert_slope(found, expected, rtol):
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=rtol * np.abs(expected).max())


def element_of(part, **options):
    return part.superelement(step=STEP, duration=10 * STEP, **options)


BODIES = {
    "bending": (lambda EI: rod(EI / rod().body(step=STEP).section.EI_z), {"key": "section.EI_z"}),
    "thickness": (plate, {"key": "shell.thickness"}),
    "morph": (bar, {"mesh": block(1.0)}),
}


@pytest.mark.parametrize("name", BODIES)
def test_a_change_by_tangents_is_that_of_rebuilds(name):
    make, given = BODIES[name]
    start = {"bending": rod().body(step=STEP).section.EI_z, "thickness": 2e-3, "morph": 0.0}[name]
    part = make(start)
    part.derivative("p", **given)
    element = element_of(part)
    tangent, step = element.derivatives["p"], 1e-4 * (start or 1.0)
    assert tangent.value == start

    near, exact = (
        [of(start + side * step) for side in (1.0, -1.0)]
        for of in (lambda p: redesigned(element, {"p": p}), lambda p: element_of(make(p)))
    )

    def slopes(what):
        for above, below in (near, exact):
            yield (what(above) - what(below)) / (2.0 * step)

    for key in ("mass", "J_rot", "center", "compliance", "accelerance"):
        found, expected = slopes(lambda one, key=key: getattr(one, key))
        size = max(np.abs(getattr(element, key)).max() / (start or 1.0), np.abs(expected).max())
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=2e-6 * size, err_msg=key)
    found, expected = slopes(lambda one: np.array([face.X for face in one.interfaces]))
    np.testing.assert_allclose(found, expected, atol=1e-6 * max(np.abs(expected).max(), 1e-3))
    size = np.sqrt(element.compliance.diagonal())
    assert_slope(*slopes(lambda one: responses(one, size)), 5e-5)
    # Statics of the whole mesh, apart from the modes.
    by_modes, _ = slopes(lambda one: one.compliance)
    unit = np.outer(size, size) / (start or 1.0)
    np.testing.assert_allclose(by_modes / unit, tangent.compliance / unit, atol=1e-6)


def test_few_modes_with_their_statics_beat_as_many_modes_alone():
    EI = rod().body(step=STEP).section.EI_z
    size = np.sqrt(element_of(rod()).compliance.diagonal())

    def made(factor, **options):
        part = rod(factor)
        part.derivative("bending", key="section.EI_z")
        return element_of(part, **options)

    expected = slope(lambda p: responses(element_of(rod(p / EI)), size), EI, SMALL * EI)
    whole, few = made(1.0), made(1.0, method="rubin", modes=16)
    alone = _lowest(whole, 16)

    def error(element):
        found = slope(
            lambda p: responses(redesigned(element, {"bending": p}), size), EI, SMALL * EI
        )
        return np.abs(found - expected).max() / np.abs(expected).max()

    assert error(whole) < 1e-6
    assert error(few) < 1e-3
    assert error(few) < 0.02 * error(alone)


def _lowest(element, k):
    """Its lowest modes, and nothing for what they leave."""
    modes, tangent = element.modes, element.derivatives["bending"]
    phi = modes.phi[:, :k]
    few = replace(modes, omega=modes.omega[:k], zeta=modes.zeta[:k], phi=phi)
    K, M = tangent.K[:k, :k], tangent.M[:k, :k]
    less = replace(tangent, K=K, M=M, phi=tangent.phi[:, :k])
    return replace(element, modes=few, derivatives={"bending": less})


def test_tangents_of_krylov_modes_are_right_in_their_band():
    part = bar()
    part.derivative("p", mesh=block(1.0))
    element = element_of(part, method="krylov")
    assert element.derivatives["p"].error < 1e-6
    size = np.sqrt(element.compliance.diagonal())
    found = slope(lambda p: responses(redesigned(element, {"p": p}), size), 0.0, SMALL)
    expected = slope(lambda p: responses(element_of(bar(p), method="modal"), size), 0.0, SMALL)
    assert_slope(found, expected, 1e-4)


def test_meshes_of_second_order_morph_with_their_middle_nodes():
    mesh = skfem.MeshTet.init_tensor(*[np.linspace(0, 0.1, 3)] * 3)
    mesh = mesh.with_boundaries({"end": lambda at: at[0] > 0.1 - 1e-9})

    def made(mesh):
        part = du.Part(mesh, du.Material(E=2e11, nu=0.3, rho=7800.0), order=2)
        part.interface("end", "end")
        return part

    part = made(mesh)
    part.derivative("longer", mesh=mesh.scaled([2.0, 1.0, 1.0]))
    element, longer = (
        one.superelement(step=2e-6) for one in (part, made(mesh.scaled([1.001, 1.0, 1.0])))
    )
    found = element.derivatives["longer"]
    np.testing.assert_allclose(found.mass, element.mass, rtol=1e-9)
    change = 1e3 * (longer.compliance - element.compliance)
    scale = np.sqrt(np.outer(*2 * [element.compliance.diagonal()]))
    np.testing.assert_allclose(found.compliance / scale, change / scale, atol=5e-3)


def test_powers_make_the_height_of_a_section_one_parameter():
    part = rod()
    height = {"section.EI_z": 3.0, "section.EI_y": 1.0, "section.EA": 1.0}
    part.derivative("height", powers=height | {"section.mass_per_length": 1.0})
    part.derivative("bending", key="section.EI_z")
    element = element_of(part)
    height, bending = (element.derivatives[name] for name in ("height", "bending"))
    assert height.value == 1.0
    np.testing.assert_allclose(height.mass, element.mass, rtol=1e-9)
    across = element.rows("tip").start + 1
    np.testing.assert_allclose(
        height.compliance[across, across],
        3.0 * bending.value * bending.compliance[across, across],
        # The rotary inertia that relieves the load changes too.
        rtol=1e-3,
    )


@pytest.mark.parametrize(
    "damping",
    [
        {"modal": 0.02},
        {"rayleigh": {"mass": 3.0, "stiffness": 1e-6}},
        {"loss_factor": 0.1, "band": (10.0, 5e3), "reference_frequency": 100.0},
    ],
    ids=["modal", "rayleigh", "loss"],
)
def test_damping_follows_the_frequencies(damping):
    def made(factor):
        part = rod(factor)
        part.damping(**damping)
        part.derivative("bending", key="section.EI_z")
        return element_of(part)

    element = made(1.0)
    EI = element.derivatives["bending"].value
    size = np.sqrt(element.compliance.diagonal())
    found = slope(lambda p: responses(redesigned(element, {"bending": p * EI}), size), 1.0, SMALL)
    assert_slope(found, slope(lambda p: responses(made(p), size), 1.0, SMALL), 2e-5)


def test_several_parameters_and_factors_go_together():
    part = rod()
    part.derivative("bending", key="section.EI_z")
    part.derivative("stretch", key="section.EA")
    element = element_of(part)
    values = {name: 1.01 * one.value for name, one in element.derivatives.items()}
    both = redesigned(scaled(element, stiffness=2.0), values)
    same = scaled(
        redesigned(redesigned(element, {"bending": values["bending"]}), values), stiffness=2.0
    )
    np.testing.assert_array_equal(both.modes.omega, same.modes.omega)
    assert both.variation.tables == same.variation.tables
    assert both.base is element
    # Linear in both, so that this is exact.
    exact = rod(1.01).body(step=STEP)
    exact = build(with_numbers(exact, {"section.EA": values["stretch"]}))
    np.testing.assert_allclose(both.compliance, exact.compliance / 2.0, rtol=1e-6, atol=1e-12)
    with pytest.raises(
        SuperelementError, match=r"bending: expected .* where the derivatives of rod"
    ):
        redesigned(element, {"bending": 1.2 * element.derivatives["bending"].value})
    with pytest.raises(
        SuperelementError, match="no derivative by 'width'; there are: bending, str"
    ):
        redesigned(element, {"width": 1.0})


def test_the_reach_ends_where_the_first_order_errs_by_a_hundredth():
    part = plate()
    part.derivative("thickness", key="shell.thickness")
    element = element_of(part)
    tangent = element.derivatives["thickness"]
    t = tangent.value + tangent.reach
    exact = element_of(plate(t)).compliance
    first_order = element.compliance + tangent.reach * tangent.compliance
    scale = np.sqrt(element.compliance.diagonal())
    assert 0.003 < (np.abs(exact - first_order) / np.outer(scale, scale)).max() < 0.03


def test_the_reach_is_no_rounding_of_an_interface_at_the_center():
    """Which stands at 1e-17 from it, and moves as little."""
    steel = du.Material(E=2e11, nu=0.3, rho=7800.0)
    section = du.Section.rectangle(steel, 0.02, 0.01, orientation=(0.0, 1.0, 0.0))
    part = du.Beam(np.linspace([0.0] * 3, [0.77, 0.0, 0.0], 11), section=section, name="hub")
    part.interface("middle", (0.385, 0.0, 0.0))
    part.derivative("bending", key="section.EI_z")
    tangent = element_of(part).derivatives["bending"]
    assert 0.09 * tangent.value < tangent.reach <= 0.1 * tangent.value


def test_files_of_a_body_are_those_of_its_derivatives_too(tmp_path):
    source = Path(__file__).parents[2] / "meshes/bar"
    for name in ("solid.msh", "other.msh"):
        (tmp_path / name).write_bytes((source / "solid.msh").read_bytes())
    text = (source / "solid.toml").read_text()
    (tmp_path / "bar.toml").write_text(f'{text}\n[derivatives.p]\nmesh = "other.msh"\n')
    names = [path.name for path in files_of(read_body(tmp_path / "bar.toml"))]
    assert names == ["solid.msh", "other.msh"]


def test_derivatives_are_written_and_read(tmp_path):
    part = rod()
    part.derivative("bending", key="section.EI_z")
    element = element_of(part)
    write(element, tmp_path / "rod.h5")
    back = read(tmp_path / "rod.h5").derivatives["bending"]
    for name, value in vars(element.derivatives["bending"]).items():
        np.testing.assert_array_equal(getattr(back, name), value)


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (lambda group: group.__delitem__("K"), r"dataset 'K' is missing"),
        (lambda group: group["K"].__setitem__((0, 1), 1e30), r"K: expected symmetry"),
        (lambda group: group.attrs.__setitem__("reach", -1.0), r"reach: expected a positive"),
        (lambda group: group["mass"].__setitem__((), np.nan), r"mass: expected finite"),
        (lambda group: group.__delitem__("X"), r"X"),
    ],
    ids=["no K", "asymmetric", "reach", "nan", "no X"],
)
def test_a_damaged_derivative_is_refused_by_its_name(tmp_path, change, expected):
    part = rod()
    part.derivative("bending", key="section.EI_z")
    write(element_of(part), tmp_path / "rod.h5")
    with h5py.File(tmp_path / "rod.h5", "a") as file:
        change(file["derivatives/bending"])
    with pytest.raises(SuperelementError, match=rf"rod\.h5: derivatives/bending: .*{expected}"):
        read(tmp_path / "rod.h5")


def test_files_of_version_6_are_read_without_derivatives(tmp_path):
    write(element_of(rod()), tmp_path / "rod.h5")
    with h5py.File(tmp_path / "rod.h5", "a") as file:
        file.attrs["version"] = 6
    assert read(tmp_path / "rod.h5").derivatives == {}


def test_info_lists_derivatives(tmp_path):
    part = rod()
    part.derivative("bending", key="section.EI_z")
    write(element_of(part), tmp_path / "rod.h5")
    result = CliRunner().invoke(app, ["info", str(tmp_path / "rod.h5")])
    assert "bending" in result.output


def test_a_body_file_with_a_mesh_to_morph_to_is_written_and_read(tmp_path):
    part = bar()
    part.derivative("p", mesh=block(1.0))
    part.derivative("E", key="material.E")
    part.write(tmp_path / "bar.toml", step=STEP)
    element = build(read_body(tmp_path / "bar.toml"))
    expected = element_of(part).derivatives["p"]
    np.testing.assert_allclose(element.derivatives["p"].mass, expected.mass, rtol=1e-9)


BAD = {
    "one of key, powers and mesh, found none": {},
    "one of key, powers and mesh, found key and powers": {"key": "section.EA", "powers": {}},
}


@pytest.mark.parametrize("expected", BAD)
def test_a_derivative_is_of_one_kind(expected):
    with pytest.raises(BodyError, match=f"p: expected {expected}"):
        rod().derivative("p", **BAD[expected])


@pytest.mark.parametrize(
    "key", ["section.EI_x", "impulse.step", "section", "section.orientation", "sections.a.EA"]
)
def test_a_key_is_that_of_a_number_of_stiffness_or_mass(key):
    part = rod()
    part.derivative("p", key=key)
    with pytest.raises(ValueError, match=rf"derivatives.p: expected the key .* found '{key}'"):
        part.body(step=STEP)


def test_a_value_that_the_body_cannot_have_beside_its_own_is_named():
    part = du.Part(block(), du.Material(E=2e11, nu=0.495, rho=7800.0))
    part.interface("tip", "right")
    part.derivative("p", key="material.nu")
    expected = r"derivatives\.p: beside the value of the body: .*nu"
    with pytest.raises(BodyError, match=expected):
        element_of(part)


def test_modes_that_miss_the_change_of_the_compliance_are_told():
    part = rod()
    part.derivative("p", key="section.EI_z")
    with pytest.warns(PlausibilityWarning, match=r"derivatives\.p: the modes miss 1\.8e-02"):
        element_of(part, method="craig-bampton", modes=1)


def test_what_has_no_derivative_is_refused():
    part = rod()
    part.derivative("p", key="section.EA")
    part.rotation()
    with pytest.raises(ValueError, match=r"derivatives: expected no \[rotation\]"):
        part.body(step=STEP)
    part = bar()
    part.derivative("p", key="material.E")
    with pytest.raises(ValueError, match=r"derivatives: need modes, which impulse.method march"):
        part.body(step=STEP, duration=10 * STEP, method="march")


def test_a_mesh_that_morphs_has_its_cells_and_interfaces_by_group():
    part = bar()
    coarse = skfem.MeshHex.init_tensor(*[np.linspace(0, 0.1, 3)] * 3)
    part.derivative("p", mesh=coarse)
    with pytest.raises(BodyError, match=r"derivatives\.p: mesh: expected the cells"):
        element_of(part)
    part = du.Part(block(), du.Material(E=2e11, nu=0.3, rho=7800.0))
    part.interface("tip", du.plane(x=0.3))
    part.derivative("p", mesh=block(1.0))
    with pytest.raises(
        ValueError, match=r"expected interfaces by group, .* interfaces\.tip by plane"
    ):
        part.body(step=STEP)
