"""Exports, and importers of them."""

import shutil

import pytest
from duhamel import fmu

from .importers import Slave


@pytest.fixture(scope="session")
def exported(tmp_path_factory):
    """Exports a model, for the processor of this machine unless another is asked for."""

    def make(model, **options):
        path = tmp_path_factory.mktemp("fmu") / "machine.fmu"
        return fmu.export_fmu(model, path, **({"cpu": "native"} | options))

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
