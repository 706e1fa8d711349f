"""A results file made by hand."""

from collections.abc import Callable
from pathlib import Path

import h5py
import pytest

from .disc import write_disc


@pytest.fixture
def results_file(tmp_path: Path) -> Path:
    return write_disc(tmp_path / "disc-results.h5")


@pytest.fixture
def edit(results_file: Path) -> Callable[[Callable[[h5py.File], None]], Path]:
    """Change the file, and give its path."""

    def edited(change: Callable[[h5py.File], None]) -> Path:
        with h5py.File(results_file, "a") as file:
            change(file)
        return results_file

    return edited
