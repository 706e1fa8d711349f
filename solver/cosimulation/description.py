"""What the file of an FMU says of it, as far as a model needs it."""

import zipfile
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Any
from xml.etree import ElementTree

from ...inputs import quoted
from ...inputs.errors import did_you_mean
from ..errors import ModelError
from ..model.fmus import FMU, StartValue
from .fmpy import fmpy

REAL_TYPES = ("Real", "Float64", "Float32")
WHOLE_TYPES = (
    *("Integer", "Enumeration", "Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32"),
    *("Int64", "UInt64"),
)
TRUTH_TYPE, TEXT_TYPE = "Boolean", "String"
MAX_LISTED_VARIABLES = 12
"""names in a message"""
DERIVATIVES_OF_FMI_3 = "providesDirectionalDerivatives"
"""the attribute of a model description that FMPy leaves out"""


@dataclass(frozen=True)
class FMUVariable:
    """A variable of an FMU by its number (value reference) and type."""

    name: str
    reference: int
    type: str


@dataclass(frozen=True, eq=False)
class Description:
    """An FMU for co-simulation that this machine can run, with the variables that a model names.

    step: its own communication step [s], if it has one; saves, serializes: whether its state can be
    saved and restored, and be written as bytes; derives: whether it gives directional derivatives.
    """

    fmu: FMU
    version: int
    identifier: str
    token: str
    step: float | None
    saves: bool
    serializes: bool
    derives: bool
    inputs: tuple[FMUVariable, ...]
    outputs: tuple[FMUVariable, ...]
    parameters: tuple[tuple[FMUVariable, StartValue], ...]


def read_description(fmu: FMU) -> Description:
    """The description in the file of an FMU; `ModelError` says why the model cannot use it."""
    found, names, derives = _read(fmu)
    whole = found.coSimulation
    if whole is None:
        raise _error(fmu, "expected co-simulation, found model exchange alone")
    # Such an FMU starts another program, which may need a license and a screen.
    if whole.needsExecutionTool:
        tool = found.generationTool or "the tool that wrote it"
        raise _error(
            fmu,
            f"it runs only inside {tool} (needsExecutionTool): export it with its solver inside",
        )
    version = int(found.fmiMajorVersion)
    _check_platform(fmu, version, whole.modelIdentifier, names)
    known = {variable.name: variable for variable in found.modelVariables}
    return Description(
        fmu=fmu,
        version=version,
        identifier=whole.modelIdentifier,
        token=found.guid,
        step=_own_step(found),
        saves=whole.canGetAndSetFMUstate,
        serializes=whole.canGetAndSetFMUstate and whole.canSerializeFMUstate,
        derives=derives or whole.providesDirectionalDerivative,
        inputs=tuple(_number(fmu, "inputs", "input", name, known) for name in fmu.inputs),
        outputs=tuple(_number(fmu, "outputs", "output", name, known) for name in fmu.outputs),
        parameters=tuple(_parameter(fmu, *item, known) for item in fmu.parameters.items()),
    )


def _read(fmu: FMU) -> tuple[Any, list[str], bool]:
    """The description as FMPy has it, the files in the FMU, and a flag of FMI 3."""
    library = fmpy(fmu)
    try:
        with zipfile.ZipFile(fmu.file) as archive:
            names = archive.namelist()
            root = ElementTree.fromstring(archive.read("modelDescription.xml"))
    except (zipfile.BadZipFile, KeyError, ElementTree.ParseError, OSError) as error:
        raise _error(fmu, f"expected an FMU, found {_in_words(error)}") from error
    # Before FMPy, which takes FMI 1 for its own.
    version = root.get("fmiVersion", "")
    if not (version == "2.0" or version.startswith("3.")):
        raise _error(fmu, f"expected FMI 2 or 3, found {version or 'no version'}")
    element = root.find("CoSimulation")
    derives = element is not None and element.get(DERIVATIVES_OF_FMI_3) in ("true", "1")
    try:
        # Not validated: many FMUs break a rule of the schema that no run needs.
        return library.read_model_description(fmu.file, validate=False), names, derives
    except Exception as error:  # of any kind: FMPy does not say which
        raise _error(fmu, f"its description cannot be read: {error}") from error


def _in_words(error: Exception) -> str:
    if isinstance(error, KeyError):
        return "an archive without modelDescription.xml"
    if isinstance(error, ElementTree.ParseError):
        return f"a damaged modelDescription.xml ({error})"
    return str(error)


def _check_platform(fmu: FMU, version: int, identifier: str, names: Iterable[str]) -> None:
    library = fmpy(fmu)
    own = library.platform if version == 2 else library.platform_tuple
    if f"binaries/{own}/{identifier}{library.sharedLibraryExtension}" in names:
        return
    # What there is instead tells whom to ask for another export.
    parts = [name.split("/") for name in names if name.startswith("binaries/")]
    found = ", ".join(sorted({part[1] for part in parts if len(part) > 2 and part[2]}))
    raise _error(fmu, f"expected a library for {own}, found {found or 'none'}")


def _own_step(found: Any) -> float | None:
    # FMI 3 alone has a fixed step; a default experiment may be without one.
    fixed = getattr(found.coSimulation, "fixedInternalStepSize", None)
    experiment = found.defaultExperiment
    text = fixed or (experiment.stepSize if experiment is not None else None)
    step = float(text) if text else 0.0
    return step if step > 0.0 and isfinite(step) else None


def _number(fmu: FMU, key: str, causality: str, name: str, known: Mapping[str, Any]) -> FMUVariable:
    """A variable that is one real number."""
    found = _variable(fmu, key, causality, name, known)
    if found.type not in REAL_TYPES or found.dimensions:
        kind = f"an array of {found.type}" if found.dimensions else found.type
        raise fmu.error(
            f"{key}: {name}: expected a real number (Real, Float64 or Float32), found {kind} in "
            f"{fmu.file}"
        )
    return FMUVariable(name, int(found.valueReference), found.type)


def _variable(fmu: FMU, key: str, causality: str, name: str, known: Mapping[str, Any]) -> Any:
    own = [one.name for one in known.values() if one.causality == causality]
    if name not in known:
        raise fmu.error(
            f"{key}: no variable {quoted(name)} in {fmu.file}"
            f"{did_you_mean(name, own, n=3) or _listed(own)}"
        )
    if known[name].causality != causality:
        found = known[name].causality or "local"
        raise fmu.error(
            f"{key}: {name}: expected a variable of causality {causality}, found {found} in "
            f"{fmu.file}{did_you_mean(name, own, n=3)}"
        )
    return known[name]


def _listed(names: Sequence[str]) -> str:
    """The end of a message: some of the names that there are."""
    more = ", ..." if len(names) > MAX_LISTED_VARIABLES else ""
    return f"; it has: {', '.join(names[:MAX_LISTED_VARIABLES]) or 'none'}{more}"


def _parameter(
    fmu: FMU, name: str, start: StartValue, known: Mapping[str, Any]
) -> tuple[FMUVariable, StartValue]:
    found = _variable(fmu, "parameters", "parameter", name, known)
    fits, expected = {
        TRUTH_TYPE: (isinstance(start, bool), "true or false"),
        TEXT_TYPE: (isinstance(start, str), "a text"),
        **dict.fromkeys(WHOLE_TYPES, (_is_whole(start), "a whole number")),
        **dict.fromkeys(REAL_TYPES, (_is_real(start), "a number")),
    }.get(found.type, (False, "a number, a text, or true or false"))
    if not fits or found.dimensions:
        kind = f"an array of {found.type}" if found.dimensions else found.type
        raise fmu.error(f"parameters: {name}: expected {expected} ({kind}), got {quoted(start)}")
    return FMUVariable(name, int(found.valueReference), found.type), start


def _is_whole(start: StartValue) -> bool:
    # In Python a bool is an int.
    return isinstance(start, int) and not isinstance(start, bool)


def _is_real(start: StartValue) -> bool:
    return isinstance(start, int | float) and not isinstance(start, bool)


def _error(fmu: FMU, message: str) -> ModelError:
    return fmu.error(f"file: {fmu.file}: {message}")
