"""`duhamel export --to abaqus|nastran`: loads on a body at an instant, read back from the decks and
in equilibrium with the inertia of the rigid motion.
"""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.cli import app
from duhamel.preprocess.mesh.formats.abaqus_deck import keywords
from duhamel.preprocess.mesh.formats.nastran_deck import read_cards
from duhamel.results import Results
from duhamel.results.rotations import inverse, rotate
from duhamel.solver import (
    FlexibleBody,
    Force,
    Harmonic,
    Model,
    Settings,
    Start,
    Torque,
    simulate,
)
from duhamel.superelement import Pattern, write

DIGITS = 1e-9
"""of numbers in 16 characters"""


@pytest.fixture(params=[1.0, 1e-3])
def unit(request):
    """Of the mesh [m]."""
    return request.param


@pytest.fixture
def body(element, unit, tmp_path):
    """A body made by hand, heavy enough for the loads below, and its file."""
    source = replace(element.provenance, body=f'name = "beam"\nscale = {unit}\n')
    made = replace(element, mass=20.0, provenance=source)
    write(tmp_path / "beam.h5", made)
    return FlexibleBody(
        made,
        Start(rotation=[0.4, -0.7, 0.2], velocity=[2.0, 0.0, 0.0], angular_velocity=[1, 2, -3]),
        source=str(tmp_path / "beam.h5"),
    )


@pytest.fixture
def results_file(body, tmp_path):
    """It tumbles under gravity and loads in space."""
    loads = [
        Force("beam.tip", [1, 2, 3], Harmonic(1e-3, 30.0, offset=2e-3)),
        Force("beam.root", [0, -1, 1], Harmonic(1e-3, 11.0)),
        Torque("beam.root", [3, -1, 2], Harmonic(1e-3, 17.0)),
    ]
    model = Model({"beam": body}, loads=loads, gravity=[0, 0, -9.81], settings=Settings(t_end=0.05))
    simulate(model, output=tmp_path / "run.h5")
    return tmp_path / "run.h5"


def export(runner, file, *arguments):
    result = runner.invoke(app, ["export", str(file), str(file.parent / "out"), *arguments])
    assert result.exit_code == 0, result.output
    return file.parent / "out"


def of_abaqus(folder):
    """Places, forces and moments by node; body forces by label."""
    places = {
        data[0]: np.array(data[1:], dtype=float)
        for keyword in keywords(folder / "run-beam-nodes.inp")
        for data in keyword.data
    }
    concentrated, distributed = keywords(folder / "run-beam-loads.inp")
    wrenches = {node: np.zeros(6) for node in places}
    for node, dof, value in concentrated.data:
        wrenches[node][int(dof) - 1] = float(value)
    spread = {data[1]: np.array(data[2:], dtype=float) for data in distributed.data}
    gravity = spread["GRAV"][0] * spread["GRAV"][1:]
    omega = np.sqrt(spread["CENTRIF"][0]) * spread["CENTRIF"][4:]
    alpha = spread["ROTA"][0] * spread["ROTA"][4:]
    np.testing.assert_array_equal(spread["ROTA"][1:4], spread["CENTRIF"][1:4])
    return places, wrenches, gravity, omega, alpha, spread["CENTRIF"][1:4]


def of_nastran(folder):
    """The same. RACC pushes along the acceleration that it names, against that of the body."""
    places, wrenches, gravity, spins = {}, {}, None, {}
    for card in read_cards(folder / "run-beam.bdf", {}):
        numbers = [card.number(field) for field in range(5, 8)]
        if card.name == "GRID":
            places[card.text(2)] = np.array([card.number(field) for field in (4, 5, 6)])
        elif card.name in ("FORCE", "MOMENT"):
            first = 0 if card.name == "FORCE" else 3
            wrench = wrenches.setdefault(card.text(3), np.zeros(6))
            wrench[first : first + 3] += card.number(5) * np.array(
                [card.number(field) for field in (6, 7, 8)]
            )
        elif card.name == "GRAV":
            gravity = card.number(4) * np.array(numbers)
        elif card.name == "RFORCE":
            along = np.array([card.number(field) for field in (6, 7, 8)])
            spins[card.integer(2)] = (
                card.text(3),
                2 * np.pi * card.number(5) * along,
                2 * np.pi * card.number(10) * along,
            )
        else:
            assert card.name == "LOAD"
            combined = {card.integer(field) for field in (5, 7, 9, 11)}
    (center, omega, none), (_, nothing, alpha) = (spins[key] for key in sorted(spins))
    assert not none.any()
    assert not nothing.any()
    assert combined == {9001, 9002, *spins}
    return places, wrenches, gravity, omega, -alpha, places[center]


@pytest.mark.parametrize(
    ("program", "read", "accuracy"),
    [("abaqus", of_abaqus, 1e-14), ("nastran", of_nastran, DIGITS)],
)
def test_forces_and_moments_of_a_deck_are_in_equilibrium(
    runner, results_file, body, unit, program, read, accuracy
):
    folder = export(runner, results_file, "--to", program, "--at", "0.02")
    places, wrenches, gravity, omega, alpha, center = read(folder)
    element, results = body.superelement, Results.read(results_file)
    row = int(np.abs(results.time - 0.02).argmin())
    np.testing.assert_allclose(center, element.center / unit, rtol=DIGITS)
    tip = next(node for node in wrenches if node.endswith("2"))
    np.testing.assert_allclose(
        places[tip], (element.center + element.interface("tip").X) / unit, rtol=DIGITS
    )
    motion = results.body("beam")
    back = inverse(motion.R[row : row + 1])
    force = results.frame("beam.tip").force[row, :3]
    np.testing.assert_allclose(wrenches[tip][:3], rotate(back, force)[0], rtol=DIGITS)
    np.testing.assert_allclose(omega, motion.v[row, 3:], rtol=DIGITS)

    mass, J = element.mass * unit, element.J_rot / unit
    forces = sum(wrench[:3] for wrench in wrenches.values())
    moments = sum(
        wrench[3:] + np.cross(places[node] - center, wrench[:3])
        for node, wrench in wrenches.items()
    )
    size = sum(np.linalg.norm(wrench[:3]) for wrench in wrenches.values())
    np.testing.assert_allclose(forces + mass * gravity, 0.0, atol=accuracy * size)
    largest = np.linalg.norm(moments) + np.linalg.norm(np.cross(omega, J @ omega))
    rest = moments - J @ alpha - np.cross(omega, J @ omega)
    np.testing.assert_allclose(rest, 0.0, atol=accuracy * largest)
    # what balances is the recorded motion, but for the arms of forces that the body's bending moves
    g = rotate(back, np.array([0.0, 0.0, -9.81]))[0]
    a = rotate(back, motion.v_dot[row : row + 1, :3])[0]
    np.testing.assert_allclose(gravity * unit, g - a, rtol=0, atol=1e-9)
    np.testing.assert_allclose(alpha, motion.v_dot[row, 3:], rtol=0, atol=1e-5)


def test_the_worst_instant_is_that_of_the_largest_load(runner, results_file):
    results = Results.read(results_file)
    sizes = [
        np.linalg.norm(results.frame(name).force[:, :3], axis=1)
        + np.linalg.norm(results.frame(name).force[:, 3:], axis=1)
        / results.superelement("beam").size
        for name in ("beam.root", "beam.tip")
    ]
    deck = export(runner, results_file, "--to", "nastran") / "run-beam.bdf"
    time = float(deck.read_text().partition("at t = ")[2].partition(" s")[0])
    largest = np.max(sizes, axis=0)
    row = int(np.abs(results.time - time).argmin())
    assert largest[row] == pytest.approx(largest.max(), rel=1e-12)


def test_patterns_are_named_for_they_are_in_the_balance(results_file, monkeypatch):
    """`load_set` takes their resultants from the superelement."""
    from duhamel.results import load_set
    from duhamel.results.motion import PatternMotion

    results = Results.read(results_file)
    plain = load_set(results, "beam", 0.02)
    element = results.superelement("beam")
    pattern = Pattern("wind", np.array([1.0, 2.0, 3.0]), np.array([0.1, 0.2, 0.3]))
    monkeypatch.setattr(type(element), "patterns", (pattern,))
    monkeypatch.setattr(Results, "patterns", ("beam.wind",))
    amplitude = np.full(len(results.time), 2.0)
    monkeypatch.setattr(Results, "pattern", lambda self, name: PatternMotion({"load": amplitude}))
    loaded = load_set(results, "beam", 0.02)
    assert loaded.patterns == {"wind": 2.0}
    gained = element.mass * (loaded.acceleration - plain.acceleration)
    np.testing.assert_allclose(gained, 2.0 * pattern.force, rtol=1e-12)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--to", "abaqus", "--at", "9"], "expected a time from 0 to 0.05 s, found 9"),
        (["--to", "abaqus", "--body", "hub"], "the run has no flexible body 'hub'"),
        (["--to", "csv", "--at", "0.01"], "--at and --body go with --to abaqus or nastran"),
        (["--to", "nastran", "--at", "soon"], "expected a time [s] or worst, found 'soon'"),
    ],
)
def test_what_cannot_be_done_is_refused(runner, results_file, arguments, message):
    out = results_file.parent / "out"
    result = runner.invoke(app, ["export", str(results_file), str(out), *arguments])
    assert result.exit_code != 0
    assert message in " ".join(result.stderr.replace("│", " ").split())
    assert not out.exists()
