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
    group = get_command(app)
    for command in (group.get_command(None, name) for name in group.list_commands(None)):
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


def test_a_wrong_name_of_a_command_is_told_the_right_one(runner):
    result = runner.invoke(app, ["rum"], env={"COLUMNS": "100"})
    assert result.exit_code == 2
    assert "Did you mean 'run'?" in result.stderr


def test_a_command_imports_no_other():
    code = "import sys; from duhamel.cli import app; app(['info', '--help'], standalone_mode=False)"
    code += "; print(*(name for name in sys.modules if name.startswith('duhamel.cli.commands.')))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split()[-1] == "duhamel.cli.commands.info"
    assert "duhamel.cli.commands.plot" not in done.stdout
