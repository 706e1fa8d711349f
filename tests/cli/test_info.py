"""`duhamel info`: what it shows of a superelement, and how it fails."""

import os
import re
import subprocess
import sys
from dataclasses import replace

import pytest
from duhamel.cli import app
from duhamel.superelement import Chain, sample_kernel, write

from ..superelement.rotations import any_rotation


def cells(output: str) -> dict[str, str]:
    """The table read back: label -> value, with the lines of a folded value joined by a blank."""
    table: dict[str, str] = {}
    label = ""
    for line in output.splitlines():
        parts = [re.sub(r"\s+", " ", part).strip() for part in line.split("│")]
        if len(parts) == 4:
            label = parts[1] or label
            table[label] = f"{table.get(label, '')} {parts[2]}".strip()
    return table


@pytest.fixture
def shown(runner, element_file):
    result = runner.invoke(app, ["info", str(element_file)])
    assert result.exit_code == 0
    return cells(result.stdout)


def test_mass_properties(shown):
    assert shown["mass [kg]"] == "0.0429"
    assert shown["center of mass [m]"] == "0.25 0 0"
    assert shown["principal inertia [kg m^2]"] == "2 4 5.5"
    assert shown["inertia [kg m^2]"] == "3 1 0 1 3 0 0 0 5.5"


def test_interfaces_with_position_and_dofs(shown):
    assert shown["interfaces"] == "2, positions [m] from the center of mass"
    assert shown["root"] == "-0.25 0 0 6 dofs"
    assert shown["tip"] == "0.25 0 0 3 dofs"


def test_the_number_of_modes_and_the_first_ten_frequencies(shown):
    assert shown["modes"] == "12"
    assert shown["first 10 [Hz]"] == "100, 200, 300, 400, 500, 600, 700, 800, 900, 1000"


def test_the_kernel(shown):
    found = [
        shown[f"kernel {label}"] for label in ("step [s]", "length [s]", "rho_inf", "error", "n_c")
    ]
    assert found == ["0.0005", "0.02, 40 steps", "0.8", "3e-09", "9"]


def test_a_body_of_some_modes_says_how_far_they_reach(runner, element, tmp_path):
    modes = replace(element.modes, h_min=5e-4)
    kernel = replace(element.kernel, error=2.34e-7, band=500.0)
    write(tmp_path / "solid.h5", replace(element, modes=modes, kernel=kernel))
    shown = cells(runner.invoke(app, ["info", str(tmp_path / "solid.h5")]).stdout)
    assert shown["modes"] == "12, for steps down to 0.0005 s"
    assert shown["kernel error"] == "2.34e-07 up to 500 Hz"


def test_the_provenance_with_the_whole_hash(shown):
    assert shown["mesh"] == "beam.msh"
    assert shown["mesh SHA-256"].replace(" ", "") == "0123456789abcdef" * 4
    assert shown["method"] == "modal, tolerance 1e-08"
    assert shown["versions"] == "numpy 2.4.6"
    assert shown["timings [s]"] == "modes 0.25"


def test_a_body_without_modes_says_so(runner, measured_file):
    table = cells(runner.invoke(app, ["info", str(measured_file)]).stdout)
    assert table["modes"] == "none, so the step and rho_inf of the kernel are fixed"


def test_the_second_order_with_what_stiffens_most(runner, element, tmp_path):
    rotation = any_rotation(0, element.modes, element.J_rot)
    rotation = replace(rotation, kappa=[1.0, 0.29, 0.0721])
    write(tmp_path / "blade.h5", replace(element, rotation=rotation))
    shown = cells(runner.invoke(app, ["info", str(tmp_path / "blade.h5")]).stdout)
    assert shown["rotation"] == "r = 5: 1 modes, 2 soft shapes"
    assert shown["stiffening, relative"] == "1, 0.29, 0.072"


def test_a_body_without_it_says_so(shown):
    assert shown["rotation"].startswith("none: stiffness and inertia do not depend on")


def test_a_missing_file_is_one_line_on_stderr(runner, tmp_path):
    result = runner.invoke(app, ["info", str(tmp_path / "none.h5")])
    assert result.exit_code == 1
    assert result.stdout == ""
    assert result.stderr == f"error: {tmp_path / 'none.h5'}: no such file\n"


def lossy(element, path, amplitude, loss_factor, reference=0.0):
    chain = Chain([1e-4, 1e-3], amplitude, loss_factor, (50.0, 2000.0), reference, 0.0123)
    modes, kernel = replace(element.modes, chain=chain), element.kernel
    kernel = sample_kernel(modes, kernel.h, kernel.scheme, kernel.steps)
    write(path, replace(element, modes=modes, kernel=kernel))
    return path


def test_the_loss_factor_of_a_material_with_its_limits(runner, element, tmp_path):
    path = lossy(element, tmp_path / "lossy.h5", [0.02, 0.02], 0.03)
    assert cells(runner.invoke(app, ["info", str(path)]).stdout)["loss factor"] == (
        "0.03 from 50 to 2000 Hz within 1.2 %, 2 Maxwell elements: damping ratio 0.015, free or "
        "held; moduli given at rest; at 316 Hz they are 1.7 % higher"
    )
    path = lossy(element, tmp_path / "given.h5", [0.02, 0.02], 0.03, 316.2278)
    found = cells(runner.invoke(app, ["info", str(path)]).stdout)["loss factor"]
    assert found.endswith("held; moduli given at 316 Hz; the static moduli are 1.6 % lower")


def test_loss_factors_of_several_materials_are_those_of_modes(runner, element, tmp_path):
    path = lossy(element, tmp_path / "lossy.h5", [[0.02] * 12, [0.0] * 6 + [0.02] * 6], 0.0)
    found = cells(runner.invoke(app, ["info", str(path)]).stdout)["loss factor"]
    assert re.match(r"0\.00\d+ to 0\.01\d+, by the strain energy that modes of the free", found)


@pytest.mark.parametrize("encoding", ["ascii", "cp1252"])
def test_letters_that_the_terminal_does_not_have_are_escaped(element, tmp_path, encoding):
    write(tmp_path / "beam.h5", replace(element, name="\N{CJK UNIFIED IDEOGRAPH-6881}"))
    done = subprocess.run(
        [sys.executable, "-m", "duhamel.cli", "info", tmp_path / "beam.h5"],
        env={**os.environ, "PYTHONIOENCODING": encoding},
        capture_output=True,
    )
    assert (done.returncode, done.stderr) == (0, b"")
    assert b"\\u6881" in done.stdout
