"""Work that does not fit into memory."""

import re

import pytest
from duhamel.preprocess.errors import MemoryShortageError
from duhamel.preprocess.memory import require


def test_more_than_there_is_is_refused_with_all_numbers(monkeypatch):
    monkeypatch.setattr("duhamel.preprocess.memory.available", lambda: 2e9)
    require({"the factor": 1.5e9, "the basis": 0.5e9}, "lower impulse.band")
    expected = (
        "the factor needs 1.5 GB of memory and the basis 1 GB, "
        "2 GB are available: lower impulse.band"
    )
    with pytest.raises(MemoryShortageError, match=re.escape(expected)) as e:
        require({"the factor": 1.5e9, "the basis": 1e9}, "lower impulse.band")
    assert isinstance(e.value, MemoryError)
    assert (e.value.needed, e.value.available) == (2.5e9, 2e9)
