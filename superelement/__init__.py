"""The superelement: an elastic body reduced to its interfaces, and its HDF5 file."""

from typing import TYPE_CHECKING

from ..files.lazy import lazily_loaded

if TYPE_CHECKING:
    from .audit import check
    from .chain import Chain
    from .channels import Channels
    from .checks import Check
    from .file import read, require_writable, sha256, write
    from .interface import Interface
    from .kernel import Kernel, sample_kernel
    from .measured import MeasuredModes
    from .modes import Modes
    from .outline import Outline
    from .pattern import Pattern
    from .recovery import Recovery, von_mises
    from .response import respond, stressed
    from .rotation import Rotation
    from .scheme import GeneralizedAlpha
    from .sensor import Sensor
    from .superelement import Provenance, StepWarning, Superelement
    from .surfaces import Surface, Surfaces
    from .validation import SuperelementError

__all__ = [
    "Chain",
    "Channels",
    "Check",
    "GeneralizedAlpha",
    "Interface",
    "Kernel",
    "MeasuredModes",
    "Modes",
    "Outline",
    "Pattern",
    "Provenance",
    "Recovery",
    "Rotation",
    "Sensor",
    "StepWarning",
    "Superelement",
    "SuperelementError",
    "Surface",
    "Surfaces",
    "check",
    "read",
    "require_writable",
    "respond",
    "sample_kernel",
    "sha256",
    "stressed",
    "von_mises",
    "write",
]

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily_loaded(
        __name__,
        {
            ".audit": "check",
            ".chain": "Chain",
            ".channels": "Channels",
            ".checks": "Check",
            ".file": "read require_writable sha256 write",
            ".interface": "Interface",
            ".kernel": "Kernel sample_kernel",
            ".measured": "MeasuredModes",
            ".modes": "Modes",
            ".outline": "Outline",
            ".pattern": "Pattern",
            ".recovery": "Recovery von_mises",
            ".response": "respond stressed",
            ".rotation": "Rotation",
            ".scheme": "GeneralizedAlpha",
            ".sensor": "Sensor",
            ".superelement": "Provenance StepWarning Superelement",
            ".surfaces": "Surface Surfaces",
            ".validation": "SuperelementError",
        },
    )
