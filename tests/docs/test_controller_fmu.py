"""The guide of controllers of other tools, with the controller of the tests as its FMU."""

import tomllib

import numpy as np
import pytest
import tomli_w
from duhamel.solver import read_model, simulate

from ..solver.controller_fmu import controller
from .test_how_to import BASES, merged
from .walk import blocks

GUIDE = "how-to/controller-fmu.md"


@pytest.fixture(autouse=True)
def _folder_of_the_fmu(tmp_path, monkeypatch):
    controller(tmp_path / "drive.fmu")
    monkeypatch.chdir(tmp_path)


def test_the_model_file_of_the_guide_runs(tmp_path):
    (part,) = (block.text for block in blocks(GUIDE) if block.title == "model.toml")
    whole = merged(tomllib.loads(BASES["model.toml"]), tomllib.loads(part))
    del whole["springs"]
    whole["simulation"]["t_end"] = 1.0
    (tmp_path / "model.toml").write_text(tomli_w.dumps(whole), encoding="utf-8")
    results = simulate(read_model(tmp_path / "model.toml"))
    assert results.joint("pivot").angle[-1] == pytest.approx(0.3, abs=0.01)
    assert results.fmu("drive").outputs["tau"][0] == pytest.approx(50.0 * 0.3)


def test_the_program_of_the_guide_runs():
    (program,) = (block.text for block in blocks(GUIDE) if block.kind == "python")
    found = {}
    exec(compile(program, "guide", "exec"), found)
    run = found["run"]
    np.testing.assert_allclose(run["pivot"].angle[-1], 0.3, atol=0.1)
    assert run.plot("fmu_input:drive:tau")
