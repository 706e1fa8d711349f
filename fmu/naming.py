"""Names and units of Duhamel as FMI has them."""

import re

C_IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
# exponents of the SI base units
BASE_UNITS = {
    "m": {"m": 1},
    "kg": {"kg": 1},
    "s": {"s": 1},
    "rad": {"rad": 1},
    "N": {"kg": 1, "m": 1, "s": -2},
    "J": {"kg": 1, "m": 2, "s": -2},
    "W": {"kg": 1, "m": 2, "s": -3},
    "Pa": {"kg": 1, "m": -1, "s": -2},
    "Hz": {"s": -1},
}


def structured(path: str) -> str:
    """A name of Duhamel as a structured name of FMI.

    "frames/beam.tip/position" is "frames.beam.tip.position"; what is no identifier is quoted.

    Examples
    --------
    >>> structured("motors/elbow servo/torque")
    "motors.'elbow servo'.torque"
    """
    return ".".join(map(_quoted, re.split(r"[/.]", path)))


def _quoted(part: str) -> str:
    if C_IDENTIFIER.fullmatch(part):
        return part
    return "'" + part.replace("\\", "\\\\").replace("'", "\\'") + "'"


def identifier(name: str) -> str:
    """A name as an identifier of C, by which files and functions are called.

    Examples
    --------
    >>> identifier("2-arm robot")
    '_2_arm_robot'
    """
    # Letters beyond ASCII are none in C.
    found = re.sub(r"[^A-Za-z0-9_]", "_", name) or "model"
    return f"_{found}" if found[0].isdigit() else found


def base_units(unit: str) -> dict[str, int]:
    """The exponents of the base units in a unit, in the spelling of UDUNITS.

    Examples
    --------
    >>> base_units("N m s-1")
    {'kg': 1, 'm': 2, 's': -3}
    """
    total: dict[str, int] = {}
    for factor in unit.split():
        # A pure number, as in "m m-1" reduced.
        if factor == "1":
            continue
        symbol, power = re.findall(r"([A-Za-z]+)(-?\d*)", factor)[0]
        for base, exponent in BASE_UNITS[symbol].items():
            total[base] = total.get(base, 0) + exponent * int(power or 1)
    return {base: exponent for base, exponent in sorted(total.items()) if exponent}
