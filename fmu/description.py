"""The descriptions of an FMU in XML, of FMI 3.0 and 2.0."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

from .naming import base_units
from .variables import Variable, VariableKind

CAUSALITY_OF_KIND = {
    VariableKind.TIME: "independent",
    VariableKind.INPUT: "input",
    VariableKind.PARAMETER: "parameter",
    VariableKind.REAL: "output",
    VariableKind.INTEGER: "output",
}

VARIABILITY_OF_KIND = {VariableKind.PARAMETER: "tunable", VariableKind.INTEGER: "discrete"}


@dataclass(frozen=True)
class Experiment:
    """What a description tells of an export.

    name: of the model; identifier: of its library; step: the internal one [s]; communication:
    that of importers by default [s]; stop: the end of the model [s]; ends: whether nothing is known
    after that.
    """

    name: str
    identifier: str
    token: str
    step: float
    communication: float
    stop: float


def description(version: int, experiment: Experiment, variables: Sequence[Variable]) -> bytes:
    """modelDescription.xml of a version of FMI."""
    make = {2: _description_2, 3: _description_3}[version]
    return _text(make(experiment, variables))


def terminals(variables: Sequence[Variable]) -> bytes:
    """terminalsAndIcons.xml: one terminal for each joint, motor, frame and sensor."""
    root = Element("fmiTerminalsAndIcons", fmiVersion="3.0")
    owners = dict.fromkeys(one.terminal for one in variables if one.terminal)
    if owners:
        group = SubElement(root, "Terminals")
        for owner in owners:
            terminal = SubElement(group, "Terminal", name=owner, matchingRule="plug")
            for one in variables:
                if one.terminal == owner:
                    member = one.name.removeprefix(f"{owner}.")
                    SubElement(
                        terminal,
                        "TerminalMemberVariable",
                        variableName=one.name,
                        memberName=member,
                        variableKind="signal",
                    )
    return _text(root)


def _text(root: Element) -> bytes:
    ElementTree.indent(root)
    text: str = ElementTree.tostring(root, "unicode")
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{text}\n'.encode()


def _description_3(experiment: Experiment, variables: Sequence[Variable]) -> Element:
    root = Element(
        "fmiModelDescription",
        fmiVersion="3.0",
        modelName=experiment.name,
        instantiationToken=experiment.token,
        generationTool="Duhamel",
        variableNamingConvention="structured",
    )
    SubElement(
        root,
        "CoSimulation",
        modelIdentifier=experiment.identifier,
        canHandleVariableCommunicationStepSize="true",
        fixedInternalStepSize=repr(experiment.step),
        canGetAndSetFMUState="true",
        canSerializeFMUState="true",
        providesIntermediateUpdate="true",
        canReturnEarlyAfterIntermediateUpdate="true",
    )
    _add_units(root, variables)
    _add_categories(root)
    _add_experiment(root, experiment)
    group = SubElement(root, "ModelVariables")
    for reference, one in enumerate(variables):
        tag = "Int64" if one.kind is VariableKind.INTEGER else "Float64"
        element = SubElement(group, tag, _attributes(one, reference))
        # Inputs may be set, and reals be read, after each internal step.
        if one.kind not in (VariableKind.TIME, VariableKind.PARAMETER, VariableKind.INTEGER):
            element.set("intermediateUpdate", "true")
        if _has_unit(one):
            element.set("unit", one.unit)
        if one.start is not None:
            element.set("start", _double(one.start))
    structure = SubElement(root, "ModelStructure")
    for tag in ("Output", "InitialUnknown"):
        for reference, one in enumerate(variables):
            if one.is_output:
                # No input reaches an output within a step: importers have no algebraic loops.
                SubElement(structure, tag, valueReference=str(reference), dependencies="")
    return root


def _description_2(experiment: Experiment, variables: Sequence[Variable]) -> Element:
    root = Element(
        "fmiModelDescription",
        fmiVersion="2.0",
        modelName=experiment.name,
        guid=experiment.token,
        generationTool="Duhamel",
        variableNamingConvention="structured",
    )
    SubElement(
        root,
        "CoSimulation",
        modelIdentifier=experiment.identifier,
        canHandleVariableCommunicationStepSize="true",
        canGetAndSetFMUstate="true",
        canSerializeFMUstate="true",
    )
    _add_units(root, variables)
    _add_categories(root)
    _add_experiment(root, experiment)
    group = SubElement(root, "ModelVariables")
    # FMI 2 counts variables from 1, FMI 3 names them by their value references.
    outputs = []
    for reference, one in enumerate(variables):
        if one.kind is VariableKind.TIME:
            continue  # importers of FMI 2 look for a start, which the time must not have
        element = SubElement(group, "ScalarVariable", _attributes(one, reference))
        number = SubElement(element, "Integer" if one.kind is VariableKind.INTEGER else "Real")
        if _has_unit(one):
            number.set("unit", one.unit)
        if one.start is not None:
            number.set("start", _double(one.start))
        if one.is_output:
            outputs.append(len(group))
    structure = SubElement(root, "ModelStructure")
    for tag in ("Outputs", "InitialUnknowns"):
        if outputs:
            unknowns = SubElement(structure, tag)
            for index in outputs:
                SubElement(unknowns, "Unknown", index=str(index), dependencies="")
    return root


def _attributes(one: Variable, reference: int) -> dict[str, str]:
    """What both versions have of a variable."""
    found = {
        "name": one.name,
        "valueReference": str(reference),
        "causality": CAUSALITY_OF_KIND[one.kind],
        "variability": VARIABILITY_OF_KIND.get(one.kind, "continuous"),
        "description": one.description,
    }
    if one.is_output:
        found["initial"] = "calculated"
    elif one.kind is VariableKind.PARAMETER:
        found["initial"] = "exact"
    return found


def _double(value: float) -> str:
    """A number as XML has it: a motor without limits has infinite ones."""
    return repr(value) if isfinite(value) else ("INF" if value > 0.0 else "-INF")


def _has_unit(one: Variable) -> bool:
    return one.unit not in ("", "1") and one.kind is not VariableKind.INTEGER


def _add_units(root: Element, variables: Sequence[Variable]) -> None:
    group = SubElement(root, "UnitDefinitions")
    for unit in sorted({one.unit for one in variables if _has_unit(one)}):
        exponents = {base: str(exponent) for base, exponent in base_units(unit).items()}
        SubElement(SubElement(group, "Unit", name=unit), "BaseUnit", exponents)


def _add_categories(root: Element) -> None:
    group = SubElement(root, "LogCategories")
    SubElement(group, "Category", name="logStatusError", description="why a function has failed")


def _add_experiment(root: Element, experiment: Experiment) -> None:
    SubElement(
        root,
        "DefaultExperiment",
        startTime="0",
        stopTime=repr(experiment.stop),
        stepSize=repr(experiment.communication),
    )
