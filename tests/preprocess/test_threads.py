"""Work on several threads, whose results come in the order of the work."""

import threading
from itertools import count

import pytest
from duhamel.preprocess.threads import in_order, threads


@pytest.fixture(params=["1", "2", "3"])
def several(request, monkeypatch):
    monkeypatch.setattr("os.sched_getaffinity", lambda _: range(4), raising=False)
    monkeypatch.setenv("OMP_NUM_THREADS", request.param)
    return int(request.param)


def test_results_come_in_the_order_of_the_items(several):
    """Though the first is done last, where there is a thread for the second."""
    second = threading.Event()

    def work(item):
        if item == 1:
            second.set()
        elif item == 0 and several > 1:
            assert second.wait(10.0)
        return 10 * item

    assert threads() == several
    assert list(in_order(work, range(7))) == [0, 10, 20, 30, 40, 50, 60]


def test_items_are_taken_as_they_are_needed(several):
    taken = []

    def items():
        for item in count():
            taken.append(item)
            yield item

    results = in_order(lambda item: item, items())
    assert [next(results) for _ in range(5)] == [0, 1, 2, 3, 4]
    assert len(taken) <= 5 + several
    results.close()


def test_an_error_reaches_who_asks(several):
    def work(item):
        if item == 2:
            raise ValueError("the third one")
        return item

    results = in_order(work, range(5))
    assert [next(results), next(results)] == [0, 1]
    with pytest.raises(ValueError, match="the third one"):
        next(results)
