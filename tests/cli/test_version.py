"""The version, and the command as a module."""

import pydoc
import subprocess
import sys
from importlib.metadata import version

import duhamel
import pytest
from duhamel.cli import app


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


def test_help_says_where_to_begin():
    help_of_it = pydoc.render_doc(duhamel, renderer=pydoc.plaintext)
    assert "duhamel init" in help_of_it
    assert "from duhamel import preprocess, solver" in help_of_it


def test_the_package_itself_loads_nothing():
    code = "import sys; before = set(sys.modules); import duhamel; print(set(sys.modules) - before)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "{'duhamel'}\n"
