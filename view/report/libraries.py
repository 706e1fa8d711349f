"""The programs in JavaScript that draw on the page, as they are in the packages that bring them."""

import base64
import gzip
from importlib import import_module
from importlib.metadata import version
from pathlib import Path
from types import ModuleType

from ..errors import PictureError

# Within the packages, which bring their programs for pages without a network.
PLOTLY_FILE = "package_data/plotly.min.js"
K3D_FILE = "static/standalone.js"


def plotly() -> str:
    """Plotly, compressed, as text that a page holds."""
    return packed(_source("plotly", PLOTLY_FILE))


def k3d() -> str:
    """K3D with three.js, compressed, as text that a page holds."""
    return packed(_source("k3d", K3D_FILE))


def versions() -> str:
    """What the page is drawn by."""
    return ", ".join(f"{name} {version(name)}" for name in ("plotly", "k3d"))


def packed(data: bytes) -> str:
    """Bytes, gzip and base64: letters, digits, + / = alone, which end no element of a page."""
    return text(gzip.compress(data, 9, mtime=0))


def text(data: bytes) -> str:
    """Bytes as base64."""
    return base64.b64encode(data).decode("ascii")


def package(name: str) -> ModuleType:
    """A package of the extra `report`; `PictureError` without it."""
    try:
        return import_module(name)
    except ImportError as error:
        raise PictureError(
            f"duhamel report needs {name}: pip install 'duhamel[report]' ({error})"
        ) from error


def _source(name: str, file: str) -> bytes:
    module = package(name)
    assert module.__file__ is not None
    path = Path(module.__file__).parent / file
    try:
        return path.read_bytes()
    except OSError as error:
        raise PictureError(
            f"duhamel report needs {name} with {file}, found {name} {version(name)}: {error}"
        ) from error
