"""The page of Python runs as it is written, and its errors are those that it shows."""

import re
import warnings
from pathlib import Path

import numpy as np
import pytest
from import_order import ROOT

from .walk import blocks

CODE = [block.text for block in blocks("python.md") if block.kind == "python"]
SLOW = "run.animate"


@pytest.fixture(scope="module")
def names(tmp_path_factory: pytest.TempPathFactory) -> dict[str, object]:
    """The names after all blocks, but that of the film and the page."""
    found: dict[str, object] = {}
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(tmp_path_factory.mktemp("python"))
        for text in CODE:
            if SLOW not in text:
                exec(compile(text, "docs/python.md", "exec"), found)
    found["folder"] = Path(str(tmp_path_factory.getbasetemp()))
    return found


def test_every_block_runs(names):
    assert names["run"]["hinge"].angle.shape == names["run"].time.shape
    assert names["swing"]["servo"].torque.max() == pytest.approx(60.0)
    closed_form = 0.1 * (1.0 - 6.0 * np.exp(-5.0))  # critically damped, omega t = 5
    assert names["simulator"].outputs[0] == pytest.approx(closed_form, rel=1e-3)


def test_the_frequencies_are_those_of_the_text(names):
    text = (ROOT / "docs/python.md").read_text(encoding="utf-8")
    told, slender = map(float, re.findall(r"([\d.]+) Hz", text))
    assert names["clamped"].modes(4).frequencies[0] == pytest.approx(told, abs=0.006)
    closed_form = 1.875104**2 / (2.0 * np.pi) * np.sqrt(70e9 * 0.05**2 / 12.0 / 2700.0)
    assert slender == pytest.approx(closed_form, abs=0.006)


def test_the_errors_are_those_of_the_text(names):
    (shown,) = [block.text for block in blocks("python.md") if block.kind == "text"]
    for line in re.findall(r">>> (.*)\n(.*)\n", shown):
        code, message = line
        kind, _, words = message.partition(": ")
        with pytest.raises(ValueError) as failure:  # noqa: PT011 - compared below
            eval(code, dict(names))
        assert (type(failure.value).__name__, str(failure.value)) == (kind, words)


def test_films_pages_and_files_are_written(names, tmp_path, monkeypatch):
    pytest.importorskip("pyvista")
    pytest.importorskip("k3d")
    monkeypatch.chdir(tmp_path)
    (text,) = [text for text in CODE if SLOW in text]
    with warnings.catch_warnings():
        exec(compile(text, "docs/python.md", "exec"), names)
    assert {path.name for path in tmp_path.iterdir()} == {
        *("bar.mp4", "bar.html", "bar.toml", "bar-rod.h5")
    }


def test_the_readme_prints_what_it_shows(capsys):
    code, shown = blocks("../README.md")
    exec(compile(code.text, "README.md", "exec"), {})
    assert capsys.readouterr().out.split() == shown.text.split()
