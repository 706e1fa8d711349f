"""The superelement: an elastic body reduced to its interfaces, and its HDF5 file."""

from typing import TYPE_CHECKING

from ..files.lazy import lazily_loaded

if TYPE_CHECKING:
    from .audit import check
    from .chain import Chain
    from .channels import Channels
    from .checks import Check
    from .derivative import DesignDerivative
    from .file import read, require_writable, sha256, write
    from .interface import Interface
    from .kernel import Kernel, sample_kernel
    from .measured import MeasuredModes
    from .modes import Modes
    from .outline import Outline
    from .parameters import redesigned, scaled, with_parameters
    from .pattern import Pattern
    from .recovery import Recovery, von_mises
    from .response import respond, stressed
    from .rotation import Rotation
    from .scheme import GeneralizedAlpha
    from .sensor import Sensor
    from .superelement import Provenance, StepWarning, Superelement, SuperelementVariation
    from .surfaces import Surface, Surfaces
    from .validation import SuperelementError

__all__ = [
    "Chain",
    "Channels",
    "Check",
    "DesignDerivative",
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
    "SuperelementVariation",
    "Surface",
    "Surfaces",
    "check",
    "read",
    "redesigned",
    "require_writable",
    "respond",
    "sample_kernel",
    "scaled",
    "sha256",
    "stressed",
    "von_mises",
    "with_parameters",
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
            ".parameters": "redesigned scaled with_parameters",
            ".pattern": "Pattern",
            ".recovery": "Recovery von_mises",
            ".response": "respond stressed",
            ".rotation": "Rotation",
            ".scheme": "GeneralizedAlpha",
            ".sensor": "Sensor",
            ".superelement": "Provenance StepWarning Superelement SuperelementVariation",
            ".surfaces": "Surface Surfaces",
            ".derivative": "DesignDerivative",
            ".validation": "SuperelementError",
        },
    )
