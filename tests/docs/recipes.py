"""The code of docs/extending.md: where blocks belong, and a copy of the sources with all in."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

from import_order import PACKAGES, ROOT

PAGE = ROOT / "docs" / "extending.md"
TRIAL = "# try it"
TARGET = re.compile(r"# (?P<file>[\w/]+\.py)(?:, (?P<how>below|instead of) `(?P<line>.+)`)?")


class Block(NamedTuple):
    """Code of the page: the heading that it stands under, its first line, and the rest."""

    heading: str
    first: str
    code: str


def blocks() -> list[Block]:
    """All blocks of Python, in the order of the page."""
    found, heading = [], ""
    parts = re.split(r"^(## [^\n]+|```python\n.*?^```)$", PAGE.read_text(), flags=re.M | re.S)
    for part in parts:
        if part.startswith("## "):
            heading = part.removeprefix("## ")
        elif part.startswith("```python\n"):
            first, _, code = part.removeprefix("```python\n").removesuffix("```").partition("\n")
            found.append(Block(heading, first, code))
    return found


def extended_copy(folder: Path) -> Path:
    """A folder for PYTHONPATH: the packages, with the blocks of all recipes in their places."""
    namespace = folder / "duhamel"
    shutil.copytree(ROOT / "top", namespace)
    for package in PACKAGES:
        shutil.copytree(
            ROOT / package, namespace / package, ignore=shutil.ignore_patterns("__pycache__")
        )
    for block in blocks():
        if block.first != TRIAL:
            _insert(namespace, block)
    return folder


def _insert(namespace: Path, block: Block) -> None:
    target = TARGET.fullmatch(block.first)
    assert target is not None, f"extending.md: {block.first!r} does not say where its block goes"
    path = namespace / target["file"]
    if target["line"] is None:
        assert not path.exists(), f"extending.md: {target['file']} exists"
        path.write_text(block.code)
        return
    lines = path.read_text().splitlines(keepends=True)
    at = next((i for i, line in enumerate(lines) if line.strip() == target["line"]), None)
    assert at is not None, f"extending.md: {target['file']} has no line {target['line']!r}"
    lines[at : at + 1] = ([] if target["how"] == "instead of" else [lines[at]]) + [block.code]
    path.write_text("".join(lines))


def run(code: str, extended: Path, folder: Path, compiled: bool = False) -> str:
    """Run a program with the extended copy; what it wrote to standard error if it failed."""
    environment = {**os.environ, "PYTHONPATH": str(extended)}
    if not compiled:
        environment["NUMBA_DISABLE_JIT"] = "1"
    process = subprocess.run(
        [sys.executable, "-W", "error", "-c", code],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
    )
    return process.stderr if process.returncode else ""
