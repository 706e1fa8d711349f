"""The version, and the command as a module."""

import pydoc
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import duhamel
import pytest
from duhamel.cli import app
from rich.text import Text
from typer.main import get_command


def test_the_version_is_told(runner):
    result = runner.invoke(app, ["--version"])
    assert (result.exit_code, result.stdout) == (0, f"duhamel {version('duhamel')}\n")


@pytest.mark.parametrize("module", ["duhamel", "duhamel.cli"])
def test_the_package_runs_as_a_module(module):
    words = [sys.executable, "-m", module, "--version"]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    assert done.stdout == f"duhamel {version('duhamel')}\n"


def test_the_package_says_its_version():
    assert duhamel.__version__ == version("duhamel")


def test_no_word_of_help_is_taken_for_markup():
    """As a unit in brackets: "[s]" is what rich strikes through."""
    for command in get_command(app).commands.values():
        for text in (command.help, *(getattr(each, "help", "") for each in command.params)):
            assert Text.from_markup(text or "").plain == (text or "")


def test_help_says_where_to_begin():
    help_of_it = pydoc.render_doc(duhamel, renderer=pydoc.plaintext)
    assert "duhamel init" in help_of_it
    assert "import duhamel as du" in help_of_it


def test_the_package_itself_loads_nothing():
    code = "import sys; before = set(sys.modules); import duhamel; print(set(sys.modules) - before)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "{'duhamel'}\n"


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="Linux has it")
@pytest.mark.parametrize("words", ["--help", "run --help", "schema model"])
def test_a_full_disk_under_the_output_is_one_line(words):
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "duhamel", *words.split()],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
    assert done.returncode == 1
    assert done.stderr == ("error: standard output: cannot be written: No space left on device\n")
