"""Superelements that several processes have made, beside those that one has made."""

import sys

import numpy as np
import pytest
from duhamel.preprocess import build, read_body
from duhamel.preprocess.responses.band import Band
from duhamel.superelement import read

from .mpi import PREPROCESS, run

pytest.importorskip("petsc4py")

EXACT = {'method = "krylov"': 'method = "krylov"\nsolver = "factor"'}
"""Solutions are exact but for rounding."""
INEXACT = {
    "[recovery]\nstress = true\n": "",
    'method = "krylov"': 'method = "krylov"\nsolver = "iterative"',
}
LOSSY = EXACT | {
    "E = 2.1e11": "loss_factor = 0.02\nE = 2.1e11",
    "[recovery]\nstress = true\n": "[damping]\nband = [10, 10000]\n",
    'kind = "rigid"\n': "",
}


@pytest.fixture(scope="module")
def made(bar):
    """Superelements of a bar by the number of processes, and by `preprocess.build` for 0."""

    def make(changes, numbers):
        body_file = bar(changes)
        elements = {0: build(read_body(body_file))}
        for processes in numbers:
            target = body_file.with_name(f"{processes}.h5")
            done = run(processes, *PREPROCESS, str(body_file), "-o", str(target))
            assert done.returncode == 0, done.stderr
            told = [line for line in done.stdout.splitlines() if "loss factor" not in line]
            (last,) = [line for line in told if not line.startswith("note: ")]
            assert last.startswith(f"{target}: 12 dofs, ")
            elements[processes] = read(target)
        return elements

    return make


@pytest.fixture(scope="module")
def exact(made):
    return made(EXACT, (1, 2, 3))


@pytest.fixture(scope="module")
def lossy(made):
    return made(LOSSY, (2,))


SHORT = INEXACT | {"step = 1e-5": "step = 4e-6"}
"""Steps of which the matrix is nearly the mass, far above the band."""
LONG = INEXACT | {"step = 1e-5": "step = 1e-3", "band = 10000": "band = 400"}
"""Steps of which the matrix is nearly the stiffness."""
STEPS = """
import sys
from pathlib import Path
from mpi4py import MPI
from duhamel.preprocess import read_body
from duhamel.preprocess.parallel import solve
from duhamel.preprocess.parallel.build import build_together
from duhamel.preprocess.parallel.ranks import Ranks

original, made = solve.iterated, []

def iterated(*arguments):
    made.append(original(*arguments))
    return made[-1]

solve.iterated = iterated
build_together(read_body(Path(sys.argv[1])), Ranks(MPI.COMM_WORLD), False, lambda doubt: None)
if MPI.COMM_WORLD.rank == 0:
    print(*(steps for solver in made for steps in solver.iterations))
"""
PAIRS = pytest.mark.parametrize(("one", "other"), [(1, 2), (1, 3), (0, 1), (0, 2)])


def close(found, expected, scale=None, tolerance=1e-9):
    """Within the tolerance of the largest, or of a scale."""
    scale = np.abs(expected).max() if scale is None else scale
    np.testing.assert_allclose(found / scale, expected / scale, rtol=0, atol=tolerance)


@PAIRS
def test_mass_and_interfaces_are_the_same(exact, one, other):
    a, b = exact[one], exact[other]
    close(a.mass, b.mass, tolerance=1e-14)
    close(a.J_rot, b.J_rot, tolerance=1e-13)
    close(a.center, b.center, tolerance=1e-13)
    assert [interface.name for interface in a.interfaces] == ["root", "tip"]
    for i, j in zip(a.interfaces, b.interfaces, strict=True):
        assert i.rotations == j.rotations
        close(i.X, j.X, tolerance=1e-13)


@PAIRS
def test_kernels_compliance_and_accelerance_are_the_same(exact, one, other):
    a, b = exact[one], exact[other]
    for name in ("compliance", "accelerance"):
        expected = getattr(b, name)
        size = np.sqrt(np.diag(expected))
        close(getattr(a, name), expected, np.outer(size, size))
    for name in ("g", "g_initial"):
        expected = getattr(b.kernel, name)
        size = np.sqrt(np.abs(np.diagonal(expected, axis1=1, axis2=2)).max(axis=0))
        close(getattr(a.kernel, name), expected, np.outer(size, size))


@PAIRS
def test_modes_in_the_band_are_the_same(exact, one, other):
    a, b = exact[one].modes, exact[other].modes
    inside = b.frequencies < 10_000.0
    assert inside.sum() >= 3
    np.testing.assert_allclose(a.omega[: inside.sum()], b.omega[inside], rtol=1e-9)


@PAIRS
def test_fields_at_rest_are_the_same(exact, one, other):
    a, b = exact[one], exact[other]
    np.testing.assert_array_equal(a.recovery.cells, b.recovery.cells)
    close(a.recovery.points, b.recovery.points, tolerance=1e-13)

    def at_rest(element, field):
        modes = element.modes
        return (field.reshape(-1, len(modes.omega)) / modes.omega**2) @ modes.phi.T

    for name in ("phi", "stress"):
        found, expected = (at_rest(e, getattr(e.recovery, name)) for e in (a, b))
        # Kernels, the same to 1e-12, differ by the square of what fields do.
        close(found, expected, np.abs(expected).max(axis=0), tolerance=1e-6)


@PAIRS
def test_patterns_and_sensors_are_the_same(exact, one, other):
    a, b = exact[one], exact[other]
    assert [pattern.name for pattern in a.channels.patterns] == ["wind", "weight"]
    for p, q in zip(a.channels.patterns, b.channels.patterns, strict=True):
        close(p.force, q.force, tolerance=1e-12)
        close(p.moment, q.moment, max(np.abs(q.moment).max(), 1e-9), tolerance=1e-9)

    def at_rest(element):
        modes = element.modes
        return (element.channels.phi / modes.omega**2) @ modes.phi.T

    found, expected = at_rest(a), at_rest(b)
    # The weight only accelerates what is of one density; here it deforms.
    assert np.abs(expected).min(axis=1).max() > 0.0
    close(found, expected, np.abs(expected).max(axis=1)[:, None])


def test_outlines_are_the_same(exact):
    np.testing.assert_array_equal(exact[2].outline.cells, exact[0].outline.cells)
    close(exact[2].outline.points, exact[0].outline.points, tolerance=1e-13)


def test_materials_of_different_loss_damp_modes_alike(lossy):
    a, b = lossy[2].modes, lossy[0].modes
    inside = b.frequencies < 10_000.0
    np.testing.assert_allclose(
        a.chain.amplitude[:, : inside.sum()], b.chain.amplitude[:, inside], rtol=1e-7
    )
    assert np.ptp(b.chain.amplitude[:, inside], axis=1).max() > 0.0


@pytest.mark.parametrize(("changes", "by"), [(SHORT, ""), (LONG, " with multigrid")])
def test_with_inexact_solutions_transfer_functions_agree_to_the_tolerance(made, changes, by):
    found = made(changes, (1, 2, 3))
    kernel = found[0].kernel
    band = Band(kernel.h, kernel.scheme, kernel.band)
    for processes in (1, 2, 3):
        versions = found[processes].provenance.versions
        assert versions["factorization"].startswith(f"conjugate gradients{by}, PETSc 3.")
        assert found[processes].kernel.error <= 1e-5
        assert band.error(found[processes].modes, found[0].modes) <= 2e-5


@pytest.mark.parametrize("processes", [1, 2, 4])
def test_multigrid_takes_few_steps(bar, processes):
    """Also where coarse levels leave processes out."""
    done = run(processes, sys.executable, "-c", STEPS, str(bar(LONG, (24, 6, 6))))
    assert done.returncode == 0, done.stderr
    steps = [int(word) for word in done.stdout.split()]
    assert len(steps) >= 3
    assert max(steps) < 80


def test_the_file_says_what_made_it(exact):
    provenance = exact[2].provenance
    assert (provenance.method, provenance.tolerance) == ("krylov", 1e-5)
    assert provenance.versions["factorization"].startswith("mumps, PETSc 3.")
    assert set(provenance.timings) == {"mesh", "assembly", "impulse", "static", "recovery"}
