"""Exports, and importers of them."""

import shutil

import pytest
from duhamel import fmu
from duhamel.solver.compiler.object_file import compiler

from .importers import Slave


@pytest.fixture(scope="session")
def exported(tmp_path_factory):
    """Exports a model, for the processor that `Simulator` has code for."""
    # Code of a wheel is for fewer instructions than this machine may have.
    cpu = "x86-64-v3" if compiler() == "shipped" else "native"

    def make(model, **options):
        path = tmp_path_factory.mktemp("fmu") / "machine.fmu"
        return fmu.export_fmu(model, path, **({"cpu": cpu} | options))

    return make


@pytest.fixture
def slave():
    """Opens an export, and closes all at the end."""
    opened = []

    def make(path, **options):
        opened.append(Slave(path, **options))
        return opened[-1]

    yield make
    for one in opened:
        one.close()
        shutil.rmtree(one.folder, ignore_errors=True)
