"""What is made of fields: damage by rainflow cycles, sound power, tables of pandas.

The body is a unit cube with two modes that are given by hand: on its skin one breathes, the other
one has stresses alone.
"""

import sys
from dataclasses import replace

import numpy as np
import pytest
from duhamel import Run
from duhamel.cli import app
from duhamel.results import ExportError, RecoveryError, SeriesError
from duhamel.results.fatigue import WoehlerLine, damage, damage_field, rainflow
from duhamel.results.radiation import AIR_DENSITY, AIR_SOUND_SPEED, radiated_power
from duhamel.solver import (
    Constant,
    FlexibleBody,
    Force,
    Harmonic,
    Model,
    Results,
    Settings,
    simulate,
)
from duhamel.superelement import (
    GeneralizedAlpha,
    Interface,
    Modes,
    Recovery,
    Superelement,
    read,
    sample_kernel,
    write,
)
from typer.testing import CliRunner

H, OMEGA, FORCE = 1e-4, np.array([400.0, 900.0]), 30.0
CORNERS = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
FACES = np.array(
    [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
)
PHI_C = np.array([[0.6, 0.3], [0.0, 0.0], [0.0, 0.0]])
"""displacements of the interface, along x alone"""
STRESS = np.zeros((8, 6, 2))
STRESS[3, 0, 0], STRESS[6, 5, 1] = 2e12, 3e12


@pytest.fixture(scope="module")
def cube(tmp_path_factory):
    modes = Modes(OMEGA, np.zeros(2), PHI_C)
    phi = np.stack([0.4 * CORNERS, np.zeros((8, 3))], axis=2)
    element = Superelement(
        name="cube",
        mass=2.0,
        J_rot=np.eye(3),
        center=np.zeros(3),
        interfaces=(Interface("tip", np.zeros(3), rotations=False),),
        kernel=sample_kernel(modes, H, GeneralizedAlpha(1.0), 100),
        modes=modes,
        compliance=PHI_C / OMEGA**2 @ PHI_C.T,
        accelerance=PHI_C @ PHI_C.T,
        recovery=Recovery(CORNERS, FACES, phi, STRESS, nodes=np.arange(11, 19)),
    )
    path = tmp_path_factory.mktemp("cube") / "cube.h5"
    write(path, element)
    return path


def run(cube, signal, output=None, t_end=0.2):
    given = isinstance(cube, FlexibleBody)
    return simulate(
        Model(
            {"cube": cube if given else FlexibleBody(read(cube), source=str(cube))},
            loads=[Force("cube.tip", [1.0, 0.0, 0.0], signal)],
            settings=Settings(t_end=t_end, step=H, rho_inf=1.0),
        ),
        output=output,
    )


@pytest.fixture(scope="module")
def stepped(cube, tmp_path_factory):
    path = tmp_path_factory.mktemp("run") / "stepped.h5"
    run(cube, Constant(FORCE), path)
    return path


def rate(t):
    """Of the breathing mode under a step of the force."""
    return PHI_C[0, 0] * FORCE / OMEGA[0] * np.sin(OMEGA[0] * t)


def test_the_sound_power_of_a_cube_that_breathes(stepped):
    """rho c A v_n^2: faces move by 0.5 x 0.4 of the rate; in bands all of it is at 63.7 Hz."""
    results = Results.read(stepped)
    found = radiated_power(results, "cube")
    exact = AIR_DENSITY * AIR_SOUND_SPEED * 6.0 * (0.2 * rate(results.time)) ** 2
    assert found.area == pytest.approx(6.0, rel=1e-14)
    # Later the phase error of the time step grows.
    np.testing.assert_allclose(found.power[:300], exact[:300], rtol=0, atol=4e-3 * exact.max())
    assert found.mean == pytest.approx(0.5 * exact.max(), rel=0.02)
    bands = found.bands(1)
    assert bands.center[bands.values.argmax()] == pytest.approx(63.1, abs=0.1)
    assert bands.values.sum() == pytest.approx(found.mean, rel=0.02)
    one = radiated_power(results, "cube", where=lambda X: X[:, 0] > 0.0)
    np.testing.assert_allclose(one.power, found.power / 6.0, rtol=1e-12)


def test_the_sound_power_of_a_body_that_moves_as_a_whole(cube):
    """Two faces of 1 m^2 push the air at the speed of the body; the elastic part is added."""
    results = run(cube, Constant(FORCE), t_end=0.1)
    v = results.body("cube").velocity[:, 0]
    assert v[-1] > 1.0
    found = radiated_power(results, "cube", rigid=True, density=1000.0, sound_speed=1500.0)
    breathing = 0.2 * rate(results.time)
    exact = 1.5e6 * ((v + breathing) ** 2 + (breathing - v) ** 2 + 4.0 * breathing**2)
    np.testing.assert_allclose(found.power, exact, rtol=1e-5, atol=1e-5 * exact.max())


def test_surfaces_that_cannot_radiate_are_refused(stepped):
    results = Results.read(stepped)
    with pytest.raises(RecoveryError, match="no surface 'top'; there are: none"):
        radiated_power(results, "cube", "top")
    with pytest.raises(RecoveryError, match="found no facets"):
        radiated_power(results, "cube", where=lambda X: X[:, 0] > 9.0)
    with pytest.raises(RecoveryError, match="where: expected shape"):
        radiated_power(results, "cube", where=lambda X: True)
    with pytest.raises(RecoveryError, match="density: expected a positive number"):
        radiated_power(results, "cube", density=0.0)


def test_rainflow_of_the_standard():
    """ASTM E1049-85, figure 6, as a history that repeats itself: ranges 3, 4, 7, 9."""
    amplitude, _ = rainflow(np.array([-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0]))
    assert sorted((2.0 * amplitude).tolist()) == [3.0, 4.0, 7.0, 9.0]
    for short in ([], [2.0], [2.0, 2.0]):
        assert len(rainflow(np.array(short))[0]) == 0
    with pytest.raises(SeriesError, match="rainflow: expected finite numbers"):
        rainflow(np.array([0.0, np.nan, 1.0]))


@pytest.mark.parametrize(
    ("given", "amplitude", "mean", "exact"),
    [
        ({}, 50.0, 0.0, 2.0**-5),
        ({"rule": "haibach"}, 50.0, 0.0, 2.0**-9),
        ({"rule": "haibach"}, 200.0, 0.0, 2.0**5),
        ({"rule": "original"}, 99.0, 0.0, 0.0),
        ({"rule": "original"}, 200.0, 0.0, 2.0**5),
        ({"mean_stress": 0.3}, 100.0, 50.0, 1.15**5),
        ({"mean_stress": 0.3}, 100.0, -50.0, 0.85**5),
    ],
)
def test_the_damage_of_a_sine(given, amplitude, mean, exact):
    wave = mean + amplitude * np.sin(np.linspace(0.0, 2.0 * np.pi * 7, 7 * 400 + 1))
    found = damage(wave, WoehlerLine(100.0, cycles=1e6, **given))
    assert found * 1e6 == pytest.approx(7.0 * exact, rel=1e-3)


def test_damage_is_where_the_stress_is(cube):
    """At node 14 along x, at node 17 in shear: the plane of the largest normal stress counts."""
    results = run(cube, Harmonic(FORCE, 10.0), t_end=0.5)
    line = WoehlerLine(50e6, slope=4.0)
    found = damage_field(results, "cube", line)
    assert np.flatnonzero(found.damage).tolist() == [3, 6]
    xx, xy = (results.stress_history("cube", [p])[:, 0, i] for p, i in ((3, 0), (6, 5)))
    np.testing.assert_allclose(xx, results.stress("cube", results.time)[:, 3, 0], rtol=1e-12)
    # Corners have planes of all directions, within 10 degrees of the worst one.
    for history, at in ((xx, 3), (xy, 6)):
        exact = damage(history, line)
        assert np.cos(np.radians(10.0)) ** 8 * exact < found.damage[at] <= exact
    by_mises = damage_field(results, "cube", line, "mises").damage
    assert by_mises[3] == pytest.approx(damage(xx, line), rel=1e-9)
    assert found.repetitions == pytest.approx(1.0 / found.damage.max())
    assert found.life == pytest.approx(0.5 * found.repetitions)


def test_on_a_smooth_surface_planes_across_it_count(cube):
    """Of one face of the cube: uniaxial stress in it, on planes that are 10 degrees apart."""
    element = read(cube)
    for turn in (0.0, 15.0, 45.0):
        c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
        stress = np.zeros((8, 6, 2))
        stress[4, :, 0] = 2e12 * np.array([0.0, c * c, s * s, c * s, 0.0, 0.0])
        face = replace(element.recovery, cells=FACES[1:2], stress=stress)
        body = FlexibleBody(replace(element, recovery=face))
        results = run(body, Harmonic(FORCE, 10.0))
        along = results.stress_history("cube", [4])[:, 0, 1:4] @ [1.0, 1.0, 0.0]
        exact = damage(along, line := WoehlerLine(50e6, slope=4.0))
        share = damage_field(results, "cube", line).damage[4] / exact
        assert np.cos(np.radians(5.0)) ** 8 * (1 - 1e-9) <= share <= 1.0 + 1e-9


def test_what_means_nothing_is_refused(stepped):
    for given in ({"limit": -1.0}, {"cycles": 0.0}, {"slope": 0.5}, {"mean_stress": 2.0}):
        with pytest.raises(SeriesError, match=f"{next(iter(given))}: expected"):
            WoehlerLine(**{"limit": 1.0} | given)
    with pytest.raises(SeriesError, match="rule: expected one of elementary, haibach, original"):
        WoehlerLine(1.0, rule="miner")
    results = Results.read(stepped)
    with pytest.raises(SeriesError, match="criterion: expected one of normal, mises, principal"):
        damage_field(results, "cube", WoehlerLine(1.0), "tresca")
    with pytest.raises(SeriesError, match="two or more recorded steps, found 1"):
        damage_field(results, "cube", WoehlerLine(1.0), rows=slice(3, 4))


def test_without_pylife_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "pylife", None)
    with pytest.raises(
        ExportError, match=r"fatigue needs pylife: pip install 'duhamel\[fatigue\]'"
    ):
        rainflow(np.array([0.0, 1.0]))


def test_the_commands(stepped, tmp_path):
    runner = CliRunner()
    given = ["fatigue", str(stepped), "--limit", "5e7", "--body", "cube", "-o", str(tmp_path)]
    told = runner.invoke(app, [*given, "acceleration:cube:x"])
    assert told.exit_code == 0, told.output
    assert "node 1" in told.output
    assert "accelerat" in told.output
    table = np.loadtxt(tmp_path / "stepped-cube-damage.csv", delimiter=",", skiprows=1)
    assert table[:, 0].tolist() == list(range(11, 19))
    assert (tmp_path / "stepped-cube-damage.vtkhdf").exists()
    refused = runner.invoke(app, ["fatigue", str(stepped), "--limit", "5e7"])
    assert refused.exit_code == 2
    heard = runner.invoke(app, ["radiation", str(stepped), "cube", "--fraction", "1"])
    assert heard.exit_code == 0, heard.output
    assert "6 m²" in heard.output
    wrong = runner.invoke(app, ["radiation", str(stepped), "ball"])
    assert wrong.exit_code == 1
    assert "the run has no flexible body 'ball'" in wrong.output


def test_quantities_as_a_table_of_pandas(stepped):
    run = Run.read(stepped)
    frame = run.to_pandas("cube.velocity", "energy:kinetic")
    names = [*(f"velocity:cube:{axis} [m/s]" for axis in "xyz"), "energy:kinetic [J]"]
    assert list(frame.columns) == names
    assert frame.index.name == "time [s]"
    np.testing.assert_array_equal(frame[names[0]], run["cube"].velocity[:, 0])
    spectrum = run.to_pandas("psd(velocity:cube:x)")
    assert spectrum.index.name == "frequency [Hz]"
    with pytest.raises(ExportError, match="is over other times or frequencies"):
        run.to_pandas("velocity:cube:x", "psd(velocity:cube:x)")
    with pytest.raises(ExportError, match="expected one or more quantities"):
        run.to_pandas()
