"""Write fmu/c/fmi2_stubs.h and fmi3_stubs.h: functions of the standards that exports do not have.

    python tools/make_fmi_stubs.py

Importers look all of them up. Each is an error that names the function.
"""

import re
from pathlib import Path

FOLDER = Path(__file__).resolve().parents[1] / "fmu/c"
# a function type: what it returns, its name, its arguments
TYPE = re.compile(
    r"typedef\s+(fmi[23]Status|fmi3Instance|void)\s+(fmi[23]\w+)TYPE\s*\(([^;]*)\)\s*;"
)


def main() -> None:
    for version in (2, 3):
        FOLDER.joinpath(f"fmi{version}_stubs.h").write_text(stubs(version), encoding="utf-8")


def stubs(version: int) -> str:
    """The stubs of a version as C."""
    header = FOLDER.joinpath(f"fmi/fmi{version}FunctionTypes.h").read_text(encoding="utf-8")
    source = FOLDER.joinpath(f"fmi{version}.c").read_text(encoding="utf-8")
    there = set(re.findall(r"^EXPORT [\w \*]*?(fmi\d\w+)\(", source, re.M))
    found = TYPE.findall(re.sub(r"/\*.*?\*/", "", header, flags=re.S))
    parts = ["/* Made by tools/make_fmi_stubs.py. */\n"]
    parts += [_stub(*one) for one in found if one[1] not in there and "Callback" not in one[1]]
    return "\n".join(parts)


def _stub(returned: str, name: str, arguments: str) -> str:
    declared = [" ".join(argument.split()) for argument in arguments.split(",")]
    # SELF knows the instance by this name.
    declared[0] = declared[0].replace("fmi2Component c", "fmi2Component component")
    names = [re.findall(r"\w+", argument)[-1] for argument in declared]
    instance = "component" if name.startswith("fmi2") else "instance"
    unused = [f"(void){one};" for one in names if one != instance]
    lines = [f"EXPORT {returned} {name}(", *(f"    {one}," for one in declared[:-1])]
    lines += [f"    {declared[-1]}) {{", *(f"    {one}" for one in unused)]
    if returned == "fmi3Instance":
        lines += [
            "    if (logMessage)",
            "        logMessage(instanceEnvironment, fmi3Error, CATEGORY,",
            f'                   "{name}: expected co-simulation");',
            "    return NULL;",
        ]
    elif returned != "void":
        lines += [
            "    SELF;",
            f'    return FAILS("{name}: not part of this export");',
        ]
    return "\n".join(filter(str.strip, [*lines, "}"])) + "\n"


if __name__ == "__main__":
    main()
