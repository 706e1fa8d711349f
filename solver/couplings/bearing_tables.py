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
"""SI units of each unit by quantity; the first one is that of a column without a unit"""
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
    for name, why in UNSUPPORTED_COLUMNS.items():
        if name in columns and columns[name].any():
            raise ModelError(f"file: {path}: column {name}: expected zeros, for {why}")
    zero = np.zeros(len(columns["kxx"]))
    K, C = (np.array([columns.get(letter + k, zero) for k in MATRIX_ENTRIES]).T for letter in "kc")
    if "sommerfeld" in columns:
        table = _of_film(columns["sommerfeld"], K, C, film)
    elif film:
        raise ModelError(f"file: {path}: expected a column sommerfeld, for film is given")
    else:
        table = BearingTable(next(columns[name] for name in SPEED_COLUMNS if name in columns), K, C)
    _check_increasing(path, table.speeds)
    return table


def _check_missing(path: str, columns: Mapping[str, Array]) -> None:
    needed = [k + end for k in "kc" for end in ("xx", "yy")]
    missing = [name for name in needed if name not in columns]
    if not any(name in columns for name in (*SPEED_COLUMNS, "sommerfeld")):
        missing.insert(0, "speed (or sommerfeld)")
    if missing:
        there_are = ", ".join(columns) or "none of these"
        raise ModelError(
            f"file: {path}: expected the columns {', '.join(missing)} too, found {there_are}"
        )


def _check_increasing(path: str, speeds: Array) -> None:
    falls = np.flatnonzero(np.diff(speeds) <= 0.0)
    if len(falls):
        k = int(falls[0])
        raise ModelError(
            f"file: {path}: row {k + 2} of the table: expected speeds that increase, found "
            f"{speeds[k + 1]:.6g} rad/s after {speeds[k]:.6g} rad/s"
        )
    if len(speeds) < 2:
        raise ModelError(f"file: {path}: expected two or more speeds, found {len(speeds)}")


def _of_film(numbers: Array, K: Array, C: Array, film: Mapping[str, float]) -> BearingTable:
    """The table of a dimensionless one, in the order of its speeds."""
    load, clearance, viscosity, length, diameter = (film[key] for key in FILM_KEYS)
    per_turn = viscosity * length * diameter / load * (0.5 * diameter / clearance) ** 2
    speeds = 2.0 * np.pi * numbers / per_turn
    # Published tables often begin with the largest load.
    order = slice(None) if speeds[0] < speeds[-1] else slice(None, None, -1)
    by_speed = C * load / (clearance * speeds[:, None])
    return BearingTable(speeds[order], (K * load / clearance)[order], by_speed[order])


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
        factor = _factor(path, header, quantity, unit)
        found[name] = factor * column_of(path, header)
    if "sommerfeld" in found:
        if not dimensionless:
            raise ModelError(
                f"file: {path}: column sommerfeld: expected film = {{{', '.join(FILM_KEYS)}}} of "
                "the bearing, which makes coefficients of dimensionless ones"
            )
        if not (found["sommerfeld"] > 0.0).all():
            raise ModelError(f"file: {path}: column sommerfeld: expected numbers above 0")
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
