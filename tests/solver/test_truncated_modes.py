"""Bodies of a given number of modes in models: the paper's beam, clamped at its root."""

import numpy as np
import pytest
from duhamel.preprocess import build, read_body
from duhamel.solver import (
    Constant,
    Fixed,
    FlexibleBody,
    Force,
    Start,
    simulate,
)
from duhamel.superelement import StepWarning

from .conftest import BEAM
from .models import model_of

EI, LENGTH, FORCE = 5.5, 0.5, 0.1
CLAMPED = 1.8751040687**2 * np.sqrt(EI / 0.0858) / LENGTH**2


@pytest.fixture(params=["craig-bampton", "rubin"])
def element(request):
    return build(read_body(BEAM).with_modes(request.param, 6))


def cantilever(element, **settings):
    """Under a force at the tip; the step resolves more than the modes hold, which is told."""
    model = model_of(
        bodies={"beam": FlexibleBody(element, Start(position=[LENGTH / 2, 0, 0]))},
        joints=(Fixed("ground", "beam.root", name="clamp"),),
        loads=(Force("beam.tip", [0, FORCE, 0], Constant(1.0)),),
        step=1e-4,
        rho_inf=0.9,
        **settings,
    )
    with pytest.warns(StepWarning, match="right up to"):
        return simulate(model)


def test_a_cantilever_bends_as_it_should_at_rest(element):
    """Both have all that loads at the interfaces do at rest: F L^3 / 3 EI."""
    result = cantilever(element, t_end=1e-3, start="equilibrium")
    deflection = result.frame("beam.tip").position[-1, 1]
    assert deflection == pytest.approx(FORCE * LENGTH**3 / (3 * EI), rel=1e-4)


def test_a_cantilever_vibrates_as_it_should(element):
    """About the deflection at rest, from none to twice that, with the first frequency."""
    period = 2 * np.pi / CLAMPED
    result = cantilever(element, t_end=4.0 * period)
    y = result.frame("beam.tip").position[:, 1] / (FORCE * LENGTH**3 / (3 * EI))
    assert y.max() == pytest.approx(2.0, abs=0.05)
    slow = 0.97 * np.cos(CLAMPED * result.time)
    assert np.abs(y - 1.0 + slow).max() < 0.08


def test_the_range_of_a_run_knows_the_error_and_the_band(element):
    validity = cantilever(element, t_end=0.05).validity
    assert validity.values("kernel_error") == {"beam": pytest.approx(element.kernel.error)}
    in_band = validity.values("kernel_band")["beam"]
    assert in_band > CLAMPED / (2 * np.pi) / element.kernel.band * 0.9
