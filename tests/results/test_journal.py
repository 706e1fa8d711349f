"""Files whose changes take place at once: interrupts wait."""

import signal

import pytest
from duhamel.results.journal import uninterrupted


def interrupt_and_go_on(done):
    with uninterrupted():
        signal.raise_signal(signal.SIGINT)
        done.append("all")


def test_an_interrupt_waits_until_the_block_has_ended():
    done = []
    with pytest.raises(KeyboardInterrupt):
        interrupt_and_go_on(done)
    assert done == ["all"]
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


@pytest.fixture
def foreign_handler(monkeypatch):
    """Python does not know what handles the signal, as where it is embedded in another program."""
    install = signal.signal
    monkeypatch.setattr(signal, "signal", lambda *given: install(*given) and None)


@pytest.mark.usefixtures("foreign_handler")
def test_an_interrupt_that_another_program_handled_is_one_of_python():
    with pytest.raises(KeyboardInterrupt):
        interrupt_and_go_on([])
