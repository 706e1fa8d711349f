"""What `duhamel run` tells of the energy of a run."""

import re

import pytest
from duhamel.cli import app

MODEL = """
[simulation]
t_end = 0.2
rule = "RULE"

[bodies.beam]
superelement = "beam.h5"

[[loads]]
type = "force"
on = "beam.tip"
direction = [0.0, 0.0, 1.0]
signal = {amplitude = 1.0, frequency = 640.0}
"""


@pytest.fixture
def told(runner, element_file):
    """The lines of a run under a load at a frequency at which the tip answers like a mass, against the load."""

    def run(rule):
        path = element_file.with_name(f"{rule}.toml")
        path.write_text(MODEL.replace("RULE", rule))
        result = runner.invoke(app, ["run", str(path)])
        assert result.exit_code == 0, result.output
        return result.stdout

    return run


def test_energy_that_the_convolution_created_is_told(told):
    """Eq. (55) gives energy to a load on a mass; no other rule does."""
    found = re.search(
        r"elastic energy fell to (\S+) J: the convolution has created energy \(rule 'paper'\)", told("paper")
    )
    assert float(found[1]) < -1e-6
    assert "created energy" not in told("consistent")
