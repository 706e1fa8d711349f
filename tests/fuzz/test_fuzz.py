"""Damaged files of every kind: each is read, or refused in one line that names it.

`make fuzz` tries others for as long as it is told.
"""

import random
import signal

import pytest

from .harness import fuzz
from .mutations import MUTATIONS, mutated
from .run import NAMES
from .targets import targets

NUMBER = 60
"""damaged files of each reader"""


@pytest.mark.parametrize("name", NAMES)
def test_damaged_files_are_read_or_refused(name):
    tally = fuzz(name, 0, NUMBER)
    assert tally.findings == {}
    assert tally.executions == NUMBER
    assert tally.answers["refused"] > 0


def test_all_readers_are_fuzzed(tmp_path):
    assert set(targets(tmp_path)) == set(NAMES)


def test_crashes_hangs_and_foreign_exceptions_are_found(monkeypatch):
    monkeypatch.setitem(fuzz.__globals__, "PATIENCE", 0.5)
    tally = fuzz("any", 0, 6, "tests.fuzz.broken")
    assert tally.answers == {"read": 2, "refused": 1}
    assert tally.findings == {
        2: f"ended with -{signal.SIGSEGV.value}",
        3: "KeyError: 3",
        4: "hangs",
    }


def test_a_number_stands_for_one_damaged_file():
    seeds = [b"a = 1\nb = 2\n", b"c = 3\n"]
    assert [mutated(n, seeds) for n in range(50)] == [mutated(n, seeds) for n in range(50)]
    assert len({mutated(n, seeds) for n in range(50)}) > 40


def test_every_mutation_takes_an_empty_file():
    for mutation in MUTATIONS:
        mutation(random.Random(0), bytearray(), [b""])
