"""FMUs of a small controller (controller.c), compiled when tests need them."""

import re
import subprocess
import zipfile
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from duhamel.fmu.library import FMI_PLATFORMS, compiler_of
from duhamel.solver.compiler.targets import own_platform

HERE = Path(__file__).parent
HEADERS = HERE.parents[1] / "fmu/c/fmi"
VARIABLES = (
    ("time", "independent"),
    ("angle", "input"),
    ("rate", "input"),
    ("torque", "output"),
    *((name, "parameter") for name in ("kp", "kd", "ki", "lag", "limit", "reference", "fails_at")),
    ("z", "local"),
    ("count", "output"),
)
"""by their value references"""
TURNS, MODE = 13, 14
"""a parameter that is a whole number, and an input that is a truth value"""


@cache
def library(version):
    """The library of the controller for this machine."""
    header = HEADERS.joinpath(f"fmi{version}FunctionTypes.h").read_text(encoding="utf-8")
    source = (HERE / "controller.c").read_text(encoding="utf-8")
    names = set(re.findall(rf"(fmi{version}\w+)TYPE", header))
    there = set(re.findall(rf"fmi{version}\w+", source))
    there |= {f"fmi{version}{name}" for name in re.findall(r"F\((\w+)\)", source)}
    platform = FMI_PLATFORMS[own_platform()]
    with TemporaryDirectory() as place:
        folder = Path(place)
        # Importers look all functions up: those that are missing fail when they are called.
        stubs = [f"int {name}(void) {{ return 3; }}" for name in sorted(names - there)]
        (folder / "stubs.c").write_text("\n".join(stubs))
        built = folder / f"controller{platform.suffix}"
        subprocess.run(
            [
                *compiler_of(own_platform()),
                *("-shared", "-O2", "-fPIC", f"-DFMI={version}", f"-I{HEADERS}"),
                *(str(HERE / "controller.c"), str(folder / "stubs.c"), "-o", str(built), "-lm"),
            ],
            check=True,
            capture_output=True,
        )
        return built.read_bytes()


def controller(
    path,
    version=3,
    *,
    states=True,
    serializes=True,
    derivatives=False,
    step=None,
    platform="",
    interface="CoSimulation",
    tool=False,
):
    """Write the FMU of the controller, which offers what is asked for."""
    own = FMI_PLATFORMS[own_platform()]
    folder = platform or (own.name_2 if version == 2 else own_platform())
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", _description(version, locals()))
        archive.writestr(f"binaries/{folder}/controller{own.suffix}", library(version))
    return path


def _description(version, given):
    def flag(name):
        return "true" if given[name] else "false"

    step = f' stepSize="{given["step"]}"' if given["step"] else ""
    if version == 2:
        abilities = (
            f'canGetAndSetFMUstate="{flag("states")}" canSerializeFMUstate="{flag("serializes")}" '
            f'providesDirectionalDerivative="{flag("derivatives")}"'
        )
        head = 'fmiVersion="2.0" guid="controller"'
    else:
        abilities = (
            f'canGetAndSetFMUState="{flag("states")}" canSerializeFMUState="{flag("serializes")}" '
            f'providesDirectionalDerivatives="{flag("derivatives")}"'
        )
        head = 'fmiVersion="3.0" instantiationToken="controller"'
    return (
        f'<?xml version="1.0" encoding="UTF-8"?>\n'
        f'<fmiModelDescription {head} modelName="controller" generationTool="Sketch">'
        f'<{given["interface"]} modelIdentifier="controller" needsExecutionTool="{flag("tool")}" '
        f"{abilities}/>"
        f"<DefaultExperiment{step}/>"
        f"<ModelVariables>{_variables(version)}</ModelVariables>"
        "<ModelStructure/></fmiModelDescription>"
    )


def _variables(version):
    real = {2: "Real", 3: "Float64"}[version]
    whole = {2: "Integer", 3: "Int32"}[version]
    rows = [(name, number, causality, real) for number, (name, causality) in enumerate(VARIABLES)]
    rows += [("turns", TURNS, "parameter", whole), ("mode", MODE, "input", "Boolean")]
    return "".join(_variable(version, *row) for row in rows)


def _variable(version, name, number, causality, kind):
    own = f'name="{name}" valueReference="{number}" causality="{causality}"'
    if causality == "parameter":
        own += ' variability="fixed"'
    start = "" if causality in ("output", "local", "independent") else ' start="0"'
    if version == 2:
        return f"<ScalarVariable {own}><{kind}{start}/></ScalarVariable>"
    return f"<{kind} {own}{start}/>"
