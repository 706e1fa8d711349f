"""A part that only a simulated hammer test knows, on a plate, beside both meshes.

What the table of docs/how-to/measured.md says of benchmarks/beside_lmfbs.py.
"""

from functools import cache

import duhamel as du
import numpy as np
import pytest
from coupling.comparison import (
    LINES,
    TRANSLATIONS,
    identified,
    motions,
    substructured,
    true_assembly,
    true_struck,
)
from coupling.hammer import ALL, HITS, NOISE, SENSORS, Errors, HammerTest, hammer_test, truth
from coupling.parts import INTERFACES, FreePart, Motion, plate
from coupling.substructuring import coupled, virtual_points
from duhamel import preprocess
from duhamel.preprocess.measured.part import identified as fit_of_test
from duhamel.preprocess.progress import Stages

pytestmark = [
    pytest.mark.validation,
    pytest.mark.filterwarnings(
        "ignore:.* modes for steps down to:duhamel.superelement.StepWarning"
    ),
]


@cache
def found(errors: Errors):
    return identified(hammer_test(errors))


def accelerances(part: FreePart, names: tuple[str, ...]):
    own = Motion.all_of([part.motion(name) for name in names])
    return part.accelerance(2j * np.pi * LINES, own, own)


def test_joined_parts_respond_as_lm_fbs_couples_their_responses():
    """The solver's equations with a joint, and a formula of the responses of the free parts."""
    Y = coupled(accelerances(truth().part, INTERFACES), accelerances(plate(), ("root", "tip")))
    np.testing.assert_allclose(
        Y[:, TRANSLATIONS][:, :, TRANSLATIONS],
        true_assembly(),
        rtol=0.0,
        atol=1e-12 * np.abs(Y).max(),
    )


def test_virtual_points_of_a_rigid_part_move_by_its_mass():
    part, whole, test = truth().part, truth().whole, hammer_test(Errors())
    into = (whole.motion(f"h{hit}").rigid.T @ np.array(HITS[hit][1]) for hit in test.hits)
    sensors = np.vstack([whole.motion(f"s{label}").rigid for label in SENSORS])
    H = sensors @ np.linalg.solve(part.mass, np.column_stack(list(into)))
    rigid = HammerTest(test.f[:1], H[None].astype(complex), test.hits)
    U = np.vstack([part.motion(name).rigid for name in INTERFACES])
    expected = U @ np.linalg.solve(part.mass, U.T)
    np.testing.assert_allclose(virtual_points(rigid)[0], expected, atol=1e-9 * expected.max())


@pytest.mark.parametrize(
    ("errors", "misfit", "displacement"),
    [(Errors(), 0.035, 2e-3), (ALL, 0.07, 2e-2)],
    ids=["exact", "with errors"],
)
def test_a_tested_part_moves_as_its_mesh_after_a_blow(errors, misfit, displacement):
    part = found(errors)
    assert part.frequencies < 1e-4
    assert part.damping < 1e-2
    assert part.misfit < misfit
    assert motions(part.element).displacement < displacement


@pytest.mark.parametrize(("errors", "most"), [(NOISE, 0.012), (ALL, 0.04)], ids=["noise", "all"])
def test_an_assembly_is_nearer_to_the_truth_than_by_measured_responses(errors, most):
    """Of the same test, in each of three bands; and its frequencies."""
    ours, theirs = found(errors), substructured(hammer_test(errors))
    assert (ours.assembly < theirs.assembly).all()
    assert np.abs(ours.of_assembly).max() < most


def test_a_ball_leaves_a_tested_part_as_it_leaves_its_mesh():
    off = motions(found(ALL).element)
    assert abs(off.peak) < 5e-3
    assert abs(off.speed) < 1e-2
    # Not because little happens: a force of Hertz on a part that gives way.
    blow = true_struck()
    assert blow.peak > 2000.0
    assert 0.2 < blow.speed < 0.9


def test_what_was_identified_is_what_a_model_responds(tmp_path):
    """A further sensor by hits at the foot: in the fit, and of the free body in a model."""
    test = hammer_test(ALL)
    few = HammerTest(test.f[::8], test.H[::8], test.hits)
    body = preprocess.read_body(few.write(tmp_path))
    part = fit_of_test(body, Stages())
    m = du.Mechanism()
    m.add(preprocess.build(body), name="A")
    inputs = [f"{kind}:A.foot:{axis}" for kind in ("force", "torque") for axis in "xyz"]
    outputs = [f"sensor_acceleration:A.measured_7:{axis}" for axis in "xyz"]
    own, measured = part.test.coordinates, part.measurement
    hits = [few.hits.index(hit) for hit in few.hits_of("foot")]
    channels = [k for k, label in enumerate(part.test.channels.labels) if label == "7"]
    found = m.frf(inputs, outputs, few.f).values @ own.inputs[hits, own.interfaces["foot"]].T
    rigid = measured.H - measured.elastic
    fit = (part.found.fit.responses(measured) + rigid)[:, channels][:, :, hits]
    np.testing.assert_allclose(found, fit, rtol=0.0, atol=1e-9 * np.abs(fit).max())
