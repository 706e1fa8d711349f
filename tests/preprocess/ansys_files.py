"""The files of ANSYS that come with ansys-mapdl-reader."""

from importlib.util import find_spec
from pathlib import Path

import pytest


def ansys_examples() -> Path:
    """Their folder, without an import of the library, which changes colors and fonts of PyVista."""
    try:
        found = find_spec("ansys.mapdl.reader")
    except ModuleNotFoundError:
        found = None
    if found is None or not found.submodule_search_locations:
        pytest.skip("takes ansys-mapdl-reader")
    return Path(found.submodule_search_locations[0]) / "examples"
