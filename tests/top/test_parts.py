"""Parts in Python are body files in other words."""

import duhamel as du
import numpy as np
import pytest
import skfem
from duhamel import preprocess
from duhamel.inputs import InputError

ALUMINIUM = du.Material(E=70e9, nu=0.33, rho=2700.0)
STEEL = du.Material(E=210e9, nu=0.3, rho=7850.0)


def bar(**more) -> du.Part:
    mesh = skfem.MeshHex.init_tensor(
        np.linspace(0.0, 1.0, 6), np.linspace(0.0, 0.1, 3), np.linspace(0.0, 0.1, 3)
    )
    part = du.Part(mesh, ALUMINIUM, name="bar", **more)
    part.interface("root", du.plane(x=0.0))
    part.interface("tip", du.plane(x=1.0))
    return part


def test_a_part_is_written_as_a_body_file_that_makes_the_same_superelement(tmp_path):
    part = bar()
    part.interface("node", [0.4, 0.0, 0.1])
    part.mass("lump", 0.2, interface="tip", inertia=[1e-4, 2e-4, 2e-4])
    part.load("wind", du.plane(z=0.1), pressure=1.0)
    part.sensor("gauge", [0.5, 0.05, 0.1], direction=[1, 0, 0])
    part.damping(modal=0.01)
    part.recover()
    part.write(tmp_path / "bar.toml", step=2e-5, duration=1e-3, band=2e3, tolerance=1e-7)
    body = preprocess.read_body(tmp_path / "bar.toml")
    assert (body.impulse.band, body.impulse.tolerance) == (2e3, 1e-7)
    assert body.impulse.steps == 50
    assert body.mesh == tmp_path / "bar.vtu"
    from_file = preprocess.build(body)
    in_memory = part.superelement(step=2e-5, duration=1e-3, band=2e3, tolerance=1e-7)
    np.testing.assert_array_equal(from_file.compliance, in_memory.compliance)
    np.testing.assert_array_equal(from_file.kernel.g, in_memory.kernel.g)
    np.testing.assert_array_equal(from_file.recovery.phi, in_memory.recovery.phi)
    assert [pattern.name for pattern in in_memory.patterns] == ["wind"]
    again = du.Part.read(tmp_path / "bar.toml").superelement()
    np.testing.assert_array_equal(again.compliance, in_memory.compliance)


def test_groups_of_a_mesh_in_memory_are_kept_in_its_file(tmp_path):
    mesh = skfem.MeshHex.init_tensor(*[np.linspace(0.0, 1.0, 3)] * 3)
    mesh = mesh.with_boundaries({"left": lambda x: x[0] == 0.0})
    mesh = mesh.with_subdomains({"low": lambda x: x[2] < 0.5, "high": lambda x: x[2] > 0.5})
    part = du.Part(mesh, {"low": STEEL, "high": ALUMINIUM})
    part.interface("left", "left")
    part.write(tmp_path / "cube.toml", step=1e-5)
    read = preprocess.build(preprocess.read_body(tmp_path / "cube.toml"))
    assert read.mass == pytest.approx(0.5 * (7850.0 + 2700.0), rel=1e-12)
    np.testing.assert_array_equal(read.compliance, part.superelement(step=1e-5).compliance)


def test_a_part_in_a_folder_that_is_not_there_is_an_error_that_names_the_file(tmp_path):
    with pytest.raises(preprocess.MeshError, match=r"nowhere/bar\.vtu: cannot be written: No such"):
        bar().write(tmp_path / "nowhere" / "bar.toml", step=2e-5)
    part = bar()
    part.write(tmp_path / "bar.toml", step=2e-5)
    with pytest.raises(
        preprocess.BodyError, match=r"nowhere/bar\.toml: cannot be written: No such"
    ):
        du.Part.read(tmp_path / "bar.toml").write(tmp_path / "nowhere" / "bar.toml")


def test_selections_are_joined_by_and():
    part = bar()
    part.interface("corner", du.plane(x=1.0) & du.box([1.0, 0.0, 0.0], [1.0, 0.05, 0.05]))
    interfaces = preprocess.assemble(part.body(step=1e-5)).interfaces
    np.testing.assert_allclose(interfaces[2].X - interfaces[1].X, [0.0, -0.025, -0.025], atol=1e-15)
    with pytest.raises(ValueError, match="found plane twice"):
        du.plane(x=1.0) & du.plane(y=0.0)


@pytest.mark.parametrize("scale", [1.0, 1e-3])
def test_the_scale_of_a_mesh_in_memory_is_its_unit(scale):
    mesh = skfem.MeshHex.init_tensor(*[np.linspace(0.0, 1.0, 3) / scale] * 3)
    part = du.Part(mesh, STEEL, scale=scale)
    part.interface("foot", du.plane(z=0.0))
    assert preprocess.assemble(part.body(step=1e-5)).rigid.mass == pytest.approx(7850.0, rel=1e-12)


def test_a_beam_deflects_as_timoshenko_says():
    length, width, height = 1.0, 0.02, 0.05
    section = du.Section.rectangle(STEEL, width, height, orientation=(0.0, 1.0, 0.0))
    beam = du.Beam(np.linspace([0.0] * 3, [length, 0.0, 0.0], 11), section=section)
    beam.interface("root", [0.0, 0.0, 0.0])
    beam.interface("tip", [length, 0.0, 0.0])
    H = beam.superelement(step=1e-5).compliance
    load = np.zeros(12)
    load[[2, 8, 4]] = -1.0, 1.0, length  # a force at the tip, held in balance at the root
    u = H @ load
    deflection = u[8] - u[2] + u[4] * length
    EI, GA = section.EI_y, section.GA_z
    assert deflection == pytest.approx(length**3 / (3.0 * EI) + length / GA, rel=1e-9)


def test_sections_have_the_moments_of_their_shapes():
    square = du.Section.rectangle(STEEL, 0.1, 0.1)
    G = STEEL.shear
    # Timoshenko and Goodier, Theory of Elasticity: torsion constants of a square and of 1:2
    assert pytest.approx(0.140577 * 0.1**4, rel=1e-5) == square.GJ / G
    assert (
        pytest.approx(0.228682 * 0.2 * 0.1**3, rel=1e-5)
        == du.Section.rectangle(STEEL, 0.2, 0.1).GJ / G
    )
    flat = du.Section.rectangle(STEEL, width=0.3, height=0.1)
    assert (flat.EI_y, flat.EI_z) == pytest.approx(
        (210e9 * 0.3 * 0.1**3 / 12.0, 210e9 * 0.1 * 0.3**3 / 12.0)
    )
    tube = du.Section.circle(STEEL, 0.05, inner=0.04)
    assert pytest.approx(np.pi / 2.0 * (0.05**4 - 0.04**4)) == tube.GJ / G
    assert tube.mass_per_length == pytest.approx(7850.0 * np.pi * (0.05**2 - 0.04**2))
    # Cowper 1966: 6 (1 + nu) / (7 + 6 nu) of a full circle; a thin tube: 2 (1 + nu) / (4 + 3 nu)
    full = du.Section.circle(STEEL, 0.05)
    assert full.GA_y / (G * np.pi * 0.05**2) == pytest.approx(7.8 / 8.8)
    thin = du.Section.circle(STEEL, 1.0, inner=0.99999)
    assert thin.GA_y / (G * thin.EA / STEEL.young) == pytest.approx(2.6 / 4.9, rel=1e-4)


def test_what_looks_wrong_is_a_warning():
    part = bar()
    part._table["material"] = du.Material(E=70e3, nu=0.33, rho=2700.0)
    with pytest.warns(preprocess.PlausibilityWarning, match="bar: "):
        part.superelement(step=2e-3)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: du.Material(E=-1.0, nu=0.3, rho=1.0), "Material: E: "),
        (lambda: du.Material(E=1.0, nu=0.3), "Material: rho: missing"),
        (lambda: du.plane(), "plane: expected one of x, y and z, or point and normal"),
        (lambda: du.plane(x=1.0, y=2.0), "plane: expected one of x, y and z, or point and normal"),
        (lambda: du.box([0.0], [1.0]), "expected three numbers, found [0.0]"),
        (lambda: du.Part(bar()._table["mesh"], 3.0), "Part: expected a Material, a Section"),
        (lambda: bar().interface("root", du.plane(x=0.0)), "interfaces: 'root' is there already"),
        (lambda: bar().load("p", pressure=1.0), "part 'bar': loads: p: pressure: expected what it"),
        (lambda: bar().mass("m", -1.0, interface="tip"), "part 'bar': masses: m: mass: "),
        (lambda: bar().superelement(), "part 'bar': step: expected that of the impulse responses"),
        (
            lambda: bar().superelement(step=1e-5, durration=1.0),
            "part 'bar': unknown keyword 'durration'; known are step, duration, band",
        ),
        (lambda: bar().superelement(step=1e-5, duration=-1.0), "duration: expected a positive"),
        (
            lambda: bar().superelement(step=1e-5, band=1e9),
            "part 'bar': impulse: band: expected at most the Nyquist frequency",
        ),
        (lambda: du.Beam([[0, 0, 0], [1, 0, 0]]), "Beam: expected a section, found none"),
        (lambda: du.Section.rectangle(du.Material(E=1.0, nu=0.3, G=1.0, rho=1.0), 1.0, 1.0), "iso"),
    ],
)
def test_what_cannot_be_a_part_is_one_line(make, message):
    with pytest.raises((InputError, preprocess.PreprocessError, ValueError)) as failure:
        make()
    assert message in str(failure.value)
    assert "\n" not in str(failure.value)


def test_a_part_is_drawn_with_its_interfaces(tmp_path):
    part = bar()
    picture = part.draw()
    assert picture.save(tmp_path / "bar.png").stat().st_size > 10_000
    words = {text.get_text() for axes in picture.figure.axes for text in axes.texts}
    assert {"root", "tip"} <= words
    assert part._repr_html_().startswith("<p>&lt;Part &#x27;bar&#x27; on mesh in memory")


def test_a_part_with_a_surface_is_written_as_a_body_file_that_makes_the_same(tmp_path):
    mesh = skfem.MeshHex.init_tensor(
        np.linspace(0.0, 1.0, 6), np.linspace(0.0, 0.3, 4), np.linspace(0.0, 0.2, 4)
    )
    part = du.Part(mesh, ALUMINIUM, name="block")
    part.surface("face", du.plane(x=1.0))
    assert repr(part).endswith("interfaces: none, surfaces: face>")
    part.write(tmp_path / "block.toml", step=2e-5, band=2.5e3)
    read = du.Part.read(tmp_path / "block.toml").superelement()
    here = part.superelement(step=2e-5, band=2.5e3)
    np.testing.assert_allclose(read.surfaces.H, here.surfaces.H, rtol=1e-9, atol=1e-22)
    assert read.surface("face").facet_type == "quad"
    with pytest.raises(preprocess.BodyError, match="surfaces: 'face' is there already"):
        part.surface("face", "other")
    with pytest.raises(preprocess.BodyError, match=r"surfaces: top: .* found node"):
        part.surface("top", [0.0, 0.0, 0.0])
    with pytest.raises(preprocess.BodyError, match=r"impulse\.band: surfaces need"):
        part.superelement(step=2e-5)


def test_a_part_takes_frequencies_of_a_test_also_from_a_body_file(tmp_path):
    """Written to another folder than that of the test."""
    plain = bar().superelement(step=2e-5)
    places = [(0.0, 0.0, 0.0), (0.4, 0.0, 0.0), (1.0, 0.1, 0.0), (0.6, 0.1, 0.1), (1.0, 0.0, 0.1)]
    tested = bar()
    for k, place in enumerate(places):
        tested.sensor(f"p{k}", place)
    element = tested.superelement(step=2e-5)
    modes = np.argsort(element.modes.omega)[:4]
    frequencies = 0.97 * element.modes.omega[modes] / (2.0 * np.pi)
    shapes = element.channels.phi[:, modes].T
    folder = tmp_path / "test"
    folder.mkdir()
    np.savez(folder / "modes.npz", frequency=frequencies, damping=np.full(4, 0.01), shapes=shapes)
    rows = [f"p{k}, {x}, {y}, {z}, {axis}" for k, (x, y, z) in enumerate(places) for axis in "xyz"]
    (folder / "channels.csv").write_text("\n".join(["label, x, y, z, axis", *rows]))
    part = bar()
    part.measured(folder / "modes.npz", folder / "channels.csv", mass=1.1 * plain.mass)
    part.write(tmp_path / "bar.toml", step=2e-5)
    in_memory = part.superelement(step=2e-5)
    from_file = preprocess.build(preprocess.read_body(tmp_path / "bar.toml"))
    for found in (in_memory, from_file):
        assert found.measured.matched.all()
        assert found.mass == pytest.approx(1.1 * plain.mass, rel=1e-10)
        lowest = np.sort(found.modes.omega)[:4] / (2.0 * np.pi)
        np.testing.assert_allclose(lowest, np.sort(frequencies), rtol=1e-10)
