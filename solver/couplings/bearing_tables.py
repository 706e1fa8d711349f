"""Tables of bearing coefficients over the spin, from files.

CSV names its columns, with units in brackets: `speed [rpm], kxx [N/mm], ..., cyy [N s/m]`. TOML and
JSON are those that ROSS saves of a bearing. A dimensionless table has a column `sommerfeld`,

    S = mu N L D / W (R / c)^2,      K* = K c / W,      C* = C c Omega / W

with N = Omega / (2 pi) revolutions a second, viscosity mu, length L, diameter D = 2 R, load W and
radial clearance c of the bearing. At constant load and viscosity each S is one spin. Source: M. I.
Friswell et al., Dynamics of Rotating Machines (2010), ch. 5.
"""

import json
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ...inputs import InputError, parse_toml, quoted
from ...inputs.text import read_text
from ..arrays import Array
from ..errors import ModelError
from ..signals.columns import column_of, names_of_columns

LBF_PER_INCH = 4.4482216152605 / 0.0254
"""in N/m"""
UNITS_OF = {
    "speed": {"rad/s": 1.0, "rpm": np.pi / 30.0, "Hz": 2.0 * np.pi},
    "stiffness": {"N/m": 1.0, "N/mm": 1e3, "kN/m": 1e3, "kN/mm": 1e6, "MN/m": 1e6,
                  "lbf/in": LBF_PER_INCH},
    "damping": {"N s/m": 1.0, "N s/mm": 1e3, "kN s/m": 1e3, "kN s/mm": 1e6, "MN s/m": 1e6,
                "lbf s/in": LBF_PER_INCH},
    "mass": {"kg": 1.0},
    "number": {"1": 1.0, "-": 1.0},
}  # fmt: skip
"""SI units of each unit by quantity; the first is that of a column without one, but `frequency`"""
SPEED_COLUMNS = "speed", "frequency"
MATRIX_ENTRIES = "xx", "xy", "yx", "yy"
"""of a matrix, by rows: x is e_1 of the bearing, y is e_2"""
FILM_KEYS = "load", "clearance", "viscosity", "length", "diameter"
"""of a bearing with a dimensionless table [N, m, Pa s, m, m]"""
# Left out without a word, they would make other results than those of the program that wrote them.
UNSUPPORTED_COLUMNS = {
    **dict.fromkeys(("mxx", "mxy", "myx", "myy", "mzz"), "added masses are not supported"),
    **dict.fromkeys(("kzz", "czz"), "a bearing acts across its axis alone"),
}
_HEADER = re.compile(r"\s*([^\[\](]*?)\s*(?:\[([^\]]*)\]|\(([^)]*)\))?\s*")
"""a name, and a unit in brackets of either kind"""


class BearingTable(NamedTuple):
    """Speeds (n,) [rad/s], stiffness and damping (n, 4) [N/m, N s/m], as 11, 12, 21, 22."""

    speeds: Array
    stiffness: Array
    damping: Array


def read_bearing_table(path: str, film: Mapping[str, float]) -> BearingTable:
    """The table of a file; film: FILM_KEYS of a dimensionless one.

    ModelError names the file, and the row and column where one is wrong.
    """
    suffix = Path(path).suffix.lower()
    if suffix in (".toml", ".json"):
        columns = _of_ross(path)
    elif suffix in (".xls", ".xlsx", ".ods"):
        raise ModelError(f"file: {path}: expected a CSV file, got a spreadsheet: export it as CSV")
    else:
        columns = _of_csv(path, bool(film))
    _check_missing(path, columns)
    _check_dimensionless(path, columns, film)
    for name, why in UNSUPPORTED_COLUMNS.items():
        if name in columns and columns[name].any():
            raise ModelError(f"file: {path}: column {name}: expected zeros, for {why}")
    zero = np.zeros(len(columns["kxx"]))
    K, C = (np.array([columns.get(letter + k, zero) for k in MATRIX_ENTRIES]).T for letter in "kc")
    if "sommerfeld" in columns:
        table = _of_film(columns["sommerfeld"], K, C, film)
    else:
        table = BearingTable(next(columns[name] for name in SPEED_COLUMNS if name in columns), K, C)
    if len(table.speeds) < 2:
        raise ModelError(f"file: {path}: expected two or more speeds, found {len(table.speeds)}")
    # Published tables often begin with the largest load.
    falls = "sommerfeld" in columns and bool(table.speeds[0] > table.speeds[-1])
    _check_order(path, table.speeds, falls)
    return BearingTable(*(column[::-1] for column in table)) if falls else table


def _check_missing(path: str, columns: Mapping[str, Array]) -> None:
    needed = [k + end for k in "kc" for end in ("xx", "yy")]
    missing = [name for name in needed if name not in columns]
    if not any(name in columns for name in (*SPEED_COLUMNS, "sommerfeld")):
        missing.insert(0, "speed (or sommerfeld)")
    named = [name for name in (*SPEED_COLUMNS, "sommerfeld") if name in columns]
    if len(named) > 1:
        raise ModelError(
            f"file: {path}: expected one of speed, frequency and sommerfeld, found "
            f"{' and '.join(named)}"
        )
    if missing:
        there_are = ", ".join(columns) or "none of these"
        raise ModelError(
            f"file: {path}: expected the columns {', '.join(missing)} too, found {there_are}"
        )


def _check_dimensionless(
    path: str, columns: Mapping[str, Array], film: Mapping[str, float]
) -> None:
    """Sommerfeld numbers and a film, or neither."""
    if "sommerfeld" not in columns:
        if film:
            raise ModelError(f"file: {path}: expected a column sommerfeld, for film is given")
        return
    if not film:
        raise ModelError(
            f"file: {path}: column sommerfeld: expected film = {{{', '.join(FILM_KEYS)}}} of "
            "the bearing, which makes coefficients of dimensionless ones"
        )
    for k, number in enumerate(columns["sommerfeld"].tolist()):
        if not number > 0.0:
            raise ModelError(
                f"file: {path}: column sommerfeld: row {k + 1} of the table: expected a number "
                f"above 0, found {number:g}"
            )


def _check_order(path: str, speeds: Array, falls: bool) -> None:
    """Speeds, as they stand in the file, all rise or all fall."""
    wrong = np.flatnonzero(np.diff(speeds) * (-1.0 if falls else 1.0) <= 0.0)
    if len(wrong):
        k = int(wrong[0])
        raise ModelError(
            f"file: {path}: row {k + 2} of the table: expected speeds that "
            f"{'decrease' if falls else 'increase'}, found {speeds[k + 1]:.6g} rad/s after "
            f"{speeds[k]:.6g} rad/s"
        )


def _of_film(numbers: Array, K: Array, C: Array, film: Mapping[str, float]) -> BearingTable:
    """The table of a dimensionless one."""
    load, clearance, viscosity, length, diameter = (film[key] for key in FILM_KEYS)
    per_turn = viscosity * length * diameter / load * (0.5 * diameter / clearance) ** 2
    speeds = 2.0 * np.pi * numbers / per_turn
    return BearingTable(speeds, K * load / clearance, C * load / (clearance * speeds[:, None]))


def _of_csv(path: str, dimensionless: bool) -> dict[str, Array]:
    """The columns of a CSV file that a table takes, by name, in SI units."""
    found: dict[str, Array] = {}
    for header in names_of_columns(path):
        name, unit = _parsed(header)
        quantity = _quantity(name)
        if quantity is None:
            continue
        if name in found:
            raise ModelError(f"file: {path}: more than one column is {name}")
        if dimensionless and quantity in ("stiffness", "damping"):
            quantity = "number"
        if name == "frequency" and unit is None:
            # That of ROSS is in rad/s, and that of others in Hz.
            raise ModelError(
                f"file: {path}: column {quoted(header)}: expected a unit in brackets, "
                f"{', '.join(UNITS_OF['speed'])}, found none"
            )
        factor = _factor(path, header, quantity, unit)
        found[name] = factor * column_of(path, header)
    return found


def _parsed(header: str) -> tuple[str, str | None]:
    """The name in a header, as ROSS spells it, and the unit; None where there is none."""
    found = _HEADER.fullmatch(header)
    name, square, round_ = found.groups() if found else (header, None, None)
    name = name.lower().replace("_", "")
    if re.fullmatch("[kcm][12]{2}", name):
        name = name.translate(str.maketrans("12", "xy"))
    return name, square if square is not None else round_


def _quantity(name: str) -> str | None:
    """What a column is; None for one that a table does not take."""
    if name in SPEED_COLUMNS:
        return "speed"
    if name == "sommerfeld":
        return "number"
    if re.fullmatch("[kcm]([xy]{2}|zz)", name):
        return {"k": "stiffness", "c": "damping", "m": "mass"}[name[0]]
    return None


def _factor(path: str, header: str, quantity: str, unit: str | None) -> float:
    units = UNITS_OF[quantity]
    if unit is None:
        return next(iter(units.values()))
    # "N*s/m", "N.s/m" and "Ns/m" are one unit.
    plain = {_bare(known): factor for known, factor in units.items()}
    if _bare(unit) not in plain:
        raise ModelError(
            f"file: {path}: column {quoted(header)}: expected a unit of {quantity}, "
            f"{', '.join(units)}, found {quoted(unit)}"
        )
    return plain[_bare(unit)]


def _bare(unit: str) -> str:
    return re.sub(r"[\s*.\u00b7]", "", unit)


def _of_ross(path: str) -> dict[str, Array]:
    """The columns of the one bearing in a file that ROSS saved, all in SI units."""
    text = read_text(path, ModelError)
    try:
        content: Any = json.loads(text) if path.lower().endswith(".json") else parse_toml(text)
    except (ValueError, RecursionError, InputError) as error:
        raise ModelError(f"file: {path}: not a readable file: {error}") from error
    tables = {"": content, **content} if isinstance(content, Mapping) else {}
    bearings = {k: v for k, v in tables.items() if isinstance(v, Mapping) and "kxx" in v}
    if len(bearings) != 1:
        found = ", ".join(map(quoted, bearings)) or "none"
        raise ModelError(f"file: {path}: expected one table of a bearing, with kxx, found {found}")
    ((name, bearing),) = bearings.items()
    columns = {}
    for key, values in bearing.items():
        if _quantity(key) is None or values is None:
            continue
        columns[key] = _numbers(path, f"{name}.{key}", values)
    lengths = {key: len(column) for key, column in columns.items()}
    if len(set(lengths.values())) > 1:
        listed = ", ".join(f"{key} {n}" for key, n in lengths.items())
        raise ModelError(f"file: {path}: expected arrays of one length, found {listed}")
    return columns


def _numbers(path: str, key: str, values: Any) -> Array:
    items = values if isinstance(values, list) else [values]
    for k, item in enumerate(items):
        if isinstance(item, bool) or not isinstance(item, int | float) or not np.isfinite(item):
            raise ModelError(
                f"file: {path}: {key.lstrip('.')}: row {k + 1}: expected a number, "
                f"found {quoted(item)}"
            )
    return np.array(items, dtype=np.float64)
