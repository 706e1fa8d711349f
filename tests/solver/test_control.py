"""Runs that another thread holds, continues and stops."""

import time
from contextvars import copy_context
from dataclasses import replace
from threading import Thread

import pytest
from duhamel.results import Results
from duhamel.solver import Constant, Frame, Model, Revolute, RigidBody, Settings, Torque, simulate
from duhamel.solver.control import RUN_CONTROL, RunControl

ARM = Model(
    {"arm": RigidBody(1.0, [0.1, 0.1, 0.1], {"pin": Frame([-0.5, 0, 0])})},
    [Revolute("ground", "arm.pin", [0, 0, 1], name="hinge")],
    loads=[Torque("arm", [0, 0, 1], Constant(1.0))],
    settings=Settings(t_end=5.0, step=1e-4),
)


class Controlled:
    """A run to a file in a thread of its own."""

    def __init__(self, path, model=ARM):
        self.control, self.found = RunControl(), None
        self.thread = Thread(target=copy_context().run, args=(self._run, path, model))
        self.thread.start()

    def _run(self, path, model):
        RUN_CONTROL.set(self.control)
        try:
            self.found = simulate(model, output=path)
        except BaseException as error:
            self.found = error

    def result(self):
        self.thread.join(60.0)
        return self.found


def rows(path):
    return len(Results.read(path).time)


def begun(control):
    until = time.monotonic() + 60.0
    while control.place is None and time.monotonic() < until:
        time.sleep(0.005)
    assert control.place is not None


def test_a_run_that_is_held_takes_no_step_and_then_goes_on_to_the_bit(tmp_path):
    path = tmp_path / "held.h5"
    run = Controlled(path)
    begun(run.control)
    run.control.hold()
    time.sleep(1.0)  # beyond the batch in which it is
    assert run.control.held
    seen = rows(run.control.place)
    time.sleep(0.5)
    assert rows(run.control.place) == seen < 50_001
    run.control.go_on()
    held, alone = run.result(), simulate(ARM)
    assert held.joint("hinge").angle.tobytes() == alone.joint("hinge").angle.tobytes()
    assert not run.control.held


def test_all_rows_of_a_run_that_is_held_can_be_read(tmp_path):
    path = tmp_path / "held.h5"
    run = Controlled(path)
    begun(run.control)
    run.control.hold()
    time.sleep(1.0)
    results = Results.read(run.control.place)
    # Rows otherwise take place once a second.
    assert len(results.time) > 1
    run.control.stop()
    assert str(run.result()).startswith(f"interrupted at t = {results.time[-1]:.6g} s of 5 s")


class HeldOften(RunControl):
    """Holds the run before each of its first batches, looks at its file, and stops it."""

    def __init__(self):
        super().__init__()
        self.seen = []

    def obey(self, before_waiting):
        self.hold()

        def look():
            before_waiting()
            self.seen.append(rows(self.place))
            self.go_on()
            if len(self.seen) == 3:
                self.stop()

        return super().obey(look)


def test_each_pause_finds_all_steps_in_the_file(tmp_path):
    token = RUN_CONTROL.set(control := HeldOften())
    try:
        with pytest.raises(KeyboardInterrupt) as stopped:
            simulate(ARM, output=tmp_path / "held.h5")
    finally:
        RUN_CONTROL.reset(token)
    # They follow within the second after which rows take place anyway.
    assert 1 == control.seen[0] < control.seen[1] < control.seen[2]
    taken = control.seen[2] - 1
    assert str(stopped.value).startswith(f"interrupted at t = {taken * 1e-4:.6g} s of 5 s")


def test_a_run_that_is_to_end_is_not_held(tmp_path):
    control = RunControl()
    control.stop()
    control.hold()
    assert not control.held
    with pytest.raises(KeyboardInterrupt):
        control.obey(lambda: None)


@pytest.mark.parametrize("held", [False, True])
def test_a_run_that_is_stopped_ends_as_by_an_interrupt(tmp_path, held):
    path = tmp_path / "stopped.h5"
    run = Controlled(path)
    begun(run.control)
    if held:
        run.control.hold()
    run.control.stop()
    error = run.result()
    assert isinstance(error, KeyboardInterrupt)
    assert "rows are in" in str(error) or "nothing is kept" in str(error)


class HeldForDays(RunControl):
    """Held before the first step, while a clock goes on by a million seconds."""

    def __init__(self):
        super().__init__()
        self.pause = 0.0
        self.hold()

    def obey(self, before_waiting):
        def wait():
            before_waiting()
            self.pause += 1e6
            self.go_on()

        return super().obey(wait)


def test_the_time_of_the_pause_is_none_of_the_steps(monkeypatch):
    control, clock = HeldForDays(), time.perf_counter
    monkeypatch.setattr(time, "perf_counter", lambda: clock() + control.pause)

    def run():
        RUN_CONTROL.set(control)
        return simulate(replace(ARM, settings=Settings(t_end=0.01, step=1e-4)))

    results = copy_context().run(run)
    assert control.pause == 1e6
    assert len(results.time) == 101
    assert 0.0 < results.solver["seconds"] < 1e5
