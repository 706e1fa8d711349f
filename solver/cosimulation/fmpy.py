"""FMPy, which reads and calls FMUs: loaded where a model has one, and not before."""

from importlib import import_module
from typing import Any

from ..model.fmus import FMU


def fmpy(fmu: FMU, module: str = "") -> Any:
    """FMPy, or a module of it; `ModelError` where it is not installed."""
    try:
        return import_module(f"fmpy.{module}" if module else "fmpy")
    except ImportError as error:
        raise fmu.error(
            f"FMUs need FMPy, which cannot be loaded ({error}): pip install 'duhamel[fmu]'"
        ) from error
