"""Fuzz all readers for some time, one file after the other.

python -m tests.fuzz.run [SECONDS [FIRST]]
"""

import sys
import time
from collections.abc import Collection

from .harness import Tally, fuzz

BATCH = 500
"""damaged files of a reader at a time"""
NAMES = (
    "model",
    "study",
    "study table",
    "body",
    "superelement",
    "results",
    "mesh",
    "matrix",
    "nodes",
)


def main(seconds: float = 60.0, first: int = 0) -> int:
    """The number of findings."""
    started, tallies = time.monotonic(), {name: Tally() for name in NAMES}
    while time.monotonic() - started < seconds:
        for name, tally in tallies.items():
            found = fuzz(name, first, BATCH)
            tally.answers += found.answers
            for number, answer in found.findings.items():
                tally.add(number, answer)
                print(f"{name} {number}: {answer}", flush=True)
            if time.monotonic() - started > seconds:
                break
        first += BATCH
        print(f"{first}: {_summary(tallies.values())}", flush=True)
    for name, tally in tallies.items():
        print(f"{name}: {tally.executions}, {dict(tally.answers)}, {len(tally.findings)} findings")
    print(_summary(tallies.values()))
    return sum(len(tally.findings) for tally in tallies.values())


def _summary(tallies: Collection[Tally]) -> str:
    executions = sum(tally.executions for tally in tallies)
    findings = sum(len(tally.findings) for tally in tallies)
    return f"{executions} executions, {findings} findings"


if __name__ == "__main__":
    sys.exit(1 if main(*map(float, sys.argv[1:2]), *map(int, sys.argv[2:3])) else 0)
