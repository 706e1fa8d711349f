"""Threads of BLAS: one where products are small, whatever the environment asks for."""

from importlib import import_module

import meshio
import numpy as np
import pytest
from duhamel.files.blas import one_blas_thread
from duhamel.preprocess import Body, build
from duhamel.preprocess.verification import static_check
from duhamel.solver import FlexibleBody, Model, Settings, linearize, simulate
from threadpoolctl import ThreadpoolController


def most_threads():
    found = ThreadpoolController().select(user_api="blas").info()
    return max(library["num_threads"] for library in found)


@pytest.fixture
def two_threads():
    with ThreadpoolController().limit(limits=2, user_api="blas"):
        if most_threads() < 2:
            pytest.skip("this BLAS has one thread")
        yield


@pytest.fixture
def threads_in(monkeypatch):
    """The threads of BLAS that each call of a function has, named by its module and name."""
    seen = {}

    def watch(module, name):
        module = import_module(f"duhamel.{module}")
        function = getattr(module, name)

        def watched(*arguments, **keywords):
            seen.setdefault(name, []).append(most_threads())
            return function(*arguments, **keywords)

        monkeypatch.setattr(module, name, watched)

    for module, name in (
        ("preprocess.build", "assemble_on"),
        ("preprocess.build", "impulse_responses"),
        ("preprocess.verification", "compliance"),
        ("solver.simulation", "initialize"),
        ("solver.linear.linearize", "equations_of"),
        ("solver.linear.linearize", "modes_of"),
        ("solver.linear.linearize", "validity_of"),
    ):
        watch(module, name)
    return seen


def test_the_limit_ends_with_the_block(two_threads):
    with one_blas_thread():
        assert most_threads() == 1
    assert most_threads() == 2


def test_small_products_have_one_thread(two_threads, threads_in, tmp_path):
    """Of preprocessing, its check, the start of a run, and linear analyses."""
    mesh = tmp_path / "bar.vtu"
    points = np.linspace(0.0, 0.5, 11)[:, None] * [1.0, 0.0, 0.0]
    lines = np.stack([np.arange(10), np.arange(1, 11)], axis=1)
    meshio.Mesh(points, [("line", lines)]).write(mesh)
    body = Body.model_validate(
        {
            "name": "bar",
            "mesh": mesh,
            "section": {
                "EA": 2.16e7,
                "EI_y": 5.5,
                "EI_z": 5.5,
                "GJ": 4.0,
                "mass_per_length": 0.0858,
                "polar_inertia_per_length": 4.4e-8,
            },
            "interfaces": {"root": {"node": [0, 0, 0]}, "tip": {"node": [0.5, 0, 0]}},
            "impulse": {"step": 1e-4, "steps": 10},
        }
    )
    bar = build(body)
    assert static_check(bar, body).holds
    model = Model({"bar": FlexibleBody(bar)}, settings=Settings(t_end=1e-3))
    simulate(model)
    linear = linearize(model)
    linear.validity(linear.modes(8))
    assert len(threads_in) == 7
    assert {threads for seen in threads_in.values() for threads in seen} == {1}
    assert most_threads() == 2


def test_the_limit_lasts_until_the_last_thread_has_left_it(two_threads):
    """Blocks of threads end in any order: the first to end is not the last that needs the limit."""
    first, second = one_blas_thread(), one_blas_thread()
    first.__enter__()
    second.__enter__()
    first.__exit__(None, None, None)
    assert most_threads() == 1
    second.__exit__(None, None, None)
    assert most_threads() == 2
