"""Bad files and options of every command: one line on stderr, code 1 or 2, nothing left behind."""

import itertools
import os
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from duhamel.cli import app
from typer.testing import CliRunner

from .models import MECHANISM

STUDY = """
model = "model.toml"
parameters.bodies.hub.mass = [1, 2]
"""
BODY = """
name = "beam"
mesh = "beam.msh"
"""

COMMANDS = {
    "run": "model.toml",
    "check": "model.toml",
    "preprocess": "body.toml",
    "preprocess --dry-run": "body.toml",
    "sweep --workers 0": "study.toml",
    "plot": "results.h5",
    "info": "beam.h5",
}
"""by words, with the file that each reads"""


def _folder(path: Path) -> None:
    path.mkdir()


def _text_not_utf8(path: Path) -> None:
    path.write_bytes("name = 'Größe'".encode("latin-1"))


FILES: dict[str, Callable[[Path], object]] = {
    "missing": lambda path: None,
    "a folder": _folder,
    "a fifo": os.mkfifo,
    "a device": lambda path: path.symlink_to("/dev/null"),
    "an endless device": lambda path: path.symlink_to("/dev/zero"),
    "a link to itself": lambda path: path.symlink_to(path),
    "empty": lambda path: path.write_bytes(b""),
    "zeros": lambda path: path.write_bytes(bytes(1000)),
    "not UTF-8": _text_not_utf8,
    "nested deep": lambda path: path.write_text("a = " + 5000 * "[" + 5000 * "]"),
    "keys nested deep": lambda path: path.write_text("a" + 5000 * ".a" + " = 1"),
    "an integer of 5000 digits": lambda path: path.write_text("a = " + 5000 * "9"),
    "keys with line breaks": lambda path: path.write_text('"a\\nb" = 1\n["c\\nd"]\n"e\\r" = 1'),
    "the signature of HDF5 alone": lambda path: path.write_bytes(b"\x89HDF\r\n\x1a\n"),
}

NAMES = {
    "of 300 characters": 300 * "x",
    "with a line break": "a\nb",
    "not UTF-8": os.fsdecode(b"\xff\xfe"),
    "in a file": "model.toml/x",
    "in no folder": "nowhere/x",
}


@pytest.fixture
def folder(beam_file: Path) -> Path:
    """A model, a study and a body without its mesh, as files of a folder."""
    for name, text in (("model", MECHANISM), ("study", STUDY), ("body", BODY)):
        (beam_file.parent / f"{name}.toml").write_text(text)
    return beam_file.parent


@pytest.fixture
def results(folder: Path) -> Path:
    target = folder / "results.h5"
    assert (
        CliRunner().invoke(app, ["run", str(folder / "model.toml"), "-o", str(target)]).exit_code
        == 0
    )
    return target


def complaints(folder: Path, *words: str, names: tuple[str, ...] = ()) -> Iterator[str]:
    """What is wrong with the answer to words that should be refused."""
    before = sorted(folder.rglob("*"))
    result = CliRunner().invoke(app, list(words))
    if not isinstance(result.exception, SystemExit):
        yield f"{type(result.exception).__name__}: {result.exception}"[:300]
    if result.exit_code not in (1, 2):
        yield f"exit code {result.exit_code}"
    lines = [line for line in result.stderr.splitlines() if not line.startswith("warning: ")]
    if result.exit_code == 1 and not (len(lines) == 1 and lines[0].startswith("error: ")):
        yield f"not one line: {result.stderr[:300]!r}"
    if not any(name in result.stderr for name in names):
        yield f"without {names}: {result.stderr[:300]!r}"
    if left := set(folder.rglob("*")) - set(before):
        yield f"left behind {sorted(left)}"


@pytest.mark.parametrize("what", FILES)
@pytest.mark.parametrize("command", COMMANDS)
def test_a_bad_file_is_one_line_that_names_it(command, what, folder):
    path = folder / COMMANDS[command]
    path.unlink(missing_ok=True)
    FILES[what](path)
    assert list(complaints(folder, *command.split(), str(path), names=(str(path),))) == []


@pytest.mark.parametrize("what", NAMES)
@pytest.mark.parametrize("command", COMMANDS)
def test_a_file_of_a_bad_name_is_one_line(command, what, folder):
    path = str(folder / NAMES[what])
    told = (path, "x", "a\\nb", "\\udcff")
    assert list(complaints(folder, *command.split(), path, names=told)) == []


@pytest.mark.parametrize("what", ["of 300 characters", "in a file", "in no folder"])
@pytest.mark.parametrize("command", ["run", "plot"])
def test_an_output_of_a_bad_name_is_one_line(command, what, folder, results):
    source = results if command == "plot" else folder / "model.toml"
    target = str(folder / NAMES[what]) + (".png" if command == "plot" else ".h5")
    assert list(complaints(folder, command, str(source), "-o", target, names=("x",))) == []


@pytest.mark.parametrize(
    ("command", "what"),
    [
        *itertools.product(("run", "plot"), ("a folder", "a link to itself")),
        ("run", "a fifo"),
        ("run", "a device"),
    ],
)
def test_an_output_that_is_no_file_is_one_line(command, what, folder, results):
    source = results if command == "plot" else folder / "model.toml"
    target = folder / ("a.png" if command == "plot" else "a.h5")
    FILES[what](target)
    assert list(complaints(folder, command, str(source), "-o", str(target), names=("a.",))) == []


@pytest.mark.parametrize("target", ["model.toml", "beam.h5"])
def test_a_run_does_not_replace_its_inputs(target, folder):
    before = (folder / target).read_bytes()
    words = "run", str(folder / "model.toml"), "-o", str(folder / target)
    assert list(complaints(folder, *words, names=("which the results would replace",))) == []
    assert (folder / target).read_bytes() == before


def test_a_plot_does_not_replace_the_results(results):
    target = results.with_name("picture.png")
    target.symlink_to(results)
    before = results.read_bytes()
    words = "plot", str(results), "-o", str(target)
    assert (
        list(complaints(results.parent, *words, names=("which the picture would replace",))) == []
    )
    assert results.read_bytes() == before


@pytest.mark.parametrize(
    "text", ["x" * 100_000, "$\\frac{$", "a\0b", os.fsdecode(b"\xff"), "", "a\n" * 50]
)
def test_any_title_is_drawn_or_refused(text, results):
    result = CliRunner().invoke(app, ["plot", str(results), "--title", text])
    assert result.exit_code in (0, 1), result.exception
    assert len(result.stderr.splitlines()) == result.exit_code


@pytest.mark.parametrize(
    "quantity",
    [
        "",
        ",",
        ":",
        "::::",
        "angle",
        "angle:hub:w",
        "position:no:x",
        "x" * 100_000,
        "a\nb",
        "\udcff",
    ],
)
def test_a_bad_quantity_is_one_line(quantity, results):
    words = "plot", str(results), quantity
    assert list(complaints(results.parent, *words, names=("error: ",))) == []


@pytest.mark.parametrize(
    "words",
    [
        ("--workers", "-1"),
        ("--workers", "x"),
        ("--scheduler", ""),
        ("--scheduler", "x"),
        ("--scheduler", "tcp://"),
        ("--scheduler", "tcp://127.0.0.1:1"),
        ("--scheduler", "tls://127.0.0.1:1"),
    ],
)
def test_bad_options_of_a_sweep_are_refused(words, folder, monkeypatch):
    monkeypatch.setattr("duhamel.study.workers.MAX_SCHEDULER_WAIT", 1)
    found = complaints(
        folder,
        "sweep",
        str(folder / "study.toml"),
        "-o",
        str(folder),
        *words,
        names=("scheduler", "--workers"),
    )
    assert [text for text in found if not text.startswith("left behind")] == []


@pytest.mark.parametrize(
    ("error", "message"),
    [
        (MemoryError(), "out of memory"),
        (MemoryError("Unable to allocate 3 GiB"), "out of memory: Unable to allocate 3 GiB"),
        (RecursionError("maximum depth"), "nested too deep: maximum depth"),
        (OSError(28, "No space left on device", "a\nb"), "[Errno 28] No space left on device: 'a"),
    ],
)
def test_what_the_machine_refuses_is_one_line(error, message, folder, monkeypatch):
    def fail(*arguments: object) -> None:
        raise error

    monkeypatch.setattr("duhamel.solver.check", fail)
    found = complaints(folder, "check", str(folder / "model.toml"), names=(f"error: {message}",))
    assert list(found) == []


def test_the_model_that_is_damaged_here_is_sound(folder):
    result = CliRunner().invoke(app, ["check", str(folder / "model.toml")])
    assert result.exit_code == 0, result.output
    assert sorted(path.suffix for path in folder.iterdir()) == [".h5", ".toml", ".toml", ".toml"]
