"""`duhamel bug-report`: what is in it, and what must not be in it."""

import getpass
import hashlib
import platform
import sys
import tomllib
from pathlib import Path

import pytest
import typer
from duhamel.cli import app
from duhamel.cli.call import call_of, last_failure
from duhamel.cli.installation import without_names

MODEL = """
[simulation]
t_end = 0.1

[bodies.arm]
superelement = "parts/arm.h5"

[bodies.lost]
superelement = "parts/lost.h5"
"""


@pytest.fixture
def folder(tmp_path, monkeypatch) -> Path:
    """A folder of somebody, whose failures are kept apart."""
    monkeypatch.setenv("DUHAMEL_CACHE", str(tmp_path / "cache"))
    folder = tmp_path / "Jane Doe" / "secret"
    folder.mkdir(parents=True)
    monkeypatch.chdir(tmp_path)
    return folder


def report_of(runner, folder, *arguments):
    done = runner.invoke(app, ["bug-report", *map(str, arguments), "-o", str(folder / "r.txt")])
    assert done.exit_code == 0, done.output
    text = (folder / "r.txt").read_text(encoding="utf-8")
    assert str(folder) not in text
    assert "Jane" not in text
    return tomllib.loads(text)


def test_it_has_versions_the_machine_and_the_compiled_code(runner, folder):
    report = report_of(runner, folder)
    assert report["python"]["version"] == platform.python_version()
    assert {"numba", "numpy", "llvmlite", "h5py"} <= set(report["packages"])
    assert report["machine"]["machine"] == platform.machine()
    assert report["compiled_code"]["compiler"] in ("quick", "shipped", "stock", "none")
    assert "error" not in report["compiled_code"]
    assert report["last_failure"] == {"error": "none is kept"}


def test_it_has_digests_of_the_model_and_its_superelements(runner, folder):
    model = folder / "model.toml"
    model.write_text(MODEL)
    (folder / "parts").mkdir()
    (folder / "parts" / "arm.h5").write_bytes(b"arm")
    arm = {"name": "arm.h5", "bytes": 3, "sha256": hashlib.sha256(b"arm").hexdigest()}
    first, second, lost = report_of(runner, folder, model)["files"]
    assert first["sha256"] == hashlib.sha256(model.read_bytes()).hexdigest()
    assert second == arm
    assert lost == {"name": "lost.h5", "error": "No such file or directory"}


def test_a_model_that_is_no_toml_is_reported_all_the_same(runner, folder):
    (folder / "model.toml").write_text("= broken")
    (only,) = report_of(runner, folder, folder / "model.toml")["files"]
    assert only["bytes"] == 8


@pytest.mark.parametrize("given", ["absolute", "relative"])
def test_the_last_failure_is_in_it_without_folders(runner, folder, given):
    path = folder / "none.toml"
    word = path if given == "absolute" else path.relative_to(Path.cwd())
    assert runner.invoke(app, ["run", str(word)]).exit_code == 1
    failure = report_of(runner, folder)["last_failure"]
    assert failure["arguments"][0] == "run"
    assert failure["arguments"][1].endswith("none.toml")
    assert "none.toml: not a readable file" in failure["error"]


def test_a_defect_is_in_it_with_its_traceback(runner, folder, monkeypatch):
    def fails(file):
        raise ZeroDivisionError(f"of {file}")

    monkeypatch.setattr("duhamel.superelement.read", fails)
    done = runner.invoke(app, ["info", str(folder / "arm.h5")])
    assert isinstance(done.exception, ZeroDivisionError)
    failure = report_of(runner, folder)["last_failure"]
    assert failure["error"].startswith("ZeroDivisionError: of ")
    assert "commands/info.py" in failure["traceback"]


def test_a_call_that_is_only_wrong_is_no_failure(runner, folder):
    assert runner.invoke(app, ["info", "--unknown"]).exit_code == 2
    assert report_of(runner, folder)["last_failure"] == {"error": "none is kept"}


def test_a_report_that_fails_is_not_the_failure_that_it_tells_of(runner, folder):
    assert runner.invoke(app, ["run", str(folder / "none.toml")]).exit_code == 1
    model = folder / "model.toml"
    model.write_text(MODEL)
    assert runner.invoke(app, ["bug-report", str(model), "-o", str(model)]).exit_code == 1
    assert report_of(runner, folder)["last_failure"]["arguments"][0] == "run"


def test_an_end_without_an_error_is_no_failure(folder):
    with pytest.raises(typer.Exit), call_of(["check", "model.toml"]):
        raise typer.Exit(1)
    assert last_failure() is None


def test_it_replaces_no_model(runner, folder):
    model = folder / "model.toml"
    model.write_text(MODEL)
    done = runner.invoke(app, ["bug-report", str(model), "-o", str(model)])
    assert done.exit_code == 1
    assert model.read_text() == MODEL


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("/data/jane/a b/model.toml: no such file", ".../model.toml: no such file"),
        (r"C:\Users\jane\model.toml: no such file", ".../model.toml: no such file"),
        ("expected a length in m/s, found 3 N / m", "expected a length in m/s, found 3 N / m"),
        (f"{Path.home()}/Jane Doe/x.toml", "<user folder>/x.toml"),
        ("of jane at turing, not of janet", "of <user> at <host>, not of janet"),
        ("jane_rod of Jane, turing_2", "<user>_rod of <user>, <host>_2"),
        (f"{Path.home()}-bmw/secret/x.toml: bad", ".../x.toml: bad"),
        (f"{Path.home()}mary/secret/x.toml: bad", ".../x.toml: bad"),
        (f"{Path.home()}: is a folder", "<user folder>: is a folder"),
        ("/data/O'Brien/secret/x.toml: bad", ".../x.toml: bad"),
        ("'/data/a/x.h5' or '/data/b/y.h5'", "'.../x.h5' or '.../y.h5'"),
        ("client/part.h5: no such file", ".../part.h5: no such file"),
        ("part: file = client/a/part.h5", "part: file = .../part.h5"),
        ("(../client/x.toml)", "(.../x.toml)"),
        ("~/client/x.toml", ".../x.toml"),
        ("~jane/client/x.toml", ".../x.toml"),
        ("3.2 N/mm, not m/s2 or rad/s.", "3.2 N/mm, not m/s2 or rad/s."),
        (f"{Path(sys.prefix)}/client/x.py", "<environment>/client/x.py"),
    ],
)
def test_folders_users_and_machines_are_taken_out(text, expected, monkeypatch):
    monkeypatch.setattr(getpass, "getuser", lambda: "jane")
    monkeypatch.setattr(platform, "node", lambda: "turing")
    assert without_names(text) == expected


def test_folders_of_arguments_are_taken_out_as_words():
    words = ["client a/part.h5", "./m.toml"]
    text = "client a/part.h5: bad; m.toml, ../m.toml"
    assert without_names(text, words) == ".../part.h5: bad; m.toml, .../m.toml"
