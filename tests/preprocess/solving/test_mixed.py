"""Factors in single precision, refined by conjugate gradients in double."""

import numpy as np
import pytest
from duhamel.preprocess import assemble, build
from duhamel.preprocess.solving import solver
from duhamel.preprocess.solving.mixed import MixedFactor
from duhamel.preprocess.solving.solver import cheaper, factorized, mixed


@pytest.mark.parametrize("shift", [1e5, 1e9, 1e12])
@pytest.mark.parametrize("accuracy", [1e-3, 1e-5, 1e-9])
def test_solutions_are_as_accurate_as_is_asked_for(solid_body, box, shift, accuracy):
    """Also of columns whose loads differ by forty orders of magnitude, and of none."""
    structure = assemble(solid_body(box("tetra10", (0.4, 0.1, 0.1), (8, 2, 2))))
    loads = structure.loads * np.logspace(-20, 20, structure.loads.shape[1])
    loads[:, 3] = 0.0
    exact = factorized(structure, shift, "S", accuracy)(loads)
    found = mixed(structure, shift, "S", accuracy)(loads)
    S, missed = structure.K + shift * structure.M, found - exact
    energies = [np.einsum("ik,ik->k", u, S @ u) for u in (missed, exact)]
    assert (np.sqrt(energies[0]) <= accuracy * np.sqrt(energies[1])).all()
    assert not found[:, 3].any()


def test_what_single_precision_cannot_hold_is_factorized_in_double(beam_body, beam):
    """400 elements of a slender beam: its frequencies are eleven orders of magnitude apart."""
    structure = assemble(beam_body(beam(400)))
    shift = 1e-6 * (2.0 * np.pi * 100.0) ** 2
    exact = factorized(structure, shift, "S", 1e-5)(structure.loads)
    found = mixed(structure, shift, "S", 1e-5)(structure.loads)
    np.testing.assert_allclose(found, exact, rtol=0, atol=1e-4 * np.abs(exact).max())


def test_large_bodies_have_such_a_factor_unless_they_ask_for_another(solid_body, box, monkeypatch):
    monkeypatch.setattr(solver, "MIN_MIXED_UNKNOWNS", 1000)
    monkeypatch.setattr(solver.Costs, "cheaper", "factor")
    impulse = {"step": 2e-5, "steps": 100, "method": "krylov"}
    made = {}
    for kind in ("auto", "factor"):
        body = solid_body(
            box("tetra10", (0.4, 0.1, 0.1), (8, 2, 2)), impulse=impulse | {"solver": kind}
        )
        made[kind] = build(body)
    versions = {kind: found.provenance.versions["factorization"] for kind, found in made.items()}
    assert versions == {"auto": "rslab in single precision, refined", "factor": "rslab"}
    auto, factor = made["auto"], made["factor"]
    inside = factor.modes.frequencies < 12_500.0
    np.testing.assert_allclose(
        auto.modes.omega[: inside.sum()], factor.modes.omega[inside], rtol=1e-8
    )
    scale = np.sqrt(np.diag(factor.compliance))
    missed = np.abs(auto.compliance - factor.compliance) / np.outer(scale, scale)
    assert missed.max() <= auto.kernel.error


def test_the_choice_of_a_large_body_is_such_a_factor(solid_body, box, monkeypatch):
    monkeypatch.setattr(solver, "MIN_MIXED_UNKNOWNS", 1000)
    monkeypatch.setattr(solver.Costs, "cheaper", "factor")
    structure = assemble(solid_body(box("tetra10", (0.4, 0.1, 0.1), (8, 2, 2))))
    assert isinstance(cheaper(structure, 1e9, "S", 1e-5)._solve, MixedFactor)
