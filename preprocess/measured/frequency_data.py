"""Frequency responses in files, as accelerances: arrays of NumPy, HDF5 and MATLAB, or UFF."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ...files.arrays import Array, Complex, IntArray
from ...files.hdf5 import opened, whole
from ..errors import MeasurementError, about
from .channels import ChannelTable
from .hits import HitTable
from .impulse_data import transformed
from .uff import read_uff

OVER_TIME = "impulse"
POWERS_OF_S = {"accelerance": 0, "mobility": 1, "receptance": 2, OVER_TIME: 0}
"""of s that make each of them an accelerance"""
LEAST_LINES = 20
MOST_COHERENCE = 1.0 + 1e-6
"""with the rounding of files in single precision"""
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
    """f (k,) [Hz] ascending, and accelerances (k, n_o, n_i) [1/kg] of channels by hits.

    coherence (k, n_o, n_i): of each, None where the file has none; quantity: what the file has.
    """

    f: Array
    H: Complex
    coherence: Array | None = None
    quantity: str = "accelerance"

    def lines(self, used: IntArray) -> "FrequencyData":
        """The lines of some numbers."""
        coherence = None if self.coherence is None else self.coherence[used]
        return FrequencyData(self.f[used], self.H[used], coherence, self.quantity)

    def laplace(self, window: float) -> Complex:
        """s (k,) [1/s] of the lines, under an exponential window [1/s]."""
        return np.asarray(2j * np.pi * self.f + window, dtype=complex)


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
        sets = read_uff(path, channels, hits, over_time=quantity == OVER_TIME)
        f, H, found, coherence = sets.f, sets.H, sets.quantity, sets.coherence
    elif suffix in ARRAY_READERS:
        f, H, found, coherence = _of_arrays(path, channels, hits)
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
    if kind == OVER_TIME and found != OVER_TIME:
        raise MeasurementError(
            f'{path}: measured.quantity = "impulse": expected the arrays response and step, found '
            "functions of frequency"
        )
    if kind not in POWERS_OF_S:
        raise MeasurementError(f"{path}: expected one of {', '.join(POWERS_OF_S)}, found {kind!r}")
    if not np.isfinite(f).all():
        raise MeasurementError(f"{path}: expected finite frequencies, found others")
    _require_responses(path, f, H, channels.names, hits.labels)
    if len(f) >= LEAST_LINES and (back := np.flatnonzero(np.diff(f) <= 0.0)).size:
        raise MeasurementError(
            f"{path}: expected frequencies [Hz], ascending, found {f[back[0] + 1]:g} after "
            f"{f[back[0]]:g}"
        )
    if len(f) < LEAST_LINES or f[0] < 0.0:
        raise MeasurementError(
            f"{path}: expected {LEAST_LINES} frequencies [Hz] or more, ascending, found {len(f)}"
        )
    if coherence is not None:
        _require_coherences(path, f, coherence)
    # A windowed response is that at a shifted s, its derivatives too.
    s = 2j * np.pi * f + window
    return FrequencyData(f, H * (s ** POWERS_OF_S[kind])[:, None, None], coherence, kind)


def _require_responses(
    path: Path, f: Array, H: Complex, channels: Sequence[str], hits: Sequence[str]
) -> None:
    """`MeasurementError` names the first response that is no number, and what is dead."""
    if len(wrong := np.argwhere(~np.isfinite(H))):
        k, o, i = wrong[0]
        raise MeasurementError(
            f"{path}: expected finite numbers, found {H[k, o, i]:.3g} in {channels[o]} by "
            f"{hits[i]} at {f[k]:g} Hz"
        )
    for kind, names, others in (("channel", channels, (0, 2)), ("hit", hits, (0, 1))):
        if len(dead := np.flatnonzero(~H.any(axis=others))):
            raise MeasurementError(
                f"{path}: {kind} {names[dead[0]]}: expected responses, all are 0"
            )


def _require_coherences(path: Path, f: Array, coherence: Array) -> None:
    """`MeasurementError` names the first number that no coherence has, and its line."""
    # Written so that NaN is none either.
    wrong = np.argwhere(~((coherence >= 0.0) & (coherence <= MOST_COHERENCE)))
    if len(wrong):
        place = tuple(wrong[0])
        raise MeasurementError(
            f"{path}: coherence: expected numbers from 0 to 1, found {coherence[place]:.3g} at "
            f"{f[place[0]]:g} Hz"
        )


def _of_arrays(
    path: Path, channels: ChannelTable, hits: HitTable
) -> tuple[Array, Complex, str, Array | None]:
    with about(path, MeasurementError, "file", "not readable arrays", DAMAGE_OF_RESPONSES):
        arrays = ARRAY_READERS[path.suffix.lower()](path)
    if "response" in arrays and "H" not in arrays:
        arrays = _transformed(path, arrays)
    elif "".join(str(part) for part in np.ravel(arrays.get("quantity", ""))) == OVER_TIME:
        raise MeasurementError(f"{path}: expected the arrays response and step, found none")
    if missing := [key for key in ("f", "H") if key not in arrays]:
        raise MeasurementError(f"{path}: expected the arrays f and H, found no {missing[0]}")
    with about(path, MeasurementError, "file", "not arrays of numbers", (TypeError, ValueError)):
        f = np.asarray(arrays["f"], dtype=float).ravel()
        H = np.asarray(arrays["H"], dtype=complex)
        coherence = np.asarray(arrays["coherence"], dtype=float) if "coherence" in arrays else None
    shape = (len(f), len(channels.names), len(hits.labels))
    for key, values in (("H", H), ("coherence", coherence)):
        if values is not None and values.shape != shape:
            raise MeasurementError(
                f"{path}: {key}: expected frequencies, channels and hits {shape}, found "
                f"{values.shape}"
            )
    for axis, key, names in ((1, "outputs", channels.names), (2, "inputs", hits.labels)):
        if key in arrays:
            given = [str(name).strip() for name in np.ravel(arrays[key])]
            places = _places(path, key, given, names)
            H = np.take(H, places, axis=axis)
            coherence = None if coherence is None else np.take(coherence, places, axis=axis)
    quantity = "".join(str(part) for part in np.ravel(arrays.get("quantity", "")))
    return f, H, quantity, coherence


def _transformed(path: Path, arrays: Mapping[str, Any]) -> dict[str, Any]:
    """Arrays of impulse responses (n, n_o, n_i) [1/(kg s)] as those of frequency responses."""
    said = "".join(str(part) for part in np.ravel(arrays.get("quantity", OVER_TIME)))
    if said != OVER_TIME:
        raise MeasurementError(f"{path}: response: expected the quantity impulse, found {said!r}")
    step = np.ravel(arrays.get("step", ()))
    if len(step) != 1 or not float(step[0]) > 0.0:
        raise MeasurementError(f"{path}: expected step, the time between responses [s], found none")
    f, H = transformed(path, np.asarray(arrays["response"], dtype=float), float(step[0]))
    kept = {key: value for key, value in arrays.items() if key in ("outputs", "inputs")}
    return {**kept, "f": f, "H": H, "quantity": OVER_TIME}


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

    with opened(path, MeasurementError) as file:
        arrays: dict[str, Any] = {}
        keys = ("f", "H", "response", "step", "coherence", "outputs", "inputs", "quantity")
        for key in keys:
            if key in file:
                text = h5py.check_string_dtype(file[key].dtype) is not None
                arrays[key] = file[key].asstr()[()] if text else whole(file[key])
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
