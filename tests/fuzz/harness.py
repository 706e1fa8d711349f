"""Runs workers on damaged files, survives their crashes and ends those that hang."""

import select
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PATIENCE = 20.0
"""seconds for one file; more is a hang"""
STARTING = 300.0
"""seconds until a worker is ready: it may have to compile"""
GOOD = ("read", "refused")


@dataclass
class Tally:
    """The answers of a reader: how many files were read and refused, and findings by number."""

    answers: Counter[str] = field(default_factory=Counter)
    findings: dict[int, str] = field(default_factory=dict)

    @property
    def executions(self) -> int:
        return sum(self.answers.values()) + len(self.findings)

    def add(self, number: int, answer: str) -> None:
        if answer in GOOD:
            self.answers[answer] += 1
        else:
            self.findings[number] = answer


def fuzz(name: str, first: int, count: int, module: str = "tests.fuzz.worker") -> Tally:
    """The answers of a reader to the damaged files first, first + 1, ..."""
    tally = Tally()
    while count > 0:
        done = _one_worker(name, first, count, tally, module)
        first, count = first + done, count - done
    return tally


def _one_worker(name: str, first: int, count: int, tally: Tally, module: str) -> int:
    """The files that a worker took until it ended, however it did."""
    with tempfile.TemporaryDirectory() as folder:
        words = [sys.executable, "-m", module, name, str(first), str(count), folder]
        with subprocess.Popen(
            words, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
        ) as process:
            try:
                return _follow(process, first, count, tally)
            finally:
                process.kill()


def _follow(process: "subprocess.Popen[bytes]", first: int, count: int, tally: Tally) -> int:
    lines = _lines(process)
    if next(lines, "") != "ready":
        raise RuntimeError("the worker did not start")
    for done in range(count):
        number, answer = next(lines, ""), next(lines, "")
        if not answer:
            tally.add(int(number or first + done), _end(process))
            return done + 1
        tally.add(int(number), answer)
    return count


def _end(process: "subprocess.Popen[bytes]") -> str:
    try:
        return f"ended with {process.wait(1)}"
    except subprocess.TimeoutExpired:
        return "hangs"


def _lines(process: "subprocess.Popen[bytes]") -> Iterator[str]:
    """The lines of a process, until it ends or says nothing for too long."""
    patience, waiting = STARTING, b""
    assert process.stdout is not None
    while select.select([process.stdout], [], [], patience)[0]:
        if not (data := process.stdout.read1(1 << 16)):
            return
        *whole, waiting = (waiting + data).split(b"\n")
        yield from (line.decode(errors="replace") for line in whole)
        patience = PATIENCE
