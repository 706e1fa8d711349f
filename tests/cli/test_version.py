"""The version, and the command as a module."""

import subprocess
import sys
from importlib.metadata import version

from duhamel.cli import app


def test_the_version_is_told(runner):
    result = runner.invoke(app, ["--version"])
    assert (result.exit_code, result.stdout) == (0, f"duhamel {version('duhamel')}\n")


def test_the_package_of_commands_runs_as_a_module():
    words = [sys.executable, "-m", "duhamel.cli", "--version"]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    assert done.stdout == f"duhamel {version('duhamel')}\n"
