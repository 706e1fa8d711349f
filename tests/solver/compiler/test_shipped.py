"""The object file of a wheel: it is used where it fits, and only there."""

import json
import os
import subprocess
import sys

import pytest
from duhamel.solver.compiler import digests, object_file, shipped
from duhamel.solver.compiler.digests import key, with_digest
from duhamel.solver.compiler.shipped import shipped_name
from duhamel.solver.compiler.targets import SHIPPED_TARGETS, SHIPPED_WITH_DERIVATIVES, own_platform

CODE = b"an object file"
OWN = f"shipped-{own_platform()}"


@pytest.fixture
def ship(tmp_path, monkeypatch):
    """Writes the file of this machine, after nothing was kept or shipped."""
    monkeypatch.setattr(shipped, "SHIPPED_FOLDER", tmp_path)
    monkeypatch.setenv("DUHAMEL_CACHE", str(tmp_path / "cache"))
    monkeypatch.setenv("DUHAMEL_COMPILER", "")
    monkeypatch.setenv("NUMBA_DISABLE_JIT", "0")
    monkeypatch.setattr(object_file, "_built_codes", lambda targets: [b"built"] * len(targets))

    def write(content=None):
        whole = key(OWN).encode() + b"\n" + with_digest(CODE)
        (tmp_path / shipped_name(OWN)).write_bytes(whole if content is None else content)
        shipped.shipped_code.cache_clear()

    yield write
    shipped.shipped_code.cache_clear()


def test_what_fits_is_used_and_nothing_is_built(ship):
    ship()
    assert object_file._quick_code(required=False) == CODE
    assert object_file.compiler() == "shipped"


def test_what_is_kept_comes_first(ship):
    ship()
    object_file._new_code()
    assert object_file._quick_code(required=False) == b"built"
    assert object_file.compiler() == "quick"


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"0123456789abcdef\n" + with_digest(CODE),
        key(OWN).encode() + b"\n" + with_digest(CODE)[:-1],
        key(OWN).encode() + b"\n" + b"another" + with_digest(CODE),
    ],
    ids=["empty", "other sources", "cut", "damaged"],
)
def test_what_does_not_fit_is_built_anew(ship, content):
    ship(content)
    assert object_file._quick_code(required=False) == b"built"
    assert object_file.compiler() == "quick"


def test_a_processor_without_its_instructions_builds_its_own(ship, monkeypatch):
    monkeypatch.setattr(shipped, "_has_features", lambda _: False)
    ship()
    assert object_file._quick_code(required=False) == b"built"


def test_who_asks_for_a_compiler_gets_it(ship, monkeypatch):
    ship()
    monkeypatch.setenv("DUHAMEL_COMPILER", "quick")
    assert object_file._quick_code(required=True) == b"built"
    assert object_file.compiler() == "quick"


def test_code_with_derivatives_is_that_of_the_wheel_too(ship, tmp_path, monkeypatch):
    ship()
    target = f"{OWN}-derivatives-4"
    content = key(target).encode() + b"\n" + with_digest(CODE)
    (tmp_path / shipped_name(target)).write_bytes(content)
    wanted = ["derivatives-4", "derivatives-1"]
    assert object_file.object_files(wanted) == dict(zip(wanted, [CODE, b"built"], strict=True))
    monkeypatch.setenv("DUHAMEL_COMPILER", "quick")
    assert object_file.object_files(wanted) == dict.fromkeys(wanted, b"built")


def test_keys_of_shipped_code_do_not_depend_on_what_is_installed(monkeypatch):
    before = {target: key(target) for target in (*SHIPPED_TARGETS, *SHIPPED_WITH_DERIVATIVES)}
    assert len(set(before.values())) == len(before)
    monkeypatch.setattr(digests, "_versions", lambda: ["others"])
    key.cache_clear()
    try:
        assert {target: key(target) for target in before} == before
        assert key("x86_64-linux") not in before.values()
    finally:
        key.cache_clear()


PROGRAM = """
import json, sys
from pathlib import Path
from duhamel.solver import Force, Model, RigidBody, Settings, Steps, simulate
from duhamel.solver.compiler import object_file, shipped

shipped.SHIPPED_FOLDER = Path(sys.argv[1])
push = Force("ball", [1.0, 0.0, 0.5], Steps([0.0], [2.0]))
model = Model({"ball": RigidBody(1.0, [0.1, 0.2, 0.25])}, loads=[push],
              settings=Settings(t_end=1.0, step=0.01))
results = simulate(model)
print(json.dumps([object_file.compiler(), "numba" in sys.modules,
                  results.body("ball").position[-1].tolist()]))
"""


def test_a_first_run_with_shipped_code_loads_no_compiler(tmp_path):
    """And its motion is that of code that was made here."""
    # That of the wheel where a wheel is tested.
    code = shipped.shipped_code() or object_file.object_files([OWN])[OWN]
    content = key(OWN).encode() + b"\n" + with_digest(code)
    (tmp_path / shipped_name(OWN)).write_bytes(content)
    environment = {
        name: value for name, value in os.environ.items() if name != "DUHAMEL_COMPILER"
    } | {"DUHAMEL_CACHE": str(tmp_path / "cache")}
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, str(tmp_path)],
        env=environment,
        capture_output=True,
        text=True,
        check=True,
    )
    compiler, has_numba, position = json.loads(done.stdout)
    assert (compiler, has_numba) == ("shipped", False)
    assert position == pytest.approx([1.0, 0.0, 0.5], rel=1e-12)
    assert "compiling" not in done.stderr
    assert not (tmp_path / "cache").exists()
