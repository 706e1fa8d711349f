"""Pages that are walked through: files that they show, and commands with what they print.

    ```toml title="lever.toml"       a file
    ```console                       commands after "$ ", each followed by lines that it prints

Of the lines shown, "..." stands for any, at the end of a line for its rest. Numbers agree to 2 %;
of sizes of files and times in s and us, which machines differ in, it only counts that there is one.
"""

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

from import_order import ROOT

BLOCK = re.compile(
    r"^```(?P<kind>\w+)(?: title=\"(?P<title>[^\"]+)\")?\n(?P<text>.*?)^```$", re.M | re.S
)
NUMBER = re.compile(r"(-?\d+(?:\.\d+)?(?:e[-+]?\d+)?)( (?:s|us|MB)\b)?")
CLOSE = 0.02
"""by which numbers that are shown may be off, of what is printed"""


class Block(NamedTuple):
    """A fenced block of a page: its language, the file that it is, and its text."""

    kind: str
    title: str | None
    text: str


def blocks(page: str) -> list[Block]:
    """All fenced blocks of a page of docs/."""
    text = (ROOT / "docs" / page).read_text(encoding="utf-8")
    return [Block(m["kind"], m["title"], m["text"]) for m in BLOCK.finditer(text)]


def walk(page: str, folder: Path) -> list[str]:
    """Write the files and run the commands of a page; what was shown and not printed."""
    missing = []
    for block in blocks(page):
        if block.title is not None:
            (folder / block.title).write_text(block.text, encoding="utf-8")
        elif block.kind == "console":
            for command, shown in commands(block.text):
                printed = run(command, folder).splitlines()
                missing += [line for line in shown if not any(agree(line, p) for p in printed)]
    return missing


def commands(text: str) -> list[tuple[str, list[str]]]:
    """Commands of a block, each with the lines that are shown below it."""
    found: list[tuple[str, list[str]]] = []
    for line in text.splitlines():
        if line.startswith("$ "):
            found.append((line[2:], []))
        elif line != "...":
            found[-1][1].append(line)
    return found


def run(command: str, folder: Path) -> str:
    """What a command prints; an error if it fails or warns."""
    words = shlex.split(command)
    if words[0] == "duhamel":
        words = [sys.executable, "-m", "duhamel.cli", *words[1:]]
    elif words[0] == "python":
        words[0] = sys.executable
    elif words[0] == "gmsh":
        words = [sys.executable, "-c", _GMSH, *words[1:]]
    done = subprocess.run(
        words,
        cwd=folder,
        capture_output=True,
        text=True,
        encoding="utf-8",
        env={**os.environ, "COLUMNS": "80"},
    )
    assert done.returncode == 0, f"{command}: {done.stderr}"
    warned = [line for line in done.stderr.splitlines() if line.startswith("warning")]
    assert not warned, f"{command}: {warned}"
    return done.stdout


def shape(line: str) -> str:
    """A line whose numbers and blanks do not count."""
    return " ".join(NUMBER.sub("#", line).split())


def numbers(line: str) -> list[float]:
    """The numbers of a line that do not depend on the machine."""
    return [float(number) for number, measured in NUMBER.findall(line) if not measured]


def agree(shown: str, printed: str) -> bool:
    """Whether a line that is shown is one that is printed."""
    if shown.endswith("..."):
        shown = shown.removesuffix("...").rstrip()
        same = shape(printed).startswith(shape(shown))
    else:
        same = shape(printed) == shape(shown)
    pairs = zip(numbers(shown), numbers(printed), strict=False)
    return same and all(abs(a - b) <= CLOSE * abs(b) for a, b in pairs)


_GMSH = "import gmsh, sys; gmsh.initialize(['gmsh', *sys.argv[1:]], run=True, interruptible=False)"
"""the command of Gmsh, whose script need not be on the path"""
