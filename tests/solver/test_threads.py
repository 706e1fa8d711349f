"""Runs in several threads at once: the time loop releases Python's lock, and shares nothing."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
from duhamel.solver import (
    Frame,
    Harmonic,
    Model,
    Results,
    Revolute,
    RigidBody,
    Settings,
    Start,
    Torque,
    simulate,
)

THREADS = 4


def arm(amplitude: float) -> Model:
    body = RigidBody(1.0, [0.1, 0.1, 0.1], {"pin": Frame([-0.5, 0, 0])}, Start([0.5, 0, 0]))
    return Model(
        {"arm": body},
        [Revolute("ground", "arm.pin", [0, 0, 1], name="hinge")],
        loads=[Torque("arm", [0, 0, 1], Harmonic(amplitude, 2.0))],
        settings=Settings(t_end=0.5, step=1e-3),
    )


AMPLITUDES = [0.5 * k for k in range(1, 9)]


def angles(results: Results) -> bytes:
    angle: np.ndarray = results.joint("hinge").angle
    return angle.tobytes()


def test_runs_in_threads_are_those_of_one_after_another():
    alone = [angles(simulate(arm(amplitude))) for amplitude in AMPLITUDES]
    with ThreadPoolExecutor(THREADS) as pool:
        together = [angles(each) for each in pool.map(simulate, map(arm, AMPLITUDES))]
    assert together == alone
    assert len(set(alone)) == len(AMPLITUDES)


def test_files_of_runs_in_threads_are_those_of_one_after_another(tmp_path):
    def written(case: tuple[str, float]) -> bytes:
        name, amplitude = case
        simulate(arm(amplitude), output=tmp_path / f"{name}.h5")
        return angles(Results.read(tmp_path / f"{name}.h5"))

    alone = [written((f"alone-{a}", a)) for a in AMPLITUDES]
    with ThreadPoolExecutor(THREADS) as pool:
        together = list(pool.map(written, [(f"together-{a}", a) for a in AMPLITUDES]))
    assert together == alone
