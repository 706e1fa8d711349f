"""Factors and design parameters of superelements as parameters, beside rebuilds."""

import duhamel as du
import numpy as np
import pytest
from duhamel import results, study, superelement
from duhamel.files import OverwriteError
from duhamel.solver import ModelError, read_model, simulate, write_model
from duhamel.study import StudyError, sensitivities

E, RHO = 7e10, 2700.0
STRETCH = "max |displacement:rod.tip:x|"


def part(section=None, e=1.0, r=1.0, eta=0.1):
    section = section or du.Section.rectangle(
        du.Material(E=e * E, nu=0.3, rho=r * RHO), 0.02, 0.01, orientation=(0.0, 1.0, 0.0)
    )
    made = du.Beam(np.linspace([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], 6), section=section, name="rod")
    made.interface("root", (0.0, 0.0, 0.0))
    made.interface("tip", (1.0, 0.0, 0.0))
    made.damping(loss_factor=eta, band=(10.0, 1e4))
    made.recover()
    return made


def rod(e=1.0, r=1.0, eta=0.1):
    return part(None, e, r, eta).superelement(step=2e-5, duration=1e-2)


def swung(element):
    """The rod on a hinge, struck at its tip."""
    m = du.Mechanism()
    body = m.add(element, name="rod")
    m.add(du.joints.Revolute(m.ground, body["root"], axis="z", name="hinge"))
    m.add(du.loads.Force(body["tip"], [0, 1, 0], du.signals.HalfSine(50.0, 2e-3)))
    m.simulate(0.01)
    return m


@pytest.fixture
def model(tmp_path):
    """The path of a model file, beside its superelement."""
    superelement.write(rod(), tmp_path / "rod.h5")
    swung(tmp_path / "rod.h5").write(tmp_path / "swing.toml")
    return tmp_path / "swing.toml"


def with_scale(path, factors):
    text = path.read_text().replace('"rod.h5"', f'"rod.h5"\nscale = {{{factors}}}')
    path.write_text(text)
    return path


def test_a_run_with_factors_is_that_of_a_rebuild(model, tmp_path):
    path = with_scale(model, "stiffness = 1.2, density = 0.9, damping = 1.1")
    found = simulate(read_model(path), output=tmp_path / "run.h5")
    expected = swung(rod(1.2, 0.9, 0.11)).simulate(0.01).results
    for quantity in ("position", "velocity"):
        one, other = (getattr(run.body("rod"), quantity) for run in (found, expected))
        np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-9 * np.abs(other).max())
    # Fields are read from the file of the superelement, which has other modes.
    back = results.Results.read(tmp_path / "run.h5")
    one, other = (run.displacement("rod", 0.005) for run in (back, expected))
    np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-6 * np.abs(other).max())
    assert '"density": 0.9' in back.superelement_files["rod"].variation


def test_a_model_with_factors_is_written_and_read_back(model, tmp_path):
    one = read_model(with_scale(model, "density = 2.0"))
    write_model(one, tmp_path / "again.toml")
    again = read_model(tmp_path / "again.toml")
    assert again.bodies["rod"].mass == one.bodies["rod"].mass == 2.0 * rod().mass
    assert again.bodies["rod"].superelement.base.mass == rod().mass


def test_a_rigid_body_with_the_mass_of_a_superelement_scales_too(model):
    path = with_scale(model, "density = 2.0")
    path.write_text(path.read_text().replace("scale", "rigid = true\nscale"))
    assert read_model(path).bodies["rod"].mass == pytest.approx(2.0 * rod().mass)


def test_bodies_of_the_same_factors_share_their_superelement(model):
    text = with_scale(model, "density = 2.0").read_text()
    more = text + '\n[bodies.other]\nsuperelement = "rod.h5"\nscale = {density = 2.0}\n'
    model.write_text(more)
    bodies = read_model(model).bodies
    assert bodies["rod"].superelement is bodies["other"].superelement


def test_derivatives_by_factors_are_those_by_rebuilds(model):
    keys = {name: f"bodies.rod.scale.{name}" for name in ("stiffness", "density", "damping")}
    output = "final velocity:rod.tip:y"
    found = sensitivities(read_model(model), keys, [output])

    def last(e=1.0, r=1.0, eta=0.1):
        made = swung(rod(e, r, eta)).simulate(0.01).results
        return study.outputs.values(made, {"y": output})["y"]

    d = 1e-4
    by_rebuilds = [
        (last(**{name: base * (1 + d)}) - last(**{name: base * (1 - d)})) / (2 * d)
        for name, base in (("e", 1.0), ("r", 1.0), ("eta", 0.1))
    ]
    np.testing.assert_allclose(found.derivative[0], by_rebuilds, rtol=1e-5)
    assert (found.error[0] < 1e-5 * np.abs(found.derivative[0])).all()


def test_a_sweep_varies_factors_that_the_model_file_has_not(model, tmp_path):
    (tmp_path / "masses.toml").write_text(
        """
        model = "swing.toml"
        [parameters]
        bodies.rod.scale.density = [1, 2]
        [outputs]
        y = "final position:rod.tip:y"
        """
    )
    read = study.read_study(tmp_path / "masses.toml")
    one, two = study.sweep(read, workers=0)
    assert one.numbers["y"] > 1.5 * two.numbers["y"] > 0.0


def test_what_cannot_scale_is_named_by_its_body(model):
    text = model.read_text()
    with pytest.raises(ModelError, match=r"scale\.stiffness"):
        read_model(with_scale(model, "stiffness = -1"))
    model.write_text(text)
    with pytest.raises(ModelError, match=r"bodies\.rod: scale: damping: expected a loss factor"):
        read_model(with_scale(model, "damping = 20"))
    model.write_text(text)
    with pytest.raises(ModelError, match=r"rod\.scale: unknown key 'rho'"):
        read_model(with_scale(model, "rho = 2"))
    model.write_text(text)
    with pytest.raises(StudyError, match="no 'weight' in bodies"):
        sensitivities(
            read_model(model), ["bodies.weight.scale.density"], ["final position:rod.tip:y"]
        )


@pytest.fixture
def designed(tmp_path):
    """A model file whose superelement has a derivative by its bending stiffness."""
    made = part()
    made.derivative("bending", key="section.EI_z")
    element = made.superelement(step=2e-5, duration=1e-2)
    superelement.write(element, tmp_path / "rod.h5")
    swung(tmp_path / "rod.h5").write(tmp_path / "swing.toml")
    return tmp_path / "swing.toml"


def test_derivatives_by_a_design_parameter_are_those_by_rebuilds(designed):
    output = "final velocity:rod.tip:y"
    model = read_model(designed)
    found = sensitivities(model, {"bending": "bodies.rod.design.bending"}, [output])
    EI = model.bodies["rod"].superelement.derivatives["bending"].value

    def last(factor):
        made = part()
        section = made.body(step=2e-5).section
        changed = section.model_copy(update={"EI_z": factor * section.EI_z})
        run = swung(part(changed).superelement(step=2e-5, duration=1e-2)).simulate(0.01)
        return study.outputs.values(run.results, {"y": output})["y"]

    d = 1e-4
    by_rebuilds = (last(1 + d) - last(1 - d)) / (2 * d * EI)
    assert found.parameters["bending"] == EI
    assert found.derivative[0, 0] == pytest.approx(by_rebuilds, rel=1e-5)
    assert found.error[0, 0] < 1e-5 * abs(by_rebuilds)


def test_a_study_file_names_a_design_parameter_and_its_value_is_that_of_the_superelement(designed):
    (designed.parent / "bending.toml").write_text(
        """
        model = "swing.toml"
        parameters.bodies.rod.design.bending.uniform = [200, 300]
        outputs.y = "final velocity:rod.tip:y"
        """
    )
    found = study.sensitivities_of(designed.parent / "bending.toml")
    element = read_model(designed).bodies["rod"].superelement
    assert list(found.parameters.values()) == [element.derivatives["bending"].value]


def test_cases_beyond_the_reach_of_a_derivative_fail_and_say_so(designed):
    EI = read_model(designed).bodies["rod"].superelement.derivatives["bending"].value
    (designed.parent / "far.toml").write_text(
        f"""
        model = "swing.toml"
        parameters.bodies.rod.design.bending = [{EI}, {2 * EI}]
        outputs.y = "final velocity:rod.tip:y"
        """
    )
    near, far = study.sweep(study.read_study(designed.parent / "far.toml"), workers=0)
    assert not near.message
    assert "bodies.rod: design: bending: expected" in far.message
    with pytest.raises(StudyError, match=r"bodies\.rod\.design\.width: .*there are: bending"):
        sensitivities(
            read_model(designed), ["bodies.rod.design.width"], ["final velocity:rod.tip:y"]
        )


def test_fields_of_a_redesigned_body_are_not_known(designed):
    path = with_scale(designed, "")
    text = path.read_text().replace("scale = {}", "design = {bending = 117}")
    EI = read_model(designed).bodies["rod"].superelement.derivatives["bending"].value
    path.write_text(text.replace("117", str(1.01 * EI)))
    found = simulate(read_model(path))
    with pytest.raises(results.RecoveryError, match=r"fields are not known with design\.bending"):
        found.displacement("rod", 0.005)


def test_a_fit_finds_the_factor_of_a_stiffness_and_writes_it(model):
    text = model.read_text()
    simulate(read_model(with_scale(model, "stiffness = 1.07")), output=model.parent / "test.h5")
    model.write_text(text)
    (model.parent / "stiffness.toml").write_text(
        """
        model = "swing.toml"
        parameters.bodies.rod.scale.stiffness.uniform = [0.9, 1.2]
        [[fit.series]]
        quantity = "velocity:rod.tip:y"
        file = "test.h5"
        """
    )
    found = study.fit(model.parent / "stiffness.toml", model.parent / "fitted.toml")
    assert found.parameters[0].value == pytest.approx(1.07, rel=1e-6)
    variation = read_model(model.parent / "fitted.toml").bodies["rod"].superelement.variation
    assert variation.scale["stiffness"] == found.parameters[0].value


def test_fields_of_a_scaled_body_in_memory_are_those_of_its_file(model, tmp_path):
    found = simulate(read_model(with_scale(model, "density = 0.5")), output=tmp_path / "run.h5")
    expected = found.displacement("rod", 0.005)
    given = results.Results.read(tmp_path / "run.h5", {"rod": rod()})
    np.testing.assert_allclose(
        given.displacement("rod", 0.005), expected, atol=1e-6 * np.abs(expected).max()
    )


FACTORS = ("scale.stiffness", "scale.density", "scale.damping")


def test_derivatives_by_dual_numbers_are_those_by_differences(designed):
    model = read_model(designed)
    keys = {key: f"bodies.rod.{key}" for key in (*FACTORS, "design.bending")}
    for parameters in (keys, {"bending": keys["design.bending"]}):
        dual, other = (
            sensitivities(model, parameters, ["final velocity:rod.tip:y"], method=method)
            for method in ("dual", "differences")
        )
        np.testing.assert_allclose(dual.derivative, other.derivative, rtol=1e-6)
        # Neither knows less than it says; the arrays behind both are rounded.
        assert (
            np.abs(dual.derivative - other.derivative) <= 10.0 * (dual.error + other.error)
        ).all()
        assert (dual.error >= 1e-11 * np.abs(dual.derivative)).all()


def test_modes_of_coinciding_frequencies_stay_next_to_those_of_the_file():
    square = du.Section.rectangle(
        du.Material(E=E, nu=0.3, rho=RHO), 0.02, 0.02, orientation=(0.0, 1.0, 0.0)
    )
    made = part(square)
    made.derivative("bending", powers={"section.EI_z": 1.0, "section.EI_y": 1.0})
    element = made.superelement(step=2e-5, duration=1e-2)
    start = element.derivatives["bending"].value
    largest = np.abs(element.modes.phi).max()
    for share in (-2e-4, -1e-4, 0.0, 1e-4, 2e-4):
        other = superelement.redesigned(element, {"bending": start * (1.0 + share)})
        away = np.abs(other.modes.phi - element.modes.phi).max()
        assert away <= (abs(share) + 1e-9) * largest


def test_the_superelement_of_a_model_is_no_output_of_a_search_or_a_fit(model):
    (model.parent / "stiffness.toml").write_text(
        """
        model = "swing.toml"
        parameters.bodies.rod.scale.stiffness.uniform = [0.9, 1.2]
        outputs.y = "final velocity:rod.tip:y"
        optimize.minimize = "y"
        [[fit.series]]
        quantity = "velocity:rod.tip:y"
        file = "test.csv"
        """
    )
    (model.parent / "test.csv").write_text("0, 0\n0.001, 0\n")
    for search in (study.optimize, study.fit):
        with pytest.raises(OverwriteError, match="an input of the"):
            search(model.parent / "stiffness.toml", model.parent / "rod.h5")
