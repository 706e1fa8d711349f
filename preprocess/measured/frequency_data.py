"""Frequency responses in files: UFF58, NumPy, HDF5 and MATLAB, as accelerances."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ...files.arrays import Array, Complex
from ..errors import MeasurementError, about
from .channels import ChannelTable
from .hits import HitTable

POWERS_OF_S = {"accelerance": 0, "mobility": 1, "receptance": 2}
"""of s that make each of them an accelerance"""
QUANTITY_OF_TYPE = {12: "accelerance", 11: "mobility", 8: "receptance"}
"""of UFF's types of the numerator"""
FORCE_TYPE, FREQUENCY_TYPE, RESPONSE_FUNCTION = 13, 18, 4
"""of UFF: its denominator, its abscissa, and its function"""
SAME_LINES = 1e-6
"""relative difference of frequencies that are one line"""
LEAST_LINES = 20
DAMAGE_OF_RESPONSES = (
    OSError,
    TypeError,
    ValueError,
    KeyError,
    EOFError,
    NotImplementedError,
    UnicodeError,
)
"""what readers of broken files raise"""


@dataclass(frozen=True, eq=False)
class FrequencyData:
    """f (k,) [Hz] ascending, and accelerances (k, n_o, n_i) [1/kg] of channels by hits."""

    f: Array
    H: Complex


def read_responses(
    path: Path, quantity: str | None, channels: ChannelTable, hits: HitTable, window: float
) -> FrequencyData:
    """The responses of all channels to all hits of the tables.

    Arrays are `f` (k,) and `H` (k, n_o, n_i), with names of `outputs` and `inputs` unless these are
    in the order of the tables, and perhaps `quantity`. UFF sets are named by their nodes and
    directions. `MeasurementError` names the file, the set, what was found and what was expected.
    """
    suffix = path.suffix.lower()
    if suffix in (".uff", ".unv"):
        f, H, found = _of_uff(path, channels, hits)
    elif suffix in ARRAY_READERS:
        f, H, found = _of_arrays(path, channels, hits)
    else:
        known = ", ".join([".uff", ".unv", *ARRAY_READERS])
        raise MeasurementError(f"{path}: expected a file {known}, found {suffix or 'no suffix'}")
    if found and quantity and found != quantity:
        raise MeasurementError(f"{path}: measured.quantity is {quantity}, but the file has {found}")
    if not (kind := quantity or found):
        raise MeasurementError(
            f"{path}: the file does not say what it has: measured.quantity: expected one of "
            f"{', '.join(POWERS_OF_S)}, found none"
        )
    if kind not in POWERS_OF_S:
        raise MeasurementError(f"{path}: expected one of {', '.join(POWERS_OF_S)}, found {kind!r}")
    if not np.isfinite(H).all() or not np.isfinite(f).all():
        raise MeasurementError(f"{path}: expected finite numbers, found others")
    if len(f) < LEAST_LINES or not (np.diff(f) > 0.0).all() or f[0] < 0.0:
        raise MeasurementError(
            f"{path}: expected {LEAST_LINES} frequencies [Hz] or more, ascending, found {len(f)}"
        )
    # A windowed response is that at a shifted s, its derivatives too.
    s = 2j * np.pi * f + window
    return FrequencyData(f, H * (s ** POWERS_OF_S[kind])[:, None, None])


Read = tuple[Array, Complex, str]


def _of_arrays(path: Path, channels: ChannelTable, hits: HitTable) -> Read:
    with about(path, MeasurementError, "file", "not readable arrays", DAMAGE_OF_RESPONSES):
        arrays = ARRAY_READERS[path.suffix.lower()](path)
    if missing := [key for key in ("f", "H") if key not in arrays]:
        raise MeasurementError(f"{path}: expected the arrays f and H, found no {missing[0]}")
    f = np.asarray(arrays["f"], dtype=float).ravel()
    H = np.asarray(arrays["H"], dtype=complex)
    shape = (len(f), len(channels.names), len(hits.labels))
    if H.shape != shape:
        raise MeasurementError(
            f"{path}: H: expected frequencies, channels and hits {shape}, found {H.shape}"
        )
    for axis, key, names in ((1, "outputs", channels.names), (2, "inputs", hits.labels)):
        if key in arrays:
            given = [str(name).strip() for name in np.ravel(arrays[key])]
            H = np.take(H, _places(path, key, given, names), axis=axis)
    quantity = "".join(str(part) for part in np.ravel(arrays.get("quantity", "")))
    return f, H, quantity


def _places(path: Path, key: str, given: list[str], names: tuple[str, ...]) -> list[int]:
    if sorted(given) != sorted(names):
        missing = sorted(set(names) - set(given)) or sorted(set(given) - set(names))
        raise MeasurementError(
            f"{path}: {key}: expected those of the table, each once; {missing[0]} is not in both"
        )
    return [given.index(name) for name in names]


def _of_npz(path: Path) -> Mapping[str, Any]:
    with np.load(path) as file:
        return {key: file[key] for key in file.files}


def _of_hdf5(path: Path) -> Mapping[str, Any]:
    import h5py

    with h5py.File(path) as file:
        arrays: dict[str, Any] = {}
        for key in ("f", "H", "outputs", "inputs", "quantity"):
            if key in file:
                value = file[key]
                text = h5py.check_string_dtype(value.dtype) is not None
                arrays[key] = value.asstr()[()] if text else value[()]
        return arrays


def _of_matlab(path: Path) -> Mapping[str, Any]:
    from scipy.io import loadmat

    found: Mapping[str, Any] = loadmat(path, chars_as_strings=True)
    return {key: _flat(value) for key, value in found.items() if not key.startswith("__")}


def _flat(value: Any) -> Any:
    """Cells of MATLAB as names."""
    array = np.asarray(value)
    return [str(np.ravel(cell)[0]) for cell in array.ravel()] if array.dtype == object else array


ARRAY_READERS: dict[str, Callable[[Path], Mapping[str, Any]]] = {
    ".npz": _of_npz,
    ".h5": _of_hdf5,
    ".mat": _of_matlab,
}


def _of_uff(path: Path, channels: ChannelTable, hits: HitTable) -> Read:
    try:
        import pyuff
    except ImportError as error:
        raise MeasurementError(
            f"{path}: reading UFF takes pyuff: pip install 'duhamel[measured]'"
        ) from error
    with about(path, MeasurementError, "file", "not a readable UFF file", DAMAGE_OF_RESPONSES):
        file = pyuff.UFF(str(path))
        types = [int(kind) for kind in file.get_set_types()]
        sets = [(k + 1, file.read_sets(k)) for k, kind in enumerate(types) if kind == 58]
    # pyuff passes over what it cannot read, and says nothing.
    if 0 in types:
        raise MeasurementError(f"{path}: set {types.index(0) + 1}: expected a UFF set, found none")
    responses = [(k, one) for k, one in sets if _is_response(path, k, one)]
    if not responses:
        raise MeasurementError(f"{path}: expected sets 58 of frequency responses, found none")
    outputs = {name: k for k, name in enumerate(channels.names)}
    # All of them have one axis, or could not be one matrix.
    first = np.asarray(responses[0][1]["x"], dtype=float)
    H = np.full((len(first), len(channels.names), len(hits.labels)), np.nan + 0j)
    quantities = set()
    for k, one in responses:
        where = f"{path}: set {k}"
        x, data = np.asarray(one["x"], dtype=float), np.asarray(one["data"], dtype=complex)
        if len(x) != len(first) or not np.allclose(x, first, rtol=SAME_LINES):
            raise MeasurementError(
                f"{where}: expected the {len(first)} frequencies of the first set, found {len(x)}"
            )
        o, sign = _channel(where, one, channels, outputs)
        label = str(int(one["ref_node"]))
        if label not in hits.labels:
            raise MeasurementError(f"{where}: no hit {label} in the table")
        i = hits.labels.index(label)
        sign *= _sign(int(one["ref_dir"]), hits.directions[i])
        if not np.isnan(H[0, o, i]):
            raise MeasurementError(
                f"{where}: expected each pair once, found {channels.names[o]} by {label} twice"
            )
        H[:, o, i] = sign * data
        quantities.add(QUANTITY_OF_TYPE.get(int(one["ordinate_spec_data_type"]), ""))
    if np.isnan(H[0]).any():
        o, i = np.argwhere(np.isnan(H[0]))[0]
        raise MeasurementError(
            f"{path}: expected all channels by all hits, found no set of {channels.names[o]} by "
            f"{hits.labels[i]}"
        )
    if len(quantities) > 1:
        raise MeasurementError(f"{path}: expected one quantity, found {sorted(quantities)}")
    return first, H, quantities.pop()


def _is_response(path: Path, k: int, one: Mapping[str, Any]) -> bool:
    """Whether a set is a frequency response; `MeasurementError` where it has no numbers."""
    # Nor does it say that the numbers of a set are broken off.
    if "data" not in one or "x" not in one or not np.size(one["data"]):
        raise MeasurementError(f"{path}: set {k}: expected numbers, found none that can be read")
    if int(one["func_type"]) != RESPONSE_FUNCTION:
        return False
    # Programs that leave types open write 0.
    for key, name, wanted in (
        ("abscissa_spec_data_type", "frequencies", FREQUENCY_TYPE),
        ("orddenom_spec_data_type", "responses per force", FORCE_TYPE),
    ):
        if (found := int(one.get(key) or 0)) not in (0, wanted):
            raise MeasurementError(
                f"{path}: set {k}: expected {name} ({wanted}), found the type {found}"
            )
    return True


def _channel(
    where: str, one: Mapping[str, Any], channels: ChannelTable, outputs: Mapping[str, int]
) -> tuple[int, float]:
    """The channel of a set, and the sign that makes it point as in the table."""
    label, code = str(int(one["rsp_node"])), int(one["rsp_dir"])
    if abs(code) not in (0, 1, 2, 3):
        raise MeasurementError(f"{where}: expected a direction from -3 to 3, found {code}")
    axis = "" if code == 0 else "xyz"[abs(code) - 1]
    for name in (f"{label}:{axis}", f"{label}:{abs(code)}", label):
        if name in outputs:
            o = outputs[name]
            # Numbered directions are those of a turned sensor, in its own axes.
            turned = name.endswith(f":{abs(code)}")
            return o, float(np.sign(code)) if turned else _sign(code, channels.directions[o])
    raise MeasurementError(f"{where}: no channel {label}:{axis} in the table")


def _sign(code: int, direction: Array) -> float:
    """1 or -1: whether a direction of the table is that of a code from -3 to 3, or against it."""
    if code == 0:
        return 1.0
    along = float(np.sign(code) * direction[abs(code) - 1])
    return -1.0 if along < 0.0 else 1.0
