"""The libraries: what they call, allocate and need; and what is refused before there is one."""

import re
import shutil
import subprocess
import zipfile
from dataclasses import replace
from pathlib import Path

import pytest
from duhamel import fmu, solver
from duhamel.fmu import library
from duhamel.fmu.library import FMI_PLATFORMS
from duhamel.fmu.naming import base_units
from duhamel.solver.compiler.object_file import object_files
from duhamel.solver.compiler.targets import COMPILED_TARGETS, own_platform
from typer.testing import CliRunner

from .machines import box, rod, servo

HERE = Path(__file__).parent
CALLED = {"atan2", "cos", "exp", "log", "memcpy", "memset", "pow", "sin", "sincos"}
"""what the compiled time step may call of the C library"""


def library_in(made, folder):
    """The library of an export of one platform, as a file."""
    with zipfile.ZipFile(made.path) as archive:
        (name,) = [n for n in archive.namelist() if n.startswith("binaries/")]
        archive.extract(name, folder)
    return folder / name


@pytest.mark.parametrize("model", [rod(), box(contact_step=2e-5)], ids=["rod", "two sizes"])
def test_steps_and_kept_states_allocate_nothing(model, exported, tmp_path):
    made = exported(model)
    program = tmp_path / "allocations"
    source, headers = HERE / "allocations.c", library.C_SOURCES
    subprocess.run(["cc", "-O1", f"-I{headers}", source, "-o", program, "-ldl"], check=True)
    arguments = [library_in(made, tmp_path), made.experiment.token, made.experiment.step, 500]
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == "0\n"


def test_the_library_needs_the_c_library_alone(exported, tmp_path):
    path = library_in(exported(rod()), tmp_path)
    told = subprocess.run(["readelf", "-d", path], capture_output=True, text=True, check=True)
    needed = set(re.findall(r"NEEDED.*\[(.*)\]", told.stdout))
    assert needed <= {"libm.so.6", "libc.so.6", "ld-linux-x86-64.so.2"}


@pytest.mark.parametrize("target", ["native", "x86_64-linux"])
def test_the_time_step_calls_what_is_known(target, tmp_path):
    path = tmp_path / "step.o"
    path.write_bytes(object_files([target])[target])
    told = subprocess.run(["nm", "-u", path], capture_output=True, text=True, check=True)
    found = {line.split()[-1] for line in told.stdout.splitlines()} - {"_GLOBAL_OFFSET_TABLE_"}
    assert found <= CALLED


@pytest.mark.validation
def test_all_platforms_are_linked(exported):
    """Some minutes where neither the step nor the libraries of C have been compiled for them."""
    made = exported(rod(), platforms=list(FMI_PLATFORMS), cpu="x86-64-v3")
    with zipfile.ZipFile(made.path) as archive:
        found = {n: archive.read(n) for n in archive.namelist() if n.startswith("binaries/")}
    assert set(found) == {
        "binaries/x86_64-linux/machine.so",
        "binaries/aarch64-linux/machine.so",
        "binaries/x86_64-windows/machine.dll",
        "binaries/aarch64-darwin/machine.dylib",
    }
    heads = {name.split("/")[1]: content[:20] for name, content in found.items()}
    assert heads["x86_64-linux"][:4] == b"\x7fELF"
    assert heads["x86_64-linux"][18:20] == b"\x3e\0"
    assert heads["aarch64-linux"][18:20] == b"\xb7\0"
    assert heads["x86_64-windows"][:2] == b"MZ"
    assert heads["aarch64-darwin"][:4] == b"\xcf\xfa\xed\xfe"
    assert b"@rpath/machine.dylib" in found["binaries/aarch64-darwin/machine.dylib"]
    for content in found.values():
        assert b"fmi3DoStep" in content
        assert b"fmi2DoStep" in content
        assert b"/tmp/" not in content


def test_platforms_are_those_of_the_compiler():
    assert set(FMI_PLATFORMS) <= set(COMPILED_TARGETS)


def test_a_lesser_processor_is_told(exported, monkeypatch, slave):
    """Level 4, which nobody has, stands for a processor that is missing."""
    source = library._image_source
    monkeypatch.setattr(library, "_image_source", lambda platform, level: source(platform, 4))
    made = exported(rod())
    with pytest.raises(RuntimeError, match="expected a processor with"):
        slave(made.path)


def test_the_times_of_steps_are_told(exported):
    times = exported(box()).times(300)
    assert times.n == 300
    assert 0.0 < times.median <= times.most <= times.longest


def test_without_ziglang_the_compiler_of_the_machine_links(exported, monkeypatch, slave):
    monkeypatch.setattr(library, "find_spec", lambda _: None)
    slave(exported(rod()).path).step(0.0, 1e-3)
    # what is refused is refused before anything is compiled
    monkeypatch.setattr("duhamel.fmu.export.object_files", lambda _: pytest.fail("compiled"))
    with pytest.raises(fmu.FMUError, match=r"aarch64-darwin: expected ziglang.*duhamel\[fmu\]"):
        exported(rod(), platforms=["aarch64-darwin"], cpu="x86-64-v3")
    monkeypatch.setattr(shutil, "which", lambda _: None)
    with pytest.raises(fmu.FMUError, match="expected a C compiler, found none: pip install"):
        exported(rod())


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ({"outputs": ["joints/pivot/angel"]}, "output: no 'joints/pivot/angel'; did you mean"),
        ({"parameters": ["motors/x/stiffness"]}, "parameter: no 'motors/x/stiffness'"),
        ({"platforms": ["riscv-linux"]}, "platform: expected of x86_64-linux"),
        ({"version": 2, "platforms": ["aarch64-linux"]}, "FMI 2 has no folder for it"),
        ({"version": 1}, "fmi: expected 3 or 2, got 1"),
        ({"cpu": "z80"}, "cpu: expected x86-64-v3 or x86-64-v2 or native, got 'z80'"),
        ({"platforms": ["aarch64-darwin"]}, "cpu native: expected the platform"),
        ({"communication": 0.0}, "communication: expected a time above 0 s, got 0"),
        ({"communication": float("nan")}, "communication: expected a time above 0 s, got nan"),
    ],
)
def test_what_cannot_be_exported_is_refused(options, told, exported):
    with pytest.raises(fmu.FMUError) as error:
        exported(rod(), **options)
    assert told in str(error.value)


def test_a_law_of_python_is_refused(exported):
    model = servo()
    (spring,) = model.springs
    law = solver.UserLaw(_cubic, numbers=[2.0])
    with pytest.raises(fmu.FMUError, match="UserLaw is a function of Python"):
        exported(replace(model, springs=(replace(spring, law=law),)))


def _cubic(p, memory, h, c, rate):
    return p[0] * c**3, 3.0 * p[0] * c**2, 0.0, 0.25 * p[0] * c**4


def test_nothing_is_left_where_an_export_fails(tmp_path):
    with pytest.raises(fmu.FMUError, match="cannot be written"):
        fmu.export_fmu(rod(), tmp_path / "nowhere" / "machine.fmu", cpu="native")
    target = tmp_path / "machine.fmu"
    target.write_bytes(b"what was there")
    with pytest.raises(fmu.FMUError):
        fmu.export_fmu(rod(), target, cpu="native", outputs=["no/such/thing"])
    assert [path.name for path in tmp_path.iterdir()] == ["machine.fmu"]
    assert target.read_bytes() == b"what was there"


@pytest.mark.parametrize(
    ("unit", "exponents"),
    [
        ("N m s-1", {"kg": 1, "m": 2, "s": -3}),
        ("m s-2", {"m": 1, "s": -2}),
        ("N s m-1", {"kg": 1, "s": -1}),
        ("rad", {"rad": 1}),
        ("1", {}),
        ("kg m2 s-1", {"kg": 1, "m": 2, "s": -1}),
    ],
)
def test_units_are_products_of_base_units(unit, exponents):
    assert base_units(unit) == exponents


def test_the_command_tells_what_it_has_made(tmp_path):
    from duhamel.cli import app

    solver.write_model(box(), tmp_path / "falling box.toml")
    done = CliRunner().invoke(
        app, ["fmu", str(tmp_path / "falling box.toml"), "--cpu", "native", "--fmi", "2"]
    )
    assert done.exit_code == 0, done.output
    path = tmp_path / "falling box.fmu"
    assert f"{path}: FMI 2," in done.output
    assert "input inputs.u [N], 0 at the start" in done.output
    assert own_platform() in done.output
    assert "us here; 99.9 % of 2000 take at most" in done.output
    with zipfile.ZipFile(path) as archive:
        assert "binaries/linux64/falling_box.so" in archive.namelist()
    failed = CliRunner().invoke(app, ["fmu", str(tmp_path / "falling box.toml"), "--fmi", "4"])
    assert failed.exit_code == 1
    assert "fmi: expected 3 or 2, got 4" in failed.output
