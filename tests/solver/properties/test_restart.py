"""A run in two parts is the run in one, to the bit."""

import tempfile
from pathlib import Path

import numpy as np
from duhamel.solver import simulate
from hypothesis import given
from hypothesis import strategies as st

from .mechanisms import STEPS, mechanisms, run


def arrays(results, model):
    """All that was recorded of bodies, couplings and energies."""
    yield results.time
    for name in model.bodies:
        yield from vars(results.body(name)).values()
    for name in results.frames:
        yield from vars(results.frame(name)).values()
    for joint in results.joints:
        yield results.joint(joint).multipliers
    yield from (value for value in vars(results.energy).values() if value is not None)
    yield from vars(results.momentum).values()


@given(
    mechanisms(),
    st.integers(1, STEPS - 1),
    st.sampled_from(["recursive", "direct", "fft"]),
)
def test_a_run_in_two_parts_is_that_in_one(model, end, history):
    model = model.with_settings(history=history)
    whole = run(model)
    first = model.with_settings(t_end=end * model.settings.step, checkpoint={"every": STEPS})
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "parts.h5"
        simulate(first, output=file)
        parts = simulate(first.with_settings(t_end=model.settings.t_end), output=file, resume=True)
        for found, expected in zip(arrays(parts, model), arrays(whole, model), strict=True):
            np.testing.assert_array_equal(found, expected)
