"""The models of the examples raise no doubts: those of rigid bodies and of beams."""

import tomllib
from pathlib import Path

import pytest
from duhamel import preprocess, superelement
from duhamel.solver import doubts, read_model

from .conftest import EXAMPLES

MODELS = (
    *("arm_on_stop", "backlash", "ball_on_beam", "case1", "case2", "case3", "case4", "case5"),
    *("clearance", "flapping_blade", "four_bar", "rotor", "shaker", "soft_pendulum", "swap"),
    *("robot_arm", "tumbling_box", "unbalance", "oil_whip"),
)


def make_superelements(model: Path) -> None:
    """Those that the model names and that are not there yet."""
    for body in tomllib.loads(model.read_text())["bodies"].values():
        target = model.parent / body.get("superelement", ".")
        if not target.exists():
            body_file = preprocess.read_body(target.with_suffix(".toml"))
            superelement.write(target, preprocess.build(body_file))


@pytest.mark.parametrize("name", MODELS)
def test_no_example_is_doubted(name):
    path = EXAMPLES / f"{name}.toml"
    make_superelements(path)
    assert doubts(read_model(path)) == ()
